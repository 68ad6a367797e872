"""
A process that ends with the one that has started it, even where that is killed.

    python -m push_scenario.dds.child_process PARENT MODULE [ARGUMENT ...]
"""

import ctypes
import os
import runpy
import signal
import sys

# Of prctl(2): the signal that a process gets when its parent has died.
PR_SET_PDEATHSIG = 1


def end_with(parent: int) -> None:
    """
    Let the kernel send SIGTERM to this process when its parent has died.

    :param parent: process id of the parent.
    """
    if sys.platform == 'linux':
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    if os.getppid() != parent:
        # It has died before.
        sys.exit(128 + signal.SIGTERM)


if __name__ == '__main__':
    end_with(int(sys.argv[1]))
    sys.argv = sys.argv[2:]
    runpy.run_module(sys.argv[0], run_name='__main__', alter_sys=True)
