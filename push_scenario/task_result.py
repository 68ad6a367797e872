"""What came of a task, in process or over DDS."""

import dataclasses
import math

from push_control.task_status import SupervisorStatus
from push_model.geometry import distance, wrap_angle
from push_scenario.scenario import Scenario
from push_scenario.tape import Tape


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
    :param history: ``Change`` of every state, over all goals.
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
        return sum(change.state == 'push' for change in self.history)

    @property
    def position_error(self):
        """True distance of the object from its goal at the end [m]."""
        return distance(self.tape.poses('object')[-1], self.scenario.final_goal)

    @property
    def heading_error(self):
        """True heading of the object at the end less that of its goal [rad]."""
        return wrap_angle(self.tape.poses('object')[-1][2] - self.scenario.final_goal.theta)
