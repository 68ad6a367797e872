"""Loads of the supports in the plant: balance in space, lifting, the limit of floor height."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.plant_course import course, plant_of, poses, UNEVEN
from helpers.plant_reference import ramp_robot, rolling_push
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import GRAVITY
from push_model.signals import Twist
from push_sim_node.plant import Plant
import pytest

pytestmark = pytest.mark.physics
HEIGHTS = {'contact_height': 0.1, 'center_of_mass_height': 0.15}


def moment_about_the_origin(obj, truth):
    """Add up force and moment in space: gravity, inertia, contact and supports."""
    n = np.array([np.cos(truth.normal), np.sin(truth.normal)])
    contact = np.array([*(truth.force_n * n + truth.force_t * np.array([-n[1], n[0]])), 0.0])
    friction = np.array(truth.support_forces)
    center = np.array([*truth.object_pose.transform(obj.center_of_mass),
                       obj.center_of_mass_height])
    # Newton's second law gives the acceleration.
    inertial = np.array([*(contact[:2] + friction.sum(axis=0)), obj.mass * GRAVITY])
    total = np.cross([*truth.contact_point, obj.contact_height], contact)
    total -= np.cross(center, inertial)
    for support, load, force in zip(obj.supports, truth.support_loads, friction):
        place = truth.object_pose.transform((support.x, support.y))
        total += np.cross([*place, 0.0], [*force, load])
    return total[:2]


@pytest.mark.parametrize(
    'obj', [box(**UNEVEN, **HEIGHTS), bin_(**HEIGHTS), bin_(feet=5, **HEIGHTS)],
    ids=['box', 'bin', 'five feet'])
def test_loads_carry_the_weight_and_balance_all_moments(obj):
    """While the push accelerates, slides, ends and comes back; moments in Nm of about 5."""
    truths = course(plant_of(obj, (0.0, 0.0, 0.2), (-0.41, 0.02, -0.1), step=1e-3))
    pushed = [truth for truth in truths if truth.force_n > 1.0]
    assert len(pushed) > 5
    for truth in truths:
        assert sum(truth.support_loads) == pytest.approx(obj.mass * GRAVITY)
        assert min(truth.support_loads) >= 0.0
    for truth in pushed:
        # Truth has the pose at the end of a step, its forces act in the middle.
        assert moment_about_the_origin(obj, truth) == pytest.approx([0.0, 0.0], abs=0.02)
        assert np.ptp(truth.support_loads) > 1.0


def test_floor_height_is_the_limit():
    ends = [poses(course(plant_of(box(**UNEVEN, contact_height=height), (0.0, 0.0, 0.2),
                                  (-0.41, 0.02, -0.1)))) for height in (0.0, 1e-8, 0.1)]
    assert ends[1] == pytest.approx(ends[0], abs=1e-6)
    assert np.abs(ends[2] - ends[0]).max() > 1e-3


@pytest.mark.parametrize('obj, point', [(box(**UNEVEN, **HEIGHTS), (-0.2, 0.02)),
                                        (bin_(**HEIGHTS), (-0.2, 0.0))], ids=['box', 'bin'])
def test_push_converges_to_the_rolling_equations_with_heights(obj, point):
    """Those of push_model, in which loads and friction are solved for at once."""
    obj = dataclasses.replace(obj, contact_friction_coefficient=5.0)
    robot, times, command = ramp_robot(0.17), [0.5, 1.0, 1.5], (0.2, 0.0, 0.1)
    course, forces = rolling_push(obj, robot, 0.0, point, obj.radius or math.inf, 0.0, command,
                                  times)
    errors = []
    for step in (4e-3, 2.5e-4):
        plant = Plant(obj, robot, Pose(0.0, 0.0, 0.0), Pose(point[0] - 0.17, point[1], 0.0), step)
        truths = []
        for time in times:
            plant.advance(0.5, Twist(*command))
            truths.append(plant.truth(time))
        errors.append(np.abs(np.array([truth.object_pose for truth in truths]) - course).max())
    assert errors[0] < 1e-4 and errors[1] < 0.15 * errors[0]
    assert [(truth.force_n, truth.force_t) for truth in truths] == [
        pytest.approx(force, abs=5e-3) for force in forces]


def test_mirror_symmetry_holds_with_heights():
    one, two = (course(plant_of(box(**HEIGHTS), (0.0, 0.0, side * 0.2), (-0.41, side * 0.02, 0.0)),
                       [Twist(0.3, side * 0.05, side * 0.2)]) for side in (1.0, -1.0))
    assert poses(two) == pytest.approx(poses(one) * [1, -1, -1, 1, -1, -1], abs=1e-8)


@pytest.mark.parametrize('feet', [3, 4, 6])
def test_a_hard_start_lifts_supports_and_none_ever_pulls(feet):
    """The mass centre is high: the object is thrown back onto its rear supports."""
    obj = bin_(feet=feet, contact_height=0.02, center_of_mass_height=0.5)
    plant = plant_of(obj, (0.0, 0.0, 0.3), (-0.37, 0.0, 0.0))
    lifted = 0
    for _ in range(50):
        plant.advance(0.002, Twist(0.4, 0.0, 0.0))
        loads = plant.truth(0.0).support_loads
        assert min(loads) >= 0.0 and sum(loads) == pytest.approx(obj.mass * GRAVITY)
        lifted += min(loads) == 0.0
    assert lifted > 5 and plant.unsolved_steps == 0


def test_work_is_kinetic_energy_and_losses_with_heights():
    energies = np.array([truth.energy for truth in course(plant_of(
        box(**UNEVEN, **HEIGHTS), (0.0, 0.0, 0.2), (-0.45, 0.02, -0.1)))])
    assert energies[:, 0] == pytest.approx(energies[:, 1:].sum(axis=1), rel=1e-12, abs=1e-12)


def test_object_that_a_push_tips_is_refused():
    with pytest.raises(ValueError, match='PushedObject.contact_height: got 0.5 m, expected below'):
        plant_of(bin_(contact_height=0.5), Pose(0.0, 0.0, 0.0), Pose(-0.4, 0.0, 0.0))


def test_plain_python_shifts_the_same_loads():
    loads = []
    for interpret in (False, True):
        plant = plant_of(box(**UNEVEN, **HEIGHTS), (0.0, 0.0, 0.0), (-0.37, 0.02, 0.0),
                         interpret=interpret)
        plant.advance(0.1, Twist(0.2, 0.0, 0.1))
        loads.append(plant.truth(0.0).support_loads)
    assert loads[1] == pytest.approx(loads[0], rel=1e-9)
