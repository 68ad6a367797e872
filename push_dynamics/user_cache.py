"""
The user's cache of machine code and tables, and how it stays small.

Each version of the sources has a directory of its own there, so that former ones would pile up. A
directory that is asked for gets the present time; once a day whoever asks removes those for which
nobody has asked in 30 days. Each is renamed first, so that other processes see all of it or
nothing; what one that has run for so long still needs it makes anew.
"""

import contextlib
import os
import pathlib
import re
import shutil

from push_dynamics.reservation import reserved

DAY = 86400.0
# Time for which an unused directory is kept [s]; chosen: whoever alternates between versions, or
# comes back from a holiday, does not compile anew.
KEPT_TIME = 30.0 * DAY
# Time between two looks for unused directories [s]; chosen: they come with new versions.
PRUNING_PERIOD = DAY
# File whose time is that of the last look.
PRUNED = 'pruned'
REMOVED = '.removed-'
# Directories of versions, and those whose removal was interrupted.
REMOVABLE = re.compile(f'[0-9a-f]{{16}}|{re.escape(REMOVED)}.*')


def user_cache(name: str) -> str | None:
    """
    Return a directory of the cache, made if need be; None where it cannot be written to.

    It lies in ``NUMBA_CACHE_DIR``, else ``XDG_CACHE_HOME``, else ``~/.cache``.

    :param name: of the directory.
    """
    root = os.environ.get('NUMBA_CACHE_DIR') or os.environ.get('XDG_CACHE_HOME')
    if not root:
        home = os.path.expanduser('~')
        root = os.path.join(home, '.cache')
    path = pathlib.Path(root) / 'push_control' / name
    unused: list[pathlib.Path] = []
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Nobody sets a directory aside that another process is about to use.
        with reserved(path.parent / PRUNED):
            path.mkdir(exist_ok=True)
            os.utime(path)
            with contextlib.suppress(OSError):
                unused = _set_unused_aside(path.parent, path.stat().st_mtime)
    except OSError:
        return None
    for former in unused:
        shutil.rmtree(former, ignore_errors=True)
    return str(path) if os.access(path, os.W_OK) else None


def _set_unused_aside(folder: pathlib.Path, now: float) -> list[pathlib.Path]:
    """Rename what nobody has used for long, where it is time to look; return what to remove."""
    mark = folder / PRUNED
    if mark.exists() and now - mark.stat().st_mtime < PRUNING_PERIOD:
        return []
    mark.touch()
    unused: list[pathlib.Path] = []
    for path in sorted(folder.iterdir()):
        # Another process may be removing it.
        with contextlib.suppress(OSError):
            if REMOVABLE.fullmatch(path.name) and now - path.stat().st_mtime > KEPT_TIME:
                unused.append(path.rename(
                    path.with_name(REMOVED + path.name.removeprefix(REMOVED))))
    return unused
