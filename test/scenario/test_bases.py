"""Bases of the package that do not do what they are told, and the scenarios that have them."""

import dataclasses

from push_base.push_force import needed_force
from push_control.goal import TaskFailure
from push_model.files.parameter_files import named_file
from push_model.files.strict_yaml import ParameterFileError
from push_scenario.definition.bases import base_names, read_base, with_base
from push_scenario.definition.loader import load_scenario, read_scenario, scenario_text
from push_scenario.simulation.loop import simulate
from push_sim_node.imperfect_drive import is_ideal
import pytest


@pytest.mark.parametrize('name', base_names())
def test_only_the_true_base_is_another(name):
    """It is not ideal, and nothing else of a scenario changes."""
    scenario = load_scenario('task_tap')
    changed = with_base(scenario, named_file('bases', name))
    assert not is_ideal(changed.true_robot, changed.simulation.drive)
    assert dataclasses.replace(
        changed, true_robot=scenario.true_robot, simulation=scenario.simulation) == scenario


def test_a_scenario_names_a_base_and_changes_parts_of_it(tmp_path):
    """What the scenario states itself goes before what the file does."""
    (tmp_path / 'mine.yaml').write_text(
        'robot: {min_speed: 0.06, dead_time: 0.1}\ndrive: {sag: 0.2, start_ratio: 1.5}\n')
    text = scenario_text(load_scenario('task_tap'))
    assert 'true_robot:' in text and '\nsimulation:' in text
    good = tmp_path / 'good.yaml'
    good.write_text(text)
    nominal = read_scenario(good)
    path = tmp_path / 'case.yaml'
    lines = text.splitlines()
    start = lines.index('true_robot:')
    end = next(i for i in range(start + 1, len(lines)) if not lines[i].startswith(' '))
    lines[start:end] = ['true_robot: {dead_time: 0.2}', 'true_base: mine.yaml']
    start = lines.index('simulation:')
    end = next(i for i in range(start + 1, len(lines)) if not lines[i].startswith(' '))
    lines[start:end] = ['simulation: {drive: {start_ratio: 2.0}}']
    path.write_text('\n'.join(lines))
    scenario = read_scenario(path)
    assert scenario.robot == nominal.robot
    assert scenario.true_robot == dataclasses.replace(nominal.robot, min_speed=0.06, dead_time=0.2)
    assert (scenario.simulation.drive.sag, scenario.simulation.drive.start_ratio) == (0.2, 2.0)


@pytest.mark.parametrize('text, words', [
    ('wheels: 2', 'wheels: got an unknown key, expected robot or drive'),
    ('robot: 3', 'robot: got 3, expected a mapping'),
    ('robot: {min_sped: 0.1}', "robot.min_sped: got an unknown key, expected 'min_speed'"),
    ('drive: {sag: 2}', 'drive.sag: got 2, expected'),
])
def test_what_is_wrong_in_a_file_is_named(tmp_path, text, words):
    """With file and key."""
    path = tmp_path / 'base.yaml'
    path.write_text(text)
    with pytest.raises(ParameterFileError, match=r'base\.yaml') as error:
        with_base(load_scenario('task_tap'), path)
    assert words in str(error.value)


def test_a_carton_needs_more_than_weak_wheels_push_with():
    """As the scenario and the comment of the file say."""
    scenario = load_scenario('task_spinning_wheels')
    force = read_base(named_file('bases', 'weak_wheels'))['robot']['max_push_force']
    assert scenario.true_robot.max_push_force == force < 0.5 * needed_force(scenario.true_object)


@pytest.mark.slow
def test_spinning_wheels_are_named_within_seconds_of_the_first_touch():
    """The object is called too heavy, and it does hardly move."""
    result = simulate(load_scenario('task_spinning_wheels'), planning_time=0.0)
    assert result.status.failure is TaskFailure.TOO_HEAVY
    touch = result.tape['time'][result.tape['gap'] < 1e-4][0]
    assert result.duration < touch + 10.0
