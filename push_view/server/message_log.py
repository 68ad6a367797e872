"""Log of messages: what a page that is opened later has to be sent, too."""

import json
import threading
from typing import Any, NamedTuple

from push_view.messages import Message

# Rows that are kept; chosen: half an hour at 50 Hz. Older ones are dropped, the rest stays.
MAX_ROWS = 90_000


class _Entry(NamedTuple):
    """A message as it is sent, and how many rows it has."""

    text: str
    rows: int = 0


class MessageLog:
    """Messages in order, for any number of readers, from any thread."""

    def __init__(self, max_rows: int = MAX_ROWS) -> None:
        """
        Start empty.

        :param max_rows: rows that are kept.
        """
        self._max_rows = max_rows
        self._lock = threading.Lock()
        # None in place of a message that is out of date.
        self._entries: list[_Entry | None] = []
        self._first = 0
        self._newest: dict[str, int] = {}
        self._rows = 0
        self._oldest_rows = 0

    def add(self, message: Message) -> None:
        """
        Add a message.

        :param message: with the key ``type``.
        """
        entry = _Entry(_text(message), len(message['rows']) if message['type'] == 'rows' else 0)
        with self._lock:
            self._entries.append(entry)
            self._rows += entry.rows
            while self._rows > self._max_rows:
                self._drop_oldest_rows()

    def replace(self, message: Message) -> None:
        """
        Add a message that takes the place of all former ones of its type.

        :param message: with the key ``type``.
        """
        with self._lock:
            previous = self._newest.get(message['type'])
            if previous is not None:
                self._entries[previous] = None
            self._newest[message['type']] = len(self._entries)
            self._entries.append(_Entry(_text(message)))

    def clear(self) -> None:
        """Drop everything but what was last added by ``replace``; readers go on with the rest."""
        with self._lock:
            entries = {name: self._entries[index] for name, index in self._newest.items()}
            self._first += len(self._entries)
            self._entries = list(entries.values())
            self._newest = {name: index for index, name in enumerate(entries)}
            self._rows = self._oldest_rows = 0

    def since(self, cursor: int) -> tuple[list[str], int]:
        """
        List what has been added.

        :param cursor: as the last call returned it, 0 at first.
        :return: messages as JSON, and the cursor for the next call.
        """
        with self._lock:
            entries = self._entries[max(0, cursor - self._first):]
            return ([entry.text for entry in entries if entry is not None],
                    self._first + len(self._entries))

    def _drop_oldest_rows(self) -> None:
        index = self._oldest_rows
        entry = self._entries[index]
        if entry is not None and entry.rows:
            self._rows -= entry.rows
            self._entries[index] = None
        self._oldest_rows = index + 1


def _text(message: Any) -> str:
    return json.dumps(message, separators=(',', ':'), allow_nan=False)
