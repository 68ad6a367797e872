"""Whole tasks over Fast DDS, in lockstep: three nodes in three processes each."""

import dataclasses

from helpers.extras import import_extra
import numpy as np
from push_model.geometry import distance
from push_ros.conversions.primitives import nanoseconds
from push_scenario.dds.replay import run_over_dds
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.definition.task import LaterGoal
from push_scenario.evaluation.metrics import is_as_expected, measure
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
import pytest

AnyReader = import_extra('rosbags', 'record', 'rosbags.highlevel').AnyReader
NEAR, TURNED = 0.01, np.radians(1.0)
LATER = Placement(0.0, 0.3, 0.0)

pytestmark = [pytest.mark.dds, pytest.mark.slow]


def scenario(name, **changes):
    """Load a scenario of the package, and change some of it."""
    return dataclasses.replace(load_scenario(name), **changes)


@pytest.fixture(scope='module')
def twice(tmp_path_factory):
    """Replay a task twice whose robot stands on the wrong side."""
    folder = tmp_path_factory.mktemp('twice')
    return [run_over_dds(scenario('task_approach'), None, folder / name)
            for name in ('first', 'second')]


def test_the_object_arrives_although_the_robot_stands_on_the_wrong_side(twice):
    """Within 10 mm and 1 degree, with poor sensors and odometry; the robot is clear of it."""
    for result in twice:
        assert result.outcome is Outcome.DONE and is_as_expected(result)
        assert result.position_error < NEAR and abs(result.heading_error) < TURNED
        assert measure(result).gap > result.scenario.task.drive.clearance


def test_lockstep_twice_gives_the_same_tape(twice):
    """However long the planner thinks: time waits for it."""
    assert twice[0].tape.to_bytes() == twice[1].tape.to_bytes()
    assert twice[0].history == twice[1].history


def test_a_task_over_dds_goes_as_in_process(twice):
    """Until the first push has ended; then it tells when late poses count as new."""
    expected = simulate(scenario('task_approach'), planning_time=0.0)
    for change, other in zip(twice[0].history[:4], expected.history[:4]):
        assert change.state is other.state
        assert change.time == pytest.approx(other.time, abs=0.5)
    assert is_as_expected(expected)


def test_the_recording_has_request_and_answer(twice):
    """One plan for each request, with its stamp; the last path leads to the goal; text shows."""
    with AnyReader([twice[0].bag]) as reader:
        received = {}
        for connection, _, data in reader.messages():
            if connection.topic in ('/push_request', '/push_plan', '/planned_path', '/markers'):
                received.setdefault(connection.topic, []).append(
                    reader.deserialize(data, connection.msgtype))
    stamps = [[nanoseconds(message.header.stamp) for message in received[topic]]
              for topic in ('/push_request', '/push_plan', '/planned_path')]
    assert stamps[0] == stamps[1] == stamps[2] and len(stamps[0]) == twice[0].pushes
    end = received['/planned_path'][-1].poses[-1].pose.position
    assert distance((end.x, end.y), twice[0].scenario.goal.pose) < 0.02
    shown = {marker.text for message in received['/markers'] for marker in message.markers}
    assert {'approach', 'push'} <= shown


@pytest.fixture(scope='module')
def redirected(tmp_path_factory):
    """Replay a task whose goal changes in between, twice."""
    first = scenario('task_map')
    task = dataclasses.replace(first.task, map=None, goals=(LaterGoal(LATER, 12.0),))
    return [run_over_dds(dataclasses.replace(first, name='redirected', task=task), None,
                         tmp_path_factory.mktemp('redirected'), record=False) for _ in range(2)]


def test_a_goal_that_changes_in_between_is_reached(redirected):
    """From the time on that the scenario says; the same tape twice all the same."""
    for result in redirected:
        assert result.outcome is Outcome.DONE and is_as_expected(result)
        assert distance(result.tape.poses('object')[-1], LATER.pose) < NEAR
        changed, = [change for change in result.history[1:] if change.reason == 'new goal']
        assert changed.time == pytest.approx(12.0, abs=0.1)
    assert redirected[0].tape.to_bytes() == redirected[1].tape.to_bytes()


def test_in_a_map_nothing_is_touched(tmp_path):
    """The map reaches both nodes before the task begins."""
    result = run_over_dds(scenario('task_map'), None, tmp_path, record=False)
    assert is_as_expected(result) and measure(result).within_map


def test_a_task_without_a_path_fails_and_says_so(tmp_path):
    """The robot never moves; it gives up after as many attempts as are allowed."""
    walled = scenario('task_map')
    task = dataclasses.replace(walled.task, supervision=dataclasses.replace(
        walled.task.supervision, max_attempts=2))
    goal = Placement(5.0, 0.0, 0.0)
    result = run_over_dds(dataclasses.replace(walled, goal=goal, task=task), None, tmp_path,
                          record=False)
    assert result.outcome is Outcome.FAILED and 'does not fit into the map' in result.reason
    assert not result.tape['robot_v_x'].any() and result.recoveries == 2
