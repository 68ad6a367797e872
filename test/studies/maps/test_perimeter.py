"""Locations round a perimeter: their sections, stability and tolerances."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_model.contact import contact_point, normal_range
from push_model.parameters import Contact
import pytest
from studies.analysis.rolling_limits import (
    force_tolerances, min_robot_radius, quasi_static_force,
)
from studies.analysis.stability import equilibrium_at, tolerances
from studies.analysis.steady_turn import steady_force
from studies.maps.perimeter import (
    is_stable, perimeter_locations, push_through_center, section_ends, stable_borders,
)
from studies.maps.tolerance import returns


@pytest.mark.parametrize('obj, contact', [
    (box(), Contact('face', 3, 0.06)),
    (bin_(center_of_mass=(-0.08, 0.02)), Contact('round', 0, 3.0))])
def test_pushes_through_the_center_are_equilibria(obj, contact):
    location = push_through_center(obj, contact, 0.6)
    assert location.alpha(0.0) == pytest.approx(0.0, abs=1e-12)
    assert is_stable(obj, contact, 0.6)
    for tolerance in force_tolerances(obj, contact, location):
        for factor, expected in ((0.97, True), (1.03, False)):
            assert returns(obj, contact, location, 0.02, rotation=factor * tolerance.rotation,
                           distance=1.0) == expected


def test_force_tolerances_are_those_of_rho_where_the_cone_is_wide():
    obj, contact = box(contact_friction_coefficient=8.0), Contact('face', 3, 0.05)
    location = push_through_center(obj, contact, 0.3)
    assert force_tolerances(obj, contact, location) == tolerances(
        location, equilibrium_at(location, 0.0), 8.0)


def test_force_of_a_slow_push_is_that_of_a_steady_turn():
    obj, contact = box(friction=(0.2, 0.3, 0.5, 0.3)), Contact('face', 3, 0.03)
    place, normal = contact_point(obj, contact), normal_range(obj, contact)[0]
    force = quasi_static_force(obj, place, math.cos(0.2), math.sin(0.2))
    assert normal == 0.0
    assert force == pytest.approx(steady_force(obj, place, 0.2, 1e-4, normal), rel=1e-5)


@pytest.mark.parametrize('obj, contact', [
    (box(), Contact('face', 3, 0.06)),
    (bin_(center_of_mass=(-0.08, 0.02)), Contact('round', 0, 3.0))])
def test_least_radius_is_where_stability_begins(obj, contact):
    least = min_robot_radius(obj, push_through_center(obj, contact, 1.0))
    assert is_stable(obj, contact, 1.001 * least)
    assert not is_stable(obj, contact, 0.999 * least)


def test_no_robot_pushes_a_centred_disc_stably():
    location = push_through_center(bin_(), Contact('round', 0, 1.0), 1.0)
    assert min_robot_radius(bin_(), location) == math.inf
    assert stable_borders(bin_(), 50.0, 60) == (0.0, [])


@pytest.mark.parametrize('obj, perimeter', [(box(), 1.6), (bin_(), 0.4 * math.pi)])
def test_locations_cover_the_perimeter_end_to_end(obj, perimeter):
    found = perimeter_locations(obj, 50)
    assert sum(location.length for location in found) == pytest.approx(perimeter)
    for location, following in zip(found, found[1:] + found[:1]):
        assert section_ends(obj, location)[1] == pytest.approx(section_ends(obj, following)[0],
                                                               abs=1e-12)
    assert np.all(np.diff([location.s for location in found]) > 0.0)
