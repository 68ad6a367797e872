"""Moves of a chain that follow each other at one place are one push."""

from typing import NamedTuple

import numpy as np

ROUNDING = 1e-9
NARROW = 1e-3


class SequenceMotions(NamedTuple):
    """
    What chains come to; rows are chains, columns their moves.

    :param turns: signed turns of the object [rad], shape (m, n).
    :param before: straight lengths before the turns [m], shape (m, n).
    :param after: the same after the turns, shape (m, n).
    :param ways: way of the contact [m], shape (m, n); infinite where the goal is not reached.
    """

    turns: np.ndarray
    before: np.ndarray
    after: np.ndarray
    ways: np.ndarray


def complete_rotations(table, sites, turns, heading):
    """
    Complete turns by those of the last move, which fix the object's heading.

    :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
    :param sites: numbers of the elements, shape (m, n).
    :param turns: signed turns of all but the last [rad], shape (m, n - 1).
    :param heading: turn of the goal [rad].
    :return: signed turns, shape (m, n); NaN in the last column where it turns too far.
    """
    last = sites[:, -1]
    left = table.sides[last] * (heading - turns.sum(axis=1))
    left = np.maximum((left + ROUNDING) % (2.0 * np.pi) - ROUNDING, 0.0)
    left[left > table.widest[last] + ROUNDING] = np.nan
    return np.column_stack([turns, table.sides[last] * left])


def solve_straights(table, sites, turns, goal, least):
    """
    Find the shortest straight pushes with which chains reach the goal.

    :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
    :param sites: numbers of the elements, shape (m, n).
    :param turns: signed turns [rad], shape (m, n), as ``complete_rotations`` completes them.
    :param goal: ``Pose`` in the frame of the object before the first push.
    :param least: straight length after the turn of each move, at least [m], shape (m, n).
    :return: ``SequenceMotions``.
    """
    heading = np.cumsum(turns, axis=1) - turns
    first = heading + table.angles[sites]
    second = first + turns
    x, y = _turned(table, sites, heading, turns, first, second)
    x = goal.x - (x + least * np.cos(second)).sum(axis=1)
    y = goal.y - (y + least * np.sin(second)).sum(axis=1)
    lengths, which, reached = _split(np.hstack([first, second]), x, y)
    rows, count = np.arange(len(sites)), sites.shape[1]
    straights = np.zeros((len(sites), 2 * count))
    straights[:, count:] = least
    for length, column in zip(lengths, which):
        straights[rows, column] += length
    before, after = straights[:, :count], straights[:, count:]
    ways = np.abs(turns) * table.radii[sites] * table.stretches[sites] + before + after
    return SequenceMotions(turns, before, after, np.where(reached[:, None], ways, np.inf))


def object_poses_along(table, sites, chains, count):
    """
    Find where the object is on its way, at equal shares of every piece, up to their ends.

    :param table: ``push_planner.sequence.primitives.PrimitiveTable``.
    :param sites: numbers of the elements, shape (m, n).
    :param chains: ``SequenceMotions`` of m chains.
    :param count: places on each piece; the pieces of a move are straight, a turn, and straight.
    :return: (x, y, theta) in the frame of the object before the first push, shape
        (m, n, 3 count, 3).
    """
    turns, before, after, _ = chains
    heading = np.cumsum(turns, axis=1) - turns
    first = heading + table.angles[sites]
    second = first + turns
    arcs = _turned(table, sites, heading, turns, first, second)
    moves = np.stack([np.stack((before * np.cos(first), arcs[0], after * np.cos(second)), axis=2),
                      np.stack((before * np.sin(first), arcs[1], after * np.sin(second)), axis=2)])
    segments = moves.reshape(2, len(sites), 3 * sites.shape[1])
    begins = (segments.cumsum(axis=2) - segments).reshape(moves.shape)
    found = np.empty((*sites.shape, 3, count, 3))
    for k in range(count):
        share = (k + 1) / count
        parts = share * moves
        parts[..., 1] = _turned(table, sites, heading, share * turns, first, first + share * turns)
        found[..., k, :2] = np.moveaxis(begins + parts, 0, -1)
        found[..., k, 2] = np.stack((heading, heading + share * turns, heading + turns), axis=2)
    return found.reshape(*sites.shape, 3 * count, 3)


def _turned(table, sites, heading, turns, first, second):
    """Displacement of the object's origin in the turns alone."""
    radius = table.radii[sites] * table.sides[sites]
    f_x, f_y = table.flats[sites, 0], table.flats[sites, 1]
    end = heading + turns
    c, s = np.cos(heading) - np.cos(end), np.sin(heading) - np.sin(end)
    return (radius * (np.sin(second) - np.sin(first)) + c * f_x - s * f_y,
            radius * (np.cos(first) - np.cos(second)) + s * f_x + c * f_y)


def _split(directions, x, y):
    """Lengths along the directions next to a vector on its left and on its right."""
    away = np.hypot(x, y)
    aside = directions - np.arctan2(y, x)[:, None]
    aside = (aside + np.pi) % (2.0 * np.pi) - np.pi
    left = np.where(aside >= 0.0, aside, np.inf)
    right = np.where(aside <= 0.0, -aside, np.inf)
    which = left.argmin(axis=1), right.argmin(axis=1)
    rows = np.arange(len(x))
    left, right = left[rows, which[0]], right[rows, which[1]]
    span = left + right
    reached = (span < np.pi - NARROW) | (away < ROUNDING)
    # Straight ahead both are 0, and either direction will do.
    ahead = span < ROUNDING
    sine = np.where(reached & ~ahead, np.sin(np.where(np.isfinite(span), span, 1.0)), 1.0)
    lengths = (np.where(ahead, away, away * np.sin(np.where(reached, right, 0.0)) / sine),
               np.where(ahead, 0.0, away * np.sin(np.where(reached, left, 0.0)) / sine))
    return tuple(np.where(reached, length, 0.0) for length in lengths), which, reached


def longest_pushes(numbers, ways):
    """
    Find the way of the longest push of each chain [m], shape (m,).

    :param numbers: of the places of the moves, shape (m, n).
    :param ways: of the contact in the moves [m], shape (m, n).
    """
    way = longest = ways[:, 0]
    for i in range(1, numbers.shape[1]):
        way = ways[:, i] + np.where(numbers[:, i] == numbers[:, i - 1], way, 0.0)
        longest = np.maximum(longest, way)
    return longest


def last_push(numbers, chains):
    """
    Tell of the last push of each chain how it turns the object, and its way.

    :param numbers: of the places of the moves, shape (m, n).
    :param chains: ``push_planner.sequence.kinematics.SequenceMotions`` of m chains.
    :return: (angle to and fro [rad], way of the contact [m]), each of shape (m,).
    """
    there = numbers == numbers[:, -1:]
    last = np.logical_and.accumulate(there[:, ::-1], axis=1)[:, ::-1]
    turned = np.abs(np.where(last, chains.turns, 0.0)).sum(axis=1)
    return turned, np.where(last, chains.ways, 0.0).sum(axis=1)
