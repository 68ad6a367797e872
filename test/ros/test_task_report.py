"""Diagnostics of a task: their level, their codes, and what a task that is done knows."""

from types import SimpleNamespace

from push_control.behaviors.failures import BehaviorFailure
from push_control.events import TaskEvent
from push_control.perception.view import View
from push_control.ros.task_report import TaskReporter
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.events import codes, sentence
from push_model.signals import PoseDeviation
from push_ros.diagnostics import ERROR, OK, WARN
import pytest

DEVIATION = PoseDeviation(0.021, 0.023)
BY_ODOMETRY = TaskEvent.DONE_BY_ODOMETRY.report(position=21.0, heading=1.3)


def report_of(state, cause, *, is_requested=False, deviation=None, view=View()):
    """Report one change of state; return the level and the values."""
    reported = []
    node = SimpleNamespace(reporter=SimpleNamespace(
        report=lambda level, text, values, always: reported.append((level, values))))
    change = StateChange(1.0, state, sentence(cause), is_requested, codes(cause))
    status = SupervisorStatus(state, sentence(cause), 1.0, history=(change,),
                              is_requested=is_requested, codes=codes(cause),
                              goal_deviation=deviation)
    supervisor = SimpleNamespace(
        history=status.history, status=status, state=state, reason=status.reason,
        perception=SimpleNamespace(base_knowledge=None, view=view))
    TaskReporter(node, SimpleNamespace()).report(supervisor, 1.0)
    return reported[0]


@pytest.mark.parametrize('state, cause, is_requested, level', [
    (TaskState.DONE, None, False, OK),
    (TaskState.DONE, BY_ODOMETRY, False, OK),
    (TaskState.PLAN, TaskEvent.NEW_GOAL.report(), True, OK),
    (TaskState.RETREAT, BehaviorFailure.OBJECT_NOT_MOVED.report(), False, WARN),
    (TaskState.PAUSED, None, True, WARN),
    (TaskState.FAILED, TaskEvent.ABORTED.report(reason=BY_ODOMETRY), False, ERROR),
], ids=str)
def test_only_what_is_wrong_is_a_warning(state, cause, is_requested, level):
    """A task that is done by odometry is done: its code says what nobody can know."""
    assert report_of(state, cause, is_requested=is_requested)[0] == level


def test_the_deviation_of_the_goal_is_told_where_there_is_one():
    """Beside the codes; without one there are no such values."""
    values = report_of(TaskState.DONE, BY_ODOMETRY, deviation=DEVIATION)[1]
    assert values['codes'] == str(TaskEvent.DONE_BY_ODOMETRY)
    assert (values['position_deviation'], values['heading_deviation']) == DEVIATION
    assert 'position_deviation' not in report_of(TaskState.DONE, None)[1]


def test_a_view_is_told_where_it_is_limited() -> None:
    """As the text of a diagnostic, from which a display reads the same view."""
    view = View(0.6, 0.18)
    values = report_of(TaskState.PLAN, None, view=view)[1]
    assert View.from_report({name: str(value) for name, value in values.items()}) == view
    assert View.from_report(report_of(TaskState.PLAN, None)[1]) is None
    assert View.from_report({**values, 'view_angle': 'wide'}) is None
