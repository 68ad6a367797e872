"""Members of an ensemble take over what is known of friction, and sum it up again."""

import dataclasses

from helpers.objects import bin_, box
import numpy as np
from push_control.perception.ensemble.friction_members import (
    friction_centers, FrictionMembers, knowledge_of, with_knowledge,
)
from push_control.perception.object_knowledge import ObjectKnowledge
from push_model.friction import friction_center
import pytest

UNEVEN = box(friction=(0.2, 0.4, 0.3, 0.5))


def drawn(obj, count=200, deviation=0.23):
    """Draw members that know nothing but the nominal values."""
    rng = np.random.default_rng(5)
    return FrictionMembers(deviation * rng.standard_normal((count, len(obj.supports))),
                           0.5 + 0.15 * rng.standard_normal(count))


@pytest.mark.parametrize('obj', [box(), UNEVEN, bin_()])
def test_centers_are_those_of_the_objects(obj):
    """Support by support, against an object with this friction."""
    members = drawn(obj, 3)
    for factors, center in zip(np.exp(members.log_factors),
                               friction_centers(obj, members.log_factors)):
        supports = tuple(
            dataclasses.replace(support, friction_coefficient=support.friction_coefficient * ratio)
            for support, ratio in zip(obj.supports, factors.tolist()))
        assert center == pytest.approx(friction_center(dataclasses.replace(obj,
                                                                           supports=supports)))


@pytest.mark.parametrize('obj', [box(), UNEVEN, bin_()])
def test_members_know_what_was_known(obj):
    """Summed up again it is the same, though the centre depends on the supports nonlinearly."""
    x, y = friction_center(obj)
    known = ObjectKnowledge((x + 0.015, y - 0.02), 0.004, 0.3, 0.05)
    again = knowledge_of(obj, with_knowledge(obj, drawn(obj), known))
    assert again.friction_center == pytest.approx(known.friction_center, abs=1e-5)
    assert again.center_deviation == pytest.approx(0.004, abs=1e-5)
    assert again.contact_friction == pytest.approx(0.3)
    assert again.contact_friction_deviation == pytest.approx(0.05)


def test_vague_knowledge_makes_members_no_less_certain():
    """What was learned long ago is worth no less than nothing."""
    before = knowledge_of(UNEVEN, drawn(UNEVEN))
    vague = dataclasses.replace(before, center_deviation=1.0, contact_friction_deviation=9.0)
    members = with_knowledge(UNEVEN, drawn(UNEVEN), vague)
    assert np.allclose(members.log_factors, drawn(UNEVEN).log_factors, atol=1e-9)
    assert np.allclose(members.contact_friction, drawn(UNEVEN).contact_friction)


def test_what_is_not_known_keeps_its_spread():
    """Four supports have four factors: the centre says nothing of the other two."""
    sharp = ObjectKnowledge((0.0, 0.0), 0.0, 0.5, 0.0)
    members = with_knowledge(box(), drawn(box()), sharp)
    spreads = np.linalg.svd(members.log_factors - members.log_factors.mean(axis=0))[1]
    before = np.linalg.svd(drawn(box()).log_factors
                           - drawn(box()).log_factors.mean(axis=0))[1]
    assert (spreads[:2] > 0.8 * before[2:]).all() and (spreads[2:] < 0.2 * before[2:]).all()


def test_supports_on_one_line_move_the_centre_along_it_only():
    """What they cannot do is not asked of them."""
    rod = dataclasses.replace(box(), supports=tuple(
        dataclasses.replace(support, y=0.0) for support in box().supports))
    known = ObjectKnowledge((0.02, 0.05), 0.003, 0.4, 0.1)
    again = knowledge_of(rod, with_knowledge(rod, drawn(rod), known))
    assert again.friction_center == pytest.approx((0.02, 0.0), abs=1e-5)


def test_friction_does_not_get_negative():
    known = ObjectKnowledge((0.0, 0.0), 0.01, 0.02, 0.1)
    members = with_knowledge(box(), drawn(box()), known)
    assert members.contact_friction.min() == 0.0
