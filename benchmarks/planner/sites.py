"""
The choice of the contact site measured: CPU time of ``choose_site``.

That of telling that no site reaches a goal as well.

Random goals within 3 m of the 0.4 m box in ``config/objects``, seeds fixed; the programmes have
been built before. Prints Markdown.
"""

import argparse
import math
import time

from benchmarks.planner.measure import collect
from benchmarks.planner.tables import table
import numpy as np
from push_model.geometry import Pose
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.single_push.site_selection import choose_site
from push_scenario.definition import data
from push_scenario.definition.loader import read_object, read_robot

BOX, ORIGIN = 'box_04', Pose(0.0, 0.0, 0.0)
KINDS = {'holonomic': ('holonomic_017', {}),
         'holonomic, does not turn': ('holonomic_017', {'robot_yaw': 'fixed'}),
         'differential': ('disc_017', {})}
SEED, WARM_SEED = 2026, 7
SPEEDS = 0.05, 0.15, 0.25


def goals(count, seed):
    """Draw (goal, pushing speed)."""
    rng = np.random.default_rng(seed)
    drawn = []
    for _ in range(count):
        distance, bearing = rng.uniform(0.2, 3.0), rng.uniform(-math.pi, math.pi)
        drawn.append((Pose(distance * math.cos(bearing), distance * math.sin(bearing),
                           rng.uniform(-math.pi, math.pi)), rng.choice(SPEEDS)))
    return drawn


def measure(kind, count, seed, title):
    """Choose a site for each goal; return list of (CPU time [s], whether there is one)."""
    obj = read_object(data.config_file(f'objects/{BOX}.yaml'))
    name, settings = KINDS[kind]
    robot = read_robot(data.config_file(f'robots/{name}.yaml'))

    def choose(drawn):
        goal, speed = drawn
        began = time.process_time()
        try:
            choose_site(obj, robot, ORIGIN, goal,
                        PlannerSettings(pushing_speed=float(speed), **settings))
            found = True
        except PlanningFailed:
            found = False
        return time.process_time() - began, found
    return collect(goals(count, seed), title, choose)


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--goals', type=int, default=60, help='of each kind of drive')
    parser.add_argument('--warm', type=int, default=8, help='goals of each before')
    chosen = parser.parse_args()
    rows = []
    for kind in KINDS:
        measure(kind, chosen.warm, WARM_SEED, f'{kind}, to warm up')
        found = measure(kind, chosen.goals, SEED, kind)
        for name, times in (('a site', [cpu for cpu, done in found if done]),
                            ('none', [cpu for cpu, done in found if not done])):
            if times:
                rows.append((kind, name, len(times), *(f'{value:.2f}' for value in (
                    np.median(times), np.percentile(times, 95), max(times)))))
    print(table(['drive', 'answer', 'goals', 'CPU s, median', 'p95', 'max'], rows))


if __name__ == '__main__':
    main()
