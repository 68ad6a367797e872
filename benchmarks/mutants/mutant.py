"""A mutant: one planted mistake, and the tests that have to notice it."""

from pathlib import Path
from typing import NamedTuple


class Mutant(NamedTuple):
    """
    A planted mistake.

    :param name: what the program does then, one clause.
    :param file: that has it, from the top of the repository.
    :param old: text that stands once in the file.
    :param new: text in its place.
    :param tests: files and folders of tests, one of which has to notice it; tried in order.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


def mutated(mutant: Mutant, text: str) -> str:
    """
    Plant the mistake.

    :param mutant: the ``Mutant``.
    :param text: of its file.
    :return: the text with the mistake.
    :raises ValueError: where the old text does not stand in it once: the list is out of date.
    """
    count = text.count(mutant.old)
    if count != 1:
        raise ValueError(f'{mutant.file}: got {count} places with {mutant.old!r}, expected one')
    return text.replace(mutant.old, mutant.new)


def check(mutant: Mutant, tree: Path) -> None:
    """
    Check that a mutant can be planted.

    :param mutant: the ``Mutant``.
    :param tree: top of the repository.
    :raises ValueError: where its text or its tests are not there.
    """
    mutated(mutant, (tree / mutant.file).read_text(encoding='utf-8'))
    for test in mutant.tests:
        if not (tree / test).exists():
            raise ValueError(f'{mutant.name}: got the tests {test}, expected a file or folder')
