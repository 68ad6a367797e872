"""Steering ranges: closed forms for small angles, symmetry, and the contact simulation."""

import dataclasses
import math

from helpers.objects import bin_, box
from push_model.geometry import Pose
from push_model.parameters import Contact, RoundRobot
from push_model.quasi_static import vehicle
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest
from studies.analysis.pushing_location import pushing_location
from studies.analysis.steering import steady_differential_push, steering_range

CORNER, FACE = Contact('vertex', 0), Contact('face', 3)
SLOW = 1e-3
DIFFERENTIAL = RoundRobot(radius=0.17, max_speed=1.0, max_yaw_rate=20.0, time_constant=0.0)
HOLONOMIC = dataclasses.replace(DIFFERENTIAL, drive='holonomic')


def curvatures(*arguments, **options):
    return tuple(push.curvature for push in steering_range(*arguments, **options))


@pytest.mark.parametrize('lead', [0.0, 0.02])
def test_small_cone_at_a_vertex(lead):
    """``(D -+ beta) / (r + R_p)``."""
    obj = box(contact_friction_coefficient=0.03)
    reach, beta = 0.2 * math.sqrt(2.0) + 0.17, math.atan(0.03)
    assert curvatures(obj, CORNER, DIFFERENTIAL, SLOW, heading_offset=lead) == pytest.approx(
        ((lead - beta) / reach, (lead + beta) / reach), rel=1e-2)


def test_small_cone_with_a_held_normal():
    """``beta r / c^2`` to either side."""
    obj = box(contact_friction_coefficient=0.03)
    view = vehicle(obj, (-0.2, 0.0))
    limit = 0.03 * view.arm / view.c_squared
    assert curvatures(obj, FACE, HOLONOMIC, SLOW) == pytest.approx((-limit, limit), rel=1e-2)


@pytest.mark.parametrize('radius', [0.1, 0.3])
def test_rolling_along_a_face_steers_as_far_as_the_radius_differs(radius):
    """``kappa (R_p + L) = -(offset - offset_0) (1 / n_f - 1 / R_p)``."""
    obj, shift = box(), 1e-3
    location = pushing_location(obj, FACE, radius)
    push = steady_differential_push(obj, location, shift / radius, SLOW)
    assert push.contact_point == pytest.approx((-0.2, shift), abs=1e-9)
    assert push.curvature * (radius + 0.4) == pytest.approx(
        -shift * (1.0 / 0.2 - 1.0 / radius), rel=1e-2)


def test_no_authority_on_a_face_with_the_radius_of_the_friction_centre():
    """The contact decides: a curvature of ``-zeta_0 / (R_p + L)`` wherever it rolls to."""
    obj, same = box(), dataclasses.replace(DIFFERENTIAL, radius=0.2)
    low, high = curvatures(obj, Contact('face', 3, 0.02), same, SLOW)
    assert low < -0.1 / 0.6 < high
    corner = curvatures(obj, CORNER, same, SLOW)
    assert high - low < 0.12 * (corner[1] - corner[0])
    small = curvatures(obj, Contact('face', 3, 0.02), DIFFERENTIAL, SLOW)
    assert small[1] - small[0] > 2.0 * (high - low)


@pytest.mark.parametrize('obj, contact', [(box(), FACE), (box(), Contact('face', 3, 0.05)),
                                          (bin_(), Contact('round', 0, 2.8))])
def test_arcs_rolled_off_robot_and_object_are_equal(obj, contact):
    location = pushing_location(obj, contact, 0.17, None, -0.05)
    pushes = [steady_differential_push(obj, location, turn, 0.1) for turn in (0.0, 0.12, -0.3)]
    for push in pushes[1:]:
        rolled = 0.17 * ((push.normal - push.heading) - 0.05)
        (x, y), (x_0, y_0) = push.contact_point, pushes[0].contact_point
        if contact.kind == 'face':
            assert y - y_0 == pytest.approx(rolled, abs=1e-12)
        else:
            turned = math.atan2(y, x) - math.atan2(y_0, x_0)
            assert math.hypot(x, y) == pytest.approx(obj.radius)
            assert math.remainder(obj.radius * turned, 2.0 * math.pi * obj.radius) == (
                pytest.approx(-rolled, abs=1e-12))


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC])
def test_mirror_symmetry_and_independence_of_mass(robot):
    right = steering_range(box(), Contact('face', 3, 0.07), robot, 0.3)
    left = steering_range(box(mass=9.0), Contact('face', 3, -0.07), robot, 0.3)
    for one, other in zip(right, reversed(left)):
        assert one.curvature == pytest.approx(-other.curvature, rel=1e-7)
        assert one.contact_point[1] == pytest.approx(-other.contact_point[1], abs=1e-8)
        assert one.twist[0] == pytest.approx(other.twist[0])
        # Contact and robot move as one body.
        v_x, v_y, omega = one.twist
        lead = one.normal - one.heading
        assert math.hypot(v_x - omega * 0.17 * math.sin(lead),
                          v_y + omega * 0.17 * math.cos(lead)) == pytest.approx(0.3)


def test_inertia_relieves_a_held_contact_and_loads_a_trailing_one():
    """The pull to the middle of the turn is against the steering force, or on its side."""
    fast = dataclasses.replace(DIFFERENTIAL, max_speed=5.0)
    for robot, contact, share in ((dataclasses.replace(fast, drive='holonomic'), FACE, 1.2),
                                  (fast, CORNER, 0.8)):
        slow, quick = (curvatures(box(), contact, robot, speed)[1] for speed in (SLOW, 0.8))
        assert (quick - share * slow) * (share - 1.0) > 0.0


@pytest.mark.parametrize('limit', [{'max_yaw_rate': 0.1}, {'max_speed': 0.11}])
def test_limits_of_the_drive(limit):
    slow = dataclasses.replace(HOLONOMIC, **limit)
    for push in steering_range(box(), FACE, slow, 0.1):
        used = {'max_yaw_rate': abs(push.twist[2]), 'max_speed': math.hypot(*push.twist[:2])}
        assert all(used[name] == pytest.approx(value) for name, value in limit.items())
        assert abs(push.force_angle) < math.atan(0.5) - 0.01


def test_contacts_that_steer_to_one_side_or_not_at_all():
    slippery = box(contact_friction_coefficient=0.05)
    for robot in (HOLONOMIC, DIFFERENTIAL):
        low, high = curvatures(slippery, Contact('face', 3, 0.05), robot, 0.1)
        assert low < high < 0.0
    assert steering_range(slippery, Contact('face', 3, 0.19), HOLONOMIC, 0.1) is None
    lame = dataclasses.replace(HOLONOMIC, max_speed=0.05)
    assert steering_range(box(), FACE, lame, 0.1) is None
    for robot in (dataclasses.replace(DIFFERENTIAL, radius=0.0),
                  dataclasses.replace(HOLONOMIC, radius=math.inf)):
        with pytest.raises(ValueError, match='robot.radius'):
            steering_range(box(), FACE, robot, 0.1)


@pytest.mark.slow
@pytest.mark.parametrize('offset', [0.1, 0.62, 2.0, 4.4])
def test_round_object_steers_alike_all_round(offset):
    """On feet all round, and with its friction centre in the middle but for rounding."""
    found = [curvatures(bin_(feet=24), Contact('round', 0, angle), DIFFERENTIAL, 0.1)
             for angle in (0.0, offset)]
    assert found[1] == pytest.approx(found[0], rel=2e-2)
    assert found[1][0] == pytest.approx(-found[1][1], rel=2e-2)


def slipped(obj, robot, push, way=0.3):
    """Hold the twist of a push in the contact simulation; tell the share of it that slid."""
    speed, ramp = math.hypot(*push.twist[:2]), 0.02
    # Translation and rotation gather speed alike.
    robot = dataclasses.replace(robot, max_acceleration=ramp,
                                max_yaw_acceleration=ramp * abs(push.twist[2]) / speed)
    c_x, c_y = push.contact_point
    plant = Plant(obj, robot, Pose(0.0, 0.0, 0.0),
                  Pose(c_x - robot.radius * math.cos(push.normal),
                       c_y - robot.radius * math.sin(push.normal), push.heading))
    slid, steps = 0, math.ceil((way / speed + speed / ramp) / 0.02)
    for step in range(steps):
        plant.advance(0.02, Twist(*push.twist))
        slid += plant.mode is not ContactMode.STICK and step > 2
    return slid / steps


@pytest.mark.parametrize('robot, contact', [
    (DIFFERENTIAL, CORNER), (DIFFERENTIAL, FACE), (DIFFERENTIAL, Contact('face', 3, 0.05)),
    (HOLONOMIC, CORNER), (HOLONOMIC, FACE), (HOLONOMIC, Contact('face', 3, -0.05))])
@pytest.mark.parametrize('side', [0, 1])
def test_contact_holds_up_to_the_limit_and_slips_beyond(robot, contact, side):
    """The limits of a bit more friction than there is, and of a bit less."""
    for share, holds in ((0.95, True), (1.05, False)):
        believed = box(contact_friction_coefficient=0.5 * share)
        push = steering_range(believed, contact, robot, 0.05)[side]
        share_slid = slipped(box(), robot, push)
        assert share_slid == 0.0 if holds else share_slid > 0.1
