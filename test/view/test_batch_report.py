"""The report of a batch: tables, failures that are replayed, and a bound on its size."""

import base64
import dataclasses
import gzip
import json
import re

from helpers.browser import open_browser
from helpers.tapes import make_result, make_tape, straight_plan, TIMES
from push_scenario.batch.batch import run_batch
from push_view import batch_table, write_batch_report
import pytest


def reached(job):
    """Say how far a push of a batch gets: a job is its speed."""
    if job < 0.0:
        raise ValueError('too slow')
    return {'distance': 10.0 * job, 'success': job > 0.15}


def replay(job):
    """Run the push of a job."""
    tape = make_tape(object_x=job * TIMES, robot_x=job * TIMES - 0.38, mode=1.0, force_n=3.0)
    result = make_result(tape, straight_plan(), (2.0, 0.0, 0.0))
    return dataclasses.replace(result, reason=f'only at {job} m/s'), None


def unpacked(text):
    """Return what was packed."""
    return json.loads(gzip.decompress(base64.b64decode(text)))


def document(path):
    """Return what a report holds."""
    return unpacked(re.search(r'id="recording">([^<]+)<', path.read_text())[1])


@pytest.fixture(scope='module')
def failures():
    """Run a batch of five pushes, of which two get too short and one ends with an error."""
    batch = run_batch(reached, [0.1, 0.2, -1.0, 0.3, 0.05], workers=1)
    return batch_table(batch, lambda record: not record['success'], replay)


def test_failures_alone_are_listed_and_replayed(failures, tmp_path):
    """What ended with an error has no run; a run holds what the page shows of it."""
    path = tmp_path / 'batch.html'
    assert write_batch_report([failures], path, 'a batch') == 0
    held = document(path)
    table, = held['tables']
    assert table['title'] == '3 of 5 failed'
    assert [line[0] for line in table['lines']] == ['job', '0', '2', '4']
    assert table['lines'][2][-1].endswith('too slow')
    assert table['runs'] == {'1': 0, '3': 1}
    messages = unpacked(held['runs'][1]['packed'])['messages']
    columns = messages[0]['columns']
    assert {'time', 'object_x', 'robot_theta', 'force_n'} < set(columns)
    assert not {'command_v_x', 'energy_work'} & set(columns)
    rows, = [message['rows'] for message in messages if message['type'] == 'rows']
    assert rows[-1][columns.index('object_x')] == pytest.approx(0.5)


def test_a_report_keeps_within_its_size(failures, tmp_path):
    """Runs beyond it are left out, and counted."""
    path = tmp_path / 'batch.html'
    write_batch_report([failures], path, 'a batch')
    one = len(document(path)['runs'][0]['packed'])
    assert write_batch_report([failures], path, 'a batch', max_size=one) == 1
    held = document(path)
    assert held['tables'][0]['runs'] == {'1': 0} and len(held['tables'][0]['lines']) == 4
    assert held['notes'][0].startswith('1 more')


@pytest.mark.browser
@pytest.mark.slow
def test_a_failure_is_replayed_in_the_browser(failures, tmp_path):
    """From disk: the table first, the run once its link is followed, then another."""
    path = tmp_path / 'batch.html'
    write_batch_report([failures], path, 'a batch')
    with open_browser() as browser:
        browser.open(path.as_uri(), 380, 800, prefers_reduced_motion='reduce')
        browser.wait('document.querySelectorAll("#batch a").length === 2')
        assert browser.run('return document.querySelector("main").offsetParent') is None
        assert browser.run('return document.documentElement.scrollWidth') <= 380
        for number, distance in enumerate((1.0, 0.5)):
            browser.run('document.querySelectorAll("#batch a")[arguments[0]].click()', number)
            browser.wait(f'Math.abs(app.recording.at(10)("object_x") - {distance}) < 1e-4')
        # The table is that of one run, not of both.
        titles = browser.run('return [...document.querySelectorAll("#results tbody th")].map('
                             'e => e.textContent)')
        assert len(titles) == len(set(titles)) > 3
        assert browser.errors() == []
