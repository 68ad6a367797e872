"""Identification from recordings of the plant, whose friction is known."""

import dataclasses

from benchmarks.identification.__main__ import NAMES, run_case
import numpy as np
from push_control.identification.friction_changes import (
    changed_loaded_supports, changed_supports, friction_patterns, identified_object,
    nominal_unknowns,
)
from push_control.identification.identification import (
    identify, identify_together, PushedRecording,
)
from push_control.identification.push_set import POINTS
from push_control.identification.recorded_push import RecordedPush, touching_path
from push_model.analysis.sliding_contact import SupportArrays
from push_model.analysis.slow_push import integrate_slow_pushes, LoadedSupports, Shape
from push_model.files.data import config_file
from push_model.files.parameter_files import read_object
from push_model.friction import with_friction_center
import pytest

BOX = read_object(config_file('objects/box_04.yaml'))
RADIUS = 0.17
# Offset from the middle of the face behind [m] and direction [rad] of five pushes of 0.1 m.
PUSHES = ((0.1, 0.0), (-0.08, 0.2), (0.05, -0.6), (-0.1, 0.7), (0.0, 0.65))


def slow_pushes(obj, pushes=PUSHES):
    """Integrate pushes of an object along its x, as if they were recorded without an error."""
    travel = np.linspace(0.0, 0.1, POINTS)
    paths = np.array([np.column_stack([-0.37 + travel * np.cos(angle),
                                       offset + travel * np.sin(angle), np.zeros(POINTS)])
                      for offset, angle in pushes])
    starts = np.zeros((len(pushes), 3))
    ends = integrate_slow_pushes(Shape.of(obj), LoadedSupports.of(obj),
                                 obj.contact_friction_coefficient, RADIUS, starts, paths)
    return [RecordedPush(*push) for push in zip(starts, ends.poses[:, -1], paths)]


@pytest.mark.slow
@pytest.mark.physics
def test_intervals_cover_the_friction_of_the_plant():
    """A box that is pushed 45 mm above the floor, with noise."""
    case = run_case(2)
    assert case.contact_height > 0.04
    assert sum(case.covered) >= len(NAMES) - 1
    # And the values tell something: a fifth of what is unknown before.
    assert np.abs(case.errors[:2]).max() < 0.005 and np.abs(case.errors[2:]).max() < 0.06


def test_objects_pushed_by_one_robot_share_the_contact_friction():
    """The first object is pushed straight only: the second tells its contact friction."""
    true = dataclasses.replace(BOX, contact_friction_coefficient=0.4)
    straight, all_pushes = slow_pushes(true, PUSHES[:3]), slow_pushes(true)
    first, second = identify_together(
        [PushedRecording(BOX, straight), PushedRecording(BOX, all_pushes)], RADIUS)
    assert first.contact_friction == second.contact_friction
    assert first.contact_friction.value == pytest.approx(0.4, rel=0.02)
    assert first.object.contact_friction_coefficient == first.contact_friction.value
    assert (first.pushes, second.pushes) == (3, 5)
    # Nothing says that friction on the floor is not as statics has it.
    assert not first.is_free and not second.is_free


def test_friction_is_freed_where_pushes_say_so_but_not_by_a_single_one():
    true = with_friction_center(BOX, (0.05, -0.07))
    freed = identify(BOX, RADIUS, slow_pushes(true))
    assert freed.is_free
    assert (freed.friction_center_x.value, freed.friction_center_y.value) == pytest.approx(
        (0.05, -0.07), abs=4e-3)
    pushes = slow_pushes(BOX)
    pushes[0] = slow_pushes(true)[0]
    assert not identify(BOX, RADIUS, pushes).is_free


@pytest.mark.slow
def test_the_height_of_the_contact_counts():
    """Without the height another c^2 explains the pushes; with it the nominal one does."""
    high = dataclasses.replace(BOX, contact_height=0.15, center_of_mass_height=0.2)
    pushes = slow_pushes(high)
    ignoring, knowing = identify(BOX, RADIUS, pushes), identify(high, RADIUS, pushes)
    assert knowing.c_squared_ratio.value == pytest.approx(1.0, abs=0.01)
    assert abs(ignoring.c_squared_ratio.value - 1.0) > 0.03
    assert knowing.object.contact_height == 0.15


def test_an_identified_object_has_the_supports_that_were_integrated():
    high = dataclasses.replace(BOX, contact_height=0.1)
    unknowns = nominal_unknowns(high) + (0.01, 0.0, 0.0, 0.1, 0.2, 0.1)
    changed = changed_loaded_supports(high, unknowns)
    found = LoadedSupports.of(identified_object(high, unknowns))
    assert found.at_rest.capacities == pytest.approx(changed.at_rest.capacities)
    assert found.shifts == pytest.approx(changed.shifts)
    assert found.at_rest.capacities.sum() == pytest.approx(np.exp(0.2) * sum(BOX.capacities))


def test_changed_supports_have_the_friction_center_that_is_asked_for():
    center = np.array((0.02, -0.03))
    positions, capacities = changed_supports(BOX, np.array([*center, np.log(1.3), 0.0, 0.0, 0.2]))
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


def test_a_path_is_shifted_along_the_normal_until_it_touches():
    shape, pose = Shape.of(BOX), np.zeros(3)
    for x in (-0.38, -0.36):
        path = np.array([[-0.5, 0.05, 0.0], [x, 0.05, 0.0]])
        shifted = touching_path(shape, 0.17, pose, path, -1)
        assert shifted[-1] == pytest.approx((-0.37, 0.05, 0.0))
        assert shifted[0] == pytest.approx((-0.5 - 0.37 - x, 0.05, 0.0))
