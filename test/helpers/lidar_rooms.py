"""Rooms of known walls, and what a lidar measures in them, computed apart from the package."""

import math

import numpy as np
from push_localization.settings import PlaceSettings
from push_localization.wall_field import WallField
from push_model.geometry import Pose
from push_model.signals import LidarScan, Odometry, Twist

RESOLUTION = 0.05
BEAMS, PERIOD, RANGE_MAX = 360, 0.1, 12.0
# Faces of cells are where the walls are.
EXACT = PlaceSettings(source='scan', wall_offset=0.0, map_noise=0.1)


def room_cells(length, width, niches=()):
    """Draw the walls of a room with its inner corner at the origin of the cells (2, 2)."""
    columns, rows = (round(side / RESOLUTION) + 4 for side in (length, width))
    cells = np.ones((rows, columns), dtype=bool)
    cells[2:-2, 2:-2] = False
    for first, low, last, high in niches:
        cells[low:high, first:last] = True
    return cells


def field_of(cells, origin=Pose(0.0, 0.0, 0.0), offset=0.0):
    """Make the field of walls."""
    return WallField(RESOLUTION, origin, cells, offset)


def cast(cells, origin, lens, angles, range_max=RANGE_MAX):
    """Cast beams by small steps through the cells: slow, and with nothing of the package."""
    x, y = origin.inverse().transform(lens[:2])
    directions = np.asarray(angles) + lens[2] - origin.theta
    distances = np.arange(0.0, range_max, 2e-3)
    columns = np.floor((x + np.cos(directions)[:, None] * distances) / RESOLUTION).astype(int)
    rows = np.floor((y + np.sin(directions)[:, None] * distances) / RESOLUTION).astype(int)
    inside = ((columns >= 0) & (rows >= 0) & (columns < cells.shape[1])
              & (rows < cells.shape[0]))
    hits = inside & cells[np.clip(rows, 0, cells.shape[0] - 1),
                          np.clip(columns, 0, cells.shape[1] - 1)]
    first = hits.argmax(axis=1)
    return np.where(hits.any(axis=1), distances[first] - 1e-3, np.inf)


def scan_at(cells, pose, time=0.0, *, origin=Pose(0.0, 0.0, 0.0), noise=None, beams=BEAMS):
    """Measure a scan of a robot that stands at a pose; ``pose`` may be a function of time."""
    angles = -math.pi + 2.0 * math.pi / beams * np.arange(beams)
    increment = PERIOD / beams
    if callable(pose):
        ranges = np.concatenate([
            cast(cells, origin, pose(time + increment * index), angles[index:index + 1])
            for index in range(beams)])
    else:
        ranges = cast(cells, origin, pose, angles)
    if noise is not None:
        ranges = ranges + 0.02 * noise.standard_normal(beams)
    return LidarScan(time, ranges, -math.pi, 2.0 * math.pi / beams, increment, 0.1, RANGE_MAX)


def standing(time, pose):
    """Make odometry of a robot at a pose."""
    return Odometry(time, Pose(*pose), Twist())
