"""
Limits of the curvature of z that the contact survives in a steady turn.

With r the distance from the contact C to the centre of friction F, L the wheelbase, R_p the radius
of the robot, zeta the angle from C->F to the contact normal and D the angle from the robot's
heading to it, the normal of a differential drive comes to rest at ``zeta = D - (L + R_p) kappa``,
and the contact force lies ``zeta + kappa c^2 / r`` off the normal, where ``c^2 / r = L - r``.
"""

from typing import Any

from push_control.steered.estimation.limit_surface_table import curvatures_of_forces
from push_control.steered.path.path import CurvatureLimits
from push_dynamics.compiled import compiled, wrap_angles
from push_model.quasi_static import Vehicle

# Angle that the normal of a steady turn keeps from the edges of the vertex [rad]. Chosen: the
# estimate of the normal is off by about as much.
STEADY_VERTEX_MARGIN = 0.02


@compiled
def jackknife_limits(vehicle: Vehicle, robot_radius: float, heading_offset: float,
                     cone_angle: float) -> CurvatureLimits:
    """
    Limits where the normal turns with the robot: a differential drive at a vertex.

    ``(D - cone) / (r + R_p) <= kappa <= (D + cone) / (r + R_p)``; beyond, the contact jackknifes
    like a reversing trailer, and no law recovers.

    :param vehicle: the object as ``Vehicle``.
    :param robot_radius: R_p [m].
    :param heading_offset: D, angle from the robot's heading to the normal [rad].
    :param cone_angle: half angle of the friction cone that may be used [rad].
    """
    length = vehicle.arm + robot_radius
    return CurvatureLimits((heading_offset - cone_angle) / length,
                           (heading_offset + cone_angle) / length)


@compiled
def vertex_limits(vehicle: Vehicle, robot_radius: float, heading_offset: float,
                  zeta_limits: tuple[float, float]) -> CurvatureLimits:
    """
    Limits where a turn of a differential drive would roll the contact off its vertex.

    :param vehicle: the object as ``Vehicle``.
    :param robot_radius: R_p [m].
    :param heading_offset: D, angle from the robot's heading to the normal [rad].
    :param zeta_limits: (lowest, highest) zeta at the vertex [rad].
    """
    length = vehicle.wheelbase + robot_radius
    return CurvatureLimits((heading_offset - zeta_limits[1] + STEADY_VERTEX_MARGIN) / length,
                           (heading_offset - zeta_limits[0] - STEADY_VERTEX_MARGIN) / length)


@compiled
def friction_cone_limits(c_squared: Any, forces: Any, vehicle: Vehicle, normal: float,
                         cone_angle: float) -> CurvatureLimits:
    """
    Limits where the normal is held in the object: a holonomic base that turns along.

    The force stays in the cone; on the ellipsoid, ``|zeta + kappa c^2 / r| <= cone``.

    :param c_squared: ``LimitSurfaceTable.values`` [m^2].
    :param forces: ``LimitSurfaceTable.forces`` [rad].
    :param vehicle: the object as ``Vehicle``.
    :param normal: angle of the contact normal in the object frame [rad].
    :param cone_angle: half angle of the friction cone that may be used [rad].
    """
    zeta = wrap_angles(normal - vehicle.angle)
    low, high = curvatures_of_forces(c_squared, forces, vehicle.arm, vehicle.c_squared,
                                     zeta - cone_angle, zeta + cone_angle)
    return CurvatureLimits(low, high)
