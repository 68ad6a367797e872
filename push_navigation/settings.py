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

    speed: float = quantity('speed of the robot alone', 'm/s', above=0.0, high=10.0, is_basic=True,
                            default=0.4)
    yaw_rate: float = quantity('yaw rate of the robot alone', 'rad/s', above=0.0, high=50.0,
                               default=1.9)
    acceleration: float = quantity('acceleration of the robot alone', 'm/s^2', above=0.0,
                                   high=100.0, default=0.8)
    yaw_acceleration: float = quantity('yaw acceleration of the robot alone', 'rad/s^2', above=0.0,
                                       high=200.0, default=5.0)
    clearance: float = quantity('distance to the object besides pose uncertainty', 'm', above=0.0,
                                high=1.0, default=0.03)
    map_clearance: float = quantity('distance to obstacles of a map; half of it for the object',
                                    'm', 0.0, 1.0, is_basic=True, default=0.05)
    standoff: float = quantity('gap at which the straight approach starts', 'm', above=0.0,
                               high=1.0, default=0.06)
    retreat_distance: float = quantity('straight retreat after a push', 'm', above=0.0, high=1.0,
                                       default=0.15)
    max_reverse_distance: float = quantity('longest reverse path of a differential drive', 'm',
                                           0.0, 100.0, default=0.5)
    reverse_limit: float = quantity('reverse distance that the base allows at a time', 'm',
                                    above=0.0, high=100.0, default=100.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    def limited_to(self, robot: RoundRobot) -> 'DriveSettings':
        """Limit speeds and accelerations to those of a robot."""
        return _limited(self, robot)

    def with_clearances(self, fraction: float) -> 'DriveSettings':
        """
        Reduce the clearances from object and obstacles.

        :param fraction: what remains of them.
        """
        return dataclasses.replace(self, clearance=fraction * self.clearance,
                                   map_clearance=fraction * self.map_clearance)

    def for_uncertain_robot(self, deviation: float) -> 'DriveSettings':
        """
        Widen the clearance, as the robot may be elsewhere than it is estimated to be.

        :param deviation: standard deviation of the robot's position [m].
        """
        added = min(MAX_ADDED_CLEARANCE, CLEARANCE_SIGMAS * deviation)
        return dataclasses.replace(self, clearance=min(1.0, self.clearance + added))


@dataclasses.dataclass(frozen=True)
class MapSettings:
    """Definition of obstacles in a map; names as in Nav2, where it has the same."""

    allow_unknown: bool = quantity('unknown cells are free, else obstacles', default=False)
    lethal_cost_threshold: float = quantity('occupancy or cost from which a cell is an obstacle',
                                            '', 1.0, 100.0, default=50.0)
    footprint_clearing_enabled: bool = quantity('clear obstacles where object or robot have been',
                                                default=False)
    footprint_clearing_margin: float = quantity('margin of the footprint for clearing', 'm', 0.0,
                                                0.5, default=0.08)
    footprint_clearing_time: float = quantity('largest age of measurements in a map', 's', 0.0,
                                              60.0, default=1.0)
    max_cells: int = quantity('cells of the largest map; a larger one is refused unread', '', 1,
                              1_000_000_000, is_dynamic=False, default=16_000_000)

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
