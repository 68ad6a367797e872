"""Mesh of a push: lengths, speeds and steering of its steps."""

import math
from typing import Any

from helpers.push_problems import face_problem, HOLONOMIC, vertex_problem
import numpy as np
from push_model.geometry import Pose
from push_planner.problem import InitialMotion
from push_planner.settings import PlannerSettings
from push_planner.steered.collocation.mesh import build_mesh, SEGMENT_COUNT_STEP, SEGMENT_RATIO
from push_planner.steered.collocation.speed_profile import (
    MAX_RAMP_FRACTION, push_time, speed_profile)
import pytest

GOAL = Pose(1.5, 0.4, 0.5)
SETTINGS = {
    'braking': {},
    'soft start': {'acceleration': 0.2},
    'constant speed': {'deceleration': 0.0},
    'no final straight': {'final_straight': 0.0},
    'long ramps': {'pushing_speed': 0.5, 'acceleration': 0.05, 'deceleration': 0.05},
    'constant angles': {'pushing_angles': 'constant', 'acceleration': 0.2},
    'few constant angles': {'pushing_angles': 'constant', 'segments': 5, 'segment_length': 20.0}}


def mesh_of(path_length, refined=False, **settings):
    problem = face_problem(GOAL, **settings)
    straight = min(problem.settings.final_straight, 0.5 * path_length)
    return build_mesh(problem, path_length, straight, refined), straight


@pytest.mark.parametrize('settings', SETTINGS.values(), ids=SETTINGS)
@pytest.mark.parametrize('path_length', [0.1, 1.0, 6.0])
def test_steps_fill_the_path_and_their_speeds_join(settings, path_length):
    """Fixed and free parts sum up, and V is continuous, from the start to the end speed."""
    mesh, straight = mesh_of(path_length, **settings)
    free_length = 0.7
    lengths = mesh.step_lengths(free_length)
    assert mesh.free_fractions.sum() == pytest.approx(1.0)
    assert lengths.sum() == pytest.approx(mesh.fixed_length + free_length)
    assert (lengths > 0.0).all()
    profile = speed_profile(PlannerSettings(**settings), InitialMotion(), path_length)
    # The free part has one speed: ends of the steps do not depend on S.
    np.testing.assert_allclose(mesh.v_squared[1:], mesh.end_v_squared[:-1], rtol=1e-9)
    assert mesh.v_squared[0] == pytest.approx(profile.v_squared_start)
    assert mesh.end_v_squared[-1] == pytest.approx(profile.v_squared_end)
    assert mesh.v_squared.max() == pytest.approx(profile.v_squared_max)
    assert mesh.fixed_length == pytest.approx(
        profile.rise_length + max(profile.fall_length, straight))


@pytest.mark.parametrize('settings', SETTINGS.values(), ids=SETTINGS)
def test_times_of_the_steps_are_those_of_the_speed_profile(settings):
    """Summed over the steps, as in closed form over the ramps."""
    mesh, _ = mesh_of(3.0, **settings)
    free_length = 3.0 - mesh.fixed_length
    assert mesh.step_times(free_length).sum() == pytest.approx(
        push_time(PlannerSettings(**settings), 3.0))


def test_nothing_is_steered_in_the_final_straight():
    mesh, straight = mesh_of(3.0)
    ends = np.cumsum(mesh.step_lengths(3.0 - mesh.fixed_length))
    inside = ends > ends[-1] - straight + 1e-9
    assert (mesh.may_steer == np.where(inside, 0.0, 1.0)).all()


def test_constant_angles_jump_once_per_segment():
    """But not at the first, where the angle is set anyhow."""
    mesh, _ = mesh_of(1.0, pushing_angles='constant', segments=6, segment_length=20.0)
    main = mesh.free_fractions > 0.0
    assert mesh.may_steer[main].sum() == 5.0
    assert mesh.may_steer[~main].sum() == 0.0


@pytest.mark.parametrize('segments', [2, 3, 5, 24])
def test_segments_at_both_ends_of_the_main_section_are_shorter(segments):
    """Where there are more than four; and a push backwards would have the same mesh."""
    mesh, _ = mesh_of(0.2, segments=segments, segment_length=20.0, deceleration=0.0)
    fractions = mesh.free_fractions[mesh.free_fractions > 0.0]
    shorter = fractions < 0.75 * fractions.max()
    assert np.flatnonzero(shorter).tolist() == ([0, 1, segments - 2, segments - 1]
                                                if segments > 4 else [])
    np.testing.assert_array_equal(fractions, fractions[::-1])


@pytest.mark.parametrize('settings', SETTINGS.values(), ids=SETTINGS)
def test_a_divided_mesh_is_the_same_push(settings: dict[str, Any]) -> None:
    """In lengths, speeds, times and steering, up to the ends of all steps before."""
    mesh, _ = mesh_of(3.0, **settings)
    parts = 1 + np.arange(len(mesh.lengths)) % 3
    divided, ends = mesh.divided(parts), np.cumsum(parts) - 1
    np.testing.assert_allclose(np.cumsum(divided.step_lengths(0.7))[ends],
                               np.cumsum(mesh.step_lengths(0.7)))
    np.testing.assert_allclose(np.cumsum(divided.step_times(0.7))[ends],
                               np.cumsum(mesh.step_times(0.7)))
    np.testing.assert_allclose(divided.end_v_squared[ends], mesh.end_v_squared)
    np.testing.assert_array_equal(divided.may_steer[ends], mesh.may_steer)


def test_a_refined_mesh_has_twice_the_segments():
    coarse, fine = (mesh_of(3.0, refined)[0] for refined in (False, True))
    counts = [np.count_nonzero(mesh.free_fractions) for mesh in (coarse, fine)]
    assert counts[1] == 2 * counts[0]
    assert fine.fixed_length == pytest.approx(coarse.fixed_length)


def test_long_pushes_have_few_different_numbers_of_segments():
    """A program is built for each number; and segments are at most two thirds of the wheelbase."""
    problem = vertex_problem(GOAL, HOLONOMIC, segment_length=20.0)
    longest = SEGMENT_RATIO * problem.vehicle.wheelbase
    for path_length in np.linspace(24.5 * longest, 60.0 * longest, 20):
        count = np.count_nonzero(build_mesh(problem, path_length, 0.0).free_fractions)
        assert count % SEGMENT_COUNT_STEP == 0
        assert path_length / count <= longest < path_length / (count - SEGMENT_COUNT_STEP)


@pytest.mark.parametrize('start', [0.0, 0.1, 0.3])
@pytest.mark.parametrize('acceleration', [0.0, 0.2])
def test_ramps_of_near_goals_leave_a_constant_part(start, acceleration):
    """At a lower speed, which is no less than that at either end."""
    settings = PlannerSettings(pushing_speed=0.4, acceleration=acceleration)
    for path_length in (0.02, 0.1, 0.3, 2.0):
        profile = speed_profile(settings, InitialMotion(speed=start), path_length)
        assert profile.v_squared_max <= 0.4 ** 2
        assert profile.v_squared_max >= max(profile.v_squared_start, profile.v_squared_end) - 1e-12
        if profile.v_squared_max > max(start, settings.end_speed) ** 2 + 1e-9:
            ramps = profile.rise_length + profile.fall_length
            assert ramps <= MAX_RAMP_FRACTION * path_length + 1e-12
        rise = profile.v_squared_max - profile.v_squared_start
        if profile.rise_length > 0.0:
            rate = acceleration or settings.deceleration
            assert rise / profile.rise_length == pytest.approx(2.0 * rate)
            assert profile.rise_slope == pytest.approx(2.0 * rate)


def test_the_time_of_a_push_at_constant_speed_is_its_length_over_the_speed():
    assert push_time(PlannerSettings(deceleration=0.0), 0.6) == pytest.approx(0.6 / 0.15)
    assert math.isfinite(push_time(PlannerSettings(), 0.01))
