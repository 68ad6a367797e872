"""
Supervisor of a room: which object is moved next, and what became of each.

Its caller measures where all objects are, asks for the next move, makes it by the pushes of a
single object, and tells how that ended:

    while (move := supervisor.next_move(scene, time)) is not None:
        supervisor.end_move(move, made(move))

After each move the order is planned from where all objects are then. A move that has failed does
not come next, unless nothing else can be moved; an object whose moves fail too often is given up,
or no longer moved aside, and the others go on.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
import enum
import math
from typing import NamedTuple

from push_model.events import AnyReport, ObjectFailure, Report
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import GoalTolerances
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.rearrangement.order import plan_order
from push_planner.rearrangement.problem import Move, NamedObject, OrderPlan, Rearrangement

# Moves of one object that may fail, to its goal and likewise aside, and moves in all for each
# object; chosen.
MAX_FAILURES = 3
MAX_MOVES_PER_OBJECT = 4

OrderPlanner = Callable[[Rearrangement], OrderPlan]


class ObjectGoal(NamedTuple):
    """
    An object, and where it is to stand.

    :param name: by which it is told from others.
    :param obj: the ``PushedObject``.
    :param pose: goal ``Pose`` in the world; None where it may stand anywhere.
    :param tolerances: ``GoalTolerances``.
    """

    name: str
    obj: PushedObject
    pose: Pose | None = None
    tolerances: GoalTolerances = GoalTolerances()

    def seen_at(self, pose: Pose, *, has_goal: bool) -> NamedObject:
        """
        Describe it for the order.

        :param pose: where it is measured.
        :param has_goal: whether it is still to be brought to its goal.
        """
        return NamedObject(self.name, self.obj, pose, self.pose if has_goal else None,
                           self.tolerances)


class MeasuredScene(NamedTuple):
    """
    Where everything is, at rest.

    :param poses: ``Pose`` of each object in the world, by name.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param occupancy_map: ``OccupancyMap`` of the floor without the objects.
    """

    poses: Mapping[str, Pose]
    robot_pose: Pose
    occupancy_map: OccupancyMap


class ObjectState(enum.Enum):
    """State of an object; messages carry the number in this list, from 0 on: add at its end."""

    WAITING = 'waits for its move'
    MOVING = 'is moved to its goal'
    MOVING_ASIDE = 'is moved out of the way'
    AT_GOAL = 'is at its goal'
    WITHOUT_GOAL = 'may stand anywhere'
    GIVEN_UP = 'is given up'


class ObjectStatus(NamedTuple):
    """
    What is known of an object.

    :param state: the ``ObjectState``.
    :param failure: ``Report`` of why it does not get to its goal; None where it does, or may.
    """

    state: ObjectState
    failure: Report[ObjectFailure] | None = None


class TidySupervisor:
    """
    Brings several objects to their goals, as many as possible or all.

    ``plan``: the ``OrderPlan`` of the last measurement. ``moves``: number of moves made.

    :param goals: ``ObjectGoal`` of each object that is there.
    :param robot: the ``RoundRobot``.
    :param drive: ``DriveSettings``.
    :param find_order: plans the order.
    :param needs_all: whether nothing is moved any more where one object cannot get to its goal.
    :param time_limit: time from which on no move begins [s].
    :raises ValueError: where two objects have one name.
    """

    def __init__(self, goals: Sequence[ObjectGoal], robot: RoundRobot,
                 drive: DriveSettings = DriveSettings(), *,
                 find_order: OrderPlanner = plan_order, needs_all: bool = False,
                 time_limit: float = math.inf) -> None:
        self._goals = {goal.name: goal for goal in goals}
        if len(self._goals) < len(goals):
            raise ValueError(f'goals: got the names {[goal.name for goal in goals]}, expected '
                             'different ones')
        self._robot = robot
        self._drive = drive
        self._find_order = find_order
        self._needs_all = needs_all
        self._time_limit = time_limit
        self._poses: dict[str, Pose] = {}
        self._move: Move | None = None
        self._end: Report[ObjectFailure] | None = None
        # By name, and whether the moves were to a temporary place.
        self._failed: Counter[tuple[str, bool]] = Counter()
        self._refused: frozenset[tuple[str, Pose]] = frozenset()
        self._given_up: dict[str, Report[ObjectFailure]] = {}
        self.moves = 0
        self.plan = OrderPlan((), {}, 0.0, True, 0)

    @property
    def goal_count(self) -> int:
        """Number of objects that have a goal."""
        return sum(goal.pose is not None for goal in self._goals.values())

    @property
    def placed_count(self) -> int:
        """Number of objects that were last measured at their goals."""
        return sum(status.state is ObjectState.AT_GOAL for status in self.statuses().values())

    def next_move(self, scene: MeasuredScene, time: float = 0.0) -> Move | None:
        """
        Plan the order from where all are, and return its first move; None at the end.

        :param scene: the ``MeasuredScene``.
        :param time: since the start [s].
        """
        self._poses = dict(scene.poses)
        self._move = None
        self.plan = self._plan(scene)
        if not self.plan.moves and self._refused:
            # Nothing else can be moved: what has failed is repeated.
            self._refused = frozenset()
            self.plan = self._plan(scene)
        if self._end is None:
            self._end = self._reason_to_end(time)
        if self._end is None and self.plan.moves:
            self._move = self.plan.moves[0]
        return self._move

    def end_move(self, move: Move, failure: AnyReport | str | None) -> None:
        """
        Take note of how a move ended.

        :param failure: why its pushes failed; None where they did not.
        """
        self.moves += 1
        self._move = None
        if failure is None:
            self._refused = frozenset()
            return
        self._refused |= {(move.name, move.end)}
        self._failed[move.name, move.is_temporary] += 1
        if not move.is_temporary and self._failed[move.name, False] >= MAX_FAILURES:
            self._given_up[move.name] = ObjectFailure.PUSHES_FAILED.report(reason=failure)

    def cancel(self, cause: AnyReport | str) -> None:
        """
        Make no more moves.

        :param cause: why.
        """
        self._move = None
        self._end = ObjectFailure.NOT_MOVED.report(reason=cause)

    def statuses(self) -> dict[str, ObjectStatus]:
        """Return the ``ObjectStatus`` of each object, by name, as last measured."""
        return {name: self._status(goal) for name, goal in self._goals.items()}

    def failures(self) -> dict[str, Report[ObjectFailure]]:
        """Return why objects do not get to their goals, by name."""
        return {name: status.failure for name, status in self.statuses().items()
                if status.failure is not None}

    def _plan(self, scene: MeasuredScene) -> OrderPlan:
        objects = tuple(
            goal.seen_at(self._poses[name], has_goal=name not in self._given_up)
            for name, goal in self._goals.items())
        fixed = frozenset(name for (name, is_temporary), count in self._failed.items()
                          if is_temporary and count >= MAX_FAILURES)
        return self._find_order(Rearrangement(
            objects, self._robot, scene.robot_pose, scene.occupancy_map, self._drive,
            self._refused, fixed))

    def _status(self, goal: ObjectGoal) -> ObjectStatus:
        move = self._move
        if move is not None and move.name == goal.name:
            return ObjectStatus(ObjectState.MOVING_ASIDE if move.is_temporary
                                else ObjectState.MOVING)
        if goal.pose is None:
            return ObjectStatus(ObjectState.WITHOUT_GOAL)
        pose = self._poses.get(goal.name)
        if pose is not None and goal.tolerances.contain(pose, goal.pose):
            return ObjectStatus(ObjectState.AT_GOAL)
        failure = (self._given_up.get(goal.name) or self.plan.refusals.get(goal.name)
                   or self._end)
        if failure is None:
            return ObjectStatus(ObjectState.WAITING)
        return ObjectStatus(ObjectState.GIVEN_UP, failure)

    def _reason_to_end(self, time: float) -> Report[ObjectFailure] | None:
        """Say why no move begins although there are some; None where one may."""
        refused = sorted({*self.plan.refusals, *self._given_up})
        if self._needs_all and refused:
            return ObjectFailure.NOT_ALL.report(others=' and '.join(refused))
        if time >= self._time_limit:
            return ObjectFailure.NOT_MOVED.report(reason='the time limit has passed')
        if self.moves >= MAX_MOVES_PER_OBJECT * len(self._goals):
            return ObjectFailure.NOT_MOVED.report(
                reason=f'{self.moves} moves were made, more would not help')
        return None
