"""What is seen of nodes and commands to whose surroundings something happens."""

from typing import NamedTuple

# How Python begins to tell of an error that nobody has expected.
TRACEBACK = 'Traceback (most recent call last)'
# Part of it that is told.
QUOTED = 2000


class Observation(NamedTuple):
    """
    What is seen.

    :param seen: one sentence.
    :param faults: what is not as it should be, one text each.
    """

    seen: str
    faults: tuple[str, ...] = ()


def traceback_in(output: str) -> list[str]:
    """
    Quote a traceback.

    :param output: of a node or command.
    :return: the quotation; empty where there is none.
    """
    start = output.find(TRACEBACK)
    return [] if start < 0 else [output[start:start + QUOTED]]
