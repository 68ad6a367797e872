"""Objects that stand while another is pushed: obstacles of the map, and what touches them."""

import dataclasses
from typing import Sequence

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_navigation.settings import MapSettings
from push_planner.rearrangement.footprints import distances_to_object, placed_points
from push_scenario.definition.floor_map import FloorMap, FREE, OCCUPIED, UNKNOWN
from push_sim_node.tape import Tape
from push_tidy.obstacles import covered_cells, MapGrid, StandingObject

# Gap below which two bodies touch [m]; chosen: the accuracy of the plant at walls.
TOUCH_GAP = 1e-3


def with_obstacles(floor: FloorMap, reading: MapSettings, standing: Sequence[StandingObject],
                   margin: float, pushed: StandingObject) -> FloorMap:
    """
    Draw objects into a map, as cells that are no walls.

    :param reading: what is an obstacle; unknown cells that are none become free.
    :param standing: where they are measured.
    :param margin: uncertainty of their outlines [m].
    :param pushed: the object that is pushed past them; where it stands is free of them.
    """
    cells = np.array(floor.characters)
    if reading.allow_unknown:
        cells[cells == ord(UNKNOWN)] = ord(FREE)
    grid = MapGrid(floor.resolution, floor.origin.pose, *cells.shape)
    is_object = covered_cells(grid, standing, margin, pushed) & (cells != ord(OCCUPIED))
    cells[is_object] = ord(UNKNOWN)
    lines = (row.tobytes().decode('ascii') for row in cells[::-1])
    return dataclasses.replace(floor, rows='\n'.join(lines))


def least_gap(tape: Tape, obj: PushedObject, robot_radius: float,
              standing: StandingObject) -> float:
    """
    Find the least gap of robot or pushed object to one that stands [m].

    :param obj: the object that is pushed.
    """
    robot = tape.poses('robot')[:, :2]
    gaps = [distances_to_object(robot, standing.obj, standing.pose).min() - robot_radius]
    poses = tape.poses('object')
    gaps.append(_gap_of_corners(obj, poses, standing.obj, standing.pose))
    gaps.append(_gap_to_corners(obj, poses, standing.obj, standing.pose))
    return float(min(gaps))


def _corners(obj: PushedObject) -> tuple[FloatArray, float]:
    return np.array(obj.outline or ((0.0, 0.0),)), 0.0 if obj.outline else obj.radius


def _gap_of_corners(obj: PushedObject, poses: FloatArray, other: PushedObject,
                    other_pose: Pose) -> float:
    """Measure how near corners of a moving object come to one that stands [m]."""
    corners, radius = _corners(obj)
    c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    points = np.stack((poses[:, 0, None] + c * corners[:, 0] - s * corners[:, 1],
                       poses[:, 1, None] + s * corners[:, 0] + c * corners[:, 1]), axis=2)
    return float(distances_to_object(points.reshape(-1, 2), other, other_pose).min()) - radius


def _gap_to_corners(obj: PushedObject, poses: FloatArray, other: PushedObject,
                    other_pose: Pose) -> float:
    """Measure how near a moving object comes to corners of one that stands [m]."""
    corners, radius = _corners(other)
    points = placed_points(corners, other_pose)
    c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    d_x, d_y = points[:, 0] - poses[:, 0, None], points[:, 1] - poses[:, 1, None]
    local = np.stack((c * d_x + s * d_y, c * d_y - s * d_x), axis=2)
    return float(distances_to_object(local.reshape(-1, 2), obj,
                                     Pose(0.0, 0.0, 0.0)).min()) - radius
