"""Poses that cannot be true are held back; those of an object that was moved are not."""

import numpy as np
from push_control.events import PushEvent
from push_control.safety.pose_check import AGREEING_COUNT, NOISE_STEPS, PoseCheck
from push_model.geometry import Pose
from push_model.signals import ObjectPose
import pytest

PERIOD = 0.05
STEPS = NOISE_STEPS + 5


def noisy(seed, speed=0.0, noise=0.002):
    """Measure an object with noise; poses of one second and a half."""
    rng = np.random.default_rng(seed)
    return [ObjectPose(i * PERIOD, Pose(*(rng.standard_normal(3) * noise
                                          + (speed * i * PERIOD, 0.0, 0.0)).tolist()))
            for i in range(STEPS)]


def checked(check, poses):
    """Let a check judge poses; return the last one that is believed."""
    return [check.believed(pose) for pose in poses][-1]


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('noise', [0.0, 0.002, 0.02])
def test_poses_with_noise_are_believed(seed, noise):
    """Of an object at rest as of one that is pushed, however noisy they are."""
    for speed in (0.0, 0.3):
        check = PoseCheck()
        for pose in noisy(seed, speed, noise):
            assert check.believed(pose) is pose and check.doubt is None


def test_an_outlier_is_held_back_and_an_object_that_was_moved_is_not():
    """Until some poses agree."""
    check, poses = PoseCheck(), noisy(1)
    last = checked(check, poses)
    far = last._replace(time=last.time + PERIOD, pose=Pose(1.0, 0.0, 0.0))
    assert check.believed(far) is last
    assert check.doubt.reason is PushEvent.OBJECT_POSE_JUMPS
    assert check.doubt.values['distance'] == pytest.approx(1.0, abs=0.01)
    back = last._replace(time=far.time + PERIOD)
    assert check.believed(back) is back and check.doubt is None
    moved = [far._replace(time=back.time + (i + 1) * PERIOD) for i in range(AGREEING_COUNT)]
    judged = [check.believed(pose) for pose in moved]
    assert judged == [back] * (AGREEING_COUNT - 1) + [moved[-1]] and check.doubt is None


def test_garbage_is_hardly_ever_believed():
    """Only by accident: where it is near the last pose."""
    check, rng = PoseCheck(), np.random.default_rng(1)
    last = checked(check, noisy(1))
    garbage = [ObjectPose(last.time + (i + 1) * PERIOD, Pose(*rng.uniform(-3.0, 3.0, 3)))
               for i in range(200)]
    assert sum(check.believed(pose) is pose for pose in garbage) <= 1


def test_a_noisy_tracker_that_repeats_a_pose_is_frozen():
    """With fresh stamps; one without noise may repeat as often as it likes."""
    for noise, is_frozen in ((0.002, True), (0.0, False)):
        check = PoseCheck()
        last = checked(check, noisy(1, noise=noise))
        again = [last._replace(time=last.time + (i + 1) * PERIOD) for i in range(20)]
        believed = checked(check, again)
        assert (believed is not again[-1]) is is_frozen
        assert (check.doubt is not None) is is_frozen
        fresh = ObjectPose(again[-1].time + PERIOD, Pose(0.001, 0.002, 0.003))
        assert check.believed(fresh) is fresh and check.doubt is None
