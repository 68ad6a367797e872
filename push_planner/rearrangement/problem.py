"""What is to be rearranged: objects by name, where they stand and where they are to stand."""

from collections.abc import Mapping
from typing import NamedTuple

from push_model.events import ObjectFailure, Report
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import GoalTolerances
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings


class NamedObject(NamedTuple):
    """
    An object and its goal.

    :param name: by which it is told from others.
    :param obj: the ``PushedObject``.
    :param pose: ``Pose`` in the world.
    :param goal: goal ``Pose``; None where it may stand anywhere.
    :param tolerances: ``GoalTolerances``.
    """

    name: str
    obj: PushedObject
    pose: Pose
    goal: Pose | None = None
    tolerances: GoalTolerances = GoalTolerances()

    @property
    def is_at_goal(self) -> bool:
        """Whether it need not be moved."""
        return self.goal is None or self.tolerances.contain(self.pose, self.goal)


class Rearrangement(NamedTuple):
    """
    Objects to bring to their goals.

    :param objects: of different names.
    :param robot: the ``RoundRobot``.
    :param robot_pose: its ``Pose`` in the world.
    :param occupancy_map: ``OccupancyMap`` of the floor without the objects.
    :param drive: ``DriveSettings``.
    :param refused_moves: (name, end) of moves that turned out to be impossible from where all
        stand now: none of them comes first.
    :param fixed: names of objects that no move brings aside.
    """

    objects: tuple[NamedObject, ...]
    robot: RoundRobot
    robot_pose: Pose
    occupancy_map: OccupancyMap
    drive: DriveSettings = DriveSettings()
    refused_moves: frozenset[tuple[str, Pose]] = frozenset()
    fixed: frozenset[str] = frozenset()


class Move(NamedTuple):
    """
    Move of one object while all others stand.

    :param name: of the object.
    :param start: ``Pose`` in the world.
    :param end: ``Pose`` in the world.
    :param is_temporary: whether the end is a temporary place, out of the way of others.
    :param time: expected, with the robot's way to the object [s].
    :param path: of the object's middle, shape (n, 2), in the world [m].
    """

    name: str
    start: Pose
    end: Pose
    is_temporary: bool
    time: float
    path: FloatArray


class OrderPlan(NamedTuple):
    """
    Moves in their order.

    :param moves: of each ``Move``.
    :param refusals: by name, why an object gets to no goal.
    :param time: expected time of all moves [s].
    :param is_complete: whether the search compared all orders before its budget was spent.
    :param work: grid points that the search visited.
    """

    moves: tuple[Move, ...]
    refusals: Mapping[str, Report[ObjectFailure]]
    time: float
    is_complete: bool
    work: int
