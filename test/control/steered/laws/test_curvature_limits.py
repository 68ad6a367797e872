"""Limits of curvature against steady turns of the model."""

import math

from helpers.objects import box
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.laws.command import differential_command
from push_control.steered.laws.curvature_limits import (
    friction_cone_limits, jackknife_limits, vertex_limits,
)
from push_model.dynamics import contact_force, ObjectTerms
from push_model.quasi_static import quasi_static_yaw_rate, vehicle
import pytest
from scipy.integrate import solve_ivp

CORNER = (-0.2, -0.2)
FACE = (-0.2, 0.0)


@pytest.mark.parametrize('heading_offset', [-0.2, 0.0, 0.15])
@pytest.mark.parametrize('curvature', [-0.5, 0.0, 0.4])
def test_trailing_limits_are_where_a_steady_turn_leaves_the_cone(heading_offset, curvature):
    """The normal of a steady turn comes from integrating the drive; the force is the model's."""
    obj = box(foot=0.18)
    robot_radius, flat = 0.17, vehicle(obj, CORNER)
    supports = LimitSurfaceTable(obj, CORNER)
    alpha = supports.push_angle(flat, curvature)

    def rate(_, zeta):
        command = differential_command(1.0, alpha - zeta[0], heading_offset, robot_radius)
        return command.omega - math.cos(alpha) * curvature

    zeta = solve_ivp(rate, (0.0, 5.0), (0.0,), rtol=1e-8).y[0, -1]
    speed, gamma = 1e-3, flat.angle + zeta
    v = speed * math.cos(flat.angle + alpha), speed * math.sin(flat.angle + alpha)
    omega = quasi_static_yaw_rate(obj, CORNER, *v)
    force_n, force_t = contact_force(ObjectTerms.of(obj), (0, 0, 0, omega, gamma, *CORNER),
                                     (*v, 0, 0, omega), 0.0, (0.0, 0.0), 1e-9)
    cone = abs(math.atan2(float(force_t), float(force_n)))
    limits = jackknife_limits(flat, robot_radius, heading_offset, cone)
    assert min(abs(limits.low - curvature), abs(limits.high - curvature)) < 0.03


@pytest.mark.parametrize('tilt', [-0.15, 0.0, 0.1])
def test_held_limits_are_where_the_force_leaves_the_cone(tilt):
    """At either limit the contact force lies on the edge of the cone."""
    obj, cone = box(foot=0.18, friction=(0.3, 0.25, 0.35, 0.3)), 0.2
    flat, supports = vehicle(obj, FACE), LimitSurfaceTable(obj, FACE)
    limits = friction_cone_limits(supports.values, supports.forces, flat, flat.angle + tilt,
                                  cone)
    assert limits.low < limits.high
    for curvature, side in ((limits.low, 1.0), (limits.high, -1.0)):
        alpha = supports.push_angle(flat, curvature)
        v = 1e-3 * math.cos(flat.angle + alpha), 1e-3 * math.sin(flat.angle + alpha)
        omega = quasi_static_yaw_rate(obj, FACE, *v)
        state = (0, 0, 0, omega, flat.angle + tilt, *FACE)
        force_n, force_t = contact_force(ObjectTerms.of(obj), state, (*v, 0, 0, omega), 0.0,
                                         (0.0, 0.0), 1e-9)
        assert math.atan2(float(force_t), float(force_n)) == pytest.approx(side * cone, abs=5e-3)


def test_a_steady_turn_at_the_limit_keeps_the_normal_on_the_vertex():
    """The normal of a differential drive rests at D - (L + R_p) kappa."""
    flat, room, heading_offset = vehicle(box(), (-0.2, -0.2)), (-0.5, 0.3), 0.1
    limits = vertex_limits(flat, 0.17, heading_offset, room)
    assert limits.low < 0.0 < limits.high
    for curvature in limits:
        rest = heading_offset - (flat.wheelbase + 0.17) * curvature
        assert room[0] < rest < room[1] and min(rest - room[0], room[1] - rest) < 0.03
