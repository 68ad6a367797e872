"""What was learned of the base, in a file between runs of the node."""

from pathlib import Path
from typing import Any

from push_model.base_knowledge import BaseKnowledge, robot_key
from push_model.files.whole_file import write_whole
from push_model.parameters import RoundRobot
import yaml

HEADER = '# What was learned of bases, by nominal parameters; delete an entry to forget it.\n'


class BaseMemory:
    """
    A YAML file of what was learned of bases.

    No file keeps a node from starting: what cannot be read is named, and learned again.
    """

    def __init__(self, path: Path | None, robot: RoundRobot) -> None:
        """
        Choose the file; it need not be there yet.

        :param path: of the file; None to keep nothing.
        :param robot: the ``RoundRobot``, nominal.
        """
        self._path = path
        self._key = robot_key(robot)
        # What is in the file, or could not be written there.
        self._stored: BaseKnowledge | None = None

    def recall(self) -> tuple[BaseKnowledge | None, str]:
        """
        Look the base up.

        :return: the ``BaseKnowledge``, None where there is none; and why it cannot be read, one
            sentence, empty where it can.
        """
        if self._path is None:
            return None, ''
        try:
            entry = self._entries().get(self._key)
            if entry is None:
                return None, ''
            if not isinstance(entry, dict):
                raise ValueError(f'got {entry!r}, expected a mapping')
            self._stored = BaseKnowledge.from_mapping(entry)
        except (OSError, ValueError, yaml.YAMLError) as error:
            return None, f'base_file: {self._path}: {error}; the base is learned again'
        return self._stored, ''

    def keep(self, knowledge: BaseKnowledge) -> str:
        """
        Replace what is known of the base, at once; other bases stay.

        :return: why it cannot be written, one sentence; empty where it can, or is kept already.
        """
        if self._path is None or knowledge == self._stored:
            return ''
        self._stored = knowledge
        try:
            entries = {**self._readable_entries(), self._key: knowledge.to_mapping()}
            write_whole(self._path, (HEADER + yaml.safe_dump(entries)).encode())
        except OSError as error:
            return f'base_file: {error}; kept in memory only'
        return ''

    def _readable_entries(self) -> dict[str, Any]:
        """Return what is in the file; a damaged one is replaced."""
        try:
            return self._entries()
        except (ValueError, yaml.YAMLError):
            return {}

    def _entries(self) -> dict[str, Any]:
        if self._path is None or not self._path.exists():
            return {}
        entries = yaml.safe_load(self._path.read_text(encoding='utf-8'))
        if entries is None:
            return {}
        if not isinstance(entries, dict):
            raise ValueError(f'got {entries!r}, expected a mapping of bases')
        return entries
