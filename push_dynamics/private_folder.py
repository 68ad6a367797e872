"""
A folder of files that its user alone can have written, and that are whole.

Machine code is run and pickled objects are loaded from there, both of which may do anything. So
nobody else may be able to change the folder, or to put another in its place, and what is read
from it is the user's own. A digest tells files that were cut off or spoilt: each counts as none,
and is made again.
"""

from collections.abc import Callable, Generator
import contextlib
import fcntl
import functools
import grp
import hashlib
import os
import pathlib
import pwd
import stat
import tempfile
import warnings

SUPERUSER = 0
# Mode of a folder that is made.
PRIVATE = 0o700
# Links on the way to a folder, as many as Linux follows.
MAX_LINKS = 40
DIGEST_SIZE = hashlib.sha256().digest_size


class PrivateFolder:
    """
    A folder that nobody else can change.

    ``path``: of the folder, without links.
    """

    def __init__(self, path: pathlib.Path, user: int | None = None) -> None:
        """
        Make a folder, and those above it, where they are missing.

        :param path: of the folder.
        :param user: number of the user, or None for that of this process.
        :raises OSError: where it cannot be made, or somebody else can change it.
        """
        self._user = os.geteuid() if user is None else user
        self.path = _private_path(path, self._user)

    def read(self, name: str) -> bytes | None:
        """
        Read a file; None where there is none that is the user's own and whole.

        :param name: of the file.
        """
        try:
            with open(self.path / name, 'rb', opener=_open_file) as file:
                # What was opened is checked: another file may have that name by now.
                status = os.fstat(file.fileno())
                _check(self.path / name, status, self._user)
                if not stat.S_ISREG(status.st_mode):
                    return None
                digest, content = file.read(DIGEST_SIZE), file.read()
                # The time of its last use, by which the cache forgets; a disk may be read-only.
                with contextlib.suppress(OSError):
                    os.utime(file.fileno())
        except OSError:
            return None
        return content if digest == _digest(name, content) else None

    def write(self, name: str, content: bytes) -> None:
        """
        Write a file, at once as a whole; warn where that is impossible, as on a full disk.

        :param name: of the file.
        """
        try:
            handle, unfinished = tempfile.mkstemp(dir=self.path, suffix='.part')
            try:
                with open(handle, 'wb') as file:
                    file.write(_digest(name, content))
                    file.write(content)
                    file.flush()
                    os.fsync(handle)
                os.replace(unfinished, self.path / name)
            finally:
                pathlib.Path(unfinished).unlink(missing_ok=True)
        except OSError as error:
            warn_once(f'{self.path.parent}: {error.strerror}: what is compiled and computed now '
                      'cannot be stored, and is made again at the next start')

    def read_or_make(self, name: str, make: Callable[[], bytes]) -> bytes:
        """
        Read a file, or make and write it: of processes that start together one makes it.

        :param name: of the file.
        :param make: returns the content.
        """
        content = self.read(name)
        if content is None:
            with self.reserved(name):
                # Another process may have made it while this one waited.
                content = self.read(name)
                if content is None:
                    content = make()
                    self.write(name, content)
        return content

    @contextlib.contextmanager
    def reserved(self, name: str) -> Generator[None, None, None]:
        """
        Let other processes wait that want to make a file too.

        :param name: of the file; the lock lies beside it.
        """
        with contextlib.ExitStack() as stack:
            # On a disk without locks every process makes its own.
            with contextlib.suppress(OSError):
                lock = stack.enter_context((self.path / name).with_suffix('.lock').open('w'))
                fcntl.flock(lock, fcntl.LOCK_EX)
            yield


@functools.lru_cache(maxsize=None)
def warn_once(message: str) -> None:
    """Warn, once in the life of a process; filters alone forget what they have shown."""
    warnings.warn(message, RuntimeWarning, stacklevel=3)


def _private_path(path: pathlib.Path, user: int) -> pathlib.Path:
    """
    Return the path without links, checked from the root down: each folder protects the next.

    Those above the last may belong to the superuser. Anybody may write to them only where they
    protect what is not the writer's, as ``/tmp`` does.
    """
    path = path.absolute()
    current = pathlib.Path(path.anchor)
    _check_above(current, current.lstat(), user)
    names = list(reversed(path.relative_to(current).parts))
    links = 0
    while names:
        name = names.pop()
        status = _status(current / name)
        if stat.S_ISLNK(status.st_mode):
            _check_owner(current / name, status, user, SUPERUSER)
            links += 1
            if links > MAX_LINKS:
                raise OSError(f'{path}: got more than {MAX_LINKS} links')
            target = pathlib.Path(os.readlink(current / name))
            names += reversed(target.relative_to(target.anchor).parts)
            current /= target.anchor
        else:
            current = current.parent if name == os.pardir else current / name
            _check_above(current, status, user)
    _check(current, current.lstat(), user)
    return current


def _status(path: pathlib.Path) -> os.stat_result:
    """Return the status of a folder or link; make a folder where there is nothing."""
    try:
        return path.lstat()
    except FileNotFoundError:
        path.mkdir(mode=PRIVATE, exist_ok=True)
        return path.lstat()


def _check_above(path: pathlib.Path, status: os.stat_result, user: int) -> None:
    """Refuse a folder in which others can replace what belongs to the user."""
    if not stat.S_ISDIR(status.st_mode):
        raise NotADirectoryError(f'{path}: got a file, expected a folder')
    if status.st_mode & stat.S_ISVTX:
        _check_owner(path, status, user, SUPERUSER)
    else:
        _check(path, status, user, SUPERUSER)


def _check(path: pathlib.Path, status: os.stat_result, *owners: int) -> None:
    """Refuse what belongs to none of some users, or what others may write to."""
    _check_owner(path, status, *owners)
    others_may_write = bool(status.st_mode & stat.S_IWOTH)
    if status.st_mode & stat.S_IWGRP and not _is_private_group(status.st_gid, owners[0]):
        others_may_write = True
    if others_may_write:
        raise PermissionError(f'{path}: got mode {stat.S_IMODE(status.st_mode):o}, by which '
                              'others may write to it, expected one without, as by chmod go-w')


def _is_private_group(group: int, user: int) -> bool:
    """
    Tell whether a group is the user's own, with nobody else in it.

    Debian and Ubuntu give each user such a group, of the user's name, and let it write by default.
    """
    try:
        account, members = pwd.getpwuid(user), grp.getgrgid(group)
    except KeyError:
        return False
    return (group == account.pw_gid and members.gr_name == account.pw_name
            and set(members.gr_mem) <= {account.pw_name})


def _check_owner(path: pathlib.Path, status: os.stat_result, *owners: int) -> None:
    if status.st_uid not in owners:
        raise PermissionError(f'{path}: got a folder, file or link of user {status.st_uid}, '
                              f'expected user {owners[0]}')


def _open_file(path: str, flags: int) -> int:
    """Open a file, but no link, and without waiting for the writer of a pipe."""
    return os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK)


def _digest(name: str, content: bytes) -> bytes:
    """Return the digest that stands before the content: one file is not taken for another."""
    digest = hashlib.sha256(name.encode() + b'\0')
    digest.update(content)
    return digest.digest()
