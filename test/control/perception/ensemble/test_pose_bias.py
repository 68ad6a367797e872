"""Bias of object poses: what views from several sides reveal of it, and what not."""

import dataclasses
import math

from helpers.ensemble_runs import CONTROL, difference, NO_NOISE, ROBOT
from helpers.objects import box
import numpy as np
from push_control.perception.ensemble.measurement_update import MAX_OUTLIERS
from push_control.perception.ensemble.pose_bias import PoseBias
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_sim_node.sensors import SensorSettings, ViewBias
import pytest

POSITION, HEADING = 0.011, math.radians(0.5)
BIASED = dataclasses.replace(CONTROL, pose_bias=POSITION, heading_bias=HEADING)
SENSORS = SensorSettings(pose_bias=0.03, pose_heading_bias=math.radians(1.0))
PLACE = Pose(0.7, -0.4, 2.5)
RADIUS, PERIOD, SPEED = 0.8, 0.1, 0.4


def bias(deviation=POSITION, heading_deviation=HEADING, count=4000):
    """Return the biases of many members."""
    return PoseBias(deviation, heading_deviation, count, np.random.default_rng(1))


def around(angle):
    """Return where a robot stands on a circle round the object, facing along it."""
    return PLACE @ Pose(RADIUS * math.cos(angle), RADIUS * math.sin(angle), angle + math.pi / 2)


class View:
    """An ensemble whose robot drives round an object at rest."""

    def __init__(self, error, seed=0):
        self.ensemble = PushEnsemble(box(), ROBOT, BIASED, NO_NOISE)
        self.error, self.rng = error, np.random.default_rng(seed)
        self.time = 0.0
        # Round the object [rad].
        self.angle = 0.0
        # Whether each pose was believed.
        self.believed = []

    def drive(self, rotation):
        """Drive on along the circle, or stand for a second, and see the object all the time."""
        steps = max(10, int(abs(rotation) * RADIUS / SPEED / PERIOD))
        for _ in range(steps):
            self.time += PERIOD
            self.angle += rotation / steps
            self.ensemble.predict(Odometry(self.time, around(self.angle), STOP))
            noise = self.rng.standard_normal(3) * (2e-3, 2e-3, 5e-3)
            x, y, theta = PLACE @ self.error(self.angle)
            measured = Pose(x + noise[0], y + noise[1], theta + noise[2])
            self.believed.append(self.ensemble.update(ObjectPose(self.time, measured)))
        return self

    @property
    def object_error(self):
        """Estimated less true pose of the object, shape (3,)."""
        return difference(self.ensemble.object_pose, PLACE)


def drawn_view(seed):
    """See an object with the bias of the simulator."""
    return View(ViewBias(SENSORS, np.random.default_rng(seed)).error, seed)


@pytest.mark.parametrize('angle', [0.0, 2.0])
def test_biases_have_the_stated_deviation_from_every_side(angle):
    """And none where none is stated."""
    robots = np.tile(np.array(around(angle)), (4000, 1))
    objects = np.tile(np.array(PLACE), (4000, 1))
    assert bias().errors(robots, objects).std(axis=0) == pytest.approx(
        [POSITION, POSITION, HEADING], rel=0.05)
    assert not bias(0.0, 0.0).exists and not bias(0.0, 0.0).errors(robots, objects).any()


def test_biases_turn_with_robot_and_object():
    """They belong to the object and to the side from which it is seen."""
    biases, turned = bias(count=50), Pose(1.0, 2.0, 0.9)
    here, there = (
        biases.errors(np.tile(np.array(frame @ around(0.4)), (50, 1)),
                      np.tile(np.array(frame @ PLACE), (50, 1)))
        for frame in (Pose(0.0, 0.0, 0.0), turned))
    rotated = np.array([(*Pose(0.0, 0.0, turned.theta).transform(row[:2]), row[2])
                        for row in here.tolist()])
    assert np.allclose(there, rotated, atol=1e-12)


def test_one_side_tells_no_more_than_the_bias_allows():
    """However many poses are averaged: the deviation stays, and it is honest."""
    scores = []
    for seed in range(8):
        view = drawn_view(seed).drive(0.0).drive(0.0).drive(0.0)
        deviations = view.ensemble.object_deviations
        assert np.all(deviations > 0.7 * np.array((POSITION, POSITION, HEADING)))
        scores.append(view.object_error / deviations)
    assert np.sqrt(np.mean(np.square(scores))) < 1.5


def test_views_from_all_sides_find_the_object():
    """Far better than poses from one side; the deviation is about the error."""
    errors, scores, before = [], [], []
    for seed in range(5):
        view = drawn_view(seed).drive(0.0)
        before.append(view.object_error)
        view.drive(2.0 * math.pi)
        errors.append(view.object_error)
        scores.append(view.object_error / view.ensemble.object_deviations)
    first, last = (np.sqrt(np.mean(np.square(rows), axis=0)) for rows in (before, errors))
    assert math.hypot(*last[:2]) < 0.6 * math.hypot(*first[:2]) and last[2] < 0.6 * first[2]
    assert np.sqrt(np.mean(np.square(scores))) < 1.5


def test_poses_that_are_far_off_are_not_believed():
    """One in ten, by a decimetre: the object stays where it is."""
    numbers = iter(range(10 ** 6))
    view = View(lambda _: Pose(0.0, 0.1, 0.2) if next(numbers) % 10 == 9 else Pose(0.0, 0.0, 0.0))
    view.drive(0.0).drive(1.0)
    assert [number % 10 == 9 for number in range(len(view.believed))] == [
        not believed for believed in view.believed]
    assert np.all(np.abs(view.object_error) < 3.0 * view.ensemble.object_deviations)


def test_another_mark_makes_the_object_as_uncertain_as_at_first():
    """Where the bias jumps by less than an object is moved, what was learned is forgotten."""
    view = View(lambda angle: Pose(0.03 if angle > 6.0 else 0.0, 0.0, 0.0)).drive(5.9)
    certain = view.ensemble.object_deviations[:2].max()
    view.drive(0.2)
    assert view.believed.count(False) == MAX_OUTLIERS - 1
    assert view.ensemble.object_deviations[:2].max() > 1.5 * certain
