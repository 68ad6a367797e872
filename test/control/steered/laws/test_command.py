"""From contact velocity to command: kinematics, limits, lag and speed."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.laws.command import (
    contact_speed, differential_command, holonomic_command, limit_command, mean_twist)
from push_model.parameters import RoundRobot
from push_model.robot_kinematics import contact_velocity
from push_model.signals import Twist
import pytest
from scipy.integrate import solve_ivp

SETTINGS = ControlSettings()


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('speed, angle, heading_offset, phi', [
    (0.2, 0.3, 0.1, 1.0), (0.1, -0.6, -0.4, -2.0), (0.05, 0.0, 0.0, 0.0)])
def test_the_command_gives_the_contact_velocity(drive, speed, angle, heading_offset, phi):
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
