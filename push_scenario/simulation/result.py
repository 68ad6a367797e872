"""Result of a run, in one process or over DDS: how it ended, its tape, and what the robot did."""

import dataclasses
import enum
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_control.law_names import law_title
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.events import Codes
from push_model.geometry import distance, wrap_angle
from push_model.trajectory import PushTrajectory
from push_planner.problem import PlanningFailed
from push_planner.task_plan import TaskPlan
from push_scenario.definition.scenario import Scenario
from push_sim_node.tape import Tape


class TimedRefusal(NamedTuple):
    """
    Refusal of a plan in a task.

    :param time: when [s].
    :param failure: ``PlanningFailed``.
    """

    time: float
    failure: PlanningFailed


class Outcome(enum.Enum):
    """Outcome of a run."""

    DONE = 'done'  # the controller or the supervisor reports success
    FAILED = 'failed'  # it gave up
    TIME_LIMIT = 'time_limit'  # simulated time ran out before
    REFUSED = 'refused'  # there was no plan to start with


@dataclasses.dataclass(frozen=True)
class WallClockTiming:
    """
    Speed of a run over DDS.

    :param latency_median: time from publishing an object pose to receiving the command that
        answers it, in the simulator's process [s]; nan without any.
    :param latency_p99: 99th percentile of the same [s].
    :param speed_up: simulated time over wall time.
    """

    latency_median: float
    latency_p99: float
    speed_up: float


@dataclasses.dataclass(frozen=True, eq=False)
class RunResult:
    """
    One run of a scenario under one control law: a single push, or a task of several.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback``, ``mpc`` or ``open_loop``.
    :param outcome: the ``Outcome``.
    :param reason: why it ended so, one sentence.
    :param tape: the ``Tape``; None where the goal was refused and nothing moved.
    :param duration: simulated time until the controller or supervisor ended the run, before
        everything came to rest [s].
    :param history: every ``StateChange``, over all goals; a single push is in the state ``PUSH``
        from the start to the end.
    :param recoveries: number of times that the supervisor had to recover.
    :param status: last ``SupervisorStatus`` of a task; None for a single push.
    :param plan: ``PushTrajectory`` that a single push followed; None for a task, and where none
        was needed.
    :param task_plans: ``TaskPlan`` of each push of a task, in order; empty over DDS.
    :param refusals: ``TimedRefusal`` of each request of a task that was refused otherwise than
        the one before; empty over DDS.
    :param timing: ``WallClockTiming`` of a run over DDS, else None.
    :param bag: folder of the recording, or None.
    :param codes: of the reason, as of ``Report``.
    :raises ValueError: where a run that moved lacks its tape, or a single push its plan.
    """

    scenario: Scenario
    control_law: str
    outcome: Outcome
    reason: str = ''
    tape: Tape | None = None
    duration: float = 0.0
    history: tuple[StateChange, ...] = ()
    recoveries: int = 0
    status: SupervisorStatus | None = None
    plan: PushTrajectory | None = None
    task_plans: tuple[TaskPlan, ...] = ()
    refusals: tuple[TimedRefusal, ...] = ()
    timing: WallClockTiming | None = None
    bag: Path | None = None
    codes: Codes = ()

    def __post_init__(self) -> None:
        """Check that the fields fit the outcome."""
        if self.outcome is Outcome.REFUSED:
            return
        if self.tape is None:
            raise ValueError(f'RunResult.tape: got None, expected a tape for the outcome '
                             f'{self.outcome.value!r}')
        if self.plan is None and self.scenario.task is None and self.pushes:
            raise ValueError(f'RunResult.plan: got None, expected the plan of a single push for '
                             f'the outcome {self.outcome.value!r}')

    def __repr__(self) -> str:
        """Say in one line how it ended."""
        ending = f'{self.scenario.name}, {law_title(self.control_law)}: {self.outcome.value}'
        if self.tape is None:
            return f'<RunResult {ending}: {self.reason}>'
        return (f'<RunResult {ending} after {self.duration:.2f} s, pushes: {self.pushes}, '
                f'{1e3 * self.position_error:.1f} mm and {math.degrees(self.heading_error):+.2f} '
                'deg from the goal>')

    @property
    def pushes(self) -> int:
        """Number of pushes that were started."""
        return sum(change.state is TaskState.PUSH for change in self.history)

    @property
    def position_error(self) -> float:
        """True distance of the object from its goal at the end [m]."""
        return distance(self._final_object_pose, self.scenario.final_goal)

    @property
    def heading_error(self) -> float:
        """True heading of the object at the end minus that of its goal [rad]."""
        return wrap_angle(self._final_object_pose[2] - self.scenario.final_goal.theta)

    @property
    def _final_object_pose(self) -> NDArray[np.float64]:
        if self.tape is None:
            raise ValueError(f'RunResult.tape: got None for {self.scenario.name}, expected a run '
                             'in which something moved')
        return self.tape.poses('object')[-1]
