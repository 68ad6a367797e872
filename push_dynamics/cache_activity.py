"""What processes compile and compute for the first time, as the files of the cache tell."""

import pathlib
from typing import NamedTuple

from push_dynamics.user_cache import cache_path

# Functions that a task over DDS compiles in a new installation, by `make demo` with an empty
# cache. In one process, and for steered pushes, there are fewer.
USUAL_FUNCTIONS = 125
MACHINE_CODE, TABLE = '.code', '.npz'
# What is made of an object's pushes, one after the other; the lock of a file is there before it.
TABLES = ('table', 'cost')


class CacheState(NamedTuple):
    """
    Content of the cache at a time.

    :param folders: time of the last use of each folder [s].
    :param files: paths of the files.
    """

    folders: dict[pathlib.Path, float]
    files: frozenset[pathlib.Path]


class CacheActivity:
    """Tells what is new in the cache since this was made."""

    def __init__(self) -> None:
        """Remember what is there."""
        self._before = _read_state()

    def __call__(self) -> str:
        """
        Describe what is being made, or was made last.

        :return: such as ``compiling 37 of about 125`` or ``table of pushes, step 1 of 2``; empty
            where nothing new has been made.
        """
        now = _read_state()
        new = now.files - self._before.files
        for step, kind in enumerate(TABLES, 1):
            if _is_being_made(kind, new, now.files):
                return f'table of pushes, step {step} of {len(TABLES)}'
        if not any(path.suffix == MACHINE_CODE for path in new):
            return ''
        in_use = {folder for folder, used in now.folders.items()
                  if used != self._before.folders.get(folder)}
        count = sum(path.suffix == MACHINE_CODE and path.parent in in_use for path in now.files)
        return f'compiling {count}' + (
            f' of about {USUAL_FUNCTIONS}' if count <= USUAL_FUNCTIONS else '')


def _is_being_made(kind: str, new: frozenset[pathlib.Path],
                   files: frozenset[pathlib.Path]) -> bool:
    locks = [path for path in new if path.suffix == '.lock' and path.name.startswith(f'{kind}-')]
    return any(lock.with_suffix(TABLE) not in files for lock in locks)


def _read_state() -> CacheState:
    folders: dict[pathlib.Path, float] = {}
    files: set[pathlib.Path] = set()
    for folder in cache_path().glob('*'):
        try:
            if folder.is_dir():
                folders[folder] = folder.stat().st_mtime
                files.update(folder.iterdir())
        except OSError:
            # Another process has removed it.
            continue
    return CacheState(folders, frozenset(files))
