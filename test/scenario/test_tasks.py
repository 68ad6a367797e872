"""The tasks that come with the package, in one process."""

import dataclasses
import functools
import math

import numpy as np
from push_control.task.status import TaskState
from push_model.geometry import distance, Pose
from push_navigation.settings import DriveSettings
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.loader import load_scenario, scenario_names
from push_scenario.definition.mapping import from_mapping, Location, to_mapping
from push_scenario.definition.strict_yaml import ScenarioError
from push_scenario.definition.task import Task
from push_scenario.evaluation.metrics import is_as_expected, measure
from push_scenario.evaluation.report import format_report
from push_scenario.simulation.history import StateHistory
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.tape import Tape
import pytest

CLEARANCE = DriveSettings().clearance


def scenario(name):
    """Read a scenario that comes with the package."""
    return load_scenario(name)


@functools.lru_cache(maxsize=None)
def result_of(name, law='feedback'):
    """Carry a task out as ``replay`` does, once."""
    return simulate(scenario(name), law, planning_time=0.0)


TASKS = [name for name in scenario_names() if scenario(name).task is not None]


@pytest.mark.parametrize('name', TASKS)
def test_every_task_ends_as_expected(name):
    """The object rests on its mark, the robot is clear of it, both stand."""
    result = result_of(name)
    assert is_as_expected(result), format_report([result])
    final = dict(zip(result.tape.columns, result.tape.rows[-1]))
    rest = [final[f'{body}_v_{axis}'] for body in ('object', 'robot') for axis in 'xy']
    assert np.abs(rest).max() < 2e-3
    assert final['gap'] > CLEARANCE


def test_the_robot_goes_round_the_object_before_it_pushes():
    """It starts beyond it, touches nothing on its way, and one push does."""
    result = result_of('task_approach')
    start, robot = result.scenario.start.object.pose, result.scenario.robot_start
    goal = result.scenario.goal.pose
    ahead = (goal.x - start.x, goal.y - start.y)
    assert (robot.x - start.x) * ahead[0] + (robot.y - start.y) * ahead[1] > 0.0
    begin = next(change.time for change in result.history if change.state == TaskState.ALIGN)
    before = result.tape['time'] < begin
    assert result.tape['gap'][before].min() > CLEARANCE - 0.01
    assert result.pushes == 1 and not result.recoveries


def test_two_pushes_are_much_quicker_than_one():
    """One alone would lead the object in a loop."""
    metrics = measure(result_of('task_two_pushes'))
    assert metrics.pushes == 2
    assert metrics.time < 0.75 * metrics.single_push_time


def test_a_robot_that_slips_off_goes_on():
    """The push fails after the foot has caught; another follows."""
    result = result_of('task_lost_contact')
    spell = result.scenario.simulation.friction_changes[0]
    troubles = [change for change in result.history[1:] if change.reason]
    assert spell.start < troubles[0].time < spell.end + 3.0
    assert troubles[0].state == TaskState.RETREAT and result.recoveries >= 1
    assert any(change.state == TaskState.PUSH and change.time > troubles[0].time
               for change in result.history)


def test_through_the_door_no_wall_is_touched():
    """The robot comes from the other room; no single push would lead the object there."""
    result = result_of('task_map')
    case = result.scenario
    occupancy_map, start, goal = case.task.occupancy_map, case.start.object, case.goal
    line = np.linspace((start.x, -1.0, 0.0), (goal.x, -1.0, 0.0), 200)
    assert not occupancy_map.object_is_free(case.object, line, 0.0)
    assert start.x < 0.0 < case.robot_start.x and goal.x > 0.0
    assert measure(result).within_map and math.isinf(result.single_push_time)
    beside = dataclasses.replace(case.task.map, origin=dataclasses.replace(
        case.task.map.origin, y=case.task.map.origin.y + 1.0))
    moved = dataclasses.replace(result, scenario=dataclasses.replace(
        case, task=dataclasses.replace(case.task, map=beside)))
    assert not measure(moved).within_map and not is_as_expected(moved)


def test_every_shove_is_noticed():
    """Within three seconds, each in another state; so is the way that the object took."""
    result = result_of('task_displacement')
    for shove in result.scenario.simulation.object_displacements:
        assert any(shove.time < change.time < shove.time + 3.0 and change.reason
                   for change in result.history), shove
    assert result.recoveries >= len(result.scenario.simulation.object_displacements)


def test_the_later_goal_counts():
    """It is taken up when it is given, during a push, and the tape ends there."""
    result = result_of('task_new_goal')
    later, = result.scenario.task.goals
    states = [change.state for change in result.history if change.time < later.time]
    assert states[-1] == TaskState.PUSH
    assert any(change.reason == 'new goal' and abs(change.time - later.time) < 0.1
               for change in result.history[1:])
    final = result.tape.poses('object')[-1]
    assert distance(final, later.goal.pose) == result.position_error < 0.01
    assert distance(final, result.scenario.goal.pose) > 1.0
    assert result.pushes == sum(change.state == TaskState.PUSH for change in result.history) \
        > result.status.pushes


def test_a_task_is_the_same_every_time():
    """Also where poses are noisy and lost."""
    again = simulate(scenario('task_two_pushes'), planning_time=0.0)
    assert again.tape.to_bytes() == result_of('task_two_pushes').tape.to_bytes()


def test_a_robot_that_still_stands_at_the_object_is_not_done():
    """Though the object rests within its bounds."""
    result = result_of('task_approach')
    retreat = next(change.time for change in result.history if change.state == TaskState.RETREAT)
    rows = result.tape.rows[result.tape['time'] <= retreat]
    early = dataclasses.replace(result, tape=Tape(result.tape.columns, rows))
    assert early.position_error < 0.01
    assert not measure(early).within_bounds and not is_as_expected(early)


def test_what_cannot_be_reached_is_not_done():
    """No push is begun where the door is shut; that can be what a scenario expects."""
    case = scenario('task_map')
    shut = dataclasses.replace(case.task.map, rows=case.task.map.rows.replace(
        '.' * 96, 46 * '.' + 4 * '#' + 46 * '.').replace('.' * 98, 47 * '.' + '####' + 47 * '.'))
    result = simulate(dataclasses.replace(case, task=dataclasses.replace(
        case.task, map=shut, supervision=dataclasses.replace(case.task.supervision, max_attempts=1))))
    assert result.outcome is Outcome.FAILED and 'map' in result.reason
    assert result.pushes == 0 and math.isnan(result.single_push_time)
    assert not is_as_expected(result)
    assert is_as_expected(dataclasses.replace(result, scenario=dataclasses.replace(
        result.scenario, expected='refused')))
    assert 'time of the best single push' in format_report([result])


def test_the_table_tells_pushes_times_and_what_went_wrong():
    """And the law, the bounds, and the outcome."""
    text = format_report([result_of('task_lost_contact')])
    rows = {line.split('  ')[0]: line.split() for line in text.splitlines()}
    result = result_of('task_lost_contact')
    assert int(rows['pushes'][-1]) == result.pushes
    assert int(rows['recoveries'][-1]) == result.recoveries
    assert float(rows['time'][-1]) == pytest.approx(result.duration, abs=0.06)
    assert float(rows['time of the best single push'][-1]) == pytest.approx(result.single_push_time,
                                                                            abs=0.06)
    assert rows['final position error'][-1] == '10.0'
    assert any(change.reason and change.reason in text for change in result.history[1:])


def test_a_drawn_map_has_its_first_row_at_the_top():
    """The origin is the corner with the least x and y, as turned."""
    drawn = FloorMap(0.5, '#..\n...\n', dataclasses.replace(
        scenario('task_map').task.map.origin, x=1.0, y=2.0, theta=math.pi / 2))
    occupancy_map = drawn.occupancy_map
    corner = Pose(1.0, 2.0, math.pi / 2)
    cells = [[occupancy_map.clearance([corner.transform((x, y))])[0] for x in (0.25, 0.75, 1.25)]
             for y in (0.75, 0.25)]
    assert np.argmin(cells) == 0
    assert drawn.occupancy_map.occupied.tolist() == [[False] * 3, [True, False, False]]


@pytest.mark.parametrize('rows', ['', '..\n...', '.x'])
def test_a_map_that_is_no_rectangle_of_cells_is_refused(rows):
    """By name."""
    with pytest.raises(ValueError, match='FloorMap.rows'):
        FloorMap(0.5, rows)


@pytest.mark.parametrize('times', [(5.0, 5.0), (5.0, 4.0), (0.0,)])
def test_later_goals_must_be_later(times):
    """One after the other, each after the beginning."""
    case = to_mapping(scenario('task_new_goal').task)
    goals = [{'time': time, 'goal': {'x': 1.0}} for time in times]
    with pytest.raises(ScenarioError, match='goals'):
        from_mapping(Task, {**case, 'goals': goals}, Location('case'))


def test_history_goes_on_over_goals():
    """What is told again is passed over; recoveries of the goal before are kept."""
    history = StateHistory()
    history.update([(0.0, TaskState.PLAN, '')], 0)
    history.update([(0.0, TaskState.PLAN, ''), (1.0, TaskState.APPROACH, ''), (2.0, TaskState.PLAN, 'moved')], 1)
    history.update([(0.0, TaskState.PLAN, ''), (1.0, TaskState.APPROACH, ''), (2.0, TaskState.PLAN, 'moved')], 1)
    history.update([(3.0, TaskState.PLAN, 'new')], 0)
    history.update([(3.0, TaskState.PLAN, 'new'), (4.0, TaskState.PLAN, 'lost')], 1)
    assert [change.time for change in history.changes] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert history.recoveries == 2
