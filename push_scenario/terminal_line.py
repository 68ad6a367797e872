"""What a terminal can do: colours, and a line that is written over and fits into the window."""

import os
from typing import TextIO

# Window of a terminal that does not tell its size, and what stands for the rest of a line.
DEFAULT_COLUMNS = 80
ELLIPSIS = '...'


def shows_colors(stream: TextIO) -> bool:
    """
    Tell whether colours may be written: to a terminal whose user has not set ``NO_COLOR``.

    :param stream: such as ``sys.stdout``.
    """
    is_dumb = os.environ.get('TERM') == 'dumb'
    return stream.isatty() and not os.environ.get('NO_COLOR') and not is_dumb


class TerminalLine:
    """
    One line that is overwritten in a terminal; elsewhere each text is a line of its own.

    :param stream: where to write, such as ``sys.stderr``.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._width = 0

    @property
    def is_overwritten(self) -> bool:
        """Tell whether the stream is a terminal."""
        return self._stream.isatty()

    @property
    def columns(self) -> int:
        """Number of characters that fit into a line of the window as it is now."""
        try:
            columns = os.get_terminal_size(self._stream.fileno()).columns
        except OSError:
            columns = 0
        # A terminal may not know its size, and may wrap when its last column is written.
        return max((columns or DEFAULT_COLUMNS) - 1, len(ELLIPSIS))

    def write(self, text: str, *, is_last: bool = False) -> None:
        """
        Show a text in place of the one before.

        :param text: without an end of line; one that is too long is cut, unless it is the last.
        :param is_last: whether it stays.
        """
        if self.is_overwritten:
            # What is longer than the window cannot be written over.
            columns = self.columns
            if len(text) > columns and not is_last:
                text = text[:columns - len(ELLIPSIS)] + ELLIPSIS
            self._stream.write('\r' + text.ljust(min(self._width, columns)))
            self._width = len(text)
        if is_last or not self.is_overwritten:
            self._stream.write('\n' if self.is_overwritten else text + '\n')
        self._stream.flush()
