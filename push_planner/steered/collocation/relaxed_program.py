"""
The program of a push with relaxed inequalities: it explains why a push cannot be planned.

All inequalities may be violated by a common excess e >= 0 at a price, ``g_i(x) + e >= 0``. Ipopt
solves it, more slowly and more robustly than the planner's own method solves the program itself.
An excess that remains at the optimum tells which limit cannot be kept.
"""

import casadi as ca
import numpy as np
from push_model.geometry import FloatArray
from push_model.plan_request import PlanFailure
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.collocation.formulation import Formulation, MIN_FREE_LENGTH
from push_planner.steered.collocation.solution import Solution, SolveResult, VariableBounds
from push_planner.steered.collocation.transcription import Transcription

# Price of the excess [m]. Chosen: dear against paths of some metres, so that limits are violated
# only where no push keeps them.
EXCESS_PRICE = 100.0
# Excess that the search starts from, and up to which it counts as none. Chosen: a noticeable
# violation; and the tolerance of the solver.
FIRST_EXCESS = 0.05
NEGLIGIBLE_EXCESS = 1e-5
OPTIONS = {'print_time': False, 'error_on_fail': False, 'expand': True, 'ipopt': {
    'print_level': 0, 'sb': 'yes', 'max_iter': 80, 'tol': 1e-4, 'mu_init': 1e-2,
    'acceptable_iter': 0, 'linear_solver': 'mumps'}}


class RelaxedProgram:
    """
    All relaxed programs of the same dimensions.

    :param dimensions: ``Dimensions``.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        """Build the program."""
        self._dimensions = dimensions
        self._program = program = Transcription(dimensions)
        self._upper = np.where(program.equality, 0.0, np.inf)
        excess = ca.MX.sym('excess')
        inequality = ca.DM(np.where(program.equality, 0.0, 1.0))
        self._solver = ca.nlpsol('relaxed', 'ipopt', {
            'x': ca.vertcat(program.x, excess), 'p': program.p,
            'f': program.cost + EXCESS_PRICE * excess,
            'g': program.rows + inequality * excess}, OPTIONS)

    def solve(self, formulation: Formulation, guess: Solution) -> SolveResult:
        """
        Solve the relaxed program.

        :param formulation: ``Formulation`` of these dimensions.
        :param guess: ``Solution`` to start from.
        """
        column = np.append(guess.column(self._dimensions), FIRST_EXCESS)
        low, high = variable_limits(self._dimensions, formulation.bounds)
        answer = self._solver(x0=column, p=formulation.parameters(), lbx=np.append(low, 0.0),
                              ubx=np.append(high, np.inf), lbg=0.0, ubg=self._upper)
        stats = self._solver.stats()
        optimum = np.array(answer['x']).ravel()
        count = int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(optimum).all():
            return SolveResult(None, count, PlanFailure.NOT_CONVERGED,
                               'the search did not converge')
        excess = optimum[-1]
        if excess > NEGLIGIBLE_EXCESS:
            limit = self._dearest_limit(np.array(answer['lam_g']).ravel())
            return SolveResult(None, count, PlanFailure.LIMIT_EXCEEDED,
                               f'{limit} would be exceeded by {excess:.2g}')
        return SolveResult(Solution.of_column(optimum[:-1], self._dimensions), count)

    def _dearest_limit(self, multipliers: FloatArray) -> str:
        """Name the inequality with the largest multiplier."""
        prices = np.abs(multipliers)
        prices[self._program.equality] = 0.0
        constraint = self._program.constraints[int(prices.argmax())]
        return constraint.value if constraint else ''


def variable_limits(dimensions: Dimensions,
                    bounds: VariableBounds) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest values of the variables, infinite where there is no limit."""
    low = np.full((dimensions.step_count + 1, dimensions.step_size), -np.inf)
    high = -low
    # The columns are S, w, rho, theta, q_x, q_y.
    low[0, 0] = MIN_FREE_LENGTH
    low[:, 2], high[:, 2] = -bounds.angle, bounds.angle
    low[0, 2], high[0, 2] = bounds.first_angle
    low[:, 3], high[:, 3] = bounds.rotation
    return low.ravel()[:dimensions.variable_count], high.ravel()[:dimensions.variable_count]
