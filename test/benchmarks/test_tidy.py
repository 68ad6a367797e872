"""Benchmark of rooms with several objects: what its rooms are, and what its table says."""

from pathlib import Path
from typing import Any

from benchmarks.tidy import benchmark, flat
from benchmarks.tidy.benchmark import nearest_first
from benchmarks.tidy.doors import draw_door
from benchmarks.tidy.report import room_table
from benchmarks.tidy.rooms import draw_room, GAP
from helpers.maps import walled_floor
from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_planner.rearrangement.footprints import object_gap
from push_planner.rearrangement.order import plan_order
from push_planner.rearrangement.problem import NamedObject, OrderPlan, Rearrangement
from push_scenario.evaluation.result_row import Row
from push_scenario.tidying.room import Room
from push_scenario.tidying.tidy import RoomRun, tidy, TidyResult
import pytest

START = Pose(0.0, 0.0, 0.0)


def test_a_room_with_a_circle_keeps_its_gaps() -> None:
    """The first object is to stand where the second stands; the robot fits between all."""
    room = draw_room(3, 0)
    first, second, third = room.scenarios.values()
    assert first.goal == second.start.object
    for one, other in ((first, second), (first, third), (second, third)):
        assert object_gap(one.object, one.start.object.pose, other.object,
                          other.start.object.pose) > GAP


def test_the_nearest_object_comes_first() -> None:
    """Whatever stands in its way."""
    objects = tuple(NamedObject(name, box(), Pose(x, 0.0, 0.0), Pose(x, 1.0, 0.0))
                    for name, x in (('far', 2.0), ('near', 1.0)))
    problem = Rearrangement(objects, RoundRobot(0.17), Pose(0.0, 0.0, 0.0), walled_floor(8.0, 8.0))
    assert [move.name for move in nearest_first(problem).moves] == ['near']


def test_the_table_counts_rooms_and_objects() -> None:
    """A room counts where all of its objects are at their goals; deep touches count twice."""
    row = {'count': 3, 'objects': 3, 'order': 'searched', 'touches': 2,
           'deep_touches': 1, 'moves': 4, 'duration': 100.0, 'index': 7,
           'reasons': 'bin 0: too narrow'}
    *_, line, _, reason = room_table([{**row, 'placed': 3}, {**row, 'placed': 2}],
                                     ['searched']).splitlines()
    assert line == '| 3, searched | 1 of 2 | 5 of 6 | 4, 2 | 8 | 100 s |'
    assert reason == '* room of 3 objects, 7, searched: bin 0: too narrow.'


def test_times_are_compared_in_rooms_that_both_orders_put_in_order() -> None:
    """A room that one of them does not put in order has no part in the median."""
    def row(order: str, index: int, duration: float, placed: int = 3) -> Row:
        return {'count': 3, 'objects': 3, 'order': order, 'touches': 0, 'deep_touches': 0,
                'moves': 3, 'duration': duration, 'index': index, 'placed': placed,
                'reasons': ''}
    rows = [row('searched', 0, 80.0), row('nearest', 0, 100.0), row('searched', 1, 60.0),
            row('nearest', 1, 10.0, 2), row('alone', 1, 50.0)]
    searched = room_table(rows, ['searched']).splitlines()[2]
    assert searched.endswith('| 0.80 (1) | 1.20 (1) |')


def test_a_flat_goes_on_where_it_stopped(tmp_path: Path) -> None:
    """After an interrupt no goal is repeated, and none is left out; other seeds start anew."""
    indices: list[int] = []

    def note(_room: Room, _run: RoomRun, _seed: int, index: int) -> Row:
        indices.append(index)
        return {'index': index}

    def interrupt(done: int, _count: int) -> None:
        if done == 2:
            raise KeyboardInterrupt
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(flat, 'draw_flat', lambda _: draw_room(3, 0))
        patch.setattr(flat, '_goal_row', note)
        with pytest.raises(KeyboardInterrupt):
            flat.run_flat(0, 3, tmp_path, interrupt)
        rows = flat.run_flat(0, 3, tmp_path, lambda *_: None)
        assert indices == [row['index'] for row in rows] == [0, 1, 2]
        assert len(flat.run_flat(1, 1, tmp_path, lambda *_: None)) == 1


def test_each_object_alone_has_the_room_to_itself() -> None:
    """It gets from its start to its goal as if no other were there."""
    rooms: list[Room] = []

    def note(room: Room, **_: Any) -> TidyResult:
        rooms.append(room)
        return TidyResult(room, (), {name: item.goal.pose
                                     for name, item in room.scenarios.items()}, START, {})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark, 'tidy', note)
        row = benchmark.room_row(benchmark.Job(3, 0, 'alone'))
    assert row['objects'] == row['placed'] == 3
    assert [list(room.scenarios) for room in rooms] == [
        [name] for name in draw_room(3, 0).scenarios]


def test_what_blocks_a_door_is_moved_first() -> None:
    """The box waits for it, and gets through; what has a goal in the door comes back."""
    plans: list[OrderPlan] = []

    def plan_only(problem: Rearrangement) -> OrderPlan:
        plans.append(plan_order(problem, 0))
        return plans[-1]._replace(moves=())

    room = draw_door(0)
    tidy(room, find_order=plan_only)
    moves, = [plan.moves for plan in plans]
    blocking, = set(room.scenarios) - {'box'}
    assert [move.name for move in moves] == [blocking, 'box', blocking]
    assert [move.is_temporary for move in moves] == [True, False, False]
