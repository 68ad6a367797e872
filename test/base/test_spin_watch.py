"""Wheels that spin at an object are told from good pushes and from faults of trackers."""

import math

from helpers.objects import box
import numpy as np
from push_base.push_force import force_warning
from push_base.spin_watch import MEMORY, SpinWatch
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose
import pytest

PERIOD, SPEED = 0.02, 0.15


def watched(object_pose, seconds=3.0, noise=0.002, latency=0.08, seed=0):
    """
    Return whether wheels spun, the object crept, or the push was without effect, at any time.

    Behind them are whether it was hindered at the end, without and with spinning before.

    :param object_pose: function of what the wheels have driven [m], in a frame where the robot
        pushes along x at the origin.
    """
    rng, watch = np.random.default_rng(seed), SpinWatch(object_pose(0.0))
    spun = crept = effectless = False
    for k in range(round(seconds / PERIOD)):
        time = PERIOD * k
        watch.add_distance(time, SPEED * time)
        if k % 3 == 0 and time >= latency:
            x, y, theta = object_pose(SPEED * (time - latency))
            e_x, e_y, e_theta = noise * rng.standard_normal(3) * (1.0, 1.0, 2.5)
            watch.add_object_pose(
                ObjectPose(time - latency, Pose(x + e_x, y + e_y, theta + e_theta)),
                (x - 0.2, y), 0.0, noise)
        spun, crept = spun or watch.is_spinning, crept or watch.is_creeping
        effectless = effectless or watch.is_without_effect
    return spun, crept, effectless, watch.is_hindered(False), watch.is_hindered(True)


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('ratio', [0.0, 0.15, 0.6, 0.9, 1.0])
def test_an_object_that_stops_while_the_wheels_turn_is_found(seed, ratio):
    """It moves for 5 cm, then by a part of what the wheels turn: below 0.3 that is spinning."""
    spun, *_ = watched(lambda s: Pose(min(s, 0.05) + ratio * max(0.0, s - 0.05), 0.0, 0.0),
                       seed=seed)
    assert spun == (ratio < 0.3)


@pytest.mark.parametrize('seed', range(10))
def test_a_long_arc_is_no_spinning(seed):
    """The object rotates about a point beside the contact, and goes on along the push."""
    radius = 0.5

    def along_arc(s):
        return Pose(radius * math.sin(s / radius), radius * (1.0 - math.cos(s / radius)),
                    0.5 * s / radius)

    assert not any(watched(along_arc, seed=seed))


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('pose', [lambda s: Pose(1.0, 2.0, 0.3), lambda s: Pose(-s, 0.0, 0.0),
                                  lambda s: Pose(0.0, s, 0.0)],
                         ids=['another object', 'mirrored', 'other axes'])
def test_a_fault_of_the_tracker_is_no_spinning(seed, pose):
    """The object does not move along the push at any time."""
    spun, crept, *_ = watched(pose, seed=seed)
    assert not (spun or crept)


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('ratio', [0.0, 0.02, 0.3, 0.6, 1.0])
def test_a_push_without_effect_is_found_however_the_object_seemed_to_move(seed, ratio):
    """One pose that is 3 cm off is no motion of an object that does not yield."""
    _, _, effectless, *_ = watched(
        lambda s: Pose(ratio * s + (0.03 if 0.2 < s < 0.21 else 0.0), 0.0, 0.0), seed=seed)
    assert effectless == (ratio < 0.1)


@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('ratio, expected', [
    (0.0, [True, True]), (0.2, [False, True]), (0.5, [False, False]), (1.0, [False, False])])
def test_a_short_push_that_ends_tells_whether_it_was_hindered(seed, ratio, expected):
    """Of wheels that have spun before, less motion of the object tells as much."""
    *_, at_first, once_more = watched(lambda s: Pose(ratio * s, 0.0, 0.0), seconds=0.8, seed=seed)
    assert [at_first, once_more] == expected


def test_the_first_centimetres_tell_nothing():
    """The object may not be touched yet."""
    *_, at_first, once_more = watched(lambda s: Pose(0.0, 0.0, 0.0), seconds=0.3)
    assert not (at_first or once_more)


@pytest.mark.parametrize('seed', range(10))
def test_an_object_that_creeps_by_millimetres_is_found(seed):
    """It never moves far enough to be seen in one pose."""
    _, crept, *_ = watched(lambda s: Pose(min(0.005, 0.05 * s), 0.0, 0.0), seed=seed)
    assert crept


def test_the_forces_are_compared_before_the_first_push():
    """A warning has both; where no force is stated there is none."""
    obj = box(mass=5.0)
    assert force_warning(obj, RoundRobot(0.17)) == ''
    assert force_warning(obj, RoundRobot(0.17, max_push_force=15.0)) == ''
    warning = force_warning(obj, RoundRobot(0.17, max_push_force=12.0))
    assert '15 N' in warning and '12 N' in warning


def test_what_is_kept_of_the_wheels_does_not_grow_with_the_push():
    """And a pose within the memory gets the distance that the wheels had driven by then."""
    rng, watch = np.random.default_rng(3), SpinWatch(Pose(0.0, 0.0, 0.0))
    times = np.cumsum(rng.uniform(0.01, 0.03, 5000))
    distances = np.cumsum(rng.uniform(0.0, 0.005, 5000))
    for k, (time, distance) in enumerate(zip(times.tolist(), distances.tolist())):
        watch.add_distance(time, distance)
        seen = time - float(rng.uniform(0.0, MEMORY))
        if k % 50 == 0 and seen > times[0]:
            assert watch._driven_at(seen) == pytest.approx(
                float(np.interp(seen, times, distances)), abs=1e-12)
        assert len(watch._driven) <= MEMORY / 0.01 + 2


@pytest.mark.parametrize('ratio, expected', [
    (1.0, True), (0.85, True), (0.5, False), (0.0, False)])
def test_only_what_goes_with_the_wheels_has_followed(ratio, expected):
    """Whatever stops it later; wheels that spin leave it behind from the start."""
    watch = SpinWatch(Pose(0.0, 0.0, 0.0))
    for k in range(40):
        driven = 0.005 * k
        watch.add_distance(PERIOD * k, driven)
        watch.add_object_pose(ObjectPose(PERIOD * k, Pose(ratio * min(driven, 0.12), 0.0, 0.0)),
                              (ratio * min(driven, 0.12) - 0.2, 0.0), 0.0, 0.002)
    assert watch.has_followed == expected
