"""
The user's cache of machine code and tables, and how it stays small.

Each version of the sources has a directory of its own there, so that former ones would pile up. A
directory that is asked for gets the present time; once a day whoever asks removes those for which
nobody has asked in 30 days. Each is renamed first, so that other processes see all of it or
nothing; what one that has run for so long still needs it makes anew. Where the rest is larger than
``MAX_SIZE``, the files go that were last used the longest ago.

Whether others can write to the cache is checked in ``push_dynamics.private_folder``.
"""

import contextlib
import os
import pathlib
import re
import shutil
from typing import NamedTuple

from push_dynamics.private_folder import PrivateFolder, warn_once

DAY = 86400.0
# Time for which an unused directory is kept [s]; chosen: whoever alternates between versions, or
# comes back from a holiday, does not compile anew.
RETENTION_TIME = 30.0 * DAY
# Time between two looks for unused directories [s]; chosen: they come with new versions.
PRUNING_PERIOD = DAY
# Bound of the files [bytes]; chosen: one version with the tables of the objects in config/objects
# takes some 40 MB. What goes over it is cut to a part, so that not every look cuts a little.
MAX_SIZE = 500e6
REMAINING_PART = 0.75
# File whose time is that of the last look.
PRUNED = 'pruned'
REMOVED = '.removed-'
# Directories of versions, and those whose removal was interrupted.
REMOVABLE = re.compile(f'[0-9a-f]{{16}}|{re.escape(REMOVED)}.*')


class CachedFile(NamedTuple):
    """
    A file of the cache.

    :param path: where it is.
    :param size: in bytes.
    :param used: time at which it was made or last read, since the epoch [s].
    """

    path: pathlib.Path
    size: int
    used: float


def cache_path() -> pathlib.Path:
    """Return the path of the cache: in ``NUMBA_CACHE_DIR``, ``XDG_CACHE_HOME`` or ``~/.cache``."""
    root = os.environ.get('NUMBA_CACHE_DIR') or os.environ.get('XDG_CACHE_HOME')
    if not root:
        home = os.path.expanduser('~')
        root = os.path.join(home, '.cache')
    return pathlib.Path(root) / 'push_control'


def cached_files() -> list[CachedFile]:
    """List what the folders of the cache hold, without their locks."""
    return _files_in(cache_path())


def clear_cache() -> None:
    """Remove all folders of the cache; processes that run make anew what they still need."""
    for path in list(cache_path().glob('*')):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)


def user_cache(name: str) -> PrivateFolder | None:
    """
    Return a folder of the cache, made if need be; None, with a warning, where there can be none.

    It lies in ``cache_path()``.

    :param name: of the folder.
    """
    path = cache_path()
    unused: list[pathlib.Path] = []
    try:
        folder = PrivateFolder(path)
        # Nobody sets a directory aside that another process is about to use.
        with folder.reserved(PRUNED):
            version = PrivateFolder(folder.path / name)
            # A cache on a disk that is read-only is read.
            with contextlib.suppress(OSError):
                os.utime(version.path)
                unused = _set_apart_unused(folder.path, version.path.stat().st_mtime)
    except OSError as error:
        reason = f'{path}: {error.strerror}' if error.strerror else str(error)
        warn_once(f'{reason}: without a cache, compiled code and tables of pushes are made again '
                  'at each start')
        return None
    for unused_path in unused:
        shutil.rmtree(unused_path, ignore_errors=True)
    return version


def _set_apart_unused(folder: pathlib.Path, now: float) -> list[pathlib.Path]:
    """Rename what nobody has used for long, where it is time to look; return what to remove."""
    mark = folder / PRUNED
    if mark.exists() and now - mark.stat().st_mtime < PRUNING_PERIOD:
        return []
    mark.touch()
    _remove_oldest(_files_in(folder))
    unused: list[pathlib.Path] = []
    for path in sorted(folder.iterdir()):
        # Another process may be removing it.
        with contextlib.suppress(OSError):
            if REMOVABLE.fullmatch(path.name) and now - path.stat().st_mtime > RETENTION_TIME:
                unused.append(path.rename(
                    path.with_name(REMOVED + path.name.removeprefix(REMOVED))))
    return unused


def _files_in(folder: pathlib.Path) -> list[CachedFile]:
    files: list[CachedFile] = []
    for path in folder.glob('*/*'):
        # Another process may be removing it.
        with contextlib.suppress(OSError):
            status = path.stat()
            if path.is_file() and path.suffix != '.lock':
                files.append(CachedFile(path, status.st_size, status.st_mtime))
    return files


def _remove_oldest(files: list[CachedFile]) -> None:
    """Remove files, the longest unused first, until the rest is well below the bound."""
    size = sum(file.size for file in files)
    if size <= MAX_SIZE:
        return
    for file in sorted(files, key=lambda file: file.used):
        if size <= REMAINING_PART * MAX_SIZE:
            break
        with contextlib.suppress(OSError):
            file.path.unlink()
            size -= file.size
