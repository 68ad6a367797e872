"""Progress bar on the terminal, for commands that take a while."""

import sys
from typing import Iterator, Optional, Sequence, TextIO, TypeVar

Item = TypeVar('Item')
# Characters of a full bar; chosen: bar, title and count fit into 80 columns.
BAR_WIDTH = 30


def progress(items: Sequence[Item], title: str, stream: Optional[TextIO] = None) -> Iterator[Item]:
    """
    Yield the items, and show how many are done.

    :param items: sequence to go through.
    :param title: name of what is running.
    :param stream: where to write; ``sys.stderr`` if None. Anything but a terminal gets one line.
    """
    bar: TextIO = stream or sys.stderr
    count = len(items)
    for i, item in enumerate(items):
        if bar.isatty():
            done = BAR_WIDTH * i // count
            bar.write(f'\r{title} [{"#" * done}{"." * (BAR_WIDTH - done)}] {i}/{count}')
            bar.flush()
        yield item
    begin = '\r' if bar.isatty() else ''
    bar.write(f'{begin}{title}: {count} done{" " * BAR_WIDTH}\n')
