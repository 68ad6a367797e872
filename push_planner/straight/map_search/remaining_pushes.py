"""Remaining pushes of a chain, which is continued where a push has ended as planned."""

from typing import NamedTuple

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_planner.straight.map_search.pushes import FIRST, LATER, Pushes
from push_planner.straight.map_search.search import SearchPush, SearchResult

# Distance and rotation from the plan within which a push has ended as planned, the first at least
# and else a standard deviation of it [m, rad]; chosen: what the next push corrects in passing.
MIN_DISTANCE, MAX_ROTATION = 0.03, 0.15
# A goal that has moved by less is the same [m, rad]; chosen: below the tolerances of a goal.
SAME_GOAL = 1e-3


class RemainingPush(NamedTuple):
    """
    A later push of a chain.

    :param primitive: its index in the table.
    :param start: ``Pose`` of the object before it, as expected, in the world.
    :param end: likewise after it.
    :param length: driven length [m].
    :param remaining_time: that the task takes after it [s].
    :param deviation: standard deviation of the object before it [m].
    :param robot_start: ``Pose`` of the robot at first contact, heading as it moves, in the world.
    """

    primitive: int
    start: Pose
    end: Pose
    length: float
    remaining_time: float
    deviation: float
    robot_start: Pose

    @property
    def robot_end(self) -> Pose:
        """``Pose`` of the robot after it, about."""
        return self.robot_start @ Pose(self.length, 0.0, 0.0)


class RemainingPushes(NamedTuple):
    """
    Remaining pushes of a chain.

    :param goal: ``Pose`` that it leads to, in the world.
    :param pushes: ``RemainingPush`` of each.
    """

    goal: Pose
    pushes: tuple[RemainingPush, ...] = ()

    def continues_from(self, pose: Pose, goal: Pose) -> bool:
        """
        Tell whether the first of them may follow; not the last one, which ends at the goal.

        :param pose: of the object.
        :param goal: of the object.
        """
        if not self.pushes or not _is_near(self.goal, goal, SAME_GOAL, SAME_GOAL):
            return False
        first = self.pushes[0]
        if _is_near(first.end, goal, SAME_GOAL, SAME_GOAL):
            return False
        return _is_near(first.start, pose, max(MIN_DISTANCE, first.deviation), MAX_ROTATION)


def pushes_after_first(result: SearchResult, pushes: Pushes, origin: Pose,
                       goal: Pose) -> RemainingPushes:
    """
    List all pushes of a chain but the first.

    :param pushes: ``Pushes`` that it consists of.
    :param origin: ``Pose`` of the map in the world.
    :param goal: ``Pose`` in the world.
    """
    later = tuple(
        RemainingPush(int(pushes.primitives[push.push_index]), origin @ push.start,
                      origin @ push.end, push.length, result.cost - push.cost,
                      _deviation(pushes, before),
                      origin @ push.start @ Pose(*pushes.starts[push.push_index].tolist()))
        for before, push in zip(result.pushes, result.pushes[1:]))
    return RemainingPushes(goal, later)


def expected_end(pushes: Pushes, index: int, length: float, start: Pose) -> Pose:
    """
    Find where a first push ends, as expected.

    :param index: among them.
    :param length: driven length, one of theirs [m].
    """
    return start @ Pose(*pushes.means[FIRST, index, _step(pushes, length)].tolist())


def is_as_expected(first: RemainingPush, end: Pose) -> bool:
    """
    Tell whether a push from where the object is ends where the remaining ones start.

    :param end: ``Pose`` of the object after it.
    """
    return _is_near(first.end, end, 2.0 * MIN_DISTANCE, MAX_ROTATION)


def _deviation(pushes: Pushes, push: SearchPush) -> float:
    return float(pushes.stds[LATER, push.push_index, _step(pushes, push.length)])


def _step(pushes: Pushes, length: float) -> int:
    return int(np.argmin(np.abs(pushes.lengths - length)))


def _is_near(one: Pose, other: Pose, far: float, rotated: float) -> bool:
    return distance(one, other) <= far and abs(wrap_angle(one.theta - other.theta)) <= rotated
