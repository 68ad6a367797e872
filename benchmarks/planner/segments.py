"""Computation time of a plan over the number of its pushing angles."""

import statistics
import time

from benchmarks.planner.measure import whole_plan
from push_planner.problem import PushProblem
from studies import catalogue
from studies.chapter3.setup import push_problem
from studies.framework.parameters import read_chosen_values

COUNTS = (2, 3, 4, 6, 8, 12, 24)
REFERENCE = 6
REPETITIONS = 5


def cpu_time(problem: PushProblem) -> float:
    """
    Measure the CPU time of a plan, after a first one that builds what is cached.

    :param problem: to plan for.
    :return: median time [s].
    """
    whole_plan(problem)
    times: list[float] = []
    for _ in range(REPETITIONS):
        start = time.process_time()
        whole_plan(problem)
        times.append(time.process_time() - start)
    return statistics.median(times)


def main() -> None:
    """Print the table of table 3.1 as Markdown, in seconds and relative to six segments."""
    study, = catalogue.select(['T3.1'])
    values = study.values(read_chosen_values())
    goals = values.goal, values.asymmetrical_goal
    times = {count: [cpu_time(push_problem(values, values.speed, count, goal=goal))
                     for goal in goals] for count in COUNTS}
    print('| segments | symmetrical: s (relative) | asymmetrical: s (relative) |')
    print('| --- | --- | --- |')
    for count in COUNTS:
        cells = [f'{seconds:.3f} ({seconds / reference:.2f})'
                 for seconds, reference in zip(times[count], times[REFERENCE])]
        print(f'| {count} | {" | ".join(cells)} |')


if __name__ == '__main__':
    main()
