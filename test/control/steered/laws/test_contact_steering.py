"""Centring of a contact that a holonomic base rolls."""

import math

from helpers.contact_sites import SITES
import numpy as np
from push_control.steered.laws.contact_steering import centering_rotation
import pytest

ALLOWED = 0.1
CENTERS = [(0.0, 0.0), (0.03, 0.08), (-0.05, -0.09), (0.08, -0.02), (-0.09, 0.01)]


def zeta(site, turn, center):
    """Angle from C->F to the normal after a turn of the robot."""
    c_x, c_y, normal = site.contact_at(site.heading + turn)
    return math.remainder(normal - math.atan2(center[1] - c_y, center[0] - c_x), 2.0 * math.pi)


@pytest.mark.parametrize('center', CENTERS)
@pytest.mark.parametrize('kind', ['vertex', 'face'])
def test_the_normal_runs_through_the_centre(kind, center):
    """A vertex and a face can be centred exactly, within their ends."""
    site = SITES[kind]
    turn = centering_rotation(site, center, ALLOWED, 0.0)
    assert zeta(site, turn, center) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize('start', np.linspace(-3.0, 3.0, 13))
@pytest.mark.parametrize('center', CENTERS)
def test_a_disc_is_rolled_no_further_than_it_must(center, start):
    """Where the normal is near enough nothing turns, else it comes to the allowed angle."""
    point = (-0.2 * math.cos(start), -0.2 * math.sin(start))
    site = SITES['round']._replace(normal=start, point=point)
    turn, before = centering_rotation(site, center, ALLOWED, 0.0), abs(zeta(site, 0.0, center))
    after = abs(zeta(site, turn, center))
    assert (turn == 0.0) == (before <= ALLOWED)
    assert after == pytest.approx(min(before, ALLOWED), abs=1e-9)
    small = math.copysign(1e-4, turn)
    assert turn == 0.0 or abs(zeta(site, turn - small, center)) > ALLOWED


@pytest.mark.parametrize('kind', ['vertex', 'face'])
def test_the_contact_stays_on_its_feature(kind):
    """However far aside the centre, it does not roll beyond the end."""
    for center in ((1.0, -3.0), (-0.1, 3.0)):
        site = SITES[kind]
        rotation = centering_rotation(site, center, ALLOWED, 0.0)
        x, y, normal = site.contact_at(site.heading + rotation)
        low, high = site.normal_limits
        aside = y * math.cos(site.normal) - x * math.sin(site.normal)
        assert low < normal < high
        assert kind == 'vertex' or site.edges[0] < aside < site.edges[1]
