"""Settings on which the expected time of a task depends, besides the object."""

import dataclasses
import math

from push_model.parameters import Drive, DRIVES
from push_model.plan_request import MAX_HEADING_TOLERANCE
from push_model.quantity import check, quantity

# Lengths of robot path that backing off and coming again costs, in a straight line and turning to
# it [m], by drive: fitted to simulated contacts of a robot at 0.3 m/s.
CONTACT_PATHS: dict[Drive, float] = {'differential': 0.9, 'holonomic': 0.6}


@dataclasses.dataclass(frozen=True)
class CostSettings:
    """Settings on which the expected time of a task depends, besides the object."""

    position_tolerance: float = quantity('largest distance from the goal', 'm', above=0.0,
                                         high=1.0, default=0.01)
    heading_tolerance: float = quantity('largest heading error at the goal', 'rad', above=0.0,
                                        high=MAX_HEADING_TOLERANCE, default=math.radians(1.0))
    position_deviation: float = quantity('standard deviation of the position as it is measured '
                                         'at rest; leaves that much less of the tolerance', 'm',
                                         0.0, 0.1, default=0.0015)
    heading_deviation: float = quantity('the same of the heading', 'rad', 0.0, 0.1,
                                        default=math.radians(0.2))
    pushing_speed: float = quantity('speed of pushes', 'm/s', above=0.0, high=5.0, default=0.25)
    robot_speed: float = quantity('speed of the robot on its own', 'm/s', above=0.0, high=5.0,
                                  default=0.3)
    drive: Drive = quantity('kinematics of the robot', choices=DRIVES, default='differential')
    push_time: float = quantity('time to accelerate and brake, per push', 's', 0.0, 60.0,
                                default=0.5)
    contact_time: float = quantity('time to measure at rest, to plan and to settle, per contact',
                                   's', 0.0, 60.0, default=1.3)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def position_limit(self) -> float:
        """Distance within which the object counts as at its goal [m]."""
        return max(0.3 * self.position_tolerance,
                   self.position_tolerance - self.position_deviation)

    @property
    def heading_limit(self) -> float:
        """Heading error within which the object counts as at its goal [rad], pi at most."""
        return min(math.pi, max(0.3 * self.heading_tolerance,
                                self.heading_tolerance - self.heading_deviation))
