"""
Camera: a pinhole with the distortion of a lens, and how it is mounted.

A point (X, Y, Z) in the optical frame of REP-103 (x to the right, y down, z ahead) is seen at

    a = X / Z,  b = Y / Z,  r^2 = a^2 + b^2
    a' = a (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 a b + p2 (r^2 + 2 a^2)
    b' = b (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 b^2) + 2 p2 a b
    u = f_x a' + c_x,  v = f_y b' + c_y

which is the model ``plumb_bob`` of ``sensor_msgs/CameraInfo`` (Brown 1966). The middle of the
first pixel is (0, 0).
"""

import dataclasses
import math

import numpy as np
from push_model.geometry import FloatArray
from push_model.quantity import check, quantity
from push_model.rigid_transform import RigidTransform

# From the optical frame to that of the body of the camera: x ahead, y to the left, z up.
OPTICAL = RigidTransform.from_angles((0.0, 0.0, 0.0), (-0.5 * math.pi, 0.0, -0.5 * math.pi))
# Longest edge of an image [pixel]; chosen: beyond any camera of a robot.
MAX_EDGE = 10_000
# Steps that invert the distortion; chosen: the error is squared in each, from some per cent on.
NEWTON_STEPS = 4


@dataclasses.dataclass(frozen=True)
class CameraIntrinsics:
    """Size of the image, focal lengths, principal point and distortion of a camera."""

    width: int = quantity('columns of the image', 'pixel', 1, MAX_EDGE)
    height: int = quantity('rows of the image', 'pixel', 1, MAX_EDGE)
    f_x: float = quantity('focal length, horizontal', 'pixel', above=0.0, high=1e5)
    f_y: float = quantity('focal length, vertical', 'pixel', above=0.0, high=1e5)
    c_x: float = quantity('principal point, column', 'pixel', -1e5, 1e5)
    c_y: float = quantity('principal point, row', 'pixel', -1e5, 1e5)
    k_1: float = quantity('radial distortion, second order', '', -100.0, 100.0, default=0.0)
    k_2: float = quantity('radial distortion, fourth order', '', -100.0, 100.0, default=0.0)
    p_1: float = quantity('tangential distortion, vertical', '', -10.0, 10.0, default=0.0)
    p_2: float = quantity('tangential distortion, horizontal', '', -10.0, 10.0, default=0.0)
    k_3: float = quantity('radial distortion, sixth order', '', -100.0, 100.0, default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @classmethod
    def from_view_angle(cls, width: int, height: int, angle: float) -> 'CameraIntrinsics':
        """
        Make an ideal camera that looks through the middle of its image.

        :param angle: horizontal angle of view [rad].
        """
        focal_length = 0.5 * width / math.tan(0.5 * angle)
        return cls(width, height, focal_length, focal_length, 0.5 * (width - 1),
                   0.5 * (height - 1))

    @property
    def matrix(self) -> FloatArray:
        """Camera matrix K, shape (3, 3) [pixel]."""
        return np.array([(self.f_x, 0.0, self.c_x), (0.0, self.f_y, self.c_y), (0.0, 0.0, 1.0)])

    @property
    def distortion(self) -> FloatArray:
        """Coefficients (k1, k2, p1, p2, k3) of ``plumb_bob``, shape (5,)."""
        return np.array((self.k_1, self.k_2, self.p_1, self.p_2, self.k_3))

    def project(self, points: FloatArray) -> FloatArray:
        """
        Compute where points are seen.

        :param points: in the optical frame, in front of it, shape (n, 3) [m].
        :return: columns and rows, shape (n, 2) [pixel].
        """
        a, b = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
        square = a * a + b * b
        radial = 1.0 + square * (self.k_1 + square * (self.k_2 + square * self.k_3))
        column = a * radial + 2.0 * self.p_1 * a * b + self.p_2 * (square + 2.0 * a * a)
        row = b * radial + self.p_1 * (square + 2.0 * b * b) + 2.0 * self.p_2 * a * b
        return np.stack((self.f_x * column + self.c_x, self.f_y * row + self.c_y), axis=1)

    def directions(self, pixels: FloatArray) -> FloatArray:
        """
        Invert ``project`` by Newton's method, which starts without distortion.

        :param pixels: columns and rows, shape (n, 2) [pixel].
        :return: (X / Z, Y / Z), shape (n, 2).
        """
        scale = np.array((self.f_x, self.f_y))
        directions = (pixels - (self.c_x, self.c_y)) / scale
        for _ in range(NEWTON_STEPS if self.distortion.any() else 0):
            points = np.column_stack((directions, np.ones(len(directions))))
            gradient = self.projection_gradient(points)[:, :, :2]
            residual = (self.project(points) - pixels)[:, :, None]
            directions = directions - np.linalg.solve(gradient, residual)[:, :, 0]
        return directions

    def projection_gradient(self, points: FloatArray) -> FloatArray:
        """
        Compute the derivatives of ``project`` with respect to the points.

        :param points: as of ``project``, shape (n, 3) [m].
        :return: shape (n, 2, 3) [pixel/m].
        """
        depth = points[:, 2]
        a, b = points[:, 0] / depth, points[:, 1] / depth
        square = a * a + b * b
        radial = 1.0 + square * (self.k_1 + square * (self.k_2 + square * self.k_3))
        # Half the derivative of the radial factor with respect to a is a times this, and so for b.
        slope = self.k_1 + square * (2.0 * self.k_2 + square * 3.0 * self.k_3)
        mixed = 2.0 * (a * b * slope + self.p_1 * a + self.p_2 * b)
        column_a = radial + 2.0 * a * a * slope + 2.0 * self.p_1 * b + 6.0 * self.p_2 * a
        row_b = radial + 2.0 * b * b * slope + 6.0 * self.p_1 * b + 2.0 * self.p_2 * a
        column = self.f_x / depth * np.stack((column_a, mixed, -a * column_a - b * mixed))
        row = self.f_y / depth * np.stack((mixed, row_b, -a * mixed - b * row_b))
        return np.moveaxis(np.stack((column, row)), 2, 0)


@dataclasses.dataclass(frozen=True)
class CameraMounting:
    """
    Pose of the lens in the frame in which object poses are stated.

    Without rotation the camera looks along x of that frame, upright.
    """

    x: float = quantity('position of the lens, x', 'm', -100.0, 100.0, is_basic=True, default=0.0)
    y: float = quantity('position of the lens, y', 'm', -100.0, 100.0, is_basic=True, default=0.0)
    z: float = quantity('height of the lens above the floor', 'm', -10.0, 100.0, is_basic=True,
                        default=0.0)
    roll: float = quantity('rotation about the x axis, first', 'rad', -7.0, 7.0, default=0.0)
    pitch: float = quantity('rotation about the y axis, second; positive looks down', 'rad', -7.0,
                            7.0, is_basic=True, default=0.0)
    yaw: float = quantity('rotation about the z axis, third; positive looks to the left', 'rad',
                          -7.0, 7.0, is_basic=True, default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def optical_pose(self) -> RigidTransform:
        """``RigidTransform`` of the optical frame in the frame of object poses."""
        body = RigidTransform.from_angles((self.x, self.y, self.z),
                                          (self.roll, self.pitch, self.yaw))
        return body @ OPTICAL
