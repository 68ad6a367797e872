"""Steering laws of somebody else's, in a module of their own."""

import math

from push_control import SteeringLaw
from push_control.steered.laws.closed_form import ClosedFormLaw


class Same(ClosedFormLaw):
    """Steers as the law of the package does."""

    def __init__(self, robot, settings):
        """Take the gains."""
        super().__init__(settings)


class Lost(Same):
    """Chooses nothing."""

    def curvature(self, steering):
        """Return no number."""
        return math.nan


class Incomplete(SteeringLaw):
    """Lacks its curvature."""

    def __init__(self, robot, settings):
        """Take nothing."""

    def reset(self):
        """Do nothing."""


class WithoutRobot(ClosedFormLaw):
    """Is made from something else."""


NO_LAW = 3.0
