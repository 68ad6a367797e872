"""
Find the order in which objects are brought to their goals.

Branch and bound over orders, depth first: the move with the least time comes first, so that the
first order is there at once, and better ones replace it until the budget is spent. The bound of
what remains is the time to push each object alone. Where no object gets to its goal, one that
stands in the way of another is moved to a temporary place: that breaks circles, and frees doors.
"""

import math
from typing import NamedTuple

from push_model.events import ObjectFailure, Report
from push_model.geometry import FloatArray, Pose
from push_planner.rearrangement.early_refusals import early_refusals
from push_planner.rearrangement.moves import MoveEvaluator, MoveOption, Regions
from push_planner.rearrangement.object_floor import descend
from push_planner.rearrangement.placements import GOAL, Layout, Placements, START
from push_planner.rearrangement.problem import (
    Move, NamedObject, OrderPlan, Rearrangement)
from push_planner.rearrangement.temporary_places import temporary_places

# Grid points that a search visits, and while its best order leaves objects out; chosen: 0.3 to
# 0.5 s of CPU time, and 2 to 5 s.
MAX_WORK, MAX_WORK_FOR_ALL = 6_000_000, 60_000_000
# Temporary places that an order may use for each object; chosen: more than one is rare.
MAX_TEMPORARY = 2


class _Step(NamedTuple):
    """
    Move of an order.

    :param moved: number of the object.
    :param place: where to.
    :param layout: of all objects before it.
    :param regions: in which the robot may be before it.
    :param time: of it [s].
    """

    moved: int
    place: int
    layout: Layout
    regions: Regions
    time: float


class _Node(NamedTuple):
    """
    Objects, and how they got there.

    :param layout: of all objects.
    :param regions: in which the robot may be.
    :param steps: ``_Step`` of each move so far.
    :param time: of them [s].
    """

    layout: Layout
    regions: Regions
    steps: tuple[_Step, ...]
    time: float

    @property
    def last(self) -> tuple[int, int] | None:
        """Object and place of the last move."""
        return (self.steps[-1].moved, self.steps[-1].place) if self.steps else None

    @property
    def moved_aside(self) -> int | None:
        """Object that the last move has brought to a temporary place; None where it did not."""
        return self.steps[-1].moved if self.steps and self.steps[-1].place > GOAL else None

    def after(self, index: int, place: int, option: MoveOption) -> '_Node':
        """Return the node to which a move leads."""
        step = _Step(index, place, self.layout, self.regions, option.time)
        return _Node(option.layout, option.regions, (*self.steps, step), self.time + option.time)


def plan_order(problem: Rearrangement, max_work: int = MAX_WORK) -> OrderPlan:
    """
    Find the order of least expected time in which most objects get to their goals.

    :param problem: the ``Rearrangement``; the order of its objects has no effect.
    :param max_work: grid points after which the search ends if its best order has all objects,
        also of 0; one that leaves objects out it searches on for ``MAX_WORK_FOR_ALL``.
    :raises ValueError: where two objects have one name.
    """
    objects = sorted(problem.objects, key=lambda item: item.name)
    names = [item.name for item in objects]
    if len(set(names)) < len(names):
        raise ValueError(f'objects: got the names {names}, expected different ones')
    refusals = early_refusals(objects, problem.occupancy_map)
    objects = [item._replace(goal=None) if item.name in refusals else item for item in objects]
    search = _OrderSearch(problem._replace(objects=tuple(objects)), max_work)
    return search.plan(refusals)


class _OrderSearch:
    """Search of one problem."""

    def __init__(self, problem: Rearrangement, max_work: int) -> None:
        self._problem = problem
        self._max_work = max_work
        self._placements = Placements(problem.objects, problem.robot, problem.drive,
                                      problem.occupancy_map)
        self._moves = MoveEvaluator(self._placements, problem.robot,
                                    problem.occupancy_map.origin.inverse() @ problem.robot_pose,
                                    problem.drive)
        self._best: _Node | None = None
        self._times: dict[tuple[Layout, tuple[int, int] | None], float] = {}
        self._has_order = False
        self._is_complete = True
        self._lacks_place: dict[int, list[int]] = {}

    def plan(self, refusals: dict[str, Report[ObjectFailure]]) -> OrderPlan:
        """
        Search, and lay out the best order.

        :param refusals: of objects that are known to get to no goal.
        """
        refusals = dict(refusals)
        bodies = self._placements.bodies
        for index, body in enumerate(bodies):
            if not body.is_placed(START) and math.isinf(self._moves.least_time(index, START)):
                refusals[body.name] = ObjectFailure.TOO_NARROW.report()
                bodies[index] = body._replace(has_goal=False)
        layout = (START,) * len(bodies)
        self._extend(_Node(layout, self._moves.first_regions(layout), (), 0.0))
        best = self._best
        if best is None:
            raise ValueError('plan: got no order, expected at least that without moves')
        for index in self._unplaced(best.layout):
            refusals[bodies[index].name] = self._refusal(best, index)
        return OrderPlan(tuple(self._lay_out(step) for step in best.steps), refusals, best.time,
                         self._is_complete, self._placements.floor.work)

    def _unplaced(self, layout: Layout) -> list[int]:
        return [index for index, (body, place) in enumerate(zip(self._placements.bodies, layout))
                if not body.is_placed(place)]

    def _extend(self, node: _Node) -> None:
        """Search all orders that begin as a node does."""
        unplaced = self._unplaced(node.layout)
        self._note(node, unplaced)
        if not unplaced or self._is_dominated(node, unplaced):
            return
        count = len(self._times)
        # What has just been moved aside was in the way of others, which come first.
        aside = node.moved_aside
        if not (self._move_to_goals(node, [index for index in unplaced if index != aside])
                or self._move_to_goals(node, [index for index in unplaced if index == aside])):
            self._move_aside(node, unplaced)
        # Nothing more could be moved.
        self._has_order |= len(self._times) == count

    def _move_to_goals(self, node: _Node, indices: list[int]) -> bool:
        """Move each of some objects to its goal; return whether one can be moved."""
        has_moved = False
        for index in self._sorted(node, indices):
            option = self._evaluate(node, index, GOAL)
            if option is not None:
                has_moved = True
                self._extend(node.after(index, GOAL, option))
        return has_moved

    def _note(self, node: _Node, unplaced: list[int]) -> None:
        """Keep the node where more objects are at their goals, or sooner, than in the best."""
        best = self._best
        if best is None or ((len(unplaced), node.time)
                            < (len(self._unplaced(best.layout)), best.time)):
            self._best = node
        self._has_order |= not unplaced

    def _is_dominated(self, node: _Node, unplaced: list[int]) -> bool:
        """Tell whether no order that begins as a node does can be the best, or be searched."""
        if self._is_spent:
            self._is_complete = False
            return True
        best = self._best
        bound = node.time + sum(self._moves.least_time(index, node.layout[index])
                                for index in unplaced)
        if best is not None and not self._unplaced(best.layout) and bound >= best.time:
            return True
        key = node.layout, node.last
        if self._times.get(key, math.inf) <= node.time:
            return True
        self._times[key] = node.time
        return False

    @property
    def _is_spent(self) -> bool:
        """Whether there is an order, and no budget for a better one, or for more objects."""
        best, work = self._best, self._placements.floor.work
        if best is None or not self._has_order:
            return False
        has_all = not self._unplaced(best.layout)
        return work > (self._max_work if has_all else max(self._max_work, MAX_WORK_FOR_ALL))

    def _sorted(self, node: _Node, indices: list[int]) -> list[int]:
        """Sort objects by the least time of their moves."""
        return sorted(indices, key=lambda index: (
            self._moves.transit_time(index, node.layout[index], node.last)
            + self._moves.least_time(index, node.layout[index])))

    def _evaluate(self, node: _Node, index: int, place: int) -> MoveOption | None:
        problem, name = self._problem, self._placements.bodies[index].name
        if not node.steps and (name, self._in_world(index, place)) in problem.refused_moves:
            return None
        return self._moves.evaluate(node.layout, node.regions, index, place, node.last)

    def _move_aside(self, node: _Node, unplaced: list[int]) -> None:
        """Move what stands in the way to temporary places."""
        asides = [step.moved for step in node.steps if step.place > GOAL]
        bodies = self._placements.bodies
        tried: set[int] = set()
        for index in self._sorted(node, unplaced):
            for other in self._obstructing(node, index):
                if self._is_spent:
                    self._is_complete = False
                    return
                if (other in tried or asides.count(other) == MAX_TEMPORARY
                        or bodies[other].name in self._problem.fixed):
                    continue
                tried.add(other)
                if not self._try_places(node, other, unplaced):
                    self._lacks_place.setdefault(index, []).append(other)

    def _try_places(self, node: _Node, index: int, unplaced: list[int]) -> bool:
        """Move an object to temporary places; return whether there is one."""
        if not self._moves.is_reached(node.layout, node.regions, index):
            return True
        lengths = self._moves.grid(node.layout, node.regions, index, node.layout[index])
        paths = [self._path(other, node.layout[other]) for other in unplaced if other != index]
        poses = temporary_places(self._placements, node.layout, index, lengths, paths)
        for pose in poses:
            place = self._placements.add_place(index, pose)
            option = self._evaluate(node, index, place)
            if option is not None:
                self._extend(node.after(index, place, option))
        return bool(poses)

    def _obstructing(self, node: _Node, index: int) -> list[int]:
        """
        List what stands at the goal of an object, on its way, or on the robot's way to it.

        What stands at its goal comes first, as there is no way round it; then the nearest to the
        robot.
        """
        placements, layout = self._placements, node.layout
        if not self._moves.is_reached(layout, node.regions, index):
            path = self._moves.robot_path(index, layout[index], node.last)
            needed = placements.robot_needed
        else:
            path = self._path(index, layout[index])
            needed, _ = placements.needed(index)
        at_goal = self._moves.overlapped(layout, index, GOAL)
        others = set(at_goal)
        for other, place in enumerate(layout):
            if other != index and (placements.floor.values_at(
                    placements.field(other, place), path).min() < needed):
                others.add(other)
        return sorted(others, key=lambda other: (other not in at_goal, self._moves.transit_time(
            other, layout[other], node.last)))

    def _path(self, index: int, place: int) -> FloatArray:
        """Return the way of an object from a place to its goal past walls alone."""
        return descend(self._moves.goal_grid(index), self._placements.pose(index, place),
                       self._placements.pose(index, GOAL))

    def _refusal(self, node: _Node, index: int) -> Report[ObjectFailure]:
        """Say why an object is not at its goal in the best order."""
        if not self._is_complete:
            return ObjectFailure.SEARCH_LIMIT.report()
        others = self._obstructing(node, index)
        if not others:
            return ObjectFailure.NO_ROOM_FOR_ROBOT.report()
        names = ' and '.join(self._placements.bodies[other].name for other in others)
        if set(others) & set(self._lacks_place.get(index, ())):
            return ObjectFailure.NO_TEMPORARY_PLACE.report(others=names)
        return ObjectFailure.BLOCKED.report(others=names)

    def _lay_out(self, step: _Step) -> Move:
        start = self._placements.pose(step.moved, step.layout[step.moved])
        end = self._placements.pose(step.moved, step.place)
        path = descend(self._moves.grid(step.layout, step.regions, step.moved, step.place), start,
                       end)
        body = self._placements.bodies[step.moved]
        return Move(body.name, self._in_world(step.moved, step.layout[step.moved]),
                    self._in_world(step.moved, step.place), step.place > GOAL, step.time,
                    self._problem.occupancy_map.from_map(path))

    def _in_world(self, index: int, place: int) -> Pose:
        """Return the pose of an object at a place in the world; at a goal exactly the stated."""
        item: NamedObject = self._problem.objects[index]
        if place == START:
            return item.pose
        if place == GOAL and item.goal is not None:
            return item.goal
        return self._problem.occupancy_map.origin @ self._placements.pose(index, place)
