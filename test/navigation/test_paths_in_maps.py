"""Paths among obstacles of a map: clear, short, and there wherever free cells are connected."""

import math

from helpers.maps import RESOLUTION, room_with_door, true_distances, walled_room
from helpers.objects import box
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, PathFailure, sample_path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings
import pytest
from scipy.ndimage import label

SETTINGS = DriveSettings()
ROBOTS = {drive: RoundRobot(0.17, drive) for drive in ('differential', 'holonomic')}
ASIDE = Pose(-1.5, -2.2, 0.4)
either = pytest.mark.parametrize('drive', ROBOTS)


@pytest.mark.slow
@either
def test_paths_keep_clear_of_obstacles_and_object(drive):
    """Random ends in a room with a door and some furniture, the object in it."""
    robot, obj, rng, found = ROBOTS[drive], box(), np.random.default_rng(6), 0
    occupancy_map = walled_room((-0.05, 0.05, -3.0, 0.5), (-0.05, 0.05, 1.4, 3.0),
                                (1.2, 1.6, -1.0, -0.5), (-2.0, -1.5, -1.5, -0.5))
    while found < 25:
        object_pose = Pose(*rng.uniform(-2.0, 2.0, 2), rng.uniform(-3.0, 3.0))
        ends = [Pose(*rng.uniform(-2.6, 2.6, 2), rng.uniform(-3.0, 3.0)) for _ in range(2)]
        try:
            path = plan_path(robot, obj, object_pose, *ends, SETTINGS, occupancy_map=occupancy_map)
        except NoPathFound:
            continue
        found += 1
        assert path.poses[0] == ends[0] and path.poses[-1] == ends[1]
        rows = sample_path(path, robot, 0.01)
        clearance, = occupancy_map.clearance([ends[0][:2]])
        least = min(SETTINGS.map_clearance, clearance - robot.radius)
        assert true_distances(occupancy_map, rows[:, :2]).min() > robot.radius + least - 1e-9
        gaps = np.array([find_contact(obj, object_pose, row, robot.radius).gap for row in rows])
        inside = gaps >= SETTINGS.clearance - 1e-6
        assert np.all(inside[int(np.argmax(inside)):len(inside) - int(np.argmax(inside[::-1]))])


def test_a_wall_that_goes_on_for_six_metres_is_driven_round():
    """Farther off than a room is wide; the path is little longer than the taut one."""
    occupancy_map = walled_room((-4.5, 3.5, -0.05, 0.05), side=9.0)
    start, goal = Pose(-3.0, -1.0, 0.0), Pose(-3.0, 1.0, 0.0)
    path = plan_path(ROBOTS['differential'], box(), ASIDE, start, goal, SETTINGS,
                     occupancy_map=occupancy_map)
    taut = 2.0 * math.dist(start[:2], (3.5, 0.0))
    assert taut < path.length < 1.1 * taut


@either
def test_it_goes_through_a_door_and_not_through_a_slit(drive):
    """The path through the door is little longer than the taut one; the slit is refused."""
    robot, obj = ROBOTS[drive], box()
    start, goal = Pose(-1.5, 0.0, 0.0), Pose(1.5, 0.0, 0.0)
    path = plan_path(robot, obj, ASIDE, start, goal, SETTINGS, occupancy_map=room_with_door(0.8))
    post = math.dist(start[:2], (0.0, 0.6 + 0.17 + SETTINGS.map_clearance))
    assert 2.0 * post < path.length < 1.06 * 2.0 * post
    with pytest.raises(NoPathFound) as failure:
        plan_path(robot, obj, ASIDE, start, goal, SETTINGS, occupancy_map=room_with_door(0.4))
    assert failure.value.report.code is PathFailure.NO_ROUTE


def test_the_object_in_the_door_is_an_obstacle_too():
    """The robot can neither push through nor get past."""
    start, goal = Pose(-1.5, 0.0, 0.0), Pose(1.5, 0.0, 0.0)
    with pytest.raises(NoPathFound) as failure:
        plan_path(ROBOTS['holonomic'], box(), Pose(0.0, 1.0, 0.0), start, goal, SETTINGS,
                  occupancy_map=room_with_door(0.8))
    assert failure.value.report.code is PathFailure.NO_ROUTE


def test_one_side_of_the_object_is_walled_up():
    """It takes the other side, the longer one, without a grid."""
    robot, obj, object_pose = ROBOTS['holonomic'], box(), Pose(0.0, 0.0, 0.0)
    start, goal = Pose(-1.0, 0.1, 0.0), Pose(1.0, 0.1, 0.0)
    free = plan_path(robot, obj, object_pose, start, goal, SETTINGS)
    walled = plan_path(robot, obj, object_pose, start, goal, SETTINGS,
                       occupancy_map=walled_room((-0.1, 0.1, 0.3, 3.0)))
    assert max(pose.y for pose in free.poses) > 0.35 > max(pose.y for pose in walled.poses)
    assert min(pose.y for pose in walled.poses) < -0.35
    assert free.length < walled.length < free.length + 0.5


def test_a_path_exists_where_free_cells_are_connected():
    """Random rooms: as an independent search of the free cells says, where it is not close."""
    robot, rng, answers = ROBOTS['holonomic'], np.random.default_rng(7), []
    start, goal = Pose(-2.2, -2.2, 0.0), Pose(2.2, 2.2, 0.0)
    ticks = np.arange(-2.975, 3.0, RESOLUTION)
    grid = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    for _ in range(25):
        blocks = [(x, x + 0.3, y, y + 0.3) for x, y in rng.uniform(-2.9, 2.6, (45, 2))]
        occupancy_map = walled_room(*blocks)
        reached = []
        for clearance in (0.22 + 0.08, 0.22 - 0.02):
            free = (occupancy_map.clearance(grid) >= clearance).reshape(120, 120)
            parts = label(free)[0]
            ends = [parts[round((pose.y + 2.975) / 0.05), round((pose.x + 2.975) / 0.05)]
                    for pose in (start, goal)]
            reached.append(ends[0] == ends[1] > 0)
        try:
            plan_path(robot, box(0.1), Pose(-2.8, 2.8, 0.0), start, goal, SETTINGS,
                      occupancy_map=occupancy_map)
            answers.append(True)
        except NoPathFound:
            answers.append(False)
        assert reached[0] <= answers[-1] <= reached[1]
    assert set(answers) == {True, False}


def test_a_robot_close_to_a_wall_can_leave():
    """It keeps the clearance that it has; in the wall it stays, and is told where it is."""
    occupancy_map, obj, robot = room_with_door(0.8), box(), ROBOTS['differential']
    goal = Pose(-1.5, 0.0, 0.0)
    near = Pose(-0.05 - 0.17 - 0.8 * RESOLUTION, -1.0, 0.0)
    path = plan_path(robot, obj, ASIDE, near, goal, SETTINGS, occupancy_map=occupancy_map)
    clearance_there = occupancy_map.clearance([near[:2]])[0]
    assert clearance_there < robot.radius + SETTINGS.map_clearance
    on_path = occupancy_map.clearance(sample_path(path, robot, 0.02)[:, :2])
    assert on_path.min() >= clearance_there - 1e-9
    with pytest.raises(NoPathFound) as failure:
        plan_path(robot, obj, ASIDE, Pose(-0.1, -1.0, 0.0), goal, SETTINGS,
                  occupancy_map=occupancy_map)
    assert failure.value.report == PathFailure.START_IN_OBSTACLE.report(x=-0.1, y=-1.0)
    with pytest.raises(NoPathFound) as failure:
        plan_path(robot, obj, ASIDE, goal, Pose(-0.1, -1.0, 0.0), SETTINGS,
                  occupancy_map=occupancy_map)
    assert failure.value.report == PathFailure.GOAL_NEAR_OBSTACLE.report(x=-0.1, y=-1.0)


def test_a_free_map_changes_nothing():
    """The same path as without it."""
    rng, obj = np.random.default_rng(8), box()
    for robot in ROBOTS.values():
        for _ in range(10):
            start, goal = (Pose(*(rng.choice([-1, 1], 2) * rng.uniform(0.5, 1.2, 2)),
                                rng.uniform(-3.0, 3.0)) for _ in range(2))
            task = (robot, obj, Pose(0.0, 0.0, 0.2), start, goal, SETTINGS)
            assert plan_path(*task, occupancy_map=walled_room()) == plan_path(*task)


@either
def test_it_does_not_matter_how_the_map_lies_in_the_world(drive):
    """Everything moved and rotated: the same path; also where the robot is on the grid."""
    robot, move, plain = ROBOTS[drive], Pose(4.0, -3.0, 2.0), room_with_door(0.8)
    moved = OccupancyMap(RESOLUTION, move @ plain.origin, plain.occupied)
    goal = Pose(1.5, 0.0, 0.3)
    for start in (Pose(-1.5, 0.0, 0.0), Pose(-1.475, 0.025, 0.0)):
        path = plan_path(robot, box(), ASIDE, start, goal, SETTINGS, occupancy_map=plain)
        other = plan_path(robot, box(), move @ ASIDE, move @ start, move @ goal, SETTINGS,
                          occupancy_map=moved)
        assert len(other.poses) == len(path.poses) > 2
        for one, two in zip(path.poses, other.poses):
            assert two[:2] == pytest.approx((move @ one)[:2], abs=1e-6)
