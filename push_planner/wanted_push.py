"""What a supervisor wants: the first push of a chain, the more careful the less bold it is."""

import dataclasses
import functools

from push_model.geometry import distance
from push_planner.problem import PlanningFailed
from push_planner.task import plan_task

SHORT, DETOUR = 1.0, 1.5


def plan_wanted(wanted, robot, settings, drive, task=None, workspace=None):
    """
    Answer a supervisor.

    :param wanted: ``push_control.task_status.Wanted``: poses, goal, object as learnt, boldness.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param task: ``TaskSettings``, or None for the defaults.
    :param workspace: the ``Workspace``, or None for open floor.
    :return: ``push_planner.question.TaskPlan``.
    :raises PlanningFailed: with the reason.
    """
    ask = functools.partial(plan_task, wanted.obj, robot, wanted.object_pose, wanted.robot_pose,
                            wanted.goal, drive=drive, task=task, workspace=workspace)
    if wanted.boldness < 1.0:
        # Long turns miss most: short pushes that come to the same are asked for first.
        far = distance(wanted.object_pose, wanted.goal)
        careful = dataclasses.replace(
            settings, cone_margin=wanted.boldness * settings.cone_margin,
            max_path_length=min(settings.max_path_length, SHORT + DETOUR * far))
        try:
            return ask(careful)
        except PlanningFailed:
            pass
    return ask(settings)
