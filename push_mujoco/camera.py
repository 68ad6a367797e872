"""Camera of a simulated robot, or in its room: a pinhole without distortion."""

import dataclasses
import math
from typing import get_args, Literal, NamedTuple, TypeAlias

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.quantity import check, quantity

# Where the camera is fixed: on the robot, or in the room.
CameraPlace: TypeAlias = Literal['robot', 'room']


class LensPose(NamedTuple):
    """
    Where a lens is and looks, in the world.

    :param position: (x, y, z) [m].
    :param rotation: from the optical axes to the world, shape (3, 3); the optical axes are x to
        the right of the image, y down, z ahead (REP-103).
    """

    position: FloatArray
    rotation: FloatArray


@dataclasses.dataclass(frozen=True)
class SimulatedCamera:
    """
    A camera: its images, where it is, and what is wrong with its pixels.

    The centre of the first pixel is the point (0, 0) of the image, so that the optical axis meets
    it at ((width - 1) / 2, (height - 1) / 2).
    """

    place: CameraPlace = quantity('what it is fixed to', choices=get_args(CameraPlace),
                                  default='robot')
    x: float = quantity('position of the lens, robot frame if on it, else world', 'm', -100.0,
                        100.0, default=-0.06)
    y: float = quantity('the same, y', 'm', -100.0, 100.0, default=0.0)
    z: float = quantity('height of the lens above the floor', 'm', 0.0, 100.0, default=0.244)
    heading: float = quantity('direction of the optical axis in the same frame', 'rad', -math.pi,
                              math.pi, default=0.0)
    pitch: float = quantity('angle of the optical axis below the horizon', 'rad', -math.pi / 2,
                            math.pi / 2, default=0.0)
    width: int = quantity('columns of an image', 'px', 16, 4096, default=640)
    height: int = quantity('rows of an image', 'px', 16, 4096, default=480)
    view_angle: float = quantity('horizontal angle of view', 'rad', 0.1, 2.5, default=1.25)
    noise: float = quantity('std of grey levels, of 255', '', 0.0, 100.0, default=2.0)
    rate: float = quantity('images per second', 'Hz', above=0.0, high=100.0, default=10.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def focal_length(self) -> float:
        """Focal length [px]."""
        return 0.5 * self.width / math.tan(0.5 * self.view_angle)

    @property
    def vertical_angle(self) -> float:
        """Vertical angle of view [rad]."""
        return 2.0 * math.atan2(0.5 * self.height, self.focal_length)

    @property
    def matrix(self) -> FloatArray:
        """Matrix K from optical axes to pixels, shape (3, 3)."""
        focal = self.focal_length
        return np.array([(focal, 0.0, 0.5 * (self.width - 1)),
                         (0.0, focal, 0.5 * (self.height - 1)), (0.0, 0.0, 1.0)])

    def lens(self, robot_pose: Pose) -> LensPose:
        """
        Compute where the lens is.

        :param robot_pose: ``Pose`` of the robot in the world.
        """
        base = robot_pose if self.place == 'robot' else Pose(0.0, 0.0, 0.0)
        x, y, heading = base @ Pose(self.x, self.y, self.heading)
        c, s = math.cos(heading), math.sin(heading)
        level, down = math.cos(self.pitch), math.sin(self.pitch)
        ahead = np.array([level * c, level * s, -down])
        right = np.array([s, -c, 0.0])
        return LensPose(np.array([x, y, self.z]),
                        np.column_stack((right, np.cross(ahead, right), ahead)))

    def project(self, points: FloatArray, robot_pose: Pose) -> FloatArray:
        """
        Compute where points are in the image.

        :param points: in the world, shape (n, 3) [m].
        :param robot_pose: ``Pose`` of the robot in the world.
        :return: (column, row), shape (n, 2) [px]; of points behind the lens nan.
        """
        lens = self.lens(robot_pose)
        optical = (points - lens.position) @ lens.rotation
        depth = np.where(optical[:, 2:] > 0.0, optical[:, 2:], math.nan)
        return (optical / depth @ self.matrix.T)[:, :2]
