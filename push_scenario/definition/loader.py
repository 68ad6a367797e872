"""
Scenario files: YAML to ``Scenario`` and back.

``object`` and ``robot`` may name a file of ``config/objects`` or ``config/robots`` (key ``file``)
and change parts of it; ``true_object`` and ``true_robot`` hold only what differs from them. A map
may name a file of ``config/maps``.
"""

import dataclasses
import difflib
import math
from pathlib import Path
import re
import types
import typing

from push_model.parameters import PushedObject, RoundRobot
from push_model.quantity import expectation, field_types
from push_scenario.definition.data import share_directory
from push_scenario.definition.scenario import Scenario
import yaml

EXPONENT_NUMBER = re.compile(r'^[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)[eE][-+]?[0-9]+$')


class ScenarioError(ValueError):
    """What is wrong with a file: names the file, the key, what came and what was expected."""


def load(path):
    """
    Read a YAML file whose top level is a mapping.

    :param path: the file, a ``pathlib.Path``.
    :return: the mapping, of plain Python values.
    :raises ScenarioError: where the file is missing, is not YAML, or repeats a key.
    """
    try:
        text = path.read_text(encoding='utf-8')
    except OSError as error:
        raise ScenarioError(f'{path}: {error.strerror}, expected a readable file') from error
    except UnicodeDecodeError as error:
        raise ScenarioError(f'{path}: got bytes that are not UTF-8, expected text') from error
    return parse(text, path)


def parse(text, source):
    """
    Read YAML text whose top level is a mapping.

    :param text: the YAML.
    :param source: what errors call the text, such as its path.
    :raises ScenarioError: where it is not YAML, repeats a key, or is no mapping.
    """
    try:
        data = yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, 'problem_mark', None)
        line = f':{mark.line + 1}' if mark else ''
        problem = getattr(error, 'problem', None) or str(error)
        raise ScenarioError(f'{source}{line}: {problem}') from error
    if not isinstance(data, dict):
        raise ScenarioError(f'{source}: got {_kind(data)}, expected a mapping of keys to values')
    return data


class _Loader(yaml.SafeLoader):
    """The safe loader, made to refuse repeated keys and to read 1e-3 as a number."""

    def construct_mapping(self, node, deep=False):
        """
        Build a mapping, refusing a key that is there twice.

        :param node: the YAML node.
        :param deep: as in PyYAML.
        """
        seen = set()
        for key, _ in node.value:
            if key.tag == 'tag:yaml.org,2002:merge':
                continue
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem='got a key that is no word, expected a name',
                                           problem_mark=key.start_mark)
            if key.value in seen:
                raise yaml.MarkedYAMLError(problem=f'got the key {key.value!r} twice, expected '
                                           'it once', problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver('tag:yaml.org,2002:float', EXPONENT_NUMBER,
                              list('-+.0123456789'))


def _kind(value):
    return 'nothing' if value is None else f'{type(value).__name__} {value!r}'


DEGREES = '_deg'
RADIANS = ('rad', 'rad/s')


def build(cls, mapping, source, path=''):
    """
    Make a parameter dataclass of a mapping, strictly.

    A field in radians may also be given in degrees, under its name with ``_deg`` behind.

    :param cls: the dataclass.
    :param mapping: keys to values, as YAML gives them.
    :param source: what errors call the file.
    :param path: key path of the mapping in the file, empty at its top.
    :raises ScenarioError: naming file and key, what came and what was expected.
    """
    expect_mapping(mapping, source, path)
    hints = field_types(cls)
    fields = {field.name: field for field in dataclasses.fields(cls) if field.init}
    mapping = _in_radians(mapping, fields, source, path)
    refuse_unknown(mapping, fields, source, path)
    values = {}
    for name, field in fields.items():
        if name in mapping:
            values[name] = _value(hints[name], mapping[name], source, join(path, name))
        elif _is_required(field):
            raise ScenarioError(f'{source}: {join(path, name)}: got nothing, expected '
                                + _expected(hints[name], field))
    try:
        return cls(**values)
    except ValueError as error:
        raise ScenarioError(f'{source}: {_with_path(str(error), cls, path)}') from error


def plain(instance):
    """
    Turn a parameter dataclass into plain lists and mappings, as ``build`` reads them.

    :param instance: the dataclass instance; fields that are None are left out.
    """
    if dataclasses.is_dataclass(instance):
        values = {field.name: getattr(instance, field.name)
                  for field in dataclasses.fields(instance) if field.init}
        return {name: plain(value) for name, value in values.items() if value is not None}
    if isinstance(instance, tuple):
        return [plain(item) for item in instance]
    return instance


def merge(base, changes, source, path):
    """
    Lay changes over plain values: mappings key by key, lists of mappings item by item.

    :param base: what is changed; it stays as it is.
    :param changes: new values, of any part of ``base``.
    :param source: what errors call the file.
    :param path: key path of the changes.
    :raises ScenarioError: where a list of mappings has another length than the list it changes.
    """
    if isinstance(base, dict) and isinstance(changes, dict):
        merged = dict(base)
        for key, change in changes.items():
            known = key in base
            merged[key] = merge(base[key], change, source, join(path, key)) if known else change
        return merged
    if _are_mappings(base) and _are_mappings(changes):
        if len(base) != len(changes):
            raise ScenarioError(f'{source}: {path}: got {len(changes)} items, expected '
                                f'{len(base)}, one for each that is changed')
        return [merge(item, change, source, f'{path}[{i}]')
                for i, (item, change) in enumerate(zip(base, changes))]
    return changes


def join(path, key):
    """
    Join a key to a key path.

    :param path: the path, empty at the top.
    :param key: the key.
    """
    return f'{path}.{key}' if path else str(key)


def expect_mapping(value, source, path):
    """
    Refuse what is no mapping.

    :param value: what came.
    :param source: what errors call the file.
    :param path: its key path.
    :raises ScenarioError: naming both.
    """
    if not isinstance(value, dict):
        where = f'{path}: ' if path else ''
        raise ScenarioError(f'{source}: {where}got {value!r}, expected a mapping of keys to '
                            'values')


def refuse_unknown(mapping, known, source, path):
    """
    Refuse keys that nobody reads, and suggest what may have been meant.

    :param mapping: what came.
    :param known: names that are read.
    :param source: what errors call the file.
    :param path: key path of the mapping.
    :raises ScenarioError: naming the first such key.
    """
    for key in mapping:
        if key not in known:
            near = difflib.get_close_matches(str(key), known, 1)
            hint = f'{near[0]!r}' if near else 'one of ' + ', '.join(known)
            raise ScenarioError(f'{source}: {join(path, key)}: got an unknown key, expected '
                                + hint)


def _in_radians(mapping, fields, source, path):
    converted = {}
    for key, value in mapping.items():
        name = str(key)[:-len(DEGREES)] if str(key).endswith(DEGREES) else key
        if name == key or name not in fields or _unit(fields[name]) not in RADIANS:
            converted[key] = value
            continue
        if name in mapping:
            raise ScenarioError(f'{source}: {join(path, key)}: got {name!r} too, expected one of '
                                'the two')
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ScenarioError(f'{source}: {join(path, key)}: got {value!r}, expected a number '
                                '[deg]')
        converted[name] = math.radians(value)
    return converted


def _value(kind, value, source, path):
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        kind = next(option for option in typing.get_args(kind) if option is not type(None))
    if dataclasses.is_dataclass(kind):
        return build(kind, value, source, path)
    item = (typing.get_args(kind) or (None,))[0]
    if typing.get_origin(kind) is not tuple or not dataclasses.is_dataclass(item):
        return value
    if not isinstance(value, list):
        raise ScenarioError(f'{source}: {path}: got {value!r}, expected a list')
    return tuple(build(item, entry, source, f'{path}[{i}]') for i, entry in enumerate(value))


def _expected(kind, field):
    if dataclasses.is_dataclass(kind) or not field.metadata:
        return 'a mapping with the key ' + repr(field.name)
    return f'{expectation(kind, field.metadata)}: {field.metadata["description"]}'


def _with_path(message, cls, path):
    prefix = f'{cls.__name__}.'
    if message.startswith(prefix):
        return join(path, message[len(prefix):])
    return f'{path}: {message}' if path else message


def _are_mappings(value):
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def _is_required(field):
    return (field.default is dataclasses.MISSING
            and field.default_factory is dataclasses.MISSING)


def _unit(field):
    return field.metadata.get('unit', '')


BELIEFS = {'object': ('true_object', 'objects'), 'robot': ('true_robot', 'robots')}


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
