"""
Links that carry a set-up: the part of the address behind ``#``.

They are written as the query of an address is, ``object=bin&goal=1,0.5,90&friction.0=0.2``, with
positions in metres, angles in degrees and settings in SI units. What a link leaves out is as in
the scenario that it names.
"""

import math
from typing import NamedTuple
from urllib.parse import parse_qsl, urlencode

from push_model.geometry import Pose
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.loader import load_scenario
from push_view.live.setup import Setup
from push_view.live.walls import Wall
from push_view.server.commands import CommandRefused, MAX_COORDINATE, QUOTED

SCENARIO, GOAL, WALL = 'scenario', 'goal', 'wall'
# Most that a link holds; chosen: more than anybody draws.
MAX_FIELDS = 100
# Decimals of metres and degrees; chosen: finer than anything on the page.
DECIMALS = 3
MAX_DEGREES = 720.0


class LinkedSetup(NamedTuple):
    """
    What a link describes.

    :param setup: the ``Setup``.
    :param walls: that are drawn in it.
    """

    setup: Setup
    walls: tuple[Wall, ...]


def link_text(setup: Setup, walls: tuple[Wall, ...]) -> str:
    """Write a set-up as the text of a link: what differs from its scenario."""
    origin = Setup.of(setup.origin)
    choices = {name: value for name, value in setup.choices.items()
               if value != origin.choices[name]}
    fields: list[tuple[str, str]] = [(SCENARIO, setup.origin.name), *choices.items()]
    goal = setup.scenario.goal.pose
    if goal != origin.scenario.goal.pose:
        fields.append((GOAL, _numbers((goal.x, goal.y, math.degrees(goal.theta)))))
    usual = origin.with_choices(choices).values
    fields += [(name, f'{value:.6g}') for name, value in setup.values.items()
               if value != usual[name]]
    fields += [(WALL, _numbers((*wall.start, *wall.end))) for wall in walls]
    return urlencode(fields, safe=',')


def read_link(text: str, setup: Setup) -> LinkedSetup:
    """
    Read the text of a link.

    :param text: as ``link_text`` writes it.
    :param setup: ``Setup`` that it may differ from.
    :raises CommandRefused: naming the field, what came and what was expected.
    """
    try:
        fields = parse_qsl(text, strict_parsing=True, max_num_fields=MAX_FIELDS)
    except ValueError as error:
        raise CommandRefused(f'link: got {text[:QUOTED]!r}, expected name=value&name=value, at '
                             f'most {MAX_FIELDS}') from error
    single = {name: value for name, value in fields if name != WALL}
    setup = _of_scenario(single.pop(SCENARIO, setup.origin.name), setup)
    goal = single.pop(GOAL, None)
    choices = {name: single.pop(name) for name in tuple(single) if name in setup.choices}
    setup = setup.with_choices(choices) if choices else setup
    for name, value in single.items():
        setup = setup.with_value(name, _number(name, value, -math.inf, math.inf))
    if goal is not None:
        x, y, degrees = _values(GOAL, goal, (MAX_COORDINATE, MAX_COORDINATE, MAX_DEGREES))
        setup = setup.with_goal(Pose(x, y, math.radians(degrees)))
    return LinkedSetup(setup, tuple(_wall(value) for name, value in fields if name == WALL))


def _of_scenario(name: str, setup: Setup) -> Setup:
    if name == setup.origin.name:
        return setup
    if name not in scenario_names():
        raise CommandRefused(f'link.{SCENARIO}: got {name[:QUOTED]!r}, expected the name of a '
                             'scenario of the package')
    try:
        return Setup.of(load_scenario(name))
    except ValueError as error:
        raise CommandRefused(f'link.{SCENARIO}: {error}') from error


def _wall(text: str) -> Wall:
    x0, y0, x1, y1 = _values(WALL, text, (MAX_COORDINATE,) * 4)
    return Wall((x0, y0), (x1, y1))


def _values(name: str, text: str, limits: tuple[float, ...]) -> list[float]:
    parts = text.split(',')
    if len(parts) != len(limits):
        raise CommandRefused(f'link.{name}: got {text[:QUOTED]!r}, expected {len(limits)} numbers '
                             'with commas between them')
    return [_number(name, part, -limit, limit) for part, limit in zip(parts, limits)]


def _number(name: str, text: str, low: float, high: float) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise CommandRefused(f'link.{name[:QUOTED]}: got {text[:QUOTED]!r}, expected a number '
                             f'from {low:g} to {high:g}')
    return value


def _numbers(values: tuple[float, ...]) -> str:
    return ','.join(f'{round(value, DECIMALS):g}' for value in values)
