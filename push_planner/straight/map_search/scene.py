"""Floor and object as the compiled search reads them, and their clearances."""

import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from push_navigation.floor import clearance, Floor, make_floor, polygon_distance
from push_navigation.footprint_clearance import footprint_clearance
from push_navigation.occupancy_map import footprint, OccupancyMap

# Vertices of a round outline.
NO_VERTICES = np.zeros((0, 2))


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
    floor = make_floor(occupancy_map)
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
    if scene.vertices.shape[0] == 0:
        return math.sqrt(x * x + y * y) - scene.outer_radius
    return polygon_distance(scene.vertices, x, y)
