"""Rigid transforms in space, of which the plane needs a part."""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_model.geometry import FloatArray, Pose

# Cosine of half the angle between two rotations above which they are interpolated linearly;
# chosen: the error is then below 1e-9 rad.
NEARLY_EQUAL = 1.0 - 1e-6


class RigidTransform(NamedTuple):
    """
    Pose of a frame in another one, ``T_AB``: it takes coordinates in B to coordinates in A.

    :param x: of the origin of B in A [m].
    :param y: of the origin of B in A [m].
    :param z: of the origin of B in A [m].
    :param q_x: of the unit quaternion of the rotation.
    :param q_y: of the unit quaternion of the rotation.
    :param q_z: of the unit quaternion of the rotation.
    :param q_w: of the unit quaternion of the rotation.
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    q_x: float = 0.0
    q_y: float = 0.0
    q_z: float = 0.0
    q_w: float = 1.0

    @classmethod
    def from_parts(cls, translation: Sequence[float],
                   quaternion: Sequence[float]) -> 'RigidTransform':
        """
        Make a transform; the quaternion is brought to length 1.

        :param translation: (x, y, z) [m].
        :param quaternion: (x, y, z, w), of any length but 0.
        :raises ValueError: where a number is not finite, or the quaternion is 0.
        """
        length = math.sqrt(sum(part * part for part in quaternion))
        if not all(map(math.isfinite, translation)) or not 0.0 < length < math.inf:
            raise ValueError(f'transform: got {tuple(translation)} and the quaternion '
                             f'{tuple(quaternion)}, expected finite numbers and a length of 1')
        x, y, z = translation
        q_x, q_y, q_z, q_w = (part / length for part in quaternion)
        return cls(x, y, z, q_x, q_y, q_z, q_w)

    @classmethod
    def from_angles(cls, translation: Sequence[float],
                    angles: Sequence[float]) -> 'RigidTransform':
        """
        Make a transform of angles about fixed axes, as those of REP-103.

        :param translation: (x, y, z) [m].
        :param angles: roll, pitch and yaw [rad].
        """
        c_r, c_p, c_y = (math.cos(0.5 * angle) for angle in angles)
        s_r, s_p, s_y = (math.sin(0.5 * angle) for angle in angles)
        x, y, z = translation
        return cls(x, y, z,
                   s_r * c_p * c_y - c_r * s_p * s_y, c_r * s_p * c_y + s_r * c_p * s_y,
                   c_r * c_p * s_y - s_r * s_p * c_y, c_r * c_p * c_y + s_r * s_p * s_y)

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Rotation as a unit quaternion, in the order x, y, z, w."""
        return self[3:]

    @property
    def rotation_matrix(self) -> FloatArray:
        """Rotation as a matrix, shape (3, 3)."""
        x, y, z, w = self.quaternion
        return np.array([(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w),
                          2.0 * (x * z + y * w)),
                         (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z),
                          2.0 * (y * z - x * w)),
                         (2.0 * (x * z - y * w), 2.0 * (y * z + x * w),
                          1.0 - 2.0 * (x * x + y * y))])

    @property
    def tilt(self) -> float:
        """Angle between the z axes of both frames [rad]."""
        return 2.0 * math.asin(min(1.0, math.hypot(self.q_x, self.q_y)))

    @property
    def planar(self) -> Pose:
        """The same seen from above: x, y and yaw."""
        x, y, z, w = self.quaternion
        return Pose(self.x, self.y,
                    math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z))

    def __matmul__(self, other: 'RigidTransform') -> 'RigidTransform':
        """
        Compose two transforms, ``T_AC = T_AB @ T_BC``.

        :param other: transform of C in B.
        :return: transform of C in A.
        """
        a_x, a_y, a_z, a_w = self.quaternion
        b_x, b_y, b_z, b_w = other.quaternion
        x, y, z = self.rotate(other[:3])
        return RigidTransform(
            self.x + x, self.y + y, self.z + z,
            a_w * b_x + a_x * b_w + a_y * b_z - a_z * b_y,
            a_w * b_y - a_x * b_z + a_y * b_w + a_z * b_x,
            a_w * b_z + a_x * b_y - a_y * b_x + a_z * b_w,
            a_w * b_w - a_x * b_x - a_y * b_y - a_z * b_z)

    def inverse(self) -> 'RigidTransform':
        """Return the transform of A in B."""
        inverse = RigidTransform(0.0, 0.0, 0.0, -self.q_x, -self.q_y, -self.q_z, self.q_w)
        x, y, z = inverse.rotate(self[:3])
        return RigidTransform(-x, -y, -z, *inverse.quaternion)

    def rotate(self, vector: Sequence[float]) -> tuple[float, float, float]:
        """
        Rotate a vector from B to A.

        :param vector: (x, y, z) along the axes of B.
        :return: (x, y, z) along the axes of A.
        """
        q_x, q_y, q_z, q_w = self.quaternion
        v_x, v_y, v_z = vector
        # v + 2 q_w (q x v) + 2 q x (q x v), with the vector part q of the quaternion.
        t_x = 2.0 * (q_y * v_z - q_z * v_y)
        t_y = 2.0 * (q_z * v_x - q_x * v_z)
        t_z = 2.0 * (q_x * v_y - q_y * v_x)
        return (v_x + q_w * t_x + q_y * t_z - q_z * t_y,
                v_y + q_w * t_y + q_z * t_x - q_x * t_z,
                v_z + q_w * t_z + q_x * t_y - q_y * t_x)

    def interpolate(self, other: 'RigidTransform', ratio: float) -> 'RigidTransform':
        """
        Interpolate to another transform of the same frames, at constant twist of its rotation.

        :param other: the transform at ratio 1.
        :param ratio: 0 to 1.
        """
        cosine = sum(a * b for a, b in zip(self.quaternion, other.quaternion))
        # A quaternion and its negative are the same rotation; this is the shorter path.
        sign = -1.0 if cosine < 0.0 else 1.0
        weights = 1.0 - ratio, sign * ratio
        if abs(cosine) < NEARLY_EQUAL:
            angle = math.acos(abs(cosine))
            weights = (math.sin((1.0 - ratio) * angle) / math.sin(angle),
                       sign * math.sin(ratio * angle) / math.sin(angle))
        return RigidTransform.from_parts(
            [a + ratio * (b - a) for a, b in zip(self[:3], other[:3])],
            [weights[0] * a + weights[1] * b for a, b in zip(self.quaternion, other.quaternion)])
