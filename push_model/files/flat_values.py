"""
Parameter dataclasses as flat values by dotted names, as ROS has them.

Nested dataclasses become dotted names, tuples of dataclasses one list for each of their fields,
and tuples of numbers flat lists:

    PushedObject.mass                   object.mass                     3.0
    PushedObject.supports[i].x          object.supports.x               [-0.1, 0.1]
    PushedObject.outline[i] = (x, y)    object.outline                  [x_0, y_0, x_1, y_1, ...]
"""

import dataclasses
from typing import Any, get_args, get_origin, Mapping

from push_model.quantity import check_plausible, expectation, field_types

# Types of values that are parameters by themselves.
SCALARS = (bool, int, float, str)
# Stands for a value that is not given; None is one that may be.
_MISSING = object()


@dataclasses.dataclass(frozen=True)
class ParameterSpec:
    """
    One ROS parameter.

    :param name: with dots.
    :param kind: bool, int, float, str, or a list of one of them, as ``list[float]``.
    :param default: its value where none is given; None where one must be given.
    :param metadata: of ``quantity``: description, unit, range.
    """

    name: str
    kind: Any
    default: Any
    metadata: Mapping[str, Any]

    @property
    def expectation(self) -> str:
        """Description of the values that the parameter accepts."""
        return expectation(self.kind, self.metadata)


def parameter_specs(cls: Any, prefix: str = '') -> list[ParameterSpec]:
    """
    List the parameters of a dataclass.

    :param cls: the dataclass, of fields made with ``quantity``.
    :param prefix: put before the names, with its dot.
    :return: ``ParameterSpec`` list.
    """
    hints = field_types(cls)
    specs: list[ParameterSpec] = []
    for field in dataclasses.fields(cls):
        kind, name, default = hints[field.name], prefix + field.name, _default(field)
        item = _item_type(kind)
        if dataclasses.is_dataclass(kind):
            specs += parameter_specs(kind, f'{name}.')
        elif item is not None and dataclasses.is_dataclass(item):
            specs += [_as_list(spec, is_optional=default == ())
                      for spec in parameter_specs(item, f'{name}.')]
        elif kind in SCALARS:
            specs.append(ParameterSpec(name, kind, default, field.metadata))
        else:
            values = None if default is None else tuple(_flattened(default))
            specs.append(ParameterSpec(name, list[float], values, field.metadata))
    return specs


def to_parameter_values(instance: Any, prefix: str = '') -> dict[str, Any]:
    """
    Flatten a dataclass instance; empty lists are left out.

    :param instance: of a class that ``parameter_specs`` describes.
    :param prefix: put before the names, with its dot.
    :return: dict of names to numbers, texts and lists.
    """
    values: dict[str, Any] = {}
    for field in dataclasses.fields(instance):
        name, value = prefix + field.name, getattr(instance, field.name)
        if dataclasses.is_dataclass(value):
            values.update(to_parameter_values(value, f'{name}.'))
        elif not isinstance(value, tuple):
            values[name] = value
        elif value and dataclasses.is_dataclass(value[0]):
            for part in dataclasses.fields(value[0]):
                values[f'{name}.{part.name}'] = [getattr(item, part.name) for item in value]
        elif value:
            values[name] = _flattened(value)
    return values


def from_parameter_values(cls: Any, values: Mapping[str, Any], prefix: str = '') -> Any:
    """
    Make a dataclass instance of flat values.

    :param cls: the dataclass.
    :param values: names to values; others than its own are ignored.
    :param prefix: put before the names, with its dot.
    :raises ValueError: naming the parameter, what came and what was expected.
    """
    hints = field_types(cls)
    arguments: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        kind, name = hints[field.name], prefix + field.name
        value = _field_value(kind, values, name)
        if value is not _MISSING:
            arguments[field.name] = value
        elif _default(field) is None:
            raise ValueError(f'{name}: got nothing, expected {expectation(kind, field.metadata)}')
    try:
        instance = cls(**arguments)
        check_plausible(instance)
    except ValueError as error:
        raise ValueError(_with_parameter_name(str(error), cls, prefix)) from error
    return instance


def _field_value(kind: Any, values: Mapping[str, Any], name: str) -> Any:
    """Make the value of a field of some type; ``_MISSING`` where it has none."""
    item = _item_type(kind)
    if dataclasses.is_dataclass(kind):
        return from_parameter_values(kind, values, f'{name}.')
    if item is not None and dataclasses.is_dataclass(item):
        return _items(item, values, f'{name}.')
    if name not in values:
        return _MISSING
    holds_pairs = kind is tuple or get_origin(item) is tuple
    return _pairs(name, values[name]) if holds_pairs else values[name]


def _as_list(spec: ParameterSpec, is_optional: bool) -> ParameterSpec:
    """Turn the parameter of one item into that of all; without a default one must be given."""
    default = () if is_optional or spec.default is not None else None
    return dataclasses.replace(spec, kind=list[spec.kind], default=default)


def _items(cls: Any, values: Mapping[str, Any], prefix: str) -> tuple[Any, ...]:
    """Make a tuple of dataclass instances of lists, one list for each field."""
    columns: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        name = prefix + field.name
        column = values.get(name, ())
        if isinstance(column, str) or not hasattr(column, '__len__'):
            raise ValueError(f'{name}: got {column!r}, expected a list')
        if len(column):
            columns[field.name] = column
    counts = {prefix + name: len(column) for name, column in columns.items()}
    if len(set(counts.values())) > 1:
        raise ValueError(', '.join(counts) + f': got lists of {list(counts.values())} numbers, '
                         'expected lists of one length')
    rows = [dict(zip(columns, row)) for row in zip(*columns.values())]
    return tuple(
        from_parameter_values(cls, {prefix + name: value for name, value in row.items()}, prefix)
        for row in rows)


def _pairs(name: str, values: Any) -> tuple[tuple[float, float], ...]:
    values = list(values) if hasattr(values, '__iter__') else [values]
    if len(values) % 2:
        raise ValueError(f'{name}: got {len(values)} numbers, expected pairs in a row')
    return tuple(zip(values[::2], values[1::2]))


def _with_parameter_name(text: str, cls: type[Any], prefix: str) -> str:
    """Put the prefix of the parameters in place of the name of the dataclass in an error."""
    start = f'{cls.__name__}.'
    return prefix + text[len(start):] if text.startswith(start) else text


def _default(field: 'dataclasses.Field[Any]') -> Any:
    """Return the default of a field; None where there is none."""
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return None if field.default is dataclasses.MISSING else field.default


def _item_type(kind: Any) -> Any:
    """Return T of ``tuple[T, ...]``; None for all other types."""
    arguments = get_args(kind)
    if get_origin(kind) is tuple and arguments and arguments[-1] is Ellipsis:
        return arguments[0]
    return None


def _flattened(value: Any) -> list[Any]:
    if isinstance(value, tuple):
        return [number for item in value for number in _flattened(item)]
    return [value]
