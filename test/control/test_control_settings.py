"""Settings of the controller refuse what is out of range."""

from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
import pytest


@pytest.mark.parametrize('field, value', [('lateral_gain', -1.0), ('pose_timeout', 0.0),
                                          ('control_law', 'magic'), ('replan_cone_fraction', 1.5),
                                          ('max_reapproaches', 1.5), ('pose_gate', float('nan'))])
def test_settings_out_of_range_are_refused_by_name(field, value):
    """The error names the field."""
    with pytest.raises(ValueError, match=f'ControlSettings.{field}'):
        ControlSettings(**{field: value})


def test_a_covariance_is_believed_only_where_odometry_is_absolute():
    """Many bases state a small constant one for a pose that drifts."""
    stated = Odometry(0.0, Pose(0.0, 0.0, 0.0), STOP, PoseCovariance.from_deviations(1e-3, 2e-3))
    absolute = SupervisionSettings(odometry_reference='absolute')
    assert SupervisionSettings().assumed_covariance(stated) is None
    assert absolute.assumed_covariance(stated) == stated.covariance
    assert absolute.assumed_covariance(stated._replace(covariance=None)) is None


def test_noise_grows_with_the_distance_of_relative_poses_alone():
    settings = ControlSettings(pose_noise=0.002, heading_noise=0.01, pose_noise_per_distance=0.005,
                               heading_noise_per_distance=0.02)
    pose = Pose(5.0, 0.0, 0.0)
    seen = ObjectPose(0.0, pose, relative=Pose(0.0, 2.0, 1.0))
    assert settings.assumed_covariance(seen).position_deviation == pytest.approx(0.012)
    assert settings.assumed_covariance(seen).heading_deviation == pytest.approx(0.05)
    assert settings.assumed_covariance(ObjectPose(0.0, pose)).heading_deviation == pytest.approx(
        0.01)
    stated = PoseCovariance.from_deviations(0.1, 0.2)
    assert settings.assumed_covariance(seen._replace(covariance=stated)) is stated
