"""What the controller's node keeps of its measurements, and what it says of them."""

from push_control.ros.measurements import CovarianceCheck
from push_control.task.settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.signals import Odometry, PoseCovariance, STOP

SILENT = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP)
STATED = SILENT._replace(covariance=PoseCovariance.from_deviations(1e-3, 2e-3))


def test_absolute_odometry_without_a_covariance_is_reported_once():
    """And again after it was there."""
    check = CovarianceCheck(SupervisionSettings(odometry_reference='absolute'))
    texts = [check.update(odometry) for odometry in (SILENT, SILENT, STATED, SILENT, SILENT)]
    assert [bool(text) for text in texts] == [True, False, False, True, False]
    assert 'odom.pose.covariance: got none' in texts[0]


def test_drifting_odometry_needs_no_covariance():
    check = CovarianceCheck(SupervisionSettings())
    assert not check.update(SILENT) and not check.update(STATED)
