"""Paths to a contact: clear of the object, without needless stops, quicker than with them."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.paths import approaches, drive_along
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.approach.approach_path import approach_time, ARC_ALLOWANCE, plan_approach
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, Path, PathFailure, sample_path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import MotionSection, split_at_stops, travel_time
import pytest

SETTINGS = DriveSettings()
PLANK = dataclasses.replace(box(), outline=((-0.4, -0.15), (0.4, -0.15), (0.4, 0.15),
                                            (-0.4, 0.15)))
OBJECTS = {'box': box(), 'bin': bin_(), 'plank': PLANK}
ROBOTS = {drive: RoundRobot(0.17, drive, 0.3, 1.9, 0.9, 6.0) for drive in ('differential',
                                                                           'holonomic')}
either = pytest.mark.parametrize('drive', ROBOTS)
each = pytest.mark.parametrize('name', OBJECTS)
SPEED = 0.2


@each
@either
def test_the_robot_never_overlaps_the_object(name, drive):
    """It leads straight off, keeps the clearance but for arcs, and ends along the push."""
    obj, robot = OBJECTS[name], ROBOTS[drive]
    for object_pose, start, contact in approaches(obj, 16, seed=1):
        path = plan_approach(robot, obj, object_pose, start, contact, SETTINGS)
        assert path.poses[0] == start and path.poses[-1][:2] == contact[:2]
        last = path.segments[-1]
        assert abs(wrap_angle(last.directions[1] - contact.theta)) < 1e-6
        rows = sample_path(path, robot, 0.003)
        gaps = np.array([find_contact(obj, object_pose, row, 0.17).gap for row in rows])
        assert gaps.min() > -1e-4
        limit = (1.0 - ARC_ALLOWANCE) * SETTINGS.clearance - 5e-4
        first, last = (np.argmax(row > min(limit, gaps.max() - 1e-9))
                       for row in (gaps, gaps[::-1]))
        assert np.all(np.diff(gaps[:first]) > -1e-9)
        assert np.all(np.diff(gaps[len(gaps) - last:]) < 1e-9)
        assert gaps[first:len(gaps) - last].min() > min(limit, gaps.max() - 1e-6)


@either
def test_it_leads_round_a_fine_outline(drive):
    """However many corners there are, in hardly more time than round the disc."""
    disc, robot = OBJECTS['bin'], ROBOTS[drive]
    count, radius = 60, disc.radius
    fine = dataclasses.replace(disc, radius=0.0, outline=tuple(
        (radius * math.cos(math.tau * i / count), radius * math.sin(math.tau * i / count))
        for i in range(count)))
    here, start = Pose(0.0, 0.0, 0.0), Pose(radius + 0.6, 0.1, 2.5)
    contact = Pose(-radius - robot.radius, 0.0, 0.0)
    times = [travel_time(plan_approach(robot, obj, here, start, contact, SETTINGS), robot,
                         SETTINGS) for obj in (disc, fine)]
    assert 0.99 * times[0] < times[1] < 1.5 * times[0]


@each
@either
def test_it_is_not_slower_than_a_path_with_stops(name, drive):
    """As the robot's own path planner has it, with a straight line behind; mostly far quicker."""
    obj, robot = OBJECTS[name], ROBOTS[drive]
    saved = []
    for object_pose, start, contact in approaches(obj, 15, seed=2):
        goal = contact if drive == 'differential' else contact._replace(theta=start.theta)
        standoff = goal._replace(x=goal.x - SETTINGS.standoff * math.cos(contact.theta),
                                 y=goal.y - SETTINGS.standoff * math.sin(contact.theta))
        stopping = plan_path(robot, obj, object_pose, start, standoff, SETTINGS)
        stopping = Path((*stopping.poses, goal), (*stopping.arc_angles, 0.0))
        path = plan_approach(robot, obj, object_pose, start, contact, SETTINGS, end_speed=SPEED)
        saved.append(travel_time(stopping, robot, SETTINGS, end_speed=SPEED)
                     - travel_time(path, robot, SETTINGS, end_speed=SPEED))
    assert min(saved) > -1e-6
    assert np.median(saved) > (1.0 if drive == 'differential' else 0.3)


@either
def test_the_robot_changes_its_direction_once_at_most(drive):
    """From contact it backs off, and then goes forwards into the next contact: two sections."""
    robot = ROBOTS[drive]
    for object_pose, start, contact in approaches(box(), 20, seed=3):
        path = plan_approach(robot, box(), object_pose, start, contact, SETTINGS)
        sections = split_at_stops(path, SETTINGS.limited_to(robot), SPEED)
        assert len(sections) <= 3
        last = sections[-1]
        assert isinstance(last, MotionSection)
        assert drive == 'holonomic' or not last.is_backwards


@either
def test_the_mirror_image_takes_as_long(drive):
    """Left and right are alike."""
    robot = ROBOTS[drive]
    flipped = dataclasses.replace(PLANK, outline=tuple((x, -y) for x, y in PLANK.outline[::-1]))

    def mirror(pose):
        return Pose(pose.x, -pose.y, -pose.theta)

    for object_pose, start, contact in approaches(PLANK, 10, seed=4):
        times = [travel_time(plan_approach(robot, *poses, SETTINGS), robot, SETTINGS)
                 for poses in ((PLANK, object_pose, start, contact),
                               (flipped, *map(mirror, (object_pose, start, contact))))]
        assert times[0] == pytest.approx(times[1], abs=0.05)


@each
@either
def test_the_follower_passes_the_contact_place_moving(name, drive):
    """With a lag of 0.1 s: across within 10 mm and 2.5 degrees, in the time that was planned."""
    obj, robot = OBJECTS[name], ROBOTS[drive]
    for object_pose, start, contact in approaches(obj, 8, seed=5):
        path = plan_approach(robot, obj, object_pose, start, contact, SETTINGS, end_speed=SPEED)
        run = drive_along(path, robot, SETTINGS, SPEED)
        assert run.follower.finished and not run.follower.missed
        assert abs(run.aside) < 0.01 and abs(run.turned) < math.radians(2.5)
        expected = travel_time(path, robot, SETTINGS, end_speed=SPEED)
        assert run.time == pytest.approx(expected, abs=0.3)


@each
@either
def test_its_time_is_known_without_the_path(name, drive):
    """The same as that of the path, but for rotations that are left out of it."""
    obj, robot = OBJECTS[name], ROBOTS[drive]
    for object_pose, start, contact in approaches(obj, 10, seed=6):
        poses = object_pose, start, contact
        path = plan_approach(robot, obj, *poses, SETTINGS, end_speed=SPEED)
        assert approach_time(robot, obj, *poses, SETTINGS, end_speed=SPEED) == pytest.approx(
            travel_time(path, robot, SETTINGS, end_speed=SPEED), abs=0.005)


@each
def test_a_robot_that_has_backed_off_drives_no_detour(name):
    """A few centimetres off the contact: as planned, and at most the way back longer."""
    obj, robot = OBJECTS[name], ROBOTS['differential']
    for object_pose, start, contact in approaches(obj, 25, seed=8):
        back = start @ Pose(-0.07, 0.0, 0.0)
        path = plan_approach(robot, obj, object_pose, back, contact, SETTINGS, end_speed=SPEED)
        time = travel_time(path, robot, SETTINGS, end_speed=SPEED)
        assert approach_time(robot, obj, object_pose, back, contact, SETTINGS,
                             end_speed=SPEED) == pytest.approx(time, abs=0.005)
        at_contact = plan_approach(robot, obj, object_pose, start, contact, SETTINGS,
                                   end_speed=SPEED)
        assert time < travel_time(at_contact, robot, SETTINGS, end_speed=SPEED) + 1.0


@either
def test_it_starts_wherever_the_robot_is(drive):
    """Far away, a few centimetres off the object, with its back to it, on the other side."""
    robot, contact = ROBOTS[drive], Pose(-0.37, 0.05, 0.2)
    for start in (Pose(-2.0, 1.0, 2.0), Pose(-0.4, 0.0, 0.0), Pose(-0.39, 0.1, 0.3),
                  Pose(-0.37, 0.0, math.pi), Pose(-0.4, 0.1, 1.5), Pose(0.37, 0.0, 3.0),
                  Pose(0.1, 0.45, 0.0)):
        path = plan_approach(robot, box(), Pose(0.0, 0.0, 0.0), start, contact, SETTINGS)
        rows = sample_path(path, robot, 0.01)
        gaps = [find_contact(box(), Pose(0.0, 0.0, 0.0), row, 0.17).gap for row in rows]
        assert min(gaps) > -1e-4
        run = drive_along(path, robot, SETTINGS, SPEED)
        assert run.follower.finished


def test_it_does_not_matter_where_the_world_begins():
    """Everything moved and rotated: the same path, moved and rotated."""
    robot, move = ROBOTS['differential'], Pose(3.0, -2.0, 2.5)
    for poses in approaches(PLANK, 8, seed=7):
        path = plan_approach(robot, PLANK, *poses, SETTINGS)
        moved = plan_approach(robot, PLANK, *(move @ pose for pose in poses), SETTINGS)
        assert len(moved.poses) == len(path.poses)
        for one, other in zip(path.poses, moved.poses):
            assert other[:2] == pytest.approx((move @ one)[:2], abs=1e-4)


def test_in_a_map_it_keeps_off_the_obstacles():
    """A wall where the quickest path passes: another side, or no path."""
    robot, contact, start = ROBOTS['differential'], Pose(0.37, 0.1, math.pi), Pose(-0.37, 0.1, 0.0)
    free = plan_approach(robot, box(), Pose(0.0, 0.0, 0.0), start, contact, SETTINGS)
    upper = max(pose.y for pose in free.poses)
    lower = min(pose.y for pose in free.poses)
    side = 1.0 if upper > -lower else -1.0
    occupied = np.zeros((120, 120), dtype=bool)
    wall = slice(70, 74) if side > 0.0 else slice(46, 50)
    occupied[wall, 40:80] = True
    room = OccupancyMap(0.05, Pose(-3.0, -3.0, 0.0), occupied)
    path = plan_approach(robot, box(), Pose(0.0, 0.0, 0.0), start, contact, SETTINGS,
                         occupancy_map=room)
    rows = sample_path(path, robot, 0.02)
    assert room.robot_is_free(robot, rows, SETTINGS.map_clearance - 0.02)
    assert not room.robot_is_free(robot, sample_path(free, robot, 0.02), 0.0)
    occupied[46:50, 40:80] = occupied[70:74, 40:80] = True
    occupied[46:74, 40:44] = occupied[46:74, 76:80] = True
    closed = OccupancyMap(0.05, Pose(-3.0, -3.0, 0.0), occupied)
    with pytest.raises(NoPathFound):
        plan_approach(robot, box(), Pose(0.0, 0.0, 0.0), start, contact, SETTINGS,
                      occupancy_map=closed)


def test_poses_inside_the_object_are_refused():
    """By name."""
    robot, inside, far = ROBOTS['differential'], Pose(0.1, 0.0, 0.0), Pose(-1.0, 0.0, 0.0)
    for code, poses in ((PathFailure.START_IN_OBJECT, (inside, far)),
                        (PathFailure.GOAL_IN_OBJECT, (far, inside))):
        with pytest.raises(NoPathFound) as failure:
            plan_approach(robot, box(), Pose(0.0, 0.0, 0.0), *poses, SETTINGS)
        assert failure.value.report.code is code
    with pytest.raises(ValueError, match='contact_pose: got'):
        plan_approach(robot, box(), Pose(0.0, 0.0, 0.0), far, Pose(math.nan, 0.0, 0.0), SETTINGS)


def reversed_distances(path):
    """List how far a differential drive moves backwards on a path before it goes forwards."""
    distances = [0.0]
    for segment in path.segments:
        if segment.length > 0.0:
            if math.cos(segment.directions[0] - segment.start.theta) < 0.0:
                distances[-1] += segment.length
            else:
                distances.append(0.0)
    return distances


@each
def test_it_moves_backwards_no_farther_than_the_limit_or_off_the_object(name):
    """Without a limit some approaches are quicker backwards."""
    obj, robot = OBJECTS[name], ROBOTS['differential']
    limited = dataclasses.replace(SETTINGS, reverse_limit=0.06)
    longest = []
    for object_pose, start, contact in approaches(obj, 20, seed=8):
        paths = [plan_approach(robot, obj, object_pose, start, contact, settings)
                 for settings in (SETTINGS, limited)]
        longest.append([max(reversed_distances(path)) for path in paths])
    free, bound = np.array(longest).T
    assert free.max() > 0.2
    assert bound.max() < 0.13
