"""The predictive law's horizon problem, solved to convergence by ipopt at every step."""

from typing import Any

import casadi as ca
import numpy as np
from push_control.laws.mpc import optimal_weights, PredictiveLaw, SolverFailed
from push_control.laws.mpc_problem import horizon_problem, HorizonParameters
from push_control.laws.steering_law import SolverFailure
from push_control.settings import ControlSettings
from push_model.parameters import Drive, RoundRobot

# Options of ipopt; chosen: a tolerance far below that of the law itself.
OPTIONS: dict[str, Any] = {'print_time': False, 'error_on_fail': False, 'ipopt': {
    'print_level': 0, 'sb': 'yes', 'tol': 1e-8, 'max_iter': 200}}
# Upper bound of the slack [rad]; chosen: never active.
MAX_SLACK = 10.0


class ConvergedLaw(PredictiveLaw):
    """The ``PredictiveLaw`` with the exact optimum; starts from the optimum of the step before."""

    def __init__(self, robot: RoundRobot, settings: ControlSettings) -> None:
        """
        Build the nonlinear program.

        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        """
        super().__init__(robot, settings)
        self._nlp = _nonlinear_program(robot.drive, settings)

    def _optimum(self) -> float:
        horizon = self._horizon
        parameters = HorizonParameters(*horizon.scalars)
        plan = horizon.curvatures
        low, high = np.full(len(plan), parameters.lowest), np.full(len(plan), parameters.highest)
        low[0], high[0] = parameters.first_lowest, parameters.first_highest
        found = self._nlp(x0=[*horizon.guess, 0.0], p=horizon.p, ubg=0.0,
                          lbx=[*low, 0.0], ubx=[*high, MAX_SLACK])
        if not self._nlp.stats()['success']:
            raise SolverFailed(SolverFailure.NOT_CONVERGED)
        plan[:] = np.array(found['x']).ravel()[:-1]
        return float(plan[0])


def _nonlinear_program(drive: Drive, settings: ControlSettings) -> Any:
    """Build the problem of one horizon, with one slack for all soft constraints."""
    weights, steps = optimal_weights(settings), settings.horizon_steps
    problem = horizon_problem(drive, steps, settings.horizon_step, weights)
    u, slack = ca.SX.sym('u', steps), ca.SX.sym('slack')
    p = ca.SX.sym('p', problem.size1_in(1))
    residuals, soft, low, high = problem(u, p)
    changes, max_change = u[1:] - u[:-1], p[HorizonParameters._fields.index('max_change')]
    return ca.nlpsol('converged', 'ipopt', {
        'x': ca.vertcat(u, slack), 'p': p,
        'f': 0.5 * ca.sumsqr(residuals) + weights.slack * (slack + 0.5 * slack ** 2),
        'g': ca.vertcat(soft - high - slack, low - slack - soft, changes - max_change,
                        -changes - max_change)}, OPTIONS)
