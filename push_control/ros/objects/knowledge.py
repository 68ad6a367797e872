"""What was learned of objects, between tasks and, in a file, between runs of the node."""

from pathlib import Path
from typing import Any, Callable

from push_control.perception.object_knowledge import object_key, ObjectKnowledge
from push_control.supervision_settings import SupervisionSettings
from push_control.task.status import TaskState
from push_model.files.whole_file import write_whole
from push_model.parameters import PushedObject
import yaml

HEADER = '# What was learned of objects, by nominal parameters; delete an entry to forget it.\n'
# Key of the time at which an object was known so, by the clock of the system [s since 1970].
TIME = 'time'


class KnowledgeFile:
    """A YAML file of what was learned of objects, with the time at which it was."""

    def __init__(self, path: Path) -> None:
        """
        Choose the file; it need not be there yet.

        :param path: of the file.
        :raises ValueError: where its folder is missing.
        """
        if not path.parent.is_dir():
            raise ValueError(f'knowledge_file: got {path}, expected a file in a folder that is '
                             'there')
        self._path = path

    def read(self, key: str) -> tuple[float, ObjectKnowledge] | None:
        """
        Look an object up.

        :param key: of the object, as of ``object_key``.
        :return: time at which it was known so [s since 1970], and the ``ObjectKnowledge``; None
            where it is not in the file, or there is no file.
        :raises ValueError: naming file and field, where they cannot be read.
        """
        entries = self._entries()
        if key not in entries:
            return None
        values = entries[key]
        if not isinstance(values, dict):
            raise ValueError(f'{self._path}: {key}: got {values!r}, expected a mapping')
        knowledge: dict[str, Any] = dict(values)
        time = knowledge.pop(TIME, None)
        if isinstance(time, bool) or not isinstance(time, (int, float)):
            raise ValueError(f'{self._path}: {key}.{TIME}: got {time!r}, expected a number [s]')
        try:
            return float(time), ObjectKnowledge.from_mapping(knowledge)
        except ValueError as error:
            field = str(error).removeprefix(f'{ObjectKnowledge.__name__}.')
            raise ValueError(f'{self._path}: {key}.{field}') from error

    def write(self, key: str, time: float, knowledge: ObjectKnowledge) -> None:
        """
        Replace what is known of an object, at once; other objects stay.

        :param key: of the object, as of ``object_key``.
        :param time: now [s since 1970].
        :raises ValueError: where the file is there and cannot be read.
        :raises OSError: where it cannot be written.
        """
        entries = {**self._entries(), key: {TIME: time, **knowledge.to_mapping()}}
        text = HEADER + yaml.safe_dump(entries, sort_keys=False)
        write_whole(self._path, text.encode())

    def _entries(self) -> dict[str, Any]:
        try:
            entries = yaml.safe_load(self._path.read_text(encoding='utf-8'))
        except FileNotFoundError:
            return {}
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise ValueError(f'{self._path}: {error}, expected a YAML file') from error
        if entries is None:
            return {}
        if not isinstance(entries, dict):
            raise ValueError(f'{self._path}: got {entries!r}, expected a mapping of objects')
        return entries


class KnowledgeMemory:
    """
    Knowledge of objects, one at a time, with its present age.

    Without a file it lasts as long as the process.
    """

    def __init__(self, obj: PushedObject, settings: SupervisionSettings,
                 file: KnowledgeFile | None, clock: Callable[[], float]) -> None:
        """
        Recall what is in the file.

        :param settings: ``SupervisionSettings``, for how fast knowledge gets uncertain.
        :param file: the ``KnowledgeFile``, or None.
        :param clock: returns the present time [s since 1970].
        :raises ValueError: where the file cannot be read.
        """
        self._settings = settings
        self._file = file
        self._clock = clock
        # When it was known so [s since 1970], and what; by keys of objects.
        self._known: dict[str, tuple[float, ObjectKnowledge]] = {}
        self.select(obj)

    def select(self, obj: PushedObject) -> None:
        """
        Turn to another object; what was learned of the former one stays known.

        :raises ValueError: where the file cannot be read; then nothing is known of the object.
        """
        self._key = object_key(obj)
        self._has_pushed = False
        if self._file is None or self._key in self._known:
            return
        stored = self._file.read(self._key)
        if stored is not None:
            self._known[self._key] = stored

    def recall(self) -> ObjectKnowledge | None:
        """Return the ``ObjectKnowledge`` as it is by now; None where the object is not known."""
        if self._key not in self._known:
            return None
        time, knowledge = self._known[self._key]
        # A clock that was set back makes nothing younger.
        dt = max(0.0, self._clock() - time)
        return knowledge.aged(dt, self._settings.center_walk,
                              self._settings.contact_friction_walk)

    def is_due(self, state: TaskState) -> bool:
        """Return whether there is something to keep: a push and the retreat from it have ended."""
        self._has_pushed = self._has_pushed or state is TaskState.PUSH
        return self._has_pushed and state not in (
            TaskState.PUSH, TaskState.RETREAT, TaskState.LOOK)

    def keep(self, knowledge: ObjectKnowledge) -> str:
        """
        Keep what is known by now.

        :return: why it cannot be written to the file, one sentence; empty where it can. It is
            known here all the same.
        """
        self._has_pushed = False
        self._known[self._key] = self._clock(), knowledge
        if self._file is None:
            return ''
        try:
            self._file.write(self._key, *self._known[self._key])
        except (OSError, ValueError) as error:
            return f'knowledge_file: {error}; kept in memory only'
        return ''
