"""Time until a goal is reached, estimated from what was achieved so far."""

import math

from push_model.parameters import PushedObject

# Part of the first error that must be gone before an estimate is made; chosen: less means little,
# as the robot has to drive around the object first.
MIN_PROGRESS = 0.2


class RemainingTimeEstimator:
    """
    Assumes that errors go on to shrink as fast as they have on average since the goal was taken.

    With the error e_0 at first and e after the time t, the time left is t e / (e_0 - e).
    """

    def __init__(self, obj: PushedObject) -> None:
        """
        Start without errors.

        :param obj: the ``PushedObject``; its heading error counts as the distance at its rim.
        """
        self._rim_radius = max((math.hypot(*vertex) for vertex in obj.outline), default=obj.radius)
        self.reset()

    def reset(self) -> None:
        """Start over for another goal."""
        self._first_error = 0.0

    def estimate(self, elapsed_time: float, position_error: float, heading_error: float) -> float:
        """
        Estimate the time left [s], 0 while too little is achieved.

        :param elapsed_time: since the goal was taken [s].
        :param position_error: distance of the object from its goal [m].
        :param heading_error: of its heading [rad].
        """
        error = position_error + self._rim_radius * abs(heading_error)
        if not math.isfinite(error):
            return 0.0
        self._first_error = max(self._first_error, error)
        achieved = self._first_error - error
        if achieved <= MIN_PROGRESS * self._first_error:
            return 0.0
        return elapsed_time * error / achieved
