"""Interface of the steering laws: what a law knows of the push, and what it answers."""

import abc
import enum
from typing import Callable, NamedTuple

from push_control.steered.path.path import CurvatureLimits, PathProjection
from push_model.geometry import FloatArray
from push_model.quasi_static import Vehicle


class Foresight(NamedTuple):
    """
    Knowledge of a law that looks ahead along the path.

    :param projection: ``PathProjection`` of z now.
    :param preview: gives the path's curvatures [1/m] at distances beyond that, shape (n,) each.
    :param vehicle: the object as ``Vehicle``.
    :param zeta: angle from C->F to the contact normal now [rad].
    :param zeta_rest: where zeta comes to rest on a straight path: the heading offset D of a
        differential drive, else where the contact is rolled to [rad].
    :param zeta_limits: (lowest, highest) zeta at which the contact stays on its feature [rad].
    :param cone_angle: half angle of the friction cone that may be used [rad].
    """

    projection: PathProjection
    preview: Callable[[FloatArray], FloatArray]
    vehicle: Vehicle
    zeta: float
    zeta_rest: float
    zeta_limits: tuple[float, float]
    cone_angle: float


class SteeringInput(NamedTuple):
    """
    The push at one instant; lengths are arc lengths of the flat output z [m].

    :param projection: ``PathProjection`` of z one drive lag ahead.
    :param limits: ``CurvatureLimits``.
    :param previous_curvature: commanded last [1/m], or None at the start.
    :param max_change: largest change from it [1/m].
    :param distance: covered since then.
    :param lag_distance: by which the drive lags behind.
    :param foresee: gives the ``Foresight``; a law that does not look ahead does not ask for it.
    """

    projection: PathProjection
    limits: CurvatureLimits
    previous_curvature: float | None
    max_change: float
    distance: float
    lag_distance: float
    foresee: Callable[[], Foresight]

    def clip(self, curvature: float) -> float:
        """
        Bring a curvature into the limits, as far as the largest change allows.

        :param curvature: as chosen [1/m].
        :return: curvature that may be commanded [1/m].
        """
        curvature = self.limits.clip(curvature)
        before = self.previous_curvature
        if before is None:
            return curvature
        return min(before + self.max_change, max(before - self.max_change, curvature))


class SolverFailure(enum.Enum):
    """Why a solver gave no answer that can be used."""

    PROBLEM_NOT_FINITE = 'the problem is not finite'
    SOLUTION_NOT_FINITE = 'the solution is not finite'
    LIMITS_NOT_MET = 'the solver was stopped before it met the limits'


class SolverReport(NamedTuple):
    """
    Report of a law's solver so far.

    :param failures: number of steps without an answer that can be used.
    :param last: why there was none the last time, or None.
    """

    failures: int = 0
    last: SolverFailure | None = None


class SteeringLaw(abc.ABC):
    """Chooses the curvature of the flat output's path at every control step."""

    @property
    def solver(self) -> SolverReport:
        """Report of the law's solver; a law without one never fails."""
        return SolverReport()

    @abc.abstractmethod
    def reset(self) -> None:
        """Forget what was planned and commanded: the robot sets out again."""

    @abc.abstractmethod
    def curvature(self, steering: SteeringInput) -> float:
        """
        Choose the curvature of z; the caller brings it into the limits.

        :return: curvature [1/m].
        """
