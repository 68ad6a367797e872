"""A plan executed on another object than the one it was made for."""

import dataclasses
import math

from helpers.objects import box
from helpers.push_problems import DIFFERENTIAL, FACE, face_problem, vertex_problem
import numpy as np
from push_model.dynamics import Input, State
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
import pytest
from studies.analysis.time_integration import integrate, push_at_angles
from studies.chapter3.errors.mismatch_rollout import rollout

pytestmark = pytest.mark.physics
POINT = RoundRobot(0.0, 'holonomic', max_speed=5.0, max_acceleration=100.0)
ROUND = RoundRobot(0.35, 'holonomic', max_speed=5.0, max_acceleration=100.0)
FREE = {'deceleration': 0.0, 'final_straight': 0.0, 'segments': 6}
NEAR = Pose(1.5, 0.1, 0.1)
ROUGH_LEFT = box(friction=(0.27, 0.27, 0.33, 0.33))


def made(robot, speed=0.3, goal=NEAR, **settings):
    """Plan a push of the box at its face, at constant speed."""
    return plan_push(face_problem(goal, robot, pushing_speed=speed, **{
        **FREE, 'robot_yaw': 'fixed', 'cone_margin': 0.95, 'friction_discount': 1.0, **settings}))


@pytest.fixture(scope='module')
def point():
    """Push by a point, in constant pushing angles."""
    return made(POINT, pushing_angles='constant', goal=Pose(1.5, 0.3, 0.3))


@pytest.fixture(scope='module')
def wide():
    """Push by a wide robot on which the box lies stably."""
    return made(ROUND, pushing_angles='constant')


@pytest.mark.parametrize('open_loop', [False, True])
def test_a_plan_leads_to_its_goal_without_mismatch(point, wide, open_loop):
    for answer in (point, wide):
        found = rollout(answer, open_loop=open_loop)
        assert found.position_error < 2e-4
        assert abs(found.heading_error) < 2e-4
        assert found.friction_usage == pytest.approx(verify(answer).friction_usage, rel=1e-6)


def test_a_push_by_a_differential_drive_is_executed_as_well():
    answer = plan_push(vertex_problem(Pose(2.0, 0.5, -0.5), DIFFERENTIAL))
    assert rollout(answer).position_error == pytest.approx(verify(answer).position_error, abs=1e-6)
    assert rollout(answer, box(friction=(0.3, 0.3, 0.33, 0.3))).position_error > 1e-3


def test_the_push_is_that_of_constant_angles_on_the_true_object(point):
    """Integrated by another scheme, with the jumps computed separately."""
    lengths = np.diff(point.segment_ends, prepend=0.0)
    other = push_at_angles(ROUGH_LEFT, FACE, np.array(point.pushing_angles)[:, 0], lengths,
                           1.4 * 0.3)
    found = rollout(point, ROUGH_LEFT, speed_scale=1.4)
    assert found.position_error > 0.05
    assert found.pose == pytest.approx(other.end, abs=1e-5)


def test_an_open_loop_robot_imposes_the_motion_of_the_plan():
    """Slowly, where acceleration does not count: velocities taken from the plan's samples."""
    answer = made(ROUND, 0.02)
    motion = answer.trajectory
    problem = dataclasses.replace(answer.problem, obj=ROUGH_LEFT)

    def push(time, _):
        v_x, v_y, _ = motion.at(time)['robot_twists']
        return Input(v_x, v_y, 0.0, 0.0, 0.0)

    start = State(0.0, 0.0, 0.0, 0.0, 0.0, *problem.contact_point)
    _, states = integrate(ROUGH_LEFT, problem.rolling, push, start, [0.0, motion.duration])
    found = rollout(answer, ROUGH_LEFT, open_loop=True)
    assert found.position_error > 0.01
    assert found.pose == pytest.approx(Pose(*states[-1, :3]), abs=2e-4)


def test_friction_counts_as_the_speed_does(point):
    """Friction twice as high is the same as speed less by the root of two."""
    rough = rollout(point, box(friction=(0.6,) * 4))
    assert rough.position_error > 5e-3
    assert rollout(point, speed_scale=math.sqrt(0.5)).pose == pytest.approx(rough.pose, abs=1e-5)


def test_mass_does_not_matter_where_inertia_grows_alike(point):
    heavy = rollout(point, box(mass=5.0))
    assert heavy.position_error < 1e-5
    uneven = rollout(point, box(mass=5.0, inertia=box().inertia))
    assert uneven.position_error > 2e-4
    assert uneven.pose == pytest.approx(rollout(point, box(inertia=0.4 * box().inertia)).pose,
                                        abs=1e-6)


def test_a_wide_robot_holds_a_box_that_runs_away_from_a_point(wide):
    open_loop_point = rollout(made(POINT, pushing_angles='constant'), ROUGH_LEFT, open_loop=True)
    held = rollout(wide, ROUGH_LEFT, open_loop=True)
    assert held.friction_usage < 1.0
    assert 5.0 * held.position_error < open_loop_point.position_error


def test_a_robot_that_follows_the_object_is_not_open_loop():
    for answer in (plan_push(vertex_problem(Pose(2.0, 0.5, -0.5), DIFFERENTIAL)),
                   made(POINT, motion_model='quasi_static')):
        with pytest.raises(ValueError, match='plan: got .* expected a dynamic one of a point'):
            rollout(answer, open_loop=True)
