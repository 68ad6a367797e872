"""
How parameter dataclasses look as flat ROS parameters, and back; no ROS needed.

A nested dataclass becomes names with dots. A tuple of dataclasses becomes one list per field
(``object.supports.x: [...]``), a tuple of pairs one list of numbers in a row.
"""

import dataclasses
import typing

from push_model.quantity import expectation


@dataclasses.dataclass(frozen=True)
class ParameterSpec:
    """
    One ROS parameter.

    :param name: with dots.
    :param kind: bool, int, float, str, or a list of one of them, as ``list[float]``.
    :param default: its value where none is given; None where one must be given.
    :param metadata: what ``quantity`` says of the field: description, unit, range.
    """

    name: str
    kind: object
    default: object
    metadata: typing.Mapping

    @property
    def expectation(self):
        """What the parameter accepts, in words."""
        return expectation(self.kind, self.metadata)


def layout(cls, prefix=''):
    """
    List the parameters of a dataclass.

    :param cls: the dataclass, of fields made with ``quantity``.
    :param prefix: put before the names, with its dot.
    :return: ``ParameterSpec`` list.
    """
    hints = typing.get_type_hints(cls)
    specs = []
    for field in dataclasses.fields(cls):
        kind, name, default = hints[field.name], prefix + field.name, _default(field)
        item = _item(kind)
        if dataclasses.is_dataclass(kind):
            specs += layout(kind, f'{name}.')
        elif dataclasses.is_dataclass(item):
            optional = default == ()
            for spec in layout(item, f'{name}.'):
                given = () if optional or spec.default is not None else None
                specs.append(dataclasses.replace(spec, kind=list[spec.kind], default=given))
        elif kind in (bool, int, float, str):
            specs.append(ParameterSpec(name, kind, default, field.metadata))
        else:
            default = default if default is None else tuple(_flat(default))
            specs.append(ParameterSpec(name, list[float], default, field.metadata))
    return specs


def to_values(instance, prefix=''):
    """
    Flatten a dataclass instance; empty lists are left out.

    :param instance: of a class that ``layout`` describes.
    :param prefix: put before the names, with its dot.
    :return: dict of names to numbers, texts and lists.
    """
    values = {}
    for field in dataclasses.fields(instance):
        name, value = prefix + field.name, getattr(instance, field.name)
        if dataclasses.is_dataclass(value):
            values.update(to_values(value, f'{name}.'))
        elif isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0]):
            for part in dataclasses.fields(value[0]):
                values[f'{name}.{part.name}'] = [getattr(item, part.name) for item in value]
        elif isinstance(value, tuple):
            values.update({name: _flat(value)} if value else {})
        else:
            values[name] = value
    return values


def from_values(cls, values, prefix=''):
    """
    Make a dataclass instance of flat values.

    :param cls: the dataclass.
    :param values: dict of names to values; others than its own are overlooked.
    :param prefix: put before the names, with its dot.
    :raises ValueError: naming the parameter, what came and what was expected.
    """
    hints = typing.get_type_hints(cls)
    arguments = {}
    for field in dataclasses.fields(cls):
        kind, name = hints[field.name], prefix + field.name
        if dataclasses.is_dataclass(kind):
            arguments[field.name] = from_values(kind, values, f'{name}.')
        elif dataclasses.is_dataclass(_item(kind)):
            arguments[field.name] = _items(_item(kind), values, f'{name}.')
        elif name in values:
            pairs = kind is tuple
            arguments[field.name] = _pairs(name, values[name]) if pairs else values[name]
        elif _default(field) is None:
            raise ValueError(f'{name}: got nothing, expected {expectation(kind, field.metadata)}')
    try:
        return cls(**arguments)
    except ValueError as error:
        raise ValueError(_renamed(str(error), cls, prefix)) from error


def _items(cls, values, prefix):
    given = {field.name: values[prefix + field.name] for field in dataclasses.fields(cls)
             if len(values.get(prefix + field.name, ()))}
    counts = {prefix + name: len(column) for name, column in given.items()}
    if len(set(counts.values())) > 1:
        raise ValueError(', '.join(counts) + f': got lists of {list(counts.values())} numbers, '
                         'expected lists of one length')
    rows = [dict(zip(given, row)) for row in zip(*given.values())]
    return tuple(from_values(cls, {prefix + name: value for name, value in row.items()}, prefix)
                 for row in rows)


def _pairs(name, numbers):
    numbers = list(numbers) if hasattr(numbers, '__iter__') else [numbers]
    if len(numbers) % 2:
        raise ValueError(f'{name}: got {len(numbers)} numbers, expected pairs in a row')
    return tuple(zip(numbers[::2], numbers[1::2]))


def _renamed(text, cls, prefix):
    start = f'{cls.__name__}.'
    return prefix + text[len(start):] if text.startswith(start) else text


def _default(field):
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return None if field.default is dataclasses.MISSING else field.default


def _item(kind):
    arguments = typing.get_args(kind)
    is_tuple = typing.get_origin(kind) is tuple
    return arguments[0] if is_tuple and arguments and arguments[-1] is Ellipsis else None


def _flat(value):
    if isinstance(value, tuple):
        return [number for item in value for number in _flat(item)]
    return [value]
