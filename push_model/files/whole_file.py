"""Files that are written whole or not at all, as where the disk is full."""

import os
from pathlib import Path


def write_whole(path: Path, data: bytes) -> None:
    """
    Replace a file at once; where that fails, it is as it was.

    What is no file, as ``/dev/null``, is written to, and not replaced.

    :param path: of the file.
    :param data: what is to be in it.
    :raises OSError: naming the file, where it cannot be written.
    """
    if path.exists() and not path.is_file():
        path.write_bytes(data)
        return
    unfinished = path.with_name(f'{path.name}.{os.getpid()}.part')
    try:
        unfinished.write_bytes(data)
        os.replace(unfinished, path)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from error
