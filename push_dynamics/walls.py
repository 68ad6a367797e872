"""
Walls: straight segments that neither object nor robot passes.

A wall has two sides; the one on which a body's centre is counts. Ends of walls are corners, which
touch edges of an object, unless a wall goes straight on there.
"""

import dataclasses
import math
from typing import Any, NamedTuple, Sequence

import numpy as np
from push_dynamics.compiled import compiled
from push_dynamics.contact_law import Velocity
from push_dynamics.layout import (
    COM_X, COM_Y, DISC_RADIUS, ROBOT_AT_WALL, ROBOT_RADIUS, ROBOT_X, ROBOT_Y, V_X, V_Y,
    WALL_FORCE_X, WALL_FRICTION, WALL_SLACK, X, Y,
)
from push_dynamics.wall_grid import MARGIN, wall_grid, walls_near
from push_model.geometry import BoolArray, FloatArray
from push_model.quantity import check, quantity

# Distance below which ends of walls coincide, or a point is on a wall [m]; chosen: far below what
# a drawing states, above the rounding of coordinates.
JOINT_TOLERANCE = 1e-6
# Cosine above which walls go straight on: chosen, two degrees.
STRAIGHT = math.cos(math.radians(2.0))
# Depth beyond which a point is not inside the wall but beyond it [m]; chosen: above any error of a
# start, below the width of a body.
MAX_DEPTH = 0.03
# Speed at which a body that starts inside a wall leaves it [m/s]; chosen: it must not be shot out.
LEAVING_SPEED = 0.02
# Distance at which a touch is looked for at least [m]; chosen: the way of a fast step.
MIN_REACH = 2e-3
# Speed into a wall that counts as none [m/s]: the rounding of speeds of some metres per second.
SPEED_ROUNDING = 1e-12
# Rounds over all walls that a robot needs at most: two in a corner, chosen with a reserve.
ROBOT_ROUNDS = 6


@dataclasses.dataclass(frozen=True)
class Wall:
    """A straight wall that acts on what touches it, from both sides."""

    start_x: float = quantity('one end in the world, x', 'm')
    start_y: float = quantity('the same, y', 'm')
    end_x: float = quantity('the other end in the world, x', 'm')
    end_y: float = quantity('the same, y', 'm')

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        if math.hypot(self.end_x - self.start_x, self.end_y - self.start_y) < JOINT_TOLERANCE:
            raise ValueError(f'Wall.end_x: got the start ({self.start_x:g}, {self.start_y:g}), '
                             'expected another point')


class WallGap(NamedTuple):
    """
    A point beside a wall.

    :param n_x: unit normal from the wall to the point, x.
    :param n_y: the same, y.
    :param distance: along it [m], negative behind the wall; infinite where the point is not
        beside the wall.
    """

    n_x: float
    n_y: float
    distance: float


def wall_rows(walls: Sequence[Wall]) -> list[tuple[float, ...]]:
    """
    Encode walls and their corners for the kernel.

    :return: rows (x, y, direction x, direction y, length); the length of a corner is 0.
    """
    segments = np.array([(wall.start_x, wall.start_y, wall.end_x, wall.end_y) for wall in walls])
    if not len(segments):
        return []
    starts, ends = segments[:, :2], segments[:, 2:]
    lengths = np.hypot(*(ends - starts).T)
    directions = (ends - starts) / lengths[:, None]
    rows = [(x, y, d_x, d_y, length) for (x, y), (d_x, d_y), length
            in zip(starts.tolist(), directions.tolist(), lengths.tolist())]
    points, outward = np.concatenate((starts, ends)), np.concatenate((-directions, directions))
    of_point, of_wall = wall_grid(rows, 2.0 * JOINT_TOLERANCE).pairs(points)
    goes_on = _goes_on(points[of_point] - starts[of_wall], outward[of_point],
                       directions[of_wall], lengths[of_wall])
    is_corner = np.bincount(of_point, goes_on, len(points)) == 0
    corners = {(x, y) for x, y in points[is_corner].tolist()}
    return rows + [(x, y, 0.0, 0.0, 0.0) for x, y in sorted(corners)]


def _goes_on(offsets: FloatArray, away: FloatArray, directions: FloatArray,
             lengths: FloatArray) -> BoolArray:
    """
    Tell whether a wall goes straight on behind the end of another one, or passes it.

    :param offsets: of that end from the start of the wall, shape (n, 2) [m].
    :param away: outward direction there, shape (n, 2).
    :param directions: of the wall, shape (n, 2).
    :param lengths: of the wall, shape (n,) [m].
    """
    along = np.sum(offsets * directions, axis=1)
    across = np.abs(offsets[:, 0] * directions[:, 1] - offsets[:, 1] * directions[:, 0])
    on_wall = across < JOINT_TOLERANCE
    inside = on_wall & (along > JOINT_TOLERANCE) & (along < lengths - JOINT_TOLERANCE)
    at_start = on_wall & (np.abs(along) <= JOINT_TOLERANCE)
    at_end = on_wall & (np.abs(along - lengths) <= JOINT_TOLERANCE)
    cosines = np.sum(directions * away, axis=1)
    return inside | (at_start & (cosines > STRAIGHT)) | (at_end & (cosines < -STRAIGHT))


@compiled
def bounding_radius(body: Any, outline: Any) -> float:
    """
    Compute the radius about the mass centre that covers the object [m].

    :param outline: vertices in the object frame, shape (k, 2) [m].
    """
    com_x, com_y = body[COM_X], body[COM_Y]
    if body[DISC_RADIUS] > 0.0:
        return body[DISC_RADIUS] + math.sqrt(com_x * com_x + com_y * com_y)
    radius = 0.0
    for i in range(len(outline)):
        x, y = outline[i][0] - com_x, outline[i][1] - com_y
        radius = max(radius, math.sqrt(x * x + y * y))
    return radius


@compiled
def wall_distance(wall: Any, x: float, y: float) -> float:
    """
    Compute the distance of a point from a wall or corner [m].

    :param wall: a row of ``wall_rows``.
    """
    along = (x - wall[0]) * wall[2] + (y - wall[1]) * wall[3]
    along = min(wall[4], max(0.0, along))
    d_x, d_y = x - wall[0] - along * wall[2], y - wall[1] - along * wall[3]
    return math.sqrt(d_x * d_x + d_y * d_y)


@compiled
def wall_gap(wall: Any, x: float, y: float, center_x: float, center_y: float) -> WallGap:
    """
    Find a point of a body beside a wall, or beside a corner.

    :param wall: a row of ``wall_rows``.
    :param center_x: of the body, which tells the side of the wall [m].
    :param center_y: the same.
    """
    d_x, d_y = x - wall[0], y - wall[1]
    if wall[4] == 0.0:
        distance = math.sqrt(d_x * d_x + d_y * d_y)
        if distance == 0.0:
            return WallGap(1.0, 0.0, math.inf)
        return WallGap(d_x / distance, d_y / distance, distance)
    along = d_x * wall[2] + d_y * wall[3]
    if along < 0.0 or along > wall[4]:
        return WallGap(1.0, 0.0, math.inf)
    side = (center_y - wall[1]) * wall[2] - (center_x - wall[0]) * wall[3]
    sign = 1.0 if side >= 0.0 else -1.0
    n_x, n_y = -sign * wall[3], sign * wall[2]
    return WallGap(n_x, n_y, n_x * d_x + n_y * d_y)


@compiled
def required_speed(gap: float, h: float) -> float:
    """Compute the speed away from a wall that keeps a gap from being negative [m/s]."""
    return min(-gap / h, LEAVING_SPEED)


@compiled
def _least_distance(walls: Any, x: float, y: float) -> float:
    """
    Find the distance of a point from the nearest wall that is listed there [m].

    :param walls: ``WallGrid``.
    """
    least = math.inf
    first, last = walls_near(walls, x, y)
    for k in range(first, last):
        least = min(least, wall_distance(walls.rows[walls.near[k]], x, y))
    return least


@compiled
def is_near_walls(state: Any, body: Any, outline: Any, walls: Any, robot: Velocity,
                  h: float) -> bool:
    """
    Tell whether object or robot may touch a wall in this step, and forget the touches of the last.

    Distances are measured when they may have been used up since they were last.

    :param walls: ``WallGrid``.
    :param robot: its velocity without walls, world axes.
    :param h: step [s].
    """
    for i in range(WALL_FORCE_X, ROBOT_AT_WALL + 1):
        state[i] = 0.0
    # An object that is met is hardly faster than the robot.
    travel = 2.0 * h * (math.sqrt(robot.v_x * robot.v_x + robot.v_y * robot.v_y)
                        + math.sqrt(state[V_X] * state[V_X] + state[V_Y] * state[V_Y]))
    if state[WALL_SLACK] > travel + MIN_REACH:
        state[WALL_SLACK] -= travel
        return False
    slack = min(MARGIN, _least_distance(walls, state[X], state[Y])
                - bounding_radius(body, outline))
    if math.isfinite(body[ROBOT_RADIUS]):
        slack = min(slack, _least_distance(walls, state[ROBOT_X], state[ROBOT_Y])
                    - body[ROBOT_RADIUS])
    state[WALL_SLACK] = slack - travel
    return slack <= travel + MIN_REACH


@compiled
def robot_beside_walls(walls: Any, body: Any, x: float, y: float, robot: Velocity,
                       h: float) -> Velocity:
    """
    Keep the robot out of walls for a step: they stop it along the normal, and brake it along them.

    Its wheels push in the direction in which its motion falls short of what they ask. Hence the
    friction of a wall reduces the speed along it by mu_w times the speed into it.

    :param walls: ``WallGrid``.
    :param x: of the robot at the start [m].
    :param y: the same.
    :param robot: its velocity without walls, world axes.
    :param h: step [s].
    """
    v_x, v_y, radius = robot.v_x, robot.v_y, body[ROBOT_RADIUS]
    if math.isinf(radius):
        return robot
    first, last = walls_near(walls, x, y)
    for _ in range(ROBOT_ROUNDS):
        is_stopped = False
        for k in range(first, last):
            n_x, n_y, distance = wall_gap(walls.rows[walls.near[k]], x, y, x, y)
            missing = required_speed(distance - radius, h) - (n_x * v_x + n_y * v_y)
            if distance - radius < -MAX_DEPTH or missing <= SPEED_ROUNDING:
                continue
            is_stopped = True
            slip = n_x * v_y - n_y * v_x
            braked = math.copysign(min(abs(slip), body[WALL_FRICTION] * missing), slip)
            v_x += missing * n_x + braked * n_y
            v_y += missing * n_y - braked * n_x
        if not is_stopped:
            break
    return Velocity(v_x, v_y, robot.omega)
