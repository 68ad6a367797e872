"""Order of the tests, and which of them share a process where there are several."""

import gc
from importlib.util import find_spec
import os
from pathlib import Path
import subprocess
import sys
from typing import Any, Iterator

from push_scenario.dds.private_network import make_process_private
import pytest

# No test is in the network of the user's robots, not even one that starts a node unawares.
make_process_private()

# Files and folders of tests that take long, the longest first: what begins last decides when all
# processes have ended. The tests of one entry share results, hence a process.
# Two of the first four build interfaces by cmake, while the others compile what all need.
LONGEST = ('test/studies/', 'test/scenario/test_tasks.py', 'test/ros/test_commander.py',
           'test/ros/test_exclusion_zones.py', 'test/scenario/test_dds_task.py',
           'test/scenario/test_dds_replay.py', 'test/control/steered/test_mpc_pushes.py',
           'test/control/task/test_supervisor.py', 'test/ros/test_nodes.py')
# Processes of tests beyond the number of cores. Chosen: about so many wait, for nodes, for time to
# pass or for another process to compile what they need too; each takes 3 s to collect the tests.
WAITING = 2
# Folders of tests that import most of what there is, in two parts of about the same size.
PARTS = (('test/scenario', 'test/ros', 'test/view'),
         ('test/studies', 'test/planner', 'test/control', 'test/primitives', 'test/navigation'))
ROOT = Path(__file__).resolve().parents[1]


@pytest.hookimpl(hookwrapper=True)
def pytest_collection() -> Iterator[None]:
    """Collect no garbage while tests are collected, a sixth of that time; what is there stays."""
    gc.disable()
    yield
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest entries, then files with nodes, then those with slow tests."""
    marked = {marker: {item.path for item in items if item.get_closest_marker(marker)}
              for marker in ('dds', 'slow')}
    items.sort(key=lambda item: (rank(item.nodeid), item.path not in marked['dds'],
                                 item.path not in marked['slow']))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes() -> None:
    """Have modules read by two processes at first, as else each process translates all of them."""
    numba = find_spec('numba')
    if numba is None or numba.cached is None or Path(numba.cached).exists():
        return
    command = [sys.executable, '-m', 'pytest', '-q', '-p', 'no:xdist', '--collect-only']
    readers = [subprocess.Popen([*command, *part], cwd=ROOT, stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
               for part in PARTS]
    # What they fail at fails again where it is seen.
    for reader in readers:
        reader.wait()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Take more processes than there are cores, as tests with nodes wait for these."""
    return len(os.sched_getaffinity(0)) + WAITING


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Hand out an entry of ``LONGEST`` or a file at a time, in the order of the tests."""
    # Not installed everywhere.
    from xdist.scheduler import LoadFileScheduling
    config.option.loadscopereorder = False
    scheduler = LoadFileScheduling(config, log)
    scheduler._split_scope = group
    return scheduler


def rank(nodeid: str) -> int:
    """Return the place of a test among ``LONGEST``, or one behind all of them."""
    return next((place for place, entry in enumerate(LONGEST) if nodeid.startswith(entry)),
                len(LONGEST))


def group(nodeid: str) -> str:
    """Return the name of what a test shares a process with."""
    place = rank(nodeid)
    return LONGEST[place] if place < len(LONGEST) else nodeid.split('::', 1)[0]
