"""Round objects on round robots and on a flat pusher: ends of the basin, sliding, asymmetry."""

import dataclasses
import math

from helpers.objects import bin_
from helpers.plant_reference import ramp_robot
from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import Support
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode
import pytest
from studies.analysis.pushing_location import PushingLocation
from studies.chapter2.rolling import flat_pusher, round_object, sliding, sliding_contact

STUDIES = by_figure(round_object, flat_pusher, sliding_contact)


def found(figure, **overrides):
    """Compute a figure, some of its values overridden; return tables and findings."""
    outcome = outcome_of(STUDIES[figure], **overrides)
    return outcome.tables, numbers(outcome)


@pytest.mark.parametrize('figure, origin, edge', [
    ('2.6', 'centre', 0.510), ('2.6', 'contact', 0.510), ('2.7', 'centre', 0.2545),
    ('2.7', 'contact', 0.2013)])
def test_the_basin_ends_where_the_sine_law_has_it(figure, origin, edge):
    _, findings = found(figure, distance_from=origin)
    assert findings['equilibrium'] == pytest.approx(0.0, abs=1e-12)
    assert findings['margin'] > 0.0
    assert findings['edge'] == pytest.approx(edge, abs=4e-4)
    assert findings['low'] == pytest.approx(-findings['edge'], abs=1e-9)


def test_the_drawn_curve_changes_its_sign_at_the_marks_only():
    """Signs of the array itself, not of the equilibria that were found."""
    for figure, column in (('2.6', 'rho_rad'), ('2.7', 'rho_rad'), ('2.9', 'd_pc_m'),
                           ('2.14', 'rho_rad')):
        tables, _ = found(figure)
        places, alpha = tables['alpha'][column], tables['alpha']['alpha_rad']
        flips = np.flatnonzero(np.diff(np.sign(alpha[alpha != 0.0])))
        crossed = places[alpha != 0.0][flips]
        assert crossed == pytest.approx(sorted(tables['equilibria'][column]),
                                        abs=2.0 * (places[1] - places[0]))
        assert len(crossed) == 3


def test_no_basin_with_the_friction_center_beyond_the_effective_radius():
    effective = 0.5 * 0.2 / 0.7
    for off, stable in ((-1e-3, True), (1e-3, False)):
        tables, findings = found('2.6', distance_from='contact', center_distance=effective + off)
        assert (findings['margin'] > 0.0) == stable
        assert bool(tables['basin']['rho_rad']) == stable


def test_rolling_ends_where_the_force_leaves_the_cone_before_the_push_does():
    tables, findings = found('2.8')
    assert 0.25 < findings['edge_narrow'] < findings['edge'] < findings['edge_wide'] < 0.34
    assert findings['edge'] < findings['border'] < 0.5 < math.atan(0.5) + 0.05
    assert findings['border'] < findings['back'] == pytest.approx(0.63, abs=0.01)
    rho, rolls = tables['alpha']['rho_rad'], tables['alpha']['rolls'] == 1
    assert rolls[np.abs(rho) < findings['edge'] - 0.01].all()
    # Beyond the border rho grows, before it falls, sliding at first; see also the drawn pushes.
    pushes = tables['releases']
    for start in values_of(STUDIES['2.8']).releases:
        course = pushes[f'rho_{start:g}_rad']
        assert (course[-1] > start) == (start > findings['border'])
        assert (pushes[f'slides_{start:g}'][0] == 1) == (start > findings['edge'])
    # There the robot passes the object in the end.
    assert findings['border'] < findings['lost'] == 0.5 and 2.0 < findings['lost_distance'] < 2.6


@pytest.mark.physics
@pytest.mark.parametrize('rho', [0.2, 0.4, 0.55, 0.72])
@pytest.mark.parametrize('spread', [0.02, 0.1])
def test_the_simulation_sticks_slides_and_rotates_as_the_motion_cone_has_it(rho, spread):
    location = PushingLocation(0.5, 0.2, 0.1)
    turn = float(location.rotation_at(rho))
    states = np.array([turn]), np.array([rho])
    expected = sliding.slow_motion(location, spread, 0.5, *states)
    points = ((spread, 0.0), (-spread, 0.0), (0.0, spread), (0.0, -spread))
    supports = [Support(x - 0.1, y, 0.3) for x, y in points]
    obj = dataclasses.replace(bin_(), supports=supports, center_of_mass=(-0.1, 0.0),
                              contact_friction_coefficient=0.5)
    # The normal is at -rho in the world, the push along x.
    robot = Pose(-0.7 * math.cos(rho), 0.7 * math.sin(rho), 0.0)
    plant = Plant(obj, ramp_robot(0.5), Pose(0.0, 0.0, turn), robot, 1e-3)
    plant.advance(0.5, Twist(0.02, 0.0, 0.0))
    assert (plant.mode is ContactMode.STICK) == (expected.slides[0] == 0)
    truth = plant.truth(0.0)
    assert truth.object_twist.omega / 0.02 == pytest.approx(expected.yaw_rates[0], rel=0.1)


def test_a_flat_pusher_holds_an_object_whose_friction_center_is_before_its_middle():
    """Half a revolution either way; with that centre beyond the middle the object tips over."""
    _, findings = found('2.9')
    assert PushingLocation(math.inf, 0.2, 0.1).rolling[0] == 0.0
    assert findings['margin'] == pytest.approx(0.1)
    assert findings['edge'] == pytest.approx(0.2 * math.pi)
    for distance in (0.01, 0.19):
        assert found('2.9', center_distance=distance)[1]['edge'] == pytest.approx(0.2 * math.pi)
    tables, findings = found('2.9', beta=0.0)
    assert findings['margin'] == pytest.approx(-0.1)
    assert findings['edge'] == 0.0 and tables['basin']['d_pc_m'] == []


def test_a_flat_pusher_is_the_limit_of_a_large_robot():
    flat = found('2.9')[0]['alpha']
    travel, alpha = flat['d_pc_m'], flat['alpha_rad']
    errors = []
    for radius in (20.0, 200.0):
        location = PushingLocation(radius, 0.2, 0.1)
        errors.append(np.abs(location.alpha(travel / location.rolling[1]) - alpha).max())
    assert errors[1] < 0.12 * errors[0] < 0.12 * 0.2


def test_a_friction_center_to_the_left_moves_the_equilibrium_to_the_right():
    """With beta below pi rho is below 0; beyond pi it is the mirror image; at pi 0."""
    _, left = found('2.14')
    _, right = found('2.14', beta=2.0 * math.pi - 2.9)
    _, centred = found('2.14', beta=math.pi)
    assert left['equilibrium'] < -0.1 and left['margin'] > 0.0
    assert right['equilibrium'] == pytest.approx(-left['equilibrium'])
    assert (right['low'], right['edge']) == pytest.approx((-left['edge'], -left['low']))
    assert centred['equilibrium'] == pytest.approx(0.0, abs=1e-12)
    assert left['low'] < left['equilibrium'] < left['edge'] < centred['edge']
    # For small offsets: the push must lead through F, which is to the left by beta's share.
    _, little = found('2.14', beta=math.pi - 1e-3)
    ahead, share, effective = 0.115, 0.2 / 0.7, 0.5 * 0.2 / 0.7
    assert little['equilibrium'] == pytest.approx(-share * 0.085e-3 / (effective - ahead),
                                                  rel=1e-3)


def test_another_origin_is_refused():
    with pytest.raises(ValueError, match="distance_from: got 'middle', expected one of centre"):
        found('2.6', distance_from='middle')
