"""The predictive law's horizon problem, solved to convergence by ipopt at every step."""

import casadi as ca
import numpy as np
from push_control.laws.mpc import optimal_weights, PredictiveLaw, SolverFailed
from push_control.laws.mpc_problem import horizon_problem, SCALARS
from push_control.laws.steering_law import SolverFailure

OPTIONS = {'print_time': False, 'error_on_fail': False, 'ipopt': {
    'print_level': 0, 'sb': 'yes', 'tol': 1e-8, 'max_iter': 200}}
WIDEST_SLACK = 10.0


class ConvergedLaw(PredictiveLaw):
    """Has the parameters and the first guess of ``PredictiveLaw``; starts from its last plan."""

    def __init__(self, robot, settings):
        """
        Build the nonlinear programme.

        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        """
        super().__init__(robot, settings)
        self._nlp = _horizon_nlp(robot.drive, settings)

    def _optimum(self, situation):
        self._fill(situation)
        part = dict(zip(SCALARS, self._scalars))
        count = len(self._plan)
        low, high = np.full(count, part['lowest']), np.full(count, part['highest'])
        low[0], high[0] = part['first_low'], part['first_high']
        found = self._nlp(x0=[*self._start, 0.0], p=self._parameters, ubg=0.0,
                          lbx=[*low, 0.0], ubx=[*high, WIDEST_SLACK])
        if not self._nlp.stats()['success']:
            raise SolverFailed(SolverFailure.NOT_CONVERGED)
        self._plan[:] = np.array(found['x']).ravel()[:-1]
        return float(self._plan[0])


def _horizon_nlp(drive, settings):
    """Build the problem of one horizon, with the soft constraints' one slack."""
    weights, steps = optimal_weights(settings), settings.horizon_steps
    _, problem = horizon_problem(drive, steps, settings.horizon_step, weights)
    u, slack = ca.SX.sym('u', steps), ca.SX.sym('slack')
    p = ca.SX.sym('p', problem.size1_in(1))
    residuals, soft, low, high = problem(u, p)
    changes, most = u[1:] - u[:-1], p[SCALARS.index('change')]
    return ca.nlpsol('converged', 'ipopt', {
        'x': ca.vertcat(u, slack), 'p': p,
        'f': 0.5 * ca.sumsqr(residuals) + weights[2] * (slack + 0.5 * slack ** 2),
        'g': ca.vertcat(soft - high - slack, low - slack - soft, changes - most,
                        -changes - most)}, OPTIONS)
