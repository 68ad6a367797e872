"""Replanning while a push is under way, from late measurements."""

import dataclasses
import math

from helpers.objects import box
from helpers.push_problems import DIFFERENTIAL, face_problem, HOLONOMIC, vertex_problem
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_planner.problem import InitialMotion, PlannerSettings, PlanningFailed
from push_planner.steered.planner import plan_push
from push_planner.steered.replanning import plan_from_measurements, problem_from_measurements
from push_planner.steered.verification.verification import verify
import pytest

GOALS = {'differential': Pose(2.5, 0.7, -0.2), 'holonomic': Pose(1.5, 0.5, 0.8)}
DRIVES = pytest.mark.parametrize('drive', GOALS)
LATE = 0.08


@pytest.fixture(scope='module')
def plans():
    """Plan a curve for each drive."""
    return {'differential': plan_push(vertex_problem(GOALS['differential'], DIFFERENTIAL)),
            'holonomic': plan_push(face_problem(GOALS['holonomic'], HOLONOMIC))}


def seen(former, time, late=0.0):
    """Measure a planned push: the newest odometry, and an object pose that is late."""
    now, then = (former.trajectory.at(t) for t in (time, time - late))
    pose = Pose(*now['robot_poses'])
    v_x, v_y = Pose(0.0, 0.0, -pose.theta).rotate(now['robot_twists'][:2])
    return (ObjectPose(time - late, Pose(*then['object_poses'])),
            Odometry(time, pose, Twist(v_x, v_y, float(now['robot_twists'][2]))))


def present(former, measured, odometry, goal=None, **settings):
    """Make the problem of pushing on."""
    problem = former.problem
    return problem_from_measurements(
        problem.obj, problem.robot, measured, odometry, goal or problem.goal,
        dataclasses.replace(problem.settings, **settings))


@DRIVES
@pytest.mark.parametrize('time', [1.0, 3.3, 6.0])
def test_the_present_motion_is_that_of_the_plan(plans, drive, time):
    """Speed, angle and, by the model, the yaw rate; the late object pose is carried on."""
    former = plans[drive]
    problem = present(former, *seen(former, time, LATE))
    now = former.trajectory.at(time)
    v_x, v_y = now['contact_twists'][:2]
    angle = wrap_angle(math.atan2(v_y, v_x) - now['contact_poses'][2])
    speed, yaw_rate, pushing_angle = problem.motion
    assert speed == pytest.approx(math.hypot(v_x, v_y), rel=5e-3)
    assert pushing_angle == pytest.approx(angle, abs=5e-3)
    assert yaw_rate == pytest.approx(now['object_twists'][2], abs=0.01)
    late = former.trajectory.at(time - LATE)['object_poses']
    assert distance(problem.start, now['object_poses']) < 0.05 * distance(late,
                                                                          now['object_poses'])
    assert problem.start.theta == pytest.approx(now['object_poses'][2], abs=1e-3)


@DRIVES
@pytest.mark.parametrize('twist', [STOP, Twist(-0.1, 0.0, 0.0), Twist(0.005, 0.0, 0.0),
                                   Twist(0.0, 0.0, 0.5)], ids=['rest', 'back', 'creep', 'turn'])
def test_a_robot_that_does_not_push_starts_from_rest(plans, drive, twist):
    """The object is where it was measured, however long ago."""
    former = plans[drive]
    measured, odometry = seen(former, 0.0)
    problem = present(former, measured, Odometry(10.0, odometry.pose, twist))
    assert problem.motion == InitialMotion()
    assert problem.start == pytest.approx(measured.pose)


@DRIVES
def test_an_old_object_pose_is_not_carried_on(plans, drive):
    """The robot has driven 0.3 m since: it seems to be inside the object."""
    former = plans[drive]
    measured, odometry = seen(former, 4.0, 2.0)
    with pytest.raises(PlanningFailed, match='inside it'):
        present(former, measured, odometry)


@DRIVES
@pytest.mark.parametrize('known', [True, False], ids=['with the former plan', 'without'])
def test_the_rest_of_a_plan_is_planned_again(plans, drive, known):
    """It takes what was left, and begins with the present speed, angle and yaw rate."""
    former = plans[drive]
    problem, time = former.problem, 0.4 * former.trajectory.duration
    choice = plan_from_measurements(
        problem.obj, problem.robot, *seen(former, time, LATE), problem.goal, problem.settings,
        previous=former if known else None)
    motion, begin = choice.plan.problem.motion, choice.plan.trajectory.at(0.0)
    assert choice.candidates == ()
    assert choice.plan.trajectory.duration == pytest.approx(former.trajectory.duration - time,
                                                            rel=0.02)
    assert np.hypot(*begin['contact_twists'][:2]) == pytest.approx(motion.speed, rel=0.02)
    before = former.trajectory.at(time)
    for name in ('robot_twists', 'object_twists'):
        np.testing.assert_allclose(begin[name], before[name], atol=0.02)


@DRIVES
def test_another_goal_is_planned_from_the_present_motion(plans, drive):
    """No impulse is needed at its start, and it ends at the new goal."""
    former, goal = plans[drive], Pose(3.2, -0.6, -1.0)
    problem = former.problem
    found = plan_from_measurements(problem.obj, problem.robot, *seen(former, 3.0, LATE), goal,
                                   problem.settings, previous=former).plan
    assert found.switches == () and found.problem.motion.speed > 0.1
    assert distance(found.trajectory.object_poses[-1], goal) < 1e-3
    check = verify(found)
    assert check.position_error < 1e-3 and check.heading_error < 2e-3


@pytest.mark.slow
@DRIVES
def test_a_push_goes_on_at_its_site_though_another_is_quicker(plans, drive):
    """Sites are compared for robots at rest only."""
    former = plans[drive]
    problem = former.problem
    auto = dataclasses.replace(problem.settings, site='best', max_path_length=40.0)
    goal = problem.start @ Pose(-1.0, 0.2, 0.5)
    measured, odometry = seen(former, 2.0, LATE)
    going = plan_from_measurements(problem.obj, problem.robot, measured, odometry, goal, auto)
    assert going.candidates == ()
    assert going.plan.problem.contact.kind == problem.contact.kind
    rest = plan_from_measurements(problem.obj, problem.robot, *seen(former, 2.0)[:1],
                                  odometry._replace(twist=STOP), goal, auto)
    assert len(rest.candidates) > 8
    assert rest.plan.trajectory.duration < going.plan.trajectory.duration


@pytest.mark.slow
def test_where_the_present_motion_cannot_go_on_it_is_planned_as_from_rest():
    """A contact velocity far outside the cone is no start of a plan."""
    steep = Odometry(0.0, Pose(-0.37, 0.0, 0.0), Twist(0.06, 0.12, 0.0))
    goal, settings = Pose(1.5, 0.2, 0.1), PlannerSettings()
    measured = ObjectPose(0.0, Pose(0.0, 0.0, 0.0))
    problem = problem_from_measurements(box(), HOLONOMIC, measured, steep, goal, settings)
    assert problem.motion.pushing_angle == pytest.approx(math.atan2(0.12, 0.06))
    with pytest.raises(PlanningFailed):
        plan_push(problem)
    found = plan_from_measurements(box(), HOLONOMIC, measured, steep, goal, settings).plan
    assert found.problem.motion == InitialMotion()
