"""What a task is judged by: where the object rests, what that took, what was touched."""

import dataclasses

import numpy as np
from push_model.quantity import quantity
from push_scenario.metrics import in_contact, robot_way
from push_scenario.task import Task


@dataclasses.dataclass(frozen=True)
class TaskMetrics:
    """Figures of one task; positions are those of the object frame."""

    position_error: float = quantity('final distance from the goal', 'm')
    heading_error: float = quantity('final orientation minus that of the goal', 'rad')
    time: float = quantity('time until the task ended', 's')
    contact_time: float = quantity('time in contact', 's')
    single_time: float = quantity('time that the best single push would have taken; infinite '
                                  'where there is none, nan where it is not known', 's')
    robot_way: float = quantity('way of the robot', 'm')
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
        robot_way=float(robot_way(tape)[-1]),
        object_way=float(np.hypot(*np.diff(objects[:, :2], axis=0).T).sum()),
        pushes=result.pushes,
        recoveries=result.recoveries,
        gap=gap,
        within_map=task.workspace is None or (
            task.workspace.robot_is_free(scenario.robot_truth, tape.poses('robot'), 0.0)
            and task.workspace.object_is_free(scenario.truth, objects, 0.0)),
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
