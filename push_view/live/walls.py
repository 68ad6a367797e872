"""Walls that are drawn on open floor or on a map."""

import math

import numpy as np
from push_model.geometry import Coordinates
from push_navigation.occupancy_map import OccupancyMap

# Side of a cell of the map on which walls are drawn, and thickness of a wall [m]; chosen: as fine
# as maps of robots.
RESOLUTION = 0.05
THICKNESS = 0.1
# Half the side of the floor round the object that such a map covers [m]; all outside it is
# occupied.
HALF_SIDE = 5.0


def open_floor(center: Coordinates) -> OccupancyMap:
    """
    Make a map without obstacles.

    :param center: (x, y) of its middle [m].
    """
    count = round(2.0 * HALF_SIDE / RESOLUTION)
    origin = (center[0] - HALF_SIDE, center[1] - HALF_SIDE, 0.0)
    return OccupancyMap(RESOLUTION, origin, np.zeros((count, count), dtype=bool))


def with_wall(occupancy_map: OccupancyMap, start: Coordinates,
              end: Coordinates) -> OccupancyMap:
    """
    Draw a straight wall.

    :param start: one end (x, y) [m].
    :param end: the other end (x, y) [m].
    :return: a map with the wall too.
    """
    resolution = occupancy_map.resolution
    rows, columns = occupancy_map.occupied.shape
    (x0, y0), (x1, y1) = occupancy_map.to_map(np.array([start[:2], end[:2]])).tolist()
    y, x = resolution * (np.indices((rows, columns)) + 0.5)
    squared = max((x1 - x0) ** 2 + (y1 - y0) ** 2, 1e-12)
    along = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / squared, 0.0, 1.0)
    distance = np.hypot(x - x0 - along * (x1 - x0), y - y0 - along * (y1 - y0))
    # At least the cells that the line runs through.
    half_width = max(0.5 * THICKNESS, resolution * math.sqrt(0.5))
    return OccupancyMap(resolution, occupancy_map.origin,
                        occupancy_map.occupied | (distance <= half_width))
