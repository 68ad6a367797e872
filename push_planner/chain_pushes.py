"""Moves of a chain that follow each other at one place are one push."""

import numpy as np


def longest_ways(numbers, ways):
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


def last_pushes(numbers, chains):
    """
    Tell of the last push of each chain how it turns the object, and its way.

    :param numbers: of the places of the moves, shape (m, n).
    :param chains: ``push_planner.chain_algebra.Weighed`` of m chains.
    :return: (angle to and fro [rad], way of the contact [m]), each of shape (m,).
    """
    there = numbers == numbers[:, -1:]
    last = np.logical_and.accumulate(there[:, ::-1], axis=1)[:, ::-1]
    turned = np.abs(np.where(last, chains.turns, 0.0)).sum(axis=1)
    return turned, np.where(last, chains.ways, 0.0).sum(axis=1)
