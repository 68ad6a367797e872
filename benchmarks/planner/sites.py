"""
CPU time of the choice of the contact site by ``choose_site``, with a result and without.

Random goals within 3 m of the 0.4 m box in ``config/objects``, with fixed seeds; NLPs have been
built before. Prints Markdown.
"""

import argparse
import math
import time
from typing import Any, NamedTuple

from benchmarks.planner.measure import collect
from benchmarks.planner.tables import site_table
import numpy as np
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.parameters import PushedObject, Support
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.steered.site_selection import choose_site

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


class Choice(NamedTuple):
    """
    Choice of a site.

    :param cpu: CPU time [s].
    :param is_found: whether there is one.
    :param faces: number of faces of the object.
    """

    cpu: float
    is_found: bool
    faces: int


def polygon(faces: int) -> PushedObject:
    """Return a regular object on a foot at each corner, about as large as the box."""
    corners = tuple((0.28 * math.cos(angle), 0.28 * math.sin(angle))
                    for angle in 2.0 * math.pi * np.arange(faces) / faces)
    return PushedObject(2.0, supports=tuple(Support(x, y, 0.3) for x, y in corners),
                        outline=corners)


def choices(kind: str, count: int, warm: int, faces: int = 4) -> list[Choice]:
    """Choose sites for random goals, after some others so that every program has been built."""
    measure(kind, warm, WARM_SEED, f'sites, {kind}, to warm up', faces)
    return measure(kind, count, SEED, f'sites, {kind}, {faces} faces', faces)


def measure(kind: str, count: int, seed: int, title: str, faces: int = 4) -> list[Choice]:
    """Choose a site for each goal."""
    obj = read_object(data.config_file(f'objects/{BOX}.yaml')) if faces == 4 else polygon(faces)
    name, settings = KINDS[kind]
    robot = read_robot(data.config_file(f'robots/{name}.yaml'))

    def choose(drawn: tuple[Pose, float]) -> Choice:
        goal, speed = drawn
        began = time.process_time()
        try:
            # Its report counts, as it does of a plan.
            chosen = choose_site(obj, robot, ORIGIN, goal,
                                 PlannerSettings(pushing_speed=float(speed), **settings))
            _ = chosen.plan.report
            is_found = True
        except PlanningFailed:
            is_found = False
        return Choice(time.process_time() - began, is_found, faces)
    return collect(goals(count, seed), title, choose)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--goals', type=int, default=60, help='of each kind of drive')
    parser.add_argument('--warm', type=int, default=8, help='goals of each before')
    chosen = parser.parse_args()
    print(site_table({kind: choices(kind, chosen.goals, chosen.warm) for kind in KINDS}))


if __name__ == '__main__':
    main()
