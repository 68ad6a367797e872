"""Equilibria of straight pushes against known numbers, the full equations and the plant."""

import dataclasses
import math

import casadi as ca
from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot
import numpy as np
from push_model.contact import contact_point, normal_range, rolling_constants
from push_model.equation_of_motion import equation_of_motion
from push_model.geometry import Pose
from push_model.parameters import Contact, Support
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.signals import Twist
from push_sim_node.plant import Plant
import pytest
from scipy.integrate import solve_ivp
from studies.analysis.pushing_location import pushing_location, PushingLocation
from studies.analysis.stability import equilibria, linear_motion, tolerances

pytestmark = pytest.mark.physics
FACE = Contact('face', 3)
ROUND = Contact('round', 0, math.pi)
SKEW = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03)}


def straight(location):
    """Return the equilibrium nearest to the reference."""
    return min(equilibria(location), key=lambda found: abs(found.rotation))


# The sine law of a centred friction centre gives these edges: R_s sin(rho) = d sin(rho / lam).
@pytest.mark.parametrize('robot, ahead, edge', [(0.5, 0.1, 0.5103), (2.0, 0.15, 0.2013),
                                                (2.0, 0.05, 0.2545)])
def test_basin_of_a_round_object_ends_at_the_unstable_equilibria(robot, ahead, edge):
    location = PushingLocation(robot, 0.2, ahead)
    found = equilibria(location)
    assert [one.is_stable for one in found if abs(one.rho) < 1.05 * edge] == [False, True, False]
    for tolerance, side in zip(tolerances(location, straight(location), math.inf), (1.0, -1.0)):
        assert tolerance.limit == 'equilibrium'
        assert tolerance.rho == pytest.approx(side * edge, abs=1e-4)
        assert 0.2 * math.sin(tolerance.rho) == pytest.approx(
            (0.2 - ahead) * math.sin(tolerance.rho * (robot + 0.2) / 0.2), abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize('robot, ahead, edge', [(0.5, 0.1, 0.5103), (2.0, 0.15, 0.2013),
                                                (2.0, 0.05, 0.2545)])
def test_slow_push_returns_from_inside_the_basin_only(robot, ahead, edge):
    """The full equations of motion, from the contact as it is at rho = edge -+ 1 %."""
    obj = shifted_bin(0.2 - ahead)
    share, effective = rolling = rolling_constants(robot, 0.2)
    motion = equation_of_motion(obj, rolling)
    for factor, returns in ((0.99, True), (1.01, False)):
        turn = factor * edge / share
        c = 0.2 * np.exp(1j * (math.pi - effective * turn / 0.2))
        run = solve_ivp(lambda _, x: np.array(motion(x, (0.1, 0, 0, 0, 0))[0]).ravel(),
                        (0.0, 60.0), [0, 0, turn, 0, factor * edge, c.real, c.imag],
                        method='Radau', rtol=1e-7, atol=1e-9)
        assert (run.y[4, -1] < 0.8 * edge) == returns
        assert (run.y[4, -1] > 1.1 * edge) != returns


def shifted_bin(shift):
    """Return a bin of radius 0.2 m whose mass and friction centres are off its middle."""
    feet = [Support(x - shift, y, 0.3) for x, y in ((0.02, 0.0), (-0.02, 0.0), (0.0, 0.02),
                                                    (0.0, -0.02))]
    return dataclasses.replace(bin_(), supports=feet, center_of_mass=(-shift, 0.0))


@pytest.mark.parametrize('ahead, stable', [(0.3, True), (0.49, True), (0.51, False), (0.7, False)])
def test_face_is_stable_with_the_friction_centre_nearer_than_the_radius(ahead, stable):
    assert straight(PushingLocation(0.5, math.inf, ahead)).is_stable == stable


def test_offset_on_a_face_tilts_the_push():
    """About rho = t_f / (R_p - n_f), t_f being the offset of the contact from F."""
    for offset in (1e-4, 1e-3):
        location = PushingLocation(0.5, math.inf, 0.3, -offset)
        assert straight(location).rho == pytest.approx(offset / 0.2, rel=20 * offset)


@pytest.mark.parametrize('robot, surface', [(0.3, 0.0), (0.0, math.inf), (0.0, 0.2),
                                            (math.inf, 0.2), (1.2, 0.2), (0.5, math.inf)])
def test_alpha_is_0_exactly_at_equilibria_and_stable_ones_turn_back(robot, surface):
    location = PushingLocation(robot, surface, 0.15, 0.02, 0.1)
    found = equilibria(location)
    assert found
    for one in found:
        assert location.alpha(one.rotation) == pytest.approx(0.0, abs=1e-12)
        # alpha > 0 turns clockwise: back, where it grows with the turn.
        slope = location.alpha(one.rotation + 1e-6) - location.alpha(one.rotation - 1e-6)
        assert one.is_stable == (slope > 0.0)
        assert slope == pytest.approx(2e-6 * one.margin / one.arm, rel=1e-4)


def test_friction_centre_moves_as_the_contact_rolls():
    """Step by step: the object turns about C, then C moves on by R_e dtheta t."""
    for robot, surface in ((0.5, 0.2), (0.3, math.inf), (math.inf, 0.2), (0.3, 0.0)):
        location = PushingLocation(robot, surface, 0.13, 0.04, -0.2)
        share, effective = rolling_constants(robot, surface)
        f, normal, h = complex(*location.friction_center(0.0)), 0.2, 1e-4
        for _ in range(3000):
            middle = normal + 0.5 * share * h
            f = f * np.exp(1j * h) - effective * h * 1j * np.exp(1j * middle)
            normal += share * h
        assert complex(*location.friction_center(0.3)) == pytest.approx(f, abs=1e-5)
        assert location.rho(0.3) == pytest.approx(-normal)


@pytest.mark.parametrize('turn', [-0.4, -0.1, 0.2, 0.5])
@pytest.mark.parametrize('obj, contact, robot', [
    (box(**SKEW), FACE, 0.3), (box(**SKEW), Contact('vertex', 0), 0.3), (bin_(), ROUND, 0.5),
    (dataclasses.replace(bin_(), center_of_mass=(0.03, 0.02)), ROUND, math.inf)])
def test_sign_of_alpha_is_that_of_the_quasi_static_turn(obj, contact, robot, turn):
    location = pushing_location(obj, contact, robot)
    effective, normal = location.rolling.effective_radius, sum(normal_range(obj, contact)) / 2.0
    c_x, c_y = contact_point(obj, contact)
    if contact.kind == 'face':
        c_y += effective * turn
    elif contact.kind == 'round':
        angle = math.pi - effective * turn / obj.radius
        c_x, c_y = obj.radius * math.cos(angle), obj.radius * math.sin(angle)
    forward = normal - turn
    rate = quasi_static_yaw_rate(obj, (c_x, c_y), math.cos(forward), math.sin(forward))
    assert math.copysign(1.0, rate) == -math.copysign(1.0, location.alpha(turn))


def test_tolerance_is_the_first_of_cone_end_and_equilibrium():
    wide = box(contact_friction_coefficient=0.2)
    location = pushing_location(wide, FACE, 0.5)
    below, above = tolerances(location, straight(location), 0.2)
    assert below.limit == above.limit == 'cone'
    assert above.rho == pytest.approx(-math.atan(0.2))
    assert above.rotation == pytest.approx(-above.rho)
    below, above = tolerances(location, straight(location), 5.0)
    assert below.limit == above.limit == 'end'
    assert above.rotation * 0.5 == pytest.approx(0.2)
    aside = pushing_location(box(), Contact('face', 3, 0.05), 0.5)
    one = straight(aside)
    below, above = tolerances(aside, one, 5.0)
    assert (one.rotation + below.rotation) * 0.5 == pytest.approx(-0.25)
    assert (one.rotation + above.rotation) * 0.5 == pytest.approx(0.15)
    narrow = pushing_location(box(), FACE, 0.19)
    assert {item.rotation for item in tolerances(narrow, straight(narrow), 1.0)} == {0.0}


@pytest.mark.parametrize('speed, damping', [(0.5, 1.12), (1.5, 0.37), (2.5, 0.22)])
def test_damping_ratio_of_a_round_robot(speed, damping):
    obj = box(foot=0.4 / math.sqrt(12))
    location = pushing_location(obj, FACE, 0.3)
    motion = linear_motion(obj, location, straight(location), speed)
    assert motion.damping_ratio == pytest.approx(damping, abs=5e-3)
    assert motion.growth_rate < 0.0


def test_growth_rates_of_a_fixed_point():
    location = pushing_location(box(), FACE, 0.0)
    fast, slow = (linear_motion(box(), location, straight(location), v).growth_rate
                  for v in (1e6, 1e-6))
    assert fast == pytest.approx(2.97, abs=5e-3)
    assert slow == pytest.approx(1e-6 / 0.4, rel=1e-6)


@pytest.mark.parametrize('speed', [0.05, 0.5, 2.0])
@pytest.mark.parametrize('obj, contact, robot', [
    (box(**SKEW), Contact('face', 3, -0.04), 0.3), (box(**SKEW), Contact('vertex', 0), 0.3),
    (bin_(), ROUND, 0.5), (box(**SKEW), FACE, 0.0),
    (dataclasses.replace(bin_(), center_of_mass=(-0.03, 0.02)), ROUND, math.inf),
    (dataclasses.replace(bin_(), center_of_mass=(0.03, 0.02)), ROUND, 1.5)])
def test_poles_are_those_of_the_full_equations(obj, contact, robot, speed):
    location = pushing_location(obj, contact, robot)
    one = straight(location)
    share, effective = location.rolling
    motion = equation_of_motion(obj, (share, effective), 1e-9)
    x = ca.SX.sym('x', 7)
    local = sum(normal_range(obj, contact)) / 2.0
    forward = location.push_direction
    turned = np.exp(1j * one.rotation)
    # The equilibrium: C is found from where F must be, straight ahead of it.
    f = turned * complex(*friction_center_of(obj))
    c = (f - one.arm * np.exp(1j * forward)) / turned
    state = [0, 0, one.rotation, 0, local + share * one.rotation, c.real, c.imag]
    push = ca.DM([speed * math.cos(forward), speed * math.sin(forward), 0, 0, 0])
    rate = motion(x, push)[0]
    assert float(ca.Function('f', [x], [rate])(state)[3]) == pytest.approx(0.0, abs=1e-7)
    values = np.linalg.eigvals(np.array(ca.Function('J', [x], [ca.jacobian(rate, x)])(state)))
    expected = sorted(values, key=abs)[-2:]
    found = linear_motion(obj, location, one, speed).poles
    assert sorted(found, key=abs) == pytest.approx(expected, rel=1e-5) or \
        sorted(found, key=abs) == pytest.approx(np.conj(expected), rel=1e-5)


def friction_center_of(obj):
    """Return the friction centre by its definition."""
    weights = np.array(obj.capacities) / sum(obj.capacities)
    return weights @ [(s.x, s.y) for s in obj.supports]


def growth_in_the_plant(obj, location, place, turn, seconds):
    """Push the object straight, turned a little and rolled along; return the rate of growth."""
    radius, (share, effective) = location.robot_radius, location.rolling
    obj = dataclasses.replace(obj, contact_friction_coefficient=3.0)
    robot = dataclasses.replace(ramp_robot(radius), max_acceleration=100.0)
    x, y = Pose(0.0, 0.0, turn).rotate(place(effective * turn))
    start = Pose(x - radius * math.cos(share * turn), y - radius * math.sin(share * turn), 0.0)
    plant = Plant(obj, robot, Pose(0.0, 0.0, turn), start, 2e-3)
    plant.advance(0.4 * seconds, Twist(1.0, 0.0, 0.0))
    first = plant.object_pose.theta
    plant.advance(0.6 * seconds, Twist(1.0, 0.0, 0.0))
    return math.log(plant.object_pose.theta / first) / (0.6 * seconds)


def on_the_rim(travel):
    """Return the contact point of a disc of radius 0.2 m that has rolled."""
    return -0.2 * math.cos(travel / 0.2), 0.2 * math.sin(travel / 0.2)


@pytest.mark.parametrize('shape', ['face', 'round'])
@pytest.mark.parametrize('off', [-0.01, 0.01])
def test_plant_switches_stability_within_a_percent_of_the_effective_radius(shape, off):
    """It switches at h = R_e: on a face by the robot's radius, on a disc by where F is."""
    if shape == 'face':
        obj, location = box(), pushing_location(box(), FACE, 0.2 / (1.0 + off))
    else:
        obj = shifted_bin(0.2 - 0.1 * (1.0 + off))
        location = pushing_location(obj, ROUND, 0.2)
    one = straight(location)
    assert one.arm / location.rolling.effective_radius - 1.0 == pytest.approx(off, abs=1e-9)
    predicted = linear_motion(obj, location, one, 1.0).growth_rate
    assert (predicted > 0.0) == (off > 0.0)
    place = on_the_rim if shape == 'round' else (lambda travel: (-0.2, travel))
    measured = growth_in_the_plant(obj, location, place, 1e-4, 20.0)
    assert measured == pytest.approx(predicted, rel=0.05)
