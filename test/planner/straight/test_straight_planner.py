"""Plans of straight pushes: they keep to their request, their robot and their kinematics."""

import dataclasses
import math

from helpers.objects import bin_, box
import numpy as np
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_control.task.repeated_pushes import cost_settings
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.plan_request import (
    ANY_HEADING, HEADING_TOLERANCE, PlanFailure, PlanRequest)
from push_model.trajectory import PushStyle
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.straight import planner
from push_planner.straight.planner import plan_straight_push
from push_planner.straight.trajectory import greatest_speed, MIN_SPEED, touch_speed
from push_primitives.cost_settings import CostSettings
from push_primitives.face_points import face_points
from push_primitives.weights import FrictionBelief
import pytest

pytestmark = pytest.mark.slow
BIN = bin_(feet=4)
ROBOT = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
HOLONOMIC = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9,
                       drive='holonomic')
HERE = Pose(1.0, 2.0, 0.7)
START = Pose(0.2, 1.1, 2.0)
GOALS = [Pose(1.5, 2.3, 0.9), Pose(1.03, 2.0, 0.72), Pose(-1.0, 3.0, -2.0)]


def request(goal=GOALS[0], **changes):
    """Return a request for the bin."""
    return PlanRequest(HERE, START, goal, BIN)._replace(**changes)


@pytest.fixture(scope='module', params=[ROBOT, HOLONOMIC], ids=['differential', 'holonomic'])
def robot(request):
    """Return a robot of each drive."""
    return request.param


@pytest.mark.parametrize('obj', [BIN, box()], ids=['bin', 'box'])
def test_what_the_first_task_needs_is_made_before_it(
        obj: PushedObject, robot: RoundRobot, monkeypatch: pytest.MonkeyPatch) -> None:
    """A planner warms up with the costs of a controller with default settings."""
    loaded: list[CostSettings] = []

    def load(_: PushedObject, __: RoundRobot, settings: CostSettings, ___: FrictionBelief) -> None:
        loaded.append(settings)
        raise ValueError('nothing is loaded')

    monkeypatch.setattr(planner, 'load_primitives', load)
    planner.warm_up(obj, robot, DriveSettings())
    assert loaded == [cost_settings(ControlSettings(), SupervisionSettings().for_object(obj),
                                    DriveSettings(), robot)]


def test_after_failed_attempts_a_free_heading_is_kept(robot: RoundRobot) -> None:
    """The robot then goes round an object that it has pushed past its goal."""
    goal = Pose(HERE.x + 0.03, HERE.y, HERE.theta + 2.0)
    plans = [plan_straight_push(request(goal=end, heading_tolerance=tolerance, cone_fraction=0.8),
                                robot)
             for end, tolerance in ((goal, ANY_HEADING),
                                    (goal._replace(theta=HERE.theta), HEADING_TOLERANCE))]
    assert plans[0].expected_time == plans[1].expected_time
    np.testing.assert_array_equal(*(plan.trajectory.robot_poses for plan in plans))


@pytest.mark.parametrize('goal', GOALS)
def test_a_plan_is_one_push_from_the_object_on(robot, goal):
    """It starts in contact where the path of the robot ends, and moves the object."""
    plan = plan_straight_push(request(goal), robot)
    trajectory = plan.trajectory
    assert trajectory.style is PushStyle.STRAIGHT
    np.testing.assert_allclose(trajectory.object_poses[0], HERE, atol=1e-12)
    away = math.dist(trajectory.robot_poses[0, :2], HERE[:2])
    assert away == pytest.approx(0.2 + 0.17, abs=1e-9)
    assert plan.contact.kind == 'round'
    end = plan.approach_path.poses[-1]
    np.testing.assert_allclose(end[:2], trajectory.robot_poses[0, :2], atol=1e-6)
    assert plan.approach_path.poses[0][:2] == pytest.approx(START[:2])
    assert trajectory.path_length == pytest.approx(plan.length, rel=1e-3)
    moved = math.dist(trajectory.object_poses[-1, :2], HERE[:2])
    assert 0.3 * plan.length < moved < 1.1 * plan.length
    assert plan.expected_time > trajectory.duration


@pytest.mark.parametrize('goal', GOALS)
def test_a_plan_states_the_line_that_its_samples_follow(robot, goal):
    """Start, direction, curvature and length as the samples have them, and the face there."""
    plan = plan_straight_push(request(goal), robot)
    trajectory, line = plan.trajectory, plan.trajectory.straight_line()
    assert line.length == plan.length
    assert line.curvature == plan.report['curvature']
    start = HERE.inverse() @ Pose(*trajectory.robot_poses[0].tolist())
    np.testing.assert_allclose(line.start[:2], start[:2], atol=1e-12)
    steps = np.diff(trajectory.robot_poses[:, :2], axis=0)
    directions = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])) - HERE.theta
    spacing = line.length / len(steps)
    first = line.start.theta + 0.5 * line.curvature * spacing
    assert math.remainder(directions[0] - first, math.tau) == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(np.diff(directions), line.curvature * spacing, atol=1e-9)
    contact = HERE.inverse().transform(trajectory.contact_poses[0, :2])
    nearest = min(face_points(BIN), key=lambda point: math.dist(point.position, contact))
    assert math.dist(nearest.position, contact) < 1e-3
    assert line.face == nearest.face


def test_drives_keep_their_kinematics():
    """A differential robot faces where it drives, a holonomic one keeps its heading."""
    trajectory = plan_straight_push(request(), ROBOT).trajectory
    headings = trajectory.robot_poses[:, 2]
    sideways = (-np.sin(headings) * trajectory.robot_twists[:, 0]
                + np.cos(headings) * trajectory.robot_twists[:, 1])
    np.testing.assert_allclose(sideways, 0.0, atol=1e-9)
    assert wrap_angle(plan_straight_push(request(), ROBOT).approach_path.poses[-1].theta
                      - headings[0]) == pytest.approx(0.0, abs=1e-6)
    held = plan_straight_push(request(), HOLONOMIC).trajectory
    np.testing.assert_allclose(held.robot_poses[:, 2], START.theta, atol=1e-12)
    assert not held.robot_twists[:, 2].any()


def test_velocities_are_those_of_the_poses(robot):
    """The robot's speeds integrate to its path; the contact moves with the object."""
    trajectory = plan_straight_push(request(), robot).trajectory
    speeds = np.hypot(*trajectory.robot_twists[:, :2].T)
    length = float((0.5 * (speeds[1:] + speeds[:-1]) * np.diff(trajectory.times)).sum())
    assert length == pytest.approx(trajectory.path_length, rel=1e-3)
    assert speeds[0] == pytest.approx(PlannerSettings().pushing_speed)
    assert speeds.max() <= greatest_speed(robot, PlannerSettings()) + 1e-9
    arms = trajectory.contact_poses[:, :2] - trajectory.object_poses[:, :2]
    np.testing.assert_allclose(np.hypot(*arms.T), 0.2, atol=0.01)
    rigid = trajectory.object_twists[:, :2] + trajectory.object_twists[:, 2:] * np.stack(
        [-arms[:, 1], arms[:, 0]], axis=1)
    np.testing.assert_allclose(trajectory.contact_twists[:, :2], rigid, atol=1e-12)


def test_taps_are_slow():
    """The speed grows with the length up to that of pushes."""
    settings = PlannerSettings(pushing_speed=0.2)
    lengths = np.linspace(0.003, 1.0, 200)
    speeds = np.array([touch_speed(length, settings) for length in lengths])
    assert speeds[0] == MIN_SPEED and speeds[-1] == 0.2
    assert (np.diff(speeds) >= 0.0).all()
    plan = plan_straight_push(request(GOALS[1]), ROBOT, settings)
    assert np.hypot(*plan.trajectory.robot_twists[:, :2].T).max() < 0.2


def test_long_pushes_are_faster_between_touch_and_end():
    """As fast as asked for and as the robot is; never slower than the touch."""
    settings = PlannerSettings(pushing_speed=0.12, straight_speed=0.25)
    speeds = np.hypot(*plan_straight_push(request(), ROBOT, settings)
                      .trajectory.robot_twists[:, :2].T)
    assert speeds[0] == pytest.approx(0.12) and speeds[-1] < 0.12
    assert speeds.max() == pytest.approx(0.25, rel=1e-6)
    for asked, limit, expected in ((0.25, 0.2, 0.2), (0.05, 0.5, 0.12), (0.25, 0.5, 0.25)):
        robot = dataclasses.replace(ROBOT, max_speed=limit)
        assert greatest_speed(robot, dataclasses.replace(
            settings, straight_speed=asked)) == expected


def test_the_frame_of_the_world_does_not_matter(robot):
    """The same task elsewhere has the same plan there."""
    frame = Pose(-3.0, 0.5, 2.5)
    first = plan_straight_push(request(), robot)
    other = plan_straight_push(request(frame @ GOALS[0], object_pose=frame @ HERE,
                                       robot_pose=frame @ START), robot)
    ends = [frame @ Pose(*first.trajectory.object_poses[-1].tolist()),
            Pose(*other.trajectory.object_poses[-1].tolist())]
    assert ends[0][:2] == pytest.approx(ends[1][:2], abs=1e-6)
    assert first.expected_time == pytest.approx(other.expected_time, abs=1e-3)


def test_what_cannot_be_planned_is_refused():
    """With the reason as an enum and in words."""
    corners = [2.0 * math.pi * i / 6 for i in range(6)]
    tiny = PushedObject(
        mass=1.0, supports=(Support(0.01, 0.0, 0.3), Support(-0.01, 0.01, 0.3),
                            Support(-0.01, -0.01, 0.3)),
        outline=tuple((0.02 * math.cos(a), 0.02 * math.sin(a)) for a in corners))
    cases = [(request(Pose(math.nan, 0.0, 0.0)), PlanFailure.INVALID_VALUE),
             (request(obj=tiny), PlanFailure.NO_FEASIBLE_SITE),
             (request(obj=bin_(feet=4, friction=0.0)), PlanFailure.NO_SUPPORT_FRICTION),
             (request(robot_pose=HERE), PlanFailure.NO_FEASIBLE_SITE)]
    for refused, code in cases:
        with pytest.raises(PlanningFailed) as failure:
            plan_straight_push(refused, ROBOT)
        assert failure.value.code is code and failure.value.reason
