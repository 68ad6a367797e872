"""Any goal, short ways: the quickest chain of pushes from here, and the plan of its first."""

from push_drive.settings import DriveSettings
from push_model.geometry import Pose
from push_planner.problem import PlanningFailed, refuse_fence
from push_planner.question import Question
from push_planner.refusals import refuse_arrived
from push_planner.settings import PlannerSettings
from push_planner.task_settings import TaskSettings


def plan_task(obj, robot, object_pose, robot_pose, goal, settings=None, drive=None, task=None,
              workspace=None):
    """
    Find the quickest chain of pushes to the goal, the robot's ways included.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object in the world.
    :param robot_pose: ``Pose`` of the robot in the world, anywhere.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param drive: ``DriveSettings``, or None for the defaults.
    :param task: ``TaskSettings``, or None for the defaults.
    :param workspace: ``Workspace`` that robot and object keep to; None for open floor.
    :return: ``TaskPlan``.
    :raises PlanningFailed: with the reason.
    """
    refuse_fence(robot)
    poses = {'object pose': object_pose, 'robot pose': robot_pose, 'goal': goal}
    for name, pose in poses.items():
        if not Pose(*pose).is_finite():
            raise PlanningFailed(f'the {name} is not finite: {tuple(pose)}')
    settings = settings or PlannerSettings()
    object_pose, robot_pose, goal = (Pose(*map(float, pose)) for pose in poses.values())
    refuse_arrived(object_pose, goal, settings)
    return Question(obj, robot, object_pose, robot_pose, goal, settings, drive or DriveSettings(),
                    task or TaskSettings(), workspace).answer()
