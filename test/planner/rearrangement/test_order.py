"""Orders of several objects: laws, an exhaustive search, and a check of ways by other geometry."""

import itertools
import math

from helpers.maps import walled_floor, walled_room
from helpers.objects import bin_, box
import numpy as np
from push_model.events import ObjectFailure
from push_model.files.parameter_files import read_object
from push_model.geometry import BoolArray, boundary_point, distance, Pose
from push_model.parameters import RoundRobot
from push_navigation.floor import make_floor
from push_navigation.occupancy_map import OccupancyMap
from push_planner.rearrangement.moves import MoveEvaluator
from push_planner.rearrangement.order import plan_order
from push_planner.rearrangement.placements import GOAL, Placements, START
from push_planner.rearrangement.problem import (
    NamedObject, OrderPlan, Rearrangement)
from push_planner.straight.map_search.object_distance import narrowest_passage
import pytest

ROBOT = RoundRobot(0.17)
ROBOT_POSE = Pose(0.0, -1.6, 0.0)
LEFT, RIGHT = Pose(-1.13, 0.12, 0.2), Pose(1.02, 0.31, 0.7)


def rearrangement(*objects: NamedObject, floor: OccupancyMap | None = None,
                  robot_pose: Pose = ROBOT_POSE) -> Rearrangement:
    """Return objects on a floor within walls."""
    return Rearrangement(objects, ROBOT, robot_pose, floor or walled_floor(5.0, 4.4))


def four_objects() -> tuple[NamedObject, ...]:
    """Return four objects, of which some goals are where others stand, without a circle."""
    places = [Pose(-1.6, 1.2, 0.3), Pose(0.1, 0.9, 1.0), Pose(1.5, 1.1, -0.4),
              Pose(1.4, -0.7, 0.2), Pose(-1.3, -0.9, 2.0)]
    return tuple(NamedObject(name, bin_() if name == 'bin' else box(), start, goal)
                 for name, start, goal in zip(('bin', 'carton', 'crate', 'table'), places,
                                              places[1:]))


def summary(plan: OrderPlan) -> list[tuple[str, bool]]:
    """Return names of moves, and whether they lead to temporary places."""
    return [(move.name, move.is_temporary) for move in plan.moves]


def swap() -> Rearrangement:
    """Return two boxes each of which stands at the goal of the other."""
    return rearrangement(NamedObject('a', box(), LEFT, RIGHT),
                         NamedObject('b', box(), RIGHT, LEFT))


def least_time(problem: Rearrangement) -> float:
    """Compare all orders without temporary places."""
    placements = Placements(problem.objects, problem.robot, problem.drive, problem.occupancy_map)
    evaluator = MoveEvaluator(placements, problem.robot,
                              problem.occupancy_map.origin.inverse() @ problem.robot_pose,
                              problem.drive)
    best = math.inf
    for order in itertools.permutations(range(len(problem.objects))):
        layout = (START,) * len(order)
        regions, last, time = evaluator.first_regions(layout), None, 0.0
        for index in order:
            option = evaluator.evaluate(layout, regions, index, GOAL, last)
            if option is None:
                break
            layout, regions, last = option.layout, option.regions, (index, GOAL)
            time += option.time
        else:
            best = min(best, time)
    return best


def test_the_order_is_the_best_of_all() -> None:
    """Branch and bound returns what an exhaustive search does."""
    problem = rearrangement(*four_objects())
    plan = plan_order(problem)
    assert plan.is_complete and not plan.refusals and len(plan.moves) == 4
    assert plan.time == pytest.approx(least_time(problem), abs=1e-9)


def test_what_stands_at_a_goal_is_moved_first() -> None:
    """In a chain each object waits for the one at its goal."""
    names = [move.name for move in plan_order(rearrangement(*four_objects())).moves]
    assert names == ['table', 'crate', 'carton', 'bin']


def test_what_would_be_hemmed_in_leaves_first() -> None:
    """The near box goes to a gap of 2 cm beside the start of the other, which is far."""
    problem = rearrangement(
        NamedObject('far', box(), Pose(1.5, 1.2, 0.0), Pose(-1.5, 1.2, 0.0)),
        NamedObject('near', box(), Pose(0.0, -0.9, 0.0), Pose(1.5, 0.78, 0.0)))
    assert summary(plan_order(problem)) == [('far', False), ('near', False)]


def test_the_sequence_of_objects_has_no_effect() -> None:
    """Objects are told apart by their names alone."""
    plans = [plan_order(rearrangement(*objects))
             for objects in itertools.islice(itertools.permutations(four_objects()), 0, 24, 7)]
    assert len({plan.time for plan in plans}) == 1
    assert all(summary(plan) == summary(plans[0]) for plan in plans)


def test_a_rigid_motion_has_no_effect() -> None:
    """A map that lies elsewhere, with all that is on it, gives the same order."""
    motion, problem = Pose(3.0, -7.0, 1.1), swap()
    floor = problem.occupancy_map
    objects = tuple(item._replace(pose=motion @ item.pose, goal=motion @ item.goal)
                    for item in problem.objects if item.goal is not None)
    moved = problem._replace(
        objects=objects, robot_pose=motion @ problem.robot_pose,
        occupancy_map=OccupancyMap(floor.resolution, motion @ floor.origin, floor.occupied))
    plan, other = plan_order(problem), plan_order(moved)
    assert summary(plan) == summary(other)
    assert other.time == pytest.approx(plan.time, abs=1e-6)
    for before, after in zip(plan.moves, other.moves):
        assert after.end == pytest.approx(motion @ before.end, abs=1e-6)


def test_a_swap_takes_one_temporary_place() -> None:
    """One of two is moved aside, then both get to their goals."""
    plan = plan_order(swap())
    assert not plan.refusals
    assert [move.is_temporary for move in plan.moves] == [True, False, False]
    aside, _, last = plan.moves
    assert aside.name == last.name and last.start == aside.end


def test_a_budget_of_nothing_gives_an_order() -> None:
    """The first order is completed, and is no better than the one that is searched for."""
    problem = rearrangement(*(item._replace(goal=item.pose @ Pose(0.3, 0.1, 0.4))
                              for item in four_objects()))
    first = plan_order(problem, max_work=0)
    assert len(first.moves) == 4 and not first.is_complete
    assert first.time >= plan_order(problem).time


def test_what_stands_at_a_goal_is_moved_aside_before_what_stands_beside_the_way() -> None:
    """Three tables change places by four moves; a fourth one, near to the robot, stays."""
    table = read_object('coffee_table')
    places = [Pose(-0.04, 0.41, 0.135), Pose(-1.91, -1.68, -1.472), Pose(2.99, 0.01, 1.302)]
    beside = Pose(-1.34, -0.09, -0.667)
    plan = plan_order(rearrangement(
        *(NamedObject(name, table, start, goal)
          for name, start, goal in zip('abc', places, [*places[1:], *places])),
        NamedObject('d', table, beside, beside), floor=walled_floor(8.0, 8.0),
        robot_pose=Pose(0.0, -0.5, 0.0)), max_work=0)
    assert not plan.refusals and [move.is_temporary for move in plan.moves] == [
        True, False, False, False]
    assert 'd' not in {move.name for move in plan.moves}


def test_an_order_that_leaves_an_object_out_does_not_end_the_search() -> None:
    """The first place aside of a circle is a dead end; a budget of nothing gives a whole order."""
    places = [Pose(1.55, -1.34, 2.59), Pose(1.4, 1.22, -0.84), Pose(0.74, -0.51, 0.87)]
    beside = Pose(-1.16, -1.43, 2.76)
    plan = plan_order(rearrangement(
        *(NamedObject(name, box(), start, goal)
          for name, start, goal in zip('abc', places, [*places[1:], *places])),
        NamedObject('d', box(), beside, beside), floor=walled_floor(5.0, 5.0),
        robot_pose=Pose(-2.25, -2.25, 0.0)), max_work=0)
    ends = {move.name: move.end for move in plan.moves}
    assert not plan.refusals and [ends[name] for name in 'abc'] == [*places[1:], places[0]]


@pytest.mark.parametrize('goal', [None, Pose(0.0, 0.0, 0.0)])
def test_a_door_is_freed(goal: Pose | None) -> None:
    """What blocks a door is moved aside, and back if it has a goal there."""
    floor = walled_floor(7.0, 4.4, door=1.0)
    plan = plan_order(rearrangement(
        NamedObject('box', box(), Pose(-1.8, 0.7, 0.0), Pose(1.9, 0.2, 0.0)),
        NamedObject('bin', bin_(), Pose(0.0, 0.0, 0.0), goal),
        floor=floor, robot_pose=Pose(-2.5, -1.0, 0.0)))
    assert not plan.refusals
    back = [] if goal is None else [('bin', False)]
    assert summary(plan) == [('bin', True), ('box', False), *back]
    # With the bin there, the box passes however it is turned.
    with_bin = OccupancyMap(floor.resolution, floor.origin, floor.occupied | disc_cells(
        floor, plan.moves[0].end, 0.2))
    passage = narrowest_passage(make_floor(with_bin),
                                *(tuple(with_bin.to_map([place])[0].tolist())
                                  for place in ((-1.8, 0.7), (1.9, 0.2))))
    assert passage.width > 0.4 * math.sqrt(2.0)


@pytest.mark.parametrize('side', [-1.0, 1.0])
def test_what_stands_in_a_door_leaves_it_away_from_the_robot(side: float) -> None:
    """The robot cannot pull it to its own side, where a place would be nearer."""
    floor = walled_room((-0.1, 0.1, -3.0, -0.5), (-0.1, 0.1, 0.5, 3.0))
    plan = plan_order(rearrangement(
        NamedObject('box', box(), Pose(-1.8 * side, 0.7, 0.0), Pose(1.9 * side, 0.2, 0.0)),
        NamedObject('bin', bin_(), Pose(-0.05 * side, 0.0, 0.0)),
        floor=floor, robot_pose=Pose(-2.5 * side, -1.0, 0.0)))
    assert summary(plan) == [('bin', True), ('box', False)]
    assert (side * plan.moves[0].path[:, 0] > -0.1).all()
    assert side * plan.moves[0].end.x > 0.3


def disc_cells(floor: OccupancyMap, center: Pose, radius: float) -> BoolArray:
    """Return the cells of a map whose centres a disc covers."""
    rows, columns = np.indices(floor.occupied.shape)
    centers = floor.from_map(floor.resolution * np.stack(
        (columns.ravel() + 0.5, rows.ravel() + 0.5), axis=1))
    return (np.hypot(*(centers - center[:2]).T) < radius).reshape(rows.shape)


def outline_points(item: NamedObject, pose: Pose) -> list[tuple[float, float]]:
    """Return points on the outline of an object, in the world."""
    obj = item.obj
    if not obj.outline:
        return [pose.transform((obj.radius * math.cos(angle), obj.radius * math.sin(angle)))
                for angle in np.linspace(0.0, 2.0 * math.pi, 60)]
    corners = [np.array(corner) for corner in obj.outline]
    return [pose.transform(tuple((start + part * (end - start)).tolist()))
            for start, end in zip(corners, corners[1:] + corners[:1])
            for part in np.linspace(0.0, 1.0, 20, endpoint=False)]


def is_inside(item: NamedObject, pose: Pose, point: tuple[float, float]) -> bool:
    """Tell whether a point of the world is inside an object."""
    x, y = pose.inverse().transform(point)
    if not item.obj.outline:
        return math.hypot(x, y) < item.obj.radius
    return boundary_point(item.obj.outline, x, y).signed_distance < 0.0


@pytest.mark.parametrize('problem', [swap(), rearrangement(*four_objects())])
def test_no_object_passes_through_another(problem: Rearrangement) -> None:
    """Other geometry sees neither a way through an object, nor two objects in one place."""
    items = {item.name: item for item in problem.objects}
    poses = {item.name: item.pose for item in problem.objects}
    # By how much grid points may make a way narrower [m].
    narrower, inner = 0.05, 0.2
    for move in plan_order(problem).moves:
        assert poses[move.name] == move.start
        for name, pose in poses.items():
            if name == move.name:
                continue
            outline = outline_points(items[name], pose)
            gaps = [distance(point, other) for point in move.path.tolist() for other in outline]
            assert min(gaps) > inner - narrower
            assert not any(is_inside(items[move.name], move.end, point) for point in outline)
        poses[move.name] = move.end
    assert all(poses[item.name] == item.goal for item in problem.objects)


def test_what_cannot_be_done_does_not_stop_the_others() -> None:
    """Goals in a wall and in one place have codes; the rest is brought to its goals."""
    plan = plan_order(rearrangement(
        NamedObject('a', box(), LEFT, RIGHT),
        NamedObject('b', box(), Pose(-1.0, 1.3, 0.0), RIGHT @ Pose(0.1, 0.0, 0.0)),
        NamedObject('c', box(), Pose(1.5, -1.2, 0.0), Pose(2.5, 0.0, 0.0))))
    assert [move.name for move in plan.moves] == ['a']
    assert {name: report.code for name, report in plan.refusals.items()} == {
        'b': ObjectFailure.GOALS_OVERLAP, 'c': ObjectFailure.GOAL_NOT_FREE}


def test_a_circle_without_room_is_refused() -> None:
    """In a closet two boxes cannot change places; the code says why."""
    floor = walled_floor(2.6, 1.2)
    plan = plan_order(rearrangement(
        NamedObject('a', box(), Pose(-0.5, 0.0, 0.0), Pose(0.3, 0.0, 0.0)),
        NamedObject('b', box(), Pose(0.3, 0.0, 0.0), Pose(-0.5, 0.0, 0.0)),
        floor=floor, robot_pose=Pose(-1.0, 0.0, 0.0)))
    assert not plan.moves
    assert {report.code for report in plan.refusals.values()} <= {
        ObjectFailure.NO_TEMPORARY_PLACE, ObjectFailure.BLOCKED}
    assert set(plan.refusals) == {'a', 'b'}


def test_a_move_that_turned_out_to_be_impossible_does_not_come_first() -> None:
    """Something else is moved before it."""
    problem = rearrangement(*four_objects()[2:], NamedObject('bin', bin_(), LEFT, Pose(
        -1.6, 0.9, 0.0)))
    first = plan_order(problem).moves[0]
    refused = frozenset([(first.name, first.end)])
    assert plan_order(problem._replace(refused_moves=refused)).moves[0].name != first.name
