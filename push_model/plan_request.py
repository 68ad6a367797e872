"""Request for a plan: what a supervisor asks of the planner."""

from typing import NamedTuple

from push_model.geometry import Pose
from push_model.parameters import PushedObject


class PlanRequest(NamedTuple):
    """
    Request for a plan that brings an object at rest to a goal.

    :param object_pose: ``Pose`` of the object, at rest.
    :param robot_pose: ``Pose`` of the robot, anywhere.
    :param goal: goal ``Pose`` of the object.
    :param obj: the ``PushedObject`` as known by now.
    :param cone_fraction: fraction of the planner's friction cone that the plan may use; below 1
        after plans that brought the object no nearer to its goal.
    """

    object_pose: Pose
    robot_pose: Pose
    goal: Pose
    obj: PushedObject
    cone_fraction: float = 1.0
