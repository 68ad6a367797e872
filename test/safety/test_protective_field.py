"""Laws of the protective field: what scans show near a robot slows and stops it."""

import dataclasses
import math

import numpy as np
from push_localization.scan_points import UnexplainedPoints
from push_localization.settings import PlaceSettings
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.signals import Odometry, Twist
from push_safety.layer import SafetyLayer
from push_safety.protective_field import (
    CLEAR_TIME, clustered, MAX_AGE, ProtectiveCause, ProtectiveField, SLOW_TIME,
)
import pytest

RADIUS = 0.2
SETTINGS = PlaceSettings(source='scan', slow_distance=1.5)
STOP = SETTINGS.stop_distance
NOBODY = np.zeros((0, 2))
SCAN_PERIOD = 0.1


def person(distance, bearing=0.0):
    """Show three beams that end at somebody, the nearest at a distance from the hull."""
    far = RADIUS + distance
    spread = 0.05 * np.array([[0.0, 0.0], [1.0, 1.0], [1.0, -1.0]]) + (far, 0.0)
    c, s = math.cos(bearing), math.sin(bearing)
    return spread @ np.array([[c, s], [-s, c]])


def driving(time, direction=0.0, speed=0.3):
    """Make odometry of a robot that drives in a direction of its own axes."""
    return Odometry(time, Pose(0.0, 0.0, 0.0),
                    Twist(speed * math.cos(direction), speed * math.sin(direction)))


def decide(points, direction=0.0, field=None, time=1.0):
    """Let two scans come that show the same."""
    field = field or ProtectiveField(SETTINGS, RADIUS)
    for each in (time - SCAN_PERIOD, time):
        protection = field.decide(UnexplainedPoints(each, points), driving(each, direction))
    return protection


@pytest.mark.parametrize('direction', [0.0, 1.0, 3.0, -2.0])
def test_who_is_near_slows_on_any_side_and_stops_ahead_alone(direction):
    """The nearest distances decide, in whatever direction the robot goes."""
    for side in (0.0, 1.2, -1.2, math.pi):
        slowed = decide(person(1.45, direction + side), direction)
        assert slowed.speed_limit == SETTINGS.slow_speed and slowed.report is None
        assert math.isinf(decide(person(1.55, direction + side), direction).speed_limit)
        near = decide(person(STOP - 0.05, direction + side), direction)
        assert (near.report is not None) == (side == 0.0)
        if near.report is not None:
            assert near.report.code is ProtectiveCause.OBSTRUCTED_UNTIL_RESUME
    assert decide(person(STOP + 0.05, direction), direction).report is None


def test_stray_beams_are_nobody():
    """Points alone, or two of them, count for nothing, nor does what is inside the hull."""
    stray = np.array([[0.4, 0.0], [0.0, 0.9], [-0.5, 0.3], [0.45, 0.05]])
    assert math.isinf(decide(stray).speed_limit) and decide(stray).report is None
    assert math.isinf(decide(0.3 * person(0.0)).speed_limit)
    crowd = np.vstack([stray, person(1.0, 2.0)])
    assert len(clustered(crowd)) == 3 and len(clustered(NOBODY)) == 0


@pytest.mark.parametrize('restart_time, duration, code', [
    (0.0, CLEAR_TIME, ProtectiveCause.OBSTRUCTED_UNTIL_RESUME),
    (2.0, 2.0, ProtectiveCause.OBSTRUCTED)])
def test_the_way_is_clear_a_while_after_the_last_scan_that_shows_somebody(
        restart_time: float, duration: float, code: ProtectiveCause) -> None:
    """From the last one, not from the first; whether that is enough the code says."""
    settings = dataclasses.replace(SETTINGS, restart_time=restart_time)
    field = ProtectiveField(settings, RADIUS)
    assert decide(person(0.2), field=field, time=1.0).report.code is code
    assert decide(person(0.2), field=field, time=2.0).report.code is code
    last = 2.0 + duration
    for time in np.arange(2.1, last + 0.5, SCAN_PERIOD).tolist():
        # It stands; where it went is known still.
        now = field.decide(UnexplainedPoints(time, NOBODY), driving(time, speed=0.0))
        assert (now.report is not None) == (time <= last)
        assert math.isinf(now.speed_limit) == (time > 2.0 + SLOW_TIME)


def test_one_scan_alone_slows_and_two_in_a_row_stop() -> None:
    """Stray beams may be side by side once, hardly twice."""
    field = ProtectiveField(SETTINGS, RADIUS)
    for index, points in enumerate([person(0.2), NOBODY, person(0.2), person(0.2)]):
        time = 1.0 + SCAN_PERIOD * index
        now = field.decide(UnexplainedPoints(time, points), driving(time))
        assert now.speed_limit == SETTINGS.slow_speed
        assert (now.report is not None) == (index == 3)
        # Between two scans nothing new is seen.
        again = field.decide(UnexplainedPoints(time, points), driving(time + 0.02))
        assert (again.report is None) == (now.report is None)


def test_without_scans_the_robot_stands_be_it_from_the_start_or_later() -> None:
    """A lidar that is covered, or of which nothing comes, protects nobody."""
    field = ProtectiveField(SETTINGS, RADIUS)
    first = field.decide(None, driving(1.0)).report
    assert first is not None and first.code is ProtectiveCause.NO_SCAN_YET
    seen = UnexplainedPoints(1.0, NOBODY)
    assert field.decide(seen, driving(1.0)).report is None
    assert field.decide(seen, driving(0.9 + MAX_AGE)).report is None
    late = field.decide(seen, driving(1.1 + MAX_AGE)).report
    assert late is not None and late.code is ProtectiveCause.NO_SCAN


def test_a_limit_of_speed_keeps_the_arc():
    """The layer slows all parts of a command by the same ratio, and none without a limit."""
    robot = read_robot(data.config_file('robots/disc_017.yaml'))
    sent = []
    for limit in (math.inf, 0.1):
        layer = SafetyLayer(robot, read_object(data.config_file('objects/box_04.yaml')))
        layer.speed_limit = limit
        pose, twist = Pose(0.0, 0.0, 0.0), Twist()
        for time in np.arange(0.0, 2.0, 0.02).tolist():
            pose = pose @ Pose(0.02 * twist.v_x, 0.0, 0.02 * twist.omega)
            layer.observe(Odometry(time, pose, twist))
            twist = layer.filter(Twist(0.25, 0.0, 0.5), time)
        sent.append(twist)
    free, slow = sent
    assert free.v_x == pytest.approx(0.25) and slow.v_x == pytest.approx(0.1)
    assert slow.omega / slow.v_x == pytest.approx(free.omega / free.v_x)


def test_a_field_needs_settings_that_make_sense():
    """A robot that is slow does move."""
    with pytest.raises(ValueError, match='slow_speed'):
        dataclasses.replace(SETTINGS, slow_speed=0.0)
