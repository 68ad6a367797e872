"""What was learned of an object ages, and survives as plain numbers."""

import dataclasses
import math

from helpers.objects import box
from push_control.perception.object_knowledge import object_key, ObjectKnowledge
import pytest

KNOWN = ObjectKnowledge((0.01, -0.02), 0.003, 0.35, 0.04, 60.0)
WALKS = {'center_walk': 5e-5, 'contact_friction_walk': 5e-4}


def test_knowledge_ages_as_by_a_random_walk():
    """Means stay, variances grow by the square of the walk; two spans are as good as their sum."""
    aged = KNOWN.aged(3600.0, **WALKS)
    assert (aged.friction_center, aged.contact_friction) == ((0.01, -0.02), 0.35)
    assert aged.age == 3660.0
    assert aged.center_deviation ** 2 - 0.003 ** 2 == pytest.approx(3600.0 * 5e-5 ** 2)
    assert aged.contact_friction_deviation ** 2 - 0.04 ** 2 == pytest.approx(3600.0 * 5e-4 ** 2)
    in_steps = KNOWN.aged(600.0, **WALKS).aged(3000.0, **WALKS)
    assert dataclasses.astuple(in_steps)[1:] == pytest.approx(dataclasses.astuple(aged)[1:])
    assert KNOWN.aged(0.0, **WALKS) == KNOWN


def test_knowledge_survives_as_plain_numbers():
    values = KNOWN.to_mapping()
    assert values['friction_center'] == [0.01, -0.02]
    assert ObjectKnowledge.from_mapping(values) == KNOWN
    del values['age']
    assert ObjectKnowledge.from_mapping(values) == dataclasses.replace(KNOWN, age=0.0)


@pytest.mark.parametrize('change, text', [
    ({'center_deviation': -1.0}, r'center_deviation: got -1.0, expected .* of at least 0 \[m\]'),
    ({'center_deviation': math.nan}, 'center_deviation: got nan'),
    ({'friction_center': [0.1]}, r'friction_center: got \(0.1,\), expected two numbers'),
    ({'friction_center': 'here'}, "friction_center: got 'here'"),
    ({'contact_friction': None}, 'contact_friction: got None'),
    ({'age': -5.0}, 'age: got -5.0'),
    ({'colour': 'red'}, 'colour: got an unknown field')])
def test_wrong_values_are_refused_by_name(change, text):
    with pytest.raises(ValueError, match=rf'^ObjectKnowledge\.{text}'):
        ObjectKnowledge.from_mapping({**KNOWN.to_mapping(), **change})


@pytest.mark.parametrize('name', ['friction_center', 'center_deviation', 'contact_friction',
                                  'contact_friction_deviation'])
def test_missing_values_are_refused_by_name(name):
    values = KNOWN.to_mapping()
    del values[name]
    with pytest.raises(ValueError, match=rf'^ObjectKnowledge\.{name}: got nothing, expected'):
        ObjectKnowledge.from_mapping(values)


def test_a_key_is_that_of_the_nominal_parameters():
    """Equal objects have one key, and any parameter makes another."""
    assert object_key(box()) == object_key(box())
    others = [dataclasses.replace(box(), contact_friction_coefficient=0.4),
              dataclasses.replace(box(), center_of_mass=(1e-4, 0.0)), box(mass=3.5)]
    assert len({object_key(obj) for obj in [box(), *others]}) == 4
