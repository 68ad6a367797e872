"""Quantity fields: what they accept, how they normalise it, and how they describe themselves."""

import dataclasses
import math
from typing import Literal

import numpy as np
from push_model.quantity import check, expectation, field_types, quantity, range_text
import pytest

Colour = Literal['red', 'green']


@dataclasses.dataclass(frozen=True)
class Part:
    """A nested parameter class."""

    size: float = quantity('size', 'm', above=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


@dataclasses.dataclass(frozen=True)
class Machine:
    """One field of every kind."""

    mass: float = quantity('mass', 'kg', above=0.5, high=10.0)
    level: float = quantity('level', '', -1.0, 1.0, default=0.0)
    reach: float = quantity('reach', 'm', 0.0, infinite=True, default=1.0)
    count: int = quantity('count', '', 1, default=3)
    is_on: bool = quantity('switch', default=False)
    name: str = quantity('name', default='m')
    colour: Colour = quantity('colour', choices=('red', 'green'), default='red')
    corner: tuple[float, ...] = quantity('corner', 'm', -2.0, 2.0, default=())
    part: Part = quantity('part', default=Part(1.0))
    note: str = 'fields of other make are left alone'

    def __post_init__(self):
        """Validate the fields."""
        check(self)


def test_numbers_that_are_right_in_one_field_are_checked_in_another():
    """The same tuple, in a field with another range; and again where it was refused."""
    @dataclasses.dataclass(frozen=True)
    class Wider:
        corner: tuple[float, ...] = quantity('corner', 'm', -9.0, 9.0)

        def __post_init__(self):
            check(self)

    corner = Wider((1, 5.0)).corner
    assert corner == (1.0, 5.0) and Wider(corner).corner is corner
    for _ in range(2):
        with pytest.raises(ValueError, match='Machine.corner'):
            Machine(1.0, corner=corner)


@pytest.mark.parametrize('field, value, expected', [
    ('mass', 0.5, 'a finite number above 0.5, at most 10 [kg]'),
    ('mass', 10.1, 'a finite number above 0.5, at most 10 [kg]'),
    ('mass', math.nan, 'a finite number above 0.5, at most 10 [kg]'),
    ('mass', True, 'a finite number above 0.5, at most 10 [kg]'),
    ('mass', '2', 'a finite number above 0.5, at most 10 [kg]'),
    ('mass', None, 'a finite number above 0.5, at most 10 [kg]'),
    ('level', 1.5, 'a finite number from -1 to 1'),
    ('level', -math.inf, 'a finite number from -1 to 1'),
    ('reach', -1.0, 'a number of at least 0 [m]'),
    ('reach', math.nan, 'a number of at least 0 [m]'),
    ('count', 0, 'a whole number of at least 1'),
    ('count', 2.5, 'a whole number of at least 1'),
    ('count', math.inf, 'a whole number of at least 1'),
    ('count', math.nan, 'a whole number of at least 1'),
    ('level', 10 ** 400, 'a finite number from -1 to 1'),
    ('level', np.array([0.1, 0.2]), 'a finite number from -1 to 1'),
    ('is_on', 1, 'true or false'),
    ('name', 5, 'text'),
    ('colour', 'blue', 'one of red, green'),
    ('corner', (0.0, 3.0), 'finite numbers from -2 to 2 [m]'),
    ('corner', ((0.0, math.nan),), 'finite numbers from -2 to 2 [m]'),
    ('corner', '12', 'finite numbers from -2 to 2 [m]'),
    ('corner', 1.0, 'finite numbers from -2 to 2 [m]'),
    ('part', 1.0, 'a Part'),
])
def test_a_wrong_value_is_refused_with_what_came_and_what_was_expected(field, value, expected):
    with pytest.raises(ValueError) as error:
        Machine(**{'mass': 1.0, field: value})
    assert str(error.value) == f'Machine.{field}: got {value!r}, expected {expected}'


def test_bounds_are_inside_but_for_strict_ones():
    assert Machine(10.0, level=1.0).level == 1.0 and Machine(0.5 + 1e-15, level=-1.0).level == -1.0
    assert Machine(1.0, reach=math.inf).reach == math.inf


def test_numbers_take_the_type_of_their_field():
    """Integers become floats, whole floats integers, lists and arrays tuples of floats."""
    machine = Machine(2, count=4.0, corner=np.array([1, -2]))
    assert type(machine.mass) is float and type(machine.count) is int
    assert machine.corner == (1.0, -2.0) and type(machine.corner[0]) is float
    assert Machine(1.0, corner=[[0, 1], [1, 0]]).corner == ((0.0, 1.0), (1.0, 0.0))
    assert type(Machine(np.float32(0.75)).mass) is float


def test_without_a_default_a_field_is_required():
    with pytest.raises(TypeError, match='mass'):
        Machine()


def test_a_literal_of_texts_counts_as_text():
    assert field_types(Machine)['colour'] is str
    assert field_types(Machine)['part'] is Part


@pytest.mark.parametrize('limits, text', [
    ({}, ''), ({'low': 0.0}, ' of at least 0'), ({'high': 2.5}, ' of at most 2.5'),
    ({'low': 1.0, 'high': 2.0}, ' from 1 to 2'), ({'above': 1.0}, ' above 1'),
    ({'above': 1.0, 'high': 9.0}, ' above 1, at most 9'), ({'above': 0.0}, ' of at least 0.001'),
    ({'above': 0.0, 'high': 9.0}, ' from 0.001 to 9')])
def test_ranges_in_words(limits, text):
    """The same words in errors, ROS descriptors and tables."""
    metadata = quantity('width', 'm', **limits).metadata
    assert range_text(metadata) == text
    assert expectation(float, metadata) == f'a finite number{text} [m]'
