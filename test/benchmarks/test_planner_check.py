"""Open-loop check of plans in the benchmark: it follows long plans, and detects wrong ones."""

import dataclasses
import math

from benchmarks.planner.check import replay, SECTION_LENGTH
from helpers.push_problems import (
    DIFFERENTIAL, face_problem, HOLONOMIC, plan_fixtures, vertex_problem,
)
import numpy as np
from push_model.geometry import Pose
from push_planner.steered.verification.verification import verify
import pytest

pytestmark = pytest.mark.slow
LONG = {'deceleration': 0.0, 'final_straight': 0.0, 'max_path_length': 60.0}
PROBLEMS = {
    'steady turns': vertex_problem(Pose(-6.0, 1.0, 0.4), DIFFERENTIAL, **LONG),
    'far': vertex_problem(Pose(16.0, 5.0, 0.5), DIFFERENTIAL, **LONG),
    'holonomic': vertex_problem(Pose(9.0, -4.0, 0.5), HOLONOMIC, **LONG),
    'quasi-static': face_problem(Pose(-3.0, 1.0, 2.0), motion_model='quasi_static', **LONG),
}
plans, answer = plan_fixtures(PROBLEMS)


def test_long_plans_are_followed_to_their_goal(answer):
    """However long a steady turn or straight push is, none of its sections is."""
    driven, wheelbase = replay(answer), answer.problem.vehicle.wheelbase
    assert driven.path_length == pytest.approx(answer.report['path_length'])
    assert driven.path_length > 2.0 * SECTION_LENGTH * wheelbase
    assert driven.sections >= driven.path_length / (SECTION_LENGTH * wheelbase)
    assert driven.position_error < 1e-4 and driven.heading_error < 1e-3


def test_it_agrees_with_the_check_of_the_plan_itself(answer):
    """Two simulations of one plan, one by its samples, one by its segments."""
    own, driven = verify(answer), replay(answer)
    assert abs(own.position_error - driven.position_error) < 1e-4
    assert own.cone_usage == pytest.approx(
        driven.steepest / answer.problem.planning_cone_angle, abs=0.05)


@pytest.mark.parametrize('what, column', [('object_poses', 0), ('object_poses', 2),
                                          ('contact_poses', 2)])
def test_inconsistent_samples_are_detected(plans, what, column):
    """A plan that leaves its path, even if it ends well: both simulations see it."""
    answer = plans['steady turns']
    values = getattr(answer.trajectory, what).copy()
    count = len(values)
    bump = 0.01 * np.sin(math.pi * np.arange(count) / (count - 1)) ** 2
    values[:, column] += bump
    wrong = dataclasses.replace(answer, motion=dataclasses.replace(
        answer.motion.recorded(), trajectory=dataclasses.replace(
            answer.trajectory, **{what: values})))
    for found in (replay(wrong), verify(wrong)):
        assert found.position_error > 1e-3 or found.heading_error > math.radians(0.1)
