"""State histories: nothing is lost or counted twice over several goals."""

from push_control.task.status import StateChange, TaskState
from push_scenario.simulation.history import single_push_history, StateHistory
from push_scenario.simulation.result import Outcome
import pytest

PLANNED, APPROACHED = (StateChange(0.0, TaskState.PLAN, ''),
                       StateChange(1.0, TaskState.APPROACH, ''))
MOVED = StateChange(2.0, TaskState.PLAN, 'moved')
REDIRECTED = StateChange(3.0, TaskState.PLAN, 'new')
LOST = StateChange(4.0, TaskState.PLAN, 'lost')


def test_history_goes_on_over_goals():
    """Known changes are skipped; recoveries of the goal before are kept."""
    history = StateHistory()
    history.update([PLANNED], 0)
    history.update([PLANNED, APPROACHED, MOVED], 1)
    history.update([PLANNED, APPROACHED, MOVED], 1)
    history.update([REDIRECTED], 0)
    history.update([REDIRECTED, LOST], 1)
    assert history.changes == (PLANNED, APPROACHED, MOVED, REDIRECTED, LOST)
    assert history.recoveries == 2


@pytest.mark.parametrize('outcome, states', [
    (Outcome.DONE, [TaskState.PUSH, TaskState.DONE]),
    (Outcome.FAILED, [TaskState.PUSH, TaskState.FAILED]),
    (Outcome.TIME_LIMIT, [TaskState.PUSH])])
def test_a_single_push_has_the_history_of_a_task_with_one_push(outcome, states):
    """It starts at time 0 and ends with the outcome, at its time and for its reason."""
    history = single_push_history(outcome, 'because', 5.0)
    assert [change.state for change in history] == states
    assert history[0] == StateChange(0.0, TaskState.PUSH, '')
    assert history[1:] in ((), (StateChange(5.0, states[-1], 'because'),))
