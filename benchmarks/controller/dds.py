"""The controller's node over DDS on the wall clock: its CPU share, and its latency."""

import os
from pathlib import Path
import tempfile
import time
from typing import NamedTuple

from benchmarks.controller.tables import table
from push_scenario.definition.loader import find_scenario, read_scenario

SCENARIO = 'straight_push'
CPU_FIELDS = slice(11, 13)


class OverDds(NamedTuple):
    """
    One replay.

    :param law: the control law.
    :param outcome: of the replay.
    :param share: CPU time of the controller's node over wall time, while it pushed.
    :param median: latency from pose to command [s].
    :param high: the same, 99th percentile [s].
    """

    law: str
    outcome: str
    share: float
    median: float
    high: float


class _CpuClock:
    """Reads the CPU time of the controller's node as the push goes on."""

    def __init__(self, name):
        self._name, self._pid, self._marks = name, None, []

    def start(self, nodes):
        self._pid = nodes.pid(self._name)

    def note(self, progress):
        if self._pid is not None and progress.stage == 'pushing':
            fields = Path(f'/proc/{self._pid}/stat').read_text().rpartition(')')[2].split()
            ticks = sum(map(int, fields[CPU_FIELDS]))
            self._marks = self._marks[:1] + [
                (time.monotonic(), ticks / os.sysconf('SC_CLK_TCK'))]

    @property
    def share(self):
        (began, before), (ended, after) = self._marks[0], self._marks[-1]
        return (after - before) / (ended - began)


def over_dds(laws):
    """
    Replay a straight push under every law, on the wall clock.

    :param laws: control laws.
    :return: list of ``OverDds``.
    :raises ModuleNotFoundError: without ROS 2.
    """
    from push_ros.topics import CONTROLLER
    from push_scenario.dds.replay import run_over_dds
    scenario, found = read_scenario(find_scenario(SCENARIO)), []
    for law in laws:
        clock = _CpuClock(CONTROLLER)
        with tempfile.TemporaryDirectory() as folder:
            result = run_over_dds(scenario, law, folder, real_time=True,
                                  record=False, progress=clock.note, on_start=clock.start)
        found.append(OverDds(law, result.outcome.value, clock.share,
                             result.timing.latency_median, result.timing.latency_p99))
    return found


def dds_table(found):
    """
    Write shares and latencies.

    :param found: list of ``OverDds``; None without ROS 2.
    """
    if not found:
        return 'Not measured in this run: neither the CPU share nor the latency over DDS.'
    return table(['law', 'outcome', 'CPU share of the node', 'pose to command, ms: median', 'p99'],
                 [(run.law, run.outcome, f'{100.0 * run.share:.0f} %', f'{1e3 * run.median:.2f}',
                   f'{1e3 * run.high:.2f}') for run in found])
