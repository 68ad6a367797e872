"""What came of a task, in process or over DDS."""

import dataclasses
import math

from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.geometry import distance, wrap_angle
from push_model.trajectory import PushTrajectory
from push_scenario.definition.scenario import Scenario
from push_sim_node.tape import Tape

OUTCOMES = ('done', 'failed', 'time_limit', 'refused')


@dataclasses.dataclass(frozen=True, eq=False)
class Result:
    """
    One run of a scenario under one control law.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``.
    :param outcome: ``done`` (the controller says so), ``failed`` (it gave up), ``time_limit``, or
        ``refused`` (the planner found no push).
    :param reason: one sentence on why it ended so.
    :param plan: the ``PushTrajectory`` that was followed; None where the goal was refused.
    :param tape: the ``Tape``; None where nothing moved.
    :param end_time: when the controller ended the push, before everything came to rest [s].
    :raises ValueError: where the outcome is none of these, or lacks its plan or tape.
    """

    scenario: Scenario
    control_law: str
    outcome: str
    reason: str = ''
    plan: PushTrajectory | None = None
    tape: Tape | None = None
    end_time: float = 0.0

    def __post_init__(self):
        """Check that the parts fit the outcome."""
        if self.outcome not in OUTCOMES:
            raise ValueError(f'Result.outcome: got {self.outcome!r}, expected one of '
                             + ', '.join(OUTCOMES))
        if self.outcome != 'refused' and (self.plan is None or self.tape is None):
            raise ValueError(f'Result.tape: got plan {self.plan} and tape {self.tape}, expected '
                             f'both for the outcome {self.outcome!r}')


class TaskHistory:
    """Keeps every change of state, and counts recoveries, over all goals."""

    def __init__(self):
        """Begin with nothing seen."""
        self._changes, self._before, self._recoveries = [], 0, 0

    @property
    def changes(self):
        """Tuple of ``StateChange``."""
        return tuple(self._changes)

    @property
    def recoveries(self):
        """Number of times that something went wrong."""
        return self._before + self._recoveries

    def note(self, changes, recoveries):
        """
        Take in what the supervisor tells, again and again.

        :param changes: ``StateChange`` sequence, oldest first; those that are known are passed over.
        :param recoveries: number of recoveries since the present goal was set.
        """
        new = []
        for change in reversed(changes):
            if self._changes and StateChange(*change) == self._changes[-1]:
                break
            new.append(StateChange(*change))
        self._changes += reversed(new)
        if recoveries < self._recoveries:
            self._before += self._recoveries
        self._recoveries = recoveries


@dataclasses.dataclass(frozen=True, eq=False)
class TaskResult:
    """
    One task.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``.
    :param outcome: ``done``, ``failed`` or ``time_limit``.
    :param reason: one sentence on why it ended so.
    :param status: the last ``SupervisorStatus``.
    :param tape: the ``Tape``.
    :param duration: simulated time that it took, before everything came to rest [s].
    :param history: ``StateChange`` of every state, over all goals.
    :param recoveries: number of times that something went wrong, likewise.
    :param plans: ``TaskPlan`` that each push was the first of, in order; empty over DDS.
    :param single: time of the best single push from the start [s], infinite where there is none;
        nan where nobody has asked.
    """

    scenario: Scenario
    control_law: str
    outcome: str
    reason: str
    status: SupervisorStatus
    tape: Tape
    duration: float
    history: tuple = ()
    recoveries: int = 0
    plans: tuple = ()
    single: float = math.nan

    @property
    def pushes(self):
        """Number of pushes that were begun."""
        return sum(change.state is TaskState.PUSH for change in self.history)

    @property
    def position_error(self):
        """True distance of the object from its goal at the end [m]."""
        return distance(self.tape.poses('object')[-1], self.scenario.final_goal)

    @property
    def heading_error(self):
        """True heading of the object at the end less that of its goal [rad]."""
        return wrap_angle(self.tape.poses('object')[-1][2] - self.scenario.final_goal.theta)
