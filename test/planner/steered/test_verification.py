"""Verification of plans: what it finds, and that it finds what is wrong."""

import dataclasses

from helpers.push_problems import face_problem
import numpy as np
from push_model.geometry import Pose
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.open_loop import open_loop_simulation, PushSegment
from push_planner.steered.verification.verification import (
    INTERVAL_WHEELBASES, merge_steady_segments, segments_of, verify,
)
import pytest

PROBLEM = face_problem(Pose(1.5, 0.4, 0.5))


@pytest.fixture(scope='module', name='plan')
def make_plan():
    return plan_push(PROBLEM)


def test_a_segment_ends_at_its_end():
    """After its duration: angle, speed and length are those of its end."""
    segment = PushSegment((0.1, 0.3), (0.1, 0.25), 0.4)
    angle, rate, speed = segment.at(segment.duration)
    assert (angle, speed) == pytest.approx((0.3, 0.25))
    assert rate == pytest.approx((0.3 - 0.1) / 0.4 * 0.25)
    times = np.linspace(0.0, segment.duration, 1001)
    speeds = np.array([segment.at(time)[2] for time in times])
    assert 0.5 * np.diff(times) @ (speeds[1:] + speeds[:-1]) == pytest.approx(0.4)
    angles = np.array([segment.at(time)[0] for time in times])
    rates = np.array([segment.at(time)[1] for time in times])
    np.testing.assert_allclose(np.gradient(angles, times)[1:-1], rates[1:-1], rtol=1e-4)
    assert segment.acceleration == pytest.approx((0.25 - 0.1) / segment.duration)


def test_segments_are_those_of_the_plan(plan):
    """Lengths sum up to the path; a speed scale leaves all but the speeds."""
    segments = segments_of(plan)
    assert sum(one.length for one in segments) == pytest.approx(plan.segment_ends[-1])
    assert sum(one.duration for one in segments) == pytest.approx(plan.trajectory.duration)
    for one, slow in zip(segments, segments_of(plan, speed_scale=0.5)):
        assert slow.angles == one.angles and slow.length == one.length
        assert slow.duration == pytest.approx(2.0 * one.duration)


def test_only_equal_steady_neighbours_are_merged():
    steady = PushSegment((0.1, 0.1), (0.2, 0.2), 0.3)
    other = PushSegment((0.2, 0.2), (0.2, 0.2), 0.1)
    ramp = PushSegment((0.1, 0.1), (0.2, 0.1), 0.1)
    merged = merge_steady_segments([steady, steady, other, ramp, ramp, steady])
    assert merged == [steady._replace(length=0.6), other, ramp, ramp, steady]


def test_the_simulation_follows_the_trajectory_of_the_plan(plan):
    """Segment by segment, from the start, it has the poses of the plan's own samples."""
    simulation = open_loop_simulation(PROBLEM)
    state, time = simulation.start(), 0.0
    for segment in segments_of(plan):
        state, _ = simulation.start_segment(state, segment)
        state, _ = simulation.integrate_segment(state)
        time += segment.duration
        sample = plan.trajectory.at(time)
        # Samples are interpolated linearly in between.
        np.testing.assert_allclose(state[:3], sample['object_poses'], atol=1e-3)


def test_a_shifted_goal_is_the_error_that_is_found(plan):
    """As large as the shift, in position and in heading."""
    goal = PROBLEM.goal
    shifted = dataclasses.replace(plan, problem=dataclasses.replace(
        PROBLEM, goal=Pose(goal.x + 0.03, goal.y - 0.04, goal.theta + 0.1)))
    own, found = verify(plan), verify(shifted)
    assert found.position_error == pytest.approx(0.05, abs=2.0 * own.position_error)
    assert found.heading_error == pytest.approx(0.1, abs=2.0 * own.heading_error)
    assert found.cone_usage == own.cone_usage


def test_a_free_heading_is_no_error(plan):
    free = dataclasses.replace(PROBLEM.settings, heading_free=True)
    turned = dataclasses.replace(plan, problem=dataclasses.replace(
        PROBLEM, settings=free, goal=PROBLEM.goal._replace(theta=2.0)))
    assert verify(turned).heading_error == 0.0


def test_mismatches_between_intervals_are_added_up():
    """A long plan with a wrong angle in the middle is not corrected by the restart after it."""
    plan = plan_push(face_problem(Pose(9.0, 1.0, 0.3)))
    sound = verify(plan)
    longest = INTERVAL_WHEELBASES * plan.problem.vehicle.wheelbase
    assert sound.intervals >= plan.segment_ends[-1] / longest > 1.0
    assert sound.position_error < 1e-3
    angles = list(plan.pushing_angles)
    middle = len(angles) // 2
    begin, end = angles[middle]
    angles[middle] = (begin, end + 0.02)
    wrong = dataclasses.replace(plan, motion=dataclasses.replace(
        plan.motion.recorded(), pushing_angles=tuple(angles)))
    assert verify(wrong).position_error > 10.0 * sound.position_error
