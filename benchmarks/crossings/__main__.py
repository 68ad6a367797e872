"""
Walk up to a robot with a lidar, and count touches, stops and tasks that are done.

Then drive as many tasks with nobody about, in which each stop is a false one.
"""

import argparse
from collections.abc import Sequence
import sys

from benchmarks.crossings.crossings import Crossing, MAX_TOUCH_SPEED, run
from push_scenario.simulation.result import Outcome


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Print the counts.

    :param arguments: command line; None for that of the process.
    :return: exit status: 1 where somebody was touched faster than allowed, or stopped for nothing.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--crossings', type=int, default=200)
    parser.add_argument('--tasks', type=int, default=30)
    parser.add_argument('--first-seed', type=int, default=1, help='of the tasks with crossings')
    parser.add_argument('--unprotected', action='store_true')
    parser.add_argument('--scenario', default='task_lidar')
    options = parser.parse_args(arguments)
    is_protected = not options.unprotected
    crossings: list[Crossing] = []
    count = done = 0
    while len(crossings) < options.crossings:
        result, walker = run(options.first_seed + count, is_protected=is_protected,
                             scenario_name=options.scenario)
        count += 1
        crossings += walker.crossings
        done += result.outcome is Outcome.DONE
    touches = [crossing for crossing in crossings if crossing.gap <= 0.0]
    fast = [crossing for crossing in touches if crossing.robot_speed > MAX_TOUCH_SPEED]
    print(f'crossings: {len(crossings)}, touches: {len(touches)}, faster than '
          f'{MAX_TOUCH_SPEED:g} m/s: {len(fast)}, at most '
          f'{max((crossing.robot_speed for crossing in touches), default=0.0):.3f} m/s; '
          f'done: {done} of {count} tasks', flush=True)
    stops = done = 0
    for seed in range(1, options.tasks + 1):
        result, walker = run(seed, walks=False, is_protected=is_protected,
                             scenario_name=options.scenario)
        stops += walker.stops
        done += result.outcome is Outcome.DONE
    print(f'nobody about: {stops} stops in {options.tasks} tasks, {done} done')
    return 1 if fast or stops else 0


if __name__ == '__main__':
    sys.exit(main())
