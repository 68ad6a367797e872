"""Parameters that a request overrules are named once."""

import dataclasses

from helpers.objects import box
from push_planner.ros.requested_object import overruled_fields, OverruledParameters
import pytest


@pytest.mark.parametrize('changes, fields', [
    ({}, ()),
    ({'contact_friction_coefficient': 0.1}, ()),
    ({'mass': 5.0}, ('mass',)),
    ({'mass': 3.0 + 1e-12}, ()),
    ({'contact_height': 0.05, 'center_of_mass_height': 0.1},
     ('contact_height', 'center_of_mass_height')),
])
def test_only_what_is_not_learned_is_compared(changes, fields):
    """Friction changes from request to request, and rounding is no difference."""
    obj = dataclasses.replace(box(), mass=3.0)
    assert overruled_fields(obj, dataclasses.replace(obj, **changes)) == fields


def test_a_disc_in_place_of_a_box_is_another_object():
    """With another outline and another radius."""
    disc = dataclasses.replace(box(), outline=(), radius=0.3, inertia=0.0)
    assert overruled_fields(box(), disc) == ('outline', 'radius')


def test_each_difference_is_named_once():
    """However often such a request comes."""
    parameters = OverruledParameters(box())
    heavy = dataclasses.replace(box(), mass=2.0 * box().mass)
    assert parameters.note(box()) == ''
    assert parameters.note(heavy) == (
        'object.mass: without effect, as the request brings another object')
    assert parameters.note(heavy) == ''
    assert parameters.note(dataclasses.replace(heavy, contact_height=0.05)).startswith(
        'object.mass, object.contact_height: ')
