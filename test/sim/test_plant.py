"""The plant against smooth equations of motion, as its step shrinks."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot, rolling_push, sliding_push
import numpy as np
from push_model.geometry import Pose
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest

pytestmark = pytest.mark.physics
GRIPPY = {'contact_friction_coefficient': 5.0}
UNEVEN = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03)}
FACE, VERTEX, DISC = math.inf, 0.0, 0.2
# object, robot radius, place on the outline, normal, curvature radius, heading, command, seconds
ROLLING = {
    'face, rolling off centre': (box(**GRIPPY), 0.17, (-0.2, 0.02), 0.0, FACE, 0.0,
                                 (0.2, 0.0, 0.0), 3.0),
    'face, slow': (box(**GRIPPY, **UNEVEN), 0.17, (-0.2, 0.0), 0.0, FACE, 0.0,
                   (0.05, 0.01, 0.0), 4.0),
    'face, fast': (box(**GRIPPY), 0.3, (-0.2, 0.05), 0.0, FACE, 0.0, (1.0, 0.1, 0.0), 1.0),
    'face, stable wide robot': (box(**GRIPPY, **UNEVEN), 0.5, (-0.2, 0.05), 0.0, FACE, 0.0,
                                (0.25, 0.0, 0.0), 4.0),
    'vertex': (box(**GRIPPY, **UNEVEN), 0.17, (-0.2, -0.2), 0.7, VERTEX, 0.7,
               (0.2, 0.02, 0.0), 2.0),
    'vertex, arc with spin': (box(**GRIPPY, **UNEVEN), 0.17, (-0.2, -0.2), 0.7, VERTEX, 0.7,
                              (0.2, 0.0, 0.3), 0.9),
    'face, arc with spin': (box(**GRIPPY, **UNEVEN), 0.17, (-0.2, 0.02), 0.0, FACE, 0.1,
                            (0.2, 0.0, -0.4), 1.5),
    'round': (bin_(), 0.17, (-0.2, 0.0), 0.0, DISC, 0.05, (0.2, 0.0, 0.0), 2.0),
    'round, spin': (bin_(**GRIPPY), 0.17, (-0.2, 0.0), 0.0, DISC, 0.05, (0.2, 0.0, 0.4), 1.5),
    'face, point': (box(**GRIPPY, **UNEVEN), 0.0, (-0.2, 0.05), 0.0, FACE, 0.1, (0.2, 0.0, 0.2),
                    1.0),
    'round, point': (bin_(**GRIPPY), 0.0, (-0.2, 0.0), 0.0, DISC, 0.05, (0.2, 0.0, 0.2), 1.0),
    'face, 10 m': (box(**GRIPPY, **UNEVEN), 10.0, (-0.2, -0.1), 0.0, FACE, 0.0, (0.2, 0.1, 0.0),
                   1.0),
    'vertex, 100 m': (box(**GRIPPY, **UNEVEN), 100.0, (-0.2, -0.2), 0.7, VERTEX, 0.7,
                      (0.2, 0.02, 0.0), 1.5),
    'round, flat pusher': (bin_(**GRIPPY, center_of_mass=(0.02, -0.03)), math.inf, (-0.2, 0.0),
                           0.0, DISC, 0.0, (0.2, 0.05, 0.0), 3.0),
    'round, flat pusher that rotates': (bin_(**GRIPPY), math.inf, (-0.2, 0.0), 0.0, DISC,
                                        0.0, (0.3, 0.0, 0.3), 2.0),
    'vertex, flat pusher': (box(**GRIPPY, **UNEVEN), math.inf, (-0.2, -0.2), 0.7, VERTEX, 0.7,
                            (0.2, 0.02, 0.2), 1.0),
}


def touching(robot, point, normal, heading):
    """Return the robot's pose beside a point of an object at the origin."""
    away = 0.0 if math.isinf(robot.radius) else robot.radius
    return Pose(point[0] - away * math.cos(normal), point[1] - away * math.sin(normal), heading)


def pushed(obj, robot, robot_pose, command, times, step):
    """Return the object's poses at the times, shape (n, 3), and all truths."""
    plant = Plant(obj, robot, Pose(0.0, 0.0, 0.0), robot_pose, step)
    truths, now = [], 0.0
    for time in times:
        plant.advance(time - now, Twist(*command))
        now = time
        truths.append(plant.truth(time))
    return np.array([truth.object_pose for truth in truths]), truths


def apart(one, other):
    """Return the greatest distance between two courses of a 0.4 m object [m]."""
    difference = one - other
    return float(np.max(np.hypot(difference[:, 0], difference[:, 1])
                        + 0.2 * np.abs(difference[:, 2])))


def errors_of(obj, robot, start, command, times, course, modes):
    """Return the errors of the plant for three steps, each a quarter of the one before."""
    errors = []
    for step in (4e-3, 1e-3, 2.5e-4):
        poses, truths = pushed(obj, robot, start, command, times, step)
        assert {truth.mode for truth in truths} == modes
        errors.append(apart(poses, course))
    return errors


@pytest.mark.slow
@pytest.mark.parametrize('scene', ROLLING)
def test_rolling_push_converges_to_the_rolling_equations(scene):
    obj, radius, point, normal, surface, heading, command, seconds = ROLLING[scene]
    robot = ramp_robot(radius)
    times = np.linspace(0.0, seconds, 9)[1:]
    course, forces = rolling_push(obj, robot, normal, point, surface, heading, command, times)
    start = touching(robot, point, normal, heading)
    coarse, middle, fine = errors_of(obj, robot, start, command, times, course,
                                     {ContactMode.STICK})
    assert middle < 4e-5
    assert coarse / middle > 3.0 and middle / fine > 3.0
    _, truths = pushed(obj, robot, start, command, times, 2.5e-4)
    measured = np.array([(truth.force_n, truth.force_t) for truth in truths])
    assert measured == pytest.approx(forces, abs=2e-3)
    assert np.abs(forces[:, 0]).min() > 1.0


@pytest.mark.parametrize('side, command', [(1, (0.2, 0.3, 0.0)), (-1, (0.3, -0.4, 0.0)),
                                           (1, (0.3, 0.0, 3.0))])
def test_sliding_push_converges_to_the_sliding_equations(side, command):
    obj, robot = box(contact_friction_coefficient=0.2, **UNEVEN), ramp_robot(0.17)
    start = touching(robot, (-0.2, -0.05 * side), 0.0, 0.0)
    times = np.linspace(0.0, 0.5, 6)[1:]
    course = sliding_push(obj, robot, start, command, side, times)
    mode = {ContactMode.SLIDE_LEFT if side > 0 else ContactMode.SLIDE_RIGHT}
    coarse, middle, fine = errors_of(obj, robot, start, command, times, course, mode)
    assert middle < 4e-5
    assert coarse / middle > 3.0 and middle / fine > 3.0


@pytest.mark.slow
@pytest.mark.parametrize('scene', ['face, rolling off centre', 'vertex', 'face, fast'])
def test_contact_slides_where_the_rolling_force_leaves_the_cone(scene):
    obj, radius, point, normal, surface, heading, command, seconds = ROLLING[scene]
    robot, times = ramp_robot(radius), np.arange(1, 201) * seconds / 200
    _, forces = rolling_push(obj, robot, normal, point, surface, heading, command, times)
    needed = np.max(np.abs(forces[:, 1]) / forces[:, 0])
    for factor, sticks in ((1.02, True), (0.97, False)):
        limited = dataclasses.replace(obj, contact_friction_coefficient=factor * needed)
        start = touching(robot, point, normal, heading)
        _, truths = pushed(limited, robot, start, command, times, 1e-3)
        assert ({truth.mode for truth in truths} == {ContactMode.STICK}) == sticks


@pytest.mark.parametrize('offset', [-0.1, 0.1])
def test_default_step_is_accurate_over_a_metre_of_mixed_contact(offset):
    """Sticking, sliding, off the face by its corner; the reference is a far finer step."""
    obj, robot = box(contact_friction_coefficient=0.3, **UNEVEN), ramp_robot(0.17)
    start = touching(robot, (-0.2, offset), 0.0, 0.0)
    times, command = np.linspace(0.0, 4.0, 41)[1:], (0.25, 0.05, 0.1)
    reference, truths = pushed(obj, robot, start, command, times, 5e-5)
    assert {truth.mode for truth in truths} >= {ContactMode.STICK, ContactMode.SLIDE_LEFT}
    assert reference[-1, 0] > 0.4
    coarse, _ = pushed(obj, robot, start, command, times, 2e-3)
    assert apart(coarse, reference) < 1e-4
