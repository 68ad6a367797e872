"""Paths round the object: clear of it, shortest, the same however one looks at them."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.path import NoPathFound, PathFailure, sample_path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import MotionSection, split_at_stops, travel_time
import pytest
from scipy.sparse.csgraph import dijkstra

SETTINGS = DriveSettings()
OBJECTS = {'box': box(), 'bin': bin_(),
           'plank': dataclasses.replace(box(), outline=((-0.6, -0.1), (0.5, -0.15), (0.7, 0.0),
                                                        (0.5, 0.12), (-0.55, 0.1)))}
ROBOTS = {drive: RoundRobot(0.17, drive) for drive in ('differential', 'holonomic')}
either = pytest.mark.parametrize('drive', ROBOTS)
each = pytest.mark.parametrize('name', OBJECTS)
# Why a path is refused of which an end lies inside the object.
INSIDE = {'start': PathFailure.START_IN_OBJECT, 'goal': PathFailure.GOAL_IN_OBJECT}


def tasks(obj, count, seed, clear=True):
    """Yield (object pose, start, goal), both poses clear of the object or just clear."""
    rng = np.random.default_rng(seed)
    least = SETTINGS.clearance if clear else 0.0
    while count:
        object_pose = Pose(*rng.uniform(-1.0, 1.0, 2), rng.uniform(-4.0, 4.0))
        ends = [Pose(*rng.uniform(-1.5, 1.5, 2), rng.uniform(-4.0, 4.0)) for _ in range(2)]
        if all(find_contact(obj, object_pose, pose, 0.17).gap > least for pose in ends):
            count -= 1
            yield (object_pose, *ends)


def gaps(obj, object_pose, rows, robot):
    """Compute the distance between robot and object at each pose."""
    return np.array([find_contact(obj, object_pose, row, robot.radius).gap for row in rows])


def outside_distances(obj, points):
    """Compute the distance of points from the outline, 0 inside."""
    if not obj.outline:
        return np.hypot(*points.T) - obj.radius
    first = np.array(obj.outline)
    edges = np.roll(first, -1, axis=0) - first
    from_first = points[:, None] - first
    fractions = np.clip((from_first * edges).sum(axis=2) / (edges ** 2).sum(axis=1), 0.0, 1.0)
    away = np.linalg.norm(from_first - fractions[..., None] * edges, axis=2).min(axis=1)
    across = edges[:, 0] * from_first[..., 1] - edges[:, 1] * from_first[..., 0]
    return np.where((across > 0.0).all(axis=1), 0.0, away)


def shortest(obj, object_pose, start, goal, margin, count=180):
    """Compute the shortest length by a visibility graph on points of the inflated outline."""
    corners = np.array(obj.outline or ((0.0, 0.0),))
    angles = 2.0 * np.pi * np.arange(count) / count
    normals = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    rim = (corners[np.argmax(normals @ corners.T, axis=1)]
           + 1.0005 * (obj.radius + margin) * normals)
    ends = [object_pose.inverse().transform(pose[:2]) for pose in (start, goal)]
    points = np.concatenate([rim, ends])
    lengths = np.zeros((len(points), len(points)))
    fractions = np.linspace(0.0, 1.0, 101)[:, None]
    for i in range(count):
        for j in ((i + 1) % count, count, count + 1):
            line = points[i] + fractions * (points[j] - points[i])
            if outside_distances(obj, line).min() > margin - 2e-4:
                lengths[i, j] = lengths[j, i] = np.linalg.norm(points[i] - points[j])
    return dijkstra(lengths, indices=count)[count + 1]


@each
@either
def test_the_robot_keeps_the_clearance(name, drive):
    """Wherever it starts and goes, and it does start and end as asked for."""
    obj, robot = OBJECTS[name], ROBOTS[drive]
    for object_pose, start, goal in tasks(obj, 40, seed=1):
        path = plan_path(robot, obj, object_pose, start, goal, SETTINGS)
        assert path.poses[0] == start and path.poses[-1] == goal
        rows = sample_path(path, robot, 0.02)
        assert gaps(obj, object_pose, rows, robot).min() > SETTINGS.clearance - 1e-6


@each
def test_the_path_is_the_shortest(name):
    """As long as the shortest one through many points of the inflated outline, where blocked."""
    obj, robot, compared = OBJECTS[name], ROBOTS['holonomic'], 0
    for object_pose, start, goal in tasks(obj, 30, seed=2):
        start, goal = (pose._replace(theta=0.0) for pose in (start, goal))
        path = plan_path(robot, obj, object_pose, start, goal, SETTINGS)
        straight = math.dist(start[:2], goal[:2])
        assert path.length >= straight - 1e-9
        if path.length > straight + 1e-9 and compared < 4:
            compared += 1
            least = shortest(obj, object_pose, start, goal, robot.radius + SETTINGS.clearance)
            assert path.length == pytest.approx(least, rel=3e-3)
    assert compared == 4


@either
def test_it_does_not_matter_where_the_world_begins(drive):
    """Everything moved and rotated: the same path, moved and rotated."""
    obj, robot, move = OBJECTS['plank'], ROBOTS[drive], Pose(3.0, -2.0, 2.5)
    for object_pose, start, goal in tasks(obj, 15, seed=3, clear=False):
        path = plan_path(robot, obj, object_pose, start, goal, SETTINGS)
        moved = plan_path(robot, obj, move @ object_pose, move @ start, move @ goal, SETTINGS)
        assert len(moved.poses) == len(path.poses)
        for one, other in zip(path.poses, moved.poses):
            expected = move @ one
            assert other[:2] == pytest.approx(expected[:2], abs=1e-6)
            assert abs(wrap_angle(other.theta - expected.theta)) < 1e-6


@either
def test_the_mirror_image_takes_as_long(drive):
    """Left and right are alike."""
    obj, robot = OBJECTS['plank'], ROBOTS[drive]
    flipped = dataclasses.replace(obj, outline=tuple((x, -y) for x, y in obj.outline[::-1]))

    def mirror(pose):
        return Pose(pose.x, -pose.y, -pose.theta)

    for object_pose, start, goal in tasks(obj, 15, seed=4, clear=False):
        time, other = (travel_time(plan_path(robot, *task, SETTINGS), robot, SETTINGS)
                       for task in ((obj, object_pose, start, goal),
                                    (flipped, *map(mirror, (object_pose, start, goal)))))
        assert time == pytest.approx(other, abs=1e-6)


@each
@either
def test_from_contact_it_leads_straight_off(name, drive):
    """The gap grows all the path out to the clearance, and shrinks likewise on the path in."""
    obj, robot, object_pose = OBJECTS[name], ROBOTS[drive], Pose(0.2, -0.1, 0.7)
    rng = np.random.default_rng(5)
    for toward in rng.uniform(-math.pi, math.pi, 12):
        far = Pose(object_pose.x + 3.0 * math.cos(toward), object_pose.y + 3.0 * math.sin(toward),
                   0.0)
        _, normal, gap = find_contact(obj, object_pose, far, robot.radius)
        touching = Pose(far.x + gap * math.cos(normal), far.y + gap * math.sin(normal),
                        normal + rng.uniform(-0.6, 0.6))
        other = Pose(object_pose.x - 1.2, object_pose.y, 0.0)
        for ends in ((touching, other), (other, touching)):
            path = plan_path(robot, obj, object_pose, *ends, SETTINGS)
            away = gaps(obj, object_pose, sample_path(path, robot, 0.005), robot)
            away = away if ends[0] is touching else away[::-1]
            clear = int(np.argmax(away > SETTINGS.clearance - 1e-6))
            assert 0 < clear and np.all(np.diff(away[:clear + 1]) > -1e-9)
            assert away[clear:].min() > SETTINGS.clearance - 1e-6


@each
@either
def test_it_stops_no_more_than_it_must(name, drive):
    """Straight off the object, round it in one go, straight on to it, and rotations between."""
    obj, robot, object_pose = OBJECTS[name], ROBOTS[drive], Pose(0.3, 0.4, 1.1)
    rng, seen = np.random.default_rng(6), set()
    for _ in range(60):
        ends = []
        for gap in rng.choice((0.0, 0.02, SETTINGS.clearance, 0.06, 0.3), 2):
            toward = rng.uniform(-math.pi, math.pi)
            far = Pose(object_pose.x + 3.0 * math.cos(toward),
                       object_pose.y + 3.0 * math.sin(toward), rng.uniform(-4.0, 4.0))
            _, normal, away = find_contact(obj, object_pose, far, robot.radius)
            ends.append(far._replace(x=far.x + (away - gap) * math.cos(normal),
                                     y=far.y + (away - gap) * math.sin(normal)))
        limits = SETTINGS.limited_to(robot)
        sections = split_at_stops(plan_path(robot, obj, object_pose, *ends, SETTINGS), limits)
        moving = sum(isinstance(section, MotionSection) for section in sections)
        near = sum(find_contact(obj, object_pose, pose, robot.radius).gap
                   < SETTINGS.clearance - 1e-6 for pose in ends)
        assert moving <= 1 + near
        assert len(sections) - moving <= (2 + near if drive == 'differential' else 0)
        seen.add(moving)
    assert seen == {1, 2, 3}


def test_a_differential_drive_backs_off_without_rotating_at_the_object():
    """Its first segment is straight, backwards."""
    start = Pose(-0.37, 0.02, 0.3)
    path = plan_path(ROBOTS['differential'], box(), Pose(0.0, 0.0, 0.0), start,
                     Pose(-1.0, 0.5, 0.0), SETTINGS)
    first = path.segments[0]
    assert first.length > 0.0 and abs(first.heading_change) < 1e-12
    assert abs(wrap_angle(first.directions[0] - start.theta)) == pytest.approx(math.pi)


def test_backwards_only_as_far_as_is_allowed():
    """Short paths behind the robot are driven backwards, as turning round costs time."""
    robot = ROBOTS['differential']
    forwards = dataclasses.replace(SETTINGS, max_reverse_distance=0.0)
    start = Pose(-0.6, 0.0, 0.0)
    for length, settings, backwards in ((0.3, SETTINGS, True), (0.3, forwards, False),
                                        (0.7, SETTINGS, False)):
        path = plan_path(robot, box(), Pose(0.0, 0.0, 0.0), start,
                         Pose(start.x - length, 0.1, 0.0), settings)
        moving = [segment for segment in path.segments if segment.length]
        assert all((math.cos(segment.start.theta - segment.directions[0]) < 0.0) == backwards
                   for segment in moving)


def test_more_clearance_never_shortens_the_path():
    """Paths grow with the clearance, and come to the straight line without an object between."""
    robot, obj = ROBOTS['holonomic'], box()
    ends = Pose(-1.0, 0.0, 0.0), Pose(1.0, 0.05, 0.0)
    lengths = [plan_path(robot, obj, Pose(0.0, 0.0, 0.0), *ends,
                         dataclasses.replace(SETTINGS, clearance=clearance)).length
               for clearance in (0.01, 0.05, 0.1, 0.2, 0.3)]
    assert np.all(np.diff(lengths) > 0.0)
    far = plan_path(robot, obj, Pose(0.0, 2.0, 0.0), *ends, SETTINGS)
    assert far.length == pytest.approx(math.dist(ends[0][:2], ends[1][:2]))


def test_what_cannot_be_is_refused_by_name():
    """Numbers that are not finite, robots that are not round, places inside the object."""
    obj, robot = box(), ROBOTS['differential']
    poses = {'object_pose': Pose(0.0, 0.0, 0.0), 'start': Pose(-1.0, 0.0, 0.0),
             'goal': Pose(1.0, 0.0, 0.0)}
    for name in poses:
        wrong = {**poses, name: Pose(math.nan, 0.0, 0.0)}
        with pytest.raises(ValueError, match=f'{name}: got'):
            plan_path(robot, obj, settings=SETTINGS, **wrong)
    for radius in (0.0, math.inf):
        with pytest.raises(ValueError, match='robot.radius: got'):
            plan_path(RoundRobot(radius), obj, settings=SETTINGS, **poses)
    for name, code in INSIDE.items():
        with pytest.raises(NoPathFound) as failure:
            plan_path(robot, obj, settings=SETTINGS, **{**poses, name: Pose(0.0, 0.0, 0.0)})
        assert failure.value.report.code is code
        assert 0.3 <= failure.value.report.values['overlap'] < 0.4
