"""Pushes at constant angles, integrated in time: steady turns, symmetries, impulses, rolling."""

import math

from helpers.objects import box
import numpy as np
from push_model.analysis.steady_turn import steady_yaw_rate
from push_model.analysis.time_integration import push_at_angles
from push_model.contact import contact_point
from push_model.dynamics import STATE
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_model.quasi_static import quasi_static_yaw_rate
import pytest

FACE = Contact('face', 3)
OMEGA = STATE.index('omega')


@pytest.mark.parametrize('speed', [0.05, 0.5, 1.0])
def test_a_long_push_ends_in_the_steady_turn(speed):
    run = push_at_angles(box(), FACE, [-0.3], [3.0], speed)
    steady = steady_yaw_rate(box(), contact_point(box(), FACE), -0.3, speed)
    assert run.states[-1, OMEGA] == pytest.approx(steady, rel=1e-4)


def test_a_slow_push_turns_as_friction_alone_has_it():
    run = push_at_angles(box(), FACE, [0.2, -0.3], [0.2, 0.2], 0.005)
    rate = quasi_static_yaw_rate(box(), contact_point(box(), FACE), math.cos(0.3), -math.sin(0.3))
    assert run.states[-1, OMEGA] / 0.005 == pytest.approx(rate, rel=5e-3)


def test_mirrored_angles_give_the_mirrored_push():
    left, right = (push_at_angles(box(), FACE, np.multiply(side, (-0.3, 0.1)), [0.4, 0.3], 0.4,
                                  robot_radius=0.2) for side in (1.0, -1.0))
    np.testing.assert_allclose(left.end, np.multiply(right.end, (1.0, -1.0, -1.0)), atol=1e-7)
    np.testing.assert_allclose(left.impulses, right.impulses * (1.0, 1.0, -1.0), atol=1e-7)


def test_two_pieces_at_one_angle_are_one():
    """No blow between them, and the same end, wherever the push starts."""
    start = Pose(1.0, -2.0, 2.5)
    one = push_at_angles(box(), FACE, [-0.2], [0.7], 0.5)
    two = push_at_angles(box(), FACE, [-0.2, -0.2], [0.3, 0.4], 0.5, start=start)
    np.testing.assert_allclose(start.inverse() @ two.end, one.end, atol=1e-6)
    np.testing.assert_allclose(two.impulses[1], (0.6, 0.0, 0.0), atol=1e-7)


def test_impulses_are_jumps_of_momentum():
    """From rest as well; the velocity of the mass centre is read off its positions."""
    run = push_at_angles(box(), FACE, [-0.3, 0.2], [0.4, 0.4], 0.5)
    switch = int(np.flatnonzero(np.diff(run.times) == 0.0)[0])
    for number, (before, after) in enumerate(((None, 0), (switch, switch + 1))):
        gamma = run.states[after, STATE.index('gamma')]
        jump = _velocity(run, after, 1) - (0.0 if before is None else _velocity(run, before, -1))
        normal = np.array((math.cos(gamma), math.sin(gamma)))
        tangent = np.array((-normal[1], normal[0]))
        np.testing.assert_allclose(run.impulses[number, 1:],
                                   box().mass * np.array((jump @ normal, jump @ tangent)),
                                   atol=0.02)


def _velocity(run, at, step):
    """Velocity of the frame's origin, here the mass centre, from there on or up to there."""
    here, there = run.states[at, :2], run.states[at + step, :2]
    return (there - here) / (run.times[at + step] - run.times[at])


def test_the_contact_rolls_by_the_radius_for_each_radian():
    run = push_at_angles(box(), FACE, [-0.3, 0.1], [0.5, 0.5], 0.3, robot_radius=0.25)
    along = run.states[:, STATE.index('c_y')]
    np.testing.assert_allclose(along, 0.25 * run.states[:, STATE.index('theta')], atol=1e-7)
    assert np.abs(along).max() > 0.01


def test_a_robot_that_does_not_spin_moves_at_the_pushing_speed():
    """Its centre, found behind the contact: all of its points move alike."""
    radius, speed = 0.25, 0.3
    run = push_at_angles(box(), FACE, [-0.3], [0.6], speed, robot_radius=radius)
    points = np.array([Pose(*row[:3]).transform(row[5:]) for row in run.states])
    gamma = run.states[:, STATE.index('gamma')]
    centers = points - radius * np.column_stack([np.cos(gamma), np.sin(gamma)])
    paces = np.hypot(*np.diff(centers, axis=0).T) / np.diff(run.times)
    np.testing.assert_allclose(paces, speed, rtol=1e-4)
