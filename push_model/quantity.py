"""
Fields of parameter dataclasses: meaning, unit and range written once.

The same description serves validation, ROS parameter descriptors, the scenario reader and the
README tables.
"""

import dataclasses
import functools
import math
from typing import get_type_hints

INFINITY = math.inf


def quantity(description, unit='', low=-INFINITY, high=INFINITY, *, above=None, choices=None,
             infinite=False, default=dataclasses.MISSING):
    """
    Describe one field of a parameter dataclass.

    :param description: what the value means, one phrase.
    :param unit: SI unit, empty for a pure number.
    :param low: least allowed value (every element of a tuple is checked).
    :param high: greatest allowed value.
    :param above: strict lower bound, in place of ``low``.
    :param choices: allowed words, for a field of type ``str``.
    :param infinite: whether infinity is a value too.
    :param default: value where none is given; the field is required without it.
    :return: a ``dataclasses.field`` that ``check`` understands.
    """
    metadata = {'description': description, 'unit': unit, 'low': low, 'high': high,
                'above': above, 'choices': choices, 'infinite': infinite}
    return dataclasses.field(default=default, metadata=metadata)


def check(instance):
    """
    Validate every described field of a frozen dataclass and normalise its type.

    Integers become floats where the field is a float; lists and arrays become tuples.

    :param instance: the dataclass instance, called from ``__post_init__``.
    :raises ValueError: naming the field, what came and what was expected.
    """
    hints = _hints(type(instance))
    for field in dataclasses.fields(instance):
        if not field.metadata:
            continue
        name = f'{type(instance).__name__}.{field.name}'
        value = _normalised(name, getattr(instance, field.name), hints[field.name], field.metadata)
        object.__setattr__(instance, field.name, value)


def expectation(kind, metadata):
    """
    Say what a field accepts, in words.

    :param kind: the annotated type of the field.
    :param metadata: the metadata that ``quantity`` made.
    :return: for example ``'a number above 0 [kg]'``.
    """
    unit = f" [{metadata['unit']}]" if metadata['unit'] else ''
    if metadata['choices']:
        return 'one of ' + ', '.join(metadata['choices'])
    number = 'a number' if metadata.get('infinite') else 'a finite number'
    noun = {bool: 'true or false', str: 'text', int: 'a whole number'}.get(kind, number)
    if kind not in (bool, str, int, float):
        noun = 'finite numbers'
    return noun + range_text(metadata) + unit


def range_text(metadata):
    """
    Say the range of a field in words; empty where it is unbounded.

    :param metadata: the metadata that ``quantity`` made.
    """
    low, high, above = metadata['low'], metadata['high'], metadata['above']
    if above is not None:
        return f' above {above:g}' + (f', at most {high:g}' if math.isfinite(high) else '')
    if math.isfinite(low) and math.isfinite(high):
        return f' from {low:g} to {high:g}'
    if math.isfinite(low):
        return f' of at least {low:g}'
    return f' of at most {high:g}' if math.isfinite(high) else ''


def _normalised(name, value, kind, metadata):
    def refuse():
        raise ValueError(f'{name}: got {value!r}, expected {expectation(kind, metadata)}')

    if kind is bool or kind is str:
        if not isinstance(value, kind):
            refuse()
        if metadata['choices'] and value not in metadata['choices']:
            refuse()
        return value
    if kind in (int, float):
        return _number(value, kind, metadata, refuse)
    if dataclasses.is_dataclass(kind):
        if not isinstance(value, kind):
            raise ValueError(f'{name}: got {value!r}, expected a {kind.__name__}')
        return value
    return _sequence(value, metadata, refuse)


def _number(value, kind, metadata, refuse):
    if isinstance(value, (bool, str)) or not hasattr(value, '__float__'):
        refuse()
    if kind is int and int(value) != value:
        refuse()
    value = kind(value)
    above = metadata['above']
    inside = metadata['low'] <= value <= metadata['high'] and (above is None or value > above)
    finite = math.isfinite(value) or (metadata.get('infinite') and not math.isnan(value))
    if not (finite and inside):
        refuse()
    return value


def _sequence(value, metadata, refuse):
    if isinstance(value, str) or not hasattr(value, '__iter__'):
        refuse()
    items = []
    for item in value:
        if dataclasses.is_dataclass(item):
            items.append(item)
        elif hasattr(item, '__iter__'):
            items.append(_sequence(item, metadata, refuse))
        else:
            items.append(_number(item, float, metadata, refuse))
    return tuple(items)


@functools.lru_cache(maxsize=None)
def _hints(kind):
    return get_type_hints(kind)
