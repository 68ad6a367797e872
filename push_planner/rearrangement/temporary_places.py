"""
Temporary places of an object that stands in the way of others.

A place is near, free of walls and of all starts and goals, beside the ways of objects that are
still to be moved, and it closes no door: floor on which the robot got from one point to another
stays connected.
"""

from collections.abc import Sequence
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, FloatArray, IntArray, Pose
from push_planner.rearrangement.placements import GOAL, Layout, Placements
from push_planner.straight.map_search.object_distance import DistanceGrid, UNREACHED

# Room that is kept round an object at a temporary place [m]; chosen: others pass it.
MARGIN = 0.05
# Places that are proposed, and their distance from each other [m]; chosen: where the nearest is no
# good, one beside it is no better.
MAX_PLACES, APART = 3, 0.6
# Places that are looked at, the nearest first; chosen.
MAX_CANDIDATES = 40
# Area of floor below which nothing is cut off by an object [m^2]; chosen: the robot's own.
MIN_AREA = 0.1


def temporary_places(placements: Placements, layout: Layout, index: int, lengths: DistanceGrid,
                     paths: Sequence[FloatArray]) -> list[Pose]:
    """
    Find temporary places, the nearest first.

    :param index: of the object.
    :param lengths: of ways from where it stands, past all others.
    :param paths: of others to their goals, shape (n, 2) [m]; a place beside them comes first.
    :return: poses in the frame of the map, with the present heading.
    """
    floor, body = placements.floor, placements.bodies[index]
    present = placements.pose(index, layout[index])
    is_free = _is_free(placements, layout, index)
    is_free[1:-1, 1:-1] &= lengths.lengths < UNREACHED
    away = np.full(floor.walls.shape, math.inf)
    if paths:
        away = floor.distances_from_points(np.concatenate(paths))
    apart = body.outer_radius + _widest(placements, index) + MARGIN
    far = away >= apart + placements.robot_needed
    beside = (away >= apart) & ~far
    passable = _passable(placements, layout, index)
    places: list[Pose] = []
    for is_allowed in (is_free & far, is_free & beside, is_free & ~(far | beside)):
        order = np.flatnonzero(is_allowed[1:-1, 1:-1])
        order = order[np.argsort(lengths.lengths.ravel()[order], kind='stable')]
        looked_at = 0
        for cell in order.tolist():
            row, column = divmod(cell, lengths.lengths.shape[1])
            pose = Pose((column + 0.5) * floor.spacing, (row + 0.5) * floor.spacing,
                        present.theta)
            if any(np.hypot(pose.x - place.x, pose.y - place.y) < APART for place in places):
                continue
            looked_at += 1
            if looked_at > MAX_CANDIDATES:
                break
            if not _closes_a_door(placements, index, pose, passable):
                places.append(pose)
                if len(places) == MAX_PLACES:
                    return places
    return places


def _widest(placements: Placements, index: int) -> float:
    """Return the greatest distance that the middle of robot or another object may need [m]."""
    return max([placements.robot_needed, *(
        body.outer_radius for other, body in enumerate(placements.bodies) if other != index)])


def _is_free(placements: Placements, layout: Layout, index: int) -> BoolArray:
    """Tell where an object may stand in any heading, away from all starts and goals of others."""
    needed = placements.bodies[index].outer_radius + MARGIN
    is_free: BoolArray = placements.floor.walls >= needed
    for other, place in enumerate(layout):
        if other == index:
            continue
        places = {place} if placements.bodies[other].is_placed(place) else {place, GOAL}
        for other_place in places:
            is_free &= placements.field(other, other_place) >= needed
    return is_free


class _Passable(NamedTuple):
    """
    Floor on which something can be without the object.

    :param needed: distance that it keeps [m].
    :param is_free: where it can be, shape (r, c).
    :param parts: connected parts of it, shape (r, c).
    """

    needed: float
    is_free: BoolArray
    parts: IntArray


def _passable(placements: Placements, layout: Layout, index: int) -> list[_Passable]:
    """Find the floor of the robot alone, and of the widest of the others in any heading."""
    obstacles = placements.obstacles(layout, index)
    result: list[_Passable] = []
    for needed in (placements.robot_needed, MARGIN + _widest(placements, index)):
        is_free: BoolArray = obstacles >= needed
        result.append(_Passable(needed, is_free, placements.floor.connected_parts(is_free)))
    return result


def _closes_a_door(placements: Placements, index: int, pose: Pose,
                   passable: list[_Passable]) -> bool:
    """Tell whether an object at a pose divides a part of the floor."""
    floor = placements.floor
    distances = floor.distances_from(placements.bodies[index].obj, pose)
    for needed, is_free, before in passable:
        after = floor.connected_parts(is_free & (distances >= needed))
        # Each part lies in one of those before.
        counts = np.bincount(after.ravel())
        whole = np.zeros(len(counts), dtype=np.int64)
        whole[after] = before
        is_part = counts * floor.spacing ** 2 >= MIN_AREA
        is_part[0] = False
        parts = whole[is_part]
        if len(np.unique(parts)) < len(parts):
            return True
    return False
