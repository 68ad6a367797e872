"""Maps: distances that never flatter, and ways among obstacles."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, sample_path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
import pytest
from scipy.ndimage import label

RESOLUTION = 0.05
SETTINGS = DriveSettings()
ROBOTS = {drive: RoundRobot(0.17, drive) for drive in ('differential', 'holonomic')}
ASIDE = Pose(-1.5, -2.2, 0.4)
either = pytest.mark.parametrize('drive', ROBOTS)


def room(*blocks, side=6.0, resolution=RESOLUTION, origin=None):
    """Return a square room about the origin with blocks (x0, x1, y0, y1) in it."""
    count = round(side / resolution)
    occupied = np.zeros((count, count), dtype=bool)
    for block in blocks:
        x0, x1, y0, y1 = (round((value + 0.5 * side) / resolution) for value in block)
        occupied[y0:y1, x0:x1] = True
    return OccupancyMap(resolution, origin or Pose(-0.5 * side, -0.5 * side, 0.0), occupied)


def door(width):
    """Return a room with a wall along y, and a door in it about y = 1."""
    return room((-0.05, 0.05, -3.0, 1.0 - width / 2), (-0.05, 0.05, 1.0 + width / 2, 3.0))


def true_distances(occupancy_map, points):
    """Compute the distance to the nearest occupied square, cell by cell, the border included."""
    rows, columns = np.nonzero(occupancy_map.occupied)
    centers = np.stack((columns + 0.5, rows + 0.5), axis=1) * occupancy_map.resolution
    local = np.array([occupancy_map.origin.inverse().transform(point) for point in points])
    apart = np.abs(local[:, None, :] - centers) - 0.5 * occupancy_map.resolution
    inner = np.linalg.norm(np.maximum(apart, 0.0), axis=2).min(axis=1)
    size = np.array(occupancy_map.occupied.shape[::-1]) * occupancy_map.resolution
    return np.minimum(inner, np.minimum(local, size - local).min(axis=1))


def scattered(seed, origin=None):
    """Return a map with a few occupied cells, at random."""
    occupied = np.random.default_rng(seed).random((40, 60)) < 0.01
    return OccupancyMap(RESOLUTION, origin or Pose(0.0, 0.0, 0.0), occupied)


def test_clearance_is_never_too_long_and_hardly_too_short():
    """Against the distance to every square; a map that lies askew too."""
    rng = np.random.default_rng(1)
    for origin in (Pose(0.0, 0.0, 0.0), Pose(2.0, -1.0, 2.2)):
        occupancy_map = scattered(2, origin)
        local = rng.uniform(0.0, 1.0, (2000, 2)) * (3.0, 2.0)
        points = np.array([origin.transform(point) for point in local])
        short = true_distances(occupancy_map, points) - occupancy_map.clearance(points)
        assert short.min() >= -1e-12
        assert short.max() < 1.6 * RESOLUTION


def test_outside_the_map_is_an_obstacle():
    """However far."""
    points = [(-0.01, 1.0), (1.0, 2.01), (-50.0, 3.0), (4.0, 90.0)]
    assert np.all(scattered(3).clearance(points) < 0.0)


@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_a_free_object_keeps_the_margin_and_a_clear_one_is_free(obj):
    """Against the distance from the outline to all occupied cells."""
    occupancy_map, rng, margin = scattered(4), np.random.default_rng(5), 0.05
    rows, columns = np.nonzero(occupancy_map.occupied)
    centers = np.stack((columns + 0.5, rows + 0.5), axis=1) * RESOLUTION
    seen = set()
    for _ in range(150):
        pose = Pose(*rng.uniform(0.2, 1.8, 2), rng.uniform(-3.0, 3.0))
        away = min(find_contact(obj, pose, center, 0.0)[2] for center in centers)
        corners = obj.outline or [(obj.radius * math.cos(a), obj.radius * math.sin(a))
                                  for a in np.linspace(0.0, 6.3, 40)]
        border = min(min(x, y, 3.0 - x, 2.0 - y) for x, y in map(pose.transform, corners))
        free = occupancy_map.object_is_free(obj, [pose], margin)
        seen.add(free)
        if free:
            assert min(away - 0.5 * RESOLUTION, border) >= margin - 1e-3
        if min(away, border) > margin + 2.7 * RESOLUTION:
            assert free
    assert seen == {True, False}


def test_an_object_over_an_obstacle_is_not_free():
    """A single cell under its middle is seen, although its edge is far away."""
    occupied = np.zeros((60, 60), dtype=bool)
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), occupied)
    assert occupancy_map.object_is_free(box(0.8), [Pose(1.5, 1.5, 0.3)], 0.0)
    occupied[30, 30] = True
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), occupied)
    assert not occupancy_map.object_is_free(box(0.8), [Pose(1.5, 1.5, 0.3)], 0.0)


def test_the_first_hit_is_told():
    """The robot and the object drive at a wall; it is the first pose that is too near."""
    occupancy_map, poses = door(0.8), [(x, -1.0, 0.0) for x in np.arange(-2.0, 0.0, 0.02)]
    for number, size in ((occupancy_map.first_robot_collision(ROBOTS['holonomic'], poses, 0.05), 0.17),
                         (occupancy_map.first_object_collision(box(), poses, 0.05), 0.2),
                         (occupancy_map.first_object_collision(bin_(), poses, 0.05), 0.2)):
        assert -0.05 - size - 0.05 - 2.0 * RESOLUTION < poses[number][0] < -0.08 - size
    assert occupancy_map.first_robot_collision(ROBOTS['holonomic'], poses[:20], 0.05) is None
    assert occupancy_map.first_object_collision(box(), poses[:20], 0.05) is None


@either
def test_ways_keep_clear_of_obstacles_and_object(drive):
    """Random ends in a room with a door and some furniture, the object in it."""
    robot, obj, rng, found = ROBOTS[drive], box(), np.random.default_rng(6), 0
    occupancy_map = room((-0.05, 0.05, -3.0, 0.5), (-0.05, 0.05, 1.4, 3.0), (1.2, 1.6, -1.0, -0.5),
                         (-2.0, -1.5, -1.5, -0.5))
    while found < 25:
        object_pose = Pose(*rng.uniform(-2.0, 2.0, 2), rng.uniform(-3.0, 3.0))
        ends = [Pose(*rng.uniform(-2.6, 2.6, 2), rng.uniform(-3.0, 3.0)) for _ in range(2)]
        try:
            way = plan_path(robot, obj, object_pose, *ends, SETTINGS, occupancy_map=occupancy_map)
        except NoPathFound:
            continue
        found += 1
        assert way.poses[0] == ends[0] and way.poses[-1] == ends[1]
        rows = sample_path(way, robot, 0.01)
        least = min(SETTINGS.map_clearance, occupancy_map.clearance([ends[0][:2]])[0] - robot.radius)
        assert true_distances(occupancy_map, rows[:, :2]).min() > robot.radius + least - 1e-9
        gaps = np.array([find_contact(obj, object_pose, row, robot.radius)[2] for row in rows])
        inside = gaps >= SETTINGS.clearance - 1e-6
        assert np.all(inside[int(np.argmax(inside)):len(inside) - int(np.argmax(inside[::-1]))])


@either
def test_it_goes_through_a_door_and_not_through_a_slit(drive):
    """The way through the door is little longer than the taut one; the slit is refused."""
    robot, obj = ROBOTS[drive], box()
    start, goal = Pose(-1.5, 0.0, 0.0), Pose(1.5, 0.0, 0.0)
    way = plan_path(robot, obj, ASIDE, start, goal, SETTINGS, occupancy_map=door(0.8))
    post = math.dist(start[:2], (0.0, 0.6 + 0.17 + SETTINGS.map_clearance))
    assert 2.0 * post < way.length < 1.06 * 2.0 * post
    with pytest.raises(NoPathFound, match='obstacles of the map'):
        plan_path(robot, obj, ASIDE, start, goal, SETTINGS, occupancy_map=door(0.4))


def test_the_object_in_the_door_is_an_obstacle_too():
    """The robot can neither push through nor get past."""
    start, goal = Pose(-1.5, 0.0, 0.0), Pose(1.5, 0.0, 0.0)
    with pytest.raises(NoPathFound, match='obstacles of the map, or the object between them'):
        plan_path(ROBOTS['holonomic'], box(), Pose(0.0, 1.0, 0.0), start, goal, SETTINGS,
                  occupancy_map=door(0.8))


def test_one_side_of_the_object_is_walled_up():
    """It takes the other side, the longer one, without a lattice."""
    robot, obj, object_pose = ROBOTS['holonomic'], box(), Pose(0.0, 0.0, 0.0)
    start, goal = Pose(-1.0, 0.1, 0.0), Pose(1.0, 0.1, 0.0)
    free = plan_path(robot, obj, object_pose, start, goal, SETTINGS)
    walled = plan_path(robot, obj, object_pose, start, goal, SETTINGS,
                       occupancy_map=room((-0.1, 0.1, 0.3, 3.0)))
    assert max(pose.y for pose in free.poses) > 0.4 > max(pose.y for pose in walled.poses)
    assert min(pose.y for pose in walled.poses) < -0.4
    assert free.length < walled.length < free.length + 0.5


def test_a_way_exists_where_free_cells_are_connected():
    """Random rooms: as an independent search of the free cells says, where it is not close."""
    robot, rng, answers = ROBOTS['holonomic'], np.random.default_rng(7), []
    start, goal = Pose(-2.2, -2.2, 0.0), Pose(2.2, 2.2, 0.0)
    ticks = np.arange(-2.975, 3.0, RESOLUTION)
    grid = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    for _ in range(25):
        blocks = [(x, x + 0.3, y, y + 0.3) for x, y in rng.uniform(-2.9, 2.6, (45, 2))]
        occupancy_map = room(*blocks)
        reached = []
        for room_needed in (0.22 + 0.08, 0.22 - 0.02):
            free = (occupancy_map.clearance(grid) >= room_needed).reshape(120, 120)
            parts = label(free)[0]
            ends = [parts[round((pose.y + 2.975) / 0.05), round((pose.x + 2.975) / 0.05)]
                    for pose in (start, goal)]
            reached.append(ends[0] == ends[1] > 0)
        try:
            plan_path(robot, box(0.1), Pose(-2.8, 2.8, 0.0), start, goal, SETTINGS, occupancy_map=occupancy_map)
            answers.append(True)
        except NoPathFound:
            answers.append(False)
        assert reached[0] <= answers[-1] <= reached[1]
    assert set(answers) == {True, False}


def test_a_robot_close_to_a_wall_can_leave():
    """It keeps the room that it has; in the wall it stays, and is told where it is."""
    occupancy_map, obj, robot = door(0.8), box(), ROBOTS['differential']
    goal = Pose(-1.5, 0.0, 0.0)
    near = Pose(-0.05 - 0.17 - 1.2 * RESOLUTION, -1.0, 0.0)
    way = plan_path(robot, obj, ASIDE, near, goal, SETTINGS, occupancy_map=occupancy_map)
    room_there = occupancy_map.clearance([near[:2]])[0]
    assert room_there < robot.radius + SETTINGS.map_clearance
    assert occupancy_map.clearance(sample_path(way, robot, 0.02)[:, :2]).min() >= room_there - 1e-9
    with pytest.raises(NoPathFound, match='the robot at -0.10 m, -1.00 m is in an obstacle'):
        plan_path(robot, obj, ASIDE, Pose(-0.1, -1.0, 0.0), goal, SETTINGS, occupancy_map=occupancy_map)
    with pytest.raises(NoPathFound, match='the goal of the path, -0.10 m, -1.00 m, is too near'):
        plan_path(robot, obj, ASIDE, goal, Pose(-0.1, -1.0, 0.0), SETTINGS, occupancy_map=occupancy_map)


def test_a_free_map_changes_nothing():
    """The same way as without it."""
    rng, obj = np.random.default_rng(8), box()
    for robot in ROBOTS.values():
        for _ in range(10):
            start, goal = (Pose(*(rng.choice([-1, 1], 2) * rng.uniform(0.5, 1.2, 2)),
                                rng.uniform(-3.0, 3.0)) for _ in range(2))
            task = (robot, obj, Pose(0.0, 0.0, 0.2), start, goal, SETTINGS)
            assert plan_path(*task, occupancy_map=room()) == plan_path(*task)


@either
def test_it_does_not_matter_how_the_map_lies_in_the_world(drive):
    """Everything moved and turned: the same way; also where the robot is on the lattice."""
    robot, move, plain = ROBOTS[drive], Pose(4.0, -3.0, 2.0), door(0.8)
    moved = OccupancyMap(RESOLUTION, move @ plain.origin, plain.occupied)
    goal = Pose(1.5, 0.0, 0.3)
    for start in (Pose(-1.5, 0.0, 0.0), Pose(-1.475, 0.025, 0.0)):
        way = plan_path(robot, box(), ASIDE, start, goal, SETTINGS, occupancy_map=plain)
        other = plan_path(robot, box(), move @ ASIDE, move @ start, move @ goal, SETTINGS,
                          occupancy_map=moved)
        assert len(other.poses) == len(way.poses) > 2
        for one, two in zip(way.poses, other.poses):
            assert two[:2] == pytest.approx((move @ one)[:2], abs=1e-6)


def test_what_is_no_map_is_refused_by_name():
    """Resolution, origin and cells."""
    cells, origin = np.zeros((3, 4), dtype=bool), Pose(0.0, 0.0, 0.0)
    for wrong in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match='resolution: got'):
            OccupancyMap(wrong, origin, cells)
    with pytest.raises(ValueError, match='origin: got'):
        OccupancyMap(0.05, Pose(math.inf, 0.0, 0.0), cells)
    for wrong in (cells.astype(float), cells[0], cells[:0]):
        with pytest.raises(ValueError, match='occupied: got'):
            OccupancyMap(0.05, origin, wrong)


def test_a_map_cannot_be_changed_behind_its_back():
    """What it was made of may change; the map does not."""
    cells = np.zeros((30, 30), dtype=bool)
    occupancy_map = OccupancyMap(RESOLUTION, Pose(0.0, 0.0, 0.0), cells)
    before = occupancy_map.clearance([(0.7, 0.7)])
    cells[:] = True
    assert occupancy_map.clearance([(0.7, 0.7)]) == before and not occupancy_map.occupied.any()
    with pytest.raises(ValueError, match='read-only'):
        occupancy_map.occupied[0, 0] = True
