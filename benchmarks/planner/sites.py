"""
CPU time of the choice of the contact site by ``choose_site``, with a result and without.

Random goals within 3 m of the 0.4 m box in ``config/objects``, with fixed seeds; NLPs have been
built before. Prints Markdown.
"""

import argparse
import math
import time
from typing import Any

from benchmarks.planner.measure import collect
from benchmarks.planner.tables import table
import numpy as np
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.single_push.site_selection import choose_site

BOX, ORIGIN = 'box_04', Pose(0.0, 0.0, 0.0)
DESCRIPTION = 'CPU time of the choice of the contact site.'
KINDS: dict[str, tuple[str, dict[str, Any]]] = {
    'holonomic': ('holonomic_017', {}),
    'holonomic, fixed yaw': ('holonomic_017', {'robot_yaw': 'fixed'}),
    'differential': ('disc_017', {})}
SEED, WARM_SEED = 2026, 7
SPEEDS = 0.05, 0.15, 0.25


def goals(count: int, seed: int) -> list[tuple[Pose, float]]:
    """Draw (goal, pushing speed)."""
    rng = np.random.default_rng(seed)
    drawn: list[tuple[Pose, float]] = []
    for _ in range(count):
        distance, bearing = rng.uniform(0.2, 3.0), rng.uniform(-math.pi, math.pi)
        drawn.append((Pose(distance * math.cos(bearing), distance * math.sin(bearing),
                           rng.uniform(-math.pi, math.pi)), rng.choice(SPEEDS)))
    return drawn


def measure(kind: str, count: int, seed: int, title: str) -> list[tuple[float, bool]]:
    """Choose a site for each goal; return list of (CPU time [s], whether there is one)."""
    obj = read_object(data.config_file(f'objects/{BOX}.yaml'))
    name, settings = KINDS[kind]
    robot = read_robot(data.config_file(f'robots/{name}.yaml'))

    def choose(drawn: tuple[Pose, float]) -> tuple[float, bool]:
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


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--goals', type=int, default=60, help='of each kind of drive')
    parser.add_argument('--warm', type=int, default=8, help='goals of each before')
    chosen = parser.parse_args()
    rows: list[tuple[Any, ...]] = []
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
