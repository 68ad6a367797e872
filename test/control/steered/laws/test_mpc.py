"""The predictive law: symmetries, limits, optimality, and what replaces a failed solver."""

import dataclasses
import math
from typing import NamedTuple

import casadi as ca
from helpers.push_case import box
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.laws.closed_form import ClosedFormLaw
from push_control.steered.laws.mpc import (
    HorizonSolver, optimal_weights, PredictiveLaw, SolverFailed)
from push_control.steered.laws.mpc_problem import (
    horizon_problem, HorizonParameters, parameter_offsets, SCALAR_COUNT, straight_step,
    terminal_root)
from push_control.steered.laws.steering_law import Foresight, SolverFailure, SteeringInput
from push_control.steered.path.path import CurvatureLimits, PathProjection
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.quasi_static import vehicle
import pytest
from scipy.linalg import solve_discrete_are

SETTINGS = ControlSettings(control_law='mpc')
ROBOT = RoundRobot(radius=0.17)
VEHICLE = vehicle(box(0.4, 2.0, [0.3] * 4), (-0.2, -0.2))
WEIGHTS = optimal_weights(SETTINGS)
STEPS, STEP = SETTINGS.horizon_steps, SETTINGS.horizon_step


def situation(lateral=0.0, heading=0.0, zeta=0.0, bend=0.0, **changes):
    """Stand beside a path of one curvature, with room to all sides."""
    projection = PathProjection(0.0, lateral, heading, bend, 2.0)
    ahead = Foresight(
        projection=projection, preview=lambda distances: np.full(len(distances), bend),
        vehicle=VEHICLE, zeta=zeta, zeta_rest=0.0, zeta_limits=(-0.7, 0.7), cone_angle=0.3)
    ahead = ahead._replace(**{name: changes.pop(name) for name in Foresight._fields
                              if name in changes})
    plain = SteeringInput(
        projection=projection, limits=CurvatureLimits(-0.6, 0.6), previous_curvature=None,
        max_change=0.2, distance=0.003, lag_distance=0.0, foresee=lambda: ahead)
    return plain._replace(**changes)


def numbers(place, root):
    """Put the parameters of a situation in their order, with a straight path."""
    scalars = HorizonParameters(
        *place, wheelbase=VEHICLE.wheelbase, force_slope=VEHICLE.c_squared / VEHICLE.arm,
        robot_radius=0.17, zeta_rest=0.0, rolling_gain=4.0, lag_distance=0.015, cone_angle=0.3,
        zeta_low=-0.7, zeta_high=0.7, lowest=-0.6, highest=0.6, first_lowest=-0.2,
        first_highest=0.2, max_change=2.1)
    return np.concatenate([scalars, root.ravel(order='F'), np.zeros(2 * STEPS)])


def test_left_and_right_are_treated_alike():
    """Mirrored errors, normal and path get the mirrored curvature, limits active or not."""
    for lateral, heading, zeta, bend in ((0.01, 0.02, 0.1, 0.2), (0.08, 0.2, -0.25, 0.5)):
        one = PredictiveLaw(ROBOT, SETTINGS).curvature(situation(lateral, heading, zeta, bend))
        other = PredictiveLaw(ROBOT, SETTINGS).curvature(
            situation(-lateral, -heading, -zeta, -bend))
        assert one == pytest.approx(-other, abs=1e-9)
        assert abs(one) > 0.05


@pytest.mark.parametrize('lag', [0.0, 0.02])
def test_near_a_straight_path_it_is_the_linear_quadratic_regulator(lag):
    """With no limit active: the gain of the Riccati equation, solved apart from the problem."""
    weights = optimal_weights(SETTINGS)
    a, b = straight_step('differential', STEP, lag)
    costs = np.diag([STEP * weights.lateral, STEP * weights.heading, 1e-9])
    value = solve_discrete_are(a, b, costs, np.array([[STEP]]))
    gain = np.linalg.solve(STEP + b.T @ value @ b, b.T @ value @ a)
    for errors in ((1e-3, 0.0), (0.0, 2e-3), (-1e-3, 1e-3)):
        found = PredictiveLaw(ROBOT, SETTINGS).curvature(situation(*errors, lag_distance=lag))
        wanted = -float((gain @ (*errors, 0.0))[0])
        assert found == pytest.approx(wanted, rel=1e-3, abs=1e-6)


def test_with_short_steps_it_is_the_closed_form_law():
    """The weights are those for which that law is optimal."""
    fine = dataclasses.replace(SETTINGS, horizon_step=0.002)
    for errors in ((1e-4, 0.0), (0.0, 2e-4)):
        place = situation(*errors)
        closed = ClosedFormLaw(SETTINGS).curvature(place)
        assert PredictiveLaw(ROBOT, fine).curvature(place) == pytest.approx(closed, rel=0.03)


def test_it_steers_before_the_path_bends():
    """On a straight stretch, with a bend to the left ahead that is sharper than the limit."""
    place = situation(preview=lambda distances: np.where(distances > 0.15, 0.9, 0.0))
    assert PredictiveLaw(ROBOT, SETTINGS).curvature(place) > 0.01
    assert ClosedFormLaw(SETTINGS).curvature(place) == 0.0


@pytest.mark.parametrize('lag', [0.0, 0.02])
def test_limits_and_changes_are_kept(lag):
    """Whatever the errors, the answer needs no correction; and no failure is counted."""
    law, rng = PredictiveLaw(ROBOT, SETTINGS), np.random.default_rng(1)
    before = None
    for _ in range(300):
        place = situation(*rng.normal(0.0, (0.05, 0.1, 0.15)), previous_curvature=before,
                          lag_distance=lag)
        found = law.curvature(place)
        assert found == pytest.approx(place.clip(found), abs=1e-6)
        before = place.clip(found)
    assert law.solver.failures == 0


def test_the_force_stays_in_its_cone_where_the_closed_form_law_leaves_it():
    """With the normal turned aside, a sharp turn the wrong way must wait."""
    place = situation(lateral=-0.05, zeta=0.25)
    slope = VEHICLE.c_squared / VEHICLE.arm
    closed = place.clip(ClosedFormLaw(SETTINGS).curvature(place))
    found = PredictiveLaw(ROBOT, SETTINGS).curvature(place)
    ahead = place.foresee()
    assert ahead.zeta + slope * closed > ahead.cone_angle
    assert ahead.zeta + slope * found < ahead.zeta + slope * closed


def test_the_scalars_have_one_order():
    """What the law writes for a field is what the problem reads as that field."""
    law = PredictiveLaw(ROBOT, SETTINGS)
    place = situation(0.01, 0.02, 0.03, 0.1, zeta_rest=0.04, zeta_limits=(-0.6, 0.5),
                      cone_angle=0.25, previous_curvature=0.05, max_change=0.15,
                      lag_distance=0.02)
    law.curvature(place)
    horizon, limits = law._horizon, place.limits
    written = HorizonParameters(*horizon.scalars)
    assert written == HorizonParameters(
        lateral_error=0.01, heading_error=0.02, zeta=0.03, curvature=0.05,
        wheelbase=VEHICLE.wheelbase, force_slope=VEHICLE.c_squared / VEHICLE.arm,
        robot_radius=0.17, zeta_rest=0.04, rolling_gain=SETTINGS.rolling_gain, lag_distance=0.02,
        cone_angle=0.25, zeta_low=-0.6, zeta_high=0.5, lowest=limits.low, highest=limits.high,
        first_lowest=0.05 - 0.15, first_highest=0.05 + 0.15,
        max_change=SETTINGS.max_curvature_rate * STEP)
    parts = horizon.scalars, horizon.root, horizon.path, horizon.guess
    assert [len(part) for part in parts] == np.diff(parameter_offsets(STEPS)).tolist()
    assert sum(len(part) for part in parts) == len(horizon.p)
    assert all(np.shares_memory(part, horizon.p) for part in parts)


def solved(p: FloatArray) -> FloatArray:
    """Take one step from the guess."""
    solver = HorizonSolver(ROBOT, SETTINGS, WEIGHTS)
    solver.p[:] = p
    return solver.solve()


class Linear(NamedTuple):
    """The problem around its guess: residuals, values and bounds of soft constraints, slopes."""

    residuals: FloatArray
    slopes: FloatArray
    values: FloatArray
    low: FloatArray
    high: FloatArray
    value_slopes: FloatArray


def linearized(p: FloatArray) -> Linear:
    """Differentiate the whole problem by U."""
    problem = horizon_problem('differential', STEPS, STEP, WEIGHTS)
    u = ca.SX.sym('u', STEPS)
    residuals, values, low, high = problem(u, p)
    parts = ca.Function('linear', [u], [
        residuals, ca.jacobian(residuals, u), values, low, high, ca.jacobian(values, u)])(
            p[-STEPS:])
    arrays = [np.array(part) for part in parts]
    return Linear(*(array.ravel() if array.shape[1] == 1 else array for array in arrays))


def dense_solution(p: FloatArray) -> FloatArray:
    """Solve the quadratic program around the guess by another solver of casadi."""
    linear, guess, given = linearized(p), p[-STEPS:], HorizonParameters(*p[:SCALAR_COUNT])
    changes = np.eye(STEPS, k=1)[:-1] - np.eye(STEPS)[:-1]
    slack = np.ones((len(linear.values), 1))
    a = np.block([[linear.value_slopes, -slack], [linear.value_slopes, slack],
                  [changes, np.zeros((STEPS - 1, 1))]])
    h = np.zeros((STEPS + 1, STEPS + 1))
    h[:STEPS, :STEPS], h[STEPS, STEPS] = linear.slopes.T @ linear.slopes, WEIGHTS.slack
    g = np.append(linear.slopes.T @ linear.residuals, WEIGHTS.slack)
    free = np.full(len(linear.values), np.inf)
    change = changes @ guess
    lower = np.concatenate((-free, linear.low - linear.values, -given.max_change - change))
    upper = np.concatenate((linear.high - linear.values, free, given.max_change - change))
    low, high = np.full(STEPS, given.lowest), np.full(STEPS, given.highest)
    low[0], high[0] = given.first_lowest, given.first_highest
    solver = ca.conic('dense', 'qpoases', {'h': ca.DM(h).sparsity(), 'a': ca.DM(a).sparsity()},
                      {'printLevel': 'none', 'error_on_fail': True})
    found = solver(h=h, g=g, a=a, lba=lower, uba=upper, lbx=[*(low - guess), 0.0],
                   ubx=[*(high - guess), 10.0])
    return guess + np.array(found['x']).ravel()[:-1]


@pytest.mark.parametrize('name, sign', [('first_lowest', -1.0), ('first_highest', 1.0)])
def test_the_problem_reads_a_field_where_the_law_writes_it(name, sign):
    """The first curvature is at the bound that binds, and follows it."""
    weights = optimal_weights(SETTINGS)
    root = terminal_root('differential', STEP, weights, 0.015)
    p = numbers((-0.09 * sign, -0.4 * sign, 0.0, 0.0), root)
    for bound in (0.2 * sign, 0.15 * sign):
        p[HorizonParameters._fields.index(name)] = bound
        assert solved(p)[0] == pytest.approx(bound, abs=1e-6)


@pytest.mark.parametrize('place', [(1e-3, 2e-3, 0.0, 0.0), (-2e-3, 0.0, 0.05, 0.01)])
def test_where_no_constraint_binds_it_is_the_least_squares_solution(place):
    """By numpy; with a bound that cuts it off, the solver of the quadratic program agrees."""
    p = numbers(place, terminal_root('differential', STEP, WEIGHTS, 0.015))
    linear = linearized(p)
    expected = np.linalg.lstsq(linear.slopes, -linear.residuals, rcond=None)[0]
    assert solved(p) == pytest.approx(expected, abs=1e-9)


def random_problem(rng):
    """Draw parameters and a guess within its limits, so that mostly some constraints bind."""
    place = rng.normal(0.0, (0.05, 0.15, 0.2, 0.1))
    p = numbers(place, terminal_root('differential', STEP, WEIGHTS, 0.015))
    p[-2 * STEPS:-STEPS] = rng.normal(0.0, 0.3)
    p[-STEPS:] = rng.uniform(-0.2, 0.2, STEPS)
    p[HorizonParameters._fields.index('max_change')] = rng.uniform(0.05, 0.5)
    p[HorizonParameters._fields.index('zeta_low')] = -rng.uniform(0.05, 0.7)
    return p


def test_the_quadratic_program_is_solved_as_by_another_solver():
    """Given matrices that are put together here; in most programs something binds."""
    rng = np.random.default_rng(3)
    solver = HorizonSolver(ROBOT, SETTINGS, WEIGHTS)
    free = 0
    for _ in range(60):
        p = random_problem(rng)
        expected = dense_solution(p)
        solver.p[:] = p
        assert solver.solve() == pytest.approx(expected, abs=1e-6)
        linear = linearized(p)
        unlimited = p[-STEPS:] + np.linalg.lstsq(linear.slopes, -linear.residuals, rcond=None)[0]
        free += np.allclose(unlimited, expected, atol=1e-6)
    assert free < 20


def test_what_was_solved_before_changes_nothing():
    """The same problem has the same answer to the bit, after others and in another solver."""
    rng = np.random.default_rng(4)
    solver = HorizonSolver(ROBOT, SETTINGS, WEIGHTS)
    problems = [random_problem(rng) for _ in range(20)]
    for p in (*problems, *problems[::-1]):
        solver.p[:] = p
        np.testing.assert_array_equal(solver.solve(), solved(p))


def test_a_program_that_nothing_fulfils_is_told():
    """Limits that exclude each other are a failure, and nothing stays of that."""
    solver = HorizonSolver(ROBOT, SETTINGS, WEIGHTS)
    good = numbers((0.01, 0.02, 0.05, 0.0), terminal_root('differential', STEP, WEIGHTS, 0.015))
    bad = good.copy()
    bad[HorizonParameters._fields.index('lowest')] = 0.7
    expected = solved(good)
    solver.p[:] = bad
    with pytest.raises(SolverFailed) as raised:
        solver.solve()
    assert raised.value.failure is SolverFailure.LIMITS_NOT_MET
    solver.p[:] = good
    np.testing.assert_array_equal(solver.solve(), expected)


def converged(place):
    """Solve the same problem by ipopt, and by steps around the last solution."""
    weights = optimal_weights(SETTINGS)
    problem = horizon_problem('differential', STEPS, STEP, weights)
    p = numbers(place, terminal_root('differential', STEP, weights, 0.015))
    u, slack = ca.SX.sym('u', STEPS), ca.SX.sym('slack')
    residuals, soft, low, high = problem(u, p)
    changes = u[1:] - u[:-1]
    cost = 0.5 * ca.sumsqr(residuals) + weights.slack * (slack + 0.5 * slack ** 2)
    solver = ca.nlpsol('exact', 'ipopt', {
        'x': ca.vertcat(u, slack), 'f': cost,
        'g': ca.vertcat(soft - high - slack, low - slack - soft, changes - 2.1, -changes - 2.1)},
        {'ipopt.print_level': 0, 'print_time': False, 'ipopt.tol': 1e-10})
    first = [0.2] + [0.6] * (STEPS - 1)
    exact = solver(ubg=0.0, lbx=[-x for x in first] + [0.0], ubx=first + [10.0])
    once = solved(p)
    many = once
    for _ in range(15):
        p[-STEPS:] = many
        many = solved(p)

    def cost_of(inputs):
        values, bounds, *_ = problem(inputs, p)
        rows = np.concatenate([np.array(bounds - high_), np.array(low_ - bounds)])
        beyond = max(0.0, rows.max())
        return 0.5 * float(ca.sumsqr(values)) + weights.slack * (beyond + 0.5 * beyond ** 2)

    _, _, low_, high_ = problem(once, p)
    return np.array(exact['x'][:-1]).ravel(), once, many, cost_of


@pytest.mark.parametrize('place', [(0.01, 0.02, 0.05, 0.0), (-0.04, 0.1, 0.2, 0.1),
                                   (0.08, -0.15, -0.3, -0.3)])
def test_steps_converge_to_the_exact_solution_and_one_step_is_nearly_there(place):
    """An independent solver finds the same optimum; the first step costs hardly more."""
    exact, once, many, cost = converged(place)
    assert many == pytest.approx(exact, abs=1e-3)
    assert cost(once) < 1.02 * cost(exact) + 1e-6


def test_a_broken_problem_is_answered_by_the_closed_form_law():
    """In the same call, counted, with its reason; afterwards the solver answers again."""
    law, good = PredictiveLaw(ROBOT, SETTINGS), situation(0.01, 0.02)
    bad = situation(0.01, 0.02, preview=lambda distances: np.full(len(distances), math.nan))
    assert law.curvature(bad) == ClosedFormLaw(SETTINGS).curvature(bad)
    assert law.solver == (1, SolverFailure.PROBLEM_NOT_FINITE)
    fresh = PredictiveLaw(ROBOT, SETTINGS)
    assert law.curvature(good) == fresh.curvature(good)
    assert law.solver.failures == 1


def test_limits_that_exclude_each_other_are_answered_by_the_closed_form_law():
    """As no command fulfils them; the next step begins a new plan."""
    law, good = PredictiveLaw(ROBOT, SETTINGS), situation(0.01, 0.02)
    bad = situation(0.01, 0.02, previous_curvature=0.1, max_change=-0.1)
    assert law.curvature(bad) == ClosedFormLaw(SETTINGS).curvature(bad)
    assert law.solver == (1, SolverFailure.LIMITS_NOT_MET)
    assert law.curvature(good) == PredictiveLaw(ROBOT, SETTINGS).curvature(good)


def test_a_problem_of_any_size_is_answered():
    """Huge and tiny numbers: a finite curvature, by the solver or by what replaces it."""
    rng = np.random.default_rng(6)
    law = PredictiveLaw(ROBOT, SETTINGS)
    for _ in range(300):
        size = 10.0 ** rng.uniform(-12.0, 12.0, 4)
        found = law.curvature(situation(*(size * rng.choice([-1.0, 1.0], 4)),
                                        lag_distance=10.0 ** rng.uniform(-6.0, 0.0),
                                        previous_curvature=rng.uniform(-0.6, 0.6)))
        assert math.isfinite(found)


def test_the_speed_does_not_matter_without_lag():
    """Ways count, not times."""
    assert (PredictiveLaw(ROBOT, SETTINGS).curvature(situation(0.02, 0.1, distance=0.001))
            == PredictiveLaw(ROBOT, SETTINGS).curvature(situation(0.02, 0.1, distance=0.005)))
