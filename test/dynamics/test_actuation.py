"""From command to motion of the robot."""

import math

import numpy as np
from push_dynamics.actuation import (
    chord_velocity, decay, limit_command, track_command, track_commands)
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
import pytest
from scipy.integrate import solve_ivp

ROBOT = RoundRobot(0.17, 'holonomic', max_speed=0.5, max_yaw_rate=2.0)


@pytest.mark.parametrize('drive, twist, word', [
    ('differential', Twist(0.1, 0.01, 0.0), 'v_y'), ('holonomic', Twist(math.nan, 0, 0), 'v_x'),
    ('holonomic', Twist(0, math.inf, 0), 'v_y'), ('holonomic', Twist(0, 0, -math.inf), 'omega')])
def test_impossible_commands_are_refused(drive, twist, word):
    with pytest.raises(ValueError, match=rf'command\.{word}: got .*, expected'):
        limit_command(RoundRobot(0.17, drive), twist)


def test_limits_keep_the_direction():
    fast = limit_command(ROBOT, Twist(3.0, -4.0, 7.0))
    assert fast == pytest.approx((0.3, -0.4, 2.0))
    assert limit_command(ROBOT, Twist(0.0, 0.0, -7.0)).omega == -2.0
    assert limit_command(ROBOT, Twist(0.2, 0.1, -1.0)) == Twist(0.2, 0.1, -1.0)


@pytest.mark.parametrize('distance, time_constant, limit, duration', [
    (0.3, 0.1, 1.0, 0.02), (0.3, 0.1, 1.0, 0.25), (0.3, 0.1, 10.0, 0.25), (0.3, 0.4, 1.0, 0.5)])
def test_lag_with_limited_acceleration(distance, time_constant, limit, duration):
    def rate(_, y):
        return [-min(y[0] / time_constant, limit), y[0]]

    run = solve_ivp(rate, (0.0, duration), [distance, 0.0], rtol=1e-10, atol=1e-12, max_step=1e-3)
    end, mean = decay(distance, time_constant, limit, duration)
    assert end == pytest.approx(run.y[0, -1], abs=1e-8)
    assert mean == pytest.approx(run.y[1, -1] / duration, abs=1e-8)


def test_no_lag_ramps_up_and_arrives():
    assert decay(0.4, 0.0, 2.0, 0.1) == pytest.approx((0.2, 0.3))
    assert decay(0.4, 0.0, 2.0, 0.4) == pytest.approx((0.0, 0.1))
    assert decay(0.0, 0.0, 2.0, 0.4) == (0.0, 0.0)


def driven(twist, command, durations, drive=(0.1, 1.0, 6.0)):
    """Follow a command over pieces; return the end twist and its integral over time."""
    total = np.zeros(3)
    for duration in durations:
        *twist, m_x, m_y, m_omega = track_command(*twist, command, np.array(drive), duration)
        total += duration * np.array([m_x, m_y, m_omega])
    return np.array(twist), total


@pytest.mark.parametrize('is_shared', [False, True])
def test_several_robots_follow_as_each_of_them_alone(is_shared):
    """Whether each has a drive of its own, or all have one."""
    rng = np.random.default_rng(2)
    velocities, commands = rng.uniform(-0.5, 0.5, (2, 6, 3))
    drives = rng.uniform((0.02, 0.3, 2.0), (0.2, 1.0, 6.0), (1 if is_shared else 6, 3))
    expected = [track_command(*velocity, command, drives[0 if is_shared else i], 0.05)[:3]
                for i, (velocity, command) in enumerate(zip(velocities, commands))]
    track_commands(velocities, commands, drives, 0.05)
    np.testing.assert_allclose(velocities, expected, rtol=0.0, atol=1e-15)


def test_pieces_of_time_add_up():
    start, command = (0.1, -0.2, 1.0), np.array([0.4, 0.3, -1.5])
    one, distance = driven(start, command, [0.5])
    many, distances = driven(start, command, [0.01, 0.2, 0.09, 0.15, 0.05])
    assert many == pytest.approx(one, abs=1e-12)
    assert distances == pytest.approx(distance, abs=1e-12)


def test_step_response():
    command = np.array([0.05, 0.0, 0.0])
    twist, _ = driven((0.0, 0.0, 0.0), command, [0.1])
    assert twist[0] == pytest.approx(0.05 * (1.0 - math.exp(-1.0)))
    twist, _ = driven((0.0, 0.0, 0.0), np.array([0.5, 0.0, 0.0]), [0.2])
    assert twist[0] == pytest.approx(0.2)
    twist, _ = driven((0.3, -0.1, 1.0), np.array(STOP), [3.0])
    assert twist == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_acceleration_is_limited_as_a_vector():
    start, command = np.array([0.3, -0.2]), np.array([-0.3, 0.25])
    twist, _ = driven((*start, 0.0), np.array([*command, 0.0]), [0.1])
    change = twist[:2] - start
    assert np.hypot(*change) == pytest.approx(0.1)
    assert change / 0.1 == pytest.approx((command - start) / np.hypot(*(command - start)))


@pytest.mark.parametrize('omega', [0.0, 1e-9, 0.7, -3.0])
def test_chord_is_that_of_the_arc(omega):
    phi, v_x, v_y, duration = 0.4, 0.3, -0.1, 0.8
    run = solve_ivp(lambda t, _: Pose(0, 0, phi + omega * t).rotate((v_x, v_y)), (0.0, duration),
                    [0.0, 0.0], rtol=1e-10, atol=1e-12)
    chord = np.array(chord_velocity(phi, v_x, v_y, omega, duration))
    assert chord * duration == pytest.approx(run.y[:, -1], abs=1e-9)
