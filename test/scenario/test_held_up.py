"""An object that is pressed onto a wall is held up; neither the base nor its weight is blamed."""

import dataclasses

import numpy as np
from push_control.behaviors.failures import BehaviorFailure
from push_control.goal import TaskFailure
from push_control.task.status import TaskState
from push_dynamics.walls import Wall
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.simulation.loop import simulate
import pytest

pytestmark = pytest.mark.slow
# The face of the wall of the map along y, and half a side of the box [m].
WALL_Y, HALF = 1.15, 0.2
# Time between two rows of a tape [s].
PERIOD = 0.02


def pushed_at_wall(wall_y, is_in_map):
    """Push the box along y to the wall of the map, before which the true one stands."""
    scenario = load_scenario('task_along_wall')
    task = scenario.task if is_in_map else dataclasses.replace(scenario.task, map=None)
    return simulate(dataclasses.replace(
        scenario, task=task, goal=Placement(0.0, WALL_Y - HALF, 0.0), time_limit=40.0,
        start=dataclasses.replace(scenario.start, object=Placement(0.0, 0.5, 0.0),
                                  robot=Placement(0.0, -0.3, 0.0)),
        simulation=dataclasses.replace(scenario.simulation,
                                       walls=(Wall(-2.0, wall_y, 2.0, wall_y),))))


@pytest.mark.parametrize('is_in_map, distance', [(False, 0.15), (True, 0.015)])
def test_a_wall_before_the_object_holds_it_up(is_in_map, distance):
    """One that nobody knows of, and one of a map that errs by less than a cell."""
    result = pushed_at_wall(WALL_Y - distance, is_in_map)
    history = result.status.history
    assert result.status.failure is TaskFailure.NO_PROGRESS
    assert BehaviorFailure.HELD_UP in result.status.codes
    assert ('obstacle of the map' in result.reason) == is_in_map
    found = {code for change in history for code in change.codes}
    assert not found & {SafetyReason.NOT_MOVING, SafetyReason.MOVES_OTHERWISE,
                        SafetyReason.BASE_STOOD, BehaviorFailure.BASE_STALLS}
    # Three presses of a moment each, after which the robot backs off.
    tape = result.tape
    time, force_y, gap = (tape.rows[:, tape.columns.index(name)]
                          for name in ('time', 'wall_force_y', 'gap'))
    is_pressed = np.abs(force_y) > 20.0
    assert is_pressed.any() and PERIOD * is_pressed.sum() < 5.0
    assert gap[-1] > 0.05 and not is_pressed[-1]
    assert time[-1] < 30.0
    # It backs off at once, and not after a rest at the object.
    retreats = [then.time - change.time for change, then in zip(history, history[1:])
                if change.state is TaskState.RETREAT]
    assert max(retreats) < 0.8


def test_a_wall_where_the_map_has_it_holds_nothing_up():
    """The goal touches it."""
    result = pushed_at_wall(WALL_Y, True)
    assert result.status.failure is None and result.position_error < 0.01
    assert not {BehaviorFailure.HELD_UP} & {
        code for change in result.status.history for code in change.codes}
