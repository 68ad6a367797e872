"""The predictive law: one step of sequential quadratic programming per control step."""

import math
from typing import NamedTuple

import numpy as np
from push_control.laws.closed_form import ClosedFormLaw
from push_control.laws.mpc_kernel import (
    active_shape, GAIN, shift_plan, solve_program, STEP_COLUMNS,
)
from push_control.laws.mpc_problem import (
    horizon_step, HorizonParameters, HorizonWeights, parameter_offsets, terminal_root,
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
    Solution of the problem; its array is overwritten by the next one.

    :param curvatures: commanded ones over the horizon [1/m], shape (N,).
    :param violation: largest violation of a constraint [rad, 1/m].
    """

    curvatures: FloatArray
    violation: float


class HorizonSolver:
    """
    The problem of one horizon, solved in place: nothing is allocated in the control loop.

    ``p``: the parameter vector, of which ``scalars``, ``root``, ``path`` and ``guess`` are views,
    laid out as ``parameter_offsets`` tells. ``curvatures``: the last solution, shape (N,).
    """

    def __init__(self, robot: RoundRobot, settings: ControlSettings, weights: HorizonWeights):
        """
        Build the problem.

        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param weights: ``HorizonWeights``.
        """
        steps, step = settings.horizon_steps, settings.horizon_step
        offsets = parameter_offsets(steps)
        self.p: FloatArray = np.zeros(offsets[-1])
        self.scalars, self.root, self.path, self.guess = np.split(self.p, offsets[1:-1])
        self._weights: FloatArray = np.array((step * weights.lateral, step * weights.heading, step,
                                              weights.slack))
        self._states: FloatArray = np.zeros((steps + 1, 4))
        self._steps: FloatArray = np.zeros((steps, STEP_COLUMNS))
        self._active: FloatArray = np.zeros(active_shape(steps))
        self._solution: FloatArray = np.zeros(2 * steps + 3)
        self.curvatures = self._solution[:steps]
        self._linearize = horizon_step(robot.drive, step).bind({
            'state': self._states[:-1], 'command': self.guess[:, None],
            'path': self.path[:, None], 'scalars': self.scalars, 'after': self._states[1:],
            'slopes': self._steps[:, :GAIN]})
        # Changes nothing that lasts, but loads machine code before the robot moves.
        self.scalars[:] = 1.0
        shift_plan(self.path, 0.0, 1.0, 1.0, self.guess)
        self.solve()
        for array in (self.p, self._solution):
            array[:] = 0.0

    def reset(self) -> None:
        """Forget which constraints bound."""
        self._solution[-1] = 0.0

    def solve(self) -> HorizonSolution:
        """
        Take one step from the guess.

        :return: ``HorizonSolution``.
        """
        self._states[0] = self.scalars[:4]
        self._linearize()
        violation = solve_program(self.p, self._weights, self._states, self._steps, self._active,
                                  self._solution)
        return HorizonSolution(self.curvatures, violation)


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
        self._horizon.reset()

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
            self.reset()
            self._solver = SolverReport(self._solver.failures + 1, error.failure)
            return self._fallback.curvature(steering)

    def _optimum(self) -> float:
        """Solve the problem; give the first of its curvatures [1/m]."""
        solution = self._horizon.solve()
        if math.isnan(solution.violation):
            raise SolverFailed(SolverFailure.PROBLEM_NOT_FINITE)
        if not math.isfinite(solution.curvatures[0]):
            raise SolverFailed(SolverFailure.SOLUTION_NOT_FINITE)
        if not solution.violation <= TOLERANCE:
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
        shift_plan(self._horizon.curvatures, shift, low, high, self._horizon.guess)
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
