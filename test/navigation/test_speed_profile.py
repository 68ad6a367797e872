"""Speed profiles: times of paths by their speeds, stops, scaling and limits; motion sections."""

import dataclasses
import math

from helpers.paths import curved_path
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.path import differential_path, holonomic_path, Path, PathSegment
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import (
    BRAKING_FRACTION, FADE_TIME, joint_speeds, MotionSection, segment_limits, split_at_stops,
    stopping_speed, travel_time,
)
import pytest
from scipy.integrate import quad

ROBOT = RoundRobot(0.17, time_constant=0.0)
SETTINGS = DriveSettings()


def integrated_time(segment, limits):
    """Integrate the time of a segment from rest to rest over its path, u the root of the path."""
    path, top, rate = ((segment.length, limits.speed, limits.acceleration) if segment.length else
                       (abs(segment.heading_change), limits.yaw_rate, limits.yaw_acceleration))
    half, _ = quad(lambda u: 2.0 * u / min(top, math.sqrt(2.0 * rate) * u), 0.0,
                   math.sqrt(0.5 * path), limit=200)
    return 2.0 * half


def test_straight_segments_and_rotations_take_the_time_of_their_speeds():
    """Each from rest to rest, and a while to settle."""
    start, goal = Pose(0.0, 0.0, 0.3), Pose(1.0, 0.05, 2.0)
    path = differential_path(start, goal, [(1.0, 0.0, 0.0), (1.0, 0.05, 0.0)], [False, False])
    assert travel_time(path, ROBOT, SETTINGS) == pytest.approx(
        sum(integrated_time(segment, SETTINGS) + FADE_TIME for segment in path.segments), abs=1e-4)


def test_time_is_kept_when_lengths_and_speeds_grow_alike():
    """A law of units: twice the length at twice the speed and acceleration."""
    # So quick to turn that no corner is cut by a distance that does not grow.
    once = dataclasses.replace(SETTINGS, yaw_acceleration=50.0)
    double = dataclasses.replace(once, speed=2.0 * once.speed,
                                 acceleration=2.0 * once.acceleration)
    robot = RoundRobot(0.17, max_speed=10.0, max_acceleration=10.0, max_yaw_acceleration=50.0)
    for drive in ('differential', 'holonomic'):
        assert travel_time(curved_path(drive, 2.0), robot, double) == pytest.approx(
            travel_time(curved_path(drive), robot, once), rel=1e-9)


def test_a_path_takes_as_long_there_as_back():
    """Speeding up and slowing down are alike."""
    for drive in ('differential', 'holonomic'):
        path = curved_path(drive)
        back = Path(path.poses[::-1], tuple(-arc_angle for arc_angle in path.arc_angles[::-1]))
        assert back.length == pytest.approx(path.length, rel=1e-12)
        assert travel_time(back, ROBOT, SETTINGS) == pytest.approx(
            travel_time(path, ROBOT, SETTINGS), rel=1e-12)


def test_a_corner_is_a_stop():
    """A holonomic base too: as long as both sides each on its own; not so where it goes on."""
    first, corner, straight = Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0), Pose(2.0, 0.0, 0.0)
    for last, stops in ((Pose(1.0, 1.0, 0.0), True), (first, True), (straight, False)):
        both = travel_time(Path((first, corner, last)), ROBOT, SETTINGS)
        each = [travel_time(Path(ends), ROBOT, SETTINGS) for ends in ((first, corner),
                                                                      (corner, last))]
        if stops:
            assert both == pytest.approx(sum(each), rel=1e-12)
        else:
            assert both < sum(each) - 0.5


def test_an_arc_is_quicker_than_the_corner_that_it_cuts():
    """It does not stop, although it is as long as its own corner nearly."""
    start, goal = Pose(0.0, 0.0, 0.0), Pose(1.3, 1.3, 0.5 * math.pi)
    arc = differential_path(
        start, goal, [(1.0, 0.0, 0.0), (1.3, 0.3, 0.5 * math.pi), (1.3, 1.3, 0.0)], [False] * 3)
    corner = differential_path(start, goal, [(1.3, 0.0, 0.0), (1.3, 1.3, 0.0)], [False] * 2)
    assert travel_time(arc, ROBOT, SETTINGS) < travel_time(corner, ROBOT, SETTINGS) - 1.0


def test_the_robots_own_limits_hold():
    """A slow robot takes longer; limits above the settings change nothing."""
    path = curved_path()
    usual = travel_time(path, ROBOT, SETTINGS)
    for limit in ('max_speed', 'max_yaw_rate', 'max_acceleration', 'max_yaw_acceleration'):
        slow = dataclasses.replace(ROBOT, **{limit: 0.1})
        fast = dataclasses.replace(ROBOT, **{limit: 9.0})
        assert travel_time(path, slow, SETTINGS) > usual + 0.5
        assert travel_time(path, fast, SETTINGS) == usual


def test_nothing_to_do_takes_no_time():
    """The goal is the start."""
    here = Pose(0.3, 0.2, 0.1)
    for path in (differential_path(here, here, [], []), holonomic_path(here, here, [])):
        assert path.poses == (here, here)
        assert path.length == 0.0 and travel_time(path, ROBOT, SETTINGS) == 0.0


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_speeds_at_the_joints_can_be_reached_and_left(drive):
    """Squared speeds differ by no more than the acceleration allows, and obey the limits."""
    segments = curved_path(drive).segments
    speeds = joint_speeds(segments, SETTINGS).speeds
    assert len(speeds) == len(segments) + 1 and speeds[0] == speeds[-1] == 0.0
    assert max(speeds) > 0.1
    for segment, first, last in zip(segments, speeds, speeds[1:]):
        if segment.length:
            top, acceleration = segment_limits(segment, SETTINGS)
            assert max(first, last) <= top + 1e-12
            assert abs(first ** 2 - last ** 2) <= 2.0 * acceleration * segment.length + 1e-12
        else:
            assert first == last == 0.0


@pytest.mark.parametrize('arc_angle, heading_change', [(1.2, 1.2), (-0.7, -0.7), (0.9, 0.0),
                                                       (0.0, 1.5), (0.6, -0.4)])
def test_acceleration_along_and_across_an_arc_keeps_the_limit(arc_angle, heading_change):
    """In the world and in robot axes, at the top speed; the yaw rate keeps its own."""
    segment = PathSegment(Pose(0.0, 0.0, 0.3), Pose(0.4, 0.1, 0.3 + heading_change), arc_angle)
    speed, acceleration = segment_limits(segment, SETTINGS)
    assert 0.0 < speed <= SETTINGS.speed and 0.0 < acceleration <= SETTINGS.acceleration
    for angle in (arc_angle, arc_angle - heading_change):
        lateral = speed ** 2 * abs(angle) / segment.length
        assert math.hypot(acceleration, lateral) <= SETTINGS.acceleration + 1e-12
    assert speed * abs(heading_change) / segment.length <= SETTINGS.yaw_rate + 1e-12


def test_the_stopping_speed_brakes_evenly_and_fades_out():
    """Its square falls by ``2 a`` per distance; below ``a T^2`` it is the distance over T."""
    braking = BRAKING_FRACTION * 0.6
    fading = braking * FADE_TIME ** 2
    left = np.linspace(1.001 * fading, 1.0, 500)
    squares = np.array([stopping_speed(value, 0.6) ** 2 for value in left])
    assert np.diff(squares) / np.diff(left) == pytest.approx(2.0 * braking)
    for value in (0.0, 0.3 * fading, 0.999 * fading):
        assert stopping_speed(value, 0.6) == pytest.approx(value / FADE_TIME)
    below, above = (stopping_speed(fading * factor, 0.6) for factor in (1.0 - 1e-9, 1.0 + 1e-9))
    assert below == pytest.approx(above, rel=1e-8)


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_sections_are_all_of_the_path_between_its_stops(drive):
    path = curved_path(drive)
    sections = split_at_stops(path, SETTINGS)
    moving = [section for section in sections if isinstance(section, MotionSection)]
    assert len(moving) == 2
    assert sum(section.length for section in moving) == pytest.approx(path.length)
    speeds = joint_speeds(path.segments, SETTINGS).speeds
    assert len(moving) == sum(
        first == 0.0 and segment.length > 0.0 for segment, first in zip(path.segments, speeds))


def test_a_section_locates_the_robot_and_stops_at_its_end():
    """Arc length and offset come back; the speed is 0 at the end and negative beyond."""
    path = curved_path('holonomic')
    section = split_at_stops(path, SETTINGS)[0]
    begin = 0.0
    for segment in section.segments:
        for fraction in (0.1, 0.5, 0.9):
            (x, y, _), = segment.poses(np.array([fraction]))
            direction = segment.direction(fraction * segment.length)
            s, lateral = section.locate((x - 0.02 * math.sin(direction),
                                         y + 0.02 * math.cos(direction)))
            assert s == pytest.approx(begin + fraction * segment.length, abs=1e-9)
            assert lateral == pytest.approx(0.02, abs=1e-9)
            assert section.direction(s) == pytest.approx(direction, abs=1e-9)
            assert section.speed(s) <= segment_limits(segment, SETTINGS)[0] + 1e-12
        begin += segment.length
    assert section.speed(section.length) == 0.0
    assert section.speed(section.length + 0.01) == -section.speed(section.length - 0.01) < 0.0
