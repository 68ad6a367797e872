"""
Scenario files: YAML to ``Scenario`` and back.

``object``, ``robot`` and ``sensors`` may name a file of ``config/objects``, ``config/robots`` or
``config/sensors`` (key ``file``) and change parts of it; ``true_object`` and ``true_robot`` hold
only what differs from them. ``true_base`` names a file of ``config/bases``, which holds parts of
``true_robot`` and of ``simulation.drive``. A map may name a file of ``config/maps``, or one of
``nav2_map_server``.
"""

import dataclasses
from pathlib import Path
from typing import Any, cast

from push_model.files.data import share_directory
from push_model.files.mapping import expect_mapping, from_mapping, Location, merge, to_mapping
from push_model.files.strict_yaml import load_yaml, ParameterFileError, parse_yaml
from push_navigation.map_file import read_map
from push_navigation.settings import MapSettings
from push_scenario.definition.bases import FOLDER, read_base
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.floor_map import floor_map_values, FloorMap
from push_scenario.definition.scenario import Scenario
from push_sim_node.sensors import SensorSettings
import yaml

# Key of the nominal parameters: key of the true ones, folder of the files that both may name.
NOMINAL_KEYS = {'object': ('true_object', 'objects'), 'robot': ('true_robot', 'robots')}


def load_scenario(name: str | Path) -> Scenario:
    """
    Load a scenario by name or path.

    :param name: name of a scenario of the package, such as ``straight_push``, or path of a file.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    return read_scenario(find_scenario(name))


def read_scenario(path: str | Path) -> Scenario:
    """
    Read a scenario file.

    :param path: the file.
    :return: the ``Scenario``; its name is that of the file.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    path = Path(path)
    return scenario_from_mapping(load_yaml(path), path.stem, Location(path), path.parent)


def scenario_from_text(text: str, name: str, source: str = 'scenario') -> Scenario:
    """
    Read a scenario from YAML text, such as ``scenario_text`` writes.

    :param text: the YAML.
    :param name: of the scenario.
    :param source: name of the text in errors.
    :raises ParameterFileError: naming the key, what came and what was expected.
    """
    return scenario_from_mapping(parse_yaml(text, source), name, Location(source), None)


def scenario_text(scenario: Scenario) -> str:
    """Write a scenario as YAML: every value spelled out, no file named."""
    values = {key: value for key, value in to_mapping(scenario).items() if key != 'name'}
    return yaml.safe_dump(values, sort_keys=False, allow_unicode=True, width=99)


def read_sensors(path: str | Path) -> SensorSettings:
    """
    Read a file of ``config/sensors``.

    :param path: the file.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    return from_mapping(SensorSettings, load_yaml(Path(path)), Location(path))


def with_map(scenario: Scenario, path: str | Path) -> Scenario:
    """
    Let a task be done in another map.

    :param path: map file, drawn in characters or of ``nav2_map_server``.
    :raises ParameterFileError: naming what is wrong.
    """
    task, at = scenario.task, Location(path)
    if task is None:
        raise ParameterFileError(f'{scenario.name}: got a map for a single push, expected a task')
    values = map_file_values(Path(path), to_mapping(task.map_reading), at)
    floor_map = from_mapping(FloorMap, values, at)
    return dataclasses.replace(scenario, task=dataclasses.replace(task, map=floor_map))


def scenario_from_mapping(data: dict[str, Any], name: str, at: Location,
                          directory: Path | None) -> Scenario:
    """
    Make a scenario of the mapping that a file holds.

    :param name: of the scenario.
    :param at: where the mapping stands, for errors.
    :param directory: where the files that it names are looked for first; None for the package.
    :raises ParameterFileError: naming the key, what came and what was expected.
    """
    data = dict(data)
    if 'name' in data:
        raise at.key('name').error(f'got {data["name"]!r}, expected no such key: a scenario has '
                                   'the name of its file')
    if 'true_base' in data:
        data = _with_true_base(data, at, directory)
    for key, (true_key, folder) in NOMINAL_KEYS.items():
        if key not in data:
            continue
        nominal = _with_file(data[key], at.key(key), folder, directory)
        changes = expect_mapping(data.get(true_key, {}), at.key(true_key))
        data[key], data[true_key] = nominal, merge(nominal, changes, at.key(true_key))
    if 'sensors' in data:
        data['sensors'] = _with_file(data['sensors'], at.key('sensors'), 'sensors', directory)
    task = data.get('task')
    if isinstance(task, dict) and 'map' in task:
        data['task'] = {**task, 'map': _floor_map(cast(dict[str, Any], task), at.key('task'),
                                                  directory)}
    return from_mapping(Scenario, {'name': name, **data}, at)


def _with_true_base(data: dict[str, Any], at: Location, directory: Path | None) -> dict[str, Any]:
    """Merge the base that a scenario names into its true robot and the simulated drive."""
    scenario_data = {key: value for key, value in data.items() if key != 'true_base'}
    path = _file(data['true_base'], at.key('true_base'), FOLDER, directory)
    base = read_base(path)
    true_robot = expect_mapping(scenario_data.get('true_robot', {}), at.key('true_robot'))
    simulation = expect_mapping(scenario_data.get('simulation', {}), at.key('simulation'))
    return {**scenario_data, 'true_robot': merge(base['robot'], true_robot, at.key('true_robot')),
            'simulation': merge({'drive': base['drive']}, simulation, at.key('simulation'))}


def _floor_map(task: dict[str, Any], at: Location, directory: Path | None) -> dict[str, Any]:
    """Read the map of a task; one that is a text names a file."""
    values, at = task['map'], at.key('map')
    if isinstance(values, str):
        values = {'file': values}
    if isinstance(values, dict) and set(cast(dict[str, Any], values)) == {'file'}:
        path = _file(cast(dict[str, Any], values)['file'], at.key('file'), 'maps', directory)
        return map_file_values(path, task.get('map_reading'), at)
    return _with_file(values, at, 'maps', directory)


def map_file_values(path: Path, reading: object, at: Location) -> dict[str, Any]:
    """
    Read a map file as the mapping that a scenario holds.

    :param path: the file, drawn in characters or of ``nav2_map_server``.
    :param reading: mapping of ``MapSettings``, or None for the defaults.
    :param at: where the file is named.
    :raises ParameterFileError: naming file and field, what came and what was expected.
    """
    values = load_yaml(path)
    if 'image' not in values:
        return values
    settings = from_mapping(MapSettings, reading or {}, at)
    return floor_map_values(read_map(path), settings.lethal_cost_threshold)


def _with_file(values: object, at: Location, folder: str,
               directory: Path | None) -> dict[str, Any]:
    """Read the file that a mapping names, if any, and merge the rest of the mapping into it."""
    mapping = expect_mapping(values, at)
    if 'file' not in mapping:
        return mapping
    path = _file(mapping['file'], at.key('file'), folder, directory)
    changes = {key: value for key, value in mapping.items() if key != 'file'}
    return merge(load_yaml(path), changes, at)


def _file(name: object, at: Location, folder: str, directory: Path | None) -> Path:
    """Find a file that is named, beside the scenario or in a folder of the package."""
    if not isinstance(name, str):
        raise at.error(f'got {name!r}, expected the name of a file')
    candidates = [share_directory() / 'config' / folder / name]
    if directory is not None:
        candidates.insert(0, directory / name)
    for path in candidates:
        if path.is_file():
            return path
    there = sorted(path.name for path in candidates[-1].parent.iterdir())
    raise at.error(f'got {name!r}, expected a file in '
                   + ' or '.join(str(path.parent) for path in candidates)
                   + f', where there are {", ".join(there)}')
