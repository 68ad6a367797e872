"""The predictive law: one step of sequential quadratic programming per control step."""

from functools import lru_cache
import math
from typing import Any

import casadi as ca
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.laws.closed_form import ClosedFormLaw
from push_control.steered.laws.mpc_problem import (
    horizon_program, HorizonParameters, HorizonWeights, parameter_offsets, terminal_root)
from push_control.steered.laws.steering_law import (
    SolverFailure, SolverReport, SteeringInput, SteeringLaw)
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot

# Largest change of the curvature where none was commanded before [1/m]: none that binds.
UNLIMITED_CHANGE = 10.0
# Active-set method of D. Arnstrom et al., A dual active-set solver for embedded quadratic
# programming, 2022: exact, after a bounded number of changes of the active set. Chosen: tolerances
# [rad, 1/m] far below the noise of the curvature; several times as many changes as are needed.
SOLVER = 'daqp'
TOLERANCES = {'primal_tol': 1e-9, 'dual_tol': 1e-12}
MAX_ITERATIONS = 200


class SolverFailed(Exception):
    """
    The solver gave no answer that can be used.

    :param failure: why.
    """

    def __init__(self, failure: SolverFailure):
        """Keep the code."""
        super().__init__(failure.value)
        self.failure = failure


class HorizonSolver:
    """
    The problem of one horizon, solved in place: nothing is allocated in the control loop.

    ``p``: the parameter vector, of which ``scalars``, ``root``, ``path`` and ``guess`` are views,
    laid out as ``parameter_offsets`` tells. ``curvatures``: the last solution, shape (N,). It
    depends on ``p`` alone, and not on what was solved before.
    """

    def __init__(self, robot: RoundRobot, settings: ControlSettings, weights: HorizonWeights):
        """Build the problem."""
        steps, step = settings.horizon_steps, settings.horizon_step
        offsets = parameter_offsets(steps)
        self.p: FloatArray = np.zeros(offsets[-1])
        self.scalars, self.root, self.path, self.guess = np.split(self.p, offsets[1:-1])
        self.curvatures: FloatArray = np.zeros(steps)
        program: Any = horizon_program(robot.drive, steps, step, weights)
        solver = _solver(program, MAX_ITERATIONS)
        parts = {name: np.zeros(program.nnz_out(name)) for name in program.name_out()}
        optimum = np.zeros(steps + 1)
        self._changes = optimum[:steps]
        self._formulation, self._formulate = program.buffer()
        self._formulation.set_arg(0, self.p.data)
        self._solution, self._solve = solver.buffer()
        for name, part in parts.items():
            self._formulation.set_res(program.index_out(name), part.data)
            self._solution.set_arg(solver.index_in(name), part.data)
        self._solution.set_res(solver.index_out('x'), optimum.data)
        # What casadi reads and writes must live as long as this.
        self._memory = parts, optimum

    def solve(self) -> FloatArray:
        """
        Take one step from the guess.

        :return: ``curvatures``, overwritten by the next solution [1/m].
        :raises SolverFailed: where nothing fulfils the constraints, or a number is none.
        """
        if not np.isfinite(self.p).all():
            raise SolverFailed(SolverFailure.PROBLEM_NOT_FINITE)
        self._formulate()
        try:
            self._solve()
        except RuntimeError as error:
            # So does casadi refuse limits that exclude each other.
            raise SolverFailed(SolverFailure.LIMITS_NOT_MET) from error
        if not self._solution.stats()['success']:
            raise SolverFailed(SolverFailure.LIMITS_NOT_MET)
        np.add(self.guess, self._changes, out=self.curvatures)
        if not np.isfinite(self.curvatures).all():
            raise SolverFailed(SolverFailure.SOLUTION_NOT_FINITE)
        return self.curvatures


@lru_cache(maxsize=8)
def _solver(program: Any, max_iterations: int) -> Any:
    """Build the solver of a quadratic program."""
    matrices = {name: program.sparsity_out(name) for name in ('h', 'a')}
    return ca.conic('horizon', SOLVER, matrices, {
        'print_time': False, 'error_on_fail': False,
        SOLVER: {**TOLERANCES, 'iter_limit': max_iterations}})


class PredictiveLaw(SteeringLaw):
    """
    Keeps the force in its cone and the contact on its feature over the horizon.

    Where the solver gives no answer that can be used, the closed-form law replaces it.
    """

    def __init__(self, robot: RoundRobot, settings: ControlSettings):
        """Build the problem; its structure is kept for other pushes."""
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
        """Choose the curvature of z; the caller brings it into the limits."""
        try:
            self._set_parameters(steering)
            return float(self._horizon.solve()[0])
        except SolverFailed as error:
            self.reset()
            self._solver = SolverReport(self._solver.failures + 1, error.failure)
            return self._fallback.curvature(steering)

    def _set_parameters(self, steering: SteeringInput) -> None:
        """Write the parameters, around the last plan shifted by the distance since."""
        foresight = steering.foresee()
        projection, pushed = foresight.projection, foresight.vehicle
        self._horizon.path[:] = foresight.preview(self._distances)
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
            zeta=foresight.zeta,
            curvature=curvature,
            wheelbase=pushed.wheelbase,
            force_slope=pushed.c_squared / pushed.arm,
            robot_radius=self._robot.radius,
            zeta_rest=foresight.zeta_rest,
            rolling_gain=self._settings.rolling_gain,
            lag_distance=steering.lag_distance,
            cone_angle=foresight.cone_angle,
            zeta_low=foresight.zeta_limits[0],
            zeta_high=foresight.zeta_limits[1],
            lowest=low,
            highest=high,
            first_lowest=max(low, held - max_change),
            first_highest=min(high, held + max_change),
            max_change=self._settings.max_curvature_rate * self._settings.horizon_step)

    def _start_plan(self, steering: SteeringInput, low: float, high: float) -> float:
        """Start with the path's curvatures; return the present curvature [1/m]."""
        root = terminal_root(self._robot.drive, self._settings.horizon_step, self._weights,
                             steering.lag_distance)
        self._horizon.root[:] = root.ravel(order='F')
        np.clip(self._horizon.path, low, high, out=self._horizon.guess)
        before = steering.previous_curvature
        return min(high, max(low, self._horizon.path[0] if before is None else before))

    def _shift_plan(self, steering: SteeringInput, curvature: float, before: float, low: float,
                    high: float) -> float:
        """Start with the last plan; return the present curvature, which lags [1/m]."""
        lag = steering.lag_distance
        decay = math.exp(-steering.distance / lag) if lag > 0.0 else 0.0
        # The last curvature holds beyond the end of the plan.
        plan = np.interp(self._distances + steering.distance, self._distances,
                         self._horizon.curvatures)
        np.clip(plan, low, high, out=self._horizon.guess)
        return before + decay * (curvature - before)


def optimal_weights(settings: ControlSettings) -> HorizonWeights:
    """
    Weights for which the closed-form law is optimal beside a straight path, far from limits.

    With ``kappa = -k_y e_y - k_psi e_psi``: ``k_y^2`` and ``k_psi^2 - 2 k_y``, over that of
    ``kappa^2``.
    """
    k_y, k_psi = settings.lateral_gain, settings.heading_gain
    return HorizonWeights(k_y ** 2, max(0.0, k_psi ** 2 - 2.0 * k_y), settings.cone_weight)
