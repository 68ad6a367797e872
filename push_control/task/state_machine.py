"""
States of a task, and the transitions between them.

Repeated pushes, when all goes well:

    PLAN -> APPROACH -> ALIGN -> PUSH -> RETREAT -> PLAN -> ... -> DONE

A straight push finds the contact by itself: it skips ALIGN. A robot that does not see the object
from everywhere looks at it after each push, and whenever it is not in view:

    ... -> RETREAT -> LOOK -> PLAN -> ...        PLAN -> LOOK -> PLAN

A single push starts where the robot
stands, and nothing follows it:

    PLAN -> PUSH -> DONE
"""

from collections.abc import Mapping
from typing import NamedTuple

from push_control.goal import TaskFailure
from push_control.task.status import FINAL_STATES, StateChange, TaskState
from push_model.events import AnyReport, codes, sentence


class Transitions(NamedTuple):
    """
    Transitions of a state in which the robot acts.

    :param success: state after the end of its behaviour.
    :param failure: state after its failure.
    :param restart: state from which another plan is sought, as for a new goal.
    :param cancellation: state after the task was cancelled.
    """

    success: TaskState
    failure: TaskState
    restart: TaskState
    cancellation: TaskState


class TransitionTable(NamedTuple):
    """
    Transitions of the states of a task.

    :param transitions: ``Transitions`` of each state in which the robot acts.
    :param exceptions: further states to which a state may lead.
    :param interruptions: states to which all of those may lead in which the robot acts.
    :param resumptions: states to which all others may lead.
    :param lost: states in which a task that is stopped is over, and not started again.
    """

    transitions: Mapping[TaskState, Transitions]
    exceptions: Mapping[TaskState, frozenset[TaskState]]
    interruptions: frozenset[TaskState]
    resumptions: frozenset[TaskState]
    lost: frozenset[TaskState]

    def successors(self, state: TaskState) -> frozenset[TaskState]:
        """List the states that a state may lead to."""
        further = self.exceptions.get(state, frozenset[TaskState]())
        if state.is_standing:
            return self.resumptions | further
        return frozenset(self.transitions[state]) | self.interruptions | further


# A robot in contact backs off first. A retreat that fails is not repeated: the path to the next
# pre-push pose may lead off the object. Besides these transitions a task under way may be stopped,
# paused, given up, or planned again at once where the robot was put elsewhere; one that rests goes
# on with a plan, or a retreat after a pause.
REPEATED_PUSHES_TABLE = TransitionTable(
    transitions={
        TaskState.PLAN: Transitions(TaskState.APPROACH, TaskState.PLAN, TaskState.PLAN,
                                    TaskState.IDLE),
        TaskState.APPROACH: Transitions(TaskState.ALIGN, TaskState.PLAN, TaskState.PLAN,
                                        TaskState.IDLE),
        TaskState.ALIGN: Transitions(TaskState.PUSH, TaskState.RETREAT, TaskState.RETREAT,
                                     TaskState.RETREAT),
        TaskState.PUSH: Transitions(TaskState.RETREAT, TaskState.RETREAT, TaskState.RETREAT,
                                    TaskState.RETREAT),
        TaskState.RETREAT: Transitions(TaskState.PLAN, TaskState.PLAN, TaskState.RETREAT,
                                       TaskState.RETREAT),
        TaskState.LOOK: Transitions(TaskState.PLAN, TaskState.PLAN, TaskState.PLAN,
                                    TaskState.IDLE)},
    exceptions={
        TaskState.PLAN: frozenset({TaskState.DONE, TaskState.RETREAT, TaskState.LOOK}),
        TaskState.APPROACH: frozenset({TaskState.PUSH}),
        TaskState.RETREAT: frozenset({TaskState.LOOK}),
        TaskState.PAUSED: frozenset({TaskState.RETREAT})},
    interruptions=frozenset({TaskState.IDLE, TaskState.PAUSED, TaskState.FAILED, TaskState.PLAN}),
    resumptions=frozenset({TaskState.IDLE, TaskState.PLAN}),
    lost=frozenset(FINAL_STATES))
# The robot backs off only from a push that was cancelled. An object may turn out to be at its goal
# already, and a plan that nobody has requested may be driven whatever the robot does. A goal
# without a plan does not outlast a stop.
SINGLE_PUSH_TABLE = TransitionTable(
    transitions={
        TaskState.PLAN: Transitions(TaskState.PUSH, TaskState.FAILED, TaskState.PLAN,
                                    TaskState.IDLE),
        TaskState.PUSH: Transitions(TaskState.DONE, TaskState.FAILED, TaskState.PLAN,
                                    TaskState.RETREAT),
        TaskState.RETREAT: Transitions(TaskState.IDLE, TaskState.IDLE, TaskState.PLAN,
                                       TaskState.RETREAT)},
    exceptions={TaskState.PLAN: frozenset({TaskState.DONE}),
                TaskState.RETREAT: frozenset({TaskState.PUSH})},
    interruptions=frozenset({TaskState.IDLE, TaskState.FAILED, TaskState.PLAN}),
    resumptions=frozenset({TaskState.IDLE, TaskState.PLAN, TaskState.PUSH}),
    lost=frozenset({TaskState.PLAN, TaskState.RETREAT, *FINAL_STATES}))


class TaskStateMachine:
    """
    The present state of a task, and how it has come to it.

    ``table``: the ``TransitionTable``. ``state``: the ``TaskState``. ``cause``: ``Report`` of why,
    None while all is well. ``since``: when it was entered [s]. ``is_requested``: whether the user
    asked for it. ``failure``: the ``TaskFailure`` of a task that was given up, else None.
    ``pushes``, ``recoveries``: number of them since the task was started. ``history``: every
    ``StateChange`` since then.
    """

    def __init__(self, table: TransitionTable) -> None:
        """Start idle."""
        self.table = table
        self.state = TaskState.IDLE
        self.cause: AnyReport | None = None
        self.since = 0.0
        self.is_requested = False
        self.failure: TaskFailure | None = None
        self._paused_state = TaskState.IDLE
        self.start_task()

    def start_task(self) -> None:
        """Count and record from now on; the state stays."""
        self.pushes = 0
        self.recoveries = 0
        self.history: tuple[StateChange, ...] = ()

    @property
    def restart_state(self) -> TaskState:
        """State in which another plan is sought; of a paused task, from where it was paused."""
        state = self._paused_state if self.state is TaskState.PAUSED else self.state
        return TaskState.PLAN if state.is_standing else self.table.transitions[state].restart

    @property
    def cancellation_state(self) -> TaskState:
        """State after the task was cancelled."""
        if self.state.is_standing:
            return TaskState.IDLE
        return self.table.transitions[self.state].cancellation

    def leads_to(self, state: TaskState) -> bool:
        """Tell whether the present state may lead to another one."""
        return state in self.table.successors(self.state)

    def enter(self, state: TaskState, time: float, cause: AnyReport | None = None, *,
              is_requested: bool = False, failure: TaskFailure | None = None) -> None:
        """
        Change the state.

        :param state: the next ``TaskState``; may be the present one.
        :param time: now [s].
        :param cause: ``Report`` of why; None where all goes as it should.
        :param is_requested: whether the user asked for it, so that the cause is no fault.
        :param failure: the ``TaskFailure`` for which the task is given up, or None.
        :raises ValueError: where the present state does not lead to it.
        """
        if not self.leads_to(state):
            expected = sorted(each.value for each in self.table.successors(self.state))
            raise ValueError(f'state: got {state} after {self.state}, expected one of {expected}')
        if state is TaskState.PAUSED:
            self._paused_state = self.state
        if state is TaskState.PUSH:
            self.pushes += 1
        self.state = state
        self.cause = cause
        self.since = time
        self.is_requested = is_requested
        self.failure = failure
        self.note(time, cause, is_requested=is_requested)

    def count_recovery(self) -> None:
        """Count a failure that the task goes on from."""
        self.recoveries += 1

    def note(self, time: float, cause: AnyReport | None, *, is_requested: bool = False) -> None:
        """
        Record what has happened in the present state.

        :param time: now [s].
        :param cause: ``Report`` of it; None where all goes as it should.
        :param is_requested: whether the user asked for it.
        """
        change = StateChange(time, self.state, sentence(cause), is_requested, codes(cause))
        self.history += (change,)
