"""Plans of tasks: which of the two kinds of pushes a request is answered with."""

import math

from helpers.objects import box
import numpy as np
from push_model.contact import find_contact
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.trajectory import PushStyle
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.steered.contact_sites import site_problems
from push_planner.steered.site_selection import fastest_push
from push_planner.steered.task_push import plan_steered_push
from push_planner.task_plan import TaskPlan
from push_planner.task_planner import plan_for_request
import pytest

pytestmark = pytest.mark.slow
ROBOTS = {drive: RoundRobot(radius=0.17, drive=drive, max_speed=0.3, max_yaw_rate=1.9,
                            max_acceleration=0.9) for drive in ('differential', 'holonomic')}
SETTINGS, DRIVE = PlannerSettings(), DriveSettings()
HERE, START, GOAL = Pose(1.0, 2.0, 0.7), Pose(0.2, 1.1, 2.0), Pose(2.1, 2.6, 1.0)


def square(side: float) -> PushedObject:
    """Make a small object."""
    half = 0.5 * side
    corners = ((-half, -half), (half, -half), (half, half), (-half, half))
    return PushedObject(
        mass=1.0, inertia=side ** 2 / 6.0, outline=corners, contact_friction_coefficient=0.5,
        supports=tuple(Support(0.9 * x, 0.9 * y, 0.3) for x, y in corners))


def request(obj: PushedObject, goal: Pose = GOAL, robot: Pose = START) -> PlanRequest:
    """Request the next push."""
    return PlanRequest(HERE, robot, goal, obj)


def check_starts_in_contact(plan: TaskPlan, obj: PushedObject, robot: RoundRobot) -> None:
    """Check that the robot touches where the plan says."""
    start = plan.trajectory.robot_poses[0]
    contact, _, gap = find_contact(obj, HERE, start[:2], robot.radius)
    assert abs(gap) < 1e-6
    assert (contact.kind, contact.index) == (plan.contact.kind, plan.contact.index)


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('obj', [box(), square(0.12)], ids=['long faces', 'short faces'])
def test_a_task_is_done_by_straight_pushes(drive: str, obj: PushedObject) -> None:
    """Also by short faces where an object has no longer ones; the same push at every time."""
    robot = ROBOTS[drive]
    first, again = (plan_for_request(request(obj), robot, SETTINGS, DRIVE) for _ in range(2))
    assert first.trajectory.style is PushStyle.STRAIGHT
    np.testing.assert_array_equal(first.trajectory.object_poses, again.trajectory.object_poses)
    start = first.trajectory.robot_poses[0]
    assert distance(first.approach_path.poses[-1], start) < 1e-6
    assert first.remaining is None


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_tiny_object_gets_a_steered_push(drive: str) -> None:
    """It leads to the goal; the path of the robot ends at the standoff, along its heading."""
    robot, obj = ROBOTS[drive], square(0.03)
    plan = plan_for_request(request(obj), robot, SETTINGS, DRIVE)
    trajectory = plan.trajectory
    assert trajectory.style is PushStyle.STEERED
    check_starts_in_contact(plan, obj, robot)
    end = trajectory.object_poses[-1]
    assert distance(end, GOAL) < 2e-3 and abs(wrap_angle(end[2] - GOAL.theta)) < 2e-3
    standoff = Pose(*trajectory.robot_poses[0].tolist()) @ Pose(-DRIVE.standoff, 0.0, 0.0)
    assert plan.approach_path.poses[0] == pytest.approx(START)
    assert plan.approach_path.poses[-1] == pytest.approx(standoff, abs=1e-6)
    assert plan.expected_time > trajectory.duration


def test_after_failed_attempts_a_steered_push_keeps_to_a_smaller_cone() -> None:
    """Where that is possible, else it is planned as before."""
    wanted = request(box(), HERE @ Pose(2.0, 0.8, 0.4))
    usual, cautious = (plan_steered_push(wanted._replace(cone_fraction=fraction),
                                         ROBOTS['holonomic'], SETTINGS, DRIVE)
                       for fraction in (1.0, 0.6))
    angles = []
    for trajectory in (usual.trajectory, cautious.trajectory):
        v_x, v_y, _ = trajectory.contact_twists[1:-1].T
        gamma = trajectory.contact_poses[1:-1, 2]
        lateral = v_y * np.cos(gamma) - v_x * np.sin(gamma)
        forward = v_x * np.cos(gamma) + v_y * np.sin(gamma)
        angles.append(np.abs(np.arctan2(lateral, forward)).max())
    assert angles[1] < 0.7 * angles[0]


def test_the_time_of_the_path_to_a_site_counts() -> None:
    """A site to which the robot takes long loses to the next one."""
    problems = site_problems(box(), ROBOTS['holonomic'], HERE, GOAL, SETTINGS)
    best = fastest_push(problems).plan
    number = next(i for i, problem in enumerate(problems) if problem is best.problem)
    delays = [0.0] * len(problems)
    delays[number] = 100.0
    other = fastest_push(problems, delays).plan
    assert other.problem is not best.problem
    assert best.motion.duration <= other.motion.duration < 100.0 + best.motion.duration
    delays = [100.0] * len(problems)
    assert fastest_push(problems, delays).plan.problem is best.problem


def test_an_object_at_its_goal_needs_no_steered_push() -> None:
    """Within the tolerances of the request."""
    near = HERE @ Pose(0.005, 0.0, 0.0)
    with pytest.raises(PlanningFailed) as failure:
        plan_for_request(request(square(0.03), near), ROBOTS['holonomic'], SETTINGS, DRIVE)
    assert failure.value.code is PlanFailure.AT_GOAL


@pytest.mark.parametrize('obj', [box(), square(0.03)], ids=['straight', 'steered'])
def test_a_robot_that_gets_to_no_contact_has_no_plan(obj: PushedObject) -> None:
    """It stands in the object."""
    with pytest.raises(PlanningFailed) as failure:
        plan_for_request(request(obj, robot=HERE), ROBOTS['differential'], SETTINGS, DRIVE)
    assert failure.value.code is PlanFailure.NO_FEASIBLE_SITE
    assert 'the robot reaches no contact site' in failure.value.reason


def test_what_is_not_finite_is_refused() -> None:
    """By either kind of push."""
    spoilt = request(box(), GOAL._replace(x=math.nan))
    for plan in (plan_for_request, plan_steered_push):
        with pytest.raises(PlanningFailed) as failure:
            plan(spoilt, ROBOTS['differential'], SETTINGS, DRIVE)
        assert failure.value.code is PlanFailure.INVALID_VALUE
