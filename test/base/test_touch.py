"""A touch: what is planted in radius, tracker and wheels is found, and no more than that."""

import dataclasses
import math

from benchmarks.calibration.touches import good_touch, ROBOT, TOLERANCE, touch_object
from push_base.calibration.findings import find_faults, Finding
from push_base.calibration.recording_file import from_csv, to_csv
from push_base.calibration.report import files, summary
from push_base.calibration.touch import evaluate_touches
from push_model.files.mapping import from_mapping, Location
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
import pytest
import yaml

pytestmark = pytest.mark.slow
OF_RADIUS = [-0.01, 0.01]
# Pushes with 10 N, and an object that needs 20 N.
WEAK = dataclasses.replace(ROBOT, max_push_force=10.0)


def heavy(**changes):
    """Return a touch of an object that needs 20 N."""
    touch = good_touch(**changes)
    return touch._replace(obj=dataclasses.replace(touch.obj, mass=6.8))


def with_radius(error):
    """Return a robot whose radius is not as stated."""
    return dataclasses.replace(ROBOT, radius=ROBOT.radius + error)


@pytest.mark.parametrize('sides', [1, 2])
@pytest.mark.parametrize('has_tracker', [True, False])
@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_nothing_is_found_where_all_is_as_stated(drive, has_tracker, sides):
    """And the object has moved by the push."""
    robot = dataclasses.replace(ROBOT, drive=drive)
    calibration, simulation = touch_object(good_touch(
        robot=robot, true_robot=robot, has_tracker=has_tracker, sides=sides))
    assert find_faults(calibration) == []
    assert len(calibration.touches.touches) == sides
    assert all(touch.object_ratio > 0.9 for touch in calibration.touches.touches)
    assert simulation.plant.truth(simulation.time).force_n == 0.0


@pytest.mark.parametrize('error', OF_RADIUS)
def test_a_wrong_radius_is_found_from_two_sides(error):
    """To three millimetres; poses are not blamed."""
    calibration, _ = touch_object(good_touch(true_robot=with_radius(error)))
    assert find_faults(calibration) == [Finding.SIZE_WRONG]
    assert calibration.touches.size_error.value == pytest.approx(error, abs=TOLERANCE)
    assert abs(calibration.touches.pose_offset.value) < TOLERANCE


@pytest.mark.parametrize('offset', [0.008, -0.008])
def test_an_offset_of_the_tracker_is_found_from_two_sides(offset):
    """To three millimetres; the radius is not blamed."""
    calibration, _ = touch_object(good_touch(offset=(offset, 0.0)))
    assert find_faults(calibration) == [Finding.POSES_OFFSET]
    direction = calibration.touches.touches[0].direction
    assert abs(math.sin(direction)) < 1e-9
    assert calibration.touches.pose_offset.value == pytest.approx(
        offset * math.cos(direction), abs=TOLERANCE)
    assert abs(calibration.touches.size_error.value) < TOLERANCE


@pytest.mark.parametrize('error', OF_RADIUS)
def test_one_side_does_not_tell_radius_from_offset(error):
    """Only their sum is stated, and the finding says so."""
    radius, _ = touch_object(good_touch(true_robot=with_radius(error), sides=1))
    offset, _ = touch_object(good_touch(offset=(error, 0.0), sides=1))
    for calibration in (radius, offset):
        assert find_faults(calibration) == [Finding.SIZE_OR_OFFSET]
        result = calibration.touches
        assert result.size_error is None and result.pose_offset is None
        assert result.combined.value == pytest.approx(error, abs=TOLERANCE)


def test_an_offset_across_the_push_is_not_claimed():
    """It cannot be seen."""
    calibration, _ = touch_object(good_touch(offset=(0.0, 0.008)))
    assert find_faults(calibration) == []


def test_stamps_that_are_late_are_found_and_spoil_nothing_else():
    """As the gap is measured at rest."""
    calibration, _ = touch_object(good_touch(stamp_delay=0.07))
    assert find_faults(calibration) == [Finding.STAMPS_SHIFTED]
    assert calibration.touches.stamp_delay.value == pytest.approx(0.07, abs=0.02)


@pytest.mark.parametrize('has_tracker', [True, False])
def test_a_base_that_spins_is_called_too_weak(has_tracker):
    """In words, with the force; it goes no further, and the files warn of the object."""
    calibration, _ = touch_object(heavy(true_robot=WEAK, has_tracker=has_tracker))
    assert find_faults(calibration) == [Finding.TOO_WEAK]
    assert len(calibration.touches.touches) == 1
    text = summary(calibration)
    assert 'force needed             20 N as stated' in text
    assert 'The wheels spin' in text
    values = yaml.safe_load(files(calibration)['robot.yaml'])
    robot = from_mapping(RoundRobot, values, Location('robot.yaml'))
    assert 10.0 < robot.max_push_force < 20.0


def test_a_base_that_is_strong_enough_is_not():
    """The same object, and 25 N."""
    strong = dataclasses.replace(ROBOT, max_push_force=25.0)
    calibration, _ = touch_object(heavy(true_robot=strong))
    assert find_faults(calibration) == []


def test_wheels_that_creep_are_found():
    """A fifth of the way, at 9 N."""
    calibration, _ = touch_object(good_touch(wheel_creep=0.025))
    assert find_faults(calibration) == [Finding.WHEELS_SLIP]


def test_poses_of_another_object_are_found():
    """The robot moves on in the world, and the pose stands."""
    calibration, simulation = touch_object(good_touch(sides=1))
    recording = calibration.full_recording
    first = recording.object_poses[0].measured.pose
    recording.object_poses[:] = [
        item._replace(measured=item.measured._replace(pose=first))
        for item in recording.object_poses]
    result = evaluate_touches(recording)
    assert [touch.is_object_unseen for touch in result.touches] == [True]
    assert not result.is_too_weak
    assert result.combined is None


def test_a_touch_is_read_again_from_its_recording():
    """Object and pushes."""
    calibration, _ = touch_object(good_touch(sides=1))
    again = evaluate_touches(from_csv(to_csv(calibration.full_recording)))
    assert again == calibration.touches


def test_without_poses_nothing_is_touched():
    """The object stands as it stood, and the report says so."""
    touch = good_touch(offset=(30.0, 0.0))
    calibration, simulation = touch_object(touch)
    assert calibration.touches is None
    assert simulation.plant.object_pose == pytest.approx(Pose(1.3, 0.7, 0.6))
    assert 'touch' in summary(calibration) and 'not done' in summary(calibration)
