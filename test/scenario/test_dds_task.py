"""Whole tasks over Fast DDS, in lockstep: three nodes in three processes each."""

import dataclasses

from helpers.extras import import_extra
import numpy as np
from push_control.events import TaskEvent
from push_control.task.status import TaskState
from push_model.geometry import distance
from push_ros.conversions.primitives import nanoseconds
from push_scenario.dds.bag_playback import play_back
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
LATER = LaterGoal(Placement(1.0, 0.6, 0.0), 12.0)
# Until when the second replay goes: the first push has ended by then, and the goal has changed.
SECOND_END = 16.0

pytestmark = [pytest.mark.dds, pytest.mark.slow]


def scenario(name, **changes):
    """Load a scenario of the package, and change some of it."""
    return dataclasses.replace(load_scenario(name), **changes)


def redirected():
    """Return a task whose robot stands on the wrong side, and whose goal changes in between."""
    first = scenario('task_approach')
    return dataclasses.replace(first, task=dataclasses.replace(first.task, goals=(LATER,)))


@pytest.fixture(scope='module')
def twice(tmp_path_factory):
    """Replay it twice, the second time not to its end."""
    folder = tmp_path_factory.mktemp('twice')
    return [run_over_dds(dataclasses.replace(redirected(), time_limit=limit), None,
                         folder / name, record=name == 'whole')
            for name, limit in (('whole', redirected().time_limit), ('part', SECOND_END))]


def test_the_object_arrives_although_the_robot_stands_on_the_wrong_side(twice):
    """Within 10 mm and 1 degree, with poor sensors and odometry; the robot is clear of it."""
    result = twice[0]
    assert result.outcome is Outcome.DONE and is_as_expected(result)
    assert result.position_error < NEAR and abs(result.heading_error) < TURNED
    assert measure(result).gap > result.scenario.task.drive.clearance


def test_a_goal_that_changes_in_between_is_reached(twice):
    """From the time on that the scenario says."""
    assert distance(twice[0].tape.poses('object')[-1], LATER.goal.pose) < NEAR
    for result in twice:
        changed, = [change for change in result.history[1:] if TaskEvent.NEW_GOAL in change.codes]
        assert changed.time == pytest.approx(LATER.time, abs=0.1)


def test_lockstep_twice_gives_the_same_tape(twice):
    """However long the planner thinks: time waits for it."""
    whole, part = (result.tape.rows[result.tape['time'] < SECOND_END] for result in twice)
    assert whole.tobytes() == part.tobytes() and len(part) > 500
    assert twice[1].outcome is Outcome.TIME_LIMIT
    assert [change for change in twice[0].history if change.time < SECOND_END] == [
        change for change in twice[1].history if change.time < SECOND_END]


def test_a_task_over_dds_goes_as_in_process(twice):
    """Until the first push has ended; then it tells when late poses count as new."""
    expected = simulate(redirected(), planning_time=0.0)
    for change, other in zip(twice[0].history[:4], expected.history[:4]):
        assert change.state is other.state
        assert change.time == pytest.approx(other.time, abs=0.5)
    assert is_as_expected(expected)


def test_the_recording_is_played_back_with_the_same_commands(twice):
    """Through filter and supervisor: nearly all to the byte, and the others to rounding."""
    result = play_back(twice[0].scenario, twice[0].bag)
    assert result.commands > 300 and len(result.differences) < 0.05 * result.commands
    for difference in result.differences:
        assert difference.computed == pytest.approx(difference.recorded, abs=1e-9)


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
    assert stamps[0] == stamps[1] == stamps[2]
    states = [change.state for change in twice[0].history]
    assert len(stamps[0]) == states.count(TaskState.APPROACH) >= twice[0].pushes
    end = received['/planned_path'][-1].poses[-1].pose.position
    assert distance((end.x, end.y), LATER.goal.pose) < 0.02
    shown = {marker.text for message in received['/markers'] for marker in message.markers}
    assert {'approach', 'push'} <= shown


def test_in_a_map_nothing_is_touched(tmp_path):
    """The map reaches both nodes before the task begins: the robot comes through the door."""
    result = run_over_dds(scenario('task_map', time_limit=16.0), None, tmp_path, record=False)
    assert result.outcome is Outcome.TIME_LIMIT
    assert result.pushes == 1
    assert result.tape['robot_x'][0] > 0.0 > result.tape['robot_x'][-1]
    assert measure(result).within_map


def test_a_camera_on_the_robot_finds_the_object_and_brings_it_to_its_goal(tmp_path):
    """The object is behind the robot at first; its poses are relative to the robot."""
    result = run_over_dds(scenario('task_own_camera'), None, tmp_path, record=False)
    assert result.outcome is Outcome.DONE and is_as_expected(result)
    states = [change.state for change in result.history]
    assert states.index(TaskState.LOOK) < states.index(TaskState.APPROACH)
