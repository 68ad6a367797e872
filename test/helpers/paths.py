"""Paths that several tests drive along."""

import math

from push_model.geometry import Pose
from push_navigation.path import differential_path, holonomic_path

# An arc to the left between straight lines, and a corner.
CURVE = [(1.0, 0.0, 0.0), (1.3, 0.3, 0.5 * math.pi), (1.3, 1.0, 0.0), (0.5, 1.5, 0.0)]


def curved_path(drive='differential', scale=1.0):
    """Return a path with an arc and a corner."""
    waypoints = [(scale * x, scale * y, arc_angle) for x, y, arc_angle in CURVE]
    start, goal = Pose(0.0, 0.0, 0.4), Pose(scale * 0.5, scale * 1.5, -2.0)
    if drive == 'holonomic':
        return holonomic_path(start, goal, waypoints)
    return differential_path(start, goal, waypoints, [False] * len(waypoints))
