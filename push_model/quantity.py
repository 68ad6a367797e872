"""
Fields of parameter dataclasses: meaning, unit and range, written once.

The same description serves validation, ROS parameter descriptors, the scenario loader and the
tables of the documentation.
"""

from collections.abc import Mapping
import dataclasses
import functools
import math
from typing import Any, get_args, get_origin, get_type_hints, Literal, TYPE_CHECKING

if TYPE_CHECKING:  # Commands that list things need no numpy.
    from push_model.geometry import BoolArray, FloatArray

INFINITY = math.inf
# Least values of what is above zero, by unit: less is meant in another unit. Chosen for robots of
# 0.05 to 1 m and objects of 0.01 to 500 kg: far below what these need, and so that a thousandth of
# what is usual, as of millimetres given in metres, is below it.
MIN_VALUES = {'m': 1e-3, 's': 5e-3, 'kg': 5e-3, 'Hz': 0.2, 'rad': 1e-3, 'm/s': 1e-3,
              'rad/s': 0.02, 'm/s^2': 2e-3, 'rad/s^2': 0.02}
# Least standard deviation of a measurement [m], [rad]; chosen: a tenth of that of motion capture.
MIN_NOISE = 1e-5
# Sizes beyond which a unit is mistaken [m]: radii of robots that are neither points nor flat
# pushers, distances of the outline of an object from its origin, and heights; chosen likewise.
RADII = 5e-3, 5.0
MIN_RADIUS = 1e-3
MAX_EXTENT = 20.0
MAX_HEIGHT = 10.0
# Angle beyond which somebody means degrees [rad]: a full turn.
MAX_ANGLE = 6.2832


def quantity(description: str, unit: str = '', low: float = -INFINITY, high: float = INFINITY, *,
             above: float | None = None, choices: tuple[str, ...] | None = None,
             other_words: str = '', infinite: bool = False,
             plausible: tuple[float, float] | None = None, is_dynamic: bool = True,
             is_basic: bool = False, default: object = dataclasses.MISSING) -> Any:
    """
    Describe one field of a parameter dataclass.

    :param description: what the value means, one phrase.
    :param unit: SI unit, empty for a pure number.
    :param low: least allowed value (every element of a tuple is checked).
    :param high: greatest allowed value.
    :param above: strict lower bound, in place of ``low``; where it is 0, the least value of the
        unit is the lower bound.
    :param choices: allowed words, for a field of type ``str`` or a ``Literal`` of texts.
    :param other_words: what is allowed besides the choices, which the class checks by itself;
        empty for nothing.
    :param infinite: whether infinity is a value too.
    :param plausible: what values of files and parameters are between, but for 0 and infinity,
        where ``check`` allows more for the sake of limits.
    :param is_dynamic: whether another value takes effect while its group may be set at run time;
        False for what something is built with that lives longer than a movement or a plan.
    :param is_basic: whether a user of another robot or object has to think of it; else it is
        advanced.
    :param default: value where none is given; the field is required without it.
    :return: a ``dataclasses.field`` that ``check`` understands; type checkers take it for a value
        of the field.
    """
    if above == 0.0 and unit in MIN_VALUES:
        low, above = MIN_VALUES[unit], None
    metadata = {'description': description, 'unit': unit, 'low': low, 'high': high,
                'above': above, 'choices': choices, 'other_words': other_words,
                'infinite': infinite, 'plausible': plausible, 'is_dynamic': is_dynamic,
                'is_basic': is_basic}
    return dataclasses.field(default=default, metadata=metadata)


def check(instance: Any) -> None:
    """
    Validate every described field of a frozen dataclass and normalise its type.

    Integers become floats where the field is a float; lists and arrays become tuples.

    :param instance: the dataclass instance, called from ``__post_init__``.
    :raises ValueError: naming the field, what came and what was expected.
    """
    for name, kind, metadata in _described_fields(type(instance)):
        value = getattr(instance, name)
        try:
            normalised = _normalised(value, kind, metadata)
        except _Refused:
            expected = (f'a {kind.__name__}' if _is_dataclass_type(kind)
                        else expectation(kind, metadata))
            raise ValueError(f'{type(instance).__name__}.{name}: got {value!r}, expected '
                             f'{expected}') from None
        if normalised is not value:
            object.__setattr__(instance, name, normalised)


def check_plausible(instance: Any) -> None:
    """
    Refuse values that are valid, but must be meant in another unit.

    :param instance: of a class whose fields ``quantity`` has made, from a file or parameters.
    :raises ValueError: naming the field, what came and what was expected.
    """
    for name, _, metadata in _described_fields(type(instance)):
        limits, value = metadata['plausible'], getattr(instance, name)
        if limits and value not in (0.0, INFINITY) and not limits[0] <= value <= limits[1]:
            raise ValueError(f'{type(instance).__name__}.{name}: got {value!r}, expected from '
                             f'{limits[0]:g} to {limits[1]:g} [{metadata["unit"]}]')


def allowed(cls: type, name: str, values: 'FloatArray') -> 'BoolArray':
    """
    Tell which values a field of numbers accepts: what ``check`` tells of one, of many at once.

    :param cls: the dataclass.
    :param name: of a field that ``quantity`` has made.
    :param values: any shape.
    :return: same shape.
    """
    metadata = next(metadata for known, _, metadata in _described_fields(cls) if known == name)
    inside = (values >= metadata['low']) & (values <= metadata['high'])
    if metadata['above'] is not None:
        inside &= values > metadata['above']
    return inside if metadata['infinite'] else inside & (abs(values) < INFINITY)


@functools.lru_cache(maxsize=None)
def field_types(cls: type) -> dict[str, Any]:
    """
    List the types of the fields of a dataclass; a ``Literal`` of texts counts as ``str``.

    :param cls: the dataclass.
    :return: dict of field names to types; do not change it, as it is kept.
    """
    return {name: str if get_origin(hint) is Literal and isinstance(get_args(hint)[0], str)
            else hint for name, hint in get_type_hints(cls).items()}


def expectation(kind: Any, metadata: Mapping[str, Any]) -> str:
    """
    Describe in words what a field accepts.

    :param kind: type of the field, as ``field_types`` has it.
    :param metadata: the metadata that ``quantity`` made.
    :return: for example ``'a number above 0 [kg]'``.
    """
    unit = f" [{metadata['unit']}]" if metadata['unit'] else ''
    if metadata['choices']:
        others = (metadata['other_words'],) if metadata['other_words'] else ()
        return 'one of ' + ', '.join((*metadata['choices'], *others))
    number = 'a number' if metadata.get('infinite') else 'a finite number'
    noun = {bool: 'true or false', str: 'text', int: 'a whole number'}.get(kind, number)
    if kind not in (bool, str, int, float):
        noun = 'texts' if str in get_args(kind) else 'finite numbers'
    return noun + range_text(metadata) + unit


def range_text(metadata: Mapping[str, Any]) -> str:
    """
    Describe the range of a field in words; empty where it is unbounded.

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


# Kept, as instances of a few classes are made by the thousand.
@functools.lru_cache(maxsize=None)
def _described_fields(cls: type) -> tuple[tuple[str, Any, Mapping[str, Any]], ...]:
    """Name, type and metadata of the fields that ``quantity`` has made."""
    kinds = field_types(cls)
    return tuple((field.name, kinds[field.name], field.metadata)
                 for field in dataclasses.fields(cls) if field.metadata)


def _normalised(value: Any, kind: Any, metadata: Mapping[str, Any]) -> Any:
    if kind is float or kind is int:
        return _number(value, kind, metadata)
    if kind is bool or kind is str:
        return _choice(value, kind, metadata)
    if _is_dataclass_type(kind):
        if not isinstance(value, kind):
            raise _Refused
        return value
    return _checked_numbers(value, metadata)


def _checked_numbers(value: Any, metadata: Mapping[str, Any]) -> tuple[Any, ...]:
    """Normalise numbers; those of a field of which this is a copy need no second look."""
    key = id(value), id(metadata)
    known = _known_numbers.get(key)
    if known is not None:
        return known[0]
    normalised = _numbers(value, metadata)
    if len(_known_numbers) >= MAX_KNOWN:
        _known_numbers.clear()
    # As both are kept here, no other object has their identity.
    _known_numbers[id(normalised), id(metadata)] = normalised, metadata
    return normalised


def _is_dataclass_type(kind: Any) -> bool:
    return isinstance(kind, type) and dataclasses.is_dataclass(kind)


# Tuples of numbers that were found to be right, by their identity and that of the field.
_known_numbers: dict[tuple[int, int], tuple[tuple[Any, ...], Mapping[str, Any]]] = {}
# Number of them that is kept; chosen: variations of some objects and robots take few kB.
MAX_KNOWN = 256


class _Refused(Exception):
    """The value is not what the field accepts."""


def _choice(value: Any, kind: type, metadata: Mapping[str, Any]) -> Any:
    if not isinstance(value, kind):
        raise _Refused
    is_closed = metadata['choices'] and not metadata['other_words']
    if is_closed and value not in metadata['choices']:
        raise _Refused
    return value


def _converted(value: Any, kind: type) -> Any:
    """Convert a number that is neither infinite nor too large for it."""
    if isinstance(value, (bool, str)) or not hasattr(value, '__float__'):
        raise _Refused
    try:
        converted = kind(value)
    except (OverflowError, TypeError, ValueError):
        raise _Refused from None
    if kind is int and converted != value:
        raise _Refused
    return converted


def _number(value: Any, kind: type, metadata: Mapping[str, Any]) -> float:
    if type(value) is not kind:
        value = _converted(value, kind)
    above = metadata['above']
    inside = metadata['low'] <= value <= metadata['high'] and (above is None or value > above)
    finite = math.isfinite(value) or (metadata.get('infinite') and not math.isnan(value))
    if not (finite and inside):
        raise _Refused
    return value


def _numbers(value: Any, metadata: Mapping[str, Any]) -> tuple[Any, ...]:
    if isinstance(value, str) or not hasattr(value, '__iter__'):
        raise _Refused
    items: list[Any] = []
    for item in value:
        if dataclasses.is_dataclass(item):
            items.append(item)
        elif hasattr(item, '__iter__'):
            items.append(_numbers(item, metadata))
        else:
            items.append(_number(item, float, metadata))
    return tuple(items)
