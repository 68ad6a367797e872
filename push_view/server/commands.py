"""
Commands of the page: what its user asks for, checked before anything is done with it.

A command is a JSON object with the key ``type``; poses are (x, y, theta) in the world [m, m, rad].
"""

from collections.abc import Callable, Mapping
import json
import sys
from typing import Any, NamedTuple

from push_model.geometry import Pose

# Range of positions [m], chosen: more than any task has.
MAX_COORDINATE = 50.0
# Range of speeds over real time.
MIN_SPEED, MAX_SPEED = 0.1, 10.0
# What a robot can be told to do.
CALLS = ('start', 'stop', 'pause', 'resume')
# Longest text that is repeated to who sent it.
QUOTED = 60


class CommandRefused(ValueError):
    """A command that is not understood, or cannot be carried out; the text says why."""


class SetGoal(NamedTuple):
    """
    Bring an object there.

    :param pose: goal ``Pose`` of the object.
    :param object_index: which object, 0 for the first.
    """

    pose: Pose
    object_index: int = 0


class DisplaceObject(NamedTuple):
    """
    Move an object, as a person would.

    :param pose: ``Pose`` of the object afterwards.
    :param object_index: which object, 0 for the first.
    """

    pose: Pose
    object_index: int = 0


class AddWall(NamedTuple):
    """
    Draw a wall on the map.

    :param start: one end (x, y) [m].
    :param end: the other end (x, y) [m].
    """

    start: tuple[float, float]
    end: tuple[float, float]


class ClearWalls(NamedTuple):
    """Remove all walls that were drawn."""


class RemoveWall(NamedTuple):
    """
    Remove one wall that was drawn.

    :param wall: its number, from 0 on in the order in which they were drawn.
    """

    wall: int


class UndoWall(NamedTuple):
    """Take back what was last drawn or removed."""


class OpenLink(NamedTuple):
    """
    Start over with the set-up of a link.

    :param link: the part of its address behind ``#``.
    """

    link: str


class Choose(NamedTuple):
    """
    Start over with something else.

    :param choices: names of what is chosen (``object``, ``robot``, ``law``) to names.
    """

    choices: Mapping[str, str]


class SetValue(NamedTuple):
    """
    Change a setting under way.

    :param name: of the setting, as ``friction.0``.
    :param value: SI units.
    """

    name: str
    value: float


class Run(NamedTuple):
    """
    Let time run or stand; None leaves it as it is.

    :param paused: whether time stands.
    :param speed: simulated over real time.
    """

    paused: bool | None = None
    speed: float | None = None


class Step(NamedTuple):
    """Let a single row of time pass."""


class Restart(NamedTuple):
    """Start over with everything as it is set."""


class Call(NamedTuple):
    """
    Let a robot start, stop, pause or go on.

    :param name: one of ``CALLS``.
    """

    name: str


Command = (SetGoal | DisplaceObject | AddWall | RemoveWall | UndoWall | ClearWalls | Choose
           | OpenLink | SetValue | Run | Step | Restart | Call)


def parse_command(text: str) -> Command:
    """
    Read a command.

    :param text: JSON.
    :raises CommandRefused: naming the field, what came and what was expected.
    """
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise CommandRefused(f'message: got {_quoted(text)}, expected JSON') from error
    if not isinstance(values, dict):
        raise CommandRefused(f'message: got {_quoted(text)}, expected an object')
    kind = values.pop('type', None)
    if not isinstance(kind, str) or kind not in _READERS:
        raise CommandRefused(f'type: got {_quoted(kind)}, expected one of '
                             + ', '.join(_READERS))
    reader, fields = _READERS[kind]
    unknown = sorted(set(values) - set(fields)) if fields is not None else []
    if unknown:
        raise CommandRefused(f'{kind}.{unknown[0][:QUOTED]}: got an unknown field, expected '
                             + (' or '.join(fields or ()) or 'none'))
    return reader(kind, values)


def require_index(kind: str, index: int, count: int) -> None:
    """
    Check which object a command is about.

    :param kind: of the command.
    :param count: of objects.
    :raises CommandRefused: where there is no such object.
    """
    if not 0 <= index < count:
        raise CommandRefused(f'{kind}.index: got {index}, expected 0 to {count - 1}, one of '
                             f'{count} objects')


def _quoted(value: object) -> str:
    text = repr(value)
    return text if len(text) <= QUOTED else text[:QUOTED] + '...'


def _number(kind: str, name: str, value: object, low: float, high: float) -> float:
    if (isinstance(value, bool) or not isinstance(value, (int, float))
            or not low <= value <= high):
        raise CommandRefused(f'{kind}.{name}: got {_quoted(value)}, expected a number from '
                             f'{low:g} to {high:g}')
    return float(value)


def _numbers(kind: str, name: str, values: Mapping[str, Any], count: int) -> tuple[float, ...]:
    value = values.get(name)
    if not isinstance(value, list) or len(value) != count:
        raise CommandRefused(f'{kind}.{name}: got {_quoted(value)}, expected {count} numbers')
    return tuple(_number(kind, name, item, -MAX_COORDINATE, MAX_COORDINATE) for item in value)


def _pose(kind: str, values: Mapping[str, Any]) -> Pose:
    return Pose(*_numbers(kind, 'pose', values, 3))


def _point(kind: str, name: str, values: Mapping[str, Any]) -> tuple[float, float]:
    x, y = _numbers(kind, name, values, 2)
    return x, y


def _whole_number(kind: str, name: str, value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise CommandRefused(f'{kind}.{name}: got {_quoted(value)}, expected a whole number')
    return value


def _index(kind: str, values: Mapping[str, Any]) -> int:
    return _whole_number(kind, 'index', values.get('index', 0))


def _remove_wall(kind: str, values: Mapping[str, Any]) -> RemoveWall:
    return RemoveWall(_whole_number(kind, 'wall', values.get('wall')))


def _open(kind: str, values: Mapping[str, Any]) -> OpenLink:
    link = values.get('link')
    if not isinstance(link, str):
        raise CommandRefused(f'{kind}.link: got {_quoted(link)}, expected the text of a link')
    return OpenLink(link)


def _choose(kind: str, values: Mapping[str, Any]) -> Choose:
    for name, value in values.items():
        if not isinstance(value, str):
            raise CommandRefused(f'{kind}.{name[:QUOTED]}: got {_quoted(value)}, expected a name')
    return Choose(dict(values))


def _set(kind: str, values: Mapping[str, Any]) -> SetValue:
    name = values.get('name')
    if not isinstance(name, str):
        raise CommandRefused(f'{kind}.name: got {_quoted(name)}, expected the name of a setting')
    limit = sys.float_info.max
    return SetValue(name, _number(kind, 'value', values.get('value'), -limit, limit))


def _call(kind: str, values: Mapping[str, Any]) -> Call:
    name = values.get('name')
    if name not in CALLS:
        raise CommandRefused(f'{kind}.name: got {_quoted(name)}, expected one of '
                             + ', '.join(CALLS))
    return Call(str(name))


def _run(kind: str, values: Mapping[str, Any]) -> Run:
    paused, speed = values.get('paused'), values.get('speed')
    if paused is not None and not isinstance(paused, bool):
        raise CommandRefused(f'{kind}.paused: got {_quoted(paused)}, expected true or false')
    if speed is not None:
        speed = _number(kind, 'speed', speed, MIN_SPEED, MAX_SPEED)
    return Run(paused, speed)


# Reader of each command, and its fields; None where their names are checked later.
_READERS: dict[str, tuple[Callable[[str, Mapping[str, Any]], Command], tuple[str, ...] | None]] = {
    'goal': (lambda kind, values: SetGoal(_pose(kind, values), _index(kind, values)),
             ('pose', 'index')),
    'displace': (lambda kind, values: DisplaceObject(_pose(kind, values), _index(kind, values)),
                 ('pose', 'index')),
    'wall': (lambda kind, values: AddWall(_point(kind, 'start', values),
                                          _point(kind, 'end', values)), ('start', 'end')),
    'remove_wall': (_remove_wall, ('wall',)),
    'undo': (lambda kind, values: UndoWall(), ()),
    'clear_walls': (lambda kind, values: ClearWalls(), ()),
    'choose': (_choose, None),
    'open': (_open, ('link',)),
    'set': (_set, ('name', 'value')),
    'run': (_run, ('paused', 'speed')),
    'step': (lambda kind, values: Step(), ()),
    'restart': (lambda kind, values: Restart(), ()),
    'call': (_call, ('name',)),
}
