"""Successors of a node of the map search: turned maps, free and reachable pushes, bounds."""

import functools
import math

from helpers.maps import walled_floor, walled_room
from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_planner.straight.map_search.dead_ends import STANDOFF
from push_planner.straight.map_search.kernel import add_start
from push_planner.straight.map_search.object_distance import distance_grid
from push_planner.straight.map_search.problem import (
    COST, LENGTH, NODES, PARENT, PUSH, SearchSettings)
from push_planner.straight.map_search.pushes import FIRST, make_pushes
from push_planner.straight.map_search.reachable_set import SPACING
from push_planner.straight.map_search.scene import make_scene
from push_planner.straight.map_search.search import COARSE, FINE, MapSearch, Margins, SearchEnd
from push_planner.straight.map_search.successors import expand
from push_primitives.store import load_primitives
import pytest
from scipy.ndimage import label

pytestmark = pytest.mark.slow
BOX = box()
ROBOT = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
MARGINS = Margins(object=0.02, std_factor=0.0, robot=0.03, robot_to_object=0.03)
SETTINGS = SearchSettings(0.01, 0.02, accepted_error=0.015, open_radius=1.0, contact_time=4.0,
                          pushing_speed=0.2, robot_speed=0.3)
# Object, robot and goal, in the frame of a map whose middle is (3, 3).
POSES = Pose(1.6, 3.2, 0.4), Pose(2.1, 2.1, 1.0), Pose(4.4, 3.3, 1.0)
# A room with a wall across it and a door, and a table, whose right edge is here in the map [m].
TABLE_EDGE = 1.1
ROOM = walled_room((-0.05, 0.05, -3.0, -0.6), (-0.05, 0.05, 0.6, 3.0), (-2.4, -1.9, -0.6, 0.2))


@functools.lru_cache(maxsize=None)
def pushes():
    """Return the straight pushes of the box; each sample of friction counts as much."""
    primitives = load_primitives(BOX, ROBOT)
    count = len(primitives.table.friction_samples.contact_frictions)
    return make_pushes(primitives, BOX, ROBOT.radius, np.full(count, 1.0 / count), True)


def make_search(occupancy_map, goal, settings=SETTINGS):
    """Return a search for chains of pushes to a goal."""
    scene = make_scene(occupancy_map, BOX, ROBOT.radius)
    grid = distance_grid(scene.floor, (goal.x, goal.y), scene.inner_radius)
    cost_to_go = load_primitives(BOX, ROBOT).cost_to_go
    return MapSearch(scene, pushes(), grid, cost_to_go, settings)


def successors(occupancy_map, poses=POSES, lattice=COARSE):
    """Expand the first node; return the nodes after it, and the push that leads to each."""
    start, robot, goal = poses
    search = make_search(occupancy_map, goal)
    problem, memory = search.prepare(start, robot, goal, MARGINS._replace(lattice=lattice),
                                     np.zeros(len(pushes().primitives), dtype=bool))
    add_start(problem.query, memory)
    expand(problem, memory, 0)
    count = int(memory.counters[NODES])
    assert np.all(memory.links[1:count, PARENT] == 0)
    return memory.nodes[1:count].copy(), memory.links[1:count, PUSH].copy()


def quarter_turn(pose):
    """Turn a pose by 90 degrees about the middle of a map of 6 m."""
    return Pose(6.0 - pose.y, pose.x, pose.theta + math.pi / 2)


def turned(occupancy_map):
    """Turn a square map by 90 degrees about its middle."""
    return OccupancyMap(occupancy_map.resolution, occupancy_map.origin,
                        np.ascontiguousarray(np.rot90(occupancy_map.occupied, -1)))


@pytest.mark.parametrize('lattice', [COARSE, FINE], ids=['coarse', 'fine'])
def test_a_turned_world_has_the_turned_successors(lattice):
    """The same pushes at the same costs, to poses that are turned as the map is."""
    nodes, indices = successors(ROOM, lattice=lattice)
    assert len(nodes) > 20
    others, other_indices = successors(turned(ROOM), tuple(map(quarter_turn, POSES)), lattice)
    # Cells of the lattice do not turn with the map: of two ends in one cell one is left out.
    keys = {(push, round(node[LENGTH], 6)): node for node, push in zip(nodes, indices)}
    other_keys = {(push, round(node[LENGTH], 6)): node
                  for node, push in zip(others, other_indices)}
    shared = keys.keys() & other_keys.keys()
    assert len(shared) > 0.7 * max(len(keys), len(other_keys))
    for key in shared:
        expected = quarter_turn(Pose(*keys[key][:3]))
        assert other_keys[key][:3] == pytest.approx(expected, abs=1e-9)
        # Grid points about the robot round differently.
        assert other_keys[key][COST] == pytest.approx(keys[key][COST], abs=2.0 * SPACING / 0.3)


@pytest.mark.parametrize('occupancy_map', [ROOM, walled_floor(6.0, 6.0)], ids=['room', 'empty'])
def test_successors_are_free_and_the_robot_gets_to_their_contacts(occupancy_map):
    """By the map itself: the way of the object, the end of the robot, a way to the contact."""
    start, robot, _ = POSES
    nodes, indices = successors(occupancy_map)
    origin, regions = occupancy_map.origin, robot_regions(occupancy_map, start)
    for node, push in zip(nodes, indices):
        steps = pushes().lengths <= node[LENGTH] + 1e-9
        way = [origin @ start @ Pose(*mean) for mean in pushes().means[FIRST, push, steps]]
        assert occupancy_map.object_is_free(BOX, np.array(way), 0.0)
        contact = Pose(*pushes().starts[push])
        end = origin @ start @ contact @ Pose(node[LENGTH], 0.0, 0.0)
        assert occupancy_map.clearance([end[:2]])[0] >= ROBOT.radius
        before = start @ contact @ Pose(-STANDOFF, 0.0, 0.0)
        assert region_at(regions, before) == region_at(regions, robot) > 0


@pytest.mark.parametrize('gap', [0.01, -0.01])
def test_pushes_beside_an_obstacle_make_little_new_overlap(gap: float) -> None:
    """An object at the table may slide along it, guided by it, but is not pushed into it."""
    start = Pose(TABLE_EDGE + 0.2 + gap, 3.1, 0.0)
    nodes, indices = successors(ROOM, (start, *POSES[1:]))
    assert len(nodes) > 5
    for node, push in zip(nodes, indices):
        end = Pose(*pushes().means[FIRST, push, pushes().lengths <= node[LENGTH] + 1e-9][-1])
        clearance = ROOM.object_clearance(BOX, [ROOM.origin @ start @ end])
        overlap = min(0.018, 0.003 + 0.1 * node[LENGTH])
        assert clearance >= min(gap, 0.0) - overlap - 1e-6


def robot_regions(occupancy_map, start, spacing=0.02):
    """Label the regions of the floor in which the robot overlaps neither map nor object."""
    count = round(6.0 / spacing)
    x, y = (spacing * (np.indices((count, count))[::-1] + 0.5)).reshape(2, -1)
    points = np.stack(occupancy_map.origin.transform(np.stack([x, y])), axis=1)
    u, v = start.inverse().transform(np.stack([x, y]))
    outline = np.array(BOX.outline)
    half_x, half_y = outline.max(axis=0)
    apart = np.hypot(np.maximum(np.abs(u) - half_x, 0.0), np.maximum(np.abs(v) - half_y, 0.0))
    is_free = (occupancy_map.clearance(points) >= ROBOT.radius) & (apart >= ROBOT.radius)
    return label(is_free.reshape(count, count), np.ones((3, 3)))[0]


def region_at(regions, pose, spacing=0.02):
    """Return the region at a pose in the frame of the map."""
    return regions[int(pose.y / spacing), int(pose.x / spacing)]


def test_a_door_that_is_closed_takes_pushes_away_and_adds_none():
    """Obstacles forbid pushes; what stays has the same end, and is no cheaper."""
    free, walled = (dict(zip(zip(indices.tolist(), nodes[:, LENGTH].tolist()), nodes))
                    for nodes, indices in (successors(walled_floor(6.0, 6.0)), successors(ROOM)))
    assert len(walled) < len(free)
    assert len(walled.keys() - free.keys()) <= 0.05 * len(walled)
    for key in walled.keys() & free.keys():
        assert walled[key][:3] == pytest.approx(free[key][:3], abs=1e-9)
        assert walled[key][COST] >= free[key][COST] - 1e-9


def test_a_push_costs_at_least_contact_drive_and_way():
    """The robot is never faster than along the straight line to the contact."""
    start, robot, _ = POSES
    nodes, indices = successors(ROOM)
    for node, push in zip(nodes, indices):
        before = start @ Pose(*pushes().starts[push]) @ Pose(-STANDOFF, 0.0, 0.0)
        drive = max(0.0, math.dist(before[:2], robot[:2]) - 2.0 * SPACING)
        assert node[COST] >= (SETTINGS.contact_time + drive / SETTINGS.robot_speed
                              + node[LENGTH] / SETTINGS.pushing_speed - 1e-9)


@pytest.mark.parametrize('goal', [POSES[2], Pose(4.8, 1.2, -2.0), Pose(1.2, 4.8, 3.0)])
def test_no_chain_is_cheaper_than_the_bound(goal):
    """The bound of a quick search holds for the chain of one without haste in a finer lattice."""
    start, robot, _ = POSES
    blocked = np.zeros(len(pushes().primitives), dtype=bool)
    quick = make_search(ROOM, goal).run(start, robot, goal, MARGINS, blocked)
    careful = make_search(ROOM, goal, SETTINGS._replace(weight=1.0)).run(
        start, robot, goal, MARGINS._replace(lattice=FINE, max_expansions=300), blocked)
    assert quick.end is SearchEnd.FOUND
    away = math.dist(start[:2], goal[:2])
    assert away / SETTINGS.pushing_speed <= quick.least_cost <= quick.cost
    if careful.end is SearchEnd.FOUND:
        assert quick.least_cost <= careful.cost
