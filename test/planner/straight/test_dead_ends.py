"""Discs beside walls: where they are shut in, come off a wall, slide along it."""

import math
from typing import Any

from helpers.maps import walled_floor, walled_room
from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_navigation.floor import clearance
from push_navigation.occupancy_map import OccupancyMap
from push_planner.straight.map_search.dead_ends import (
    is_dead_end, LEAVING_ANGLE, leaving_length, slide_along)
from push_planner.straight.map_search.pushes import Pushes
from push_planner.straight.map_search.scene import make_scene, object_clearance, Scene
import pytest
from scipy.integrate import solve_ivp

ROBOT_RADIUS, MARGIN, RADIUS = 0.17, 0.02, 0.2
REACH, NEEDED = RADIUS + ROBOT_RADIUS, ROBOT_RADIUS + MARGIN
# An empty room of 6 m, and one with a niche of 0.6 m at its lower wall, 0.5 m deep.
EMPTY = walled_floor(6.0, 6.0)
NICHE = walled_room((-3.0, -0.3, -3.0, -2.5), (0.3, 3.0, -3.0, -2.5))


def scene_of(occupancy_map: OccupancyMap, obj: PushedObject | None = None) -> Scene:
    """Return the scene of a map."""
    return make_scene(occupancy_map, bin_() if obj is None else obj, ROBOT_RADIUS)


def at_gap(occupancy_map: OccupancyMap, gap: float, y: float = 3.0) -> Pose:
    """Return the position with a gap to the left wall, in the frame of the map."""
    scene = scene_of(occupancy_map)
    x = next(x for x in np.arange(0.0, 3.0, 1e-4).tolist()
             if object_clearance(scene, x, y, 0.0, 1.0) >= gap)
    return Pose(x, y, 0.0)


def is_shut_in(occupancy_map: OccupancyMap, pose: Pose) -> bool:
    """Tell whether a disc is in a dead end; it has no faces."""
    no_faces: Any = np.zeros((0, 2))
    pushes = Pushes(*[no_faces] * len(Pushes._fields))
    return is_dead_end(scene_of(occupancy_map), pushes, MARGIN, pose)


def test_the_length_along_a_wall_solves_its_equation() -> None:
    """By stepping along the line of contact; what two pushes need in sum one needs."""
    scene, start, goal = scene_of(EMPTY), at_gap(EMPTY, 0.01), at_gap(EMPTY, 0.06)
    near, far = (clearance(scene.floor, *pose[:2]) - NEEDED for pose in (start, goal))
    length = leaving_length(scene, MARGIN, start, goal)
    solution = solve_ivp(lambda _, room: room / REACH, (0.0, length), [near],
                         rtol=1e-10, atol=1e-12)
    assert solution.y[0, -1] == pytest.approx(far, rel=1e-6)
    between = at_gap(EMPTY, 0.03)
    assert length == pytest.approx(leaving_length(scene, MARGIN, start, between)
                                   + leaving_length(scene, MARGIN, between, goal))


def test_nothing_is_needed_towards_a_wall_nor_beyond_its_reach() -> None:
    """Nor of a box; from where the line of contact points far enough off the wall it is free."""
    scene = scene_of(EMPTY)
    start, goal, middle = at_gap(EMPTY, 0.01), at_gap(EMPTY, 0.06), Pose(3.0, 3.0, 0.0)
    assert leaving_length(scene, MARGIN, goal, start) == 0.0
    assert leaving_length(scene_of(EMPTY, box()), MARGIN, start, goal) == 0.0
    # The distance field is some millimetres short of the gap.
    clear = at_gap(EMPTY, NEEDED - RADIUS + REACH * math.sin(LEAVING_ANGLE) + 0.02)
    assert leaving_length(scene, MARGIN, clear, middle) == 0.0
    assert leaving_length(scene, MARGIN, start, middle) == pytest.approx(
        leaving_length(scene, MARGIN, start, clear))


def test_a_disc_is_shut_in_in_niches_and_corners_but_not_beside_a_wall() -> None:
    """Along a wall it can be pushed both ways."""
    assert is_shut_in(NICHE, Pose(3.0, 0.3, 0.0))
    assert not is_shut_in(NICHE, Pose(3.0, 3.0, 0.0))
    beside = at_gap(EMPTY, 0.03)
    assert not is_shut_in(EMPTY, beside)
    assert is_shut_in(EMPTY, Pose(beside.x, beside.x, 0.0))


def test_a_wall_guides_a_disc_that_is_pressed_a_little() -> None:
    """It then touches it, having moved along the normal; pressed deeper or free it stays."""
    scene, touching = scene_of(EMPTY), at_gap(EMPTY, 0.0)
    pose = np.array([touching.x - 0.01, 3.0, 0.3])
    slide_along(scene, pose, 0.02)
    x, y, theta = pose.tolist()
    assert object_clearance(scene, x, y, theta, 1.0) == pytest.approx(0.0, abs=1e-3)
    assert pose[1:] == pytest.approx([3.0, 0.3], abs=1e-9)
    for x, overlap in ((touching.x - 0.03, 0.02), (touching.x + 0.01, 0.02)):
        pose = np.array([x, 3.0, 0.3])
        slide_along(scene, pose, overlap)
        assert pose.tolist() == [x, 3.0, 0.3]
