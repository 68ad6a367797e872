"""Maps that several tests plan in."""

import numpy as np
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap


def walled_floor(width, height, door=None, resolution=0.05):
    """Return a floor about the origin within walls; a wall across it at x = 0 may have a door."""
    occupied = np.zeros((round(height / resolution), round(width / resolution)), dtype=bool)
    occupied[[0, -1]] = True
    occupied[:, [0, -1]] = True
    if door is not None:
        rows, columns = occupied.shape
        half = round(0.5 * door / resolution)
        occupied[:, columns // 2] = True
        occupied[rows // 2 - half:rows // 2 + half, columns // 2] = False
    return OccupancyMap(resolution, Pose(-0.5 * width, -0.5 * height, 0.0), occupied)
