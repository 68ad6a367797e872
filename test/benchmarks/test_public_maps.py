"""Tasks in maps of others: where object, goal and robot are, and that both can be touched."""

import math
from pathlib import Path

from benchmarks.map_plans.instances import bodies, Instance
from benchmarks.tasks.cases import PUBLIC_MAPS
from benchmarks.tasks.public_maps import (
    CLEARANCE, draw_public_task, GOAL_DISTANCES, is_connected, map_files, robot_cells,
)
from benchmarks.tasks.public_table import public_tables
from benchmarks.tasks.refusals import Answer, answer
from helpers.maps import walled_floor, walled_room
import numpy as np
from push_model.geometry import BoolArray, distance, Pose
from push_navigation.occupancy_map import OccupancyMap
import pytest


def write_map(folder: Path, occupancy_map: OccupancyMap) -> None:
    """Write a map as ``map_server`` does."""
    rows, columns = occupancy_map.occupied.shape
    pixels = np.where(occupancy_map.occupied[::-1], 0, 254).astype(np.uint8)
    (folder / 'map.pgm').write_bytes(f'P5 {columns} {rows} 255\n'.encode() + pixels.tobytes())
    x, y, theta = occupancy_map.origin
    (folder / 'map.yaml').write_text(
        f'image: map.pgm\nresolution: {occupancy_map.resolution}\norigin: [{x}, {y}, {theta}]\n'
        'negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n', encoding='utf-8')


def fits(occupancy_map: OccupancyMap, radius: float) -> BoolArray:
    """Tell in which cells a disc fits."""
    return occupancy_map.distances[1:-1, 1:-1] > radius


@pytest.mark.parametrize('name', ['box_04', 'bin'])
def test_object_goal_and_robot_keep_clear_of_the_whole_map(tmp_path: Path, name: str) -> None:
    """Also of what lies outside of the part that is kept; start and goal as far as stated."""
    whole = walled_floor(14.0, 5.0, 1.0)
    write_map(tmp_path, whole)
    obj, robot = bodies(name, 'differential')
    for seed in range(6):
        task = draw_public_task(str(tmp_path), seed, obj, robot, np.random.default_rng(seed))
        for floor in (whole, task.floor_map.occupancy_map):
            assert floor.object_clearance(obj, [task.start, task.goal]) >= CLEARANCE - 1e-6
            # A robot anywhere in a cell whose middle keeps clear.
            assert floor.robot_is_free(robot, [task.robot_start], CLEARANCE - 0.04)
        low, high = GOAL_DISTANCES
        assert low <= distance(task.start, task.goal) <= high
        assert task.name == 'map'


def test_a_robot_comes_from_where_it_fits_through_only() -> None:
    """A narrow door keeps it in the room of the object, a wide one does not."""
    obj, robot = bodies('box_04', 'differential')
    start = Pose(-1.0, 0.2, 0.3)
    for door, passes in ((0.3, False), (1.0, True)):
        floor = walled_floor(6.0, 4.0, door)
        cells = robot_cells(floor, fits(floor, robot.radius), obj, start, robot.radius)
        columns = np.flatnonzero(cells.any(axis=0))
        assert (columns.max() > cells.shape[1] // 2) == passes
        # Nowhere in the object.
        extent = math.hypot(*obj.outline[0])
        points = floor.from_map(floor.resolution * (np.argwhere(cells)[:, ::-1] + 0.5))
        assert np.hypot(*(points - start[:2]).T).min() > robot.radius + 0.5 * extent


def test_an_object_that_nobody_can_touch_has_no_robot() -> None:
    """It stands in a box of walls that is too narrow for the robot."""
    obj, robot = bodies('box_04', 'differential')
    floor = walled_room((-0.5, 0.5, 0.4, 0.5), (-0.5, 0.5, -0.5, -0.4), (-0.5, -0.4, -0.5, 0.5),
                        (0.4, 0.5, -0.5, 0.5))
    assert not robot_cells(floor, fits(floor, robot.radius), obj, Pose(0.0, 0.0, 0.0),
                           robot.radius).any()


def test_poses_are_connected_where_a_disc_fits_through_the_map() -> None:
    """Through a door that is wider than the disc, and not through a narrower one."""
    poses = Pose(-1.5, 0.3, 0.0), Pose(1.5, -0.4, 1.0)
    for door, passes in ((0.5, False), (1.0, True)):
        floor = walled_floor(6.0, 4.0, door)
        assert is_connected(floor, 0.35, *poses) == passes
        assert is_connected(floor, 0.35, poses[0], poses[0])


def test_a_folder_without_maps_is_refused(tmp_path: Path) -> None:
    """The sentence names it."""
    with pytest.raises(FileNotFoundError, match=str(tmp_path)):
        map_files(str(tmp_path))


def test_the_tables_count_answers_goals_collisions_and_refusals() -> None:
    """A refused task is not answered; its code, and what could be done there, are stated."""
    job = {'part': PUBLIC_MAPS, 'kind': 'bin, holonomic', 'seed': 0}
    done = {'variety': 'lidar', 'success': True, 'planning': '0.2000 0.1000', 'codes': '',
            'outcome': 'done', 'object_clearance': -0.01, 'robot_clearance': 0.1,
            'duration': 40.0, 'least': 16.0, 'longest_step': 0.3, 'in_approach': 9.0}
    refused = {**done, 'success': False, 'in_approach': 0.0, 'codes': 'NO_FACE',
               'outcome': 'failed', 'object_clearance': 0.1, 'answer': Answer.PUSHES.value}
    driven, answers = ([cell.strip() for cell in line.strip('|').split('|')]
                       for line in public_tables([(job, done), (job, refused)]).splitlines()
                       if line.startswith('| lidar'))
    assert driven[:4] == ['lidar', '2', '1', '1']
    assert driven[6:] == ['1; 0', '40', '2.50']
    assert answers == ['lidar', '0.20 / 0.20', '0.3', '1', '0', '1', '0', '1 NO_FACE']


def test_what_a_planner_that_knows_all_answers_is_told() -> None:
    """Across a room there is a plan; an object that nobody can touch is stuck."""
    obj, robot = bodies('box_04', 'differential')
    walls = [(-0.5, 0.5, 0.35, 0.45), (-0.5, 0.5, -0.45, -0.35), (-0.5, -0.4, -0.45, 0.45),
             (0.4, 0.5, -0.45, 0.45)]
    for blocks, expected in (([], Answer.PLAN), (walls, Answer.NOTHING)):
        instance = Instance(walled_room(*blocks), obj, robot, Pose(0.0, 0.0, 0.0),
                            Pose(-1.0, 0.0, 0.0), Pose(1.0, 0.3, 0.0))
        assert answer(instance.scenario, instance.occupancy_map, instance.start,
                      instance.robot_start) is expected
