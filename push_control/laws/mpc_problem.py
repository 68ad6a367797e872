"""
The predictive law's problem: the push over the next way, linearised and condensed to a small QP.

States per way of z: lateral and heading error (e_y, e_psi), zeta from C->F to the normal, and the
curvature kappa that lags behind the commanded ones U. Near the path, without lag, the optimum is
the closed-form law: its gains give the weights.
"""

from functools import lru_cache
import math

import casadi as ca
import numpy as np
from push_model.robot_kinematics import yaw_rate
from scipy.linalg import cholesky, solve_discrete_are

SOLVER = 'daqp'
ITERATION_LIMIT = 100
SHORTEST_LAG = 1e-4
STATES = ('lateral', 'heading', 'zeta', 'curvature')
SCALARS = STATES + ('wheelbase', 'force_slope', 'robot_radius', 'rest', 'roll_gain', 'lag', 'cone',
                    'zeta_low', 'zeta_high', 'lowest', 'highest', 'first_low', 'first_high',
                    'change')


@lru_cache(maxsize=8)
def horizon_problem(drive, steps, step, weights):
    """
    Build the problem of one horizon.

    :param drive: one of ``push_model.parameters.DRIVES``.
    :param steps: number of steps N.
    :param step: way of z per step [m].
    :param weights: of squared lateral error [1/m^4], squared heading error [1/m^2], and of the
        violation of soft constraints; that of squared curvature is 1.
    :return: casadi functions of the parameters: the QP step, giving U, the largest violation of a
        soft constraint and that of a hard one; and residuals and constraints, to be solved by
        other means.
    """
    p = ca.SX.sym('p', len(SCALARS) + 9 + 2 * steps)
    part = dict(zip(SCALARS, ca.vertsplit(p[:len(SCALARS)])))
    root, path, plan = ca.vertsplit(p[len(SCALARS):], [0, 9, 9 + steps, 9 + 2 * steps])
    u = ca.SX.sym('u', steps)
    states = _rollout(drive, part, path, u, step)
    residuals = _residuals(states, ca.reshape(root, 3, 3), path, u, step, weights)
    soft, low, high = _soft(part, states, u)
    problem = ca.Function('problem', [u, p], [residuals, soft, low, high])
    qp = _linearised(part, residuals, (soft, low, high), u, weights[2], plan, p)
    return _solved(qp, steps), problem


def terminal_root(drive, step, weights, lag):
    """
    Root R of the cost to go ``|R (e_y, e_psi, kappa)|^2`` on a straight path without limits.

    :param drive: one of ``push_model.parameters.DRIVES``.
    :param step: way of z per step [m].
    :param weights: as for ``horizon_problem``.
    :param lag: way over which the curvature lags [m].
    :return: upper triangle, shape (3, 3).
    """
    a, b = straight_step(drive, step, lag)
    costs = np.diag([step * weights[0], step * weights[1], 1e-9])
    return cholesky(solve_discrete_are(a, b, costs, np.array([[step]])))


def straight_step(drive, step, lag):
    """
    Linear motion of (e_y, e_psi, kappa) over one step beside a straight path.

    :param drive: one of ``push_model.parameters.DRIVES``.
    :param step: way of z [m].
    :param lag: way over which the curvature lags [m].
    :return: A, shape (3, 3), and B, shape (3, 1).
    """
    x, u = ca.SX.sym('x', 4), ca.SX.sym('u')
    part = dict.fromkeys(SCALARS, 1.0) | {'lag': lag}
    after = _advance(drive, part, x, u, 0.0, step)
    slopes = ca.Function('slopes', [x, u], [ca.jacobian(after, x), ca.jacobian(after, u)])
    a, b = (np.array(slope) for slope in slopes(0.0, 0.0))
    rows = [STATES.index(name) for name in ('lateral', 'heading', 'curvature')]
    return a[np.ix_(rows, rows)], b[rows]


def _rollout(drive, part, path, u, step):
    states = [ca.vertcat(*(part[name] for name in STATES))]
    for k in range(u.numel()):
        states.append(_advance(drive, part, states[-1], u[k], path[k], step))
    return states


def _advance(drive, part, x, command, path_curvature, step):
    """One step; exact for the lag and small heading errors, by midpoints for the rest."""
    lateral, heading, zeta, curvature = ca.vertsplit(x)
    lag = ca.fmax(part['lag'], SHORTEST_LAG)
    left = ca.exp(-step / lag)
    off = curvature - command
    turned = step * command + lag * (1.0 - left) * off
    swept = 0.5 * step ** 2 * command + (step - lag * (1.0 - left)) * lag * off
    swept -= 0.5 * step ** 2 * path_curvature
    middle = zeta + 0.5 * step * _zeta_rate(drive, part, zeta, turned / step)
    return ca.vertcat(lateral + step * ca.sin(heading + swept / step),
                      heading + turned - step * path_curvature,
                      zeta + step * _zeta_rate(drive, part, middle, turned / step),
                      command + left * off)


def _zeta_rate(drive, part, zeta, curvature):
    """Turn of the normal less that of the object, per way; ``rest`` is D, or where zeta rests."""
    if drive == 'holonomic':
        return part['roll_gain'] * (part['rest'] - zeta)
    alpha = -ca.atan(part['wheelbase'] * curvature)
    turn = yaw_rate(drive, part['robot_radius'], alpha - zeta, part['rest'], curvature)
    return turn / ca.cos(alpha) - curvature


def _residuals(states, root, path, u, step, weights):
    scales = [math.sqrt(step * weight) for weight in weights[:2]]
    rows = [ca.vertcat(scales[0] * x[0], scales[1] * x[1]) for x in states[1:-1]]
    last = states[-1]
    end = ca.mtimes(root, ca.vertcat(last[0], last[1], last[3] - path[-1]))
    return ca.vertcat(*rows, end, math.sqrt(step) * (u - path))


def _soft(part, states, u):
    """Force angle within the cone at once, normal within its place: values and bounds."""
    force = [x[2] + part['force_slope'] * command for x, command in zip(states, ca.vertsplit(u))]
    zeta = [x[2] for x in states[1:]]
    count = len(zeta)
    low = ca.vertcat(*[-part['cone']] * count, *[part['zeta_low']] * count)
    high = ca.vertcat(*[part['cone']] * count, *[part['zeta_high']] * count)
    return ca.vertcat(*force, *zeta), low, high


def _linearised(part, residuals, soft, u, slack_weight, plan, p):
    """Give the QP in (change of U, slack) around the plan, as a function of the parameters."""
    values, low, high = soft
    slopes, bends = ca.jacobian(residuals, u), ca.jacobian(values, u)
    hessian = ca.diagcat(ca.mtimes(slopes.T, slopes), slack_weight)
    gradient = ca.vertcat(ca.mtimes(slopes.T, residuals), slack_weight)
    ones = ca.SX.ones(values.numel())
    changes = u[1:] - u[:-1]
    rows = ca.vertcat(ca.horzcat(bends, -ones), ca.horzcat(bends, ones),
                      ca.horzcat(ca.jacobian(changes, u), ca.SX(changes.numel(), 1)))
    far, change = 1e3 * ones, part['change'] * ca.SX.ones(changes.numel())
    lower = ca.vertcat(-far, low - values, -change - changes)
    upper = ca.vertcat(high - values, far, change - changes)
    count = u.numel() - 1
    least = ca.vertcat(part['first_low'], *[part['lowest']] * count) - u
    most = ca.vertcat(part['first_high'], *[part['highest']] * count) - u
    parts = [hessian, gradient, rows, lower, upper, ca.vertcat(least, 0.0),
             ca.vertcat(most, 10.0)]
    parts = ca.substitute([ca.densify(item) for item in parts], [u], [plan])
    return ca.Function('qp', [p], parts, {'cse': True})


def _solved(qp, steps):
    p = ca.MX.sym('p', qp.size1_in(0))
    h, g, a, lba, uba, lbx, ubx = qp(p)
    solver = ca.conic('solver', SOLVER, {'h': h.sparsity(), 'a': a.sparsity()},
                      {'error_on_fail': False, 'daqp': {'iter_limit': ITERATION_LIMIT}})
    x = solver(h=h, g=g, a=a, lba=lba, uba=uba, lbx=lbx, ubx=ubx)['x']
    rows = ca.mtimes(a, x)
    beyond = ca.mmax(ca.vertcat(rows - uba, lba - rows, x - ubx, lbx - x))
    return ca.Function('step', [p], [p[-steps:] + x[:-1], x[-1], beyond])
