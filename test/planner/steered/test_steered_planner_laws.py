"""How plans change when the problem changes: symmetries, limits and monotone laws."""

import dataclasses
import math

from helpers.objects import box
from helpers.push_problems import (
    DIFFERENTIAL, face_problem, HOLONOMIC, MIRRORED_VERTEX, vertex_problem)
import numpy as np
from push_model.geometry import Pose
from push_planner.problem import PlannerSettings, PushProblem
from push_planner.steered.initial_guess.dubins_routes import routes, tightest_turns
from push_planner.steered.planner import plan_push
import pytest

GOAL = Pose(1.9, 0.7, -0.2)
UNEVEN = (0.4, 0.3, 0.35, 0.2)
ROBOTS = pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=lambda r: r.drive)


FAST = dataclasses.replace(HOLONOMIC, max_speed=5.0, max_yaw_rate=20.0)
FAST_PUSH = {'pushing_speed': 0.6, 'final_straight': 0.0, 'deceleration': 0.0}


def arc(curvature: float, angle: float) -> Pose:
    """Return the end of a circular arc from the origin along x, of so much rotation."""
    rotation = math.copysign(angle, curvature)
    return Pose(math.sin(rotation) / curvature, (1.0 - math.cos(rotation)) / curvature, rotation)


def mirrored(problem):
    """Return the mirror image about the x axis of a push at vertex 0 of a box."""
    friction = [support.friction_coefficient for support in problem.obj.supports]
    start, goal = problem.start, problem.goal
    return PushProblem(box(friction=friction[::-1]), problem.robot, MIRRORED_VERTEX,
                       Pose(start.x, -start.y, -start.theta), -problem.normal, -problem.heading,
                       Pose(goal.x, -goal.y, -goal.theta), problem.settings)


@ROBOTS
def test_the_mirror_image_is_pushed_in_the_mirror(robot):
    """Steering and motion change sign, the way stays."""
    problem = vertex_problem(GOAL, robot, normal=0.05, obj=box(friction=UNEVEN))
    one, other = plan_push(problem), plan_push(mirrored(problem))
    assert other.segment_ends[-1] == pytest.approx(one.segment_ends[-1], abs=1e-6)
    np.testing.assert_allclose(np.negative(other.pushing_angles), one.pushing_angles, atol=1e-4)
    sign = np.array([1.0, -1.0, -1.0])
    half = 0.5 * one.trajectory.duration
    np.testing.assert_allclose(sign * other.trajectory.at(half)['object_poses'],
                               one.trajectory.at(half)['object_poses'], atol=1e-4)


@ROBOTS
@pytest.mark.parametrize('scene', [Pose(0.0, 0.0, 2.5), Pose(-30.0, 12.0, -1.0)])
def test_the_place_of_the_scene_does_not_matter(robot, scene):
    """The plan moves along with everything else."""
    here = vertex_problem(GOAL, robot)
    one = plan_push(here)
    there = dataclasses.replace(here, start=scene @ here.start, goal=scene @ here.goal,
                                normal=here.normal + scene.theta,
                                heading=here.heading + scene.theta)
    other = plan_push(there)
    np.testing.assert_allclose(other.pushing_angles, one.pushing_angles, atol=1e-5)
    for time in np.linspace(0.0, one.trajectory.duration, 5):
        meant = scene @ Pose(*one.trajectory.at(time)['robot_poses'])
        np.testing.assert_allclose(other.trajectory.at(time)['robot_poses'], meant, atol=1e-5)


@pytest.mark.parametrize('problem', [
    vertex_problem(Pose(-1.0, 1.0, 2.0), final_straight=0.0, deceleration=0.0),
    vertex_problem(Pose(1.0, -2.0, -2.0), final_straight=0.0, deceleration=0.0),
    face_problem(Pose(-0.4, 0.9, 2.5), final_straight=0.0, deceleration=0.0)],
    ids=['vertex-to-the-left', 'vertex-to-the-right', 'face'])
def test_the_force_right_after_the_first_touch_keeps_to_the_planning_cone(problem):
    """Where a push steers at once, its first forces are the steepest."""
    rollout = plan_push(problem).motion.refined.rollout
    normal, tangential = rollout.step_forces[0]
    steepness = math.atan2(abs(tangential), normal) / problem.planning_cone_angle
    assert 0.9 < steepness < 1.05


@ROBOTS
def test_mass_does_not_matter_if_inertia_goes_with_it(robot):
    """Loads scale with the mass, so every force does."""
    light, heavy = (plan_push(vertex_problem(GOAL, robot, obj=box(mass=mass)))
                    for mass in (0.5, 8.0))
    np.testing.assert_allclose(heavy.pushing_angles, light.pushing_angles, atol=1e-5)
    assert heavy.switches[0].normal_impulse == pytest.approx(
        16.0 * light.switches[0].normal_impulse, rel=1e-4)


def test_slow_pushes_share_one_path():
    """Towards the quasi-static limit the way no longer depends on the speed, nor on inertia."""
    ways = [plan_push(face_problem(Pose(1.5, 0.5, 0.6), pushing_speed=speed)).segment_ends[-1]
            for speed in (0.01, 0.02, 0.04, 0.3)]
    assert abs(ways[1] - ways[0]) < 1e-4
    assert abs(ways[2] - ways[0]) < 5e-4
    assert abs(ways[3] - ways[0]) > 2.0 * abs(ways[2] - ways[0])


@ROBOTS
def test_twice_the_segments_are_no_slower(robot):
    """Every plan with 24 equal segments is also one with 48."""
    few, many = (plan_push(vertex_problem(GOAL, robot, segments=count)) for count in (24, 48))
    assert len(many.pushing_angles) - len(few.pushing_angles) == 24
    assert many.segment_ends[-1] <= few.segment_ends[-1] + 1e-3
    assert many.segment_ends[-1] >= 0.98 * few.segment_ends[-1]


@pytest.mark.slow
@pytest.mark.parametrize('robot, margins', [(DIFFERENTIAL, (0.8, 0.9, 1.0)),
                                            (HOLONOMIC, (0.4, 0.5, 0.6))])
def test_a_wider_cone_is_no_slower(robot, margins):
    """Whatever a narrow cone allows, a wide one does."""
    answers = [plan_push(vertex_problem(Pose(1.9, 1.3, 0.35), robot, cone_margin=margin))
               for margin in margins]
    assert len({answer.report['final_straight'] for answer in answers}) == 1
    ways = [answer.segment_ends[-1] for answer in answers]
    assert ways[0] >= ways[1] - 1e-5 and ways[1] >= ways[2] - 1e-5
    assert ways[0] > ways[2] + 5e-4


@pytest.mark.parametrize('goal', [GOAL, Pose(1.5, -0.6, 0.0), Pose(0.8, 0.5, 1.2)])
def test_the_optimum_lies_between_its_bounds(goal):
    """No shorter than z's Dubins way under the cone, no longer than the way that follows it."""
    problem = vertex_problem(goal, HOLONOMIC, pushing_speed=0.02)
    answer = plan_push(problem)
    route = routes(problem, tightest_turns(problem))[0]
    # The vehicle view is exact for the ellipsoid only; real supports turn a little differently.
    assert answer.segment_ends[-1] >= 0.97 * (route.path.length + route.final_straight)
    assert answer.segment_ends[-1] <= 1.03 * route.path_length


@pytest.mark.parametrize('side', [1.0, -1.0], ids=['left-first', 'right-first'])
@pytest.mark.parametrize('angle, back', [(1.0, 1.0), (1.5, 1.5), (2.5, 2.0)])
def test_a_fast_push_turns_once_to_either_side(side: float, angle: float, back: float) -> None:
    """A path of two turns, nearly the tightest, is planned, and no detour by a whole circle."""
    problem = face_problem(Pose(1.0, 0.0, 0.0), FAST, **FAST_PUSH)
    # Routes with a reserve keep to 0.85 of the curvature.
    curvature = 0.9 / 0.85 * tightest_turns(problem)[0].curvature
    z = Pose(*problem.vehicle.flat_output, problem.vehicle.angle)
    goal = z @ arc(side * curvature, angle) @ arc(-side * curvature, back) @ z.inverse()
    plan = plan_push(face_problem(goal, FAST, **FAST_PUSH))
    # The contact travels farther than z, as it swings out, and has to build up both turns.
    assert plan.segment_ends[-1] <= 1.15 * (angle + back) / curvature


def test_steady_turns_keep_to_the_curvature_limit():
    """On a long loop a differential drive turns as tightly as the planning cone lets it."""
    problem = vertex_problem(Pose(0.4, 1.2, 2.0), heading=0.05, normal=0.05)
    answer = plan_push(problem)
    highest, lowest = (turn.curvature for turn in tightest_turns(problem))
    motion = answer.trajectory
    x, y = problem.vehicle.flat_output
    z = np.array([Pose(*pose).transform((x, y)) for pose in motion.object_poses])
    ways = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(z, axis=0).T))])
    theta = motion.object_poses[:, 2]
    middle = np.searchsorted(ways, np.linspace(0.25, 0.7, 10) * ways[-1])
    step = np.searchsorted(ways, np.linspace(0.25, 0.7, 10) * ways[-1] + 0.3)
    curvatures = (theta[step] - theta[middle]) / (ways[step] - ways[middle])
    tightest = max(curvatures / np.where(curvatures > 0.0, highest, lowest))
    assert tightest == pytest.approx(1.0, abs=0.05)


def test_defaults_are_what_the_settings_say():
    """A problem without settings has the defaults."""
    assert vertex_problem(GOAL).settings == PlannerSettings()
