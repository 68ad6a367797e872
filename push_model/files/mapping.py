"""Parameter dataclasses from mappings, as YAML gives them, and back."""

from collections.abc import Iterable
import dataclasses
import difflib
import math
from pathlib import Path
import types
import typing
from typing import Any, NamedTuple, TypeVar

from push_model.files.strict_yaml import ParameterFileError
from push_model.quantity import check_plausible, expectation, field_types

DEGREES_SUFFIX = '_deg'
RADIANS = ('rad', 'rad/s')
Parameters = TypeVar('Parameters')


class Location(NamedTuple):
    """
    A place in a file, for errors.

    :param source: the file, or another name of its text.
    :param path: keys from the top of the file, joined by dots; empty at its top.
    """

    source: str | Path
    path: str = ''

    def key(self, name: object) -> 'Location':
        """
        Descend to a key of a mapping.

        :param name: the key.
        """
        return Location(self.source, f'{self.path}.{name}' if self.path else str(name))

    def item(self, index: int) -> 'Location':
        """
        Descend to an item of a list.

        :param index: of the item.
        """
        return Location(self.source, f'{self.path}[{index}]')

    def error(self, problem: str) -> ParameterFileError:
        """
        Make the error to raise.

        :param problem: what came and what was expected.
        """
        return ParameterFileError(': '.join(filter(None, (str(self.source), self.path, problem))))


def from_mapping(cls: type[Parameters], values: object, at: Location) -> Parameters:
    """
    Make a parameter dataclass of a mapping, strictly.

    A field in radians may also be given in degrees, under its name with the suffix ``_deg``.

    :param cls: the dataclass.
    :param values: keys to values; anything else is refused.
    :param at: where they stand.
    :raises ParameterFileError: naming file and key, what came and what was expected.
    """
    kinds = field_types(cls)
    fields = {field.name: field for field in _init_fields(cls)}
    mapping = _in_radians(expect_mapping(values, at), fields, at)
    _refuse_unknown(mapping, fields, at)
    arguments: dict[str, Any] = {}
    for name, field in fields.items():
        if name in mapping:
            arguments[name] = _field_value(kinds[name], mapping[name], at.key(name))
        elif _is_required(field):
            raise at.key(name).error(f'got nothing, expected {_expected(kinds[name], field)}')
    try:
        instance = cls(**arguments)
        check_plausible(instance)
    except ValueError as error:
        problem, prefix = str(error), f'{cls.__name__}.'
        # A check of one field names it; then the file's own path to it takes the place of that.
        if problem.startswith(prefix):
            name, _, message = problem[len(prefix):].partition(': ')
            raise at.key(name).error(message) from error
        raise at.error(problem) from error
    return instance


def to_mapping(instance: Any) -> Any:
    """
    Turn a parameter dataclass into plain mappings and lists, as ``from_mapping`` reads them.

    :param instance: the dataclass instance, or a value of a field; None is left out.
    """
    if dataclasses.is_dataclass(instance):
        values = {field.name: getattr(instance, field.name) for field in _init_fields(instance)}
        return {name: to_mapping(value) for name, value in values.items() if value is not None}
    if isinstance(instance, tuple):
        return [to_mapping(item) for item in instance]
    return instance


def merge(base: Any, changes: Any, at: Location) -> Any:
    """
    Merge changes into plain values: mappings key by key, lists of mappings item by item.

    :param base: what is changed; the value itself stays as it is.
    :param changes: new values of any part of ``base``.
    :param at: where the changes stand.
    :raises ParameterFileError: where a list of mappings has another length than the one it
        changes.
    """
    if isinstance(base, dict) and isinstance(changes, dict):
        merged: dict[str, Any] = dict(base)
        for key, change in changes.items():
            is_known = key in base
            merged[key] = merge(base[key], change, at.key(key)) if is_known else change
        return merged
    if _are_mappings(base) and _are_mappings(changes):
        if len(base) != len(changes):
            raise at.error(f'got {len(changes)} items, expected {len(base)}, one for each that is '
                           'changed')
        return [merge(item, change, at.item(i))
                for i, (item, change) in enumerate(zip(base, changes))]
    return changes


def expect_mapping(value: object, at: Location) -> dict[str, Any]:
    """
    Return a mapping, and refuse everything else.

    :param value: what came.
    :param at: where it stands.
    :raises ParameterFileError: naming both.
    """
    if not isinstance(value, dict):
        raise at.error(f'got {value!r}, expected a mapping of keys to values')
    return value


def _init_fields(cls: Any) -> list['dataclasses.Field[Any]']:
    return [field for field in dataclasses.fields(cls) if field.init]


def _refuse_unknown(mapping: Iterable[str], known: dict[str, Any], at: Location) -> None:
    """Refuse keys that nobody reads, and suggest what may have been meant."""
    for key in mapping:
        if key not in known:
            near = difflib.get_close_matches(str(key), known, 1)
            hint = f'{near[0]!r}' if near else 'one of ' + ', '.join(known)
            raise at.key(key).error(f'got an unknown key, expected {hint}')


def _in_radians(mapping: dict[str, Any], fields: dict[str, 'dataclasses.Field[Any]'],
                at: Location) -> dict[str, Any]:
    converted: dict[str, Any] = {}
    for key, value in mapping.items():
        name = str(key).removesuffix(DEGREES_SUFFIX)
        if name == key or name not in fields or fields[name].metadata.get('unit') not in RADIANS:
            converted[key] = value
            continue
        if name in mapping:
            raise at.key(key).error(f'got {name!r} too, expected one of the two')
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise at.key(key).error(f'got {value!r}, expected a number [deg]')
        converted[name] = math.radians(value)
    return converted


def _field_value(kind: Any, value: Any, at: Location) -> Any:
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        kind = next(option for option in typing.get_args(kind) if option is not type(None))
    if isinstance(kind, type) and dataclasses.is_dataclass(kind):
        return from_mapping(kind, value, at)
    item = (typing.get_args(kind) or (None,))[0]
    if typing.get_origin(kind) is not tuple or not dataclasses.is_dataclass(item):
        return value
    if not isinstance(value, list):
        raise at.error(f'got {value!r}, expected a list')
    return tuple(from_mapping(typing.cast(type, item), entry, at.item(i))
                 for i, entry in enumerate(value))


def _expected(kind: Any, field: 'dataclasses.Field[Any]') -> str:
    if dataclasses.is_dataclass(kind) or not field.metadata:
        return f'a mapping with the key {field.name!r}'
    return f'{expectation(kind, field.metadata)}: {field.metadata["description"]}'


def _are_mappings(value: object) -> bool:
    return (isinstance(value, list) and bool(value)
            and all(isinstance(item, dict) for item in value))


def _is_required(field: 'dataclasses.Field[Any]') -> bool:
    return (field.default is dataclasses.MISSING
            and field.default_factory is dataclasses.MISSING)
