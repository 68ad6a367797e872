"""
Value iteration: how the cost-to-go of an object is computed.

The goal in the frame of the object, at distance r, bearing beta and heading theta, and the face f
at which the robot stands make a state. With the time a(f, f') to get from face to face and to
begin a push there, primitives p of length l at face f', speed v and samples k of friction,

    V(f, g) = min over f', p, l of  a(f, f') + l / v + t_0 + mean over k of V(f', g_k(p, l)),

where g_k is the goal as seen after the push; V = 0 where g is within the tolerances (Bellman's
equation; V holds everything that remains to do: chains of pushes, corrections, their contacts).
Gauss-Seidel sweeps from small distances outwards solve it.
"""

from collections.abc import Callable, Generator, Sequence
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_dynamics.compiled import compiled, wrap_angles
from push_model.geometry import FloatArray, IntArray, Pose
from push_primitives.cost_settings import CONTACT_PATHS, CostSettings
from push_primitives.cost_to_go import (
    cost_after, CostGrid, CostToGo, GridPosition, interpolate_cell, locate,
)
from push_primitives.placement_errors import (
    LOCALIZED, PlacementDeviations, with_placement_errors,
)
from push_primitives.table import PrimitiveTable

# Grid of distances and headings, chosen: fine about the edge of the tolerances, then in steps of
# constant ratio up to 3.3 m, and up to 30 degrees apart.
INNER_FRACTION = 0.47
EDGE_RATIO = 1.12
DISTANCE_RATIO = 1.45
MAX_DISTANCE = 3.3
HEADING_RATIO = 1.57
MAX_HEADING_STEP = math.radians(30.0)
BEARINGS = 32
# Indices of the friction samples that V averages over, chosen: sample 0 is nominal.
AVERAGED_SAMPLES = (1, 2, 3, 4)
# Part of a robot's path round the object over the arc between the middles of two faces, chosen:
# paths cut corners.
ARC_FRACTION = 0.8
# Distance of that path from the points where pushes begin [m], chosen: the usual clearance.
ARC_CLEARANCE = 0.08
# Every this many-th point of a polygon's face is an action of V, at these approach angles [rad].
POINT_STRIDE = 2
ACTION_ANGLES = (-0.3, 0.0, 0.3)
# Shortest primitives that are actions, relative to the position tolerance.
SHORTEST_ACTION = 0.6
# Actions that are kept for each state and face; every this many-th bearing and heading selects
# among all actions, the others among those of their neighbours; selections, and sweeps after each.
# Measured: V is 0.2 % off that by sweeps over all actions in the mean, in a tenth of the time.
SELECTED_ACTIONS = 16
SELECTION_STRIDE = 2
ROUNDS = (2, 1)
# Factor on the first guess of V, and rounds from there, where that guess would be far too low, as
# for a disc that only its centre of friction turns. From above every V can be kept by some chain
# of pushes, so that each step of look-ahead promises to do better than V; from below a V that has
# not converged promises what no push keeps. Measured: factors from 2 to 3 leave V alike.
HIGH_START = 3.0
HIGH_ROUNDS = (4, 4)


class Actions(NamedTuple):
    """
    Pushes that value iteration chooses from, shortest first; m of them, S samples of friction.

    :param displacements: of the object, in its frame, shape (m, S, 3).
    :param means: their mean, shape (m, 3).
    :param faces: shape (m,).
    :param times: shape (m,) [s].
    """

    displacements: FloatArray
    means: FloatArray
    faces: Any
    times: Any


class Iteration(NamedTuple):
    """
    Arrays that the sweeps read and write.

    :param grid: ``CostGrid``, the values of which are written.
    :param actions: ``Actions``.
    :param selected: index of the best actions of each state and face, best first, then -1, shape
        (R, B, T, F, N).
    """

    grid: CostGrid
    actions: Actions
    selected: NDArray[np.int16]


class Selection(NamedTuple):
    """
    Memory of the selection of actions; m actions, N selected for a face.

    :param heading_indices: grid position of the heading that each action leaves, shape (m,).
    :param heading_fractions: the same, shape (m,).
    :param lower_bounds: least value in each cell of the grid, shape (F, R - 1, T - 1) [s].
    :param costs: of the selected actions, ascending, shape (F, N) [s].
    :param limits: upper bounds of the last of them, shape (F,) [s].
    :param candidates: copy of the actions selected for a face, shape (N,).
    """

    heading_indices: IntArray
    heading_fractions: FloatArray
    lower_bounds: FloatArray
    costs: FloatArray
    limits: FloatArray
    candidates: NDArray[np.int16]


def solve_cost_to_go(table: PrimitiveTable, settings: CostSettings | None = None,
                     deviations: PlacementDeviations = LOCALIZED,
                     from_above: bool = False,
                     progress: Callable[[float], None] = lambda part: None) -> CostToGo:
    """
    Solve Bellman's equation for an object.

    :param table: its ``PrimitiveTable``.
    :param settings: ``CostSettings``, or None for the defaults.
    :param deviations: ``PlacementDeviations`` of the pushes.
    :param from_above: whether the first guess is above the result, as for objects that are hard
        to turn.
    :param progress: called with the part that is done, from 0 to 1.
    """
    settings = settings or CostSettings()
    distances = distance_grid(settings.position_limit)
    headings = heading_grid(settings.heading_limit)
    shape = (table.face_count, len(distances), BEARINGS, len(headings))
    values = np.empty(shape, dtype=np.float32)
    values[:] = np.maximum((6.0 + 20.0 * np.sqrt(distances) + 2.0 * distances)[:, None, None],
                           np.minimum(14.0 + 7.0 * np.abs(headings),
                                      5.0 + 140.0 * np.abs(headings)))
    arrived = ((distances <= settings.position_limit + 1e-9)[:, None, None]
               & (np.abs(headings) <= settings.heading_limit + 1e-9))
    arrived = np.broadcast_to(arrived, shape[1:])
    if from_above:
        values *= HIGH_START
    values[:, arrived] = 0.0
    actions = select_actions(table, settings, deviations)
    contact_times = face_change_times(table, settings)
    iteration = Iteration(
        CostGrid(values, distances, headings), actions,
        np.full((*shape[1:], shape[0], SELECTED_ACTIONS), -1, dtype=np.int16))
    best = np.zeros(shape[0])
    schedule = HIGH_ROUNDS if from_above else ROUNDS
    passes = _Passes(sum(1 + 2 * rounds for rounds in schedule), progress)
    for rounds in schedule:
        memory = _selection(values, len(actions.times))
        # By headings and by distances: a signal is noticed between two calls.
        for k in passes.over(range(0, len(headings), SELECTION_STRIDE)):
            _select_best(iteration, memory, k)
        for _ in range(rounds):
            for i in passes.over(range(len(distances))):
                _share_actions(iteration, memory, i)
            # From small distances outwards.
            for i in passes.over(range(len(distances))):
                _sweep(iteration, arrived, contact_times, best, i)
    return CostToGo(values, distances, headings)


class _Passes:
    """
    Passes over the grid, which take about the same time each, and how far they are.

    :param count: number of passes.
    :param progress: called with the part that is done, from 0 to 1.
    """

    def __init__(self, count: int, progress: Callable[[float], None]) -> None:
        self._count = count
        self._progress = progress
        self._complete = 0

    def over(self, indices: Sequence[int]) -> Generator[int, None, None]:
        """Yield the indices of one pass."""
        for done, index in enumerate(indices, 1):
            yield index
            self._progress((self._complete + done / len(indices)) / self._count)
        self._complete += 1


def distance_grid(limit: float) -> FloatArray:
    """
    Lay the grid of distances [m].

    :param limit: distance at which the object is at its goal [m].
    """
    grid = [0.0, INNER_FRACTION * limit, limit, EDGE_RATIO * limit]
    while grid[-1] < MAX_DISTANCE:
        grid.append(DISTANCE_RATIO * grid[-1])
    return np.array([*grid[:-1], max(MAX_DISTANCE, 1.1 * grid[-2])])


def heading_grid(limit: float) -> FloatArray:
    """
    Lay the grid of headings, symmetric about 0 [rad].

    :param limit: heading at which the object is at its goal [rad].
    """
    half = [0.5 * limit, limit, EDGE_RATIO * limit]
    while half[-1] < math.pi:
        half.append(min(HEADING_RATIO * half[-1], half[-1] + MAX_HEADING_STEP))
    half[-1] = math.pi
    if half[-1] - half[-2] < 0.3 * MAX_HEADING_STEP:
        del half[-2]
    return np.array([-angle for angle in reversed(half)] + [0.0] + half)


def face_change_times(table: PrimitiveTable, settings: CostSettings) -> FloatArray:
    """
    Estimate the time from the end of a push at one face to the start of one at another.

    :return: times, shape (F, F) [s].
    """
    points = np.array([point.position for point in table.face_points])
    faces = np.array([point.face for point in table.face_points])
    middles = np.array([points[faces == face].mean(axis=0) for face in range(table.face_count)])
    bearings = np.arctan2(middles[:, 1], middles[:, 0])
    turns = np.abs(np.angle(np.exp(1j * (bearings[:, None] - bearings[None]))))
    radius = float(np.hypot(*table.starts[:, :2].T).mean()) + ARC_CLEARANCE
    paths = CONTACT_PATHS[settings.drive] + ARC_FRACTION * radius * turns
    return settings.contact_time + paths / settings.robot_speed


def select_actions(table: PrimitiveTable, settings: CostSettings,
                   deviations: PlacementDeviations = LOCALIZED) -> Actions:
    """
    Thin the primitives out to those that value iteration chooses from.

    :param deviations: ``PlacementDeviations`` of the pushes.
    """
    indices = np.flatnonzero(
        (table.is_curved[table.point_indices] | (table.point_indices % POINT_STRIDE == 0))
        & np.isclose(np.abs(table.approach_angles)[:, None], np.abs(ACTION_ANGLES)).any(axis=1))
    steps = np.flatnonzero(table.lengths >= SHORTEST_ACTION * settings.position_tolerance)
    sample_count = table.displacements.shape[1]
    samples = [sample for sample in AVERAGED_SAMPLES if sample < sample_count] or [0]
    displacements = with_placement_errors(table, deviations)[indices][:, samples][:, :, steps]
    displacements = displacements.transpose(2, 0, 1, 3).reshape(-1, len(samples), 3)
    times = np.repeat(table.lengths[steps] / settings.pushing_speed + settings.push_time,
                      len(indices))
    return Actions(np.ascontiguousarray(displacements), displacements.mean(axis=1),
                   np.tile(table.faces[indices], len(steps)), times)


def _selection(values: NDArray[np.float32], action_count: int) -> Selection:
    pairs = np.minimum(values[:, 1:], values[:, :-1]).min(axis=2)
    return Selection(np.zeros(action_count, dtype=np.int64), np.zeros(action_count),
                     np.minimum(pairs[:, :, 1:], pairs[:, :, :-1]).astype(float),
                     np.zeros((len(values), SELECTED_ACTIONS)), np.zeros(len(values)),
                     np.zeros(SELECTED_ACTIONS, dtype=np.int16))


@compiled
def _goal_at(grid: CostGrid, i: int, j: int, k: int) -> Pose:
    """Return the goal in the object frame at a point of the grid."""
    bearing = 2.0 * math.pi * j / grid.values.shape[2]
    distance = grid.distances[i]
    return Pose(distance * math.cos(bearing), distance * math.sin(bearing), grid.headings[k])


@compiled
def _select_best(iteration: Iteration, memory: Selection, k: int) -> None:
    """Write the best actions of some states of a heading, by face, judged by their mean effect."""
    grid, actions, selected = iteration
    for action in range(actions.times.shape[0]):
        heading = wrap_angles(grid.headings[k] - actions.means[action, 2])
        position = locate(grid.headings, heading)
        memory.heading_indices[action] = position.cell
        memory.heading_fractions[action] = position.fraction
    for i in range(grid.values.shape[1]):
        for j in range(0, grid.values.shape[2], SELECTION_STRIDE):
            goal = _goal_at(grid, i, j, k)
            _reset_selection(iteration, goal, selected[i, max(0, j - SELECTION_STRIDE), k], memory)
            _select_for_state(iteration, goal, selected[i, j, k], memory)


@compiled
def _share_actions(iteration: Iteration, memory: Selection, i: int) -> None:
    """Choose the best actions of all states at a distance among theirs and those beside."""
    grid, _, selected = iteration
    faces, distances, bearings, headings = grid.values.shape
    for j in range(bearings):
        for k in range(headings):
            goal = _goal_at(grid, i, j, k)
            for face in range(faces):
                own, costs = selected[i, j, k, face], memory.costs[face]
                for n in range(own.shape[0]):
                    memory.candidates[n] = own[n]
                    own[n] = -1
                    costs[n] = math.inf
                _offer(iteration, goal, face, own, costs, memory.candidates)
                for step in (-1, 1):
                    _offer(iteration, goal, face, own, costs,
                           selected[i, (j + step + bearings) % bearings, k, face])
                    if 0 <= i + step < distances:
                        _offer(iteration, goal, face, own, costs, selected[i + step, j, k, face])
                    if 0 <= k + step < headings:
                        _offer(iteration, goal, face, own, costs, selected[i, j, k + step, face])


@compiled
def _offer(iteration: Iteration, goal: Pose, face: int, selected: Any, costs: Any,
           candidates: Any) -> None:
    """Insert those of the candidates that are better than what is selected."""
    grid, actions, _ = iteration
    last = selected.shape[0] - 1
    for n in range(candidates.shape[0]):
        action = candidates[n]
        if action < 0:
            break
        if actions.times[action] >= costs[last] or _contains(selected, action):
            continue
        cost = actions.times[action] + cost_after(grid, goal, actions.means[action], face)
        if cost < costs[last]:
            _insert(costs, selected, cost, action)


@compiled
def _contains(values: Any, value: int) -> bool:
    for n in range(values.shape[0]):
        if values[n] == value:
            return True
    return False


@compiled
def _reset_selection(iteration: Iteration, goal: Pose, selected: Any, memory: Selection) -> None:
    """Bound the costs of the selected actions by those of the actions of a state beside."""
    grid, actions, _ = iteration
    for face in range(selected.shape[0]):
        memory.limits[face] = 0.0
        for n in range(selected.shape[1]):
            memory.costs[face, n] = math.inf
            action = selected[face, n]
            cost = math.inf
            if action >= 0:
                cost = actions.times[action] + cost_after(grid, goal, actions.means[action], face)
            # A little more, so that none of these actions is left out by rounding.
            memory.limits[face] = max(memory.limits[face], cost + 1e-9)


@compiled
def _select_for_state(iteration: Iteration, goal: Pose, selected: Any,
                      memory: Selection) -> None:
    grid, actions, _ = iteration
    for face in range(selected.shape[0]):
        for n in range(selected.shape[1]):
            selected[face, n] = -1
    last = selected.shape[1] - 1
    for action in range(actions.times.shape[0]):
        face = actions.faces[action]
        time = actions.times[action]
        limit = min(memory.limits[face], memory.costs[face, last])
        if time >= limit:
            continue
        d_x, d_y = goal.x - actions.means[action, 0], goal.y - actions.means[action, 1]
        distance = locate(grid.distances, math.sqrt(d_x * d_x + d_y * d_y))
        heading = GridPosition(memory.heading_indices[action], memory.heading_fractions[action])
        if time + memory.lower_bounds[face, distance.cell, heading.cell] >= limit:
            continue
        bearing = math.atan2(d_y, d_x) - actions.means[action, 2]
        cost = time + interpolate_cell(grid.values, distance, bearing, heading, face)
        if cost < limit:
            _insert(memory.costs[face], selected[face], cost, action)


@compiled
def _insert(costs: Any, selected: Any, cost: float, action: Any) -> None:
    """Insert an action into a list in order of costs, whose last one falls out."""
    n = costs.shape[0] - 1
    while n > 0 and costs[n - 1] > cost:
        costs[n] = costs[n - 1]
        selected[n] = selected[n - 1]
        n -= 1
    costs[n] = cost
    selected[n] = action


@compiled
def _sweep(iteration: Iteration, arrived: Any, contact_times: Any, best: Any, i: int) -> None:
    """Improve the values of all states at a distance by their selected actions."""
    grid, values = iteration.grid, iteration.grid.values
    for j in range(values.shape[2]):
        for k in range(values.shape[3]):
            if arrived[i, j, k]:
                continue
            goal = _goal_at(grid, i, j, k)
            for face in range(values.shape[0]):
                best[face] = _best_cost(iteration, goal, iteration.selected[i, j, k, face])
            for face in range(values.shape[0]):
                value = math.inf
                for other in range(values.shape[0]):
                    value = min(value, contact_times[face, other] + best[other])
                values[face, i, j, k] = value


@compiled
def _best_cost(iteration: Iteration, goal: Pose, selected: Any) -> float:
    """Find the least expected cost among the selected actions of a state and a face [s]."""
    grid, actions, _ = iteration
    count = actions.displacements.shape[1]
    best = math.inf
    for n in range(selected.shape[0]):
        action = selected[n]
        if action < 0:
            break
        total = actions.times[action] * count
        for sample in range(count):
            total += cost_after(grid, goal, actions.displacements[action, sample],
                                actions.faces[action])
            if total >= best * count:
                break
        best = min(best, total / count)
    return best
