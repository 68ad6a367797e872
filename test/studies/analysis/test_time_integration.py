"""Pushes integrated in time: against the plant, and by the laws of pushes at constant angles."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot
import numpy as np
from push_model.contact import contact_point, curvature_radius, rolling_constants
from push_model.dynamics import Input, STATE, State
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest
from studies.analysis import time_integration
from studies.analysis.steady_turn import FIXED, steady_yaw_rate
from studies.analysis.time_integration import (
    body_fixed_push, integrate, push_at_angles, straight_push,
)

pytestmark = pytest.mark.physics
MID_FACE = (-0.2, 0.0)
ANGLE = -math.radians(20)  # rotates the object to the left
FACE = Contact('face', 3)
OMEGA = STATE.index('omega')
SKEW = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03),
        'contact_friction_coefficient': 3.0}


@pytest.mark.parametrize('obj, contact, normal, radius', [
    (box(**SKEW), Contact('face', 3, -0.03), 0.0, 0.3),
    (box(**SKEW), Contact('face', 3), 0.0, 0.0),
    (dataclasses.replace(bin_(), contact_friction_coefficient=3.0),
     Contact('round', 0, math.pi - 0.1), -0.1, 0.5),
    (box(**SKEW), Contact('vertex', 0), math.pi / 4, 0.17)],
    ids=['rolling on a face', 'point on a face', 'rolling on a disc', 'corner'])
def test_straight_push_moves_as_in_the_plant(obj, contact, normal, radius):
    """From the plant's state once up to speed, while the contact is on its feature."""
    c_x, c_y = contact_point(obj, contact)
    start = Pose(c_x - radius * math.cos(normal), c_y - radius * math.sin(normal), 0.0)
    command = Twist(*Pose(0.0, 0.0, normal + 0.2).rotate((0.3, 0.0)), 0.0)
    plant = Plant(obj, ramp_robot(radius), Pose(0.0, 0.0, 0.0), start, 5e-4)
    plant.advance(0.16, command)
    truth = plant.truth(0.0)
    local = Pose(*truth.object_pose).inverse().transform(truth.contact_point)
    begin = State(*truth.object_pose, truth.object_twist.omega, truth.normal, *local)
    rolling = rolling_constants(radius, curvature_radius(obj, contact))
    times = np.linspace(0.0, 1.2, 7)
    reached, states = integrate(obj, rolling, straight_push(*command[:2]), begin, times)
    assert reached == pytest.approx(times)
    for state in states[1:]:
        plant.advance(0.2, command)
        assert plant.mode is ContactMode.STICK
        assert plant.object_pose == pytest.approx(tuple(state[:3]), abs=3e-4)
    assert abs(states[-1, 2] - begin.theta) > 0.01


def test_body_fixed_push_moves_as_in_the_plant():
    """A point robot that steers with the object, command by command."""
    obj, speed = box(contact_friction_coefficient=3.0), 0.4
    robot = dataclasses.replace(ramp_robot(0.0), max_acceleration=100.0)
    plant = Plant(obj, robot, Pose(0.0, 0.0, 0.0), Pose(*MID_FACE, 0.0), 2e-4)
    begin = None
    for number in range(1020):
        heading = plant.object_pose.theta + ANGLE
        plant.advance(2e-3, Twist(speed * math.cos(heading), speed * math.sin(heading), 0.0))
        if number == 19:
            begin = State(*plant.object_pose, plant.object_twist.omega, plant.object_pose.theta,
                          *MID_FACE)
    _, states = integrate(obj, FIXED, body_fixed_push(ANGLE, speed), begin, [0.0, 2.0])
    assert abs(begin.omega - states[-1, 3]) > 0.05
    assert plant.object_pose.theta == pytest.approx(states[-1, 2], rel=5e-3)
    assert plant.object_twist.omega == pytest.approx(states[-1, 3], rel=5e-3)


def test_motion_ends_at_the_stop():
    obj, rolling = box(), rolling_constants(0.1, math.inf)
    begin = State(0.0, 0.0, 0.02, 0.0, 0.02, -0.2, 0.002)
    times = np.linspace(0.0, 20.0, 2001)

    def push(stop):
        return integrate(obj, rolling, straight_push(0.3, 0.0), begin, times, stop)

    _, free = push(None)
    reached, states = push(lambda state: 0.3 - state.theta)
    assert len(free) == len(times) and free[-1, 2] > 0.5
    assert 10 < len(reached) == len(states) < len(times)
    assert 0.3 - 0.01 < states[-1, 2] <= 0.3
    assert free[len(reached), 2] > 0.3
    assert states == pytest.approx(free[:len(reached)], abs=1e-6)


def test_a_tighter_tolerance_brings_the_same_motion(monkeypatch):
    """Error against the tightest falls with the tolerance, and is of its order."""
    obj, rolling = box(**SKEW), rolling_constants(0.3, math.inf)
    begin = State(0.0, 0.0, 0.2, 0.5, 0.2, -0.2, 0.06)

    def end(tolerance):
        monkeypatch.setattr(time_integration, 'TOLERANCE', tolerance)
        return integrate(obj, rolling, straight_push(1.0, 0.0), begin, [0.0, 2.0])[1][-1]

    exact = end(1e-12)
    errors = [np.abs(end(tolerance) - exact).max() for tolerance in (1e-4, 1e-6, 1e-8)]
    assert errors[1] < 0.1 * errors[0] and errors[2] < 0.1 * errors[1]
    assert errors[2] < 1e-6


def test_pushes_are_velocities_with_their_rates():
    """The acceleration is the derivative of the velocity as the object rotates."""
    push = body_fixed_push(0.4, 0.7)
    state, h = State(0.0, 0.0, 1.1, 0.9, 1.1, *MID_FACE), 1e-6
    now, before, after = (push(0.0, state._replace(theta=1.1 + 0.9 * step))
                          for step in (0.0, -h, h))
    assert (now.a_x, now.a_y) == pytest.approx(((after.v_x - before.v_x) / (2 * h),
                                                (after.v_y - before.v_y) / (2 * h)), rel=1e-6)
    assert now.omega_p == 0.9 and math.hypot(now.v_x, now.v_y) == pytest.approx(0.7)
    assert straight_push(0.2, -0.1)(3.0, state) == Input(0.2, -0.1, 0.0, 0.0, 0.0)


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


def test_two_segments_at_one_angle_are_one():
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


def test_a_robot_that_does_not_rotate_moves_at_the_pushing_speed():
    """Its centre, found behind the contact: all of its points move alike."""
    radius, speed = 0.25, 0.3
    run = push_at_angles(box(), FACE, [-0.3], [0.6], speed, robot_radius=radius)
    points = np.array([Pose(*row[:3]).transform(row[5:]) for row in run.states])
    gamma = run.states[:, STATE.index('gamma')]
    centers = points - radius * np.column_stack([np.cos(gamma), np.sin(gamma)])
    speeds = np.hypot(*np.diff(centers, axis=0).T) / np.diff(run.times)
    np.testing.assert_allclose(speeds, speed, rtol=1e-4)
