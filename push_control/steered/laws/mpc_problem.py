"""
The predictive law's problem: the push over the horizon, and one step of it with derivatives.

States at every step of path length ds of z: lateral and heading error (e_y, e_psi), zeta from C->F
to the normal, and the curvature kappa that lags behind the commanded ones U by the distance l:

    ``e_y' = sin(e_psi)``                    ``kappa' = (U - kappa) / l``
    ``e_psi' = kappa - kappa_path``          ``zeta' = yaw rate of the normal - kappa``

The cost is ``ds sum(w_y e_y^2 + w_psi e_psi^2 + (U - kappa_path)^2)`` and the cost to go of the
linear-quadratic regulator; the force angle ``zeta + c^2 / r U`` in the friction cone and zeta on
its feature are soft constraints, with one slack for all. Near a straight path, without lag, the
optimum is the closed-form law: its gains give the weights.
"""

from functools import lru_cache
import math
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import Drive
from push_model.robot_kinematics import yaw_rate
from scipy.linalg import cholesky, solve_discrete_are

# Smallest distance that the curvature lags behind [m], so that nothing divides by 0.
MIN_LAG_DISTANCE = 1e-4
# Weight of the curvature in the regulator's cost, which must be positive definite.
MIN_CURVATURE_WEIGHT = 1e-9


class HorizonWeights(NamedTuple):
    """
    Weights of the cost; that of squared curvature is 1.

    :param lateral: of squared lateral error [1/m^4].
    :param heading: of squared heading error [1/m^2].
    :param slack: of the violation of soft constraints.
    """

    lateral: float
    heading: float
    slack: float


class HorizonParameters(NamedTuple):
    """
    Scalars of the problem, numbers or casadi symbols; their order is that in the vector p.

    :param lateral_error: e_y now [m].
    :param heading_error: e_psi now [rad].
    :param zeta: now [rad].
    :param curvature: kappa now [1/m].
    :param wheelbase: L [m].
    :param force_slope: c^2 / r, angle of the force per curvature [m].
    :param robot_radius: R_p [m].
    :param zeta_rest: the heading offset D, or where zeta comes to rest on a straight path [rad].
    :param rolling_gain: of a holonomic base, yaw per path length [1/m].
    :param lag_distance: l [m].
    :param cone_angle: half angle of the friction cone that may be used [rad].
    :param zeta_low: least zeta on the feature in contact [rad].
    :param zeta_high: greatest zeta there [rad].
    :param lowest: least curvature that may be commanded [1/m].
    :param highest: greatest curvature [1/m].
    :param first_lowest: least curvature that may be commanded now [1/m].
    :param first_highest: greatest curvature now [1/m].
    :param max_change: of the commanded curvature from one step to the next [1/m].
    """

    lateral_error: Any
    heading_error: Any
    zeta: Any
    curvature: Any
    wheelbase: Any
    force_slope: Any
    robot_radius: Any
    zeta_rest: Any
    rolling_gain: Any
    lag_distance: Any
    cone_angle: Any
    zeta_low: Any
    zeta_high: Any
    lowest: Any
    highest: Any
    first_lowest: Any
    first_highest: Any
    max_change: Any

    @property
    def state(self) -> tuple[Any, Any, Any, Any]:
        """State at the beginning of the horizon: (e_y, e_psi, zeta, kappa)."""
        return self.lateral_error, self.heading_error, self.zeta, self.curvature


SCALAR_COUNT = len(HorizonParameters._fields)
ROOT_SIZE = 9
# Of (e_y, e_psi, zeta, kappa), those that the cost to go is about.
REGULATED = [0, 1, 3]


def parameter_offsets(steps: int) -> list[int]:
    """
    List the offsets at which the parts of the parameter vector p start and end.

    They are: the scalars as ``HorizonParameters``; the root of the cost to go, column by column;
    the curvatures of the path; the curvatures around which the problem is linearised.

    :param steps: number of steps N.
    :return: the five offsets, from 0 to the length of p.
    """
    root = SCALAR_COUNT + ROOT_SIZE
    return [0, SCALAR_COUNT, root, root + steps, root + 2 * steps]


class SoftConstraints(NamedTuple):
    """Values of soft constraints and their bounds, casadi vectors of one length [rad]."""

    values: Any
    low: Any
    high: Any


@lru_cache(maxsize=8)
def horizon_problem(drive: Drive, steps: int, step: float, weights: HorizonWeights) -> ca.Function:
    """
    Build the problem of one horizon.

    :param drive: kinematics of the base.
    :param steps: number of steps N.
    :param step: path length of z per step [m].
    :return: casadi function of (U, p): residuals, the squared norm of which is the cost, and
        values and bounds of the soft constraints [rad].
    """
    offsets = parameter_offsets(steps)
    p, u = ca.SX.sym('p', offsets[-1]), ca.SX.sym('u', steps)
    scalars, root, path, _ = ca.vertsplit(p, offsets)
    parameters = HorizonParameters(*ca.vertsplit(scalars))
    states = _rollout(drive, parameters, path, u, step)
    residuals = _residuals(states, ca.reshape(root, 3, 3), path, u, step=step, weights=weights)
    return ca.Function('problem', [u, p],
                       [residuals, *_soft_constraints(parameters, states, u)])


@lru_cache(maxsize=8)
def horizon_program(drive: Drive, steps: int, step: float, weights: HorizonWeights) -> ca.Function:
    """
    Build the quadratic program of one horizon, around a guess.

    Its unknowns are the changes of U from the guess, and the slack s of the soft constraints.

    :param drive: kinematics of the base.
    :param steps: number of steps N.
    :param step: path length of z per step [m].
    :return: casadi function of p: ``h``, ``g``, ``a``, ``lba``, ``uba``, ``lbx`` and ``ubx``, as
        casadi names the parts of a quadratic program.
    """
    offsets = parameter_offsets(steps)
    u, p = ca.SX.sym('u', steps), ca.SX.sym('p', offsets[-1])
    residuals, values, low, high = horizon_problem(drive, steps, step, weights)(u, p)
    linear = ca.Function('linear', [u, p], [
        residuals, ca.jacobian(residuals, u), values - high, low - values,
        ca.jacobian(values, u)], {'cse': True})
    # Products of whole matrices take less time than their elements one by one.
    stacked = ca.MX.sym('p', offsets[-1])
    scalars, _, _, guess = ca.vertsplit(stacked, offsets)
    parameters = HorizonParameters(*ca.vertsplit(scalars))
    errors, slopes, above, below, value_slopes = linear(guess, stacked)
    slack, each, unlimited = (ca.DM.ones(count) * value for count, value in (
        (2 * steps, 1.0), (steps - 1, 1.0), (2 * steps, ca.inf)))
    change = ca.DM.eye(steps)[1:, :] - ca.DM.eye(steps)[:-1, :]
    changes = ca.mtimes(change, guess)
    program = [
        ca.diagcat(ca.mtimes(slopes.T, slopes), weights.slack),
        ca.vertcat(ca.mtimes(slopes.T, errors), weights.slack),
        ca.blockcat([[value_slopes, -slack], [value_slopes, slack],
                     [change, ca.DM(steps - 1, 1)]]),
        ca.vertcat(-unlimited, below, -parameters.max_change - changes),
        ca.vertcat(-above, unlimited, parameters.max_change - changes),
        ca.vertcat(parameters.first_lowest, parameters.lowest * each, 0.0)
        - ca.vertcat(guess, 0.0),
        ca.vertcat(parameters.first_highest, parameters.highest * each, ca.inf)
        - ca.vertcat(guess, 0.0)]
    return ca.Function('program', [stacked], program, ['p'],
                       ['h', 'g', 'a', 'lba', 'uba', 'lbx', 'ubx'])


# While the solver fails, each command begins a plan, mostly with the lag of the one before.
@lru_cache(maxsize=8)
def terminal_root(drive: Drive, step: float, weights: HorizonWeights,
                  lag_distance: float) -> FloatArray:
    """
    Root R of the cost to go ``|R (e_y, e_psi, kappa)|^2`` on a straight path without limits.

    :param drive: kinematics of the base.
    :param step: path length of z per step [m].
    :param lag_distance: over which the curvature lags [m].
    :return: upper triangle, read-only, shape (3, 3).
    """
    a, b = straight_step(drive, step, lag_distance)
    costs = np.diag([step * weights.lateral, step * weights.heading, MIN_CURVATURE_WEIGHT])
    root: FloatArray = cholesky(solve_discrete_are(a, b, costs, np.array([[step]])))
    root.flags.writeable = False
    return root


def straight_step(drive: Drive, step: float,
                  lag_distance: float) -> tuple[FloatArray, FloatArray]:
    """
    Linear motion of (e_y, e_psi, kappa) over one step beside a straight path.

    :param drive: kinematics of the base.
    :param step: path length of z [m].
    :param lag_distance: over which the curvature lags [m].
    :return: A, shape (3, 3), and B, shape (3, 1).
    """
    a, b = (np.array(slope) for slope in _slopes(drive, step)(lag_distance))
    return a[np.ix_(REGULATED, REGULATED)], b[REGULATED]


@lru_cache(maxsize=8)
def _slopes(drive: Drive, step: float) -> Any:
    """Derive one step along a straight path, by state and by input, as a function of the lag."""
    x, u, lag_distance = ca.SX.sym('x', 4), ca.SX.sym('u'), ca.SX.sym('lag_distance')
    # Zeta does not act on the others: whatever it depends on does not matter.
    parameters = HorizonParameters(*[1.0] * SCALAR_COUNT)._replace(lag_distance=lag_distance)
    after = _advance(drive, parameters, x, u, 0.0, step)
    slopes = ca.substitute([ca.jacobian(after, x), ca.jacobian(after, u)], [x, u],
                           [ca.SX.zeros(4), ca.SX(0.0)])
    return ca.Function('slopes', [lag_distance], slopes)


def _rollout(drive: Drive, parameters: HorizonParameters, path: Any, u: Any,
             step: float) -> list[Any]:
    """List the states at the N + 1 ends of the steps."""
    states = [ca.vertcat(*parameters.state)]
    for k in range(u.numel()):
        states.append(_advance(drive, parameters, states[-1], u[k], path[k], step))
    return states


def _advance(drive: Drive, parameters: HorizonParameters, x: Any, command: Any,
             path_curvature: Any, step: float) -> Any:
    """One step; exact for the lag and small heading errors, by midpoints for the rest."""
    lateral, heading, zeta, curvature = ca.vertsplit(x)
    lag = ca.fmax(parameters.lag_distance, MIN_LAG_DISTANCE)
    decay = ca.exp(-step / lag)
    off = curvature - command
    # First and second integral of the lagging curvature over the step.
    rotation = step * command + lag * (1.0 - decay) * off
    swept = 0.5 * step ** 2 * command + (step - lag * (1.0 - decay)) * lag * off
    swept -= 0.5 * step ** 2 * path_curvature
    mean = rotation / step
    middle = zeta + 0.5 * step * _zeta_rate(drive, parameters, zeta, mean)
    return ca.vertcat(lateral + step * ca.sin(heading + swept / step),
                      heading + rotation - step * path_curvature,
                      zeta + step * _zeta_rate(drive, parameters, middle, mean),
                      command + decay * off)


def _zeta_rate(drive: Drive, parameters: HorizonParameters, zeta: Any, curvature: Any) -> Any:
    """Rotation of the normal minus that of the object, per path length of z."""
    if drive == 'holonomic':
        return parameters.rolling_gain * (parameters.zeta_rest - zeta)
    alpha = -ca.atan(parameters.wheelbase * curvature)
    rotation = yaw_rate(drive, parameters.robot_radius, alpha - zeta, parameters.zeta_rest,
                        curvature)
    return rotation / ca.cos(alpha) - curvature


def _residuals(states: list[Any], root: Any, path: Any, u: Any, *, step: float,
               weights: HorizonWeights) -> Any:
    """Vector whose squared norm is the cost, without that of the slack."""
    lateral, heading = (math.sqrt(step * weight) for weight in (weights.lateral, weights.heading))
    rows = [ca.vertcat(lateral * x[0], heading * x[1]) for x in states[1:-1]]
    last = states[-1]
    end = ca.mtimes(root, ca.vertcat(last[0], last[1], last[3] - path[-1]))
    return ca.vertcat(*rows, end, math.sqrt(step) * (u - path))


def _soft_constraints(parameters: HorizonParameters, states: list[Any],
                      u: Any) -> SoftConstraints:
    """Force angle within the cone from the first command on, normal on its feature."""
    force = [x[2] + parameters.force_slope * command
             for x, command in zip(states, ca.vertsplit(u))]
    zeta = [x[2] for x in states[1:]]
    count = len(zeta)
    low = ca.vertcat(*[-parameters.cone_angle] * count, *[parameters.zeta_low] * count)
    high = ca.vertcat(*[parameters.cone_angle] * count, *[parameters.zeta_high] * count)
    return SoftConstraints(ca.vertcat(*force, *zeta), low, high)
