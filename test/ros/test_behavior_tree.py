"""Behaviours of py_trees without nodes: how a push that has ended is chosen by."""

from types import SimpleNamespace

from push_ros.behavior_tree import PushFailedWith
from push_ros.commander import PushOutcome, PushResult
from py_trees.common import Status
import pytest

FAILED = PushResult(PushOutcome.ABORTED, 10005,
                    codes=('TaskEvent.ABORTED', 'BehaviorFailure.WHEELS_SPIN'))
DONE = PushResult(PushOutcome.SUCCEEDED, 0, codes=('TaskEvent.DONE_BY_ODOMETRY',))


@pytest.mark.parametrize('result, codes, status', [
    (FAILED, (10005,), Status.SUCCESS),
    (FAILED, (10004, 'BehaviorFailure.WHEELS_SPIN'), Status.SUCCESS),
    (FAILED, (10004, 'PlanFailure.BLOCKED'), Status.FAILURE),
    (FAILED, (), Status.FAILURE),
    (DONE, ('TaskEvent.DONE_BY_ODOMETRY', 0), Status.FAILURE),
    (None, (10005,), Status.FAILURE),
])
def test_a_failed_push_is_chosen_by_any_of_its_codes(result, codes, status):
    """Error code or cause code; a push that has succeeded, or has not ended, by none."""
    behavior = PushFailedWith('choice', SimpleNamespace(result=result), *codes)
    behavior.tick_once()
    assert behavior.status is status
