"""Request for a plan: what a supervisor asks of the planner."""

from typing import NamedTuple

from push_model.geometry import Pose
from push_model.parameters import PushedObject


class PlanRequest(NamedTuple):
    """
    A plan that is wanted.

    :param object_pose: ``Pose`` of the object, at rest.
    :param robot_pose: ``Pose`` of the robot, anywhere.
    :param goal: ``Pose`` wanted for the object in the end.
    :param obj: the ``PushedObject`` as known by now.
    :param cone_fraction: share of the planner's friction cone that the plan should use; below 1 where
        plans have brought the object no nearer.
    """

    object_pose: Pose
    robot_pose: Pose
    goal: Pose
    obj: PushedObject
    cone_fraction: float = 1.0
