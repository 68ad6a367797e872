"""How the robot drives while it does not push."""

import dataclasses
import functools

from push_model.quantity import check, quantity


@dataclasses.dataclass(frozen=True)
class DriveSettings:
    """Speeds and distances of a robot on its way; the robot's own limits hold besides."""

    speed: float = quantity('speed on the way', 'm/s', above=0.0, high=10.0, default=0.4)
    yaw_rate: float = quantity('yaw rate on the way', 'rad/s', above=0.0, high=50.0, default=1.8)
    acceleration: float = quantity('acceleration on the way', 'm/s^2', above=0.0, high=100.0,
                                   default=0.6)
    yaw_acceleration: float = quantity('yaw acceleration on the way', 'rad/s^2', above=0.0,
                                       high=1000.0, default=4.0)
    clearance: float = quantity('distance that the robot keeps from the object', 'm', above=0.0,
                                high=1.0, default=0.05)
    map_clearance: float = quantity('distance that robot and object keep from obstacles', 'm',
                                    0.0, 1.0, default=0.05)
    standoff: float = quantity('gap at which the last straight piece to the contact begins', 'm',
                               0.0, 1.0, default=0.06)
    retreat_distance: float = quantity('straight way off the object after a push', 'm', above=0.0,
                                       high=1.0, default=0.15)
    max_reverse_distance: float = quantity('longest way round the object that a differential drive goes '
                                           'backwards', 'm', 0.0, 100.0, default=0.5)

    def __post_init__(self):
        """Validate the fields."""
        check(self)

    def limited_to(self, robot):
        """
        Bring speeds and accelerations within the limits of a robot.

        :param robot: the ``RoundRobot``.
        :return: ``DriveSettings``.
        """
        return _capped(self, robot)


@functools.lru_cache(maxsize=64)
def _capped(settings, robot):
    return dataclasses.replace(
        settings, speed=min(settings.speed, robot.max_speed),
        yaw_rate=min(settings.yaw_rate, robot.max_yaw_rate),
        acceleration=min(settings.acceleration, robot.max_acceleration),
        yaw_acceleration=min(settings.yaw_acceleration, robot.max_yaw_acceleration))
