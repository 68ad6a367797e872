"""The tasks of the package, in one process."""

import dataclasses
import functools
import math

import numpy as np
from push_control.events import TaskEvent
from push_control.task.status import TaskState
from push_model.geometry import distance
from push_model.plan_request import PlanFailure
from push_navigation.settings import DriveSettings
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.loader import load_scenario
from push_scenario.evaluation.metrics import is_as_expected, measure
from push_scenario.evaluation.report import format_report
from push_scenario.plots.drawing import segments_of
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.tape import Tape
import pytest

pytestmark = pytest.mark.slow
CLEARANCE = DriveSettings().clearance
# How far the object may be moved before the robot notices [m].
OVERLAP, RUN_INTO = 0.01, 'the robot has run into the object'


@functools.lru_cache(maxsize=None)
def result_of(name, law='feedback'):
    """Simulate a task as ``push replay`` does, once."""
    return simulate(load_scenario(name), law, planning_time=0.0)


# The task by a lidar is run over DDS.
@pytest.mark.parametrize('name', [name for name in scenario_names()
                                  if name.startswith('task_') and name != 'task_lidar'])
def test_every_task_ends_as_expected(name):
    """Both stand; where the task is done the object is at its goal, the robot clear of it."""
    result = result_of(name)
    assert is_as_expected(result), format_report([result])
    final = dict(zip(result.tape.columns, result.tape.rows[-1]))
    rest = [final[f'{body}_v_{axis}'] for body in ('object', 'robot') for axis in 'xy']
    assert np.abs(rest).max() < 2e-3
    assert result.outcome is not Outcome.DONE or final['gap'] > CLEARANCE


@pytest.mark.parametrize('name', ['task_approach', 'task_displacement'])
def test_segments_cover_the_tape(name):
    """One after the other; the object moves in pushes, not while the robot drives."""
    result = result_of(name)
    segments, objects = segments_of(result), result.tape.poses('object')
    assert segments[0].rows.start == 0 and segments[-1].rows.stop >= len(result.tape)
    for segment, following in zip(segments, segments[1:]):
        assert segment.rows.stop == following.rows.start + 1
    pushes = [segment.push for segment in segments if segment.push is not None]
    assert pushes == list(range(result.pushes))
    displacements = [one.time for one in result.scenario.simulation.object_displacements]
    # A robot that is badly localized runs into the object, and reports it where it notices.
    tolerance = OVERLAP if displacements else 0.005
    for segment, following in zip(segments, [*segments[1:], None]):
        moved = np.ptp(objects[segment.rows, :2], axis=0).max()
        start, end = result.tape['time'][segment.rows][[0, -1]]
        if segment.push is not None:
            # A tap moves it by some millimetres at least.
            assert moved > 0.003
        elif (segment.state in (TaskState.PLAN, TaskState.APPROACH)
                and not any(start < time <= end for time in displacements)):
            assert moved < tolerance or RUN_INTO in (segment.reason, following.reason)


def test_the_robot_drives_round_the_object_before_it_pushes():
    """It starts beyond it, and touches nothing on its path."""
    result = result_of('task_approach')
    start, robot = result.scenario.start.object.pose, result.scenario.robot_start
    goal = result.scenario.goal.pose
    ahead = (goal.x - start.x, goal.y - start.y)
    assert (robot.x - start.x) * ahead[0] + (robot.y - start.y) * ahead[1] > 0.0
    begin = next(change.time for change in result.history if change.state is TaskState.PUSH)
    assert result.tape['gap'][result.tape['time'] < begin].min() > 0.01
    assert not result.recoveries


def moves(result):
    """List how far (x, y, rotation) each push and the retreat from it have moved the object."""
    times, poses = result.tape['time'], np.array(result.tape.poses('object'))
    found = []
    for change, after in zip(result.history, result.history[2:]):
        if change.state is TaskState.PUSH:
            first, last = np.searchsorted(times, (change.time, after.time))
            found.append(poses[min(last, len(poses) - 1)] - poses[first])
    return np.array(found)


def test_a_small_miss_is_corrected_by_one_tap():
    """The robot drives up, taps, and leaves."""
    result = result_of('task_tap')
    assert result.pushes == 1 and not result.recoveries
    assert np.hypot(*moves(result)[0, :2]) < 0.04


def test_a_right_angle_in_place_is_turned_in_place():
    """The object stays within its own size; a held push at a vertex would take metres."""
    result = result_of('task_turn')
    poses = np.array(result.tape.poses('object'))
    assert np.hypot(*poses[:, :2].T).max() < 0.5
    assert np.abs(moves(result)[:, 2]).max() > math.radians(30.0)


def test_the_demo_shows_a_turn_and_ends_with_a_small_push():
    """What its picture is for."""
    found = moves(result_of('task_demo'))
    assert abs(found[0, 2]) > math.radians(45.0)
    assert np.hypot(*found[-1, :2]) < 0.1


def test_through_the_door_no_wall_is_touched():
    """The robot comes from the other room; no single push would lead the object there."""
    result = result_of('task_map')
    case = result.scenario
    occupancy_map, start, goal = case.task.occupancy_map, case.start.object, case.goal
    line = np.linspace((start.x, -1.0, 0.0), (goal.x, -1.0, 0.0), 200)
    assert not occupancy_map.object_is_free(case.object, line, 0.0)
    assert start.x < 0.0 < case.robot_start.x and goal.x > 0.0
    assert measure(result).within_map and result.pushes > 1
    beside = dataclasses.replace(case.task.map, origin=dataclasses.replace(
        case.task.map.origin, y=case.task.map.origin.y + 1.0))
    moved = dataclasses.replace(result, scenario=dataclasses.replace(
        case, task=dataclasses.replace(case.task, map=beside)))
    assert not measure(moved).within_map and not is_as_expected(moved)


def test_every_displacement_is_noticed():
    """Within three seconds, each in another state."""
    result = result_of('task_displacement')
    for displacement in result.scenario.simulation.object_displacements:
        assert any(displacement.time < change.time < displacement.time + 3.0 and change.reason
                   for change in result.history), displacement
    assert result.recoveries >= len(result.scenario.simulation.object_displacements)


def test_the_later_goal_counts():
    """It replaces the first one when it is given, during a push, and the object ends there."""
    result = result_of('task_new_goal')
    later, = result.scenario.task.goals
    states = [change.state for change in result.history if change.time < later.time]
    assert states[-1] is TaskState.PUSH
    assert any(TaskEvent.NEW_GOAL in change.codes and abs(change.time - later.time) < 0.1
               for change in result.history[1:])
    final = result.tape.poses('object')[-1]
    assert distance(final, later.goal.pose) == result.position_error < 0.01
    assert distance(final, result.scenario.goal.pose) > 1.0
    assert result.pushes == sum(change.state is TaskState.PUSH for change in result.history) \
        > result.status.pushes


def test_a_task_is_the_same_every_time():
    """Also where poses are noisy and lost."""
    again = simulate(load_scenario('task_tap'), planning_time=0.0)
    assert again.tape.to_bytes() == result_of('task_tap').tape.to_bytes()


def test_a_robot_that_still_stands_at_the_object_is_not_done():
    """Though the object rests within its bounds."""
    result = result_of('task_approach')
    *_, retreat = (change.time for change in result.history if change.state is TaskState.RETREAT)
    rows = result.tape.rows[result.tape['time'] <= retreat]
    early = dataclasses.replace(result, tape=Tape(result.tape.columns, rows))
    assert early.position_error < 0.01
    assert not measure(early).within_bounds and not is_as_expected(early)


def test_what_cannot_be_reached_is_not_done():
    """No push is started where the door is shut; that can be what a scenario expects."""
    case = load_scenario('task_map')
    shut = dataclasses.replace(case.task.map, rows=case.task.map.rows.replace(
        '.' * 96, 46 * '.' + 4 * '#' + 46 * '.').replace('.' * 98, 47 * '.' + '####' + 47 * '.'))
    once = dataclasses.replace(case.task.supervision, max_attempts=1)
    result = simulate(dataclasses.replace(
        case, task=dataclasses.replace(case.task, map=shut, supervision=once)))
    assert result.outcome is Outcome.FAILED and PlanFailure.BLOCKED in result.codes
    assert result.pushes == 0
    assert not is_as_expected(result)
    assert is_as_expected(dataclasses.replace(result, scenario=dataclasses.replace(
        result.scenario, expected='refused')))


def test_the_report_shows_pushes_times_and_failures():
    """And the law, the bounds, and the outcome."""
    text = format_report([result_of('task_displacement')])
    rows = {line.split('  ')[0]: line.split() for line in text.splitlines()}
    result = result_of('task_displacement')
    assert int(rows['pushes'][-1]) == result.pushes
    assert int(rows['recoveries'][-1]) == result.recoveries
    assert float(rows['time'][-1]) == pytest.approx(result.duration, abs=0.06)
    assert rows['final position error'][-1] == '10.0'
    assert any(change.reason and change.reason in text for change in result.history[1:])
