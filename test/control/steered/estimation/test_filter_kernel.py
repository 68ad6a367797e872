"""The compiled filter: the textbook's Kalman filter, written with matrices."""

import math

from helpers.contact_sites import SITES
from helpers.objects import bin_, box
import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.estimation.estimator import Estimator, NoiseModel
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.estimation.push_motion import MotionState, PushMotion
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, PoseCovariance, Twist
import pytest

SETTINGS = ControlSettings()
CENTER = (0.01, -0.02)
NOISE = PoseCovariance(4e-6, 1e-6, 2e-6, 9e-6, -1e-6, 4e-5)


@pytest.mark.parametrize('kind', ['vertex', 'face', 'round'])
def test_odometry_and_a_late_pose_are_fused_as_in_the_textbook(kind):
    """``P = F P F' + Q ds`` for each motion up to the pose, then ``K = P H' (H P H' + R)^-1``."""
    site, obj = SITES[kind], bin_() if kind == 'round' else box()
    motion = PushMotion(0.17, site, LimitSurfaceTable(obj, site.point))
    start = Pose(0.3, -0.2, 0.4)
    twist = Twist(0.15 * math.cos(site.heading_offset), 0.15 * math.sin(site.heading_offset), 0.1)
    estimator = Estimator(motion, SETTINGS, CENTER, ObjectPose(0.0, start),
                          Odometry(0.0, Pose(0.0, 0.0, start.theta + site.heading), twist))
    noise = NoiseModel.of(SETTINGS, site, CENTER)
    state = MotionState(*start, start.theta + site.heading, *CENTER)
    covariance = np.diag(noise.initial)
    for k in range(1, 6):
        estimator.add_odometry(Odometry(0.02 * k, Pose(0.0, 0.0, 0.0), twist))
    for duration in (0.02, 0.02, 0.02, 0.01):
        found, distance = motion.linearize(state, motion.rates(state, twist), duration)
        covariance = found @ covariance @ found.T + distance * np.diag(noise.walk)
        state = motion.propagate(state, twist, duration)
    assert estimator.predict(0.1) == pytest.approx(motion.propagate(motion.propagate(
        state, twist, 0.01), twist, 0.02), abs=1e-6)
    innovation = np.array((0.002, -0.003, 0.004))
    measured = Pose(*(np.array(state.pose) + innovation).tolist())
    assert estimator.add_pose(ObjectPose(0.07, measured, NOISE)).is_accepted
    rows = np.eye(3, 7)
    gain = covariance @ rows.T @ np.linalg.inv(rows @ covariance @ rows.T + NOISE.matrix)
    np.testing.assert_allclose(estimator.state, np.array(state) + gain @ innovation, rtol=1e-9,
                               atol=1e-12)
    np.testing.assert_allclose(estimator.covariance, covariance - gain @ rows @ covariance,
                               rtol=1e-9, atol=1e-14)
