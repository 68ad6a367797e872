"""Pushes under control: what the figures on goals and disturbances found, and laws they keep."""

import dataclasses
import math

from benchmarks.controller import cases
from helpers.study_outcomes import by_figure, numbers, quick_outcome_of, values_of
import numpy as np
from push_control.settings import ControlSettings
from push_model.friction import friction_center
from push_model.geometry import Pose
import pytest
from studies.chapter4 import disturbances, goals, other_objects, random_friction
from studies.chapter4.drawn_intervals import DrawnIntervals
from studies.chapter4.published_laws import dipole_direction, force_angle_direction
from studies.chapter4.repeated_push import median_interval
from studies.chapter4.setup import (
    CONTROL, DIPOLE, FEEDBACK, FORCE_ANGLE, KEPT_PATH, MPC, NO_JUMP_TEST, OBJECT_FRAME, OPEN_LOOP,
    OWN_PATH, planned_input, push, REPLANNED, SENSORS, TIME_LIMIT,
)
from studies.chapter4.support_friction import (
    angle_to_friction_center, box_at, friction_interval, friction_table, gaussian_friction,
    SUPPORTS,
)

pytestmark = [pytest.mark.physics, pytest.mark.slow]
STUDIES = by_figure(goals, random_friction, disturbances, other_objects)
SETTINGS = ControlSettings()
COLUMNS = ('y_m', 'theta_rad', 'rho_rad')


def values(figure, **overrides):
    """Return the values of a figure, some of them overridden."""
    return values_of(STUDIES[figure], **overrides)


def outcome(figure):
    """Compute a figure, with fewer pushes where it has many."""
    return quick_outcome_of(STUDIES[figure])


def findings(figure: str) -> dict[str, float]:
    """Return the findings of a figure as numbers."""
    return numbers(outcome(figure))


def test_sensors_are_those_of_the_benchmarks_and_filters_have_their_defaults():
    assert SENSORS['benchmark'] == cases.SENSORS
    assert CONTROL[FEEDBACK] == {} and CONTROL[MPC] == {'control_law': 'mpc'}
    assert CONTROL[KEPT_PATH] == pytest.approx({
        name: 3.0 * getattr(SETTINGS, name)
        for name in ('replan_lateral_error', 'replan_heading_error')})


def test_feedback_reaches_a_goal_without_mismatch() -> None:
    found, ends = findings('four-goals'), outcome('four-goals').tables['ends']
    for law in (FEEDBACK, OWN_PATH, KEPT_PATH, MPC):
        assert found[law] < 10.0
        # A fifth of the error with which a push may end.
        assert np.abs(ends[f'{law}_heading_error_rad']).max() < 0.4 * SETTINGS.heading_tolerance
    assert found[OPEN_LOOP] > 5.0 * max(found[FEEDBACK], found[REPLANNED])
    # All that is wrong for the plan in open loop is the first measured pose.
    given = values('4.4', sensors='exact')
    assert push(given, given.goal, OPEN_LOOP).position_error < 0.01


def test_feedback_loses_time_where_it_leaves_the_optimal_path() -> None:
    """It does so for errors of the sensors alone, and at the latest on a path of its own."""
    found = findings('4.2')
    assert 0.2 < found['loss'] < 2.0 and found['new_paths_own_path'] == 1.0
    assert found['new_paths_kept_path'] == 0.0 < found['new_paths_feedback']
    assert found['left'] < 0.4 and found['gain'] > 0.5


def test_plans_from_the_measured_pose_are_the_plan_where_nothing_is_wrong() -> None:
    given = values('4.2', sensors='exact')
    executed = push(given, given.goal, REPLANNED)
    planned = planned_input(executed.planned)
    assert goals.input_difference(executed.path, planned) < 0.1 * np.ptp(planned['rho_rad'])
    assert executed.position_error < 0.02


def test_feedback_reproduces_the_planned_input_where_nothing_is_measured_wrong():
    given = values('4.2', sensors='exact')
    executed = push(given, given.goal, FEEDBACK)
    planned = planned_input(executed.planned)
    assert executed.path['new_paths'][-1] == 0
    assert goals.input_difference(executed.path, planned) < 0.05 * np.ptp(planned['rho_rad'])
    # There the drive lags behind each change of the angle.
    assert push(given, given.goal, OBJECT_FRAME).position_error < 0.04


@pytest.mark.parametrize('law', [OPEN_LOOP, REPLANNED, FEEDBACK, FORCE_ANGLE, DIPOLE])
def test_a_mirrored_push_follows_a_mirrored_path(law):
    given = values('4.9', sensors='exact')
    left, right = (push(given, [1.0, side * 0.2, side * 0.3], law,
                        friction_interval(name, 1.5, 2.0, 4.0)).path
                   for side, name in ((1.0, 'left'), (-1.0, 'right')))
    for name in COLUMNS:
        np.testing.assert_allclose(left[name], -right[name], atol=1e-4)
    assert np.abs(left['theta_rad']).max() > 0.1


@pytest.mark.parametrize('turn', [0.0, 0.7, -2.5])
def test_published_laws_turn_with_the_world(turn: float) -> None:
    """On its path with the force along it the one goes on; behind the object so does the other."""
    frame = Pose(3.0, -1.0, turn)
    robot, goal = frame.transform((-0.4, 0.1)), frame.transform((2.0, 0.0))
    direction = dipole_direction(frame[:2], robot, goal)
    assert math.remainder(direction - turn - dipole_direction((0.0, 0.0), (-0.4, 0.1), (2.0, 0.0)),
                          math.tau) == pytest.approx(0.0, abs=1e-12)
    behind = frame.transform((-0.4, 0.0))
    assert math.remainder(dipole_direction(frame[:2], behind, goal) - turn,
                          math.tau) == pytest.approx(0.0, abs=1e-12)
    assert force_angle_direction(turn, turn, 0.0) == turn
    # Beyond the direction of the force, so that the contact comes back to the path.
    assert force_angle_direction(turn + 0.2, turn, 0.1) > turn + 0.2


@pytest.mark.parametrize('figure', ['4.9', '4.13'])
def test_feedback_tolerates_what_open_loop_does_not(figure):
    found = findings(figure)
    for law in (OPEN_LOOP, OBJECT_FRAME):
        assert found[law] > 40.0
    assert max(found[FEEDBACK], found[MPC]) < 5.0 < found['deviation'] < 20.0


def test_a_rotation_grows_in_the_world_and_only_adds_up_in_the_frame_of_the_object():
    found = findings('4.9')
    assert found['heading_open_loop'] > 1.3 * abs(found['heading_object_frame']) > 0.2


def test_plans_with_the_nominal_friction_undo_what_has_passed_but_not_what_lasts() -> None:
    temporary, sustained = findings('4.9'), findings('4.13')
    assert temporary[REPLANNED] < 5.0 < 0.2 * temporary[OBJECT_FRAME]
    assert sustained[OBJECT_FRAME] > 2.0 * sustained[REPLANNED] > 20.0 * sustained[FEEDBACK]


def test_a_test_for_jumps_makes_a_sustained_disturbance_harmless():
    found = findings('4.13')
    assert max(found[FEEDBACK], found[MPC]) < 2.0 and found[NO_JUMP_TEST] > 8.0


def test_spikes_of_the_pushing_angle_are_new_paths():
    """There are fewer of them with a greater threshold."""
    for figure in ('4.11', '4.15'):
        one = findings(figure)
        assert one['new_paths_kept_path'] < one['new_paths_feedback']
        assert one['variation_kept_path'] < one['variation_feedback']
        assert one['peak_feedback'] < 0.9 < one['peak_open_loop'] and one['delay'] < 2.0


def test_drawn_disturbances_differ_by_their_end_alone() -> None:
    given = values('4.10')
    temporary, sustained = (DrawnIntervals.of(given, is_sustained=lasts)
                            for lasts in (False, True))
    intervals = [temporary.interval(seed) for seed in range(200)]
    assert intervals == [sustained.interval(seed) for seed in range(200)]
    for name, low, high in zip(('factor', 'start', 'duration'), *zip(
            given.factors, given.start_times, given.intervals)):
        drawn = np.array([getattr(interval, name) for interval in intervals])
        assert low <= drawn.min() < drawn.max() <= high
        assert drawn.mean() == pytest.approx(0.5 * (low + high), abs=0.1 * (high - low))
    assert 70 < sum(interval.side == 'left' for interval in intervals) < 130
    for seed, interval in enumerate(intervals[:5]):
        (short, _), (long, _) = temporary(seed), sustained(seed)
        assert short.end - short.start == pytest.approx(interval.duration)
        assert dataclasses.replace(long, end=short.end) == short and long.end > TIME_LIMIT


def test_a_law_without_a_model_reaches_the_position_but_not_the_heading() -> None:
    """The force angle undoes what has passed; a dipole, which pulls, does not even hold then."""
    ends = outcome('4.10').tables['ends']
    assert ends[f'{FORCE_ANGLE}_position_error_m'].max() < 0.05
    assert (ends[f'{DIPOLE}_position_error_m'].min()
            > 2.0 * ends[f'{FEEDBACK}_position_error_m'].max())
    lasting = outcome('4.14').tables['ends']
    for law in (FORCE_ANGLE, DIPOLE):
        assert np.abs(lasting[f'{law}_heading_error_rad']).min() > 0.2
        assert (lasting[f'{law}_position_error_m'].min()
                > lasting[f'{FEEDBACK}_position_error_m'].max())


def test_open_loop_errors_grow_with_the_disturbance():
    given = values('4.13')
    errors = [push(given, given.goal, OBJECT_FRAME,
                   friction_interval('left', factor, 4.0, 100.0)).position_error
              for factor in (1.1, 1.4)]
    assert errors[1] > errors[0] + 0.1


def test_feedback_ends_its_push_through_the_friction_center():
    """It rolls the contact behind that centre, 6.7 cm aside while friction is changed."""
    sustained, temporary = findings('4.15'), findings('4.11')
    assert sustained['final_rho'] == pytest.approx(sustained['aim'], abs=0.06)
    assert sustained['rolled'] == pytest.approx(6.7, abs=1.0)
    assert abs(temporary['aim']) < 0.06 and abs(temporary['rolled']) < 1.0


def test_a_robot_wider_than_the_box_is_deep_is_stable_in_open_loop():
    """The curved pusher: the centre of friction is 0.2 m from the contact."""
    changes = friction_interval('left', 2.0, 4.0, 4.5)
    narrow, wide = (push(values('4.9', robot_radius=radius), [2.5, 0.0, 0.0], OPEN_LOOP, changes)
                    for radius in (0.1, 0.4))
    assert wide.position_error < 0.4 * narrow.position_error
    assert abs(wide.heading_error) < 0.2 < 0.5 < narrow.heading_error


def test_random_friction_costs_several_times_as_much_in_open_loop():
    found = findings('4.7')
    assert max(found[OPEN_LOOP], found[OBJECT_FRAME]) > 2.0 * max(found[FEEDBACK], found[MPC])
    assert found['wins'] >= 1.0 and found['worst_feedback'] < 10.0
    assert found['feedback_low'] <= found['feedback'] <= found['feedback_high']
    found = findings('4.6')
    assert found == findings('4.5')
    assert found['variation_feedback'] > 3.0 * found['variation_object_frame']
    # Each coefficient moves the centre by an eighth of the width, of its own relative size.
    assert found['shift'] == pytest.approx(100.0 * 0.2 * 0.2 / 2.0, rel=0.25)


def test_the_interval_of_a_median_covers_it_in_most_samples():
    draws = np.random.default_rng(0)
    hits = [one.low <= 0.0 <= one.high for one in
            (median_interval(draws.standard_normal(40)) for _ in range(200))]
    assert 0.92 < np.mean(hits) <= 1.0
    # Both ends of the range of four: the median is beside them with 2 (1 / 2)^4.
    assert median_interval(np.arange(4.0)).confidence == pytest.approx(0.875)
    assert median_interval(np.arange(40.0)).confidence >= 0.95


def test_other_objects_are_steered_better_than_open_loop():
    found = findings('disturbed-objects')
    assert found['worst_open_loop'] > 2.0 * max(found['worst_feedback'], found['worst_mpc'])
    assert found['worst_feedback'] < 3.0


def test_random_friction_depends_on_its_seed_alone():
    first, again, other = (gaussian_friction(seed, 0.2, 0.5, 5.0) for seed in (3, 3, 4))
    assert first == again != other
    factors = np.array([one.factor for one in gaussian_friction(0, 0.2, 0.1, 400.0)])
    assert factors.mean() == pytest.approx(1.0, abs=0.01)
    assert factors.std() == pytest.approx(0.2, abs=0.01)
    assert min(one.factor for one in gaussian_friction(0, 2.0, 0.1, 40.0)) == 0.0


def test_the_friction_table_holds_what_the_box_has():
    given = values('4.8')
    table = outcome('4.8').tables['friction']
    changes = disturbances.disturbance(disturbances.temporary_end, given)
    rough = box_at(given, changes, 5.0)
    assert [support.friction_coefficient for support in rough.supports] == [0.3, 0.3, 0.6, 0.6]
    row = list(table['time_s']).index(4.0)
    assert [table[name][row] for name in SUPPORTS] == [0.3, 0.3, 0.6, 0.6]
    assert table['center_y_m'][row] == pytest.approx(friction_center(rough)[1])
    assert table['center_y_m'][row] == pytest.approx(0.2 * (2.0 - 1.0) / (2.0 + 1.0))
    assert table['center_y_m'][[0, -1]] == pytest.approx(0.0, abs=1e-12)
    sides = {'left': 1.0, 'right': -1.0}
    for side, sign in sides.items():
        obj = box_at(given, friction_interval(side, 1.5, 0.0, 1.0), 0.5)
        friction = {support.y * sign > 0.0: support.friction_coefficient
                    for support in obj.supports}
        assert friction[True] == pytest.approx(1.5 * friction[False])
    with pytest.raises(ValueError, match='side'):
        friction_interval('top', 1.5, 0.0, 1.0)


def test_the_friction_center_is_straight_ahead_of_the_contact_until_it_moves():
    given, path = values('4.15'), outcome('4.15').tables[FEEDBACK]
    table = friction_table(given, (), 30.0)
    ahead = angle_to_friction_center(path, table)
    before = path['time_s'] < given.start_time
    assert np.abs(path['aim_rad'][before]).max() < 0.04
    # The face is flat: the middle of the box is half its length ahead.
    shifted = path['aim_rad'] - ahead
    assert shifted[~before] == pytest.approx(math.atan2(0.2 / 3.0, 0.2), abs=0.01)
