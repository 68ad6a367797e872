"""Ways of the robot: their geometry, and the time that they take."""

import dataclasses
import math

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.path import (
    differential_path, holonomic_path, Path, PathSegment, sample_path,
)
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import FADE_TIME, travel_time
import pytest
from scipy.integrate import quad

ROBOT = RoundRobot(0.17, time_constant=0.0)
SETTINGS = DriveSettings()
ROUND = [(1.0, 0.0, 0.0), (1.3, 0.3, 0.5 * math.pi), (1.3, 1.0, 0.0), (0.5, 1.5, 0.0)]


def bent_way(drive='differential', scale=1.0):
    """Return a way with an arc and a corner."""
    waypoints = [(scale * x, scale * y, arc_angle) for x, y, arc_angle in ROUND]
    start, goal = Pose(0.0, 0.0, 0.4), Pose(scale * 0.5, scale * 1.5, -2.0)
    if drive == 'holonomic':
        return holonomic_path(start, goal, waypoints)
    return differential_path(start, goal, waypoints, [False] * len(waypoints))


def integrated_time(segment, limits):
    """Integrate the time of a leg from rest to rest over its way, u the root of the way."""
    way, top, rate = ((segment.length, limits.speed, limits.acceleration) if segment.length else
                      (abs(segment.heading_change), limits.yaw_rate, limits.yaw_acceleration))
    half, _ = quad(lambda u: 2.0 * u / min(top, math.sqrt(2.0 * rate) * u), 0.0,
                   math.sqrt(0.5 * way), limit=200)
    return 2.0 * half


def test_a_point_on_an_arc_is_projected_to_where_it_is():
    """Legs of any bend and side, points beside them."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        arc_angle, chord = rng.uniform(-3.0, 3.0), rng.uniform(0.2, 2.0)
        start = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
        toward = rng.uniform(-math.pi, math.pi)
        segment = PathSegment(start, Pose(start.x + chord * math.cos(toward),
                              start.y + chord * math.sin(toward), start.theta + arc_angle), arc_angle)
        way = rng.uniform(0.0, segment.length)
        aside = rng.uniform(-0.4, 0.4) * min(1.0, segment.length / max(abs(arc_angle), 1e-9))
        (x, y, heading), end = segment.poses(np.array([way / segment.length, 1.0]))
        direction = segment.direction(way)
        point = (x - aside * math.sin(direction), y + aside * math.cos(direction))
        assert segment.project(point) == pytest.approx((way, aside), abs=1e-9)
        assert distance(end, segment.end) < 1e-9
        assert heading == pytest.approx(segment.heading(way))


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
def test_samples_are_dense_and_begin_and_end_where_the_way_does(drive):
    """No two are farther apart than asked for, at the rim of the robot."""
    way = bent_way(drive)
    rows = sample_path(way, ROBOT, 0.02)
    assert tuple(rows[0]) == way.poses[0] and tuple(rows[-1]) == way.poses[-1]
    steps = np.diff(rows, axis=0)
    assert np.hypot(steps[:, 0], steps[:, 1]).max() <= 0.02 + 1e-12
    assert ROBOT.radius * np.abs([wrap_angle(heading_change) for heading_change in steps[:, 2]]).max() <= 0.02 + 1e-12
    assert np.hypot(steps[:, 0], steps[:, 1]).sum() == pytest.approx(way.length, rel=1e-3)


def test_a_differential_drive_goes_along_its_heading():
    """All along the way, arcs included: a wheel never slips sideways."""
    rows = sample_path(bent_way(), ROBOT, 1e-3)
    for before, after in zip(rows, rows[1:]):
        x, y = after[:2] - before[:2]
        middle = before[2] + 0.5 * wrap_angle(after[2] - before[2])
        assert abs(-math.sin(middle) * x + math.cos(middle) * y) < 1e-9


def test_backwards_is_the_same_track_with_the_heading_turned_round():
    """The places are the same; between the ends the headings differ by half a turn."""
    start, goal = Pose(0.0, 0.0, 0.4), Pose(0.5, 1.5, -2.0)
    ahead, back = (differential_path(start, goal, ROUND, [flag] * 4) for flag in (False, True))
    moving = [[segment for segment in way.segments if segment.length] for way in (ahead, back)]
    for one, other in zip(*moving):
        assert one.start[:2] == other.start[:2] and one.directions == other.directions
        assert abs(wrap_angle(one.start.theta - other.start.theta)) == pytest.approx(math.pi)


def test_straight_legs_and_turns_take_the_time_of_their_speeds():
    """Each from rest to rest, and a while to settle."""
    start, goal = Pose(0.0, 0.0, 0.3), Pose(1.0, 0.05, 2.0)
    way = differential_path(start, goal, [(1.0, 0.0, 0.0), (1.0, 0.05, 0.0)], [False, False])
    assert travel_time(way, ROBOT, SETTINGS) == pytest.approx(
        sum(integrated_time(segment, SETTINGS) + FADE_TIME for segment in way.segments), abs=1e-4)


def test_time_is_kept_when_lengths_and_speeds_grow_alike():
    """A law of units: twice the length at twice the speed and acceleration."""
    double = dataclasses.replace(SETTINGS, speed=2.0 * SETTINGS.speed,
                                 acceleration=2.0 * SETTINGS.acceleration)
    robot = RoundRobot(0.17, max_speed=10.0, max_acceleration=10.0)
    for drive in ('differential', 'holonomic'):
        assert travel_time(bent_way(drive, 2.0), robot, double) == pytest.approx(
            travel_time(bent_way(drive), robot, SETTINGS), rel=1e-9)


def test_a_way_takes_as_long_there_as_back():
    """Speeding up and slowing down are alike."""
    for drive in ('differential', 'holonomic'):
        way = bent_way(drive)
        back = Path(way.poses[::-1], tuple(-arc_angle for arc_angle in way.arc_angles[::-1]))
        assert back.length == pytest.approx(way.length, rel=1e-12)
        assert travel_time(back, ROBOT, SETTINGS) == pytest.approx(
            travel_time(way, ROBOT, SETTINGS), rel=1e-12)


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
    arc = differential_path(start, goal, [(1.0, 0.0, 0.0), (1.3, 0.3, 0.5 * math.pi), (1.3, 1.3, 0.0)],
                            [False] * 3)
    corner = differential_path(start, goal, [(1.3, 0.0, 0.0), (1.3, 1.3, 0.0)], [False] * 2)
    assert travel_time(arc, ROBOT, SETTINGS) < travel_time(corner, ROBOT, SETTINGS) - 1.0


def test_the_robots_own_limits_hold():
    """A slow robot takes longer; limits above the settings change nothing."""
    way = bent_way()
    usual = travel_time(way, ROBOT, SETTINGS)
    for limit in ('max_speed', 'max_yaw_rate', 'max_acceleration', 'max_yaw_acceleration'):
        slow = dataclasses.replace(ROBOT, **{limit: 0.1})
        fast = dataclasses.replace(ROBOT, **{limit: 9.0})
        assert travel_time(way, slow, SETTINGS) > usual + 0.5
        assert travel_time(way, fast, SETTINGS) == usual


def test_nothing_to_do_takes_no_time():
    """The goal is the start."""
    here = Pose(0.3, 0.2, 0.1)
    for way in (differential_path(here, here, [], []), holonomic_path(here, here, [])):
        assert way.poses == (here, here)
        assert way.length == 0.0 and travel_time(way, ROBOT, SETTINGS) == 0.0


def test_samples_need_a_spacing():
    """Zero, negative and nan are refused by name."""
    for spacing in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match='spacing: got'):
            sample_path(bent_way(), ROBOT, spacing)
