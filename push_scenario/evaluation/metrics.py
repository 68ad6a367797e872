"""What a task is judged by: where the object rests, what that took, what was touched."""

import dataclasses
import math

import numpy as np
from push_model.geometry import distance, wrap_angle
from push_model.quantity import quantity
from push_scenario.definition.task import Task
from push_sim_node.kernel.layout import SEPARATE


@dataclasses.dataclass(frozen=True)
class Metrics:
    """Figures of one run; positions are those of the object frame."""

    position_error: float = quantity('final distance from the goal', 'm')
    heading_error: float = quantity('final orientation minus that of the goal', 'rad')
    time: float = quantity('time until the push ended', 's')
    contact_time: float = quantity('time in contact', 's')
    path_length: float = quantity('way of the robot', 'm')
    path_ratio: float = quantity('way of the robot over that of the plan')
    max_deviation: float = quantity('largest distance of the object from its planned path', 'm')
    slip: float = quantity('way that the contact slid', 'm')
    within_bounds: bool = quantity("whether the object rests within the scenario's bounds")


def measure(result):
    """
    Judge a run by its tape.

    :param result: the ``Result``.
    :return: the ``Metrics``; None where the goal was refused and nothing moved.
    """
    if result.tape is None:
        return None
    tape, goal, bounds = result.tape, result.scenario.goal.pose, result.scenario.bounds
    final = tape.poses('object')[-1]
    position_error = distance(final, goal)
    heading_error = wrap_angle(final[2] - goal.theta)
    way = distance_travelled(tape)[-1]
    touching = in_contact(tape)[1:]
    steps = np.diff(tape['time'])
    return Metrics(
        position_error=position_error,
        heading_error=heading_error,
        time=result.end_time,
        contact_time=float(steps[touching].sum()),
        path_length=float(way),
        path_ratio=float(way) / result.plan.path_length,
        max_deviation=float(deviation(tape.poses('object'), result.plan)[0].max()),
        slip=float((np.abs(slip_speed(tape, result.scenario.robot_truth.radius)[1:])
                    * steps)[touching].sum()),
        within_bounds=bool(position_error <= bounds.position_error
                           and abs(heading_error) <= bounds.heading_error))


def is_as_expected(result):
    """
    Tell whether a run ended as its scenario expects.

    :param result: the ``Result``.
    """
    if result.scenario.expected == 'refused':
        return result.outcome == 'refused'
    return result.outcome == 'done' and measure(result).within_bounds


def distance_travelled(tape):
    """
    Way of the robot's centre since the start [m], shape (n,).

    :param tape: the ``Tape``.
    """
    steps = np.hypot(np.diff(tape['robot_x']), np.diff(tape['robot_y']))
    return np.concatenate([[0.0], np.cumsum(steps)])


def in_contact(tape):
    """
    Tell for each row whether robot and object touch, shape (n,).

    :param tape: the ``Tape``.
    """
    return tape['mode'] != SEPARATE


def slip_speed(tape, radius):
    """
    Velocity of the robot's surface along the object's, at the contact [m/s], shape (n,).

    :param tape: the ``Tape``.
    :param radius: of the robot [m].
    """
    heading, normal = tape['robot_theta'], tape['normal']
    along = np.exp(-1j * normal)
    robot = (tape['robot_v_x'] + 1j * tape['robot_v_y']) * np.exp(1j * heading) * along
    arm = ((tape['contact_x'] - tape['object_x'])
           + 1j * (tape['contact_y'] - tape['object_y'])) * along
    body = (tape['object_v_x'] + 1j * tape['object_v_y']) * along
    surface = robot.imag + radius * tape['robot_omega']
    return surface - (body.imag + tape['object_omega'] * arm.real)


def deviation(poses, plan):
    """
    Compare poses of the object with the nearest point of its planned path.

    :param poses: shape (n, 3).
    :param plan: the ``PushTrajectory``.
    :return: (distance [m], orientation minus the planned one [rad]), each of shape (n,).
    """
    start, step = plan.object_poses[:-1], np.diff(plan.object_poses, axis=0)
    squared = np.maximum((step[:, :2] ** 2).sum(axis=1), 1e-18)
    distances, angles = [], []
    for pose in poses:
        along = np.clip(((pose[:2] - start[:, :2]) * step[:, :2]).sum(axis=1) / squared, 0.0, 1.0)
        nearest = start + along[:, None] * step
        away = np.hypot(*(pose[:2] - nearest[:, :2]).T)
        best = int(np.argmin(away))
        distances.append(away[best])
        angles.append(math.remainder(pose[2] - nearest[best, 2], 2 * math.pi))
    return np.array(distances), np.array(angles)


def force_angle(tape):
    """
    Angle of the contact force from the contact normal [rad], shape (n,); NaN out of contact.

    :param tape: the ``Tape``.
    """
    normal, tangential = tape['force_n'], tape['force_t']
    return np.where(normal > 0.0, np.arctan2(tangential, np.where(normal > 0.0, normal, 1.0)),
                    np.nan)


@dataclasses.dataclass(frozen=True)
class TaskMetrics:
    """Figures of one task; positions are those of the object frame."""

    position_error: float = quantity('final distance from the goal', 'm')
    heading_error: float = quantity('final orientation minus that of the goal', 'rad')
    time: float = quantity('time until the task ended', 's')
    contact_time: float = quantity('time in contact', 's')
    single_time: float = quantity('time that the best single push would have taken; infinite '
                                  'where there is none, nan where it is not known', 's')
    distance_travelled: float = quantity('way of the robot', 'm')
    object_way: float = quantity('way of the object', 'm')
    pushes: int = quantity('number of pushes')
    recoveries: int = quantity('number of times that something went wrong')
    gap: float = quantity('final gap between robot and object', 'm')
    within_map: bool = quantity('whether neither robot nor object came into an obstacle')
    within_bounds: bool = quantity("whether the object rests within the scenario's bounds and the "
                                   'robot is clear of it')


def measure_task(result):
    """
    Judge a task by its tape.

    :param result: the ``TaskResult``.
    :return: the ``TaskMetrics``.
    """
    tape, scenario = result.tape, result.scenario
    task = scenario.task or Task()
    objects, gap = tape.poses('object'), float(tape['gap'][-1])
    inside = (result.position_error <= scenario.bounds.position_error
              and abs(result.heading_error) <= scenario.bounds.heading_error)
    return TaskMetrics(
        position_error=result.position_error,
        heading_error=result.heading_error,
        time=result.duration,
        contact_time=float(np.diff(tape['time'])[in_contact(tape)[1:]].sum()),
        single_time=result.single,
        distance_travelled=float(distance_travelled(tape)[-1]),
        object_way=float(np.hypot(*np.diff(objects[:, :2], axis=0).T).sum()),
        pushes=result.pushes,
        recoveries=result.recoveries,
        gap=gap,
        within_map=task.occupancy_map is None or (
            task.occupancy_map.robot_is_free(scenario.robot_truth, tape.poses('robot'), 0.0)
            and task.occupancy_map.object_is_free(scenario.truth, objects, 0.0)),
        within_bounds=bool(inside and gap >= task.drive.clearance))


def is_task_as_expected(result):
    """
    Tell whether a task ended as its scenario expects.

    :param result: the ``TaskResult``.
    """
    metrics = measure_task(result)
    if result.scenario.expected == 'refused':
        return result.outcome == 'failed' and not metrics.pushes
    return result.outcome == 'done' and metrics.within_bounds and metrics.within_map
