"""What a mistyped name may have meant."""

from collections.abc import Iterable
import difflib


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """
    Guess what a name meant that does not exist.

    :param name: what was typed.
    :param names: what there is.
    :return: the end of a sentence; empty where nothing is near.
    """
    near = difflib.get_close_matches(name, list(names), n=1)
    return f'; did you mean {near[0]!r}?' if near else ''
