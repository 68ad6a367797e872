"""
Poses that cannot be true are held back; those of an object that was moved are not.

Headings that a tracker confuses are told from motions.
"""

import dataclasses
import math

from helpers.objects import box
import numpy as np
from push_model.events import PushEvent
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, PoseCovariance
from push_safety.pose_check import NOISE_STEPS, PoseCheck, rotational_symmetry
from push_safety.tolerances import AGREEING_MESSAGES
import pytest

PERIOD = 0.05
STEPS = NOISE_STEPS + 5
SQUARE = box()
CARTON = dataclasses.replace(SQUARE, outline=((-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)))
WEDGE = dataclasses.replace(SQUARE, outline=((-0.3, -0.2), (0.3, -0.2), (0.1, 0.2), (-0.3, 0.2)))


def noisy(seed, speed=0.0, noise=0.002):
    """Measure an object with noise; poses of one second and a half."""
    rng = np.random.default_rng(seed)
    return [ObjectPose(i * PERIOD, Pose(*(rng.standard_normal(3) * noise
                                          + (speed * i * PERIOD, 0.0, 0.0)).tolist()))
            for i in range(STEPS)]


def checked(check, poses):
    """Let a check evaluate poses; return the last one that passes."""
    return [check.check(pose) for pose in poses][-1]


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('noise', [0.0, 0.002, 0.02])
def test_poses_with_noise_pass(seed, noise):
    """Of an object at rest as of one that is pushed, however noisy they are."""
    for speed in (0.0, 0.3):
        check = PoseCheck(WEDGE)
        for pose in noisy(seed, speed, noise):
            assert check.check(pose) == pose and check.fault is None


def test_an_outlier_is_held_back_and_an_object_that_was_moved_is_not():
    """Until some poses agree."""
    check, poses = PoseCheck(WEDGE), noisy(1)
    last = checked(check, poses)
    far = last._replace(time=last.time + PERIOD, pose=Pose(1.0, 0.0, 0.0))
    assert check.check(far) == last
    assert check.fault.code is PushEvent.OBJECT_POSE_JUMPS
    assert check.fault.values['distance'] == pytest.approx(1.0, abs=0.01)
    back = last._replace(time=far.time + PERIOD)
    assert check.check(back) == back and check.fault is None
    moved = [far._replace(time=back.time + (i + 1) * PERIOD) for i in range(AGREEING_MESSAGES)]
    judged = [check.check(pose) for pose in moved]
    assert judged == [back] * (AGREEING_MESSAGES - 1) + [moved[-1]] and check.fault is None


def test_garbage_hardly_ever_passes():
    """Only by accident: where it is near the last pose."""
    check, rng = PoseCheck(WEDGE), np.random.default_rng(1)
    last = checked(check, noisy(1))
    garbage = [ObjectPose(last.time + (i + 1) * PERIOD, Pose(*rng.uniform(-3.0, 3.0, 3)))
               for i in range(200)]
    assert sum(check.check(pose) == pose for pose in garbage) <= 1


def test_a_noisy_tracker_that_repeats_a_pose_is_frozen():
    """With fresh stamps; one without noise may repeat as often as it likes."""
    for noise, is_frozen in ((0.002, True), (0.0, False)):
        check = PoseCheck(WEDGE)
        last = checked(check, noisy(1, noise=noise))
        again = [last._replace(time=last.time + (i + 1) * PERIOD) for i in range(20)]
        passed = checked(check, again)
        assert (passed != again[-1]) is is_frozen
        assert (check.fault is not None) is is_frozen
        fresh = ObjectPose(again[-1].time + PERIOD, Pose(0.001, 0.002, 0.003))
        assert check.check(fresh) == fresh and check.fault is None


@pytest.mark.parametrize('obj, count', [(SQUARE, 4), (CARTON, 2), (WEDGE, 1)])
def test_an_outline_looks_the_same_in_some_headings(obj, count):
    """As often as it is symmetric about its origin."""
    assert rotational_symmetry(obj) == count


def headings(check, measured, step=0.05, motion=0.0):
    """Measure headings one after the other; return those that pass."""
    return [check.check(ObjectPose(step * i, Pose(motion * i, 0.0, wrap_angle(heading))))
            .pose.theta for i, heading in enumerate(measured)]


@pytest.mark.parametrize('multiple', [1, 2, 3])
def test_a_jump_of_the_heading_is_taken_back_for_as_long_as_it_lasts(multiple):
    """While the object is rotated slowly; and nothing is left of it in the end."""
    true = [0.02 * i for i in range(60)]
    seen = [heading + (0.5 * math.pi * multiple if 20 <= i < 40 else 0.0)
            for i, heading in enumerate(true)]
    check = PoseCheck(SQUARE)
    assert headings(check, seen[:30]) == pytest.approx(true[:30])
    assert wrap_angle(check.heading_jump - 0.5 * math.pi * multiple) == pytest.approx(0.0)
    assert headings(PoseCheck(SQUARE), seen) == pytest.approx(true)
    # Where every heading looks different it is a pose that cannot be true.
    check = PoseCheck(SQUARE, heading_count=1)
    assert headings(check, seen[:21])[-1] == pytest.approx(true[19])
    assert check.heading_jump == 0.0 and check.fault is not None


def test_a_relative_pose_loses_the_same_jump_and_keeps_its_place():
    check = PoseCheck(SQUARE)
    seen = Pose(0.5, 0.1, 0.3)
    covariance = PoseCovariance.from_deviations(0.01, 0.02)
    first = ObjectPose(0.0, Pose(1.0, 2.0, 0.4), covariance, seen)
    assert check.check(first) == first
    turned = first._replace(time=PERIOD, pose=Pose(1.0, 2.0, 0.4 + 0.5 * math.pi),
                            relative=Pose(0.5, 0.1, 0.3 + 0.5 * math.pi))
    answer = check.check(turned)
    assert answer.relative.theta == pytest.approx(seen.theta)
    assert answer.relative[:2] == seen[:2] and answer.covariance == covariance
    assert answer.pose.theta == pytest.approx(0.4)


@pytest.mark.parametrize('rotation', [0.3, 0.8, 1.2])
def test_an_object_that_is_rotated_otherwise_has_been_moved(rotation):
    """No tracker confuses these headings."""
    seen = [0.0, 0.0, rotation, rotation, rotation]
    check = PoseCheck(SQUARE)
    assert headings(check, seen)[-1] == pytest.approx(rotation) and check.heading_jump == 0.0


def test_an_object_that_is_elsewhere_has_been_moved():
    """Somebody has carried it, and put it down with another heading."""
    seen = [0.0, 0.5 * math.pi]
    assert headings(PoseCheck(SQUARE), seen, step=0.9, motion=0.3) == pytest.approx(seen)
