"""States of a task lead only where they may, and what has happened is counted and recorded."""

from push_control.events import TaskEvent
from push_control.goal import TaskFailure
from push_control.task.state_machine import (
    REPEATED_PUSHES_TABLE, SINGLE_PUSH_TABLE, TaskStateMachine)
from push_control.task.status import StateChange, TaskState
import pytest

PUSH_CYCLE = (TaskState.PLAN, TaskState.APPROACH, TaskState.ALIGN, TaskState.PUSH,
              TaskState.RETREAT)
# Transitions that no task makes.
OFFENCES = [
    (TaskState.IDLE, TaskState.PUSH), (TaskState.IDLE, TaskState.PAUSED),
    (TaskState.PLAN, TaskState.PUSH), (TaskState.PLAN, TaskState.ALIGN),
    (TaskState.APPROACH, TaskState.DONE), (TaskState.APPROACH, TaskState.RETREAT),
    (TaskState.ALIGN, TaskState.APPROACH), (TaskState.PUSH, TaskState.DONE),
    (TaskState.PUSH, TaskState.APPROACH), (TaskState.PUSH, TaskState.PUSH),
    (TaskState.RETREAT, TaskState.PUSH), (TaskState.RETREAT, TaskState.DONE),
    (TaskState.DONE, TaskState.FAILED), (TaskState.FAILED, TaskState.DONE),
    (TaskState.PAUSED, TaskState.PUSH), (TaskState.PAUSED, TaskState.DONE)]
# Transitions that no single push makes.
SINGLE_OFFENCES = [
    (TaskState.IDLE, TaskState.DONE), (TaskState.IDLE, TaskState.RETREAT),
    (TaskState.PLAN, TaskState.APPROACH), (TaskState.PLAN, TaskState.RETREAT),
    (TaskState.PLAN, TaskState.PAUSED), (TaskState.PUSH, TaskState.ALIGN),
    (TaskState.PUSH, TaskState.PAUSED), (TaskState.PUSH, TaskState.PUSH),
    (TaskState.RETREAT, TaskState.DONE), (TaskState.DONE, TaskState.RETREAT),
    (TaskState.FAILED, TaskState.DONE)]

WHY = TaskEvent.STARTED_OVER.report()
TABLES = {'chain': REPEATED_PUSHES_TABLE, 'single': SINGLE_PUSH_TABLE}
STATES = [(name, state) for name, table in TABLES.items()
          for state in TaskState if state.is_standing or state in table.transitions]
ACTING = [(name, state) for name, table in TABLES.items() for state in table.transitions]


def path_to(goal, table):
    """Return the shortest sequence of states from idle to a state."""
    paths = [(TaskState.IDLE,)]
    for path in paths:
        if path[-1] is goal and (len(path) > 1 or goal is TaskState.IDLE):
            return path[1:]
        paths += [(*path, state) for state in TaskState
                  if state in table.successors(path[-1]) and state not in path]
    raise AssertionError(f'{goal} cannot be reached')


def machine_in(state, table=REPEATED_PUSHES_TABLE):
    """Make a machine that has come to a state in a permitted order."""
    machine = TaskStateMachine(table)
    for time, passed in enumerate(path_to(state, table)):
        machine.enter(passed, float(time))
    assert machine.state is state
    return machine


@pytest.mark.parametrize('name, state', STATES)
def test_every_state_can_be_reached_and_left(name, state):
    """There is no dead end and no orphan in the tables; a single push has no pauses."""
    table = TABLES[name]
    if (name, state) == ('single', TaskState.PAUSED):
        with pytest.raises(AssertionError, match='cannot be reached'):
            path_to(state, table)
        return
    assert machine_in(state, table).state is state
    assert table.successors(state) - {state}


@pytest.mark.parametrize('name, before, after', [
    *(('chain', *offence) for offence in OFFENCES),
    *(('single', *offence) for offence in SINGLE_OFFENCES)])
def test_a_transition_that_is_not_in_the_table_is_refused(name, before, after):
    """The error has both states; state, counts and history stay."""
    machine = machine_in(before, TABLES[name])
    known = machine.history, machine.pushes, machine.since
    with pytest.raises(ValueError, match=f'{after}.*{before}'):
        machine.enter(after, 100.0)
    assert machine.state is before
    assert (machine.history, machine.pushes, machine.since) == known


@pytest.mark.parametrize('name, state', ACTING)
def test_a_task_under_way_can_be_stopped_paused_and_given_up(name, state):
    """From every state in which the robot acts; only a chain of pushes can be paused."""
    machine = machine_in(state, TABLES[name])
    assert machine.leads_to(TaskState.IDLE) and machine.leads_to(TaskState.FAILED)
    assert machine.leads_to(TaskState.PAUSED) == (name == 'chain')


@pytest.mark.parametrize('name, state', ACTING)
def test_a_robot_backs_off_where_it_may_touch_the_object(name, state):
    """Where the task is cancelled; in all other states it stands."""
    touching = {TaskState.ALIGN, TaskState.PUSH, TaskState.RETREAT}
    machine = machine_in(state, TABLES[name])
    expected = TaskState.RETREAT if state in touching else TaskState.IDLE
    assert machine.cancellation_state is expected
    if state is not TaskState.RETREAT:
        machine.enter(expected, 10.0)


def test_pushes_and_recoveries_are_counted_until_a_task_starts():
    """So is the history; the state stays as it is."""
    machine = TaskStateMachine(REPEATED_PUSHES_TABLE)
    for time, state in enumerate(2 * PUSH_CYCLE):
        machine.enter(state, float(time), WHY if state is TaskState.RETREAT else None)
    machine.count_recovery()
    assert (machine.pushes, machine.recoveries) == (2, 1)
    assert machine.history[4] == StateChange(4.0, TaskState.RETREAT, str(WHY), codes=WHY.codes)
    assert machine.cause is WHY and machine.since == 9.0
    machine.start_task()
    assert (machine.pushes, machine.recoveries, machine.history) == (0, 0, ())
    assert machine.state is TaskState.RETREAT


def test_a_failure_lasts_as_long_as_its_state():
    """As does the wish of a user."""
    machine = machine_in(TaskState.PLAN)
    machine.enter(TaskState.FAILED, 5.0, WHY, failure=TaskFailure.NO_PLAN)
    assert machine.failure is TaskFailure.NO_PLAN and not machine.is_requested
    machine.enter(TaskState.PLAN, 6.0, TaskEvent.NEW_GOAL.report(), is_requested=True)
    assert machine.failure is None and machine.is_requested
    assert machine.history[-1].is_requested


@pytest.mark.parametrize('state', REPEATED_PUSHES_TABLE.transitions)
def test_a_paused_task_restarts_from_where_it_was_paused(state):
    """A robot that may touch the object backs off first, before the pause and after it."""
    machine = machine_in(state)
    expected = REPEATED_PUSHES_TABLE.transitions[state].restart
    assert machine.restart_state is expected
    machine.enter(TaskState.PAUSED, 9.0)
    assert machine.restart_state is expected
    machine.enter(machine.restart_state, 10.0)


@pytest.mark.parametrize('state', [TaskState.IDLE, TaskState.DONE, TaskState.FAILED])
def test_a_task_that_is_over_restarts_with_a_plan(state):
    """Wherever the task before it was paused."""
    machine = machine_in(TaskState.PUSH)
    machine.enter(TaskState.PAUSED, 8.0)
    machine.enter(TaskState.IDLE, 9.0)
    for passed in path_to(state, REPEATED_PUSHES_TABLE):
        machine.enter(passed, 10.0)
    assert machine.restart_state is TaskState.PLAN


def test_what_happens_in_a_state_is_recorded_without_a_change():
    """It is no reason for the state, and its time stays."""
    machine = machine_in(TaskState.PLAN)
    machine.note(7.0, WHY)
    assert machine.history[-1] == StateChange(7.0, TaskState.PLAN, str(WHY), codes=WHY.codes)
    assert machine.cause is None and machine.since == 0.0
