"""Search for the quickest chains of pushes, of any length up to the most."""

import itertools
from typing import NamedTuple

from push_planner.hunt import Hunt


class Found(NamedTuple):
    """
    Outcome of a search.

    :param chains: ``Chain`` list, the quickest first, different in their places.
    :param weighed: number of chains that were weighed.
    """

    chains: list
    weighed: int


def search(table, costs, goal, task, limit, excess=None):
    """
    Find the quickest chains of two moves and more.

    :param table: ``push_planner.elements.Table``.
    :param costs: ``Costs``.
    :param goal: ``Pose`` in the frame of the object as it stands.
    :param task: ``TaskSettings``.
    :param limit: time above which a chain is of no use [s].
    :param excess: as of ``Hunt``.
    :return: ``Found``.
    """
    rows, weighed = [], 0
    for count in range(2, task.max_pushes + 1):
        hunt = Hunt(table, costs, goal, task, count, excess)
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
    return Found(chains, weighed)
