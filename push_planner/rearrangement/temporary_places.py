"""
Temporary places of an object that stands in the way of others.

A place is near, free of walls and of all starts and goals, beside the ways of objects that are
still to be moved, and it closes no door: floor on which the robot got from one point to another
stays connected.
"""

from collections.abc import Sequence
import math

import numpy as np
from push_model.geometry import BoolArray, FloatArray, Pose
from push_planner.rearrangement.object_floor import Field, ObjectFloor
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
            if not _closes_a_door(placements, layout, index, pose):
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


def _closes_a_door(placements: Placements, layout: Layout, index: int, pose: Pose) -> bool:
    """Tell whether an object at a pose divides floor on which the robot gets everywhere."""
    floor, body = placements.floor, placements.bodies[index]
    obstacles = placements.obstacles(layout, index)
    distances = floor.distances_from(body.obj, pose)
    # The robot alone, and the widest of the others, however it is turned.
    widest = MARGIN + _widest(placements, index)
    return any(_divides(obstacles, distances, needed, floor)
               for needed in (placements.robot_needed, widest))


def _divides(obstacles: Field, distances: Field, needed: float, floor: ObjectFloor) -> bool:
    """
    Tell whether an object divides a part of the floor.

    :param obstacles: distances from all but the object [m].
    :param distances: from the object [m].
    :param needed: distance that something keeps from both [m].
    """
    is_free = obstacles >= needed
    before = floor.connected_parts(is_free)
    after = floor.connected_parts(is_free & (distances >= needed))
    pairs, counts = np.unique(np.stack((before[after > 0], after[after > 0])), axis=1,
                              return_counts=True)
    parts = pairs[0, counts * floor.spacing ** 2 >= MIN_AREA]
    return len(np.unique(parts)) < len(parts)
