"""Floors whose friction depends on the place."""

import itertools
import math

from helpers.objects import bin_, box
from helpers.plant_reference import ramp_robot
import numpy as np
from push_dynamics.compiled import kernel_array
from push_dynamics.floor import floor_rows, FloorPatch, friction_factor_at
from push_model.geometry import Pose
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.simulation import Simulation, SimulationSettings
import pytest

pytestmark = pytest.mark.physics
ORIGIN, START = Pose(0.0, 0.0, 0.0), Pose(-0.37, 0.03, 0.0)
UNEVEN = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03)}
COMMANDS = [Twist(0.3, 0.0, 0.0), Twist(0.3, 0.1, 0.3), Twist(0.2, -0.1, 0.0)]


def course(floor=(), frame=ORIGIN, scale=1.0, obj=None, step=1e-3):
    """Push across a floor; return the truths, and the plant."""
    obj = obj or box(**UNEVEN)
    plant = Plant(obj, ramp_robot(0.17), frame @ ORIGIN, frame @ START, step, floor=floor)
    plant.set_friction_factors([scale] * len(obj.supports))
    truths = []
    for command, _ in itertools.product(COMMANDS, range(10)):
        plant.advance(0.1, command)
        truths.append(plant.truth(0.0))
    return truths, plant


def poses(truths):
    """Return the object's poses, shape (n, 3)."""
    return np.array([truth.object_pose for truth in truths])


@pytest.mark.parametrize('edge', [0.0, 0.1])
def test_patch_under_everything_is_other_friction(edge):
    patch = FloorPatch(0.0, 0.0, 20.0, 20.0, 0.6, edge=edge)
    assert np.array_equal(poses(course([patch])[0]), poses(course(scale=0.6)[0]))
    halves = [FloorPatch(0.0, 0.0, 20.0, 20.0, 0.2), FloorPatch(0.0, 0.0, 30.0, 30.0, 3.0)]
    assert poses(course(halves)[0]) == pytest.approx(poses(course(scale=0.6)[0]), abs=1e-9)


def test_patch_elsewhere_changes_nothing():
    away = FloorPatch(0.0, 5.0, 2.0, 2.0, 0.1, edge=0.1)
    assert np.array_equal(poses(course([away])[0]), poses(course()[0]))


@pytest.mark.parametrize('side, factor', [(1, 0.3), (-1, 0.3), (1, 3.0), (-1, 3.0)])
def test_half_floor_rotates_the_object_towards_the_rougher_side(side, factor):
    patch = FloorPatch(0.0, side * 5.0, 20.0, 10.0, factor)
    plant = Plant(box(contact_friction_coefficient=2.0), ramp_robot(0.17), ORIGIN,
                  Pose(-0.37, 0.0, 0.0), floor=[patch])
    plant.advance(1.0, Twist(0.3, 0.0, 0.0))
    assert plant.object_pose.theta * side * (factor - 1.0) > 0.05


def test_mirrored_floor_gives_the_mirrored_push():
    ends = []
    for side in (1, -1):
        floor = [FloorPatch(0.3, side * 0.1, 0.4, 0.3, 0.2, side * 0.4, 0.05)]
        plant = Plant(box(), ramp_robot(0.17), ORIGIN, Pose(-0.37, side * 0.03, 0.0), floor=floor)
        for command in COMMANDS:
            plant.advance(1.0, Twist(command.v_x, side * command.v_y, side * command.omega))
        ends.append(plant.object_pose)
    assert abs(ends[0].theta) > 0.1
    assert ends[1] == pytest.approx((ends[0].x, -ends[0].y, -ends[0].theta), abs=1e-9)


def test_rotated_floor_gives_the_rotated_push():
    frame = Pose(0.3, -0.7, 2.1)
    place = Pose(0.3, 0.1, 0.4)
    moved = frame @ place
    one, two = (course([FloorPatch(p.x, p.y, 0.4, 0.3, 0.2, p.theta, edge=0.05)], moving)[0]
                for p, moving in ((place, ORIGIN), (moved, frame)))
    expected = [frame @ truth.object_pose for truth in one]
    assert poses(two) == pytest.approx(np.array(expected), abs=1e-9)
    assert np.abs(poses(one) - poses(course()[0])).max() > 1e-2


@pytest.mark.parametrize('edge', [0.0, 0.05])
@pytest.mark.parametrize('obj', [box(**UNEVEN), bin_()], ids=['box', 'bin'])
def test_energy_closes_and_supports_rub_as_the_floor_under_them_does(obj, edge):
    patches = [FloorPatch(0.25, 0.05, 0.4, 0.25, 0.3, 0.5, edge)]
    truths, plant = course(patches, obj=obj)
    energy = truths[-1].energy
    assert energy.work == pytest.approx(sum(energy[1:]), rel=1e-9) and energy.work > 0.3
    losses = np.diff([truth.energy.support_loss for truth in truths])
    assert losses.min() >= 0.0
    seen, rows = set(), kernel_array(floor_rows(patches))
    for truth in truths[5:]:
        for support, force, capacity in zip(obj.supports, truth.support_forces, obj.capacities):
            place = truth.object_pose.transform((support.x, support.y))
            factor = friction_factor_at(rows, *place)
            near = [friction_factor_at(rows, place[0] + x, place[1] + y)
                    for x in (-1e-3, 1e-3) for y in (-1e-3, 1e-3)]
            if max(near) - min(near) < 1e-9:
                seen.add(round(factor, 6))
                assert math.hypot(*force) <= 1.002 * factor * capacity
    assert {0.3, 1.0} <= seen


def test_smooth_edges_tend_to_the_sharp_one_and_the_step_to_0():
    floors = [[FloorPatch(0.25, 0.05, 0.4, 0.25, 0.3, 0.5, edge)] for edge in (0.1, 0.01, 0.0)]
    smooth, narrow, sharp = (poses(course(floor)[0])[-1] for floor in floors)
    assert np.abs(narrow - sharp).max() < 0.3 * np.abs(smooth - sharp).max()
    ends = [poses(course(floors[0], step=step)[0])[-1] for step in (4e-3, 1e-3, 2.5e-4)]
    assert np.abs(ends[1] - ends[2]).max() < 0.4 * np.abs(ends[0] - ends[2]).max()
    assert np.abs(ends[1] - ends[2]).max() < 2e-4


def test_simulation_has_the_floor_of_its_settings():
    patch = FloorPatch(0.0, 5.0, 20.0, 10.0, 0.3)
    rotations = []
    for patches in ((), (patch,)):
        settings = SimulationSettings(floor_patches=patches)
        sim = Simulation(box(), ramp_robot(0.17), ORIGIN, Pose(-0.37, 0.0, 0.0), settings)
        while sim.time < 1.0:
            sim.next_measurement()
            sim.command(Twist(0.3, 0.0, 0.0))
        rotations.append(sim.truth.object_pose.theta)
    assert rotations[0] == pytest.approx(0.0, abs=1e-9) and rotations[1] < -0.05
    with pytest.raises(ValueError, match='floor_patches: got 3.0, expected a FloorPatch'):
        SimulationSettings(floor_patches=(3,))
    with pytest.raises(ValueError, match='FloorPatch.length'):
        FloorPatch(0.0, 0.0, 0.0, 1.0, 0.5)
