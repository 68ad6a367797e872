"""Planned pushes: what the figures on segments, speeds, cones and rolling contacts found."""

import math

from helpers.study_outcomes import by_figure, numbers, outcome_of, values_of
import numpy as np
from push_model.friction import c_squared
from push_planner.steered.planner import plan_push
import pytest
from studies.analysis.rolling_limits import quasi_static_force
from studies.analysis.time_integration import push_at_angles
from studies.chapter3 import (
    friction_cone, pose_to_pose, robot_radii, rolling_contact, segments, speed_mismatch, speeds,
    unlimited_angle,
)
from studies.chapter3.errors.mismatch_rollout import rollout
from studies.chapter3.setup import input_table, push_problem
from studies.framework.box import box

pytestmark = pytest.mark.physics
STUDIES = by_figure(friction_cone, speed_mismatch, robot_radii, unlimited_angle, rolling_contact,
                    segments, pose_to_pose, speeds)


def values(figure, **overrides):
    """Return the values of a figure, some of them overridden."""
    return values_of(STUDIES[figure], **overrides)


def found(figure, **overrides):
    """Compute a figure, some of its values overridden; return tables and findings."""
    outcome = outcome_of(STUDIES[figure], **overrides)
    return outcome.tables, numbers(outcome)


def mirrored(pose):
    """Mirror a pose at the x axis."""
    return [pose[0], -pose[1], -pose[2]]


def executed(given, inputs, speed, radius=0.0):
    """Integrate a table of inputs independently of the planner."""
    problem = push_problem(given, speed, 2, radius=radius)
    return push_at_angles(problem.obj, problem.contact, inputs['rho_rad'],
                          inputs['end_m'] - inputs['begin_m'], speed,
                          robot_radius=radius)


@pytest.mark.parametrize('figure, speed, radius', [
    ('3.1', 0.1, 0.0), ('rolling-plan', 0.1, 0.1), ('3.3', 0.25, 0.0), ('3.9', 0.1, 0.05)])
def test_the_inputs_of_a_figure_move_the_box_to_its_goal(figure, speed, radius):
    """By two integrations that share nothing with the planner's; and mirrored as well."""
    tables, findings = found(figure)
    given = values(figure)
    assert findings['miss'] < 1e-5
    end = executed(given, tables['inputs'], speed, radius).end
    np.testing.assert_allclose(end, given.goal, atol=2e-5)
    other = found(figure, goal=mirrored(given.goal))[0]['inputs']
    np.testing.assert_allclose(other['rho_rad'], -tables['inputs']['rho_rad'], atol=2e-3)
    np.testing.assert_allclose(other['end_m'], tables['inputs']['end_m'], rtol=1e-5)


def test_a_goal_straight_ahead_needs_no_angle_and_no_detour():
    tables, findings = found('3.3', goal=[1.2, 0.0, 0.0])
    assert np.abs(tables['inputs']['rho_rad']).max() < 1e-4
    assert findings['detour'] == pytest.approx(0.0, abs=1e-3)
    assert found('3.3')[1]['detour'] > 4.0


def test_more_segments_take_less_time_by_less_and_less():
    tables, findings = found('3.4')
    assert findings['never_longer'] == 1.0
    lost = tables['durations']['above_most_percent']
    assert 0.5 < findings['lost_fewest'] < 1.0 and findings['lost_six'] < 0.1
    assert (lost[:-2] > 2.0 * lost[1:-1]).all()
    assert 1.5 < findings['difference'] < 3.5
    assert found('3.4', segment_counts=[6, 2])[1]['never_longer'] == 0.0


def test_two_segments_cost_more_round_a_sharper_bend():
    lost = [found('3.4', goal=[1.2, side, 1.2 * side], segment_counts=[2, 12])[1]['lost_fewest']
            for side in (0.15, 0.3, 0.4)]
    assert 0.0 < lost[0] < lost[1] < lost[2]


def test_slow_pushes_to_one_goal_have_one_input_and_fast_ones_larger_angles():
    tables, findings = found('3.6')
    assert findings['angle_middle'] < 0.04 < 0.08 < findings['angle_fastest']
    assert findings['slowest'] / findings['fastest'] == pytest.approx(10.0, rel=0.02)
    assert 1.0 < findings['growth'] < 2.5 and findings['deviation'] < 3.0
    slow = found('3.6', speeds=[0.005, 0.025, 0.05])[1]
    assert slow['angle_fastest'] < 2e-3 and slow['growth'] < 0.02


def test_the_slowest_input_is_that_of_a_plan_without_inertia():
    given = values('3.6')
    slow = input_table(plan_push(push_problem(given, 0.05, given.segments,
                                              motion_model='quasi_static')))
    np.testing.assert_allclose(found('3.6')[0]['inputs_0.05']['rho_rad'], slow['rho_rad'],
                               atol=5e-3)


def test_push_and_force_keep_to_the_cone_and_switches_do_not():
    tables, findings = found('3.7')
    assert findings['push'] == pytest.approx(1.0, abs=0.01)
    assert findings['force'] < 0.6 and findings['first_touch'] < 1.0
    assert findings['outside'] == findings['switches'] == 5.0
    # Spread over the blend, the force that presses meanwhile makes up for the blow.
    assert 0.2 < findings['blend'] < 5.0
    assert found('3.7', speed=0.1)[1]['blend'] < 0.1 * findings['blend']
    assert np.isfinite(tables['force']['angle_rad']).all()
    assert (tables['force']['normal_N'] > 0.0).all()


def test_a_slow_force_is_that_of_friction_and_leans_half_as_far_as_a_small_push():
    """At the end of each segment; the centre of friction moves c^2 / (r^2 + c^2) as far aside."""
    given = values('3.3', goal=[1.2, 0.05, 0.06])
    problem = push_problem(given, 0.02, 6)
    inputs, force, _ = friction_cone.contact_forces(plan_push(problem), 0.02)
    obj, place = problem.obj, problem.contact_point
    for rho, end in zip(inputs['rho_rad'], inputs['end_s']):
        angle = force['angle_rad'][np.searchsorted(force['time_s'], end - 1e-6) - 1]
        f_n, f_t = quasi_static_force(obj, place, math.cos(rho), math.sin(rho))
        assert angle == pytest.approx(math.atan2(f_t, f_n), abs=2e-4)
        share = c_squared(obj, 0.0) / (place[0] ** 2 + c_squared(obj, 0.0))
        assert angle == pytest.approx(share * rho, abs=2e-3)


@pytest.mark.slow
def test_the_push_leaves_the_cone_above_a_speed_and_the_force_stays():
    tables, findings = found('3.8')
    leaves, cone = findings['leaves'], findings['cone']
    table = tables['steepest']
    assert 0.15 < leaves < 0.22
    assert ((table['push_rad'] > cone) == (table['speed_m_s'] > leaves)).all()
    for name in ('push_rad', 'force_rad', 'first_touch_rad'):
        assert (np.diff(table[name]) > 0.0).all()
    assert (table['force_rad'] < cone).all()
    assert findings['friction_fastest'] > 1.2 * findings['friction_slowest']
    assert found('3.8', contact_friction=1.2, speeds=[0.2, 1.0])[1]['leaves'] == 0.0


def test_the_speed_that_leaves_the_cone_counts_against_friction():
    """Four times the friction on the floor, twice the speed."""
    base, rough = (found('3.8', friction_coefficient=friction, speeds=[0.1, 1.0])[1]['leaves']
                   for friction in (0.3, 1.2))
    assert rough == pytest.approx(2.0 * base, abs=0.005)


def test_a_contact_travels_by_the_radius_for_each_radian():
    tables, findings = found('3.9')
    assert findings['travel'] == pytest.approx(1e3 * 0.05 * findings['rotation'])
    assert findings['rotation'] == pytest.approx(0.5, abs=1e-4) and findings['usage'] < 1.02
    assert findings['first'] < findings['first_of_point'] - 0.1
    assert found('3.9', robot_radius=1e-4)[1]['first'] == pytest.approx(
        findings['first_of_point'], abs=5e-3)
    assert found('rolling-plan')[1]['travel'] == pytest.approx(60.0, abs=0.01)
    assert found('3.1')[1]['travel'] == pytest.approx(0.0, abs=1e-6)


@pytest.fixture(scope='module')
def radii():
    """Plan the pushes of all robots once."""
    return found('3.10')


def test_robots_wider_than_the_friction_center_is_far_rotate_the_box_the_other_way(radii):
    tables, findings = radii
    robots, arm = tables['robots'], findings['arm']
    assert findings['rolling'] < 1e-9 and arm == pytest.approx(0.25)
    assert ((robots['most_left_rad'] > 0.05) == (robots['radius_m'] < arm)).all()
    assert findings['large_left'] < 1e-6
    assert ((robots['first_rad'] < 0.0) == (robots['radius_m'] < arm)).all()
    assert findings['travel'] < 0.5 * values('3.10').box_width
    assert findings['worst_radius'] in (0.2, 0.3) and 1.0 < findings['slower'] < 4.0


def test_inputs_of_all_radii_move_the_box_to_its_goal(radii):
    given = values('3.10')
    for radius in given.radii:
        inputs = radii[0][f'inputs_{round(1e3 * radius)}']
        end = executed(given, inputs, given.speed, radius).end
        np.testing.assert_allclose(end, given.goal, atol=5e-5)


def test_on_a_longer_box_the_wide_robots_rotate_it_as_the_small_ones_do():
    robots = found('3.10', box_length=1.4, goal=[4.0, 0.1, -0.05], radii=[0.05, 0.3, 0.5])[0][
        'robots']
    assert (robots['most_left_rad'] > 0.01).all() and (robots['first_rad'] < 0.0).all()


@pytest.mark.parametrize('radius', [0.1, 0.25, 0.4])
def test_the_shift_of_a_slow_push_grows_with_the_rotation_and_the_radius(radius):
    """For small rotations ``(y + c^2 theta / h)' = (1 - R_p / h) theta``: nothing is left at h."""
    obj = box(values('3.10'))
    problem = push_problem(values('3.10'), 0.01, 2, radius=radius)
    run = push_at_angles(obj, problem.contact, [-0.03, 0.04, 0.01], [0.3, 0.3, 0.3], 0.01,
                         robot_radius=radius)
    x, y, theta = run.states[:, :3].T
    arm = 0.25
    gained = y + c_squared(obj, 0.0) / arm * theta
    area = np.concatenate([[0.0], np.cumsum(0.5 * (theta[1:] + theta[:-1]) * np.diff(x))])
    np.testing.assert_allclose(gained, (1.0 - radius / arm) * area, atol=4e-5)
    assert np.abs(area).max() > 2e-3


@pytest.mark.slow
def test_an_input_drifts_with_the_square_of_the_speed():
    tables, findings = found('3.12')
    assert findings['least'] < 1e-5
    misses = tables['ends']['position_error_m']
    assert 0.015 < misses[1] < misses[2] < misses[3] < 0.3
    assert (misses[1], misses[3]) == (findings['next'], findings['fastest'])
    assert findings['slow'] < 0.25 * findings['next'] and findings['heading_fastest'] < -0.15
    assert 0.8 < findings['power'] < 1.0
    assert 0.1 < findings['friction'] < values('3.12').contact_friction
    # With slower pushes the power tends to one.
    slower = found('3.12', planned_speed=0.01, speeds=[0.03, 0.06], slow_speed=0.005)[1]
    assert slower['power'] == pytest.approx(1.0, abs=0.02) and slower['fastest'] < 0.006


@pytest.mark.slow
def test_the_input_misses_least_at_the_speed_that_it_was_planned_for():
    tables, findings = found('3.12', planned_speed=0.5)
    misses = tables['ends']['position_error_m']
    assert misses[2] == findings['least'] < 1e-5 < 0.05 < misses[1] < misses[0]


@pytest.mark.slow
def test_executed_inputs_agree_with_the_rollout_of_the_plan():
    given = values('3.12')
    base = plan_push(push_problem(given, given.planned_speed, given.segments))
    tables = found('3.12')[0]
    for number, speed in enumerate(given.speeds):
        other = rollout(base, speed_scale=speed / given.planned_speed)
        assert other.position_error == pytest.approx(tables['ends']['position_error_m'][number],
                                                     abs=1e-6)
