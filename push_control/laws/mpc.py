"""The predictive law: one step of sequential quadratic programming per control step."""

from collections.abc import Callable, Iterable
import math
from typing import Any, NamedTuple

import numpy as np
from push_control.laws.closed_form import ClosedFormLaw
from push_control.laws.mpc_kernel import (
    keeps_constraints, QuadraticProgram, shift_plan, solve_unconstrained, write_constraints,
    write_cost,
)
from push_control.laws.mpc_problem import (
    constraint_count, horizon_problem, HorizonParameters, HorizonWeights, Linearization,
    parameter_offsets, quadratic_solver, terminal_root,
)
from push_control.laws.steering_law import (
    SolverFailure, SolverReport, SteeringInput, SteeringLaw,
)
from push_control.settings import ControlSettings
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot

# Largest violation of a hard constraint that is still an answer [1/m]. Chosen: far below the
# noise of the curvature.
TOLERANCE = 1e-4
# Largest change of the curvature where none was commanded before [1/m]: none that binds.
UNLIMITED_CHANGE = 10.0


class SolverFailed(Exception):
    """
    The solver gave no answer that can be used.

    :param failure: why.
    """

    def __init__(self, failure: SolverFailure):
        """Keep the code."""
        super().__init__(failure.value)
        self.failure = failure


class HorizonSolution(NamedTuple):
    """
    Solution of the problem; its arrays are overwritten by the next one.

    :param curvatures: commanded ones over the horizon [1/m], shape (N,).
    :param slack: largest violation of a soft constraint [rad], shape (1,).
    :param violation: largest violation of a hard one [1/m], shape (1,).
    """

    curvatures: FloatArray
    slack: FloatArray
    violation: FloatArray


class HorizonSolver:
    """
    The problem of one horizon, solved in place: nothing is allocated in the control loop.

    ``p``: the parameter vector, of which ``scalars``, ``root``, ``path`` and ``guess`` are views,
    laid out as ``parameter_offsets`` tells. ``solution``: ``HorizonSolution``.
    """

    def __init__(self, robot: RoundRobot, settings: ControlSettings, weights: HorizonWeights):
        """
        Build the problem.

        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param weights: ``HorizonWeights``.
        """
        steps = settings.horizon_steps
        problem = horizon_problem(robot.drive, steps, settings.horizon_step, weights)
        offsets = parameter_offsets(steps)
        self.p: FloatArray = np.zeros(offsets[-1])
        self.scalars, self.root, self.path, self.guess = np.split(self.p, offsets[1:-1])
        self.solution = HorizonSolution(np.zeros(steps), np.zeros(1), np.zeros(1))
        # Casadi has matrices by columns.
        rows, soft = (problem.linear.size1_out(part) for part in (1, 3))
        self._linear = Linearization(np.zeros(rows), np.zeros((steps, rows)),
                                     np.zeros((3, soft)), np.zeros((steps, soft)))
        self._slack_weight = weights.slack
        constraints, size = constraint_count(steps), steps + 1
        self._bounds: FloatArray = np.zeros((2, constraints + size))
        (lba, uba), (lbx, ubx) = self._bounds[:, :constraints], self._bounds[:, constraints:]
        self._program = QuadraticProgram(
            np.zeros((size, size)), np.zeros(size), np.zeros((size, constraints)), lba, uba, lbx,
            ubx)
        # What does not depend on the guess: the slack, and each change of U from one to the next.
        a, changes = self._program.a, 2 * soft + np.arange(steps - 1)
        a[steps, :soft], a[steps, soft:2 * soft] = -1.0, 1.0
        a[np.arange(steps - 1), changes], a[np.arange(1, steps), changes] = -1.0, 1.0
        self._factor: FloatArray = np.zeros((steps, steps))
        self._x: FloatArray = np.zeros(size)
        self._linearize = _buffered(problem.linear, (self.p,), self._linear)
        self._optimize = _buffered(quadratic_solver(steps), self._program, (self._x,))
        # Changes nothing that lasts, but loads machine code before the robot moves.
        self.scalars[:] = 1.0
        shift_plan(self.path, 0.0, 1.0, 1.0, self.guess)
        self.solve()
        for array in (self.p, *self.solution):
            array[:] = 0.0

    def solve(self) -> HorizonSolution:
        """
        Take one step from the guess.

        :return: ``HorizonSolution``.
        """
        solution, linear, program = self.solution, self._linear, self._program
        self._linearize()
        write_cost(linear.residuals, linear.slopes, self._slack_weight, program.h, program.g)
        solve_unconstrained(self.guess, program.h, program.g, self._factor, solution.curvatures)
        solution.slack[0] = solution.violation[0] = 0.0
        if not keeps_constraints(self.scalars, self.guess, linear.soft, linear.soft_slopes,
                                 solution.curvatures):
            write_constraints(self.scalars, self.guess, linear.soft, linear.soft_slopes,
                              program.a, self._bounds)
            self._optimize()
            np.add(self.guess, self._x[:-1], out=solution.curvatures)
            solution.slack[0] = self._x[-1]
            rows = np.concatenate((self._x @ program.a, self._x))
            lower, upper = self._bounds
            solution.violation[0] = max((rows - upper).max(), (lower - rows).max())
        return solution


def _buffered(function: Any, arguments: Iterable[FloatArray],
              results: Iterable[FloatArray]) -> Callable[[], None]:
    """
    Let a casadi function read and write arrays in place.

    :param function: ``casadi.Function``.
    :param arguments: one array for each argument, by columns.
    :param results: one array for each result, by columns.
    :return: what evaluates it.
    """
    buffer, run = function.buffer()
    for index, argument in enumerate(arguments):
        buffer.set_arg(index, argument.data)
    for index, result in enumerate(results):
        buffer.set_res(index, result.data)

    def evaluate(_: Any = buffer) -> None:
        # The buffer must live as long as what runs on it.
        run()

    return evaluate


class PredictiveLaw(SteeringLaw):
    """
    Keeps the force in its cone and the contact on its feature over the horizon.

    Where the solver gives no answer that can be used, the closed-form law replaces it.
    """

    def __init__(self, robot: RoundRobot, settings: ControlSettings):
        """
        Build the problem; its structure is kept for other pushes.

        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        """
        self._robot = robot
        self._settings = settings
        self._fallback = ClosedFormLaw(settings)
        self._weights = optimal_weights(settings)
        self._horizon = HorizonSolver(robot, settings, self._weights)
        self._distances = np.asarray(
            settings.horizon_step * (np.arange(settings.horizon_steps) + 0.5), dtype=np.float64)
        # The lagging curvature, as far as it follows what was commanded; None without a plan.
        self._curvature: float | None = None
        self._solver = SolverReport()

    @property
    def solver(self) -> SolverReport:
        """Report of the solver over all pushes."""
        return self._solver

    def reset(self) -> None:
        """Forget the last plan."""
        self._curvature = None

    def curvature(self, steering: SteeringInput) -> float:
        """
        Choose the curvature of z; the caller brings it into the limits.

        :param steering: ``SteeringInput``.
        :return: curvature [1/m].
        """
        try:
            self._set_parameters(steering)
            return self._optimum()
        except SolverFailed as error:
            self._curvature = None
            self._solver = SolverReport(self._solver.failures + 1, error.failure)
            return self._fallback.curvature(steering)

    def _optimum(self) -> float:
        """Solve the problem; give the first of its curvatures [1/m]."""
        # A sum is finite only where all its terms are.
        if not math.isfinite(self._horizon.p.sum()):
            raise SolverFailed(SolverFailure.PROBLEM_NOT_FINITE)
        solution = self._horizon.solve()
        if not math.isfinite(solution.curvatures.sum()):
            raise SolverFailed(SolverFailure.SOLUTION_NOT_FINITE)
        if not solution.violation[0] <= TOLERANCE:
            raise SolverFailed(SolverFailure.LIMITS_NOT_MET)
        return float(solution.curvatures[0])

    def _set_parameters(self, steering: SteeringInput) -> None:
        """Write the parameters, around the last plan shifted by the distance since."""
        ahead = steering.foresee()
        projection, pushed = ahead.projection, ahead.vehicle
        self._horizon.path[:] = ahead.preview(self._distances)
        low, high = steering.limits
        low = min(low, high)
        before = steering.previous_curvature
        if self._curvature is None or before is None:
            curvature = self._start_plan(steering, low, high)
        else:
            curvature = self._shift_plan(steering, self._curvature, before, low, high)
        self._curvature = curvature
        max_change = UNLIMITED_CHANGE if before is None else steering.max_change
        held = min(high, max(low, curvature if before is None else before))
        saturation = self._settings.lateral_saturation
        self._horizon.scalars[:] = HorizonParameters(
            lateral_error=min(saturation, max(-saturation, projection.lateral_error)),
            heading_error=projection.heading_error,
            zeta=ahead.zeta,
            curvature=curvature,
            wheelbase=pushed.wheelbase,
            force_slope=pushed.c_squared / pushed.arm,
            robot_radius=self._robot.radius,
            zeta_rest=ahead.zeta_rest,
            rolling_gain=self._settings.rolling_gain,
            lag_distance=steering.lag_distance,
            cone_angle=ahead.cone_angle,
            zeta_low=ahead.zeta_limits[0],
            zeta_high=ahead.zeta_limits[1],
            lowest=low,
            highest=high,
            first_lowest=max(low, held - max_change),
            first_highest=min(high, held + max_change),
            max_change=self._settings.max_curvature_rate * self._settings.horizon_step)

    def _start_plan(self, steering: SteeringInput, low: float, high: float) -> float:
        """Begin with the path's curvatures; give the present curvature [1/m]."""
        root = terminal_root(self._robot.drive, self._settings.horizon_step, self._weights,
                             steering.lag_distance)
        self._horizon.root[:] = root.ravel(order='F')
        shift_plan(self._horizon.path, 0.0, low, high, self._horizon.guess)
        before = steering.previous_curvature
        return min(high, max(low, self._horizon.path[0] if before is None else before))

    def _shift_plan(self, steering: SteeringInput, curvature: float, before: float, low: float,
                    high: float) -> float:
        """Begin with the last plan; give the present curvature, which lags [1/m]."""
        lag = steering.lag_distance
        decay = math.exp(-steering.distance / lag) if lag > 0.0 else 0.0
        shift = steering.distance / self._settings.horizon_step
        shift_plan(self._horizon.solution.curvatures, shift, low, high, self._horizon.guess)
        return before + decay * (curvature - before)


def optimal_weights(settings: ControlSettings) -> HorizonWeights:
    """
    Weights for which the closed-form law is optimal beside a straight path, far from limits.

    With ``kappa = -k_y e_y - k_psi e_psi``: ``k_y^2`` and ``k_psi^2 - 2 k_y``, over that of
    ``kappa^2``.

    :param settings: ``ControlSettings``.
    :return: ``HorizonWeights``.
    """
    k_y, k_psi = settings.lateral_gain, settings.heading_gain
    return HorizonWeights(k_y ** 2, max(0.0, k_psi ** 2 - 2.0 * k_y), settings.cone_weight)
