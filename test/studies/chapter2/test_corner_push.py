"""Case study 1: laws of the box pushed at a corner, and findings of its figures."""

import math

from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
from push_model.friction import c_squared
from push_model.geometry import Pose
from push_sim_node.truth import ContactMode
import pytest
from studies.analysis.steady_turn import rotated_about, rotation_center, steady_force
from studies.chapter2.corner_push import (
    motion, quasi_static_limit, steady_rates, support_patterns, transients,
)
from studies.chapter2.corner_push.setup import (
    integrated_push, push_direction, pushed_box, steady_yaw_rates,
)
from studies.chapter2.corner_push.simulated_push import push_by_robot

pytestmark = pytest.mark.physics
STUDIES = by_figure(quasi_static_limit, motion, steady_rates, transients, support_patterns)


def findings_of(figure, **overrides):
    """Return the findings of a figure as numbers."""
    return numbers(outcome_of(STUDIES[figure], **overrides))


def box_and_direction():
    """Return the box of figure 2.20 and the direction in which it is pushed."""
    values = values_of(STUDIES['2.20'])
    return (pushed_box(values, values.mass, values.friction_coefficient),
            push_direction(values))


def test_dynamic_rate_falls_below_the_quasi_static_one_as_speed_grows():
    found = findings_of('2.19')
    assert found['decreases'] == 1.0
    assert found['slow_ratio'] > 0.999
    assert found['fast_ratio'] < 0.2
    assert found['simulation_error'] < 3e-4


def test_dynamic_rate_tends_to_the_quasi_static_one_with_the_square_of_the_speed():
    lacks = [1.0 - findings_of('2.19', max_speed=speed)['slow_ratio'] for speed in (2.0, 1.0)]
    assert 0.0 < lacks[1] < 1e-4
    assert lacks[0] / lacks[1] == pytest.approx(4.0, rel=0.01)


@pytest.mark.slow
def test_speed_counts_against_friction_and_size():
    """The ratio is one function of v^2 / (mu g L)."""
    base = findings_of('2.19')
    for change in ({'friction_coefficient': 1.2, 'max_speed': 5.0},
                   {'box_length': 1.6, 'box_width': 1.6, 'max_speed': 5.0}):
        other = findings_of('2.19', **change)
        assert other['half_speed'] == pytest.approx(2.0 * base['half_speed'], rel=1e-6)
        assert other['fast_ratio'] == pytest.approx(base['fast_ratio'], rel=1e-6)


def test_fastest_turn_is_where_the_ratio_is_one_half():
    """So it is where the moment of friction falls in proportion to the turn per way."""
    found = findings_of('2.19', corner_angle=-0.05)
    assert found['peak_speed'] == pytest.approx(found['half_speed'], abs=0.05)


def test_slow_turn_of_a_nearly_central_push_is_that_of_the_vehicle():
    """Turn per way is r sin(alpha) / (r^2 + c^2), with the supports' own c^2."""
    values = values_of(STUDIES['2.26'], corner_angle=-1e-3)
    direction = push_direction(values)
    for name in values.patterns:
        obj = pushed_box(values, 3.0, 0.3, support_pattern=support_patterns.PATTERNS[name])
        arm = math.hypot(*obj.outline[0])
        expected = arm * 1e-3 / (arm ** 2 + c_squared(obj, direction))
        rate = steady_yaw_rates(obj, direction, [1e-3])[0] / 1e-3
        assert rate == pytest.approx(expected, rel=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize('figure', ['2.21', '2.24'])
def test_mass_and_inertia_leave_the_steady_rate_as_it_is(figure):
    found = findings_of(figure)
    assert found['spread'] < 1e-6
    assert found['integrated_spread'] < 1e-6
    assert found['integration_error'] < 1e-6
    # What they change: force and time to the steady rate.
    assert found['force_ratio'] == pytest.approx(6.0 if figure == '2.21' else 1.0, rel=1e-6)
    rises = outcome_of(STUDIES[figure]).tables['rise']
    slow, fast = sorted(('rise_1_s', 'rise_4_s'), reverse=figure == '2.21')
    assert (rises[slow] < 0.8 * rises[fast]).all()


def test_mass_changes_the_transient_where_the_inertia_is_kept():
    found = findings_of('2.22')
    assert found['lightest'] > 1.3 * found['heaviest']
    assert found['plate_spread'] < 1e-6
    assert found['final_error'] < 2e-3


def test_time_of_the_transient_goes_with_inertia_about_the_corner_per_mass():
    arm = math.hypot(0.2, 0.2)
    found = findings_of('2.22')
    assert found['lightest'] / found['heaviest'] == pytest.approx(
        (0.02 / 0.5 + arm ** 2) / (0.02 / 3.0 + arm ** 2), rel=1e-3)
    found = findings_of('2.25')
    assert found['greatest'] / found['least'] == pytest.approx(
        (0.16 / 3.0 + arm ** 2) / (0.02 / 3.0 + arm ** 2), rel=1e-3)


def test_inertia_changes_the_transient():
    found = findings_of('2.25')
    assert found['greatest'] > 1.5 * found['least']
    assert findings_of('2.25', inertias=[0.02, 0.3])['greatest'] > 1.2 * found['greatest']


@pytest.mark.parametrize('figure', ['2.22', '2.25'])
def test_transients_end_at_the_steady_rate(figure):
    assert findings_of(figure, duration=4.0)['final_error'] < 1e-6


@pytest.mark.slow
def test_friction_spreads_the_rates_but_for_slow_pushes():
    assert findings_of('2.23')['spread'] > 2.0
    assert findings_of('2.23', max_speed=0.2)['spread'] < 0.2
    assert findings_of('2.23', friction_coefficients=[0.3, 0.31])['spread'] < 0.05


def test_support_patterns_spread_the_rates_of_slow_pushes():
    found = findings_of('2.26')
    assert found['slow_spread'] > 0.4
    assert found['fast_spread'] < 0.1
    assert findings_of('2.26', patterns=['corners', 'corners'])['spread'] == 0.0


def test_unknown_pattern_is_refused():
    with pytest.raises(ValueError, match="patterns: got 'none'.*corners"):
        findings_of('2.26', patterns=['none'])


def test_motion_becomes_the_circle_of_the_steady_turn():
    found = findings_of('2.20')
    assert found['radius_integrated'] == pytest.approx(found['radius_dynamic'], rel=1e-5)
    assert found['radius_dynamic'] > 1.5 * found['radius_quasi_static']
    assert found['rotation_quasi_static'] > 1.5 * found['rotation_dynamic'] > 0.0


def test_slow_motion_is_the_quasi_static_one():
    tables = outcome_of(STUDIES['2.20'], speed=0.02, duration=60.0).tables
    for column, tolerance in (('x_m', 2e-3), ('y_m', 2e-3), ('theta_rad', 2e-3)):
        assert tables['dynamic'][column] == pytest.approx(tables['quasi_static'][column],
                                                          abs=tolerance)


def test_rotation_center_is_at_rest():
    center = rotation_center((-0.2, 0.1), 0.4, 0.5, -0.8)
    for angle in (0.3, -2.0):
        assert rotated_about(center, angle).transform(center) == pytest.approx(center)
    step = rotated_about(center, -0.8e-6).transform((-0.2, 0.1))
    assert np.subtract(step, (-0.2, 0.1)) / 1e-6 == pytest.approx(
        (0.5 * math.cos(0.4), 0.5 * math.sin(0.4)), abs=1e-5)
    with pytest.raises(ValueError, match='omega: got 0'):
        rotation_center((-0.2, 0.1), 0.4, 0.5, 0.0)


@pytest.mark.parametrize('speed', [0.3, 1.0, 2.0])
def test_contact_simulation_turns_and_pushes_as_the_steady_turn(speed):
    obj, direction = box_and_direction()
    end = push_by_robot(obj, direction, speed, 0.1, 4.0)[-1]
    assert end.mode is ContactMode.STICK
    assert end.object_twist[2] == pytest.approx(steady_yaw_rates(obj, direction, [speed])[0],
                                                rel=2e-4)
    force_n, force_t = steady_force(obj, obj.outline[0], direction, speed, direction)
    assert math.atan2(end.force_t, end.force_n) == pytest.approx(math.atan2(force_t, force_n),
                                                                 abs=2e-3)


def test_contact_simulation_follows_the_integrated_motion():
    """From where the simulated turn is steady, both go along one path."""
    obj, direction = box_and_direction()
    truths = push_by_robot(obj, direction, 1.0, 0.1, 6.0)
    middle, end = truths[len(truths) // 2 - 1], truths[-1]
    states = integrated_push(obj, direction, 1.0, np.array([0.0, 3.0, 6.0]))
    moved = middle.object_pose.inverse() @ end.object_pose
    expected = Pose(*states[1, :3]).inverse() @ Pose(*states[2, :3])
    assert moved == pytest.approx(expected, abs=1e-3)
