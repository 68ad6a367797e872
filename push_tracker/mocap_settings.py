"""Settings of the odometry that is made of motion capture."""

import dataclasses

from push_model.geometry import Pose
from push_model.quantity import check, MIN_NOISE, quantity


@dataclasses.dataclass(frozen=True)
class MocapSettings:
    """Mount of the rigid body on the robot, its errors, and how long it is averaged."""

    x: float = quantity('origin of the rigid body in the frame of the robot, x', 'm', -2.0, 2.0,
                        default=0.0)
    y: float = quantity('origin of the rigid body in the frame of the robot, y', 'm', -2.0, 2.0,
                        default=0.0)
    yaw: float = quantity('rotation of the rigid body from the heading of the robot', 'rad', -7.0,
                          7.0, default=0.0)
    position_noise: float = quantity('position std of one pose', 'm', MIN_NOISE, 0.1,
                                     default=0.001)
    heading_noise: float = quantity('yaw std of one pose', 'rad', MIN_NOISE, 0.5, default=0.003)
    window: float = quantity('time over which the velocity is a mean; it comes later by half of '
                             'it', 's', 0.01, 0.5, default=0.1)
    max_speed: float = quantity('faster poses are outliers', 'm/s', above=0.0, high=10.0,
                                default=2.0)
    max_yaw_rate: float = quantity('faster rotations are outliers', 'rad/s', above=0.0, high=20.0,
                                   default=6.0)
    confirmations: int = quantity('outliers in a row that are believed', '', 1, 1000, default=10)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def mounting(self) -> Pose:
        """``Pose`` of the rigid body in the frame of the robot."""
        return Pose(self.x, self.y, self.yaw)
