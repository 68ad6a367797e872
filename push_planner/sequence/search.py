"""Search for the quickest chains of pushes, of any length up to the most."""

import itertools
from typing import NamedTuple

import numpy as np
from push_planner.sequence.kinematics import (
    complete_rotations, last_push, longest_pushes, solve_straights,
)
from push_planner.sequence.miss_probability import miss_probability

CHUNK = 8000
POLISHED, IN_MAP = 24, 32
HALVINGS = 11
SAME = 1e-9


class SequenceCosts(NamedTuple):
    """
    What chains cost.

    :param first: time until a push with each element begins [s], shape (n,).
    :param change: time from one element to another [s], shape (n, n); 0 at the same place.
    :param speed: of the contact [m/s].
    :param longest: way of the contact in one push, at most [m].
    """

    first: np.ndarray
    change: np.ndarray
    speed: float
    longest: float

    def besides(self, sites):
        """
        Time of chains but for the pushing [s], shape (m,).

        :param sites: numbers of the elements, shape (m, n).
        """
        return self.first[sites[:, 0]] + self.change[sites[:, :-1], sites[:, 1:]].sum(axis=1)


class PushSequence(NamedTuple):
    """
    A chain of moves; those that follow each other at one place are one push.

    :param sites: numbers of the elements.
    :param turns: of the object in each move, signed [rad].
    :param before: straight lengths before the turns [m].
    :param after: the same after the turns [m].
    :param duration: of all together, and of mending a miss of the last push times its chance,
        about [s].
    """

    sites: tuple
    turns: tuple
    before: tuple
    after: tuple
    duration: float


class SequenceSearch:
    """
    The search for chains of one length.

    :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
    :param costs: ``SequenceCosts``.
    :param goal: ``Pose`` in the frame of the object as it stands.
    :param task: ``TaskSettings``.
    :param count: number of moves.
    :param excess: function of chains (sites, ``SequenceMotions``, whether finely) to times by which they
        count as longer, shape (m,) [s]; None: by nothing.
    """

    def __init__(self, table, costs, goal, task, count, excess):
        self.table, self.costs, self.goal, self.task = table, costs, goal, task
        self.count, self.excess = count, excess
        self.best = []

    def coarse(self, limit):
        """
        Go through sequences, the most promising first, until none can be quicker.

        :param limit: time above which a chain is of no use [s].
        :return: (time of the quickest, at most the limit [s]; number of chains weighed).
        """
        sites, bounds = self._sequences(limit)
        steps = self.task.rotation_steps
        per_sequence = steps ** (self.count - 1)
        at_once, weighed = max(1, CHUNK // per_sequence), 0
        for begin in range(0, len(sites), at_once):
            chunk = sites[begin:begin + at_once]
            chunk = chunk[bounds[begin:begin + at_once] < limit]
            if not len(chunk) or weighed >= self.task.max_evaluations:
                break
            turns = self._grid(chunk, steps)
            many = np.repeat(chunk, per_sequence, axis=0)
            times = self._weigh(many, turns.reshape(len(many), -1))[1].reshape(len(chunk), -1)
            weighed += len(many)
            index = times.argmin(axis=1)
            rows = np.arange(len(chunk))
            quickest, which = times[rows, index], turns[rows, index]
            self.best += [(time, tuple(row), tuple(turn))
                          for time, row, turn in zip(quickest, chunk, which) if time < np.inf]
            limit = min(limit, quickest.min())
        return limit, weighed

    def polished(self):
        """
        Refine the turns of the best, all at once.

        :return: list of ``PushSequence``.
        """
        if not self.best:
            return []
        best = sorted(self.best)[:POLISHED if self.excess is None else IN_MAP]
        sites = np.array([row for _, row, _ in best])
        turns, more = np.array([turn for _, _, turn in best]), np.zeros(sites.shape)
        times = self._weigh(sites, turns, more)[1]
        moves, least = self._moves()
        many, rows = np.repeat(sites, len(moves), axis=0), np.arange(len(sites))
        sides, widest = self.table.sides[sites[:, :-1]], self.table.widest[sites[:, :-1]]
        step = np.full((len(sites), 1, 1), 0.5 * widest.max() / (self.task.rotation_steps - 1))
        for _ in range(HALVINGS if self.excess is None else 2 * HALVINGS):
            tried = np.clip(np.abs(turns)[:, None, :] + step * moves, 0.0, widest[:, None, :])
            tried = sides[:, None, :] * tried
            longer = np.maximum(more[:, None, :] + step * least, 0.0)
            found = self._weigh(many, tried.reshape(len(many), -1),
                                longer.reshape(len(many), -1))[1].reshape(len(rows), -1)
            index = found.argmin(axis=1)
            better = found[rows, index] < times - SAME
            turns[better], more[better] = (each[rows, index][better] for each in (tried, longer))
            times = np.where(better, found[rows, index], times)
            step[np.logical_not(better) | (self.excess is None)] *= 0.5
        chains, times = self._weigh(sites, turns, more)
        return [PushSequence(*(tuple(map(kind, values)) for kind, values in (
            (int, row), (float, turn), (float, before), (float, after))), float(time))
            for row, turn, before, after, time in zip(sites, *chains[:3], times)
            if time < np.inf]

    def _moves(self):
        """List changes tried at once: of the turns, and in a map of the straight lengths."""
        moves = np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=self.count - 1)))
        if self.excess is None:
            return moves, np.zeros((len(moves), self.count))
        each = np.eye(self.count)
        least = np.vstack([np.zeros((len(moves), self.count)), each, -each])
        return np.vstack([moves, np.zeros((2 * self.count, self.count - 1))]), least

    def _sequences(self, limit):
        """Sequences of elements with a lower bound of their time, lowest first."""
        number = len(self.costs.first)
        sites = np.indices((number,) * self.count).reshape(self.count, -1).T
        way = self._least(sites).sum(axis=1) + self._least_turn(sites)
        times = self.costs.besides(sites) + way / self.costs.speed
        hopeful = np.flatnonzero(times < limit)
        order = hopeful[np.argsort(times[hopeful], kind='stable')]
        return sites[order], times[order]

    def _least(self, sites):
        """Straight lengths after the turns, at least; none where the push goes on."""
        numbers = self.table.numbers[sites]
        least = np.full(sites.shape, self.task.min_last_straight)
        least[:, :-1] = np.where(numbers[:, :-1] == numbers[:, 1:], 0.0, self.task.min_straight)
        return least

    def _least_turn(self, sites):
        """Way that the turn of the goal takes at least."""
        table, left = self.table, self.goal.theta % (2.0 * np.pi)
        tightest = table.radii * table.stretches
        ways = []
        for side, turn in ((1.0, left), (-1.0, 2.0 * np.pi - left)):
            radii = np.where(table.sides == side, tightest, np.inf)
            ways.append(radii[sites].min(axis=1) * turn if turn > 0.0 else np.zeros(len(sites)))
        return np.minimum(*ways)

    def _grid(self, sites, steps):
        """Lay turns on a grid, shape (sequences, trials, pushes - 1)."""
        shares = np.array(list(itertools.product(np.linspace(0.0, 1.0, steps),
                                                 repeat=sites.shape[1] - 1)))
        most = self.table.sides[sites[:, :-1]] * self.table.widest[sites[:, :-1]]
        return most[:, None, :] * shares

    def _weigh(self, sites, turns, more=None):
        """Weigh chains and tell their times; finely where straights are given that are longer."""
        if turns.shape[1] < sites.shape[1]:
            turns = complete_rotations(self.table, sites, turns, self.goal.theta)
        least = self._least(sites) + (0.0 if more is None else more)
        chains = solve_straights(self.table, sites, turns, self.goal, least)
        times = self.costs.besides(sites) + chains.ways.sum(axis=1) / self.costs.speed
        numbers, faces = self.table.numbers[sites], self.table.faces[sites[:, -1]]
        turned, way = last_push(numbers, chains)
        missing = miss_probability(turned, chains.after[:, -1], way, faces)
        within = longest_pushes(numbers, chains.ways) <= self.costs.longest
        times = np.where(within & np.isfinite(times), times + self.task.correction_time * missing,
                         np.inf)
        if self.excess is not None:
            times = times + self.excess(sites, chains, more is not None)
        return chains, times


class SearchResult(NamedTuple):
    """
    Outcome of a search.

    :param chains: ``PushSequence`` list, the quickest first, different in their places.
    :param weighed: number of chains that were weighed.
    """

    chains: list
    weighed: int


def search(table, costs, goal, task, limit, excess=None):
    """
    Find the quickest chains of two moves and more.

    :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
    :param costs: ``SequenceCosts``.
    :param goal: ``Pose`` in the frame of the object as it stands.
    :param task: ``TaskSettings``.
    :param limit: time above which a chain is of no use [s].
    :param excess: as of ``SequenceSearch``.
    :return: ``SearchResult``.
    """
    rows, weighed = [], 0
    for count in range(2, task.max_pushes + 1):
        hunt = SequenceSearch(table, costs, goal, task, count, excess)
        limit, number = hunt.coarse(limit)
        weighed += number
        rows += hunt.polished()
        limit = min([limit] + [chain.duration for chain in rows])
    places, chains = set(), []
    for chain in sorted(rows, key=lambda chain: chain.duration):
        key = tuple(number for number, _ in itertools.groupby(table.numbers[site]
                                                              for site in chain.sites))
        if key not in places and len(chains) < task.alternatives:
            places.add(key)
            chains.append(chain)
    return SearchResult(chains, weighed)
