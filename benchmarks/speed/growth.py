"""Growth of costs: a step of the simulator by supports, a batch by cases, a task by pushes."""

import json
import math
from pathlib import Path
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

from benchmarks.plant.batch import draw, PUSH, STEP
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, RoundRobot, Support
from push_scenario import load_scenario, run_pushes, simulate, simulate_cases, VariedPush
from push_scenario.batch.case_arrays import CaseEncoder

SUPPORTS = (3, 4, 8, 15, 30, 60)
CASES = (1_000, 10_000, 100_000, 1_000_000)
# Scenarios by the pushes that they take, and one through doors; chosen: of different lengths.
TASKS = ('task_tap', 'task_two_pushes', 'task_demo', 'task_flat')
# Radius of a disc on a ring of supports, and of that ring [m]; chosen: a table.
DISC, RING = 0.4, 0.35
# Cases that are stepped at once, and steps of each; chosen: half a second with 60 supports.
STEPPED, PUSH_STEPS = 100, 400
# Steps of a short push; chosen: a million of them take about half a minute.
SHORT_STEPS = 40
RADIUS = 0.17


class Growth(NamedTuple):
    """
    Cost of something of a size.

    :param what: is done.
    :param size: number of ``unit``.
    :param unit: of the size, such as cases.
    :param seconds: CPU time [s].
    :param memory: most memory that the process had [B], 0 where it was not measured.
    """

    what: str
    size: int
    unit: str
    seconds: float
    memory: float = 0.0

    def text(self) -> str:
        """Write a row of a table in Markdown."""
        memory = f'{self.memory / 1e6:.0f} MB' if self.memory else ''
        return (f'| {self.what} | {self.unit} | {self.size:,} | {time_text(self.seconds)} | '
                f'{time_text(self.seconds / self.size)} | {memory} |')


class BatchCost(NamedTuple):
    """
    Cost of a batch in a process of its own.

    :param seconds: CPU time [s].
    :param memory: most that the process had [B].
    """

    seconds: float
    memory: float


def growth_table(repeat: int) -> str:
    """
    Measure everything, and write a table in Markdown.

    :param repeat: how often steps are timed; the least time counts.
    """
    rows = [*support_rows(repeat), *case_rows(), *task_rows()]
    return '\n'.join(['| what | over | size | CPU time | for each | memory |',
                      '| --- | --- | --- | --- | --- | --- |', *(row.text() for row in rows)])


def support_rows(repeat: int) -> list[Growth]:
    """
    Time a step of a pushed disc over the number of its supports.

    :param repeat: how often; the least time counts.
    """
    return [Growth('step of the simulator', count, 'supports',
                   min(step_time(count) for _ in range(repeat))) for count in SUPPORTS]


def step_time(supports: int) -> float:
    """
    Measure the CPU time of a compiled step [s].

    :param supports: their number.
    """
    angles = [2.0 * math.pi * i / supports for i in range(supports)]
    ring = tuple(Support(RING * math.cos(angle), RING * math.sin(angle), 0.3) for angle in angles)
    push = VariedPush(PushedObject(5.0, supports=ring, radius=DISC),
                      RoundRobot(RADIUS, 'holonomic'), (0.0, 0.0, 0.0),
                      (-DISC - RADIUS, 0.0, 0.0), ((PUSH_STEPS * STEP, 0.2, 0.0, 0.1),), STEP)
    masses = np.random.default_rng(1).uniform(1.0, 5.0, STEPPED)
    return _stepping_time(push, {'object.mass': masses}) / (STEPPED * PUSH_STEPS)


def _stepping_time(push: VariedPush, columns: dict[str, FloatArray]) -> float:
    """Measure the CPU time of the compiled loop alone [s]."""
    arrays = CaseEncoder(push, push.columns(columns)).encode().arrays
    began = time.process_time()
    arrays.run(push.step, push.lost_gap)
    return time.process_time() - began


def case_rows() -> list[Growth]:
    """Run batches of short pushes to disk, each in a process of its own."""
    costs = [_in_process(count) for count in CASES]
    return [Growth(f'batch of pushes of {SHORT_STEPS} steps', count, 'cases', cost.seconds,
                   cost.memory) for count, cost in zip(CASES, costs)]


def _in_process(count: int) -> BatchCost:
    code = ('import json\nfrom benchmarks.speed.growth import batch_cost\n'
            f'print(json.dumps(batch_cost({count})))')
    done = subprocess.run([sys.executable, '-c', code], check=True, text=True,
                          stdout=subprocess.PIPE)
    return BatchCost(*json.loads(done.stdout))


def batch_cost(count: int) -> BatchCost:
    """
    Run a batch of short pushes in this process.

    :param count: number of cases.
    """
    simulate_cases(PUSH, draw_short(np.random.default_rng(0), 1))
    with tempfile.TemporaryDirectory() as folder:
        began = time.process_time()
        run_pushes(PUSH, draw_short, count, Path(folder) / 'rows.npy', workers=1)
        seconds = time.process_time() - began
    return BatchCost(seconds, _greatest_memory())


def draw_short(rng: np.random.Generator, count: int) -> dict[str, FloatArray]:
    """
    Draw cases of the benchmark of batches, and break them off early.

    :param rng: generator.
    :param count: number of cases.
    """
    columns = draw(rng, count)
    columns['segments'][:, :, 0] = SHORT_STEPS * STEP
    return columns


def _greatest_memory() -> float:
    """Read the most resident memory that this process has had [B], as Linux counts it."""
    lines = Path('/proc/self/status').read_text(encoding='ascii').splitlines()
    return 1024.0 * next(float(line.split()[1]) for line in lines if line.startswith('VmHWM'))


def task_rows() -> list[Growth]:
    """Simulate tasks of several lengths in this process."""
    return [task_row(name) for name in TASKS]


def task_row(name: str) -> Growth:
    """
    Simulate a task in this process, once all code is loaded.

    :param name: of its scenario.
    """
    scenario = load_scenario(name)
    simulate(scenario, planning_time=0.0)
    began = time.process_time()
    result = simulate(scenario, planning_time=0.0)
    return Growth(f'`{name}` in one process', result.pushes, 'pushes', time.process_time() - began)


def time_text(seconds: float) -> str:
    """
    Write a time with the unit that suits it.

    :param seconds: above 0 [s].
    """
    units = (('s', 1.0), ('ms', 1e-3), ('us', 1e-6), ('ns', 1e-9))
    unit, scale = next((one for one in units if seconds >= one[1]), units[-1])
    return f'{seconds / scale:.3g} {unit}'
