"""Parameter dataclasses from plain mappings and back, for any class made with ``quantity``."""

import dataclasses
import difflib
import math
import types
import typing

from push_model.quantity import expectation
from push_scenario.strict_yaml import ScenarioError

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
    hints = typing.get_type_hints(cls)
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
