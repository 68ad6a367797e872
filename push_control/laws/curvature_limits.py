"""The law: from where z is beside its path to the wanted contact velocity."""

import math
from typing import NamedTuple

VERTEX_RESERVE = 0.02


class CurvatureLimits(NamedTuple):
    """Curvatures of z that the contact survives in a steady turn [1/m]."""

    low: float
    high: float

    def clip(self, curvature):
        """
        Bring a curvature into the limits.

        :param curvature: wanted [1/m].
        """
        return min(self.high, max(self.low, curvature))

    def within(self, other):
        """
        Narrow the limits to those that hold under another belief as well.

        :param other: ``CurvatureLimits``.
        """
        return CurvatureLimits(max(self.low, other.low), min(self.high, other.high))


def jackknife_limits(flat, robot_radius, heading_offset, cone):
    """
    Limits where the normal turns with the robot: a differential drive at a vertex.

    ``(D - cone) / (r + R_p) <= kappa <= (D + cone) / (r + R_p)``; beyond, the contact jackknifes
    like a reversing trailer, and no law recovers.

    :param flat: the ``Vehicle``.
    :param robot_radius: R_p [m].
    :param heading_offset: D, angle from the robot's heading to the normal [rad].
    :param cone: half angle of the friction cone that may be used [rad].
    :return: ``CurvatureLimits``.
    """
    length = flat.arm + robot_radius
    return CurvatureLimits((heading_offset - cone) / length, (heading_offset + cone) / length)


def vertex_limits(flat, robot_radius, heading_offset, room):
    """
    Limits where a turn of a differential drive would roll the contact off its vertex.

    In a steady turn the normal comes to rest at ``zeta = D - (L + R_p) kappa``.

    :param flat: the ``Vehicle``.
    :param robot_radius: R_p [m].
    :param heading_offset: D, angle from the robot's heading to the normal [rad].
    :param room: lowest and highest zeta at the vertex [rad].
    :return: ``CurvatureLimits``.
    """
    length = flat.wheelbase + robot_radius
    return CurvatureLimits((heading_offset - room[1] + VERTEX_RESERVE) / length,
                           (heading_offset - room[0] - VERTEX_RESERVE) / length)


def friction_cone_limits(supports, flat, normal, cone):
    """
    Limits where the normal is held in the object: a holonomic base that turns along.

    The force stays in the cone; on the ellipsoid, ``|zeta + kappa c^2 / r| <= cone``.

    :param supports: the ``LimitSurfaceTable``.
    :param flat: the ``Vehicle``.
    :param normal: angle of the contact normal in the object frame [rad].
    :param cone: half angle of the friction cone that may be used [rad].
    :return: ``CurvatureLimits``.
    """
    zeta = math.remainder(normal - flat.angle, 2.0 * math.pi)
    return CurvatureLimits(*supports.curvatures(flat, zeta - cone, zeta + cone))
