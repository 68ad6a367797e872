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
                                       high=200.0, default=5.0)
    clearance: float = quantity('distance that a robot whose pose is certain keeps from the '
                                'object', 'm', above=0.0, high=1.0, default=0.03)
    map_clearance: float = quantity('distance that the robot keeps from obstacles of a map, more '
                                    'where its place is uncertain; the object keeps half of it '
                                    'besides the uncertainty of the push; 0.4 of both where there '
                                    'is no more room', 'm', 0.0, 1.0, default=0.05)
    standoff: float = quantity('gap at which the straight final approach to the contact begins',
                               'm', above=0.0, high=1.0, default=0.06)
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


@dataclasses.dataclass(frozen=True)
class MapSettings:
    """What counts as an obstacle in a map; names as in Nav2, where it has the same."""

    allow_unknown: bool = quantity('cells of which nothing is known are free, else obstacles',
                                   default=False)
    lethal_cost_threshold: float = quantity(
        'value from which on a cell is an obstacle: probability in percent, in a costmap its '
        'cost, where 99 is the robot itself and 100 the obstacle', '', 1.0, 100.0, default=50.0)
    footprint_clearing_enabled: bool = quantity(
        'obstacles where object or robot have been since the map was made are none: for costmaps '
        'that show the object or the robot as obstacles', default=False)
    footprint_clearing_margin: float = quantity(
        'distance from the footprint up to which an obstacle that does not go on beyond it is '
        'cleared, too', 'm', 0.0, 0.5, default=0.08)
    footprint_clearing_time: float = quantity(
        'age that measurements in a map may have at its stamp, as those of the laser in a '
        'costmap', 's', 0.0, 60.0, default=1.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


# Asked for at every path; a process has a handful of robots and settings.
@functools.lru_cache(maxsize=64)
def _limited(settings: DriveSettings, robot: RoundRobot) -> DriveSettings:
    return dataclasses.replace(
        settings, speed=min(settings.speed, robot.max_speed),
        yaw_rate=min(settings.yaw_rate, robot.max_yaw_rate),
        acceleration=min(settings.acceleration, robot.max_acceleration),
        yaw_acceleration=min(settings.yaw_acceleration, robot.max_yaw_acceleration))
