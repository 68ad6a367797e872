"""Laws that hold for the plant at any step: symmetries, energy, friction, rest."""

import itertools
import math
import os
import subprocess
import sys

from helpers.objects import bin_, box
from helpers.plant_course import COMMANDS, course, forces, plant_of, poses, UNEVEN
import numpy as np
from push_model.geometry import Pose
from push_model.signals import Twist
from push_sim_node.truth import ContactMode
import pytest

pytestmark = pytest.mark.physics

SCRIPT = """
import sys
from helpers.objects import box
from push_model import Pose, RoundRobot
from push_sim_node.plant import Plant
Plant(box(), RoundRobot(0.17), Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0)).advance(0.01)
assert 'numba' not in sys.modules
"""


@pytest.mark.parametrize('obj', [box(**UNEVEN), bin_()], ids=['box', 'bin'])
def test_isotropy(obj):
    frame = Pose(0.3, -0.7, 2.1)
    places = Pose(0.0, 0.0, 0.2), Pose(-0.41, 0.02, -0.1)
    one = course(plant_of(obj, *places))
    two = course(plant_of(obj, *(frame @ place for place in places)))
    assert {ContactMode.STICK, ContactMode.SLIDE_LEFT} <= {truth.mode for truth in one}
    expected = [truth._replace(object_pose=frame @ truth.object_pose,
                               robot_pose=frame @ truth.robot_pose) for truth in one]
    assert poses(two) == pytest.approx(poses(expected), abs=1e-9)
    assert forces(two) == pytest.approx(forces(one), abs=1e-6)


def test_mirror_symmetry():
    mirror = {'friction': (0.25, 0.3, 0.4, 0.2), 'center_of_mass': (0.02, 0.03)}
    one = course(plant_of(box(**UNEVEN), (0.0, 0.0, 0.2), (-0.41, 0.02, -0.1)))
    two = course(plant_of(box(**mirror), (0.0, 0.0, -0.2), (-0.41, -0.02, 0.1)),
                 [Twist(c.v_x, -c.v_y, -c.omega) for c in COMMANDS])
    assert poses(two) == pytest.approx(poses(one) * [1, -1, -1, 1, -1, -1], abs=1e-9)
    assert forces(two) == pytest.approx(forces(one) * [1, -1], abs=1e-6)
    swapped = {ContactMode.SLIDE_LEFT: ContactMode.SLIDE_RIGHT,
               ContactMode.SLIDE_RIGHT: ContactMode.SLIDE_LEFT}
    assert [t.mode for t in two] == [swapped.get(t.mode, t.mode) for t in one]


@pytest.mark.parametrize('obj', [box(**UNEVEN), bin_()], ids=['box', 'bin'])
@pytest.mark.parametrize('step', [1e-3, 1e-2])
def test_work_is_kinetic_energy_and_losses_that_never_shrink(obj, step):
    truths = course(plant_of(obj, (0.0, 0.0, 0.2), (-0.45, 0.02, -0.1), step=step))
    energies = np.array([truth.energy for truth in truths])
    assert energies[-1, 0] > 0.5
    assert energies[:, 0] == pytest.approx(energies[:, 1:].sum(axis=1), rel=1e-12, abs=1e-12)
    assert energies[:, 1].min() >= 0.0 and energies[:, 1].max() > 1e-3
    assert np.diff(energies[:, 2:], axis=0).min() >= -1e-5 * energies[-1, 0]


def test_loss_of_the_step_itself_vanishes_with_the_step():
    """Without an impact nothing but the step's own damping is left, and next to no impact."""
    energies = []
    for step in (4e-3, 1e-3):
        plant = plant_of(box(**UNEVEN), (0.0, 0.0, 0.0), (-0.37, 0.02, 0.0), step=step)
        plant.advance(1.5, Twist(0.3, 0.0, 0.1))
        energies.append(plant.energy)
    assert 0.0 < energies[0].integration_loss < 1e-2 * plant.energy.work
    assert energies[0].integration_loss / energies[1].integration_loss == pytest.approx(
        4.0, rel=0.1)
    assert energies[0].impact_loss < 0.2 * energies[0].integration_loss
    assert energies[1].impact_loss < 0.1 * energies[0].impact_loss


def test_loss_of_an_impact_does_not_depend_on_the_step():
    """The robot meets the object at full speed; what the step damps is apart."""
    energies = []
    for step in (2e-3, 5e-4):
        plant = plant_of(box(), (0.0, 0.0, 0.0), (-0.6, 0.0, 0.0), step=step)
        plant.advance(1.2, Twist(0.4, 0.0, 0.0))
        energies.append(plant.energy)
    assert energies[1].impact_loss == pytest.approx(0.5 * 2.0 * 0.4 ** 2, rel=0.02)
    assert energies[0].impact_loss == pytest.approx(energies[1].impact_loss, rel=0.03)
    assert energies[1].integration_loss < 1e-2 * energies[1].impact_loss


def test_support_friction_opposes_motion_and_fills_its_capacity():
    obj = box(**UNEVEN)
    truths = course(plant_of(obj, (0.0, 0.0, 0.2), (-0.41, 0.02, -0.1)))
    moving = [t for t in truths if math.hypot(*t.object_twist[:2]) > 0.05]
    assert len(moving) > 10
    for truth, (i, capacity) in itertools.product(moving, enumerate(obj.capacities)):
        support = obj.supports[i]
        x, y = Pose(0, 0, truth.object_pose.theta).rotate((support.x, support.y))
        v_x, v_y, omega = truth.object_twist
        v = np.array([v_x - omega * y, v_y + omega * x])
        if np.linalg.norm(v) < 0.02:
            continue
        force = np.array(truth.support_forces[i])
        assert np.linalg.norm(force) == pytest.approx(capacity, rel=2e-3)
        assert force @ v == pytest.approx(-capacity * np.linalg.norm(v), rel=2e-3)


def test_contact_force_stays_in_its_cone_and_opposes_slip():
    obj = box(contact_friction_coefficient=0.3, **UNEVEN)
    truths = course(plant_of(obj, (0.0, 0.0, 0.2), (-0.41, 0.02, -0.1)))
    assert {truth.mode for truth in truths} == set(ContactMode)
    for truth in truths:
        assert truth.force_n >= 0.0
        limit = 0.3 * truth.force_n
        slip = slip_of(truth)
        if truth.mode is ContactMode.SEPARATE:
            assert truth.force_n == truth.force_t == 0.0
        elif truth.mode is ContactMode.STICK:
            assert abs(truth.force_t) <= limit and abs(slip) < 2e-3
        else:
            side = 1.0 if truth.mode is ContactMode.SLIDE_LEFT else -1.0
            assert truth.force_t == pytest.approx(side * limit) and side * slip > 0.0


def slip_of(truth):
    """Return the speed of the robot's surface along t relative to the object's [m/s]."""
    n = np.array([math.cos(truth.normal), math.sin(truth.normal)])
    t = np.array([-n[1], n[0]])
    arm = np.array(truth.contact_point) - truth.object_pose[:2]
    v_x, v_y, omega = truth.object_twist
    surface = t @ truth.robot_pose.rotate(truth.robot_twist) + truth.robot_twist.omega * 0.17
    return surface - t @ (v_x - omega * arm[1], v_y + omega * arm[0])


@pytest.mark.parametrize('gap', [0.0, 0.05])
def test_at_rest_stays_exactly_at_rest(gap):
    obj, pose = box(**UNEVEN), Pose(0.123, -0.456, 0.789)
    plant = plant_of(obj, pose, pose @ Pose(-0.37 - gap, 0.03, 0.0))
    before = plant.object_pose
    plant.advance(200.0)
    assert plant.object_pose == before
    assert plant.object_twist == (0.0, 0.0, 0.0)


def test_robot_standing_beside_spins_without_moving_the_object():
    plant = plant_of(box(), (0.0, 0.0, 0.0), (-0.371, 0.0, 0.0))
    plant.advance(5.0, Twist(0.0, 0.0, 2.0))
    assert plant.object_pose == (0.0, 0.0, 0.0)
    assert plant.robot_pose.theta > 9.0


def test_object_that_was_pushed_comes_to_rest_exactly():
    plant = plant_of(box(**UNEVEN), (0.0, 0.0, 0.0), (-0.37, 0.05, 0.0))
    plant.advance(2.0, Twist(0.4, 0.0, 0.0))
    assert math.hypot(*plant.object_twist[:2]) > 0.3
    plant.advance(1.0, Twist(-0.2, 0.0, 0.0))
    resting = plant.object_pose
    assert plant.object_twist == (0.0, 0.0, 0.0)
    plant.advance(2.0, Twist(-0.2, 0.0, 0.0))
    assert plant.object_pose == resting


@pytest.mark.parametrize('obj', [box(**UNEVEN), bin_()], ids=['box', 'bin'])
def test_compiled_and_interpreted_plant_agree(obj):
    places = Pose(0.0, 0.0, 0.2), Pose(-0.41, 0.02, -0.1)
    compiled, plain = (course(plant_of(obj, *places, interpret=interpret))
                       for interpret in (False, True))
    assert poses(plain) == pytest.approx(poses(compiled), abs=1e-12)
    assert forces(plain) == pytest.approx(forces(compiled), abs=1e-6)


def test_plain_python_needs_no_compiler():
    """Where the environment asks for it, numba is not even loaded."""
    done = subprocess.run([sys.executable, '-c', SCRIPT], env={
        **os.environ, 'PUSH_SIM_INTERPRET': '1', 'PYTHONPATH': os.pathsep.join(sys.path)})
    assert done.returncode == 0
