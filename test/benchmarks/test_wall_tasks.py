"""Tasks at walls: how near to them, and how presses are counted."""

from types import SimpleNamespace

from benchmarks.tasks.cases import CELLS, draw, WALLS
from benchmarks.tasks.groups import Group
from benchmarks.tasks.nooks import GAPS, NICHES, Nook, POSSIBLE
from benchmarks.tasks.tables import wall_table
from benchmarks.tasks.wall_contact import longest, PRESSED_RATIO, wall_record
from helpers.objects import box
import numpy as np
from push_base.push_force import needed_force
import pytest


@pytest.mark.parametrize('seed', range(len(POSSIBLE)))
def test_object_or_goal_is_at_a_wall_of_the_map(seed):
    """Within the stated gap, whatever the cells; niches leave more on either side."""
    case = draw(WALLS, 'box_04, holonomic', seed)
    scenario = case.scenario
    floor = scenario.task.map.occupancy_map
    gaps = [floor.object_clearance(scenario.true_object, [placement.pose])
            for placement in (scenario.start.object, scenario.goal)]
    assert case.variety == POSSIBLE[seed].value
    assert floor.resolution in CELLS
    assert -1e-9 <= min(gaps) <= GAPS[1]
    assert (max(gaps) <= GAPS[1]) == (POSSIBLE[seed] is Nook.ALONG_WALL)
    assert POSSIBLE[seed] not in NICHES or POSSIBLE[seed] is Nook.TO_NICHE


def test_the_longest_stretch_counts():
    """Not the sum of several; the rows may be at any times."""
    time = np.array([0.0, 0.1, 0.3, 0.6, 1.0, 1.5])
    assert longest(time, np.array([1, 1, 0, 1, 1, 0], dtype=bool)) == pytest.approx(0.9)
    assert longest(time, np.zeros(6, dtype=bool)) == 0.0


def test_only_what_exceeds_the_force_of_a_push_is_a_press():
    """By twice; a force across the axes counts as one along them."""
    force = PRESSED_RATIO * needed_force(box())
    columns = ('time', 'wall_force_x', 'wall_force_y', 'wall_depth', 'robot_at_wall')
    for ratio, expected in ((0.99, 0.0), (1.01, 0.1)):
        row = (ratio * 0.6 * force, ratio * 0.8 * force, 1e-4, 1.0)
        tape = SimpleNamespace(columns=columns, rows=np.array([
            (0.0, *row), (0.1, 0.0, 0.0, 0.0, 0.0), (0.2, 0.0, 0.0, 0.0, 0.0)]))
        record = wall_record(tape, box())
        assert record == pytest.approx({
            'wall_force': ratio * force, 'pressed': expected, 'wall_depth': 1e-4,
            'robot_at_wall': 0.1})
        line = wall_table([Group(WALLS, 'all', [({}, {'success': True, **record})])])
        assert f'| all | 1 | 0.1 | {int(expected > 0.0)} |' in line
