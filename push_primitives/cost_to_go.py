"""
Cost-to-go: expected time until the object is at its goal, by value iteration.

The goal in the frame of the object, at distance r, bearing beta and heading theta, and the face f
at which the robot stands make a state. With the time a(f, f') to get from face to face and to
begin a push there, primitives p of length l at face f', speed v and guesses k of friction,

    V(f, g) = min over f', p, l of  a(f, f') + l / v + t_0 + mean over k of V(f', g_k(p, l)),

where g_k is the goal as seen after the push; V = 0 where g is within the tolerances (Bellman's
equation; V holds everything that remains to do: chains of pushes, corrections, their contacts).
Gauss-Seidel sweeps from small distances outwards solve it.
"""

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray, IntArray, Pose
from push_model.parameters import Drive, DRIVES
from push_model.quantity import check, quantity
from push_primitives.placement_errors import with_placement_errors
from push_primitives.table import PrimitiveTable

# Grid of distances and headings, chosen: fine about the edge of the tolerances, then in steps of
# constant ratio up to 3.3 m, and up to 30 degrees apart.
INNER_FRACTION = 0.47
EDGE_RATIO = 1.12
DISTANCE_RATIO = 1.45
LARGEST_DISTANCE = 3.3
HEADING_RATIO = 1.57
LARGEST_HEADING_STEP = math.radians(30.0)
BEARINGS = 32
# Rise of V beyond the grid [s/m]: about that of its last two metres.
OUTER_SLOPE = 9.0
# Guess of friction numbers that V averages over, chosen: draw 0 is nominal.
AVERAGED_DRAWS = (1, 2, 3, 4)
# Part of a robot's path round the object over the arc between the middles of two faces, chosen:
# paths cut corners.
ARC_FRACTION = 0.8
# Distance of that path from the places where pushes begin [m], chosen: the usual clearance.
ARC_CLEARANCE = 0.08
# Lengths of robot path that backing off and coming again costs, in a straight line and turning to
# it [m], by drive: fitted to simulated contacts of a robot at 0.3 m/s.
CONTACT_PATHS: dict[Drive, float] = {'differential': 0.9, 'holonomic': 0.6}
# Every this many-th place of a polygon's face is an action of V, and every tilt up to the largest.
PLACE_STRIDE = 2
ACTION_TILTS = (-0.3, 0.0, 0.3)
# Shortest primitives that are actions, relative to the position tolerance.
SHORTEST_ACTION = 0.6
# Actions that are kept for each state and face, sweeps over them, and how often they are chosen
# anew. Measured by benchmarks against sweeps over all actions: V is below 3 % off.
KEPT_ACTIONS = 16
SELECTIONS = 2
SWEEPS = 3


@dataclasses.dataclass(frozen=True)
class CostSettings:
    """What the expected time of a task depends on, besides the object."""

    position_tolerance: float = quantity('largest distance from the goal', 'm', above=0.0,
                                         high=1.0, default=0.01)
    heading_tolerance: float = quantity('largest heading error at the goal', 'rad', above=0.0,
                                        high=3.0, default=math.radians(1.0))
    position_deviation: float = quantity('standard deviation of the position as it is measured '
                                         'at rest; leaves that much less of the tolerance', 'm',
                                         0.0, 0.1, default=0.0015)
    heading_deviation: float = quantity('the same of the heading', 'rad', 0.0, 0.1,
                                        default=math.radians(0.2))
    pushing_speed: float = quantity('speed of pushes', 'm/s', above=0.0, high=5.0, default=0.17)
    robot_speed: float = quantity('speed of the robot on its own', 'm/s', above=0.0, high=5.0,
                                  default=0.3)
    drive: Drive = quantity('kinematics of the robot', choices=DRIVES, default='differential')
    push_time: float = quantity('time to accelerate and brake, per push', 's', 0.0, 60.0,
                                default=0.5)
    contact_time: float = quantity('time to measure at rest, to plan and to settle, per contact',
                                   's', 0.0, 60.0, default=1.3)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)

    @property
    def position_limit(self) -> float:
        """Distance within which the object counts as at its goal [m]."""
        return max(0.3 * self.position_tolerance,
                   self.position_tolerance - self.position_deviation)

    @property
    def heading_limit(self) -> float:
        """Heading error within which the object counts as at its goal [rad]."""
        return max(0.3 * self.heading_tolerance, self.heading_tolerance - self.heading_deviation)


@dataclasses.dataclass(frozen=True, eq=False)
class CostToGo:
    """
    Expected time until the object is at its goal [s]; arrays are read-only.

    :param values: by face where the robot stands, distance, bearing (equally spaced, from 0,
        counter-clockwise) and heading of the goal in the object frame, shape (F, R, B, T) [s].
    :param distances: of the goal, increasing from 0, shape (R,) [m].
    :param headings: of the goal, increasing from -pi to pi, shape (T,) [rad].
    """

    values: NDArray[np.float32]
    distances: FloatArray
    headings: FloatArray

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for array in (self.values, self.distances, self.headings):
            array.setflags(write=False)

    def at(self, goal: Pose, face: int) -> float:
        """
        Interpolate.

        :param goal: ``Pose`` of the goal in the object frame.
        :param face: where the robot stands.
        :return: expected time [s].
        """
        return float(interpolate_cost(self.values, self.distances, self.headings, *goal, face))


class GridPosition(NamedTuple):
    """
    Position between two points of a grid.

    :param index: of the lower point.
    :param fraction: of the distance to the next one, 0 to 1.
    """

    index: int
    fraction: float


class Actions(NamedTuple):
    """
    Pushes that value iteration chooses from, shortest first; m of them, S guesses of friction.

    :param displacements: of the object, in its frame, shape (m, S, 3).
    :param means: their mean, shape (m, 3).
    :param faces: shape (m,).
    :param times: shape (m,) [s].
    """

    displacements: FloatArray
    means: FloatArray
    faces: IntArray
    times: FloatArray


@compiled
def locate(grid: Any, value: float) -> GridPosition:
    """
    Find a value in an increasing grid; beyond the ends the end counts.

    :param grid: shape (n,).
    :param value: of the same unit.
    """
    low, high = 0, grid.shape[0] - 1
    if value <= grid[0]:
        return GridPosition(0, 0.0)
    if value >= grid[high]:
        return GridPosition(high - 1, 1.0)
    while high - low > 1:
        middle = (low + high) // 2
        if grid[middle] <= value:
            low = middle
        else:
            high = middle
    return GridPosition(low, (value - grid[low]) / (grid[low + 1] - grid[low]))


@compiled
def interpolate_cost(values: Any, distances: Any, headings: Any, x: float, y: float,
                     theta: float, face: int) -> float:
    """
    Interpolate the cost-to-go, linearly in distance, bearing and heading.

    :param values: shape (F, R, B, T), see ``CostToGo``.
    :param distances: shape (R,) [m].
    :param headings: shape (T,) [rad].
    :param x: goal in the object frame, x [m].
    :param y: the same, y [m].
    :param theta: the same, heading, any angle [rad].
    :param face: where the robot stands.
    :return: expected time [s].
    """
    bearings = values.shape[2]
    distance = math.sqrt(x * x + y * y)
    theta -= 2.0 * math.pi * math.floor((theta + math.pi) / (2.0 * math.pi))
    i, u = locate(distances, distance)
    k, w = locate(headings, theta)
    bearing = math.atan2(y, x) * (bearings / (2.0 * math.pi))
    if bearing < 0.0:
        bearing += bearings
    j = int(bearing)
    v = bearing - j
    j = j % bearings
    after = j + 1 if j + 1 < bearings else 0
    near = ((values[face, i, j, k] * (1.0 - v) + values[face, i, after, k] * v) * (1.0 - w)
            + (values[face, i, j, k + 1] * (1.0 - v) + values[face, i, after, k + 1] * v) * w)
    i += 1
    far = ((values[face, i, j, k] * (1.0 - v) + values[face, i, after, k] * v) * (1.0 - w)
           + (values[face, i, j, k + 1] * (1.0 - v) + values[face, i, after, k + 1] * v) * w)
    beyond = max(0.0, distance - distances[distances.shape[0] - 1])
    return near * (1.0 - u) + far * u + OUTER_SLOPE * beyond


@compiled
def cost_after(values: Any, distances: Any, headings: Any, x: float, y: float, theta: float,
               displacement: Any, face: int) -> float:
    """
    Interpolate the cost-to-go after a displacement of the object.

    Arguments are as in ``interpolate_cost``; ``displacement`` is the new (x, y, theta) of the
    object in its old frame.
    """
    d_x, d_y = x - displacement[0], y - displacement[1]
    c, s = math.cos(displacement[2]), math.sin(displacement[2])
    return interpolate_cost(values, distances, headings, c * d_x + s * d_y, c * d_y - s * d_x,
                            theta - displacement[2], face)


def solve_cost_to_go(table: PrimitiveTable, settings: CostSettings | None = None) -> CostToGo:
    """
    Solve Bellman's equation for an object.

    :param table: its ``PrimitiveTable``.
    :param settings: ``CostSettings``, or None for the defaults.
    :return: ``CostToGo``.
    """
    settings = settings or CostSettings()
    distances = distance_grid(settings.position_limit)
    headings = heading_grid(settings.heading_limit)
    shape = (table.face_count, len(distances), BEARINGS, len(headings))
    values = np.empty(shape, dtype=np.float32)
    values[:] = 8.0 + OUTER_SLOPE * distances[:, None, None] + 4.0 * np.abs(headings)
    arrived = ((distances <= settings.position_limit + 1e-9)[:, None, None]
               & (np.abs(headings) <= settings.heading_limit + 1e-9))
    arrived = np.broadcast_to(arrived, shape[1:])
    values[:, arrived] = 0.0
    actions = select_actions(table, settings)
    contact_times = face_change_times(table, settings)
    kept = np.full((*shape[1:], shape[0], KEPT_ACTIONS), -1, dtype=np.int16)
    best = np.zeros(shape[0])
    for _ in range(SELECTIONS):
        _keep_best_actions(values, distances, headings, actions, kept,
                           np.zeros((shape[0], KEPT_ACTIONS)))
        for _ in range(SWEEPS):
            _sweep(values, distances, headings, arrived, actions, kept, contact_times, best)
    return CostToGo(values, distances, headings)


def distance_grid(limit: float) -> FloatArray:
    """
    Lay the grid of distances [m].

    :param limit: distance at which the object is at its goal [m].
    """
    grid = [0.0, INNER_FRACTION * limit, limit, EDGE_RATIO * limit]
    while grid[-1] < LARGEST_DISTANCE:
        grid.append(DISTANCE_RATIO * grid[-1])
    return np.array([*grid[:-1], max(LARGEST_DISTANCE, 1.1 * grid[-2])])


def heading_grid(limit: float) -> FloatArray:
    """
    Lay the grid of headings, symmetric about 0 [rad].

    :param limit: heading at which the object is at its goal [rad].
    """
    half = [0.5 * limit, limit, EDGE_RATIO * limit]
    while half[-1] < math.pi:
        half.append(min(HEADING_RATIO * half[-1], half[-1] + LARGEST_HEADING_STEP))
    half[-1] = math.pi
    if half[-1] - half[-2] < 0.3 * LARGEST_HEADING_STEP:
        del half[-2]
    return np.array([-angle for angle in reversed(half)] + [0.0] + half)


def face_change_times(table: PrimitiveTable, settings: CostSettings) -> FloatArray:
    """
    Estimate the time from the end of a push at one face to the begin of one at another.

    :param table: ``PrimitiveTable``.
    :param settings: ``CostSettings``.
    :return: times, shape (F, F) [s].
    """
    points = np.array([place.point for place in table.places])
    faces = np.array([place.face for place in table.places])
    middles = np.array([points[faces == face].mean(axis=0) for face in range(table.face_count)])
    bearings = np.arctan2(middles[:, 1], middles[:, 0])
    turns = np.abs(np.angle(np.exp(1j * (bearings[:, None] - bearings[None]))))
    radius = float(np.hypot(*table.starts[:, :2].T).mean()) + ARC_CLEARANCE
    paths = CONTACT_PATHS[settings.drive] + ARC_FRACTION * radius * turns
    return settings.contact_time + paths / settings.robot_speed


def select_actions(table: PrimitiveTable, settings: CostSettings) -> Actions:
    """
    Thin the primitives out to those that value iteration chooses from.

    :param table: ``PrimitiveTable``.
    :param settings: ``CostSettings``.
    """
    is_round = len({place.normal for place in table.places}) == len(table.places)
    numbers = np.flatnonzero(
        (is_round | (table.place_indices % PLACE_STRIDE == 0))
        & np.isclose(np.abs(table.tilts)[:, None], np.abs(ACTION_TILTS)).any(axis=1))
    steps = np.flatnonzero(table.lengths >= SHORTEST_ACTION * settings.position_tolerance)
    displacements = with_placement_errors(table)[numbers][:, AVERAGED_DRAWS][:, :, steps]
    displacements = displacements.transpose(2, 0, 1, 3).reshape(-1, len(AVERAGED_DRAWS), 3)
    times = np.repeat(table.lengths[steps] / settings.pushing_speed + settings.push_time,
                      len(numbers))
    return Actions(np.ascontiguousarray(displacements), displacements.mean(axis=1),
                   np.tile(table.faces[numbers], len(steps)), times)


@compiled
def _keep_best_actions(values: Any, distances: Any, headings: Any, actions: Actions, kept: Any,
                       costs: Any) -> None:
    """Write the best actions of every state and face, judged by their mean effect."""
    for i in range(values.shape[1]):
        for j in range(values.shape[2]):
            bearing = 2.0 * math.pi * j / values.shape[2]
            x, y = distances[i] * math.cos(bearing), distances[i] * math.sin(bearing)
            for k in range(values.shape[3]):
                for face in range(values.shape[0]):
                    for n in range(costs.shape[1]):
                        costs[face, n] = math.inf
                        kept[i, j, k, face, n] = -1
                _keep_best_of_state(values, distances, headings, actions, x, y, headings[k],
                                    kept[i, j, k], costs)


@compiled
def _keep_best_of_state(values: Any, distances: Any, headings: Any, actions: Actions, x: float,
                        y: float, theta: float, kept: Any, costs: Any) -> None:
    last = costs.shape[1] - 1
    for action in range(actions.times.shape[0]):
        face = actions.faces[action]
        time = actions.times[action]
        if time >= costs[face, last]:
            continue
        cost = time + cost_after(values, distances, headings, x, y, theta,
                                 actions.means[action], face)
        if cost >= costs[face, last]:
            continue
        n = last
        while n > 0 and costs[face, n - 1] > cost:
            costs[face, n] = costs[face, n - 1]
            kept[face, n] = kept[face, n - 1]
            n -= 1
        costs[face, n] = cost
        kept[face, n] = action


@compiled
def _sweep(values: Any, distances: Any, headings: Any, arrived: Any, actions: Actions, kept: Any,
           contact_times: Any, best: Any) -> None:
    """Improve the values of all states by their kept actions, from small distances outwards."""
    for i in range(values.shape[1]):
        for j in range(values.shape[2]):
            bearing = 2.0 * math.pi * j / values.shape[2]
            x, y = distances[i] * math.cos(bearing), distances[i] * math.sin(bearing)
            for k in range(values.shape[3]):
                if arrived[i, j, k]:
                    continue
                for face in range(values.shape[0]):
                    best[face] = _best_cost(values, distances, headings, actions, x, y,
                                            headings[k], kept[i, j, k, face])
                for face in range(values.shape[0]):
                    value = math.inf
                    for other in range(values.shape[0]):
                        value = min(value, contact_times[face, other] + best[other])
                    values[face, i, j, k] = value


@compiled
def _best_cost(values: Any, distances: Any, headings: Any, actions: Actions, x: float, y: float,
               theta: float, kept: Any) -> float:
    """Least expected cost among the kept actions of a state and a face [s]."""
    count = actions.displacements.shape[1]
    best = math.inf
    for n in range(kept.shape[0]):
        action = kept[n]
        if action < 0:
            break
        total = actions.times[action] * count
        for draw in range(count):
            total += cost_after(values, distances, headings, x, y, theta,
                                actions.displacements[action, draw], actions.faces[action])
            if total >= best * count:
                break
        best = min(best, total / count)
    return best
