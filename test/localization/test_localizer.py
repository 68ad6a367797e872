"""Laws of the place of a robot by scans of its lidar."""

import dataclasses
import math

from helpers.lidar_rooms import (
    cast, EXACT, field_of, RANGE_MAX, room_cells, scan_at, standing,
)
import numpy as np
from push_localization.localizer import FIT_COUNT, LidarLocalizer, MAX_MISFITS
from push_localization.scan_points import LidarMount
from push_localization.settings import PlaceSettings
from push_model.files import data
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.signals import LidarScan, ObjectPose, PlaceStatus
import pytest

BOX = read_object(data.config_file('objects/box_04.yaml'))
CELLS = room_cells(5.0, 4.0, [(40, 30, 55, 40), (2, 60, 12, 70)])
PLACE = Pose(1.5, 1.2, 0.4)
WORLD = Pose(0.0, 0.0, 0.0)


def make_localizer(cells=CELLS, origin=WORLD, settings=EXACT):
    """Make a localizer with its map."""
    localizer = LidarLocalizer(settings, BOX)
    localizer.set_field(field_of(cells, origin, settings.wall_offset))
    return localizer


def stand(localizer, scan, claim, start=0.0, measured=None, mount=None):
    """Let a robot whose odometry claims a pose measure one scan there."""
    for time in (start, start + 0.1):
        localizer.add_odometry(standing(time, claim))
    localizer.add_scan(scan._replace(time=start), mount)
    return localizer.locate(measured)


def errors(place, pose):
    """Return the error of a place, its heading wrapped."""
    return np.array([place.pose.x - pose.x, place.pose.y - pose.y,
                     math.remainder(place.pose.theta - pose.theta, 2.0 * math.pi)])


def test_a_place_without_noise_is_exact():
    """To a millimetre and a milliradian, from 0.2 m and 12 degrees off: a start is searched."""
    scan = scan_at(CELLS, PLACE)
    localizer = make_localizer()
    claim = Pose(PLACE.x + 0.2, PLACE.y - 0.15, PLACE.theta + 0.21)
    for index in range(20):
        place = stand(localizer, scan, claim, 0.1 * index)
    assert np.abs(errors(place, PLACE)).max() < 1.5e-3
    assert place.status is PlaceStatus.TRACKED
    assert place.time == pytest.approx(1.95, abs=1e-3)


def test_moving_the_world_moves_the_place():
    """Map, odometry and place in other axes are the same, with their covariance."""
    frame = Pose(3.0, -2.0, 2.5)
    scan = scan_at(CELLS, PLACE)
    claim = Pose(PLACE.x + 0.03, PLACE.y, PLACE.theta + 0.02)
    place = stand(make_localizer(), scan, claim)
    moved = stand(make_localizer(origin=frame), scan, frame @ claim)
    assert np.abs(errors(moved, frame @ place.pose)).max() < 2e-3
    assert moved.covariance.theta_theta == pytest.approx(place.covariance.theta_theta, rel=0.02)
    trace = place.covariance.x_x + place.covariance.y_y
    assert moved.covariance.x_x + moved.covariance.y_y == pytest.approx(trace, rel=0.02)


def test_a_plain_corridor_says_nothing_along_it():
    """Across it is known to millimetres; along it stays what was known before."""
    cells = room_cells(40.0, 1.6)
    pose = Pose(20.0, 0.9, 0.0)
    scan = scan_at(cells, pose)
    localizer = make_localizer(cells)
    for index in range(30):
        place = stand(localizer, scan, Pose(20.05, 0.93, 0.02), 0.1 * index)
    assert abs(place.pose.y - pose.y) < 2e-3
    assert math.sqrt(place.covariance.x_x) > 0.95 * EXACT.start_position
    assert math.sqrt(place.covariance.y_y) < 0.012


def test_scans_of_one_place_make_it_no_surer():
    """A hundred of them leave the covariance that a few have reached."""
    localizer, scan = make_localizer(), scan_at(CELLS, PLACE)
    places = [stand(localizer, scan, PLACE, 0.1 * index) for index in range(100)]
    few, many = places[20].covariance.matrix, places[-1].covariance.matrix
    assert np.allclose(few, many, rtol=0.1)
    assert math.sqrt(many[0, 0]) > 0.003


def test_a_scan_is_corrected_for_the_motion_during_it():
    """A robot that turns and drives is where it is; taken as measured at once it is not."""
    def pose(time):
        return Pose(1.5 + 0.3 * time, 1.2, 0.4 + 1.5 * time)
    scan = scan_at(CELLS, pose, beams=180)
    off = {}
    for is_corrected in (True, False):
        localizer = make_localizer()
        for time in np.arange(0.0, 0.11, 0.02).tolist():
            localizer.add_odometry(standing(time, pose(time)))
        increment = scan.time_increment if is_corrected else 0.0
        start = 0.0 if is_corrected else scan.middle
        localizer.add_scan(scan._replace(time=start, time_increment=increment))
        off[is_corrected] = errors(localizer.locate(None), pose(scan.middle))
    assert np.abs(off[True]).max() < 3e-3
    assert np.abs(off[False]).max() > 0.02


def test_an_upside_down_lidar_beside_the_middle_sees_the_same():
    """With its beams in reverse, and where it is mounted."""
    mount = Pose(0.1, -0.05, 0.3)
    lens = PLACE @ mount
    scan = scan_at(CELLS, lens)
    localizer = make_localizer()
    place = stand(localizer, scan, PLACE, mount=LidarMount(mount))
    assert np.abs(errors(place, PLACE)).max() < 3e-3
    # Beam i of a lidar that hangs looks where beam -i of one that stands does.
    mirrored = scan._replace(ranges=np.roll(scan.ranges[::-1], 1))
    hanging = stand(make_localizer(), mirrored, PLACE, mount=LidarMount(mount, True))
    assert np.abs(errors(hanging, PLACE)).max() < 3e-3


def test_scans_that_are_stamped_ahead_of_odometry_are_matched_once_it_is_there():
    """Each waits for odometry of its end, however many come meanwhile."""
    scan, localizer = scan_at(CELLS, PLACE), make_localizer()
    places = []
    for index in range(50):
        time = 0.02 * index
        localizer.add_odometry(standing(time, PLACE))
        places.append(localizer.locate(None))
        if index % 5 == 0:
            localizer.add_scan(scan._replace(time=time + 0.15))
    located = [place for place in places if place is not None]
    assert len(located) >= 3 and np.abs(errors(located[-1], PLACE)).max() < 3e-3


def test_scans_of_another_room_fit_less():
    """The mean is told once there are enough of them; in the right map nearly all beams fit."""
    fits = []
    for cells, pose in ((CELLS, PLACE), (room_cells(12.0, 9.0), Pose(10.5, 7.0, 1.0))):
        scan, localizer = scan_at(cells, pose), make_localizer()
        for index in range(FIT_COUNT):
            assert localizer.mean_fit is None
            stand(localizer, scan, PLACE, 0.2 * index)
        fits.append(localizer.mean_fit)
    assert fits[0] > 0.9 > 0.5 > fits[1]


def test_what_measures_nothing_says_nothing_and_half_a_circle_is_enough():
    """Beams of nan, inf, 0 and beyond the range are left out; in reverse they are the same."""
    scan = scan_at(CELLS, PLACE)
    for value in (math.nan, math.inf, -math.inf, 0.0, 1e3, -1.0):
        blank = scan._replace(ranges=np.full(len(scan.ranges), value))
        assert stand(make_localizer(), blank, PLACE) is None
    holes = scan.ranges.copy()
    holes[::3], holes[1::7], holes[2::11] = math.nan, math.inf, 0.0
    half = len(scan.ranges) // 2
    last = scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1)
    turned = scan._replace(ranges=scan.ranges[::-1], angle_min=last,
                           angle_increment=-scan.angle_increment, time_increment=0.0)
    for seen in (scan._replace(ranges=holes), scan._replace(ranges=scan.ranges[:half]), turned):
        localizer = make_localizer()
        place = None
        for index in range(10):
            place = stand(localizer, seen, Pose(1.52, 1.19, 0.41), 0.1 * index)
        assert np.abs(errors(place, PLACE)).max() < 6e-3


def with_box(scan, pose, box):
    """Let a scan see a box."""
    angles = pose.theta + scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    corners = np.array([box.transform(corner) for corner in BOX.outline])
    ranges = scan.ranges.copy()
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        side = end - start
        for index, angle in enumerate(angles.tolist()):
            ray = np.array([math.cos(angle), math.sin(angle)])
            matrix = np.column_stack([ray, -side])
            along, fraction = np.linalg.solve(matrix, start - pose[:2])
            if 0.0 <= fraction <= 1.0 and along > 0.0:
                ranges[index] = min(ranges[index], along)
    return scan._replace(ranges=ranges)


def test_what_neither_map_nor_object_explains_is_where_it_stands():
    """In the frame of the robot; in a room as the map has it there is nothing."""
    seen = with_box(scan_at(CELLS, PLACE), PLACE, Pose(2.4, 0.9, 0.7))
    for scan, measured, expected in ((scan_at(CELLS, PLACE), None, 0), (seen, None, 10),
                                     (seen, ObjectPose(0.0, Pose(2.4, 0.9, 0.7)), 0)):
        localizer = make_localizer()
        stand(localizer, scan, PLACE, measured=measured)
        points = localizer.unexplained.points
        assert (len(points) > 0) == (expected > 0) and len(points) >= expected
        for point in points:
            x, y = PLACE.transform(point)
            assert math.hypot(x - 2.4, y - 0.9) < 0.3


@pytest.mark.parametrize('duration', [0.4, 4.0])
def test_a_pose_of_a_camera_on_the_robot_stays_where_it_was_measured(duration: float) -> None:
    """A robot that turns away from the object sees who stands ahead, and not the object."""
    cells, ahead = room_cells(5.0, 4.0), Pose(0.9, 0.02, 0.3)
    start, end = Pose(2.5, 2.0, 0.1), Pose(2.5, 2.0, 0.1 + 0.5 * math.pi)
    localizer = make_localizer(cells)
    measured = ObjectPose(0.1, WORLD, relative=ahead)
    seen = with_box(scan_at(cells, start), start, start @ ahead)
    stand(localizer, seen, start, measured=measured)
    assert not len(localizer.unexplained.points)
    for fraction in np.linspace(0.0, 1.0, 21).tolist():
        localizer.add_odometry(standing(
            0.1 + duration * fraction, start._replace(theta=0.1 + 0.5 * math.pi * fraction)))
        localizer.locate(measured)
    seen = with_box(with_box(scan_at(cells, end), end, start @ ahead), end, end @ ahead)
    stand(localizer, seen, end, 0.2 + duration, measured)
    points = np.array(localizer.unexplained.points)
    assert len(points) > 10
    assert np.hypot(*(points - ahead[:2]).T).max() < 0.35


def test_the_object_is_no_wall():
    """A box along a wall displaces a place unless its pose is known, in the world or relative."""
    pose, box = Pose(0.7, 1.2, 0.0), Pose(0.9, 0.34, 0.003)
    cells = room_cells(1.6, 1.6)
    seen = with_box(scan_at(cells, pose), pose, box)
    relative = pose.inverse() @ box
    at = [stand(make_localizer(cells), seen, pose, measured=measured) for measured in (
        None, ObjectPose(0.0, box), ObjectPose(0.0, WORLD, relative=relative))]
    off = [np.abs(errors(place, pose)).max() for place in at]
    assert off[1] < 2e-3 and off[2] < 2e-3
    assert off[0] > 2.0 * max(off[1:])


def test_beams_that_measure_nothing_do_not_count():
    """Not numbers, zeros and those out of range change nothing; with few beams there is none."""
    scan = scan_at(CELLS, PLACE)
    # 360 beams, of which every second is used.
    ranges = scan.ranges.copy()
    ranges[10:20], ranges[50:60], ranges[90:100] = np.nan, 0.0, RANGE_MAX + 1.0
    place = stand(make_localizer(), scan._replace(ranges=ranges), PLACE)
    assert np.abs(errors(place, PLACE)).max() < 1.5e-3
    ranges[:300] = np.inf
    assert stand(make_localizer(), scan._replace(ranges=ranges), PLACE) is None


def test_a_scan_waits_for_odometry_of_its_end():
    """It is matched once, and not before."""
    localizer, scan = make_localizer(), scan_at(CELLS, PLACE)
    localizer.add_odometry(standing(0.0, PLACE))
    localizer.add_scan(scan)
    assert localizer.locate(None) is None
    localizer.add_odometry(standing(0.1, PLACE))
    assert localizer.locate(None) is not None
    assert localizer.locate(None) is None


def test_without_a_map_there_is_no_place():
    """A scan alone says nothing."""
    localizer = LidarLocalizer(EXACT, BOX)
    assert stand(localizer, scan_at(CELLS, PLACE), PLACE) is None


def test_a_robot_that_is_carried_away_is_lost_and_regained():
    """It says so, stays lost for a while, and is then where it is."""
    localizer, away = make_localizer(), Pose(2.2, 0.9, 0.9)
    stand(localizer, scan_at(CELLS, PLACE), PLACE)
    scan = scan_at(CELLS, away)
    places = [stand(localizer, scan, PLACE, 0.1 * index) for index in range(1, 40)]
    statuses = [place.status for place in places]
    assert PlaceStatus.LOST not in statuses[:MAX_MISFITS - 1]
    assert PlaceStatus.REGAINED in statuses
    assert statuses[-1] is PlaceStatus.TRACKED
    assert np.abs(errors(places[-1], away)).max() < 3e-3


def test_a_robot_in_another_room_stays_lost():
    """No place is taken that does not fit well."""
    localizer = make_localizer()
    stand(localizer, scan_at(CELLS, PLACE), PLACE)
    other = room_cells(9.0, 9.0)
    scan = scan_at(other, Pose(4.5, 4.5, 0.3))
    places = [stand(localizer, scan, PLACE, 0.1 * index) for index in range(1, 60)]
    assert all(place.status is PlaceStatus.LOST for place in places[MAX_MISFITS:])


def uneven_room_scan(knots, pose, rng):
    """Measure four walls that are where the map has them but for errors that vary along them."""
    angles = -math.pi + 2.0 * math.pi / 180 * np.arange(180)
    directions = angles + pose.theta
    rays = np.stack([np.cos(directions), np.sin(directions)])
    walls = np.where(rays > 0.0, np.array([[5.1], [4.1]]), 0.1)
    hits = (walls - np.array([[pose.x], [pose.y]])) / rays
    axis = hits.argmin(axis=0)
    ranges = hits.min(axis=0)
    ends = np.array([[pose.x], [pose.y]]) + ranges * rays
    for index in range(180):
        side = rays[axis[index], index]
        along = ends[1 - axis[index], index]
        error = np.interp(along, 1.4 * np.arange(5), knots[2 * axis[index] + (side > 0.0)])
        ranges[index] += error / side
    return LidarScan(0.0, ranges + 0.02 * rng.standard_normal(180), -math.pi,
                     2.0 * math.pi / 180, 0.0, 0.1, RANGE_MAX)


@pytest.mark.slow
def test_stated_errors_are_those_of_drawn_tours():
    """
    Normalized squares of errors average to about one, in rooms whose walls are a little off.

    Walls err by three tenths of a cell, by something else every 1.4 m; odometry by scale, drift
    and walk. The error lasts, so that each tour counts once.
    """
    squares, drifts = [], []
    settings = dataclasses.replace(PlaceSettings(), wall_offset=0.0)
    for seed in range(24):
        rng = np.random.default_rng(seed)
        knots = 0.3 * 0.05 * rng.standard_normal((4, 5))
        localizer = make_localizer(room_cells(5.0, 4.0), settings=settings)
        pose = claim = Pose(1.0, 1.0, 0.0)
        scale, drift = 0.02 * rng.standard_normal(2)
        for index in range(25):
            step = 0.08 + 0.003 * rng.standard_normal()
            turn = 0.04 + 0.003 * rng.standard_normal()
            pose = pose @ Pose(step, 0.0, turn)
            claim = claim @ Pose((1.0 + scale) * step, 0.0, turn + drift * step)
            place = stand_at(localizer, uneven_room_scan(knots, pose, rng), claim, 0.1 * index)
        error = errors(place, pose)
        squares.append(error @ np.linalg.solve(place.covariance.matrix, error) / 3.0)
        drifts.append(math.hypot(claim.x - pose.x, claim.y - pose.y))
    assert 0.3 < np.mean(squares) < 1.3
    assert np.mean(drifts) > 0.02


def stand_at(localizer, scan, claim, time):
    """Take in odometry and a scan of the same time."""
    localizer.add_odometry(standing(time, claim))
    localizer.add_scan(scan._replace(time=time))
    return localizer.locate(None)


def test_the_helper_casts_what_it_should():
    """Straight ahead it measures the distance to the wall."""
    assert cast(CELLS, WORLD, Pose(1.0, 1.0, 0.0), np.array([0.0, math.pi]))[1] == pytest.approx(
        0.9, abs=3e-3)


def test_what_stands_in_neither_map_nor_way_is_left_out():
    """A box that stands in the room lowers the fit, unless the robot knows where it is."""
    cells = CELLS.copy()
    # Between 2.3 and 2.7 m, 1.3 and 1.7 m of the world.
    cells[26:34, 46:54] = True
    scan, fits = scan_at(cells, PLACE), {}
    for known in (True, False):
        localizer = make_localizer()
        if known:
            localizer.set_standing([(BOX, Pose(2.5, 1.5, 0.0))])
        for index in range(FIT_COUNT):
            place = stand(localizer, scan, PLACE, 0.1 * index)
        fits[known] = localizer.mean_fit
    assert np.abs(errors(place, PLACE)).max() < 0.01
    assert fits[True] > 0.99 and fits[False] < 0.98
