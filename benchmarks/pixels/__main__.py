"""
Run tasks from pixels to wheels, and report how they end.

``python -m benchmarks.pixels [--count 5]`` runs so many tasks for each view, and prints a table.
"""

import argparse
import statistics
import sys
from typing import Sequence

from benchmarks.pixels.cases import Ending, run_task, TOLERANCES, View, VIEWS
from push_scenario.simulation.result import Outcome
from tqdm import tqdm

HEADER = ('| camera | tolerance | within it, truly | done, but not within | distance to the goal: '
          'median, greatest | time, median |\n| --- | --- | --- | --- | --- | --- |')
DESCRIPTIONS: dict[View, str] = {
    'robot': 'on the robot; its place by the ticks of its wheels and a gyro',
    'located_robot': 'on the robot; its place known to 1 mm and 0.1 degrees',
    'room': 'in the room, 1.6 m above the floor'}


def row(view: View, endings: Sequence[Ending]) -> str:
    """
    Write the row of a view.

    :param view: one of ``VIEWS``.
    :param endings: of its tasks.
    """
    tolerance, count = TOLERANCES[view], len(endings)
    within = sum(ending.is_within for ending in endings)
    done = [ending for ending in endings if ending.outcome is Outcome.DONE]
    wrong = sum(not ending.is_within for ending in done)
    errors = sorted(1e3 * ending.position_error for ending in endings)
    return (f'| {DESCRIPTIONS[view]} | {1e3 * tolerance.position:.0f} mm | {within} of {count} | '
            f'{wrong} | {statistics.median(errors):.1f}, {errors[-1]:.1f} mm | '
            f'{statistics.median(ending.time for ending in endings):.0f} s |')


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the benchmark.

    :param arguments: words behind the command's name; None for those of the process.
    """
    parser = argparse.ArgumentParser(prog='benchmarks.pixels')
    parser.add_argument('--count', type=int, default=5, help='tasks for each view (default: 5)')
    count = parser.parse_args(arguments).count
    rows = [row(view, [run_task(view, seed) for seed in tqdm(range(count), desc=view)])
            for view in VIEWS]
    print('\n'.join((HEADER, *rows)))
    return 0


if __name__ == '__main__':
    sys.exit(main())
