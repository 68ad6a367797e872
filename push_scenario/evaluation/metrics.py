"""Metrics of a run: where the object came to rest, what that took, and what was touched."""

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray
from push_control.behaviors.failures import BehaviorFailure
from push_dynamics.layout import SEPARATE
from push_model.quantity import quantity
from push_model.trajectory import PushTrajectory
from push_scenario.evaluation.corrections import correcting_pushes
from push_scenario.simulation.result import Outcome, RunResult
from push_sim_node.tape import Tape

FloatArray = NDArray[np.float64]
# Below any planned step: keeps the projection finite where two planned poses coincide [m2].
MIN_SQUARED_STEP = 1e-18
# How deep an object may be in an obstacle of the map [m]; chosen: walls stop it at 0, but for
# rounding and the error of a step. A robot keeps clear.
TOUCH = 1e-3


@dataclasses.dataclass(frozen=True)
class Metrics:
    """Figures of one run; positions are those of the object frame."""

    position_error: float = quantity('final distance from the goal', 'm')
    heading_error: float = quantity('final orientation minus that of the goal', 'rad')
    time: float = quantity('time until the run ended', 's')
    contact_time: float = quantity('time in contact', 's')
    robot_path_length: float = quantity('length of the path of the robot', 'm')
    object_path_length: float = quantity('length of the path of the object', 'm')
    slip: float = quantity('distance that the contact slid', 'm')
    gap: float = quantity('final gap between robot and object', 'm')
    pushes: int = quantity('number of pushes')
    recoveries: int = quantity('number of recoveries')
    corrections: int = quantity('number of correcting pushes: near the goal, after a first one')
    correction_time: float = quantity('time of each of them with what precedes it, mean; nan '
                                      'without any', 's')
    within_map: bool = quantity('whether neither robot nor object entered an obstacle')
    within_bounds: bool = quantity("whether the object rests within the scenario's bounds and, "
                                   'after a task, the robot is clear of it')
    path_length_ratio: float | None = quantity(
        'length of the path of the robot over that of the plan; None without one plan for the '
        'whole run', default=None)
    max_deviation: float | None = quantity(
        'largest distance of the object from its planned path; None likewise', 'm', default=None)


def measure(result: RunResult) -> Metrics | None:
    """
    Compute the metrics of a run from its tape.

    :return: the ``Metrics``; None where the goal was refused and nothing moved.
    """
    tape, plan, scenario = result.tape, result.plan, result.scenario
    if tape is None:
        return None
    objects = tape.poses('object')
    touching = in_contact(tape)[1:]
    steps = np.diff(tape['time'])
    length = float(distance_travelled(tape)[-1])
    corrections = correcting_pushes(result.history, result.duration, tape, scenario.final_goal)
    slip = np.abs(slip_speed(tape, scenario.true_robot.radius)[1:]) * steps
    return Metrics(
        position_error=result.position_error,
        heading_error=result.heading_error,
        time=result.duration,
        contact_time=float(steps[touching].sum()),
        robot_path_length=length,
        object_path_length=float(np.hypot(*np.diff(objects[:, :2], axis=0).T).sum()),
        slip=float(slip[touching].sum()),
        gap=float(tape['gap'][-1]),
        pushes=result.pushes,
        recoveries=result.recoveries,
        corrections=corrections.pushes,
        correction_time=(corrections.seconds / corrections.pushes if corrections.pushes
                         else math.nan),
        within_map=_is_within_map(result, tape),
        within_bounds=not _out_of_bounds(result, tape),
        path_length_ratio=None if plan is None else length / plan.path_length,
        max_deviation=None if plan is None else float(deviation(objects, plan)[0].max()))


def is_as_expected(result: RunResult) -> bool:
    """Tell whether a run ended as its scenario expects."""
    if result.scenario.expected == 'refused':
        return result.outcome in (Outcome.REFUSED, Outcome.FAILED) and not result.pushes
    if result.scenario.expected == 'too_heavy':
        return (result.outcome is Outcome.FAILED
                and BehaviorFailure.WHEELS_SPIN in result.codes)
    metrics = measure(result)
    return (metrics is not None and result.outcome is Outcome.DONE and metrics.within_bounds
            and metrics.within_map)


def bounds_missed(result: RunResult) -> list[str]:
    """
    List what is outside its bound after a run that was done, with its value and the bound.

    A law in open loop is done with its commands, wherever the object is.

    :return: sentences without a full stop; none for a run that ended otherwise.
    """
    tape = result.tape
    if tape is None or result.outcome is not Outcome.DONE:
        return []
    missed = _out_of_bounds(result, tape)
    if not _is_within_map(result, tape):
        missed.append('robot or object in an obstacle of the map')
    return missed


def verdict(result: RunResult) -> str:
    """Name the outcome of a run in a word: ``missed`` where it was done outside its bounds."""
    return 'missed' if bounds_missed(result) else result.outcome.value


def _out_of_bounds(result: RunResult, tape: Tape) -> list[str]:
    bounds, task = result.scenario.final_bounds, result.scenario.task
    violations: list[str] = []
    if not result.position_error <= bounds.position_error:
        violations.append(f'position error {1e3 * result.position_error:.1f} mm, bound '
                          f'{1e3 * bounds.position_error:.1f} mm')
    if not abs(result.heading_error) <= bounds.heading_error:
        violations.append(f'heading error {math.degrees(result.heading_error):+.2f} deg, bound '
                          f'{math.degrees(bounds.heading_error):.2f} deg')
    if task is not None and not tape['gap'][-1] >= task.drive.clearance:
        violations.append(f"robot clear of the object by {1e3 * tape['gap'][-1]:.0f} mm, bound "
                          f'{1e3 * task.drive.clearance:.0f} mm')
    return violations


def _is_within_map(result: RunResult, tape: Tape) -> bool:
    scenario = result.scenario
    occupancy_map = None if scenario.task is None else scenario.task.occupancy_map
    if occupancy_map is None:
        return True
    return bool(
        occupancy_map.robot_is_free(scenario.true_robot, tape.poses('robot'), 0.0)
        and occupancy_map.object_is_free(scenario.true_object, tape.poses('object'), -TOUCH))


def distance_travelled(tape: Tape) -> FloatArray:
    """Distance that the robot's centre has travelled since the start [m], shape (n,)."""
    steps = np.hypot(np.diff(tape['robot_x']), np.diff(tape['robot_y']))
    return np.concatenate([[0.0], np.cumsum(steps)])


def in_contact(tape: Tape) -> NDArray[np.bool_]:
    """Tell for each row whether robot and object touch, shape (n,)."""
    return tape['mode'] != SEPARATE


def slip_speed(tape: Tape, radius: float) -> FloatArray:
    """
    Velocity of the robot's surface along that of the object, at the contact [m/s], shape (n,).

    With vectors as complex numbers in axes whose real one is the contact normal, the surface of
    the robot moves at ``Im(v_robot) + radius omega_robot`` along the tangent, and the point of
    the object at ``Im(v_object) + Re(arm) omega_object``.

    :param radius: of the robot [m].
    """
    heading, normal = tape['robot_theta'], tape['normal']
    to_contact_axes = np.exp(-1j * normal)
    robot = ((tape['robot_v_x'] + 1j * tape['robot_v_y']) * np.exp(1j * heading)
             * to_contact_axes)
    arm = ((tape['contact_x'] - tape['object_x'])
           + 1j * (tape['contact_y'] - tape['object_y'])) * to_contact_axes
    body = (tape['object_v_x'] + 1j * tape['object_v_y']) * to_contact_axes
    surface = robot.imag + radius * tape['robot_omega']
    return surface - (body.imag + tape['object_omega'] * arm.real)


def deviation(poses: FloatArray, plan: PushTrajectory) -> tuple[FloatArray, FloatArray]:
    """
    Compare poses of the object with the nearest point of its planned path.

    :param poses: shape (n, 3).
    :return: (distance [m], orientation minus the planned one [rad]), each of shape (n,).
    """
    start, step = plan.object_poses[:-1], np.diff(plan.object_poses, axis=0)
    squared = np.maximum((step[:, :2] ** 2).sum(axis=1), MIN_SQUARED_STEP)
    distances: list[float] = []
    angles: list[float] = []
    for pose in poses:
        along = np.clip(((pose[:2] - start[:, :2]) * step[:, :2]).sum(axis=1) / squared, 0.0, 1.0)
        nearest = start + along[:, None] * step
        distance = np.hypot(*(pose[:2] - nearest[:, :2]).T)
        best = int(np.argmin(distance))
        distances.append(distance[best])
        angles.append(math.remainder(pose[2] - nearest[best, 2], 2 * math.pi))
    return np.array(distances), np.array(angles)


def force_angle(tape: Tape) -> FloatArray:
    """Angle of the contact force from the contact normal [rad], shape (n,); nan out of contact."""
    normal, tangential = tape['force_n'], tape['force_t']
    return np.where(normal > 0.0, np.arctan2(tangential, np.where(normal > 0.0, normal, 1.0)),
                    np.nan)
