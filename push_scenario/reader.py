"""
Scenario files: YAML to ``Scenario`` and back.

``object`` and ``robot`` may name a file of ``config/objects`` or ``config/robots`` (key ``file``)
and change parts of it; ``truth`` and ``robot_truth`` hold only what differs from the belief. A map
may name a file of ``config/maps``.
"""

from pathlib import Path

from push_model.parameters import PushedObject, RoundRobot
from push_scenario.builder import build, expect_mapping, merge, plain
from push_scenario.data import share_directory
from push_scenario.scenario import Scenario
from push_scenario.strict_yaml import load, parse, ScenarioError
import yaml

BELIEFS = {'object': ('truth', 'objects'), 'robot': ('robot_truth', 'robots')}


def read_scenario(path):
    """
    Read a scenario file.

    :param path: the file.
    :return: the ``Scenario``; its name is that of the file.
    :raises ScenarioError: naming file and key, what came and what was expected.
    """
    path = Path(path)
    return _scenario(load(path), path.stem, path, path.parent)


def scenario_from_text(text, name, source='scenario'):
    """
    Read a scenario from YAML text, such as ``scenario_text`` writes.

    :param text: the YAML.
    :param name: of the scenario.
    :param source: what errors call the text.
    :raises ScenarioError: naming the key, what came and what was expected.
    """
    return _scenario(parse(text, source), name, source, None)


def scenario_text(scenario):
    """
    Write a scenario as YAML: every value spelled out, no file named.

    :param scenario: the ``Scenario``.
    """
    values = {key: value for key, value in plain(scenario).items() if key != 'name'}
    return yaml.safe_dump(values, sort_keys=False, allow_unicode=True, width=99)


def find_scenario(name):
    """
    Find a scenario by path, or by name among those that come with the package.

    :param name: path of a file, or name such as ``straight_push``.
    :return: its path.
    :raises ScenarioError: where there is none, with the names there are.
    """
    path = Path(name)
    if path.suffix in ('.yaml', '.yml') or path.is_file():
        return path
    path = scenario_directory() / f'{name}.yaml'
    if not path.is_file():
        raise ScenarioError(f'{name}: got no such scenario, expected a path or one of '
                            + ', '.join(scenario_names()))
    return path


def scenario_names():
    """Names of the scenarios that come with the package, sorted."""
    return sorted(path.stem for path in scenario_directory().glob('*.yaml'))


def scenario_directory():
    """Folder of the scenarios that come with the package."""
    return Path(share_directory()) / 'config' / 'scenarios'


def read_object(path):
    """
    Read an object file.

    :param path: the file.
    :return: the ``PushedObject``.
    :raises ScenarioError: naming file and key, what came and what was expected.
    """
    return build(PushedObject, load(Path(path)), path)


def read_robot(path):
    """
    Read a robot file.

    :param path: the file.
    :return: the ``RoundRobot``.
    :raises ScenarioError: naming file and key, what came and what was expected.
    """
    return build(RoundRobot, load(Path(path)), path)


def _scenario(data, name, source, directory):
    data = dict(data)
    if 'name' in data:
        raise ScenarioError(f'{source}: name: got {data["name"]!r}, expected no such key: a '
                            'scenario has the name of its file')
    for key, (truth, folder) in BELIEFS.items():
        if key not in data:
            continue
        believed = _with_file(data[key], source, key, folder, directory)
        changes = data.get(truth, {})
        expect_mapping(changes, source, truth)
        data[key], data[truth] = believed, merge(believed, changes, source, truth)
    task = data.get('task')
    if isinstance(task, dict) and 'map' in task:
        data['task'] = {**task, 'map': _with_file(task['map'], source, 'task.map', 'maps',
                                                  directory)}
    return build(Scenario, {'name': name, **data}, source)


def _with_file(value, source, key, folder, directory):
    expect_mapping(value, source, key)
    if 'file' not in value:
        return value
    name = value['file']
    if not isinstance(name, str):
        raise ScenarioError(f'{source}: {key}.file: got {name!r}, expected the name of a file')
    places = [Path(share_directory()) / 'config' / folder / name]
    if directory is not None:
        places.insert(0, directory / name)
    for place in places:
        if place.is_file():
            changes = {k: v for k, v in value.items() if k != 'file'}
            return merge(load(place), changes, source, key)
    raise ScenarioError(f'{source}: {key}.file: got {name!r}, expected a file in '
                        + ' or '.join(str(place.parent) for place in places))
