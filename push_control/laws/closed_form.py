"""What a steering law sees, and the closed-form one."""

from typing import Callable, NamedTuple, Optional

from push_control.laws.curvature_limits import CurvatureLimits, feedback_curvature
from push_control.path.guidance import PathProjection
from push_model.quasi_static import Vehicle


class SteeringInput(NamedTuple):
    """
    The push at one instant; ways are those of z [m].

    :param track: ``PathProjection`` of z one drive lag ahead.
    :param present: gives the ``PathProjection`` of z now.
    :param preview: gives the curvatures of the path at ways beyond the present place.
    :param flat: the ``Vehicle``.
    :param zeta: angle from C->F to the contact normal now [rad].
    :param rest: where zeta rests on a straight way: D of a differential drive, else where the
        contact is rolled to [rad].
    :param zeta_limits: (lowest, highest) zeta at which the contact stays in its place [rad].
    :param limits: ``CurvatureLimits``.
    :param cone: half angle of the friction cone that may be used [rad].
    :param before: curvature commanded last, or None.
    :param change: largest change from it.
    :param moved: way since then.
    :param lag: way that the drive lags behind.
    """

    track: PathProjection
    present: Callable
    preview: Callable
    flat: Vehicle
    zeta: float
    rest: float
    zeta_limits: tuple
    limits: CurvatureLimits
    cone: float
    before: Optional[float]
    change: float
    moved: float
    lag: float

    def allowed(self, curvature):
        """
        Bring a curvature into the limits, as far as the largest change lets it.

        :param curvature: wanted [1/m].
        """
        curvature = self.limits.clip(curvature)
        if self.before is None:
            return curvature
        return min(self.before + self.change, max(self.before - self.change, curvature))


class ClosedFormLaw:
    """Feedback of the errors one drive lag ahead."""

    def __init__(self, settings):
        """
        Take the gains.

        :param settings: ``ControlSettings``.
        """
        self._settings = settings
        self.report = {'solver_failures': 0, 'solver_reason': ''}

    def reset(self):
        """Set out anew; this law remembers nothing."""

    def curvature(self, situation):
        """
        Choose the curvature of z, before any limit.

        :param situation: ``SteeringInput``.
        :return: curvature [1/m].
        """
        track = situation.track
        return feedback_curvature(track.lateral_error, track.heading_error, track.curvature,
                                  self._settings)
