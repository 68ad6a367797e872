"""A report is one file that holds all it shows."""

import base64
import dataclasses
import gzip
import json
import re

from helpers.tapes import make_result, make_tape, straight_plan, TIMES
import numpy as np
from push_control.task.status import StateChange, TaskState
from push_model.friction import friction_center
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.definition.task import LaterGoal
from push_scenario.simulation.result import Outcome, RunResult
from push_sim_node.disturbance import FrictionChange, ObjectDisplacement
from push_view import write_report
from push_view.belief import BeliefRecorder
from push_view.page_file import page_html
from push_view.recording import recording
import pytest

GOAL = (2.0, 0.0, 0.0)


def result_of_push(**columns):
    """Run of a straight push whose object moves evenly."""
    moved = {'object_x': 0.2 * TIMES, 'robot_x': 0.2 * TIMES - 0.4, 'mode': 1, 'force_n': 1.0}
    return make_result(make_tape(**{**moved, **columns}), straight_plan(), GOAL)


def of_kind(messages, kind):
    """List the messages of a kind."""
    return [message for message in messages if message['type'] == kind]


def unpacked(path):
    """Return the document that a report holds."""
    text = re.search(r'id="recording">([^<]+)<', path.read_text())[1]
    return json.loads(gzip.decompress(base64.b64decode(text)))


def test_a_recording_holds_the_whole_tape():
    """Every number to 10 um; what is not finite is null."""
    result = result_of_push(pushing_angle=np.nan)
    messages = recording(result)
    scene, = of_kind(messages, 'scene')
    rows, = of_kind(messages, 'rows')
    assert messages[0] is scene and tuple(scene['columns']) == result.tape.columns
    received = np.array(rows['rows'], dtype=float)
    assert np.allclose(received, result.tape.rows, atol=0.5e-5, rtol=0.0, equal_nan=True)
    assert rows['rows'][0][scene['columns'].index('pushing_angle')] is None
    assert [message['state'] for message in of_kind(messages, 'state')] == ['push', 'done']


def test_a_recording_holds_what_changes_under_way():
    """Later goals, friction while it is changed, and displacements, each at its time."""
    task = load_scenario('task_tap')
    changed = dataclasses.replace(
        task, task=dataclasses.replace(
            task.task, goals=(LaterGoal(Placement(0.5, 0.5, 0.1), time=4.0),)),
        simulation=dataclasses.replace(
            task.simulation, friction_changes=(FrictionChange(2.0, 3.0, 0.5, support=1),),
            object_displacements=(ObjectDisplacement(5.0, x=0.1),)))
    history = (StateChange(0.0, TaskState.PLAN, ''), StateChange(9.0, TaskState.DONE, ''))
    position = np.where(TIMES >= 5.0, 0.1, 0.0)
    messages = recording(RunResult(changed, 'feedback', Outcome.DONE, '',
                                   make_tape(object_x=position), 9.0, history))
    assert [message['time'] for message in of_kind(messages, 'goal')] == [0.0, 4.0]
    before, during, after = of_kind(messages, 'truth')
    assert (during['time'], after['time']) == (2.0, 3.0)
    assert during['friction'][1] == pytest.approx(0.5 * before['friction'][1])
    assert after == {**before, 'time': 3.0}
    assert before['friction_center'] == pytest.approx(friction_center(task.true_object), abs=1e-5)
    displaced, = of_kind(messages, 'displacement')
    assert displaced['after'][0] - displaced['before'][0] == pytest.approx(0.1)


def test_a_recording_shows_what_touched_a_wall():
    """Once each, where and when the rim came in, and not while it stays inside."""
    task = load_scenario('task_tap')
    walled = dataclasses.replace(task, task=dataclasses.replace(
        task.task, map=FloorMap(0.5, '\n'.join(['....#'] * 4), Placement(-1.0, -1.0, 0.0))))
    tape = make_tape(object_x=0.1 * TIMES, robot_x=-0.5)
    messages = recording(RunResult(walled, 'feedback', Outcome.DONE, '', tape, 9.0, ()))
    collision, = of_kind(messages, 'collision')
    reach = max(x for x, _ in task.true_object.outline)
    assert collision['body'] == 'object'
    assert collision['time'] == pytest.approx((1.0 - reach) / 0.1, abs=0.2)
    assert collision['point'][0] == pytest.approx(1.0, abs=0.01)


def test_a_report_needs_nothing_but_itself(tmp_path):
    """It refers to no file and to no network; equal runs give equal bytes."""
    results = [dataclasses.replace(result_of_push(), control_law=law)
               for law in ('feedback', 'open_loop')]
    for name in ('one', 'two'):
        write_report(results, tmp_path / f'{name}.html')
    one, two = (tmp_path / f'{name}.html' for name in ('one', 'two'))
    assert one.read_bytes() == two.read_bytes()
    text = re.sub(r'http://www\.w3\.org/\S+', '', one.read_text())
    assert not re.search(r'https?://|src=|<link', text)
    assert "connect-src 'none'" in text and "connect-src 'self'" in page_html('live')
    document = unpacked(one)
    assert [run['name'] for run in document['runs']] == ['feedback', 'open loop']
    assert document['table'][0][2:4] == ['feedback', 'open loop']


def test_a_title_cannot_break_the_page():
    """It is text, whatever it holds."""
    assert '<title>&lt;script&gt;</title>' in page_html('<script>')


def test_what_was_not_recorded_is_not_known():
    """A belief that nobody took down is null in every column."""
    result = result_of_push()
    beliefs = BeliefRecorder(result.scenario.object)
    rows, = of_kind(recording(result, beliefs), 'rows')
    width = len(beliefs.columns)
    assert all(row[-width:] == [None] * width for row in rows['rows'])


def test_a_run_that_is_done_elsewhere_has_missed():
    """The page is told by how much and against what bound; of one that arrives, nothing."""
    for speed, missed in ((0.2, []), (0.1, ['position error 1000.0 mm, bound 10.0 mm'])):
        tape = make_tape(object_x=speed * TIMES, robot_x=speed * TIMES - 0.4, mode=1)
        ending, = of_kind(recording(make_result(tape, straight_plan(), (2.0, 0.0, 0.0))), 'ending')
        assert ending['missed'] == missed
        assert ending['outcome'] == ('missed' if missed else 'done')


def test_a_refused_goal_is_reported_without_rows():
    """Nothing moved, and the reason is there."""
    refused = RunResult(load_scenario('unreachable_goal'), 'feedback', Outcome.REFUSED, 'too far')
    messages = recording(refused)
    assert not of_kind(messages, 'rows')
    assert of_kind(messages, 'ending')[0]['reason'] == 'too far'
