"""Means of objects at rest: of enough measurements, and of headings that wrap."""

import math

import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_tidy.rest_poses import RestPoses
import pytest


def test_the_mean_is_nearer_than_one_measurement() -> None:
    """The heading is at the place where angles wrap; the deviation is that of the noise."""
    rest, rng = RestPoses(['box'], 400), np.random.default_rng(1)
    for e_x, e_y, e_theta in (0.01 * rng.standard_normal((400, 3))).tolist():
        rest.add('box', Pose(1.0 + e_x, 2.0 + e_y, wrap_angle(math.pi + e_theta)))
    mean = rest.means()['box']
    assert mean.pose[:2] == pytest.approx((1.0, 2.0), abs=2e-3)
    assert wrap_angle(mean.pose.theta - math.pi) == pytest.approx(0.0, abs=2e-3)
    assert mean.deviation == pytest.approx(0.01, rel=0.1)


def test_each_object_has_to_be_measured_often_enough() -> None:
    """After a move from the start again."""
    rest = RestPoses(['bin', 'box'], 2)
    for _ in range(3):
        rest.add('box', Pose(0.0, 0.0, 0.0))
    assert rest.missing == ['bin']
    rest.restart()
    assert rest.missing == ['bin', 'box'] and not rest.means()
