"""The plant under violent random pushes: slips, blows, whirls and wedges."""

import math

import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest

pytestmark = pytest.mark.physics
ORIGIN = Pose(0.0, 0.0, 0.0)


def random_object(rng):
    """Return a disc or polygon on one to five very different supports."""
    radius, mass, corners = rng.uniform(0.1, 0.4), rng.uniform(0.5, 10.0), rng.integers(2, 9)
    supports = [Support(*rng.uniform(-0.55, 0.55, 2) * radius, rng.uniform(0.02, 0.8),
                        rng.uniform(0.2, 2.0)) for _ in range(rng.integers(1, 6))]
    angles = (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) * 2.0 * math.pi / corners
    shape = {'radius': radius} if corners == 2 else {
        'outline': [(radius * math.cos(a), radius * math.sin(a)) for a in np.sort(angles)]}
    loads = np.array([support.load_fraction for support in supports])
    balance = loads @ [(support.x, support.y) for support in supports] / loads.sum()
    return PushedObject(mass, 0.5 * mass * radius ** 2, supports, center_of_mass=balance,
                        contact_friction_coefficient=rng.choice([0.0, 0.1, 0.3, 0.5, 1.0, 3.0]),
                        **shape)


def random_plant(seed, step=2e-3):
    """Return a plant whose robot touches the object, and five commands towards it."""
    rng = np.random.default_rng(seed)
    obj = random_object(rng)
    robot = RoundRobot(rng.uniform(0.05, 0.5), 'holonomic', 2.0, 4.0, rng.uniform(0.5, 20.0),
                       10.0, rng.choice([0.0, 0.05, 0.2]))
    place = Pose(-1.0, rng.uniform(-0.1, 0.1), rng.uniform(-3.0, 3.0))
    for _ in range(3):
        _, normal, gap = find_contact(obj, ORIGIN, place[:2], robot.radius)
        place = Pose(place.x + gap * math.cos(normal), place.y + gap * math.sin(normal),
                     place.theta)
    speed, ahead = rng.uniform(0.05, 0.8), rng.normal(-place.theta, 0.5, 5)
    commands = [Twist(speed * math.cos(a), speed * math.sin(a), rng.normal(0.0, 0.7))
                for a in ahead]
    return Plant(obj, robot, ORIGIN, place, step), commands


# The later ones wedge the object between robot and floor, where plain iteration runs in circles.
@pytest.mark.parametrize('seed', [0, 1, 2, 3, 4, 5, 58, 80, 106, 142, 185, 285, 303, 421])
def test_every_step_is_solved_and_keeps_the_laws(seed):
    plant, commands = random_plant(seed)
    friction = plant.obj.contact_friction_coefficient
    touched = 0
    for command in commands:
        for _ in range(100):
            plant.advance(6e-3, command)
            truth = plant.truth(0.0)
            touched += truth.mode is not ContactMode.SEPARATE
            assert truth.gap > -5e-5
            assert truth.force_n >= 0.0
            assert abs(truth.force_t) <= friction * truth.force_n * (1.0 + 1e-9) + 1e-9
            for (f_x, f_y), capacity in zip(truth.support_forces, plant.obj.capacities):
                assert math.hypot(f_x, f_y) <= 1.01 * capacity + 1e-3
    assert plant.unsolved_steps == 0
    assert touched > 20
    energy = plant.energy
    assert energy.work > 0.0
    assert energy.work == pytest.approx(sum(energy[1:]), rel=1e-9)


@pytest.mark.parametrize('seed', [80, 185, 58])
def test_wedges_do_not_depend_on_luck(seed):
    """Steps of other sizes find the same course through a wedge."""
    ends = []
    for step in (1e-3, 5e-4, 2.5e-4):
        plant, commands = random_plant(seed, step)
        for command in commands:
            plant.advance(0.6, command)
        ends.append(np.array(plant.object_pose))
    assert np.abs(ends[0][:2]).max() > 0.1
    assert np.abs(ends[0] - ends[2]).max() < 5e-3
    assert np.abs(ends[1] - ends[2]).max() < 2e-3
