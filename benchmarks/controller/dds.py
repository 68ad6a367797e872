"""CPU load and latency of the controller node, over DDS on the wall clock."""

import os
from pathlib import Path
import tempfile
import time
from typing import NamedTuple, Optional, Sequence, TYPE_CHECKING

from benchmarks.controller.tables import table
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from push_scenario.simulation.loop import Progress

if TYPE_CHECKING:
    from push_scenario.dds.processes import NodeProcesses

SCENARIO = 'straight_push'
# utime and stime in /proc/PID/stat, counted from the field after the name: fields 14 and 15 of
# proc(5).
CPU_FIELDS = slice(11, 13)


class OverDds(NamedTuple):
    """
    Figures of one replay.

    :param law: the control law.
    :param outcome: of the replay.
    :param load: CPU time of the controller node over wall time, while it pushed.
    :param median: latency from pose to command [s].
    :param high: the same, 99th percentile [s].
    """

    law: str
    outcome: str
    load: float
    median: float
    high: float


class _CpuClock:
    """Reads the CPU time of a node during the push; marks are (wall time, CPU time) [s]."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._pid: Optional[int] = None
        self._marks: list[tuple[float, float]] = []

    def start(self, nodes: 'NodeProcesses') -> None:
        self._pid = nodes.pid(self._name)

    def note(self, progress: Progress) -> None:
        if self._pid is not None and progress.stage == 'pushing':
            fields = Path(f'/proc/{self._pid}/stat').read_text().rpartition(')')[2].split()
            ticks = sum(map(int, fields[CPU_FIELDS]))
            self._marks = self._marks[:1] + [
                (time.monotonic(), ticks / os.sysconf('SC_CLK_TCK'))]

    @property
    def load(self) -> float:
        (began, before), (ended, after) = self._marks[0], self._marks[-1]
        return (after - before) / (ended - began)


def over_dds(laws: Sequence[str]) -> list[OverDds]:
    """
    Replay a straight push under every law, on the wall clock.

    :param laws: names of the control laws.
    :return: list of ``OverDds``.
    :raises ModuleNotFoundError: without ROS 2.
    :raises RuntimeError: where a replay was not timed.
    """
    from push_ros.topics import CONTROLLER
    from push_scenario.dds.replay import run_over_dds
    scenario = read_scenario(find_scenario(SCENARIO))
    runs: list[OverDds] = []
    for law in laws:
        clock = _CpuClock(CONTROLLER)
        with tempfile.TemporaryDirectory() as folder:
            result = run_over_dds(scenario, law, folder, real_time=True,
                                  record=False, progress=clock.note, on_start=clock.start)
        if result.timing is None:
            raise RuntimeError(f'timing: got none of law {law}, expected that of a replay')
        runs.append(OverDds(law, result.outcome.value, clock.load,
                            result.timing.latency_median, result.timing.latency_p99))
    return runs


def dds_table(runs: Optional[Sequence[OverDds]]) -> str:
    """
    Write CPU loads and latencies.

    :param runs: list of ``OverDds``; None without ROS 2.
    """
    if not runs:
        return 'Not measured in this run: neither the CPU load nor the latency over DDS.'
    return table(['law', 'outcome', 'CPU load of the node', 'pose to command, ms: median', 'p99'],
                 [(run.law, run.outcome, f'{100.0 * run.load:.0f} %', f'{1e3 * run.median:.2f}',
                   f'{1e3 * run.high:.2f}') for run in runs])
