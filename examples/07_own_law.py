"""
Steer a push by a law of your own: aim at a point ahead of the object on its path.

``push replay friction_interval --law my_module:VectorField`` takes the same class over DDS.
"""

import math

from push_control import ControlSettings, SteeringInput, SteeringLaw
from push_model import RoundRobot
from push_scenario import format_report, load_scenario, simulate


class VectorField(SteeringLaw):
    """Vector field guidance: turns towards the path, the steeper the further away it is."""

    lookahead = 0.4  # [m]

    def __init__(self, robot: RoundRobot, settings: ControlSettings) -> None:
        """Take nothing: all that this law knows is in each step."""

    def reset(self) -> None:
        """Do nothing: this law has no memory."""

    def curvature(self, steering: SteeringInput) -> float:
        """Choose the curvature of the path [1/m]; the controller keeps it within friction."""
        path = steering.projection
        desired_heading = -math.atan(path.lateral_error / self.lookahead)
        return path.curvature + 2.0 / self.lookahead * (desired_heading - path.heading_error)


def main() -> None:
    """Compare it with the law of the package."""
    scenario = load_scenario('friction_interval')
    results = [simulate(scenario, law) for law in (VectorField, 'feedback')]
    print(format_report(results))


if __name__ == '__main__':
    main()
