"""Codes of what has happened pass messages and files unchanged."""

import itertools

from push_control.events import TaskEvent
from push_control.task.code_text import CODE_KINDS, code_text, codes_of_text
from push_model.events import Cause
from push_model.plan_request import PlanFailure
from push_safety.status import SafetyReason
import pytest

CODES = [code for kind in CODE_KINDS for code in kind]


def test_codes_come_back_as_they_were_written():
    """In their order, all of them at once."""
    assert codes_of_text(code_text(tuple(CODES))) == tuple(CODES)
    assert code_text(()) == '' and codes_of_text('') == ()


def test_no_text_means_two_codes():
    """Whatever enumeration they are of."""
    assert len({code_text((code,)) for code in CODES}) == len(CODES)


def test_every_cause_has_a_text():
    """Each enumeration of causes is one that can be read."""
    assert set(Cause.__subclasses__()) <= set(CODE_KINDS)


@pytest.mark.parametrize('unknown', ['TaskEvent.OF_ANOTHER_VERSION', 'nonsense', '1'])
def test_codes_of_another_version_are_left_out(unknown):
    """The others are read."""
    text = f'{unknown} {SafetyReason.NOT_MOVING}'
    assert codes_of_text(text) == (SafetyReason.NOT_MOVING,)


def test_members_of_a_cause_are_no_aliases():
    """Of two with one template the second would be the first."""
    for kind in CODE_KINDS:
        assert len(kind) == len(kind.__members__)


def test_a_report_tells_what_is_behind_it():
    """Its own code first, then those of what its sentence quotes, however deep."""
    reports = [TaskEvent.NO_GOAL.report()]
    for cause in (TaskEvent.ABORTED, TaskEvent.PLANNING_FAILED_AGAIN, TaskEvent.NO_PLAN):
        reports.append(cause.report(reason=reports[-1], failure=PlanFailure.TIPS))
    for inner, outer in itertools.pairwise(reports):
        assert str(inner) in str(outer)
        assert outer.codes == (outer.code, *inner.codes, PlanFailure.TIPS)
