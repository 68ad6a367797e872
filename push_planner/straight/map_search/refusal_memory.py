"""Memory of refusals: a question that has not changed is answered without another search."""

import collections
from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanRequest
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings

# Distance and rotation within which a pose is the same [m, rad], and part by which a deviation may
# be less; chosen: noise of an average, far less than decides whether there is room.
SAME_DISTANCE, SAME_ROTATION, SAME_DEVIATION = 2e-3, 2e-3, 0.05
# Refusals that are remembered; chosen: of the few tasks of a process.
COUNT = 4


class Question(NamedTuple):
    """
    All that a refusal depends on.

    :param request: the ``PlanRequest``.
    :param robot: the ``RoundRobot``.
    :param settings: ``PlannerSettings``.
    :param drive: ``DriveSettings``.
    :param occupancy_map: the ``OccupancyMap``.
    """

    request: PlanRequest
    robot: RoundRobot
    settings: PlannerSettings
    drive: DriveSettings
    occupancy_map: OccupancyMap

    def is_like(self, other: 'Question') -> bool:
        """Tell whether another question has the same answer."""
        return ((self.robot, self.settings, self.drive)
                == (other.robot, other.settings, other.drive)
                and _are_alike(self.request, other.request)
                and _are_same_floor(self.occupancy_map, other.occupancy_map))


class RefusalMemory:
    """Remembers the last refusals."""

    def __init__(self) -> None:
        """Start without any."""
        self._refusals: collections.deque[tuple[Question, PlanningFailed]] = collections.deque(
            maxlen=COUNT)

    def add(self, question: Question, refusal: PlanningFailed) -> None:
        """Remember a refusal."""
        self._refusals.append((question, refusal))

    def recall(self, question: Question) -> PlanningFailed | None:
        """Return the refusal of a question that has not changed; None where it has."""
        for asked, refusal in self._refusals:
            if question.is_like(asked):
                return PlanningFailed(refusal.code, refusal.reason, refusal.report,
                                      refusal.marks)
        return None


def _are_alike(one: PlanRequest, other: PlanRequest) -> bool:
    """Compare two requests; what was learned of friction meanwhile frees no obstacle."""
    return (all(_is_same(getattr(one, name), getattr(other, name))
                for name in ('object_pose', 'robot_pose', 'goal'))
            and (one.obj.outline, one.obj.radius) == (other.obj.outline, other.obj.radius)
            and one.tolerances == other.tolerances and one.cone_fraction == other.cone_fraction
            and all(abs(getattr(one, name) - getattr(other, name))
                    <= SAME_DEVIATION * getattr(other, name)
                    for name in ('robot_deviation', 'odometry_slope', 'odometry_drift')))


def _is_same(one: Pose, other: Pose) -> bool:
    return (distance(one, other) <= SAME_DISTANCE
            and abs(wrap_angle(one.theta - other.theta)) <= SAME_ROTATION)


def _are_same_floor(one: OccupancyMap, other: OccupancyMap) -> bool:
    return one is other or (
        one.resolution == other.resolution and _is_same(one.origin, other.origin)
        and np.array_equal(one.occupied, other.occupied))
