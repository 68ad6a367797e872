"""The quasi-static motion of the estimator: the rolling rule, and its own derivatives."""

import math

from helpers.contact_sites import FACE, ROUND, VERTEX
from helpers.objects import bin_, box
import numpy as np
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.estimation.push_motion import MotionState, PushMotion
from push_model.dynamics import Input, kinematics, State
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.signals import Twist
import pytest

NOMINAL = box(foot=0.18)


@pytest.mark.parametrize('site, obj', [(VERTEX, box(foot=0.18)), (FACE, box(foot=0.18)),
                                       (ROUND, bin_())])
def test_motion_follows_the_rolling_rule(site, obj):
    """Object velocity as by the model's kinematics, turning as by the supports."""
    motion = PushMotion(0.17, site, LimitSurfaceTable(obj, site.point))
    state = MotionState(0.1, 0.2, 0.7, 0.7 + site.heading + 0.05, *friction_center(obj))
    twist = Twist(0.12, 0.01, 0.05)
    rates = motion.rates(state, twist)
    c_x, c_y, normal = site.contact_at(state.phi - state.theta)
    gamma = state.theta + normal
    spin = 0.17 * twist.omega
    v_x, v_y = Pose(0.0, 0.0, state.phi).rotate(twist[:2])
    v_x, v_y = v_x - spin * math.sin(gamma), v_y + spin * math.cos(gamma)
    velocity = Pose(0.0, 0.0, -state.theta).rotate((v_x, v_y))
    omega = quasi_static_yaw_rate(obj, (c_x, c_y), *velocity)
    assert rates.omega == pytest.approx(omega, rel=0.01)
    moving = State(*state.pose, rates.omega, gamma, c_x, c_y)
    lam = site.normal_ratio
    rate = kinematics(moving, Input(v_x, v_y, 0.0, 0.0, twist.omega), 0.0, (lam, 0.17 * lam))
    assert (rates.x, rates.y) == pytest.approx((float(rate.x), float(rate.y)))
    small = 1e-6
    after = site.contact_at(state.phi - state.theta + small * (twist.omega - rates.omega))
    moved = [(b - a) / small for a, b in zip((c_x, c_y), after[:2])]
    assert moved == pytest.approx((float(rate.c_x), float(rate.c_y)), abs=1e-6)
    assert (after[2] - normal) / small == pytest.approx(
        (1 - lam) * (twist.omega - rates.omega), abs=1e-6)


def test_the_jacobian_is_that_of_the_motion():
    """Against central differences of one short step, at a vertex."""
    motion = PushMotion(0.17, VERTEX, LimitSurfaceTable(NOMINAL, VERTEX.point))
    start = np.array((0.1, 0.2, 0.7, 0.72 + math.pi / 4, 0.01, -0.02, 0.3))
    twist, duration, h = Twist(0.15, 0.0, 0.1), 1e-4, 1e-5
    state = MotionState(*start)
    found, distance = motion.linearize(state, motion.rates(state, twist), duration)

    def after(state):
        return np.array(motion.propagate(MotionState(*state), twist, duration))

    columns = [(after(start + h * e) - after(start - h * e)) / (2 * h) for e in np.eye(7)]
    rates = (np.array(columns).T - np.eye(7)) / duration
    assert (found - np.eye(7)) / duration == pytest.approx(rates, abs=0.02)
    assert distance == pytest.approx(duration * math.hypot(0.15, 0.17 * 0.1), rel=0.2)


def test_an_object_does_not_follow_a_robot_that_backs_off():
    """A push is one-sided."""
    motion = PushMotion(0.17, VERTEX, LimitSurfaceTable(NOMINAL, VERTEX.point))
    state = MotionState(0.0, 0.0, 0.0, math.pi / 4, 0.0, 0.0)
    assert motion.rates(state, Twist(-0.1, 0.0, 0.0))[:3] == (0.0, 0.0, 0.0)
    assert motion.rates(state, Twist(0.1, 0.0, 0.0)).x > 0.0
