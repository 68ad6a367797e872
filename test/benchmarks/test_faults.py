"""A part of the campaign of faults: no run ends unexplained."""

import math

from benchmarks.faults.campaign import Case, draw, run
from benchmarks.faults.injection import Fault, Input, SIMULATED, Word, words_of
from benchmarks.faults.report import table
from benchmarks.faults.row import Ending
import pytest

pytestmark = pytest.mark.slow
PUSH, TASK = 'curved_push', 'task_tap'
# Greatest distance driven after the beginning of a fault that shows at once [m]: 0.3 s of a push.
STOPPING_DISTANCE = 0.05


@pytest.mark.parametrize('kind, word, text', [
    (Input.COMMAND, Word.OFF, 'the robot does not move as commanded'),
    (Input.COMMAND, Word.WRONG, 'the robot moves otherwise than commanded'),
    (Input.ODOMETRY, Word.WRONG, 'odometry has jumped by 0.30 m and 29 deg'),
    (Input.ODOMETRY, Word.STUCK, 'odometry repeats one pose'),
    (Input.ODOMETRY, Word.OFF, 'odometry is stale'),
    (Input.POSE, Word.STUCK, 'the tracker is frozen'),
    (Input.POSE, Word.GARBAGE, 'object pose jumps by'),
    (Input.POSE, Word.SLOW, 'object pose is stale'),
    (Input.POSE, Word.OFF, 'object pose is stale')])
def test_a_push_ends_stopped_and_named(kind, word, text):
    """With a fault that lasts."""
    row = run(Case(PUSH, Fault(kind, word, 4.0, math.inf)), time_after=22.0)
    assert row.is_explained and row.ending is not Ending.DONE
    assert text in row.reason
    # As far as a pose may be old that is still used, besides.
    assert row.driven < STOPPING_DISTANCE + (0.04 if kind is Input.POSE else 0.0)


@pytest.mark.parametrize('kind, word', [
    (Input.ODOMETRY, Word.STUCK), (Input.COMMAND, Word.OFF), (Input.POSE, Word.GARBAGE)])
def test_a_task_goes_on_after_a_fault(kind, word):
    """Until it is done."""
    row = run(Case(TASK, Fault(kind, word, 1.0, 2.0)), time_after=40.0)
    assert row.ending is Ending.DONE and row.is_explained


@pytest.mark.parametrize('kind, word, text', [
    (Input.COMMAND, Word.OFF, 'the robot does not move as commanded'),
    (Input.POSE, Word.INTERMITTENT, 'object pose is stale')])
def test_a_task_gives_up_where_a_fault_stays(kind, word, text):
    """And names it."""
    row = run(Case(TASK, Fault(kind, word, 1.2, math.inf)))
    assert row.ending is Ending.FAILED and row.is_explained and text in row.reason


def test_every_word_is_drawn_for_every_input():
    """And has a line in the table."""
    drawn = draw([PUSH, TASK], seed=1, count=2)
    # For both scenarios, moments and durations.
    words = {kind: len(words_of(kind)) for kind in Input}
    assert len(drawn) == 4 * (sum(words.values()) + sum(words[kind] for kind in SIMULATED))
    assert draw([PUSH, TASK], seed=1, count=2) == drawn
    row = run(Case(PUSH, Fault(Input.POSE, Word.SLOW, 1.0, 1.5)), time_after=1.0)
    lines = table([row._replace(fault=case.fault) for case in drawn]).splitlines()
    assert len(lines) == 2 + 2 * sum(words.values())
