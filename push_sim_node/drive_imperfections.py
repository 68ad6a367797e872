"""What a real base does otherwise than the ideal drive, beyond its own parameters."""

import dataclasses
from typing import Any

from push_model.quantity import check, INFINITY, quantity


@dataclasses.dataclass(frozen=True)
class SpeedFactor:
    """While it lasts, all commands are scaled, as by a collision monitor."""

    start: float = quantity('time at which commands begin to be scaled', 's', 0.0)
    end: float = quantity('time from which on they are not any more', 's', 0.0)
    factor: float = quantity('factor by which commands are scaled', '', 0.0, 1.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if self.end <= self.start:
            raise ValueError(f'SpeedFactor.end: got {self.end:g} s, expected a time after the '
                             f'start, {self.start:g} s')


@dataclasses.dataclass(frozen=True)
class DriveImperfections:
    """
    Faults of the base between command and motion; none by default.

    Dead time, least speeds and their step, track and pushing force are parameters of the true
    robot. Speeds are those of wheels of a differential drive, of translation and rotation of a
    holonomic base.
    """

    smoother_acceleration: float = quantity('acceleration to which a smoother on the way limits '
                                            'commands', 'm/s^2', above=0.0, infinite=True,
                                            default=INFINITY)
    smoother_yaw_acceleration: float = quantity('the same of the yaw rate', 'rad/s^2', above=0.0,
                                                infinite=True, default=INFINITY)
    speed_factors: tuple[SpeedFactor, ...] = quantity('intervals in which commands are scaled',
                                                      default=())
    start_ratio: float = quantity('least speed from which on a wheel at rest turns (stiction), '
                                  'over the least speed of one that turns', '', 1.0, 5.0,
                                  default=1.0)
    left_wheel_factor: float = quantity('speed of the left wheel of a differential drive over '
                                        'what is asked of it', '', 0.5, 1.5, default=1.0)
    sag: float = quantity('part of the speed that is lost by the end of the sag time', '', 0.0,
                          0.9, default=0.0)
    sag_time: float = quantity('time in which speeds sag, evenly', 's', above=0.0, default=60.0)
    output_min_speed: float = quantity('speed behind lag and acceleration limit below which '
                                       'wheels, or the translation, rest', 'm/s', 0.0, 1.0,
                                       default=0.0)
    output_min_yaw_rate: float = quantity('the same of the rotation of a holonomic base', 'rad/s',
                                          0.0, 5.0, default=0.0)
    wheel_creep: float = quantity('part of their way that the wheels slip, for each newton that '
                                  'the robot pushes with', '1/N', 0.0, 0.1, default=0.0)
    stall_force: float = quantity('force beyond which the wheels stand still, as odometry tells',
                                  'N', above=0.0, infinite=True, default=INFINITY)
    yaw_stiffness: float = quantity('moment about the robot that turns it by one radian against '
                                    'its wheels', 'N m/rad', above=0.0, infinite=True,
                                    default=INFINITY)
    play: float = quantity('way that a wheel, or an axis of a holonomic base, loses when it '
                           'reverses', 'm', 0.0, 0.1, default=0.0)
    robot_mass: float = quantity('mass of the robot, that slows down where its wheels spin', 'kg',
                                 above=0.0, default=4.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        intervals: tuple[Any, ...] = self.speed_factors
        for item in intervals:
            if not isinstance(item, SpeedFactor):
                raise ValueError(f'DriveImperfections.speed_factors: got {item!r}, expected a '
                                 'SpeedFactor')
