"""Visibility: which straight lines a robot may drive among obstacles and the object."""

import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import BoolArray, FloatArray, Pose
from push_navigation.floor import clearance, Floor, make_floor, polygon_distance
from push_navigation.map_clearance import GAIN, MapClearance, PositionUncertainty, WINDING
from push_navigation.obstacle import InflatedObstacle

# Samples on a line of which one is looked at first; chosen: the width of a robot apart.
COARSE_STEP = 16
# Rounding of clearances, and of distances from the object [m].
ROUNDING, OBJECT_ROUNDING = 1e-9, 1e-6


class Visibility(NamedTuple):
    """
    What lines keep clear of, in the frame of the map.

    :param floor: ``Floor``.
    :param core: of the object, inflated by a radius, shape (n, 2) [m].
    :param core_radius: that radius [m].
    :param middle: (x, y) of the object [m].
    :param extent: of the inflated object from there [m].
    :param robot_radius: [m].
    :param start: (x, y) at which the robot's path starts [m].
    :param margin: that it keeps from obstacles everywhere [m].
    :param gap: from obstacles at its start [m].
    :param sigmas: standard deviations of its place by which it keeps clear.
    :param uncertainty: ``PositionUncertainty``.
    """

    floor: Floor
    core: FloatArray
    core_radius: float
    middle: tuple[float, float]
    extent: float
    robot_radius: float
    start: tuple[float, float]
    margin: float
    gap: float
    sigmas: float
    uncertainty: PositionUncertainty


def make_visibility(margins: MapClearance, body: InflatedObstacle,
                    object_pose: Pose) -> Visibility:
    """
    Prepare what lines keep clear of.

    :param margins: ``MapClearance`` of the robot's path.
    :param body: ``InflatedObstacle`` that its centre keeps out of.
    :param object_pose: ``Pose`` of that.
    """
    occupancy_map, uncertainty = margins.context.occupancy_map, margins.context.uncertainty
    if not margins.counts_drift:
        uncertainty = uncertainty._replace(drift=0.0)
    core = occupancy_map.to_map([object_pose.transform(corner) for corner in body.core])
    (middle_x, middle_y), (start_x, start_y) = occupancy_map.to_map(
        [object_pose[:2], margins.start[:2]]).tolist()
    extent = max(math.hypot(*corner) for corner in body.core) + body.radius
    return Visibility(
        make_floor(occupancy_map), core, float(body.radius), (middle_x, middle_y), float(extent),
        float(margins.radius), (start_x, start_y), float(margins.margin), float(margins.gap),
        float(margins.context.sigmas), PositionUncertainty(*map(float, uncertainty)))


def see_points(visibility: Visibility, point: FloatArray, points: FloatArray,
               clearances: FloatArray, spacing: float) -> BoolArray:
    """
    Tell to which points the straight line from a point is free.

    All lines have as many samples as the longest needs.

    :param visibility: ``Visibility``.
    :param point: (x, y) in the frame of the map, shape (2,) [m].
    :param points: likewise, shape (n, 2) [m].
    :param clearances: that each line keeps at least, shape (n,) [m].
    :param spacing: of samples on lines, at most [m].
    :return: shape (n,).
    """
    seen = np.empty(len(points), dtype=np.bool_)
    _see(visibility, point, points, clearances, spacing, seen)
    return seen


def warm_up(visibility: Visibility) -> None:
    """Look along a line, so that the first path does not wait for the compiler."""
    point, points, clearances = np.zeros(2), np.zeros((1, 2)), np.zeros(1)
    see_points(visibility, point, points, clearances, 1.0)
    last_seen(visibility, point, points, clearances, 1.0)


@compiled
def _see(visibility: Any, point: Any, points: Any, clearances: Any, spacing: float,
         seen: Any) -> None:
    count = _sample_count(point, points, spacing)
    for index in range(len(points)):
        seen[index] = _is_free(visibility, point, points[index], clearances[index], count)


@compiled
def last_seen(visibility: Visibility, point: FloatArray, points: FloatArray,
              clearances: FloatArray, spacing: float) -> int:
    """
    Find the last of some points to which the line is free, -1 for none.

    :param visibility: ``Visibility``; all arguments as of ``see_points``.
    """
    count = _sample_count(point, points, spacing)
    for index in range(len(points) - 1, -1, -1):
        if _is_free(visibility, point, points[index], clearances[index], count):
            return index
    return -1


@compiled
def _sample_count(point: Any, points: Any, spacing: float) -> int:
    longest = 0.0
    for index in range(len(points)):
        d_x, d_y = points[index, 0] - point[0], points[index, 1] - point[1]
        longest = max(longest, math.sqrt(d_x * d_x + d_y * d_y))
    return 2 + int(longest / spacing)


@compiled
def _is_free(visibility: Any, first: Any, last: Any, least: float, count: int) -> bool:
    """Tell whether a line is free; a few samples tell of most lines that they are not."""
    for step in (COARSE_STEP, 1):
        for sample in range(0, count, step):
            part = sample / (count - 1)
            x = first[0] + part * (last[0] - first[0])
            y = first[1] + part * (last[1] - first[1])
            if not _may_be_at(visibility, x, y, least):
                return False
    return True


@compiled
def _may_be_at(visibility: Any, x: float, y: float, least: float) -> bool:
    """Tell whether the robot's centre may be at a point, with a least clearance [m]."""
    gap = clearance(visibility.floor, x, y)
    if gap < least or gap < _required(visibility, x, y) - ROUNDING:
        return False
    d_x, d_y = x - visibility.middle[0], y - visibility.middle[1]
    if d_x * d_x + d_y * d_y > visibility.extent * visibility.extent:
        return True
    return polygon_distance(visibility.core, x, y) - visibility.core_radius >= -OBJECT_ROUNDING


@compiled
def _required(visibility: Any, x: float, y: float) -> float:
    """Compute the clearance that the robot's centre needs, as ``MapClearance.required`` [m]."""
    d_x, d_y = x - visibility.start[0], y - visibility.start[1]
    away = math.sqrt(d_x * d_x + d_y * d_y)
    position, slope, drift = visibility.uncertainty
    rising, drifting = slope * away, 0.5 * drift * WINDING * away * away
    deviation = math.sqrt(position * position + rising * rising + drifting * drifting)
    return visibility.robot_radius + max(
        visibility.margin, min(visibility.sigmas * deviation, visibility.gap + GAIN * away))
