"""Warm start: the rest of a previous plan as a route."""

import dataclasses
import math

from helpers.push_problems import face_problem
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_planner.collocation.collocation import radau
from push_planner.collocation.dimensions import POINTS
from push_planner.initial_guess.previous_plan import previous_route
from push_planner.single_push.planner import plan_push
import pytest

PROBLEM = face_problem(Pose(1.5, 0.4, 0.5), start=Pose(0.3, -0.2, 1.0))


@pytest.fixture(scope='module', name='former')
def make_former():
    return plan_push(dataclasses.replace(PROBLEM, goal=PROBLEM.start @ PROBLEM.goal))


def from_sample(former, index):
    """Make the problem of going on from a sample of a plan."""
    motion = former.trajectory
    return dataclasses.replace(
        former.problem, start=Pose(*motion.object_poses[index].tolist()),
        normal=float(motion.contact_poses[index, 2]), heading=float(motion.robot_poses[index, 2]))


@pytest.mark.parametrize('fraction', [0.0, 0.3, 0.8])
def test_the_rest_is_what_the_former_plan_has_left(former, fraction):
    """Its length and rotation, and its poses in the frame of the present start."""
    motion = former.trajectory
    index = int(fraction * len(motion.times))
    problem = from_sample(former, index)
    route = previous_route(problem, former)
    steps = np.hypot(*np.diff(motion.contact_poses[index:, :2], axis=0).T)
    assert route.path_length == pytest.approx(steps.sum(), rel=1e-3)
    assert route.rotation == pytest.approx(motion.object_poses[-1, 2]
                                           - motion.object_poses[index, 2])
    w, _, theta, q_x, q_y, phi = route.nodes.T
    contacts = [problem.start.transform(point) for point in zip(q_x, q_y)]
    np.testing.assert_allclose(contacts, motion.contact_poses[index:, :2], atol=1e-12)
    np.testing.assert_allclose(theta[0], 0.0, atol=1e-12)
    np.testing.assert_allclose(phi, motion.robot_poses[index:, 2] - motion.robot_poses[index, 2],
                               atol=1e-12)
    speed = np.hypot(*motion.contact_twists[index:, :2].T)
    np.testing.assert_allclose(w * speed, motion.object_twists[index:, 2], atol=1e-12)
    assert route.final_straight <= 0.9 * route.path_length
    assert route.final_straight <= former.report['final_straight']


def test_the_guess_interpolates_the_rest(former):
    """At the nodes of any mesh; at their ends it is the start and the goal."""
    route = previous_route(from_sample(former, 40), former)
    lengths = np.full(10, route.path_length / 10)
    guess = route.guess(former.problem, lengths, radau(POINTS).points)
    assert guess.nodes.shape == (11, 6) and guess.rates.shape == (10, POINTS)
    np.testing.assert_allclose(guess.nodes[[0, -1]], route.nodes[[0, -1]], atol=1e-9)
    # The last Radau point of a step is its end.
    np.testing.assert_allclose(guess.rates[:, -1], guess.nodes[1:, 0], atol=1e-9)


def test_angles_of_another_turn_count_the_same(former):
    """An object pose that has been wrapped is found on the path all the same."""
    problem = from_sample(former, 40)
    wrapped = dataclasses.replace(
        problem, start=problem.start._replace(theta=problem.start.theta - 2.0 * math.pi))
    one, other = (previous_route(one, former) for one in (problem, wrapped))
    np.testing.assert_allclose(other.nodes, one.nodes, atol=1e-9)


@pytest.mark.parametrize('contact', [Contact('face', 2), Contact('vertex', 3)])
def test_another_contact_has_no_use_for_it(former, contact):
    assert previous_route(dataclasses.replace(former.problem, contact=contact), former) is None


def test_next_to_nothing_is_not_worth_it(former):
    assert previous_route(from_sample(former, -1), former) is None


def test_a_goal_that_moved_takes_fewer_iterations(former):
    """From the previous plan, and ends in the same push."""
    goal = former.problem.goal @ Pose(0.03, -0.02, 0.03)
    moved = dataclasses.replace(former.problem, goal=goal)
    again, anew = plan_push(moved, former), plan_push(moved)
    assert again.report['route'] == 'previous plan'
    assert again.report['iterations'] < anew.report['iterations']
    assert again.trajectory.duration == pytest.approx(anew.trajectory.duration, rel=1e-3)
