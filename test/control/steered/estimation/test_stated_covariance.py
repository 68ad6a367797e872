"""Object poses that state how certain they are, in both filters and at rest."""

from helpers.contact_sites import VERTEX
from helpers.objects import box
import numpy as np
from push_control.perception.ensemble.ensemble_state import OdometryNoise
from push_control.perception.ensemble.push_ensemble import PushEnsemble
from push_control.perception.object_at_rest import StationarityWindow
from push_control.settings import ControlSettings
from push_control.steered.estimation.estimator import Estimator
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.estimation.push_motion import PushMotion
from push_control.supervision_settings import SupervisionSettings
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
import pytest

SETTINGS = ControlSettings(pose_noise=0.002, heading_noise=0.006)
OBJECT = box()
ROBOT = RoundRobot(radius=0.17, drive='differential', max_speed=0.3, max_yaw_rate=1.9,
                   max_acceleration=0.9, max_yaw_acceleration=6.0, time_constant=0.1)
START = Pose(0.0, 0.0, 0.0)
# The next pose is off by as much along x, along y and in heading [m, m, rad].
ERROR = Pose(0.004, 0.004, 0.004)


def covariance(position, heading):
    """Make a covariance of independent errors; both axes may differ."""
    x, y = position
    return PoseCovariance(x ** 2, 0.0, 0.0, y ** 2, 0.0, heading ** 2)


def estimator(stated):
    """Estimate a pose from one measurement, then from another that states its covariance."""
    site = VERTEX
    motion = PushMotion(ROBOT.radius, site, LimitSurfaceTable(OBJECT, site.point))
    made = Estimator(motion, SETTINGS, friction_center(OBJECT), ObjectPose(0.0, START),
                     Odometry(0.0, Pose(-0.5, 0.0, site.heading), STOP))
    assert made.add_pose(ObjectPose(0.05, ERROR, stated)).is_accepted
    return np.array(made.state[:3])


def ensemble(stated):
    """Do the same with the ensemble, of a robot that is far away."""
    made = PushEnsemble(OBJECT, ROBOT, SETTINGS, OdometryNoise(0.01, 0.01, 0.002, 0.005))
    for time, pose, noise in ((0.0, START, None), (0.05, ERROR, stated)):
        made.predict(Odometry(time, Pose(-3.0, 0.0, 0.0), STOP))
        made.update(ObjectPose(time, pose, noise))
    return np.array(made.object_pose)


@pytest.mark.parametrize('estimate, slack', [(estimator, 0.01), (ensemble, 0.7)])
def test_a_pose_weighs_as_much_as_it_states(estimate, slack):
    """
    Equal variances meet in the middle; one that is certain to a tenth pulls the estimate along.

    A pose that states the noise of the settings counts like one that states none. The ensemble has
    the correlations of a few dozen members besides.
    """
    as_believed = covariance((0.002, 0.002), 0.006)
    np.testing.assert_allclose(estimate(None), estimate(as_believed))
    np.testing.assert_allclose(estimate(None), np.array(ERROR) / 2, rtol=slack)
    # Along y it is certain, in heading it knows nothing.
    found = estimate(covariance((0.002, 0.0002), 1.0))
    assert found[0] == pytest.approx(0.5 * ERROR.x, rel=slack)
    assert found[1] == pytest.approx(ERROR.y, rel=0.02)
    assert found[2] == pytest.approx(0.0, abs=slack * ERROR.theta)


def test_the_average_at_rest_states_the_error_of_its_poses():
    """It falls with the root of their number, from what each of them states."""
    window = StationarityWindow(SETTINGS, SupervisionSettings())
    for count in range(1, 5):
        window.add(ObjectPose(0.05 * count, START, covariance((0.01, 0.02), 0.1)))
        found = window.object_at_rest
        assert found.position_error == pytest.approx(0.02 / count ** 0.5)
        assert found.heading_error == pytest.approx(0.1 / count ** 0.5)


def test_an_uncertain_pose_is_no_motion():
    """A deviation within what the pose states does not start the average over."""
    window = StationarityWindow(SETTINGS, SupervisionSettings())
    window.add(ObjectPose(0.0, START, covariance((0.01, 0.01), 0.1)))
    window.add(ObjectPose(0.5, Pose(0.02, 0.0, 0.0), covariance((0.01, 0.01), 0.1)))
    assert window.object_at_rest.duration == pytest.approx(0.5)
    window.add(ObjectPose(1.0, Pose(0.03, 0.0, 0.0), covariance((0.001, 0.001), 0.1)))
    assert window.object_at_rest.duration == 0.0
