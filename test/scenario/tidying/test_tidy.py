"""Rooms put in order in one process."""

import pickle

import numpy as np
from push_planner.rearrangement.problem import Move, OrderPlan
from push_scenario.tidying.room import room_from_text
from push_scenario.tidying.tidy import RoomRun, tidy, TidyProgress
import pytest

# The heading of the bin at its goal is opposite to that at its start.
BIN = """
description: a bin to a place near by
robot: {file: holonomic_017.yaml}
start: {robot: {x: -0.5, y: 0.0}}
objects:
  bin: {object: {file: bin.yaml}, start: {x: 0.0, y: 0.0}, goal: {x: 0.3, y: 0.0, theta_deg: 180}}
task: {}
time_limit: 60
"""


@pytest.mark.slow
def test_a_round_object_is_brought_to_its_place_in_any_heading() -> None:
    """By a push or two: nobody turns it."""
    result = tidy(room_from_text(BIN, 'bin'))
    move, = result.moves
    assert not result.failures and move.run.pushes <= 2
    assert result.errors('bin')[0] < 0.01 and result.errors('bin')[1] > 2.0


@pytest.mark.slow
def test_a_stored_state_goes_on_to_the_bit() -> None:
    """A copy that was pickled between two moves ends where the run itself does."""
    room = room_from_text(BIN, 'bin')
    run, goal = RoomRun(room), room.scenarios['bin'].goal.pose

    def push(item: RoomRun, x: float) -> None:
        item.make(Move('bin', item.poses['bin'], goal._replace(x=x), False, 0.0, np.zeros((1, 2))),
                  TidyProgress(OrderPlan((), {}, 0.0, True, 0), 0, 1, item.poses))
    push(run, 0.1)
    copy = pickle.loads(pickle.dumps(run))
    for item in (run, copy):
        push(item, goal.x)
    assert copy.poses == run.poses and copy.robot_pose == run.robot_pose
    assert abs(run.poses['bin'].x - goal.x) < 0.02
