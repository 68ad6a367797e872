"""
Footprints of object and robot in a map of obstacles.

A costmap of what a laser sees shows the object, and maybe the robot, as obstacles where they were
when they were seen. No obstacle of the floor can be where either has been since. Of cells beside
these places only those are cleared that do not go on as an obstacle beyond them: a wall beside the
object stays whole, while the rim of the object is cleared that the laser saw too far out.

A costmap goes on to show the object where it has been until that place is seen again. So a cell
that was cleared of the object stays so in later maps until one of them shows it free.
"""

from collections import deque
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, distance, FloatArray, IntArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.obstacle import inflate, InflatedObstacle
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings

# Motion after which a pose is remembered [m], [rad]; chosen: half a cell of usual maps, and as
# much at the corner of an object.
SPACING = 0.025
ANGULAR_SPACING = 0.1
# Poses that are remembered of each body; chosen: 25 m, far more than between two maps.
MAX_POSES = 1000
# Neighbours of a cell that belong to the same obstacle: all eight.
NEIGHBOURS = np.ones((3, 3), dtype=np.int_)


class _Stay(NamedTuple):
    """A pose, and until when the body was there [s]."""

    pose: Pose
    until: float


class _Clearing(NamedTuple):
    """
    Map after clearing, with what was cleared.

    :param occupancy_map: the ``OccupancyMap`` as it came.
    :param object_cells: its cells that are cleared of the object, shape (rows, columns).
    :param cells: those that are cleared in all, shape (rows, columns).
    :param result: the ``OccupancyMap`` without them.
    """

    occupancy_map: OccupancyMap
    object_cells: BoolArray
    cells: BoolArray
    result: OccupancyMap


class _Trail:
    """Poses that a body has had."""

    def __init__(self, shape: InflatedObstacle) -> None:
        self.shape = shape
        self._stays: deque[_Stay] = deque(maxlen=MAX_POSES)

    def record(self, pose: Pose, time: float) -> None:
        if self._stays:
            last = self._stays[-1].pose
            if (distance(last, pose) < SPACING
                    and abs(wrap_angle(last.theta - pose.theta)) < ANGULAR_SPACING):
                self._stays[-1] = _Stay(last, time)
                return
        self._stays.append(_Stay(pose, time))

    def since(self, time: float) -> list[Pose]:
        """Poses that the body had since a time, the last one in any case."""
        return ([stay.pose for stay in self._stays if stay.until >= time]
                or [stay.pose for stay in list(self._stays)[-1:]])


class FootprintClearing:
    """
    Remembers where object and robot were, and clears their footprints from maps.

    :param settings: ``MapSettings``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    """

    def __init__(self, settings: MapSettings, obj: PushedObject, robot: RoundRobot) -> None:
        self._settings = settings
        self._robot = _Trail(inflate((), robot.radius, 0.0))
        self.set_object(obj)

    @property
    def is_enabled(self) -> bool:
        """Tell whether footprints are cleared at all."""
        return self._settings.footprint_clearing_enabled

    def set_object(self, obj: PushedObject) -> None:
        """Clear another object from now on; the previous one is an obstacle now."""
        self._object = _Trail(inflate(obj.outline, obj.radius, 0.0))
        self._previous: _Clearing | None = None

    def record(self, time: float, object_pose: Pose | None, robot_pose: Pose | None) -> None:
        """
        Remember where object and robot are.

        :param time: of the poses [s].
        :param object_pose: ``Pose`` of the object, or None.
        :param robot_pose: ``Pose`` of the robot, or None.
        """
        for trail, pose in ((self._object, object_pose), (self._robot, robot_pose)):
            if pose is not None and self.is_enabled:
                trail.record(pose, time)

    def clear(self, occupancy_map: OccupancyMap, stamp: float) -> OccupancyMap:
        """
        Clear the footprints; called for every map, as later ones are cleared by what was before.

        :param occupancy_map: the ``OccupancyMap`` as it came.
        :param stamp: its time [s].
        :return: the map without them; the same one again as long as nothing changes.
        """
        if not self.is_enabled:
            return occupancy_map
        since = stamp - self._settings.footprint_clearing_time
        margin, previous = self._settings.footprint_clearing_margin, self._previous
        cells = np.zeros_like(occupancy_map.occupied)
        if previous is not None:
            _carry_over(previous, occupancy_map, cells)
        _mark(occupancy_map, self._object.shape, self._object.since(since), margin, cells)
        object_cells = cells.copy()
        _mark(occupancy_map, self._robot.shape, self._robot.since(since), margin, cells)
        if (previous is not None and previous.occupancy_map is occupancy_map
                and np.array_equal(previous.cells, cells)):
            return previous.result
        result = occupancy_map.freed(cells)
        self._previous = _Clearing(occupancy_map, object_cells, cells, result)
        return result


def _carry_over(previous: _Clearing, occupancy_map: OccupancyMap, cells: BoolArray) -> None:
    """Mark the cells that were cleared of the object, and have not been seen free since."""
    rows, columns = np.nonzero(previous.object_cells)
    centers = previous.occupancy_map.resolution * np.stack((columns + 0.5, rows + 0.5), axis=1)
    points = occupancy_map.to_map(previous.occupancy_map.from_map(centers))
    columns, rows = np.floor(points / occupancy_map.resolution).astype(int).T
    height, width = cells.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    cells[rows[inside], columns[inside]] = True
    cells &= occupancy_map.occupied


def _mark(occupancy_map: OccupancyMap, shape: InflatedObstacle, poses: list[Pose],
          margin: float, cells: BoolArray) -> None:
    """Mark the occupied cells that a body has made, besides those that are marked already."""
    if not poses:
        return
    size, resolution = _radius(shape), occupancy_map.resolution
    # With a rim, in which obstacles that go on are seen.
    rim = size + margin + 2.0 * resolution
    rows, columns = _occupied_near(occupancy_map, poses, rim)
    if not rows.size:
        return
    points = occupancy_map.from_map(resolution * np.stack((columns + 0.5, rows + 0.5), axis=1))
    away = _distances(shape, poses, points, size + rim)
    inside = (away < 0.0) | cells[rows, columns]
    obstacles = _obstacle_labels(rows, columns, ~inside)
    goes_on = np.isin(obstacles, np.unique(obstacles[away > margin]))
    cleared = inside | ~goes_on
    cells[rows[cleared], columns[cleared]] = True


def _occupied_near(occupancy_map: OccupancyMap, poses: list[Pose], rim: float
                   ) -> tuple[IntArray, IntArray]:
    """List rows and columns of the occupied cells about some poses, with a rim [m]."""
    resolution = occupancy_map.resolution
    points = occupancy_map.to_map([pose[:2] for pose in poses])
    first = np.maximum(np.floor((points.min(axis=0) - rim) / resolution), 0).astype(int)
    last = np.maximum(np.ceil((points.max(axis=0) + rim) / resolution), 0).astype(int)
    rows, columns = np.nonzero(occupancy_map.occupied[first[1]:last[1], first[0]:last[0]])
    return rows + first[1], columns + first[0]


def _obstacle_labels(rows: IntArray, columns: IntArray, is_occupied: BoolArray) -> IntArray:
    """
    Label the cells with the obstacle to which they belong: connected cells have the same label.

    :param rows: of the cells, shape (n,).
    :param columns: of the cells, shape (n,).
    :param is_occupied: which cells are still occupied, shape (n,).
    :return: label of each cell, from 1, 0 for the others, shape (n,).
    """
    # Imported here: a node begins sooner without it, and few maps need it.
    from scipy.ndimage import label
    rows, columns = rows - rows.min(), columns - columns.min()
    occupied = np.zeros((rows.max() + 1, columns.max() + 1), dtype=np.bool_)
    occupied[rows[is_occupied], columns[is_occupied]] = True
    labels = np.empty(occupied.shape, dtype=np.int_)
    label(occupied, NEIGHBOURS, output=labels)
    return labels[rows, columns]


def _distances(shape: InflatedObstacle, poses: list[Pose], points: FloatArray,
               max_distance: float) -> FloatArray:
    """Distances of points from a body at any of its poses [m]; large ones are not exact."""
    result = np.full(len(points), math.inf)
    for pose in poses:
        near = np.flatnonzero(np.hypot(*(points - pose[:2]).T) < max_distance)
        if near.size:
            c, s = math.cos(pose.theta), math.sin(pose.theta)
            local = (points[near] - pose[:2]) @ np.array([[c, -s], [s, c]])
            result[near] = np.minimum(result[near], shape.distances(local))
    return result


def _radius(shape: InflatedObstacle) -> float:
    return max(math.hypot(*corner) for corner in shape.core) + shape.radius
