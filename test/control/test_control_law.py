"""Laws of the control law: signs, limits, and the way from curvature to command."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_control.laws.closed_form import feedback_curvature
from push_control.laws.command import (
    contact_speed, differential_command, holonomic_command, limit_command, mean_twist,
)
from push_control.laws.curvature_limits import (
    CurvatureLimits, friction_cone_limits, jackknife_limits,
)
from push_control.laws.limit_surface_table import LimitSurfaceTable
from push_control.settings import ControlSettings
from push_model.dynamics import contact_force, ObjectTerms
from push_model.parameters import RoundRobot
from push_model.quasi_static import quasi_static_yaw_rate, vehicle
from push_model.robot_kinematics import contact_velocity
from push_model.signals import Twist
import pytest
from scipy.integrate import solve_ivp

SETTINGS = ControlSettings()
CORNER = (-0.2, -0.2)
FACE = (-0.2, 0.0)


def test_left_of_the_path_steers_right_and_so_does_a_heading_to_the_left():
    """Each error alone asks for curvature against it; none asks for the path's own."""
    assert feedback_curvature(0.02, 0.0, 0.0, SETTINGS) < 0.0 < feedback_curvature(-0.02, 0.0, 0.0,
                                                                                   SETTINGS)
    assert feedback_curvature(0.0, 0.05, 0.0, SETTINGS) < 0.0 < feedback_curvature(0.0, -0.05, 0.0,
                                                                                   SETTINGS)
    assert feedback_curvature(0.0, 0.0, 0.4, SETTINGS) == 0.4


def test_far_from_the_path_the_law_does_not_pull_harder():
    """The lateral error saturates, the heading error does not."""
    at_bound = feedback_curvature(SETTINGS.lateral_saturation, 0.0, 0.0, SETTINGS)
    assert feedback_curvature(5.0, 0.0, 0.0, SETTINGS) == at_bound
    assert feedback_curvature(5.0, 0.3, 0.0, SETTINGS) < at_bound


@pytest.mark.parametrize('start', [(0.05, 0.0), (-0.1, 0.2), (0.08, -0.1)])
def test_a_flat_point_that_obeys_comes_to_its_path(start):
    """Unlimited, the errors of ``y' = sin psi, psi' = kappa`` vanish within two metres."""
    def rate(_, x):
        return math.sin(x[1]), feedback_curvature(x[0], x[1], 0.0, SETTINGS) / math.cos(x[1])

    end = solve_ivp(rate, (0.0, 2.0), start, rtol=1e-8).y[:, -1]
    assert np.abs(end).max() < 2e-3


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
    limits = friction_cone_limits(supports, flat, flat.angle + tilt, cone)
    assert limits.low < limits.high
    for curvature, side in ((limits.low, 1.0), (limits.high, -1.0)):
        alpha = supports.push_angle(flat, curvature)
        v = 1e-3 * math.cos(flat.angle + alpha), 1e-3 * math.sin(flat.angle + alpha)
        omega = quasi_static_yaw_rate(obj, FACE, *v)
        state = (0, 0, 0, omega, flat.angle + tilt, *FACE)
        force_n, force_t = contact_force(ObjectTerms.of(obj), state, (*v, 0, 0, omega), 0.0,
                                         (0.0, 0.0), 1e-9)
        assert math.atan2(float(force_t), float(force_n)) == pytest.approx(side * cone, abs=5e-3)


def test_limits_clip_and_narrow():
    """Clipping keeps what is inside; narrowing is the intersection."""
    limits = CurvatureLimits(-0.5, 0.8)
    assert [limits.clip(value) for value in (-2.0, 0.1, 2.0)] == [-0.5, 0.1, 0.8]
    assert limits.within(CurvatureLimits(-1.0, 0.3)) == (-0.5, 0.3)


@pytest.mark.parametrize('obj, point', [(box(foot=0.18), CORNER), (box(foot=0.18), FACE),
                                        (bin_(), (-0.2, 0.0))])
@pytest.mark.parametrize('alpha', [-0.73, -0.2, 0.04, 0.55])
def test_the_table_turns_as_the_supports_do(obj, point, alpha):
    """Interpolated c^2 gives the turning rate of the supports to a percent."""
    flat, table = vehicle(obj, point), LimitSurfaceTable(obj, point)
    omega = quasi_static_yaw_rate(obj, point, math.cos(flat.angle + alpha), math.sin(flat.angle + alpha))
    turned = -flat.arm * math.sin(alpha) / (table.c_squared(alpha) + flat.arm ** 2)
    assert turned == pytest.approx(omega, rel=0.01)
    curvature = omega / math.cos(alpha)
    assert table.push_angle(flat, curvature) == pytest.approx(alpha, abs=0.01)


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('speed, angle, heading_offset, phi', [(0.2, 0.3, 0.1, 1.0), (0.1, -0.6, -0.4, -2.0),
                                                               (0.05, 0.0, 0.0, 0.0)])
def test_the_command_gives_the_wanted_contact_velocity(drive, speed, angle, heading_offset, phi):
    """Through the kinematic rule, ``v_C = v_P + omega_p R_p t``."""
    if drive == 'differential':
        command = differential_command(speed, angle, heading_offset, 0.17)
        assert command.v_y == 0.0
    else:
        command = holonomic_command(speed, angle, heading_offset, 0.17, 0.37)
        assert command.omega == 0.37
    gamma = phi + heading_offset
    v_x, v_y = contact_velocity(phi, gamma, 0.17, command)
    assert math.hypot(v_x, v_y) == pytest.approx(speed)
    assert math.atan2(v_y, v_x) == pytest.approx(math.remainder(gamma + angle, 2 * math.pi))


def test_limiting_keeps_the_direction_of_motion():
    """Yaw rate and speed shrink together, so that the contact goes where it was sent."""
    robot = RoundRobot(radius=0.17, max_speed=0.2, max_yaw_rate=0.5)
    command = Twist(0.3, 0.0, 1.6)
    slow = limit_command(command, robot)
    assert slow.v_x <= 0.2 and abs(slow.omega) <= 0.5
    assert slow.omega / slow.v_x == pytest.approx(command.omega / command.v_x)
    assert limit_command(Twist(0.1, 0.0, -0.2), robot) == (0.1, 0.0, -0.2)


def test_mean_motion_is_that_of_a_first_order_lag():
    """Against numerical integration; a drive without lag moves as commanded at once."""
    start, command, lag = Twist(0.05, 0.0, 0.4), Twist(0.2, 0.0, -0.1), 0.13
    path = solve_ivp(lambda _, v: (np.array(command) - v) / lag, (0.0, lag), start, rtol=1e-10,
                     atol=1e-12, dense_output=True).sol
    mean = np.mean([path(t) for t in np.linspace(0.0, lag, 2001)], axis=0)
    assert mean_twist(start, command, lag) == pytest.approx(mean, abs=1e-4)
    assert mean_twist(start, command, 0.0) == command


def test_speed_rises_from_the_start_and_falls_to_the_goal():
    """Never above the plan's speed, slowest at both ends, and monotone in between."""
    rising = [contact_speed(t, 10.0, 0.2, SETTINGS) for t in np.linspace(0.0, 3.0, 50)]
    falling = [contact_speed(60.0, s, 0.2, SETTINGS) for s in np.linspace(3.0, -0.01, 50)]
    assert rising[0] == falling[-1] == SETTINGS.start_speed
    assert max(rising) == max(falling) == 0.2
    assert (np.diff(rising) >= 0.0).all() and (np.diff(falling) <= 0.0).all()


@pytest.mark.parametrize('field, value', [('lateral_gain', -1.0), ('pose_timeout', 0.0),
                                          ('control_law', 'magic'), ('replan_cone_fraction', 1.5),
                                          ('max_reapproaches', 1.5), ('pose_gate', float('nan'))])
def test_settings_out_of_range_are_refused_by_name(field, value):
    """The error names the field."""
    with pytest.raises(ValueError, match=f'ControlSettings.{field}'):
        ControlSettings(**{field: value})
