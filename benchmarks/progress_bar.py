"""A bar on the terminal for commands that take a while."""

import sys


def progress(items, title, stream=None):
    """
    Yield the items, and show how many are done.

    :param items: sequence.
    :param title: what is running.
    :param stream: where to write; ``sys.stderr`` if None. Anything but a terminal gets one line.
    """
    stream = stream or sys.stderr
    count = len(items)
    for i, item in enumerate(items):
        if stream.isatty():
            done = 30 * i // count
            stream.write(f'\r{title} [{"#" * done}{"." * (30 - done)}] {i}/{count}')
            stream.flush()
        yield item
    stream.write(f'{"" if not stream.isatty() else chr(13)}{title}: {count} done{" " * 30}\n')
