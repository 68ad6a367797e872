"""Growth of costs: a step of the simulator by supports, a task by pushes."""

import math
import time
from typing import NamedTuple

from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_scenario import load_scenario, simulate
from push_sim_node.plant import Plant

SUPPORTS = (3, 4, 8, 15, 30, 60)
# Scenarios by the pushes that they take, and one through doors; chosen: of different lengths.
TASKS = ('task_tap', 'task_demo', 'task_flat')
# Radius of a disc on a ring of supports, and of that ring [m]; chosen: a table.
DISC, RING = 0.4, 0.35
# Pushes that are timed, steps of each and their length [s]; chosen: half a second with 60
# supports.
PUSHES, PUSH_STEPS, STEP = 100, 400, 5e-3
RADIUS = 0.17


class Growth(NamedTuple):
    """
    Cost of something of a size.

    :param what: is done.
    :param size: number of ``unit``.
    :param unit: of the size, such as cases.
    :param seconds: CPU time [s].
    """

    what: str
    size: int
    unit: str
    seconds: float

    def text(self) -> str:
        """Write a row of a table in Markdown."""
        return (f'| {self.what} | {self.unit} | {self.size:,} | {time_text(self.seconds)} | '
                f'{time_text(self.seconds / self.size)} |')


def growth_table(repeat: int) -> str:
    """
    Measure everything, and write a table in Markdown.

    :param repeat: how often steps are timed; the least time counts.
    """
    rows = [*support_rows(repeat), *task_rows()]
    return '\n'.join(['| what | over | size | CPU time | for each |',
                      '| --- | --- | --- | --- | --- |', *(row.text() for row in rows)])


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
    disc = PushedObject(5.0, supports=ring, radius=DISC)
    plants = [Plant(disc, RoundRobot(RADIUS, 'holonomic'), Pose(0.0, 0.0, 0.0),
                    Pose(-DISC - RADIUS, 0.0, 0.0), STEP) for _ in range(PUSHES)]
    start = time.process_time()
    for plant in plants:
        plant.advance(PUSH_STEPS * STEP, Twist(0.2, 0.0, 0.1))
    return (time.process_time() - start) / (PUSHES * PUSH_STEPS)


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
