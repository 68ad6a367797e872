"""Report of the ratios of speeds: a row for each, with its aim, in a page of the docs."""

import argparse
from collections.abc import Callable, Sequence
import os
from pathlib import Path
from typing import NamedTuple

from benchmarks.report_template import fill_template
from benchmarks.speed import growth, measures
from benchmarks.speed.measures import median

DESCRIPTION = 'How near to the limit simulation, control, replay and starts are.'
TEMPLATE = Path(__file__).parent / 'performance.md.in'


class Row(NamedTuple):
    """
    A row of the report.

    :param what: which ratio, or time.
    :param aim: what it should be.
    :param measured: what it is.
    :param unit: of both, empty for a ratio.
    :param is_greater_better: whether the aim is a least value.
    """

    what: str
    aim: float
    measured: float
    unit: str = ''
    is_greater_better: bool = False

    @property
    def is_met(self) -> bool:
        """Whether the aim is reached."""
        return (self.measured >= self.aim if self.is_greater_better
                else self.measured <= self.aim)

    def text(self) -> str:
        """Write the row as Markdown, bold where the aim is missed."""
        measured = f'{self.measured:.3g}{self.unit}'
        return (f'| {self.what} | {self.aim:g}{self.unit} | '
                f'{measured if self.is_met else f"**{measured}**"} |')


def control_rows(repeat: int) -> list[Row]:
    """Measure the controller."""
    speeds = [measures.control_speed() for _ in range(repeat)]
    over_mujoco, mpc = (sorted(column)[repeat // 2] for column in zip(*speeds))
    return [Row('law `feedback` with its filter, over a step of MuJoCo', 2.0, over_mujoco),
            Row('step with the law `mpc` over one with `feedback`', 2.0, mpc)]


def task_rows(repeat: int) -> list[Row]:
    """Measure the demo task in one process."""
    measures.task_speed()
    return [Row('demo task in one process: simulated over CPU time', 100.0,
                median(measures.task_speed, repeat), '', True)]


def replay_rows(repeat: int) -> list[Row]:
    """Measure the demo task over DDS."""
    return [Row('demo task in lockstep over DDS: simulated over wall time', 20.0,
                median(measures.replay_speed, repeat), '', True)]


def start_rows(repeat: int) -> list[Row]:
    """Measure what starts cost, beyond that of Python itself."""
    rows: list[Row] = []
    python = median(lambda: measures.process_time(measures.NOTHING), repeat)
    for what, aim, words in (('`import push_planner`, CPU', 0.2, measures.IMPORT),
                             ('`push replay --list`, CPU', 0.3, measures.LIST),
                             *(('imports of the node ' + name + ', CPU', 0.5,
                                ('-c', f'import {module}'))
                               for name, module in measures.NODES.items())):
        measures.process_time(words)
        seconds = median(lambda words=words: measures.process_time(words), repeat)
        rows.append(Row(what, aim, max(0.0, seconds - python), ' s'))
    return rows


def memory_rows(repeat: int, plans: int = 300) -> list[Row]:
    """Measure the memory of a planner."""
    return [Row(f'memory of a planner after {plans} plans over that after '
                f'{measures.FIRST_PLANS}', 1.02, measures.memory_growth(plans))]


PARTS: dict[str, Callable[[int], list[Row]]] = {
    'control': control_rows, 'task': task_rows, 'start': start_rows,
    'memory': memory_rows, 'replay': replay_rows}
# The part that has a table of its own.
GROWTH = 'growth'


def table(rows: Sequence[Row]) -> str:
    """
    Write rows as a table in Markdown.

    :param rows: the ``Row`` values.
    """
    return '\n'.join(['| what (median) | aim | measured |', '| --- | --- | --- |',
                      *(row.text() for row in rows)])


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Measure, print the table, and write the page.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status.
    """
    parser = argparse.ArgumentParser(prog='python -m benchmarks.speed', description=DESCRIPTION)
    parser.add_argument('--part', action='append', choices=[*PARTS, GROWTH],
                        help='measure only this; repeat it for several')
    parser.add_argument('--repeat', type=int, default=3, help='runs of each (default: 3)')
    parser.add_argument('--out', type=Path, metavar='DIR',
                        help='folder of the page, such as docs; without it nothing is written')
    options = parser.parse_args(arguments)
    load = f'{os.getloadavg()[0]:.1f}'
    rows: list[Row] = []
    parts = options.part or [GROWTH, *PARTS]
    growing = ''
    for name in parts:
        if name == GROWTH:
            growing = growth.growth_table(options.repeat)
        else:
            rows += PARTS[name](options.repeat)
        print(f'{name}: measured', flush=True)
    load += f' to {os.getloadavg()[0]:.1f}'
    print('\n\n'.join([table(rows), growing]))
    if options.out is not None:
        text = fill_template(TEMPLATE, TABLE=table(rows), LOAD=load, GROWTH=growing)
        (options.out / 'performance.md').write_text(text, encoding='utf-8')
    return 0
