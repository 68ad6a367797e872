"""Benchmark of plans in maps: what its tasks are, and what its table says."""

from benchmarks.map_plans.benchmark import measure, table
from benchmarks.map_plans.instances import building, nook, passage
from benchmarks.tasks.nooks import FROM, GAPS, NICHES, Nook
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


@pytest.mark.parametrize('name', ['box_04', 'bin'])
@pytest.mark.parametrize('kind', list(Nook))
def test_in_a_nook_the_object_is_as_near_to_walls_as_stated(name, kind):
    """And the robot is clear of them, wherever the map lies; the other end is in the open."""
    for seed in range(4):
        instance = nook(kind, name, 'differential', seed)
        near, far = ((instance.start, instance.goal) if kind in FROM
                     else (instance.goal, instance.start))
        low, high = GAPS
        gap = instance.occupancy_map.object_clearance(instance.obj, [near])
        assert (0.0 if kind in NICHES else low) - 1e-9 <= gap <= high
        far_gap = instance.occupancy_map.object_clearance(instance.obj, [far])
        assert far_gap <= high if kind is Nook.ALONG_WALL else far_gap > 0.3
        assert instance.occupancy_map.robot_is_free(instance.robot, [instance.robot_start], 0.0)


@pytest.mark.slow
@pytest.mark.parametrize('name, kind, seed', [
    ('box_04', Nook.TO_CORNER, 0), ('box_04', Nook.TO_NICHE, 3), ('bin', Nook.TO_CORNER, 8)])
def test_objects_are_pushed_into_corners_and_niches(name, kind, seed):
    """A box whose walls are nearer than half a cell; a disc that has to be turned before it."""
    row = measure('', [nook(kind, name, 'differential', seed)])
    assert row.found == [True]


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
