"""Walls beside a push: those of the map, moved off an object that overlaps them."""

import dataclasses
import math

import numpy as np
from push_dynamics.walls import Wall
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.wall_segments import map_walls

# Overlap of object and map that an error of the map explains [m]; chosen: cells of 5 cm with an
# object against their wall. An object further inside stands on what the map has as occupied.
MAX_OVERLAP = 0.05
# Steps that move walls off an object, and that in which the clearance is differentiated [m];
# chosen: two walls of a corner take two, and less than the error of a map.
STEPS = 4
DIFFERENCE = 0.002
# Standard deviation of walls in cells; derived: they are anywhere within theirs.
CELL_STD = math.sqrt(1.0 / 12.0)
# Clearance of an object up to which it may as well touch the wall, in standard deviations of the
# wall, and the overlap that still is a touch [m]; chosen: furniture stands against walls, and
# the clearance is differentiated over as much.
TOUCH_SIGMAS = 2.5
TOUCH_OVERLAP = 0.002


def walls_beside(occupancy_map: OccupancyMap | None, obj: PushedObject, object_pose: Pose,
                 distance: float) -> tuple[Wall, ...]:
    """
    List the walls that a push may meet.

    An object does not stand in a wall. Where it overlaps one of the map, the walls are moved off
    it, by no more than ``MAX_OVERLAP``.

    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    :param object_pose: ``Pose`` of the object before the push.
    :param distance: from there up to which walls count, along columns and rows of the map [m].
    """
    if occupancy_map is None:
        return ()
    walls = map_walls(occupancy_map, object_pose, distance)
    x, y = _shift(occupancy_map, obj, object_pose)
    if x == y == 0.0:
        return walls
    return tuple(dataclasses.replace(
        wall, start_x=wall.start_x + x, start_y=wall.start_y + y, end_x=wall.end_x + x,
        end_y=wall.end_y + y) for wall in walls)


def wall_errors(occupancy_map: OccupancyMap | None, obj: PushedObject, object_pose: Pose,
                map_error: float, count: int) -> FloatArray:
    """
    Draw by how much the walls beside a push may be elsewhere.

    No sample has the object in a wall; it has that wall to the other side instead. Every other one
    has a wall that is near touch the object: of a wall that no sample has there, a touch tells
    nothing. Samples are the same for every push, as the map is.

    :param occupancy_map: the ``OccupancyMap``, or None for open floor.
    :param object_pose: ``Pose`` of the object before the push.
    :param map_error: standard deviation of walls about their cells [m].
    :param count: of the samples.
    :return: errors (x, y), shape (count, 2) [m].
    """
    errors = np.zeros((count, 2))
    if occupancy_map is None:
        return errors
    std = math.hypot(CELL_STD * occupancy_map.resolution, map_error)
    samples = np.random.default_rng(0).normal(0.0, std, (count, 2))
    beside = np.array(object_pose[:2]) - _shift(occupancy_map, obj, object_pose)
    clearance, away = _clearance(
        occupancy_map, obj, Pose(float(beside[0]), float(beside[1]), object_pose.theta))
    if clearance < TOUCH_SIGMAS * std:
        samples[::2] += np.outer(clearance - samples[::2] @ away, away)
    is_open = np.ones(count, dtype=bool)
    for signs in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        tried = samples * signs
        poses = np.column_stack((beside - tried, np.full(count, object_pose.theta)))
        is_free = is_open & (occupancy_map.object_clearances(obj, poses) >= -TOUCH_OVERLAP)
        errors[is_free] = tried[is_free]
        is_open &= ~is_free
    return errors


def _shift(occupancy_map: OccupancyMap, obj: PushedObject,
           object_pose: Pose) -> tuple[float, float]:
    """Find the least shift (x, y) of the map that has the object touch its walls [m]."""
    x, y, theta = object_pose
    for _ in range(STEPS):
        clearance, away = _clearance(occupancy_map, obj, Pose(x, y, theta))
        if clearance >= 0.0:
            break
        x, y = (np.array((x, y)) - clearance * away).tolist()
    shift = object_pose.x - x, object_pose.y - y
    return shift if math.hypot(*shift) <= MAX_OVERLAP else (0.0, 0.0)


def _clearance(occupancy_map: OccupancyMap, obj: PushedObject,
               pose: Pose) -> tuple[float, FloatArray]:
    """Compute the clearance of an object [m], and the direction in which it grows, shape (2,)."""
    x, y, theta = pose
    clearance, along_x, along_y = occupancy_map.object_clearances(obj, [
        pose, (x + DIFFERENCE, y, theta), (x, y + DIFFERENCE, theta)]).tolist()
    slope = np.array((along_x - clearance, along_y - clearance))
    length = math.hypot(*slope.tolist())
    return clearance, slope / length if length > 0.0 else slope
