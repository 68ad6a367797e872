"""Where object or robot, as they truly are, touch what a map has as occupied."""

import enum
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import BoolArray, Coordinates, FloatArray
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.obstacle import points_on_outline
from push_navigation.occupancy_map import OccupancyMap
from push_sim_node.tape import Tape

# Spacing of the points on a rim [m]; chosen: a corner of a wall between two of them pokes in by
# less than it.
SPACING = 0.01
# Distance at which something touches a wall [m]; chosen: walls stop it at 0, but for rounding.
TOUCHING = 1e-3
# Rows of a tape from one look to the next; chosen: at 50 Hz and 0.3 m/s half a centimetre is
# missed at most.
STRIDE = 2


class Body(enum.Enum):
    """Body that can touch a wall; the values are those of messages."""

    ROBOT = 'robot'
    OBJECT = 'object'


class WallContact(NamedTuple):
    """
    A body touches a wall.

    :param body: the ``Body``.
    :param point: where (x, y) [m].
    """

    body: Body
    point: tuple[float, float]

    def __str__(self) -> str:
        """Say so in a sentence."""
        return f'the {self.body.value} touches a wall'


class WallContactDetector:
    """
    Finds out what touches a wall.

    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot) -> None:
        rim = points_on_outline(obj.outline, SPACING) if obj.outline else _circle(obj.radius)
        rims = {Body.ROBOT: _circle(robot.radius), Body.OBJECT: rim}
        self._rims = {body: points * (1.0 + TOUCHING / np.linalg.norm(points, axis=1)[:, None])
                      for body, points in rims.items()}

    def find(self, occupancy_map: OccupancyMap, body: Body,
             pose: Coordinates) -> WallContact | None:
        """
        Find where a body touches what is occupied; what is inside of it does not count.

        :param occupancy_map: the ``OccupancyMap``; everything outside it is occupied.
        :param pose: (x, y, theta) of the body in the world.
        """
        c, s = math.cos(pose[2]), math.sin(pose[2])
        points = self._rims[body] @ np.array([[c, s], [-s, c]]) + np.asarray(pose[:2])
        inside = points[_is_occupied(occupancy_map, points)]
        if not len(inside):
            return None
        x, y = inside.mean(axis=0).tolist()
        return WallContact(body, (x, y))

    def contacts_of(self, tape: Tape,
                    occupancy_map: OccupancyMap) -> list[tuple[float, WallContact]]:
        """
        Find when touching began in a run.

        :return: times [s] in order, each with its ``WallContact``.
        """
        contacts: list[tuple[float, WallContact]] = []
        for body in Body:
            poses, touched = tape.poses(body.value), False
            for row in range(0, len(poses), STRIDE):
                contact = self.find(occupancy_map, body, poses[row])
                if contact is not None and not touched:
                    contacts.append((float(tape['time'][row]), contact))
                touched = contact is not None
        return sorted(contacts, key=lambda item: item[0])


def _is_occupied(occupancy_map: OccupancyMap, points: FloatArray) -> BoolArray:
    cells = np.floor(occupancy_map.to_map(points) / occupancy_map.resolution).astype(int)
    rows, columns = occupancy_map.occupied.shape
    column, row = cells.T
    is_outside = (column < 0) | (column >= columns) | (row < 0) | (row >= rows)
    occupied = occupancy_map.occupied[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
    return is_outside | occupied


def _circle(radius: float) -> FloatArray:
    angles = np.linspace(0.0, math.tau, max(4, math.ceil(math.tau * radius / SPACING)))[:-1]
    return radius * np.column_stack((np.cos(angles), np.sin(angles)))
