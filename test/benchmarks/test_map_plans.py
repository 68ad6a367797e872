"""Benchmark of plans in maps: what its tasks are, and what its table says."""

from benchmarks.map_plans.benchmark import measure, table
from benchmarks.map_plans.instances import building, passage
import numpy as np
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
import pytest


@pytest.mark.parametrize('ratio', [1.1, 2.0])
def test_a_passage_has_its_width_and_is_the_only_one(ratio):
    """As a multiple of the narrow side of the object, to rounding; start and goal lie apart."""
    instance = passage('carton', 'differential', ratio, 3)
    cells, resolution = instance.occupancy_map.occupied, instance.occupancy_map.resolution
    free = ~cells[:, cells.shape[1] // 2]
    assert free.sum() * resolution == pytest.approx(0.4 * ratio)
    assert np.flatnonzero(np.diff(free)).size == 2
    middle = 0.5 * cells.shape[1] * resolution
    assert instance.start.x < middle < instance.goal.x
    assert passage('carton', 'differential', ratio, 3).start == instance.start


def test_a_building_has_as_many_rooms_as_fit():
    """In the middle of its map; object and robot stand clear in the first."""
    instance = building('box_04', 'holonomic', 400, 3, 1)
    assert instance.occupancy_map.occupied.shape == (400, 400)
    assert instance.goal.x - instance.start.x > 4.0
    assert instance.occupancy_map.robot_is_free(instance.robot, [instance.robot_start], 0.02)


def test_a_task_is_counted_whether_it_has_a_plan_or_not():
    """The first pushes of one, and the refusal of one whose goal lies in a wall."""
    instance = passage('box_04', 'differential', 3.0, 0)
    walled = instance._replace(goal=Pose(0.0, 0.0, 0.0))
    row = measure('both', [instance, walled])
    assert row.found == [True, False] and len(row.pushes) == 1
    assert '1 of 2' in table([row])
    assert isinstance(instance.scenario.task.occupancy_map, OccupancyMap)
    assert np.array_equal(instance.scenario.task.occupancy_map.occupied,
                          instance.occupancy_map.occupied)
