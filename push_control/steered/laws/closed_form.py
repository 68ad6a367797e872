"""The closed-form steering law: state feedback of the path errors."""

from push_control.settings import ControlSettings
from push_control.steered.laws.steering_law import SteeringInput, SteeringLaw


class ClosedFormLaw(SteeringLaw):
    """Feedback of the errors one drive lag ahead."""

    def __init__(self, settings: ControlSettings):
        """Take the gains."""
        self._settings = settings

    def reset(self) -> None:
        """Do nothing: this law has no memory."""

    def curvature(self, steering: SteeringInput) -> float:
        """Choose the curvature of z; the caller brings it into the limits."""
        projection = steering.projection
        return feedback_curvature(projection.lateral_error, projection.heading_error,
                                  projection.curvature, self._settings)


def feedback_curvature(lateral_error: float, heading_error: float, path_curvature: float,
                       settings: ControlSettings) -> float:
    """
    Curvature of z that brings it back to its path, before any limit.

    ``kappa = kappa_path - k_y sat(e_y) - k_psi e_psi``.

    :param lateral_error: e_y of z, left of the path is positive [m].
    :param heading_error: e_psi of z, to the left is positive [rad].
    :param path_curvature: kappa_path of the path there [1/m].
    :return: curvature [1/m].
    """
    bound = settings.lateral_saturation
    saturated = min(bound, max(-bound, lateral_error))
    return (path_curvature - settings.lateral_gain * saturated
            - settings.heading_gain * heading_error)
