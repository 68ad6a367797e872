"""Displacements of the object that the robot cannot have caused, told from pushes."""

import math

import numpy as np
from push_control.perception.displacement import (
    Displacement, DisplacementWatch, MAX_EXCURSION,
)
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose
import pytest

SHIFT = Pose(0.25, -0.1, 0.6)


def judged(poses, driven=0.0, period=0.05):
    """Show poses one after the other; return how each step is judged."""
    watch, found = DisplacementWatch(), []
    for i, pose in enumerate(poses):
        watch.drive(driven)
        found.append(watch.update(ObjectPose(period * i, pose), i))
    return found


@pytest.mark.parametrize('period', [0.03, 0.3, 1.0])
@pytest.mark.parametrize('lever', [0.1, 0.3])
def test_what_a_robot_pushes_is_never_displaced(lever, period):
    """However long no pose comes, with noise, and turned by the shortest of levers."""
    rng, speed = np.random.default_rng(1), 0.3
    poses = []
    for i in range(100):
        x, y, theta = rng.normal(0.0, 0.01, 3)
        path = speed * period * i
        poses.append(Pose(path + x, y, wrap_angle(path / lever + theta)))
    assert set(judged(poses, speed * period, period)) == {Displacement.NONE}


@pytest.mark.parametrize('heading', [0.0, 3.0])
def test_an_object_that_comes_back_by_the_same_displacement_was_never_away(heading):
    """Wherever it was pushed to meanwhile, and whatever its heading; once, and not for long."""
    def moved(pose):
        return Pose(pose.x + SHIFT.x, pose.y + SHIFT.y, wrap_angle(pose.theta + SHIFT.theta))
    start = Pose(1.0, 2.0, heading)
    pushed = Pose(1.1, 2.05, wrap_angle(heading + 0.1))
    away = [moved(start), moved(pushed)]
    found = judged([start, *away, pushed, moved(pushed)], driven=0.03)
    assert found == [Displacement.NONE, Displacement.DISPLACED, Displacement.NONE,
                     Displacement.RETURNED, Displacement.DISPLACED]
    assert judged([start, *away, pushed], 0.03, MAX_EXCURSION)[-1] is Displacement.DISPLACED


def test_a_rotation_alone_is_a_displacement_too():
    """As of a tracker that confuses two sides."""
    turned = Pose(0.0, 0.0, math.pi)
    found = judged([Pose(0.0, 0.0, 0.0), turned, Pose(0.0, 0.0, 0.0)])
    assert found[1:] == [Displacement.DISPLACED, Displacement.RETURNED]


def random_pose(rng: np.random.Generator) -> Pose:
    """Draw a pose, metres and radians from the origin."""
    return Pose(*rng.uniform(-3.0, 3.0, 3).tolist())


@pytest.mark.parametrize('seed', range(5))
def test_an_object_that_is_seen_where_it_was_has_never_been_away(seed: int) -> None:
    """Wherever a tracker had it meanwhile; what is remembered is of before that."""
    rng, watch = np.random.default_rng(seed), DisplacementWatch[int]()
    start = random_pose(rng)
    assert watch.update(ObjectPose(0.0, start), -1) is Displacement.NONE
    assert watch.update(ObjectPose(0.05, start), 7) is Displacement.NONE
    for i in range(4):
        away = random_pose(rng)
        assert watch.update(ObjectPose(0.1 + i, away), 8 + i) is Displacement.DISPLACED
        assert watch.shift is not None
    assert watch.update(ObjectPose(5.0, start), 20) is Displacement.RETURNED
    assert watch.memory == 8 and watch.shift is None


@pytest.mark.parametrize('is_rejected, expected', [
    (True, Displacement.DISPLACED), (False, Displacement.NONE)])
def test_what_is_driven_after_a_pose_that_is_rejected_moves_nothing(
        is_rejected: bool, expected: Displacement) -> None:
    """The object was elsewhere by then; a robot that drives on has not pushed it there."""
    watch = DisplacementWatch[None]()
    watch.update(ObjectPose(0.0, Pose(0.0, 0.0, 0.0)), None)
    for _ in range(3):
        watch.drive(0.03)
        if is_rejected:
            watch.reject()
    assert watch.update(ObjectPose(0.15, Pose(0.3, 0.0, 0.0)), None) is expected


def test_an_object_that_was_pushed_while_its_tracker_erred_is_not_away() -> None:
    """It is no further from where it was than the robot has driven."""
    watch = DisplacementWatch[int]()
    watch.update(ObjectPose(0.0, Pose(0.0, 0.0, 0.0)), 1)
    assert watch.update(ObjectPose(0.1, Pose(0.0, 2.0, 0.0)), 2) is Displacement.DISPLACED
    watch.drive(0.3)
    assert watch.update(ObjectPose(2.0, Pose(0.0, 2.0, 0.0)), 3) is Displacement.NONE
    assert watch.update(ObjectPose(2.1, Pose(0.4, 0.0, 0.5)), 4) is Displacement.RETURNED
    assert watch.memory == 2
