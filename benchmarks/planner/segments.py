"""Computation time over the number of pushing angles, the planner beside single shooting."""

import statistics
import time
from typing import Callable

from benchmarks.planner.measure import whole_plan
from benchmarks.planner.shooting import shoot
from push_study import catalogue
from push_study.chapter3.setup import push_problem
from push_study.framework.parameters import read_chosen_values

COUNTS = (2, 3, 4, 6, 8, 12, 24)
# Single shooting takes ten seconds and more beyond.
MOST_SHOT = 8
REFERENCE = 6
REPETITIONS = 5


def cpu_time(function: Callable[[], object], repetitions: int) -> float:
    """
    Measure the CPU time of a call, after a first one that builds what is kept.

    :param function: to call.
    :param repetitions: of which the median counts.
    :return: time [s].
    """
    times: list[float] = []
    for _ in range(repetitions):
        begin = time.process_time()
        function()
        times.append(time.process_time() - begin)
    return statistics.median(times)


def main() -> None:
    """Print the table of table 3.1 as Markdown, in seconds and relative to six segments."""
    study, = catalogue.select(['T3.1'])
    values = study.values(read_chosen_values())
    rows: dict[int, list[tuple[float, float | None]]] = {}
    for count in COUNTS:
        rows[count] = []
        for goal in (values.goal, values.asymmetrical_goal):
            problem = push_problem(values, values.speed, count, goal=goal)
            whole_plan(problem)
            planned = cpu_time(lambda: whole_plan(problem), REPETITIONS)
            shot = (cpu_time(lambda: shoot(problem, count), 1) if count <= MOST_SHOT else None)
            rows[count].append((planned, shot))
    print('| segments | symmetrical: planner s (relative) | single shooting s (relative) | '
          'asymmetrical: planner s (relative) | single shooting s (relative) |')
    print('| --- | --- | --- | --- | --- |')
    for count in COUNTS:
        cells = [_cell(rows[count][goal][kind], rows[REFERENCE][goal][kind])
                 for goal in (0, 1) for kind in (0, 1)]
        print(f'| {count} | {" | ".join(cells)} |')


def _cell(seconds: float | None, reference: float | None) -> str:
    if seconds is None or reference is None:
        return '-'
    return f'{seconds:.3f} ({seconds / reference:.2f})'


if __name__ == '__main__':
    main()
