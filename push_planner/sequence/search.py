"""
Search for the fastest push sequences of two moves and more.

For every number of moves: sequences of primitives in the order of a lower bound of their time,
with rotations on a grid (``SequenceSearch.grid_search``), and then the best of them refined by a
pattern search over rotations (``SequenceSearch.refine``).
Arrays have the axes (m sequences, n moves).
"""

import itertools
from typing import Any, Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import FloatArray, Pose
from push_planner.sequence.costs import SequenceCosts
from push_planner.sequence.kinematics import (
    complete_rotations, IntArray, last_push, longest_pushes, SequenceMotions, solve_straights,
)
from push_planner.sequence.miss_probability import miss_probability
from push_planner.sequence.primitives import PrimitiveTable
from push_planner.sequence.steps import Move, PushSequence
from push_planner.settings import TaskSettings

# Sequences evaluated at once, chosen: arrays of a few hundred kB, which stay in the cache.
CHUNK_SIZE = 8000
# Sequences of each number of moves that are refined, chosen.
REFINED = 24
# Steps of the pattern search, chosen: the last changes a rotation by 1/2048 of a grid step.
REFINEMENT_STEPS = 11
# Gain of time that counts as one [s]: above rounding errors.
MIN_GAIN = 1e-9


class PatternSearch:
    """
    Pattern search: minimizes k functions of d variables at once, without derivatives.

    Each step tries all directions from each point, goes to the best one if it is better, and is
    half as long as the one before.

    :param evaluate: function of points, shape (k, p, d), to values, shape (k, p).
    :param directions: that are tried, shape (p, d); one of them may be 0.
    :param upper: greatest values of the variables, shape (k, d); the least are 0.
    """

    def __init__(self, evaluate: Callable[[FloatArray], FloatArray], directions: FloatArray,
                 upper: FloatArray) -> None:
        self._evaluate = evaluate
        self._directions = directions
        self._upper = upper

    def minimize(self, start: FloatArray, first_step: float, steps: int) -> FloatArray:
        """
        Improve points.

        :param start: points, shape (k, d).
        :param first_step: length of the first step along each variable.
        :param steps: number of steps.
        :return: points, shape (k, d), none worse than where it started.
        """
        points = start.copy()
        rows = np.arange(len(points))
        values = self._evaluate(points[:, None, :])[:, 0]
        step = first_step
        for _ in range(steps):
            trials = np.clip(points[:, None, :] + step * self._directions, 0.0,
                             self._upper[:, None, :])
            found = self._evaluate(trials)
            best = found.argmin(axis=1)
            better = found[rows, best] < values - MIN_GAIN
            points[better] = trials[rows, best][better]
            values = np.where(better, found[rows, best], values)
            step *= 0.5
        return points


class _GridPoint(NamedTuple):
    """
    The best point of the grid of one sequence of primitives; ordered by time.

    :param time: [s].
    :param moves: numbers of the primitives.
    :param rotations: signed rotations of all moves but the last [rad].
    """

    time: float
    moves: tuple[int, ...]
    rotations: tuple[float, ...]


class GridResult(NamedTuple):
    """
    Outcome of a grid search.

    :param time: of the fastest sequence, at most the limit [s].
    :param evaluations: number of sequences that were evaluated.
    """

    time: float
    evaluations: int


class SequenceSearch:
    """
    Search for sequences of one number of moves.

    :param table: ``PrimitiveTable``.
    :param costs: ``SequenceCosts``.
    :param goal: ``Pose`` in the frame of the object before the first push.
    :param task: ``TaskSettings``.
    :param count: number of moves.
    """

    def __init__(self, table: PrimitiveTable, costs: SequenceCosts, goal: Pose, task: TaskSettings,
                 count: int) -> None:
        self._table = table
        self._costs = costs
        self._goal = goal
        self._task = task
        self._count = count
        self._best: list[_GridPoint] = []

    def grid_search(self, limit: float) -> GridResult:
        """
        Evaluate sequences, the most promising first, until none can be faster.

        :param limit: time above which a sequence is of no use [s].
        :return: ``GridResult``.
        """
        sequences, bounds = self._promising_sequences(limit)
        grid_size = self._task.rotation_steps ** (self._count - 1)
        at_once = max(1, CHUNK_SIZE // grid_size)
        evaluations = 0
        for begin in range(0, len(sequences), at_once):
            chunk = sequences[begin:begin + at_once]
            chunk = chunk[bounds[begin:begin + at_once] < limit]
            if not len(chunk) or evaluations >= self._task.max_evaluations:
                break
            rotations = self._rotation_grid(chunk)
            moves = np.repeat(chunk, grid_size, axis=0)
            _, times = self._evaluate(moves, rotations.reshape(len(moves), -1))
            times = times.reshape(len(chunk), -1)
            evaluations += len(moves)
            rows = np.arange(len(chunk))
            best = times.argmin(axis=1)
            fastest = times[rows, best]
            self._best += [_GridPoint(time, tuple(row), tuple(rotation)) for time, row, rotation
                           in zip(fastest, chunk, rotations[rows, best]) if time < np.inf]
            limit = min(limit, fastest.min())
        return GridResult(limit, evaluations)

    def refine(self) -> list[PushSequence]:
        """
        Refine the rotations of the best sequences, all at once.

        :return: list of ``PushSequence``.
        """
        if not self._best:
            return []
        best = sorted(self._best)[:REFINED]
        moves = np.array([point.moves for point in best])
        sides = self._table.sides[moves[:, :-1]]
        max_rotations = self._table.max_rotations[moves[:, :-1]]

        # Variables: n - 1 unsigned rotations.
        def motions_at(points: FloatArray) -> tuple[SequenceMotions, FloatArray]:
            per_sequence = points.shape[1]
            rotations = sides[:, None, :] * points
            return self._evaluate(np.repeat(moves, per_sequence, axis=0),
                                  rotations.reshape(len(moves) * per_sequence, -1))

        def evaluate(points: FloatArray) -> FloatArray:
            return motions_at(points)[1].reshape(points.shape[:2])

        start = np.abs([point.rotations for point in best])
        directions = np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=self._count - 1)))
        found = PatternSearch(evaluate, directions, max_rotations).minimize(
            start, 0.5 * max_rotations.max() / (self._task.rotation_steps - 1), REFINEMENT_STEPS)
        motions, times = motions_at(found[:, None, :])
        return [_push_sequence(moves[row], motions, row, float(times[row]))
                for row in range(len(moves)) if times[row] < np.inf]

    def _promising_sequences(self, limit: float) -> tuple[IntArray, FloatArray]:
        """List the sequences of primitives with a lower bound of their time, lowest first."""
        number = len(self._costs.first)
        moves = np.indices((number,) * self._count).reshape(self._count, -1).T
        length = self._min_straights(moves).sum(axis=1) + self._min_arc_length(moves)
        bounds = self._costs.besides_pushing(moves) + length / self._costs.speed
        promising = np.flatnonzero(bounds < limit)
        order = promising[np.argsort(bounds[promising], kind='stable')]
        return moves[order], bounds[order]

    def _min_straights(self, moves: IntArray) -> FloatArray:
        """Least straight lengths after the rotations, shape (m, n); 0 where the push goes on."""
        locations = self._table.locations[moves]
        least = np.full(moves.shape, self._task.min_last_straight)
        goes_on = locations[:, :-1] == locations[:, 1:]
        least[:, :-1] = np.where(goes_on, 0.0, self._task.min_straight)
        return least

    def _min_arc_length(self, moves: IntArray) -> FloatArray:
        """Path length that the rotation to the goal takes at least, shape (m,)."""
        table = self._table
        left = self._goal.theta % (2.0 * np.pi)
        length_per_angle = table.radii * table.length_ratios
        lengths: list[FloatArray] = []
        for side, rotation in ((1.0, left), (-1.0, 2.0 * np.pi - left)):
            to_side = np.where(table.sides == side, length_per_angle, np.inf)
            lengths.append(to_side[moves].min(axis=1) * rotation if rotation > 0.0
                           else np.zeros(len(moves)))
        return np.minimum(*lengths)

    def _rotation_grid(self, moves: IntArray) -> FloatArray:
        """Lay signed rotations on a grid, shape (m, grid size, n - 1)."""
        fractions = np.array(list(itertools.product(
            np.linspace(0.0, 1.0, self._task.rotation_steps), repeat=self._count - 1)))
        largest = self._table.sides[moves[:, :-1]] * self._table.max_rotations[moves[:, :-1]]
        return largest[:, None, :] * fractions

    def _evaluate(self, moves: IntArray,
                  rotations: FloatArray) -> tuple[SequenceMotions, FloatArray]:
        """Return motions with the least straights, and times, shape (m,)."""
        complete = complete_rotations(self._table, moves, rotations, self._goal.theta)
        motions = solve_straights(self._table, moves, complete, self._goal,
                                  self._min_straights(moves))
        return motions, self._times(moves, motions)

    def _times(self, moves: IntArray, motions: SequenceMotions) -> FloatArray:
        """Return times with the expected corrections, shape (m,); infinite where infeasible."""
        costs = self._costs
        times = costs.besides_pushing(moves) + motions.path_lengths.sum(axis=1) / costs.speed
        locations, on_face = self._table.locations[moves], self._table.on_face[moves[:, -1]]
        rotation, path_length = last_push(locations, motions)
        probability = miss_probability(rotation, motions.straight_after[:, -1], path_length,
                                       on_face)
        feasible = (longest_pushes(locations, motions.path_lengths) <= costs.max_path_length) & (
            np.isfinite(times))
        return np.where(feasible, times + self._task.correction_time * probability, np.inf)


class SearchResult(NamedTuple):
    """
    Outcome of a search.

    :param sequences: ``PushSequence`` list, the fastest first, different in their locations.
    :param evaluations: number of sequences that were evaluated.
    """

    sequences: list[PushSequence]
    evaluations: int


def search_sequences(table: PrimitiveTable, costs: SequenceCosts, goal: Pose, task: TaskSettings,
                     limit: float) -> SearchResult:
    """
    Find the fastest sequences of two moves and more.

    :param table: ``PrimitiveTable``.
    :param costs: ``SequenceCosts``.
    :param goal: ``Pose`` in the frame of the object before the first push.
    :param task: ``TaskSettings``.
    :param limit: time above which a sequence is of no use [s].
    :return: ``SearchResult``.
    """
    found: list[PushSequence] = []
    evaluations = 0
    for count in range(2, task.max_pushes + 1):
        search = SequenceSearch(table, costs, goal, task, count)
        limit, number = search.grid_search(limit)
        evaluations += number
        found += search.refine()
        limit = min([limit] + [sequence.duration for sequence in found])
    known: set[tuple[int, ...]] = set()
    distinct: list[PushSequence] = []
    for sequence in sorted(found, key=lambda sequence: sequence.duration):
        locations = _locations(sequence, table)
        if locations not in known and len(distinct) < task.alternatives:
            known.add(locations)
            distinct.append(sequence)
    return SearchResult(distinct, evaluations)


def _locations(sequence: PushSequence, table: PrimitiveTable) -> tuple[int, ...]:
    """Contact locations of the pushes of a sequence, one each."""
    locations: Any = (table.locations[move.primitive] for move in sequence.moves)
    return tuple(number for number, _ in itertools.groupby(locations))


def _push_sequence(moves: NDArray[np.int_], motions: SequenceMotions, row: int,
                   duration: float) -> PushSequence:
    columns = zip(moves.tolist(), motions.rotations[row].tolist(),
                  motions.straight_before[row].tolist(), motions.straight_after[row].tolist())
    return PushSequence(tuple(Move(*column) for column in columns), duration)
