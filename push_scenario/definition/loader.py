"""
Scenario files: YAML to ``Scenario`` and back.

``object``, ``robot`` and ``sensors`` may name a file of ``config/objects``, ``config/robots`` or
``config/sensors`` (key ``file``) and change parts of it; ``true_object`` and ``true_robot`` hold
only what differs from them. A map may name a file of ``config/maps``.
"""

from pathlib import Path
from typing import Any

from push_model.files.data import share_directory
from push_model.files.mapping import expect_mapping, from_mapping, Location, merge, to_mapping
from push_model.files.strict_yaml import load_yaml, ParameterFileError, parse_yaml
from push_scenario.definition.scenario import Scenario
from push_sim_node.sensors import SensorSettings
import yaml

# Key of the nominal parameters: key of the true ones, folder of the files that both may name.
NOMINAL_KEYS = {'object': ('true_object', 'objects'), 'robot': ('true_robot', 'robots')}


def load_scenario(name: str | Path) -> Scenario:
    """
    Load a scenario by name or path.

    :param name: name of a scenario of the package, such as ``straight_push``, or path of a file.
    :return: the ``Scenario``.
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
    return _scenario(load_yaml(path), path.stem, Location(path), path.parent)


def scenario_from_text(text: str, name: str, source: str = 'scenario') -> Scenario:
    """
    Read a scenario from YAML text, such as ``scenario_text`` writes.

    :param text: the YAML.
    :param name: of the scenario.
    :param source: name of the text in errors.
    :return: the ``Scenario``.
    :raises ParameterFileError: naming the key, what came and what was expected.
    """
    return _scenario(parse_yaml(text, source), name, Location(source), None)


def scenario_text(scenario: Scenario) -> str:
    """
    Write a scenario as YAML: every value spelled out, no file named.

    :param scenario: the ``Scenario``.
    """
    values = {key: value for key, value in to_mapping(scenario).items() if key != 'name'}
    return yaml.safe_dump(values, sort_keys=False, allow_unicode=True, width=99)


def find_scenario(name: str | Path) -> Path:
    """
    Find a scenario by path, or by name among those of the package.

    :param name: path of a file, or name such as ``straight_push``.
    :return: its path.
    :raises ParameterFileError: where there is none, with the names there are.
    """
    path = Path(name)
    if path.suffix in ('.yaml', '.yml') or path.is_file():
        return path
    path = scenario_directory() / f'{name}.yaml'
    if not path.is_file():
        raise ParameterFileError(f'{name}: got no such scenario, expected a path or one of '
                                 + ', '.join(scenario_names()))
    return path


def scenario_names() -> list[str]:
    """List the names of the scenarios of the package, sorted."""
    return sorted(path.stem for path in scenario_directory().glob('*.yaml'))


def scenario_directory() -> Path:
    """Return the folder of the scenarios of the package."""
    return share_directory() / 'config' / 'scenarios'


def read_sensors(path: str | Path) -> SensorSettings:
    """
    Read a file of ``config/sensors``.

    :param path: the file.
    :return: the ``SensorSettings``.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    return from_mapping(SensorSettings, load_yaml(Path(path)), Location(path))


def _scenario(data: dict[str, Any], name: str, at: Location, directory: Path | None) -> Scenario:
    """Make a scenario; ``directory`` is where the files that it names are looked for first."""
    data = dict(data)
    if 'name' in data:
        raise at.key('name').error(f'got {data["name"]!r}, expected no such key: a scenario has '
                                   'the name of its file')
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
        floor_map = _with_file(task['map'], at.key('task').key('map'), 'maps', directory)
        data['task'] = {**task, 'map': floor_map}
    return from_mapping(Scenario, {'name': name, **data}, at)


def _with_file(values: object, at: Location, folder: str,
               directory: Path | None) -> dict[str, Any]:
    """Read the file that a mapping names, if any, and merge the rest of the mapping into it."""
    mapping = expect_mapping(values, at)
    if 'file' not in mapping:
        return mapping
    name = mapping['file']
    if not isinstance(name, str):
        raise at.key('file').error(f'got {name!r}, expected the name of a file')
    candidates = [share_directory() / 'config' / folder / name]
    if directory is not None:
        candidates.insert(0, directory / name)
    for path in candidates:
        if path.is_file():
            changes = {key: value for key, value in mapping.items() if key != 'file'}
            return merge(load_yaml(path), changes, at)
    raise at.key('file').error(f'got {name!r}, expected a file in '
                               + ' or '.join(str(path.parent) for path in candidates))
