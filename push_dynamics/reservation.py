"""Reservation of files that several processes would make at once: one makes, the others wait."""

from collections.abc import Generator
import contextlib
import fcntl
import pathlib


@contextlib.contextmanager
def reserved(path: pathlib.Path | None) -> Generator[None, None, None]:
    """
    Let other processes wait that want to make a file too; where it can be written to.

    :param path: of the file; the lock lies beside it. None for no file, and no wait.
    """
    with contextlib.ExitStack() as stack:
        if path is not None:
            # On a disk without locks every process makes its own.
            with contextlib.suppress(OSError):
                lock = stack.enter_context(path.with_suffix('.lock').open('w'))
                fcntl.flock(lock, fcntl.LOCK_EX)
        yield
