"""Settings of the robot while it does not push: speeds, accelerations and distances."""

import dataclasses
import functools

from push_model.parameters import RoundRobot
from push_model.quantity import check, quantity

# Standard deviations of the robot's position by which paths keep farther off, and by how much at
# most [m]; chosen: a detour of a decimetre costs half a second, running into the object several.
CLEARANCE_SIGMAS = 2.0
MAX_ADDED_CLEARANCE = 0.06


@dataclasses.dataclass(frozen=True)
class DriveSettings:
    """Speeds and distances of the robot on its path; the robot's own limits hold besides."""

    speed: float = quantity('speed on the path', 'm/s', above=0.0, high=10.0, default=0.4)
    yaw_rate: float = quantity('yaw rate on the path', 'rad/s', above=0.0, high=50.0, default=1.9)
    acceleration: float = quantity('acceleration on the path', 'm/s^2', above=0.0, high=100.0,
                                   default=0.8)
    yaw_acceleration: float = quantity('yaw acceleration on the path', 'rad/s^2', above=0.0,
                                       high=1000.0, default=5.0)
    clearance: float = quantity('distance that a robot whose pose is certain keeps from the '
                                'object', 'm', above=0.0, high=1.0, default=0.03)
    map_clearance: float = quantity('distance that the robot keeps from obstacles of a map, more '
                                    'where its place is uncertain; the object keeps half of it '
                                    'besides the uncertainty of the push; 0.4 of both where there '
                                    'is no more room', 'm', 0.0, 1.0, default=0.05)
    standoff: float = quantity('gap at which the straight final approach to the contact begins',
                               'm', 0.0, 1.0, default=0.06)
    retreat_distance: float = quantity('length of the straight path off the object after a push',
                                       'm', above=0.0, high=1.0, default=0.15)
    max_reverse_distance: float = quantity('longest path round the object on which a differential '
                                           'drive moves backwards', 'm', 0.0, 100.0, default=0.5)
    reverse_limit: float = quantity('distance that a differential drive moves backwards at a '
                                    'time, more only where it has to leave the object; for bases '
                                    'that limit it, as Create 3 does', 'm', above=0.0, high=100.0,
                                    default=100.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    def limited_to(self, robot: RoundRobot) -> 'DriveSettings':
        """
        Limit speeds and accelerations to those of a robot.

        :param robot: the ``RoundRobot``.
        :return: ``DriveSettings``.
        """
        return _limited(self, robot)

    def with_clearances(self, fraction: float) -> 'DriveSettings':
        """
        Reduce the clearances from object and obstacles.

        :param fraction: what remains of them.
        :return: ``DriveSettings``.
        """
        return dataclasses.replace(self, clearance=fraction * self.clearance,
                                   map_clearance=fraction * self.map_clearance)

    def for_uncertain_robot(self, deviation: float) -> 'DriveSettings':
        """
        Widen the clearance, as the robot may be elsewhere than it is estimated to be.

        :param deviation: standard deviation of the robot's position [m].
        :return: ``DriveSettings``.
        """
        added = min(MAX_ADDED_CLEARANCE, CLEARANCE_SIGMAS * deviation)
        return dataclasses.replace(self, clearance=min(1.0, self.clearance + added))


# Asked for at every path; a process has a handful of robots and settings.
@functools.lru_cache(maxsize=64)
def _limited(settings: DriveSettings, robot: RoundRobot) -> DriveSettings:
    return dataclasses.replace(
        settings, speed=min(settings.speed, robot.max_speed),
        yaw_rate=min(settings.yaw_rate, robot.max_yaw_rate),
        acceleration=min(settings.acceleration, robot.max_acceleration),
        yaw_acceleration=min(settings.yaw_acceleration, robot.max_yaw_acceleration))
