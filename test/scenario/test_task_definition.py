"""What scenario files say about tasks: maps drawn as text, and goals that are given later."""

import dataclasses
import itertools
import math

from helpers.objects import bin_, box
import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_model.files.mapping import from_mapping, Location, to_mapping
from push_model.files.strict_yaml import ParameterFileError
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_scenario.definition.floor_map import FloorMap
from push_scenario.definition.loader import (
    load_scenario, read_scenario, scenario_from_text, scenario_text, with_map,
)
from push_scenario.definition.placement import Placement
from push_scenario.definition.task import Task
import pytest
import yaml


def test_a_drawn_map_has_its_first_row_at_the_top():
    """The origin is the corner with the least x and y, as rotated."""
    origin = Placement(1.0, 2.0, math.pi / 2)
    occupancy_map = FloorMap(0.5, '#..\n...\n', origin).occupancy_map
    clearances = [[occupancy_map.clearance([origin.pose.transform((x, y))])[0]
                   for x in (0.25, 0.75, 1.25)] for y in (0.75, 0.25)]
    assert np.argmin(clearances) == 0
    assert occupancy_map.origin == Pose(1.0, 2.0, math.pi / 2)
    assert occupancy_map.occupied.tolist() == [[False] * 3, [True, False, False]]


@pytest.mark.parametrize('rows', ['', '..\n...', '.x'])
def test_a_map_that_is_no_rectangle_of_cells_is_refused(rows):
    """By name."""
    with pytest.raises(ValueError, match='FloorMap.rows'):
        FloorMap(0.5, rows)


@pytest.mark.parametrize('times', [(5.0, 5.0), (5.0, 4.0), (0.0,)])
def test_later_goals_must_be_later(times):
    """One after the other, each after the start."""
    case = to_mapping(load_scenario('task_new_goal').task)
    goals = [{'time': time, 'goal': {'x': 1.0}} for time in times]
    with pytest.raises(ParameterFileError, match='goals'):
        from_mapping(Task, {**case, 'goals': goals}, Location('case'))


@pytest.mark.parametrize('obj', [box(), bin_()], ids=['box', 'bin'])
def test_bounds_judge_no_heading_that_the_task_leaves_free(obj: PushedObject) -> None:
    """That of a round object by default, and of any where its tolerance is a full circle."""
    scenario = dataclasses.replace(load_scenario('task_tap'), object=obj, true_object=obj)
    for tolerance, disc_heading_free in itertools.product((0.02, math.tau), (True, False)):
        settings = SupervisionSettings(heading_tolerance=tolerance,
                                       disc_heading_free=disc_heading_free)
        is_free = tolerance >= math.pi or (disc_heading_free and not obj.outline)
        bounds = dataclasses.replace(
            scenario, task=Task(supervision=settings)).final_bounds
        assert bounds.position_error == scenario.bounds.position_error
        assert bounds.heading_error == (math.pi if is_free else scenario.bounds.heading_error)
    assert dataclasses.replace(scenario, task=None).final_bounds == scenario.bounds


def test_a_map_of_map_server_is_read_with_a_scenario_and_in_place_of_its_own(tmp_path):
    """Cells, thresholds and origin; what is unknown is free where the scenario says so."""
    (tmp_path / 'floor.pgm').write_bytes(b'P5 3 2 255\n' + bytes([254, 0, 205, 254, 254, 254]))
    (tmp_path / 'floor.yaml').write_text(
        'image: floor.pgm\nresolution: 0.5\norigin: [1.0, 2.0, 0.5]\noccupied_thresh: 0.65\n'
        'free_thresh: 0.196\n')
    text = scenario_text(load_scenario('task_map'))
    values = yaml.safe_load(text)
    for name in ('floor.yaml', {'file': 'floor.yaml'}):
        values['task'].update(map=name, map_reading={'allow_unknown': True})
        (tmp_path / 'case.yaml').write_text(yaml.safe_dump(values))
        task = read_scenario(tmp_path / 'case.yaml').task
        assert task.occupancy_map.occupied.tolist() == [[False] * 3, [False, True, False]]
        assert task.occupancy_map.origin == Pose(1.0, 2.0, 0.5)
    other = with_map(load_scenario('task_map'), tmp_path / 'floor.yaml')
    assert other.task.occupancy_map.occupied.tolist() == [[False] * 3, [False, True, True]]
    again = scenario_from_text(scenario_text(other), other.name)
    assert np.array_equal(again.task.occupancy_map.occupied, other.task.occupancy_map.occupied)
    with pytest.raises(ParameterFileError, match='expected a task'):
        with_map(load_scenario('straight_push'), tmp_path / 'floor.yaml')
