"""Identification from recordings of the plant, whose friction is known."""

import dataclasses

from helpers.recorded_pushes import record_pushes
import numpy as np
from push_control.identification.identification import (
    changed_supports, friction_patterns, identify, NAMES,
)
from push_control.identification.recorded_push import RecordedPush, touching_path
from push_model.analysis.sliding_contact import SupportArrays
from push_model.analysis.slow_push import Shape
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object, read_robot
from push_model.friction import friction_center
from push_model.parameters import Support
from push_scenario.recordings.segmentation import split_pushes
import pytest

BOX = read_object(config_file('objects/box_04.yaml'))
ROBOT = read_robot(config_file('robots/holonomic_017.yaml'))


def mean_square(obj):
    """Mean square distance of the supports from the centre of friction."""
    positions, capacities = SupportArrays.of(obj)
    offsets = positions - np.array(friction_center(obj))
    return capacities @ (offsets ** 2).sum(axis=1) / capacities.sum()


def uneven_box(rng):
    """Make a box whose feet, spread and contact differ from the nominal ones."""
    spread = rng.uniform(0.8, 1.15)
    supports = tuple(Support(spread * support.x, spread * support.y,
                             0.3 * float(1.0 + rng.uniform(-0.4, 0.4)))
                     for support in BOX.supports)
    return dataclasses.replace(BOX, supports=supports,
                               contact_friction_coefficient=float(rng.uniform(0.3, 0.7)))


@pytest.mark.slow
@pytest.mark.physics
def test_intervals_cover_the_friction_of_the_plant():
    """Three objects, four numbers each; one of twelve may be outside of its interval."""
    covered = 0
    for seed in range(3):
        rng = np.random.default_rng(100 + seed)
        true = uneven_box(rng)
        found = identify(BOX, ROBOT.radius,
                         split_pushes(BOX, ROBOT, *record_pushes(true, ROBOT, rng)))
        assert found.pushes == 10 and 1 <= found.sliding <= 8
        truth = (*friction_center(true), mean_square(true) / mean_square(BOX),
                 true.contact_friction_coefficient)
        for name, number in zip(NAMES, truth):
            interval = getattr(found, name)
            covered += interval.covers(number)
            # And they tell something: a fifth of what was believed.
            assert interval.high - interval.low < (0.03 if 'center' in name else 0.3)
        assert friction_center(found.object) == pytest.approx(
            (found.friction_center_x.value, found.friction_center_y.value), abs=1e-9)
        assert mean_square(found.object) / mean_square(BOX) == pytest.approx(
            found.c_squared_ratio.value, rel=1e-6)
    assert covered >= 11


def test_changed_supports_have_the_friction_center_that_is_asked_for():
    center = np.array((0.02, -0.03))
    positions, capacities = changed_supports(BOX, np.array([*center, np.log(1.3), 0.0, 0.2]))
    assert capacities @ positions / capacities.sum() == pytest.approx(center)
    assert capacities.sum() == pytest.approx(sum(BOX.capacities))
    pattern = friction_patterns(*SupportArrays.of(BOX))
    assert pattern.shape == (4, 1)
    assert np.abs(pattern[:, 0]) == pytest.approx(1.0)


def test_pushes_that_never_slide_leave_the_contact_friction_open():
    """Straight pushes through the middle tell neither c^2 nor contact friction."""
    path = np.column_stack([np.linspace(-0.371, -0.27, 20), np.zeros(20), np.zeros(20)])
    push = RecordedPush(np.zeros(3), np.array([0.1, 0.0, 0.0]), path)
    found = identify(BOX, 0.17, [push] * 3)
    assert found.sliding == 0
    assert found.contact_friction.low < 0.3 and found.contact_friction.high > 1.0
    with pytest.raises(ValueError, match='pushes: got 2, expected at least 3'):
        identify(BOX, 0.17, [push] * 2)
    with pytest.raises(ValueError, match='free: got mass, expected some of'):
        identify(BOX, 0.17, [push] * 3, ['mass'])


def test_a_path_is_shifted_along_the_normal_until_it_touches():
    shape, pose = Shape.of(BOX), np.zeros(3)
    for x in (-0.38, -0.36):
        path = np.array([[-0.5, 0.05, 0.0], [x, 0.05, 0.0]])
        shifted = touching_path(shape, 0.17, pose, path, -1)
        assert shifted[-1] == pytest.approx((-0.37, 0.05, 0.0))
        assert shifted[0] == pytest.approx((-0.5 - 0.37 - x, 0.05, 0.0))
