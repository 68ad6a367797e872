"""The plant with robots from a point to a flat pusher: limits, contact modes, corners."""

import math

from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest

pytestmark = pytest.mark.physics
ORIGIN = Pose(0.0, 0.0, 0.0)
UNEVEN = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03)}
POINT, FLAT_PUSHER = 0.0, math.inf
OBJECTS = {'box': (box(**UNEVEN), (-0.2, -0.2), 0.7), 'bin': (bin_(), (-0.2, 0.0), 0.0)}


def beside(point, normal, radius, gap=0.0):
    """Return the pose of a robot that looks along a normal at a point of an object."""
    away = gap if math.isinf(radius) else gap + radius
    return Pose(point[0] - away * math.cos(normal), point[1] - away * math.sin(normal), normal)


def courses(obj, point, normal, radius, commands, gap=0.0, step=1e-3, samples=40):
    """Drive through commands of half a second; return the truths."""
    plant = Plant(obj, ramp_robot(radius), ORIGIN, beside(point, normal, radius, gap), step)
    truths = []
    for command in commands:
        for _ in range(samples):
            plant.advance(0.5 / samples, Twist(*command))
            truths.append(plant.truth(0.0))
    assert plant.unsolved_steps == 0
    return truths


def poses(truths):
    """Return the object's poses, shape (n, 3)."""
    return np.array([truth.object_pose for truth in truths])


@pytest.mark.parametrize('name', OBJECTS)
def test_very_large_radius_tends_to_the_flat_pusher(name):
    """The difference falls as 1 / R_p, down to nothing at 10 km."""
    obj, point, normal = OBJECTS[name]
    commands = [(0.3, 0.05, 0.0), (0.3, -0.3, 0.0), (0.1, 0.4, 0.0)]
    flat_pusher = courses(obj, point, normal, FLAT_PUSHER, commands)
    off = [np.abs(poses(courses(obj, point, normal, radius, commands)) - poses(flat_pusher)).max()
           for radius in (10.0, 100.0, 1e4)]
    assert np.abs(poses(flat_pusher)[-1]).max() > 0.1
    assert off[1] < 0.2 * off[0] and off[2] < 1e-4


@pytest.mark.parametrize('obj, point', [(box(**UNEVEN), (-0.2, 0.04)), (bin_(), (-0.2, 0.0))])
def test_very_small_radius_tends_to_the_point(obj, point):
    commands = [(0.3, 0.05, 0.5), (0.2, -0.2, -0.5), (0.1, 0.3, 0.0)]
    ends = poses(courses(obj, point, 0.0, POINT, commands))
    off = [np.abs(poses(courses(obj, point, 0.0, radius, commands)) - ends).max()
           for radius in (1e-2, 1e-3, 1e-6)]
    assert np.abs(ends[-1]).max() > 0.1
    assert off[1] < 0.2 * off[0] and off[2] < 5e-5


@pytest.mark.parametrize('radius', [POINT, 0.05, 0.3, 5.0, FLAT_PUSHER])
@pytest.mark.parametrize('name', OBJECTS)
def test_every_robot_hits_sticks_slides_both_ways_and_leaves(name, radius):
    obj, point, normal = OBJECTS[name]
    if radius == POINT and name == 'box':
        point, normal = (-0.2, 0.0), 0.0
    commands = [(0.2, 0.0, 0.0), (0.2, 0.0, 0.0), (0.15, 0.3, 0.0), (0.15, -0.3, 0.0),
                (-0.3, 0.0, 0.0)]
    truths = courses(obj, point, normal, radius, commands, gap=0.01)
    modes = [truth.mode for truth in truths]
    assert modes[0] == ContactMode.SEPARATE and truths[0].gap > 0.0
    assert modes[-1] == ContactMode.SEPARATE and truths[-1].gap > 0.01
    assert {ContactMode.STICK, ContactMode.SLIDE_LEFT, ContactMode.SLIDE_RIGHT} <= set(modes)
    assert ContactMode.STICK in modes[40:80]
    friction = obj.contact_friction_coefficient
    for truth in truths:
        assert truth.gap > -2e-5 and truth.force_n >= 0.0
        assert abs(truth.force_t) <= friction * truth.force_n + 1e-9
    energy = truths[-1].energy
    assert energy.work == pytest.approx(sum(energy[1:]), rel=1e-9)
    assert energy.impact_loss > 0.0 and energy.contact_loss > 0.0


@pytest.mark.parametrize('radius', [0.02, 0.17, 1.0])
def test_push_travels_from_a_face_round_the_corner_to_the_next_face(radius):
    """The robot slides along one face, wraps the corner, and goes on along the next."""
    obj = box(mass=20.0, contact_friction_coefficient=0.1)
    robot = ramp_robot(radius)
    plant = Plant(obj, robot, ORIGIN, beside((-0.2, -0.1), 0.0, radius), 1e-3)
    seen, normals, gaps = [], [], []
    for _ in range(12000):
        # Pressed on, and driven to the robot's right: round vertex 0 to face 0.
        truth = plant.truth(0.0)
        n = truth.normal - truth.robot_pose.theta
        plant.advance(2e-3, Twist(0.05 * math.cos(n) + 0.2 * math.sin(n),
                                  0.05 * math.sin(n) - 0.2 * math.cos(n), 0.0))
        truth = plant.truth(0.0)
        contact, gamma, gap = find_contact(obj, truth.object_pose, truth.robot_pose, radius)
        normals.append(wrap_angle(gamma - truth.object_pose.theta))
        gaps.append(gap)
        if truth.mode is not ContactMode.SEPARATE and (contact.kind, contact.index) not in seen:
            seen.append((contact.kind, contact.index))
        if seen[-1] == ('face', 0) and abs(contact.offset) < 0.1:
            break
    assert seen == [('face', 3), ('vertex', 0), ('face', 0)]
    assert normals[0] == pytest.approx(0.0) and normals[-1] == pytest.approx(math.pi / 2)
    assert (np.diff(normals) > -1e-6).all()
    assert min(gaps) > -2e-4 and max(gaps) < 2e-3


def test_flat_pusher_that_swings_sweeps_the_object_along():
    """Far from its pivot it moves at omega times the distance, square to itself."""
    plant = Plant(bin_(), ramp_robot(FLAT_PUSHER), ORIGIN, Pose(-0.2, 1.0, 0.0), 1e-3)
    plant.advance(0.5, Twist(0.0, 0.0, 0.5))
    truth = plant.truth(0.0)
    arm = math.hypot(truth.contact_point[0] + 0.2, truth.contact_point[1] - 1.0)
    assert truth.mode is ContactMode.STICK and abs(truth.gap) < 1e-6
    assert truth.pushing_angle == pytest.approx(0.0, abs=1e-9)
    n = np.array([math.cos(truth.normal), math.sin(truth.normal)])
    assert n @ truth.object_twist[:2] == pytest.approx(0.5 * arm, rel=2e-3)


@pytest.mark.parametrize('tilt', [0.05, -0.1])
def test_flat_pusher_turns_a_face_flush_and_keeps_it_so(tilt):
    """Two corners take turns in carrying; the sideways creep that this leaves is documented."""
    plant = Plant(box(**UNEVEN), ramp_robot(FLAT_PUSHER), Pose(0.0, 0.0, tilt),
                  Pose(-0.25, 0.0, 0.0))
    plant.advance(1.5, Twist(0.2, 0.0, 0.0))
    for _ in range(200):
        plant.advance(1e-2, Twist(0.2, 0.0, 0.0))
        assert abs(plant.object_pose.theta) < 1e-4
        assert plant.truth(0.0).gap > -5e-4
    assert plant.object_pose.x == pytest.approx(plant.robot_pose.x + 0.2, abs=1e-4)
    assert plant.unsolved_steps == 0
