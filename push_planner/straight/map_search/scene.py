"""Floor and object as the compiled search reads them, and their clearances."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from push_navigation.footprint_clearance import footprint_clearance
from push_navigation.occupancy_map import footprint, OccupancyMap

# Vertices of a round outline.
NO_VERTICES = np.zeros((0, 2))


class Floor(NamedTuple):
    """
    Obstacles; positions are in the frame of the map.

    :param distances: clearances of cell centres, with a border of one cell, shape (r, c) [m].
    :param cells_per_metre: of the map [1/m].
    """

    distances: NDArray[np.float32]
    cells_per_metre: float


class Scene(NamedTuple):
    """
    Floor, object and robot.

    :param floor: ``Floor``.
    :param core: vertices of the outline, of a disc its middle, shape (n, 2) [m].
    :param vertices: of the outline, counter-clockwise, shape (m, 2) [m]; none of a disc.
    :param inner_radius: of the greatest disc about the object frame that the object contains [m].
    :param outer_radius: of the least one that contains it [m].
    :param robot_radius: [m].
    """

    floor: Floor
    core: FloatArray
    vertices: FloatArray
    inner_radius: float
    outer_radius: float
    robot_radius: float


def make_scene(occupancy_map: OccupancyMap, obj: PushedObject, robot_radius: float) -> Scene:
    """
    Prepare a map, an object and a robot for the search.

    :param robot_radius: [m].
    """
    floor = Floor(occupancy_map.distances, 1.0 / occupancy_map.resolution)
    core, _ = footprint(obj)
    if not obj.outline:
        return Scene(floor, core, NO_VERTICES, obj.radius, obj.radius, robot_radius)
    vertices = np.array(obj.outline, dtype=float)
    following = np.roll(vertices, -1, axis=0)
    edges = following - vertices
    lengths = np.hypot(*edges.T)
    depths = (vertices[:, 0] * following[:, 1] - vertices[:, 1] * following[:, 0]) / lengths
    return Scene(floor, core, vertices,
                 max(0.0, float(depths.min())), float(np.hypot(*vertices.T).max()), robot_radius)


@compiled
def clearance(floor: Any, x: float, y: float) -> float:
    """
    Interpolate the distance of a point from obstacles.

    :param floor: ``Floor``.
    :param x: along columns, from the outer corner of the first cell [m].
    :param y: along rows [m].
    :return: distance [m], negative in obstacles and outside the map.
    """
    column = x * floor.cells_per_metre + 0.5
    row = y * floor.cells_per_metre + 0.5
    rows, columns = floor.distances.shape
    if column < 0.0 or row < 0.0 or column >= columns - 1 or row >= rows - 1:
        return -1.0
    j, i = int(column), int(row)
    u, v = column - j, row - i
    return ((floor.distances[i, j] * (1.0 - u) + floor.distances[i, j + 1] * u) * (1.0 - v)
            + (floor.distances[i + 1, j] * (1.0 - u) + floor.distances[i + 1, j + 1] * u) * v)


@compiled
def object_clearance(scene: Any, x: float, y: float, theta: float, enough: float) -> float:
    """
    Find the clearance of the object, or some that is enough.

    :param scene: ``Scene``.
    :param x: of the object frame [m].
    :param y: of the object frame [m].
    :param theta: of the object frame [rad].
    :param enough: clearance from which on no exact value is needed [m].
    :return: distance [m], negative where it overlaps an obstacle.
    """
    middle = clearance(scene.floor, x, y)
    if middle - scene.outer_radius >= enough:
        return middle - scene.outer_radius
    radius = scene.outer_radius if scene.vertices.shape[0] == 0 else 0.0
    return footprint_clearance(scene.floor.distances, scene.floor.cells_per_metre,
                               (scene.core, radius), (x, y, theta), enough)


@compiled
def distance_to_object(scene: Any, x: float, y: float) -> float:
    """
    Measure the distance of a point from the object.

    :param scene: ``Scene``.
    :param x: in the object frame [m].
    :param y: in the object frame [m].
    :return: distance [m], negative inside.
    """
    count = scene.vertices.shape[0]
    if count == 0:
        return math.sqrt(x * x + y * y) - scene.outer_radius
    nearest = 1e18
    inside = True
    for k in range(count):
        following = k + 1 if k + 1 < count else 0
        x0, y0 = scene.vertices[k, 0], scene.vertices[k, 1]
        e_x, e_y = scene.vertices[following, 0] - x0, scene.vertices[following, 1] - y0
        d_x, d_y = x - x0, y - y0
        if e_x * d_y - e_y * d_x < 0.0:
            inside = False
        t = min(1.0, max(0.0, (d_x * e_x + d_y * e_y) / (e_x * e_x + e_y * e_y)))
        d_x, d_y = d_x - t * e_x, d_y - t * e_y
        nearest = min(nearest, d_x * d_x + d_y * d_y)
    return -math.sqrt(nearest) if inside else math.sqrt(nearest)
