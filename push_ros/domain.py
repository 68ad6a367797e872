"""A ROS domain of one's own."""

import contextlib
import fcntl
import os
from pathlib import Path
import tempfile

DOMAINS = range(1, 102)


@contextlib.contextmanager
def private_domain():
    """
    Take a ROS domain that no other replay on this machine uses, until the block ends.

    :return: context manager that yields the number of the domain.
    :raises RuntimeError: where all are taken.
    """
    folder = Path(tempfile.gettempdir()) / f'push_control_domains_{os.getuid()}'
    folder.mkdir(mode=0o700, exist_ok=True)
    # Begin at another one in each process, so that domains just left can fall silent.
    for i in range(len(DOMAINS)):
        domain = DOMAINS[(os.getpid() + i) % len(DOMAINS)]
        with open(folder / str(domain), 'w', encoding='ascii') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return
    raise RuntimeError(f'no ROS domain is free: all of {DOMAINS[0]} to {DOMAINS[-1]} are locked '
                       f'in {folder}')
