"""Monitors: each condition that stops the robot, at its threshold and not before."""

import math

from helpers.contact_sites import FACE, VERTEX
from push_control.perception.measurement_faults import is_finite_odometry, measurement_fault
from push_control.settings import ControlSettings
from push_control.steered.monitors import (
    FollowMonitor, jackknife_fault, jackknife_mode, OneSidedMonitor)
from push_control.steered.path.path import CurvatureLimits
from push_model.events import PushEvent
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, Twist
import pytest

SETTINGS = ControlSettings()
ODOMETRY = Odometry(10.0, Pose(0.0, 0.0, 0.0), Twist(0.1, 0.0, 0.0))
SEEN = ObjectPose(9.9, Pose(1.0, 2.0, 3.0))


def event(report):
    """Return the code of a report, or None."""
    return None if report is None else report.code


@pytest.mark.parametrize('observation, expected', [
    (Observation(10.0, ODOMETRY, SEEN), None),
    (Observation(10.0, ODOMETRY), PushEvent.NO_OBJECT_POSE),
    (Observation(10.0, ODOMETRY._replace(twist=Twist(math.nan, 0.0, 0.0)), SEEN),
     PushEvent.ODOMETRY_NOT_FINITE),
    (Observation(10.0, ODOMETRY, SEEN._replace(pose=Pose(1.0, math.inf, 0.0))),
     PushEvent.OBJECT_POSE_NOT_FINITE),
    (Observation(10.14, ODOMETRY._replace(time=10.14), SEEN), None),
    (Observation(10.16, ODOMETRY._replace(time=10.16), SEEN), PushEvent.OBJECT_POSE_STALE),
    (Observation(10.24, ODOMETRY, SEEN._replace(time=10.2)), None),
    (Observation(10.26, ODOMETRY, SEEN._replace(time=10.2)), PushEvent.ODOMETRY_STALE)])
def test_measurements_are_refused_for_what_is_wrong_with_them(observation, expected):
    """Missing, broken or older than 0.25 s; the newest finite pose counts."""
    measured = observation.object_pose
    last = None if measured is None else measured.time
    assert event(measurement_fault(observation, last, SETTINGS)) is expected


def test_a_stale_pose_is_reported_with_its_age():
    """Sentences name what came and what was expected."""
    fault = measurement_fault(Observation(10.3, ODOMETRY._replace(time=10.3), SEEN), 9.9, SETTINGS)
    assert str(fault) == 'object pose is stale: 0.40 s old, at most 0.25 s'


def test_every_number_of_an_odometry_counts():
    """Time, pose and twist."""
    assert is_finite_odometry(ODOMETRY)
    assert not is_finite_odometry(ODOMETRY._replace(time=math.nan))
    assert not is_finite_odometry(ODOMETRY._replace(pose=Pose(0.0, 0.0, math.inf)))


@pytest.mark.parametrize('normal, push_angle, expected', [
    (0.0, 0.0, None), (-0.14, 1.19, None), (math.pi / 2 + 0.14, -1.19, None),
    (-0.16, 0.0, PushEvent.TURNED_OFF_VERTEX),
    (math.pi / 2 + 0.16, 0.0, PushEvent.TURNED_OFF_VERTEX),
    (0.5, 1.21, PushEvent.PUSH_OUT_OF_CONTACT),
    (0.5, 2.0 * math.pi - 1.21, PushEvent.PUSH_OUT_OF_CONTACT),
    (0.5, 2.0 * math.pi + 0.5, None)])
def test_a_contact_that_has_folded_up_is_detected(normal, push_angle, expected):
    """The normal beyond the vertex, or a push away from the object; full turns do not matter."""
    assert event(jackknife_fault(jackknife_mode(VERTEX, normal, push_angle))) is expected


def test_a_face_has_no_end_to_turn_round():
    """Whatever the angle of its normal."""
    assert jackknife_fault(jackknife_mode(FACE, 100.0, 0.0)) is None


@pytest.mark.parametrize('ratio, lost', [(0.29, True), (0.31, False), (1.0, False)])
def test_an_object_that_does_not_follow_is_lost_after_the_window(ratio, lost):
    """It moves by a ratio of the robot's path; nothing is told before 0.25 m."""
    monitor, step = FollowMonitor(SETTINGS), 0.01
    answers = [monitor.is_lost(k * step, (0.0, ratio * k * step)) for k in range(60)]
    assert not any(answers[:25])
    assert any(answers) == lost


def test_an_object_that_stops_following_is_lost_within_the_window():
    """However long it followed before."""
    monitor, step, stop = FollowMonitor(SETTINGS), 0.01, 200
    answers = [monitor.is_lost(k * step, (min(k, stop) * step, 0.0)) for k in range(260)]
    first = answers.index(True)
    assert stop < first <= stop + 26


def test_one_sided_steering_is_given_up_after_its_distance():
    """Half a metre since the last time that it could go straight, or nearly."""
    monitor = OneSidedMonitor(SETTINGS)
    both, nearly, left = (CurvatureLimits(-0.3, 0.3), CurvatureLimits(0.09, 0.5),
                          CurvatureLimits(0.2, 0.8))
    assert monitor.fault(both, 1.0) is None
    assert monitor.fault(left, 1.4) is None
    assert monitor.fault(nearly, 1.45) is None
    assert monitor.fault(left, 1.94) is None
    assert event(monitor.fault(left, 1.96)) is PushEvent.ONE_SIDED_STEERING
