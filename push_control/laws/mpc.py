"""The predictive law: one step of sequential quadratic programming per call."""

import math

import numpy as np
from push_control.laws.closed_form import ClosedFormLaw
from push_control.laws.mpc_problem import horizon_problem, SCALARS, terminal_root
from push_control.laws.steering_law import (
    SolverFailure, SolverReport, SteeringInput, SteeringLaw,
)

TOLERANCE = 1e-4
WIDEST = 10.0


class SolverFailed(Exception):
    """
    The solver gave no answer that can be used.

    :param failure: why.
    """

    def __init__(self, failure: SolverFailure):
        """Keep the code."""
        super().__init__(failure.value)
        self.failure = failure


class PredictiveLaw(SteeringLaw):
    """
    Keeps the force in its cone and the contact in its place over the horizon.

    Where the solver gives no answer that can be used, the closed-form law answers in its stead.
    """

    def __init__(self, robot, settings):
        """
        Build the problem; its structure is kept for other pushes.

        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        """
        self._robot, self._settings = robot, settings
        self._instead = ClosedFormLaw(settings)
        self._step, steps = settings.horizon_step, settings.horizon_steps
        self._weights = optimal_weights(settings)
        self._solve, _ = horizon_problem(robot.drive, steps, self._step, self._weights)
        self._ways = self._step * (np.arange(steps) + 0.5)
        self._parameters = np.zeros(self._solve.size1_in(0))
        parts = np.split(self._parameters, np.cumsum([len(SCALARS), 9, steps]))
        self._scalars, self._root, self._path, self._start = parts
        self._plan, self._slack, self._beyond = np.zeros(steps), np.zeros(1), np.zeros(1)
        self._buffer, self._run = self._solve.buffer()
        self._buffer.set_arg(0, memoryview(self._parameters))
        for place, result in enumerate((self._plan, self._slack, self._beyond)):
            self._buffer.set_res(place, memoryview(result))
        self._curvature = None
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
            return self._optimum(steering)
        except SolverFailed as error:
            self._curvature = None
            self._solver = SolverReport(self._solver.failures + 1, error.failure)
            return self._instead.curvature(steering)

    def _optimum(self, steering: SteeringInput) -> float:
        self._fill(steering)
        if not math.isfinite(self._parameters.sum()):
            raise SolverFailed(SolverFailure.PROBLEM_NOT_FINITE)
        self._run()
        if not math.isfinite(self._plan.sum()):
            raise SolverFailed(SolverFailure.SOLUTION_NOT_FINITE)
        if not self._beyond[0] <= TOLERANCE:
            raise SolverFailed(SolverFailure.LIMITS_NOT_MET)
        return float(self._plan[0])

    def _fill(self, situation: SteeringInput) -> None:
        """Write the parameters, around the last plan moved on by the way since."""
        flat, track, lag = situation.vehicle, situation.project_now(), situation.lag_distance
        low, high = situation.limits
        low = min(low, high)
        path = self._path
        path[:] = situation.preview(self._ways)
        before = situation.previous_curvature
        if self._curvature is None or before is None:
            self._root[:] = terminal_root(self._robot.drive, self._step, self._weights,
                                          lag).ravel(order='F')
            self._curvature = min(high, max(low, path[0] if before is None else before))
            self._start[:] = path
        else:
            left = math.exp(-situation.distance / lag) if lag > 0.0 else 0.0
            self._curvature = before + left * (self._curvature - before)
            shift = situation.distance / self._step
            places = np.arange(len(path))
            self._start[:] = np.interp(places + shift, places, self._plan)
        np.clip(self._start, low, high, out=self._start)
        first = WIDEST if before is None else situation.max_change
        held = min(high, max(low, self._curvature if before is None else before))
        bound = self._settings.lateral_saturation
        self._scalars[:] = (
            min(bound, max(-bound, track.lateral_error)), track.heading_error, situation.zeta,
            self._curvature, flat.wheelbase, flat.c_squared / flat.arm, self._robot.radius,
            situation.zeta_rest, self._settings.rolling_gain, lag, situation.cone_angle,
            *situation.zeta_limits, low, high, max(low, held - first), min(high, held + first),
            self._settings.max_curvature_rate * self._step)


def optimal_weights(settings):
    """
    Weights for which the closed-form law is optimal beside a straight path, far from limits.

    With ``kappa = -k_y e_y - k_psi e_psi``: ``k_y^2`` and ``k_psi^2 - 2 k_y``, over that of
    ``kappa^2``.

    :param settings: ``ControlSettings``.
    :return: as ``horizon_problem`` takes them.
    """
    k_y, k_psi = settings.lateral_gain, settings.heading_gain
    return k_y ** 2, max(0.0, k_psi ** 2 - 2.0 * k_y), settings.cone_weight
