"""
Selection of the next push: one step of look-ahead over all primitives and lengths.

A push by primitive p of length l from where the robot stands takes the time

    T(p, l) = max(t_min, t_travel(p)) + l / v + t_0 + sum over k of w_k V(f_p, g_k(p, l)),

with the weights w_k of the samples of friction and V of ``cost_to_go``. V holds what remains to do
after the push, so that sequences of pushes are never formed. The path of the robot to the place is
estimated for all primitives, and planned for the best.
"""

import math
from typing import Any, Callable, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray, IntArray, Pose, wrap_angles
from push_primitives.cost_to_go import cost_after, CostGrid
from push_primitives.store import PushPrimitives
from push_primitives.value_iteration import ARC_CLEARANCE
from push_primitives.weights import FrictionBelief, sample_weights

# Least time for a contact [s]: where the robot seems to stand at a point already, taps would look
# free, and their errors not.
MIN_CONTACT_TIME = 1.5
# Pushes are at least this part of the error long, less some [m]: V is interpolated and a little
# optimistic, and a hope that costs nothing is repeated for ever. A heading error counts as the
# distance at this arm [m]. Chosen: a miss of 2 cm is worth a tap of 2 mm, one of 8 cm none.
LENGTH_FRACTION = 0.2
LENGTH_MARGIN = 0.002
HEADING_ARM = 0.1
# Longest push without steering or correction [m]; the table ends there.
MAX_LENGTH = 1.0
# Deviation of the robot's position from which on it counts as unsure [m], chosen: half the
# distance between points.
UNSURE_DEVIATION = 0.013
# Primitives with length that get the full expectation, the best by their mean effect; and starts
# whose paths are planned. Chosen: more of either hardly ever change the result.
EXPECTED_COUNT = 2000
PLANNED_STARTS = 10
# Starts that are tried where none can be reached; chosen: what stops the robot on its way to these
# stops it on its way to all, and each may take a tenth of a second.
UNREACHED_STARTS = 16
# Lengths tried between the neighbours of the best one; chosen: at most 3 cm apart.
REFINED_LENGTHS = 13
# Estimate of a path [s], by drive: fixed time, and its reduction near the object. Fitted to
# planned paths of a robot at 0.3 m/s and 1.9 rad/s.
FIXED_TIME = {'differential': 3.0, 'holonomic': 1.5}
NEAR = 0.25
NEAR_REDUCTION = 0.3
NEAR_TURN_TIME = 0.3
# The object hides points behind it; chosen: part of its radius that hides, as corners are passed
# closely, and an angle at its edge that does not [rad].
HIDING_FRACTION = 0.8
HIDING_MARGIN = 0.3

# Time for the path to a start (first contact and direction of motion in the object frame) [s];
# infinite where there is none.
TravelTime = Callable[[Pose], float]


class SelectionQuery(NamedTuple):
    """
    Situation for which a push is selected.

    :param goal: ``Pose`` of the goal in the object frame.
    :param robot_pose: ``Pose`` of the robot in the object frame.
    :param belief: ``FrictionBelief``.
    :param robot_deviation: standard deviation of the robot's position [m].
    :param pushing_speed: of the push [m/s].
    """

    goal: Pose
    robot_pose: Pose
    belief: FrictionBelief
    robot_deviation: float
    pushing_speed: float


class _Effects(NamedTuple):
    """
    Effects of pushes on the object, as compiled code reads them.

    :param displacements: shape (n, K, L, 3).
    :param weights: of the samples of friction, shape (K,).
    :param faces: of the primitives, shape (n,).
    """

    displacements: FloatArray
    weights: FloatArray
    faces: Any


class SelectedPush(NamedTuple):
    """
    A push and what it is expected to take.

    :param primitive: its row in the table.
    :param length: driven length from the first contact [m].
    :param weights: of the samples of friction, shape (K,).
    :param travel_time: of the robot's path to its start [s].
    :param remaining_time: expected time after it until the object is at its goal [s].
    :param expected_time: of everything, path and push included [s].
    """

    primitive: int
    length: float
    weights: FloatArray
    travel_time: float
    remaining_time: float
    expected_time: float


def select_push(primitives: PushPrimitives, query: SelectionQuery,
                travel_time: TravelTime) -> SelectedPush | None:
    """
    Select the push after which everything is expected to be done first.

    :param travel_time: plans the path to a start.
    :return: ``SelectedPush``; None where no start can be reached.
    """
    weights = sample_weights(primitives.table.friction_samples, query.belief)
    displacements = (primitives.unsure_displacements
                     if query.robot_deviation > UNSURE_DEVIATION
                     else primitives.localized_displacements)
    costs = push_costs(primitives, query, displacements, weights)
    best_steps = np.argmin(costs, axis=1)
    best_costs = costs.min(axis=1)
    selected = _nearest_in_time(primitives, query, best_costs, travel_time)
    if selected is None:
        return None
    primitive, time = selected
    length, cost = _refine_length(primitives, query, displacements[primitive], weights,
                                  (primitive, int(best_steps[primitive])))
    push_time = length / query.pushing_speed + primitives.settings.push_time
    return SelectedPush(primitive, length, weights, time, cost - push_time,
                        max(MIN_CONTACT_TIME, time) + cost)


def push_costs(primitives: PushPrimitives, query: SelectionQuery, displacements: FloatArray,
               weights: FloatArray) -> FloatArray:
    """
    Expect the times of pushes and of what remains after them, for the promising ones.

    :param displacements: shape (n, K, L, 3).
    :param weights: of the samples of friction, shape (K,).
    :return: times, shape (n, L) [s]; infinite where a push is too short or not promising.
    """
    table, grid = primitives.table, primitives.cost_to_go.grid
    goal, effects = Pose(*map(float, query.goal)), _Effects(displacements, weights, table.faces)
    costs = np.full(displacements.shape[::2], math.inf)
    steps = np.flatnonzero(_is_long_enough(table.lengths, query.goal))
    push_times = table.lengths / query.pushing_speed + primitives.settings.push_time
    estimates = np.empty((len(table.faces), len(steps)))
    _costs_of_means(grid, effects, steps, goal, np.empty(3), estimates)
    estimates += push_times[steps]
    estimates += estimate_travel_times(primitives, query.robot_pose)[:, None]
    count = min(EXPECTED_COUNT, estimates.size)
    promising = np.sort(np.argpartition(estimates, count - 1, axis=None)[:count])
    indices, columns = np.divmod(promising, len(steps))
    columns = steps[columns]
    expected = np.empty(count)
    _expected_costs(grid, effects, indices, columns, goal, expected)
    costs[indices, columns] = expected + push_times[columns]
    return costs


def estimate_travel_times(primitives: PushPrimitives, robot_pose: Pose) -> FloatArray:
    """
    Estimate the times of the paths to the starts of all primitives, round a ring.

    :param robot_pose: ``Pose`` of the robot in the object frame.
    :return: times, shape (n,) [s].
    """
    starts, settings = primitives.table.starts, primitives.settings
    away = math.hypot(robot_pose.x, robot_pose.y)
    straight = np.hypot(starts[:, 0] - robot_pose.x, starts[:, 1] - robot_pose.y)
    bearing = math.atan2(robot_pose.y, robot_pose.x)
    turns = np.abs(wrap_angles(np.arctan2(starts[:, 1], starts[:, 0]) - bearing))
    ring = float(np.hypot(starts[:, 0], starts[:, 1]).mean()) + ARC_CLEARANCE
    hidden = HIDING_FRACTION * ring
    is_visible = turns < math.acos(min(1.0, hidden / max(away, hidden))) + HIDING_MARGIN
    paths = np.where(is_visible, straight, abs(away - ring) + ring * turns)
    is_near = straight < NEAR
    times = paths / settings.robot_speed + FIXED_TIME[settings.drive] - NEAR_REDUCTION * is_near
    if settings.drive == 'differential':
        times += NEAR_TURN_TIME * np.abs(wrap_angles(starts[:, 2] - robot_pose.theta)) * is_near
    return times


def interpolate_displacements(lengths: FloatArray, displacements: FloatArray,
                              length: FloatArray | float) -> FloatArray:
    """
    Interpolate displacements between the lengths of the table.

    :param lengths: of the table, shape (L,) [m].
    :param displacements: shape (..., L, 3).
    :param length: one or several, shape (m,) [m].
    :return: displacements, shape (..., 3) or (..., m, 3).
    """
    index = np.clip(np.searchsorted(lengths, length) - 1, 0, len(lengths) - 2)
    fraction = np.asarray((length - lengths[index]) / (lengths[index + 1] - lengths[index]))
    fraction = fraction[..., None]
    return (displacements[..., index, :] * (1.0 - fraction)
            + displacements[..., index + 1, :] * fraction)


def _nearest_in_time(primitives: PushPrimitives, query: SelectionQuery, costs: FloatArray,
                     travel_time: TravelTime) -> tuple[int, float] | None:
    """Plan paths to the best starts; the primitive with the least time, and that of its path."""
    starts = primitives.table.starts
    estimates = costs + np.maximum(MIN_CONTACT_TIME,
                                   estimate_travel_times(primitives, query.robot_pose))
    times: dict[tuple[float, ...], float] = {}
    selected: tuple[int, float] | None = None
    least = math.inf
    for index in np.argsort(estimates, kind='stable').tolist():
        if not math.isfinite(costs[index]):
            break
        start = tuple(starts[index].tolist())
        if start not in times:
            # Where none of the best can be reached, others may be.
            if len(times) >= PLANNED_STARTS and selected is not None:
                continue
            if len(times) >= UNREACHED_STARTS:
                break
            times[start] = travel_time(Pose(*start))
        total = float(costs[index]) + max(MIN_CONTACT_TIME, times[start])
        if total < least:
            least, selected = total, (index, times[start])
    return selected


def _refine_length(primitives: PushPrimitives, query: SelectionQuery, displacements: FloatArray,
                   weights: FloatArray, choice: tuple[int, int]) -> tuple[float, float]:
    """Find the best length between the neighbours of a length of the table, and its cost."""
    table, (index, step) = primitives.table, choice
    longest = float(table.lengths[min(len(table.lengths) - 1, step + 1)])
    lengths = np.asarray(np.linspace(float(table.lengths[step - 1]), longest, REFINED_LENGTHS),
                         dtype=np.float64)
    lengths = lengths[_is_long_enough(lengths, query.goal)]
    between = interpolate_displacements(table.lengths, displacements, lengths)
    costs = np.empty(len(lengths))
    effects = _Effects(np.ascontiguousarray(between)[None], weights, table.faces[index:index + 1])
    steps = np.arange(len(lengths))
    _expected_costs(primitives.cost_to_go.grid, effects, np.zeros_like(steps), steps,
                    Pose(*map(float, query.goal)), costs)
    costs += lengths / query.pushing_speed + primitives.settings.push_time
    best = int(np.argmin(costs))
    return float(lengths[best]), float(costs[best])


def _is_long_enough(lengths: FloatArray, goal: Pose) -> Any:
    error = math.hypot(goal.x, goal.y) + HEADING_ARM * abs(math.remainder(goal.theta, math.tau))
    least = LENGTH_FRACTION * error - LENGTH_MARGIN
    return (lengths > 0.0) & (lengths >= min(least, MAX_LENGTH)) & (lengths <= MAX_LENGTH)


@compiled
def _expected_costs(grid: CostGrid, effects: _Effects, indices: IntArray, steps: IntArray,
                    goal: Pose, expected: FloatArray) -> None:
    """
    Write the expected cost-to-go after pushes.

    :param indices: primitive of each push, shape (m,).
    :param steps: index of its length, shape (m,).
    :param goal: in the object frame.
    :param expected: shape (m,) [s], is written.
    """
    for m in range(indices.shape[0]):
        index, step = indices[m], steps[m]
        total = 0.0
        for k in range(effects.weights.shape[0]):
            total += effects.weights[k] * cost_after(
                grid, goal, effects.displacements[index, k, step], effects.faces[index])
        expected[m] = total


@compiled
def _costs_of_means(grid: CostGrid, effects: _Effects, steps: IntArray, goal: Pose,
                    mean: FloatArray, costs: FloatArray) -> None:
    """
    Write the cost-to-go after the mean effect of every push.

    :param steps: indices of the lengths, shape (m,).
    :param goal: in the object frame.
    :param mean: scratch, shape (3,).
    :param costs: shape (n, m) [s], is written.
    """
    displacements, weights = effects.displacements, effects.weights
    for n in range(effects.faces.shape[0]):
        for m in range(steps.shape[0]):
            for j in range(3):
                mean[j] = 0.0
                for k in range(weights.shape[0]):
                    mean[j] += weights[k] * displacements[n, k, steps[m], j]
            costs[n, m] = cost_after(grid, goal, mean, effects.faces[n])
