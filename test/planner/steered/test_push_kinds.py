"""Plans of every kind of contact, input and model: what must hold for each."""

import contextlib
import dataclasses
import math

from helpers.objects import box
from helpers.push_problems import (
    face_problem, HOLONOMIC, plan_fixtures, round_problem, vertex_problem)
import numpy as np
from push_model.contact import face_length
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure
from push_planner.problem import InitialMotion, PlanningFailed
from push_planner.steered.bounds import displacement_bound
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
import pytest

pytestmark = pytest.mark.slow
IDEAL = RoundRobot(0.17, 'holonomic', max_speed=5.0, max_yaw_rate=50.0, max_acceleration=100.0)
QUICK = RoundRobot(0.1, 'differential', max_yaw_rate=50.0, max_acceleration=100.0,
                   max_yaw_acceleration=1000.0)
BENT = Pose(1.5, 0.4, 0.5)
FIXED = {'robot_yaw': 'fixed', 'final_straight': 0.0}
ANSWERED = {
    'rolling face': face_problem(Pose(1.5, 0.05, 0.05), **FIXED),
    'rolling face, off centre': face_problem(Pose(1.2, -0.1, 0.02), offset=0.02, **FIXED),
    'rolling disc': round_problem(Pose(1.0, 0.5, 1.0), **FIXED),
    'rolling disc, any heading': round_problem(Pose(-0.8, 0.9, 0.0), heading_free=True, **FIXED),
    'rolling vertex': vertex_problem(Pose(1.0, 0.02, -0.75), HOLONOMIC, **FIXED),
    'point': face_problem(BENT, RoundRobot(0.0, 'holonomic')),
    'two constant angles': face_problem(Pose(0.8, 0.1, 0.2), IDEAL, pushing_angles='constant',
                                        segments=2, segment_length=20.0, final_straight=0.0),
    'six constant angles': face_problem(BENT, IDEAL, pushing_angles='constant', segments=6,
                                        segment_length=20.0, final_straight=0.0),
    'quasi-static': face_problem(BENT, motion_model='quasi_static'),
    'soft start': face_problem(BENT, acceleration=0.2),
    '1 m/s': face_problem(Pose(3.0, 0.8, 0.9), IDEAL, pushing_speed=1.0, deceleration=1.0),
    '0.05 m/s, behind': face_problem(Pose(-1.0, 0.3, 2.0), IDEAL, pushing_speed=0.05),
    'near': face_problem(Pose(0.1, 0.0, 0.0), IDEAL, pushing_speed=0.5),
    'far': face_problem(Pose(9.0, 4.0, 2.0), IDEAL, pushing_speed=0.5),
    'small box, far': vertex_problem(Pose(-3.0, -0.6, 1.0), QUICK, obj=box(side=0.1),
                                     pushing_speed=0.25, final_straight=0.0),
    'limited angle': face_problem(BENT, IDEAL, angle_limit='angle', max_pushing_angle=0.2),
    'unlimited': face_problem(BENT, IDEAL, angle_limit='none', pushing_speed=0.1),
}
plans, answer = plan_fixtures(ANSWERED)


def test_it_reaches_its_goal_when_integrated_again(answer):
    """By scipy, to a tenth of what is asked."""
    check = verify(answer)
    assert check.position_error < 1e-4
    assert check.heading_error < 1e-4
    assert answer.report['position_error'] < 1e-4


def test_it_is_no_quicker_than_its_displacement(answer):
    assert answer.trajectory.duration >= displacement_bound(answer.problem) - 1e-3
    assert answer.report['over_displacement_bound'] >= 1.0 - 1e-3


def test_the_contact_moves_as_rolling_asks_for(answer):
    """In place, or by R_p per radian along a face, or round a disc; never off its feature."""
    problem, motion = answer.problem, answer.trajectory
    local = np.array([Pose(*pose).inverse().transform(point) for pose, point in zip(
        motion.object_poses, motion.contact_poses[:, :2])])
    turned = motion.object_poses[:, 2] - motion.object_poses[0, 2]
    if problem.kind == 'held' or problem.contact.kind == 'vertex':
        np.testing.assert_allclose(local, np.broadcast_to(local[0], local.shape), atol=1e-9)
    elif problem.contact.kind == 'face':
        np.testing.assert_allclose(local[:, 1] - local[0, 1], problem.robot.radius * turned,
                                   atol=1e-9)
        assert np.abs(local[:, 1]).max() <= 0.5 * face_length(problem.obj, 3)
    else:
        np.testing.assert_allclose(np.hypot(*local.T), problem.obj.radius, atol=1e-9)
        share = problem.robot.radius / (problem.robot.radius + problem.obj.radius)
        around = np.unwrap(np.arctan2(local[:, 1], local[:, 0]))
        np.testing.assert_allclose(around - around[0], -share * turned, atol=1e-9)
    if problem.settings.robot_yaw == 'fixed':
        assert np.ptp(motion.robot_poses[:, 2]) == 0.0


def test_the_speed_rises_and_falls_as_asked(answer):
    """Never beyond the pushing speed; at the goal at the end speed; braking is constant."""
    motion, settings = answer.trajectory, answer.problem.settings
    speed = np.hypot(*motion.contact_twists[:, :2].T)
    assert speed.max() <= settings.pushing_speed + 1e-9
    assert speed[-1] == pytest.approx(settings.end_speed)
    rates = np.diff(speed) / np.diff(motion.times)
    assert rates.min() >= -settings.deceleration * (1.0 + 1e-6) - 1e-6
    assert rates.max() <= settings.acceleration * (1.0 + 1e-6) + 1e-6


def test_angles_are_of_the_kind_that_was_asked_for(answer):
    """Linear ones go on without a jump within their rate; constant ones are constant."""
    settings, angles = answer.problem.settings, answer.pushing_angles
    if settings.pushing_angles == 'constant':
        assert all(begin == end for begin, end in angles)
        changes = sum(a[1] != b[0] for a, b in zip(angles, angles[1:]))
        assert changes <= settings.segments - 1
        return
    assert all(a[1] == b[0] for a, b in zip(angles, angles[1:]))
    lengths = np.diff(answer.segment_ends, prepend=0.0)
    rates = np.abs(np.diff(angles, axis=1).ravel()) / lengths * np.max(answer.speeds, axis=1)
    # The correction of about 1e-3 rad per piece comes on top.
    assert rates.max() <= settings.max_angle_rate * 1.02
    if settings.angle_limit == 'angle':
        assert np.abs(angles).max() <= settings.max_pushing_angle + 0.01


def test_a_file_holds_all_of_a_plan(answer, tmp_path):
    """Read again it is the same push, checks itself, and plans on."""
    answer.save(tmp_path / 'plan.npz')
    again = Plan.load(tmp_path / 'plan.npz')
    assert again.problem == answer.problem
    for name in ('pushing_angles', 'segment_ends', 'speeds', 'switches'):
        assert getattr(again, name) == getattr(answer, name)
    np.testing.assert_array_equal(again.trajectory.robot_twists, answer.trajectory.robot_twists)
    assert verify(again) == verify(answer)


def test_a_file_that_is_no_plan_is_refused(tmp_path, plans):
    plans['point'].trajectory.save(tmp_path / 'other.npz')
    with pytest.raises(ValueError, match='got no plan, expected a Plan'):
        Plan.load(tmp_path / 'other.npz')


@pytest.mark.parametrize('radius, turn', [(0.5, 0.5), (0.17, 1.3), (0.05, -2.9)])
def test_a_rolling_contact_is_not_turned_off_its_face(radius, turn):
    """Refused before anything is solved, where the turn times R_p is beyond the half face."""
    problem = face_problem(Pose(2.0, 0.0, turn), RoundRobot(radius, 'holonomic'), **FIXED)
    if abs(turn) * radius <= 0.2:
        assert not _refused_for_turning(problem)
        return
    assert _refused_for_turning(problem)


def _refused_for_turning(problem):
    try:
        plan_push(problem)
    except PlanningFailed as failure:
        return failure.code is PlanFailure.LEAVES_CONTACT_FEATURE
    return False


def test_slow_dynamic_pushes_are_quasi_static():
    """The way at 2 cm/s is that without inertia."""
    ways = [plan_push(face_problem(BENT, pushing_speed=0.02, motion_model=model)).segment_ends[-1]
            for model in ('dynamic', 'quasi_static')]
    assert ways[0] == pytest.approx(ways[1], rel=2e-4)


@pytest.mark.slow
def test_more_segments_change_less_and_less():
    """Path lengths converge with the number of segments, which counts before a straight end."""
    answers = [plan_push(face_problem(Pose(2.0, 1.0, 0.3), IDEAL, segments=count,
                                      final_straight=0.2)) for count in (16, 32, 64, 128)]
    changes = np.abs(np.diff([answer.report['path_length'] for answer in answers]))
    assert changes[1] < changes[0] and changes[2] < 0.6 * changes[1] + 1e-4


@pytest.mark.slow
def test_more_freedom_is_no_slower():
    """Any heading beats a given one; no limit beats the cone; more constant angles beat fewer."""
    given = round_problem(Pose(0.5, 0.9, 0.4))
    free = dataclasses.replace(given, settings=dataclasses.replace(given.settings,
                                                                   heading_free=True))
    assert plan_push(free).trajectory.duration <= plan_push(given).trajectory.duration + 1e-3
    durations = [plan_push(face_problem(BENT, IDEAL, angle_limit=limit)).trajectory.duration
                 for limit in ('cone', 'none')]
    assert durations[1] <= durations[0] + 1e-3
    durations = [plan_push(face_problem(
        BENT, IDEAL, pushing_angles='constant', segments=count,
        segment_length=20.0)).trajectory.duration for count in (3, 12)]
    assert durations[1] <= durations[0] + 1e-3


def test_planning_again_from_a_previous_plan_finds_the_same_push():
    """With nothing changed the same way; with the goal moved a valid plan of the same turn."""
    problem = face_problem(BENT, IDEAL)
    former = plan_push(problem)
    same = plan_push(problem, previous=former)
    assert same.report['route'] == 'previous plan'
    assert same.trajectory.duration == pytest.approx(former.trajectory.duration, rel=1e-3)
    moved = plan_push(dataclasses.replace(problem, goal=Pose(1.47, 0.44, 0.52)), previous=former)
    assert moved.report['route'] == 'previous plan'
    assert verify(moved).position_error < 1e-4


@pytest.mark.parametrize('model', ['dynamic', 'quasi_static'])
def test_a_push_under_way_is_planned_on_from(model):
    """No touch, no jump; together with what was pushed it takes about as long as the whole."""
    problem = face_problem(BENT, IDEAL, motion_model=model, pushing_speed=0.3)
    former = plan_push(problem)
    time = 0.4 * former.trajectory.duration
    now = former.trajectory.at(time)
    velocity, gamma = now['contact_twists'][:2], now['contact_poses'][2]
    rho = math.remainder(math.atan2(velocity[1], velocity[0]) - gamma, 2.0 * math.pi)
    going = dataclasses.replace(
        problem, start=Pose(*now['object_poses']), normal=gamma, heading=now['robot_poses'][2],
        motion=InitialMotion(math.hypot(*velocity), now['object_twists'][2], rho))
    answer = plan_push(going, previous=former)
    assert answer.switches == ()
    assert answer.pushing_angles[0][0] == pytest.approx(rho, abs=3e-3)
    assert answer.trajectory.object_twists[0, 2] == pytest.approx(now['object_twists'][2],
                                                                  abs=0.01)
    check = verify(answer)
    assert check.position_error < 1e-4 and check.heading_error < 1e-4
    assert time + answer.trajectory.duration == pytest.approx(former.trajectory.duration, rel=0.01)


def test_a_correction_that_would_reverse_the_push_ends_a_trial_and_not_the_planner():
    """Two pieces for 5 m are too few for some ways: they are passed over."""
    point = RoundRobot(0.0, 'holonomic', max_speed=10.0, max_yaw_rate=50.0, max_acceleration=100.0)
    problem = face_problem(Pose(1.2, -0.6, 0.4), point, pushing_speed=0.25, deceleration=0.0,
                           segments=2, segment_length=20.0, final_straight=0.0, cone_margin=0.9,
                           friction_discount=1.0)
    with contextlib.suppress(PlanningFailed):
        assert verify(plan_push(problem)).position_error < 1e-3


def test_a_previous_plan_is_left_where_there_is_a_much_shorter_path():
    """Where the goal moves so that the loop of the former plan is not needed any more."""
    behind = face_problem(Pose(-0.4, 0.0, 0.3), IDEAL)
    former = plan_push(behind)
    ahead = dataclasses.replace(behind, goal=Pose(1.5, 0.0, 0.0))
    anew = plan_push(ahead, previous=former)
    assert anew.trajectory.duration <= 1.1 * plan_push(ahead).trajectory.duration
    assert anew.report['route'] != 'previous plan'
