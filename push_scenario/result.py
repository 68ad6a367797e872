"""What came of a run, in process or over DDS."""

import dataclasses

from push_model.trajectory import PushTrajectory
from push_scenario.scenario import Scenario
from push_scenario.tape import Tape

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
