"""Planning on: from a plan to nearly the same push, to another goal or from where it is by now."""

import dataclasses
import math

from helpers.push_problems import DIFFERENTIAL, face_problem, vertex_problem
import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Contact
from push_planner.problem import InitialMotion
from push_planner.steered.continuation import plan_on
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
import pytest

PROBLEM = face_problem(Pose(1.5, 0.4, 0.5), start=Pose(0.3, -0.2, 1.0))
# Iterations that planning on takes at most, near the goal.
FEW = 8


@pytest.fixture(scope='module', name='former')
def make_former():
    return plan_push(dataclasses.replace(PROBLEM, goal=PROBLEM.start @ PROBLEM.goal))


@pytest.fixture(scope='module', name='of_drive')
def make_plan_of_a_drive():
    return plan_push(vertex_problem(Pose(2.5, 0.7, -0.2), DIFFERENTIAL))


def pushed_on(former, fraction, off=(0.0, 0.0, 0.0)):
    """Make the problem of pushing on after a fraction of the time, the object a little off."""
    now = former.trajectory.at(fraction * former.trajectory.duration)
    velocity, normal = now['contact_twists'][:2], now['contact_poses'][2]
    angle = wrap_angle(math.atan2(velocity[1], velocity[0]) - normal)
    return dataclasses.replace(
        former.problem, start=Pose(*(now['object_poses'] + off).tolist()),
        normal=float(normal + off[2]), heading=float(now['robot_poses'][2]),
        motion=InitialMotion(math.hypot(*velocity), float(now['object_twists'][2]), angle))


def assert_reaches_its_goal(plan):
    check = verify(plan)
    assert check.position_error < 1e-3 and check.heading_error < 2e-3
    assert check.friction_usage < 1.0


@pytest.mark.parametrize('moved', [(0.03, -0.02, 0.03), (-0.05, 0.05, -0.05)])
def test_a_goal_that_moved_takes_few_iterations(former, moved):
    """And ends in the same push as planned from nothing."""
    problem = dataclasses.replace(former.problem, goal=former.problem.goal @ Pose(*moved))
    again, anew = plan_push(problem, former), plan_push(problem)
    assert again.report['route'] == 'previous plan'
    assert again.report['iterations'] <= anew.report['iterations'] - 2
    assert again.trajectory.duration == pytest.approx(anew.trajectory.duration, rel=1e-3)
    assert_reaches_its_goal(again)


@pytest.mark.parametrize('off', [(0.0, 0.0, 0.0), (0.002, -0.001, 0.003)], ids=['on it', 'beside'])
@pytest.mark.parametrize('fraction', [0.1, 0.4, 0.6])
@pytest.mark.parametrize('which', ['former', 'of_drive'])
def test_a_push_in_motion_is_continued_in_few_iterations(which, fraction, off, request):
    """In the present motion, and it takes what is left of the time."""
    former = request.getfixturevalue(which)
    again = plan_on(pushed_on(former, fraction, off), former)
    assert again.report['iterations'] <= FEW
    assert again.trajectory.duration == pytest.approx(
        (1.0 - fraction) * former.trajectory.duration, rel=0.03)
    assert again.switches == ()
    assert_reaches_its_goal(again)


def test_plans_go_on_from_plans_that_went_on(former):
    """From goal to goal, and from pose to pose, without a route."""
    plan = former
    for _ in range(3):
        problem = pushed_on(plan, 0.2)
        plan = plan_on(dataclasses.replace(
            problem, goal=problem.goal @ Pose(0.01, 0.01, -0.01)), plan)
    assert_reaches_its_goal(plan)
    assert plan.trajectory.duration == pytest.approx(
        plan_push(plan.problem).trajectory.duration, rel=1e-3)


def test_angles_of_another_turn_count_the_same(former):
    """An object pose that has been wrapped is found on the path all the same."""
    problem = pushed_on(former, 0.4)
    wrapped = dataclasses.replace(
        problem, start=problem.start._replace(theta=problem.start.theta - 2.0 * math.pi))
    one, other = (plan_on(one, former) for one in (problem, wrapped))
    np.testing.assert_allclose(other.pushing_angles, one.pushing_angles, atol=1e-6)


@pytest.mark.parametrize('contact', [Contact('face', 2), Contact('vertex', 3)])
def test_another_contact_has_no_use_for_it(former, contact):
    assert plan_on(dataclasses.replace(former.problem, contact=contact), former) is None


def test_next_to_nothing_is_not_worth_it(former):
    assert plan_on(pushed_on(former, 0.995), former) is None


def test_a_plan_from_a_file_has_nothing_to_go_on_from(former, tmp_path):
    former.save(tmp_path / 'plan.npz')
    read = Plan.load(tmp_path / 'plan.npz')
    assert plan_on(former.problem, read) is None
    assert plan_push(former.problem, read).report['route'] != 'previous plan'


def test_a_far_goal_is_planned_from_nothing(former):
    """Where the rest of the former push would be a detour."""
    behind = dataclasses.replace(former.problem, goal=former.problem.start @ Pose(3.0, 0.0, 0.0))
    found = plan_push(behind, former)
    assert found.trajectory.duration == pytest.approx(
        plan_push(behind).trajectory.duration, rel=1e-3)
