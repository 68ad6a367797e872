"""Pushes integrated in time, against the plant; steady turns by the laws that they keep."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot
import numpy as np
from push_model.analysis import time_integration as motion
from push_model.analysis.steady_turn import steady_force, steady_yaw_rate
from push_model.analysis.time_integration import body_fixed_push, integrate, straight_push
from push_model.contact import contact_point, curvature_radius, rolling_constants
from push_model.dynamics import Input, State
from push_model.geometry import Pose
from push_model.parameters import Contact, GRAVITY
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest

pytestmark = pytest.mark.physics
FIXED = (1.0, 0.0)
MID_FACE = (-0.2, 0.0)
ANGLE = -math.radians(20)  # turns the object left
SKEW = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03),
        'contact_friction_coefficient': 3.0}


def scaled(obj, factor):
    """Return the object with all lengths multiplied and the same mass."""
    supports = tuple(dataclasses.replace(s, x=factor * s.x, y=factor * s.y) for s in obj.supports)
    return dataclasses.replace(
        obj, supports=supports, outline=tuple((factor * x, factor * y) for x, y in obj.outline),
        center_of_mass=tuple(factor * part for part in obj.center_of_mass),
        inertia=factor ** 2 * obj.inertia)


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


def test_turning_push_moves_as_in_the_plant():
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


def test_motion_stops_where_it_is_told_to():
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
        monkeypatch.setattr(motion, 'TOLERANCE', tolerance)
        return integrate(obj, rolling, straight_push(1.0, 0.0), begin, [0.0, 2.0])[1][-1]

    exact = end(1e-12)
    errors = [np.abs(end(tolerance) - exact).max() for tolerance in (1e-4, 1e-6, 1e-8)]
    assert errors[1] < 0.1 * errors[0] and errors[2] < 0.1 * errors[1]
    assert errors[2] < 1e-6


def test_pushes_are_velocities_with_their_rates():
    """The acceleration is the derivative of the velocity as the object turns."""
    push = body_fixed_push(0.4, 0.7)
    state, h = State(0.0, 0.0, 1.1, 0.9, 1.1, *MID_FACE), 1e-6
    now, before, after = (push(0.0, state._replace(theta=1.1 + 0.9 * step))
                          for step in (0.0, -h, h))
    assert (now.a_x, now.a_y) == pytest.approx(((after.v_x - before.v_x) / (2 * h),
                                                (after.v_y - before.v_y) / (2 * h)), rel=1e-6)
    assert now.omega_p == 0.9 and math.hypot(now.v_x, now.v_y) == pytest.approx(0.7)
    assert straight_push(0.2, -0.1)(3.0, state) == Input(0.2, -0.1, 0.0, 0.0, 0.0)


@pytest.mark.parametrize('speed, ratio', [(0.05, 0.998), (0.25, 0.957), (0.5, 0.848),
                                          (1.0, 0.575), (2.0, 0.247)])
def test_steady_over_quasi_static_turning_rate(speed, ratio):
    slow = quasi_static_yaw_rate(box(), MID_FACE, speed * math.cos(ANGLE), speed * math.sin(ANGLE))
    steady = steady_yaw_rate(box(), MID_FACE, ANGLE, speed)
    assert steady / slow == pytest.approx(ratio, abs=6e-4)


@pytest.mark.parametrize('speed', [0.2, 1.0])
@pytest.mark.parametrize('obj, point, direction', [
    (box(), MID_FACE, ANGLE), (box(**SKEW), (-0.2, 0.05), -0.1), (bin_(), (-0.2, 0.0), -0.3)])
def test_steady_turn_is_what_the_motion_tends_to(obj, point, direction, speed):
    begin = State(0.0, 0.0, 0.0, 0.0, 0.0, *point)
    _, states = integrate(obj, FIXED, body_fixed_push(direction, speed), begin,
                          [0.0, 8.0 / speed, 9.0 / speed])
    steady = steady_yaw_rate(obj, point, direction, speed)
    assert abs(steady) > 0.01
    assert states[1:, 3] == pytest.approx([steady] * 2, rel=1e-5)


def test_steady_turn_knows_neither_mass_nor_inertia():
    known = steady_yaw_rate(box(), MID_FACE, ANGLE, 1.0)
    for changes in ({'mass': 0.5}, {'mass': 30.0}, {'inertia': 0.01}, {'inertia': 3.0}):
        assert steady_yaw_rate(box(**changes), MID_FACE, ANGLE, 1.0) == pytest.approx(
            known, rel=1e-9)
    assert steady_yaw_rate(box(friction=(0.6,) * 4), MID_FACE, ANGLE, 1.0) > 1.2 * known


@pytest.mark.parametrize('length, friction', [(2.0, 1.0), (1.0, 2.0), (0.5, 0.3)])
def test_steady_turn_depends_on_speed_squared_over_friction_and_length(length, friction):
    """At equal v^2 / (mu g L) the turn per way, in lengths of the object, is the same."""
    plain, other = box(), scaled(box(friction=(0.3 * friction,) * 4), length)
    faster = 0.8 * math.sqrt(length * friction)
    per_way = steady_yaw_rate(plain, MID_FACE, ANGLE, 0.8) / 0.8
    point = tuple(length * part for part in MID_FACE)
    assert length * steady_yaw_rate(other, point, ANGLE, faster) / faster == pytest.approx(
        per_way, rel=1e-6)
    assert length * steady_yaw_rate(other, point, ANGLE, 1.5 * faster) / (1.5 * faster) < \
        0.95 * per_way


def test_slow_steady_turn_is_the_quasi_static_one():
    """The difference falls with the square of the speed; inertia only damps the turn."""
    lacks = []
    for speed in (0.2, 0.1, 0.05):
        slow = quasi_static_yaw_rate(box(), MID_FACE, speed * math.cos(ANGLE), speed * math.sin(ANGLE))
        lacks.append(1.0 - steady_yaw_rate(box(), MID_FACE, ANGLE, speed) / slow)
    assert 0.0 < lacks[2] < 3e-3
    assert np.divide(lacks[:2], lacks[1:]) == pytest.approx([4.0, 4.0], rel=0.05)


def test_steady_turn_is_mirrored_with_the_push():
    left, right = (steady_yaw_rate(box(), MID_FACE, side * ANGLE, 0.7) for side in (1, -1))
    assert left > 0.0 and right == pytest.approx(-left)
    assert steady_yaw_rate(box(), MID_FACE, 0.0, 0.7) == pytest.approx(0.0, abs=1e-9)


def test_steady_force_is_friction_and_the_pull_to_the_middle_of_the_turn():
    """Power of the push is what friction takes; without a turn the force is mu m g."""
    obj, speed, omega = box(), 1.0, steady_yaw_rate(box(), MID_FACE, ANGLE, 1.0)
    f_n, f_t = steady_force(obj, MID_FACE, ANGLE, speed, 0.0)
    v_x, v_y = speed * math.cos(ANGLE), speed * math.sin(ANGLE)
    loss = sum(q * math.hypot(v_x - omega * (s.y - MID_FACE[1]), v_y + omega * (s.x - MID_FACE[0]))
               for s, q in zip(obj.supports, obj.capacities))
    assert f_n * v_x + f_t * v_y == pytest.approx(loss, rel=1e-6)
    assert steady_force(obj, MID_FACE, 0.0, speed, 0.0) == pytest.approx(
        (0.3 * obj.mass * GRAVITY, 0.0), abs=1e-6)


@pytest.mark.parametrize('direction', [1.6, math.pi, -2.0])
def test_a_push_away_from_the_mass_centre_is_refused(direction):
    with pytest.raises(ValueError, match='direction: got .*away from the mass centre'):
        steady_yaw_rate(box(), MID_FACE, direction, 0.5)
