"""Planning: the robot stands until the object is known to be at rest, and then decides."""

import dataclasses
import math

from helpers.objects import box
from push_control.behaviors.behavior import Abort, BehaviorContext, NoPushNeeded
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.plan import PlanBehavior
from push_control.behaviors.progress import (
    MAX_INSPECTIONS, ProgressMonitor, REST_REPORT_TIME, REST_TIME_LIMIT, RETRY_TIME)
from push_control.events import PerceptionEvent, TaskEvent
from push_control.goal import TaskFailure, TaskGoal
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.supervision_settings import aimed_tolerances, SupervisionSettings
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.settings import DriveSettings
import pytest

PERIOD = 0.05
ROBOT, DRIVE, SUPERVISION = RoundRobot(radius=0.17), DriveSettings(), SupervisionSettings()
HOME, GOAL, THERE = Pose(0.0, 0.0, 0.0), Pose(1.0, 0.2, 0.3), Pose(2.0, 0.0, 0.0)


class Bench:
    """The behaviour, and measurements of a robot that stands."""

    def __init__(self, goal=GOAL, control=ControlSettings(), supervision=SUPERVISION,
                 robot=THERE):
        self.perception = TaskPerception(box(), ROBOT, control, supervision)
        self.progress = ProgressMonitor(supervision, aimed_tolerances(control, supervision))
        self.context = BehaviorContext(box(), ROBOT, control, DRIVE, supervision)
        self.robot, self.time = robot, 0.0
        self.start(goal)

    def start(self, goal):
        """Enter the state again."""
        goal = goal if isinstance(goal, TaskGoal) else TaskGoal(goal)
        self.behavior = PlanBehavior(self.context, self.progress, goal, lambda *_: None)

    def run(self, duration, speed=0.0):
        """Let time pass, in which the object rests or moves; the robot stands all the time."""
        for _ in range(round(duration / PERIOD)):
            self.time += PERIOD
            self.perception.update(Observation(
                self.time, Odometry(self.time, self.robot, STOP),
                ObjectPose(self.time, Pose(speed * self.time, 0.0, 0.0))))
            if not self.behavior.finished:
                assert self.behavior.step(self.perception, PERIOD) == STOP
                assert self.behavior.failure is None


def test_a_plan_is_requested_once_the_object_was_at_rest_for_long_enough():
    """From what is measured, with the tolerances that pushes aim at; then it is waited for."""
    bench = Bench()
    bench.run(SUPERVISION.min_averaging_time - PERIOD)
    assert bench.behavior.plan_request is None
    bench.run(3.0 * PERIOD)
    request = bench.behavior.plan_request
    assert request.object_pose == pytest.approx(HOME, abs=1e-6) and request.goal == GOAL
    assert request.robot_pose == pytest.approx(THERE, abs=1e-6)
    assert (request.position_tolerance, request.heading_tolerance) == bench.progress.aim
    bench.run(2.0)
    assert bench.behavior.plan_request is request
    assert not bench.behavior.finished and bench.behavior.waiting_cause is None


def test_a_plan_is_requested_from_poses_that_are_newer_than_the_goal():
    """Somebody may have moved the object before it came; what is measured later counts."""
    bench = Bench()
    bench.run(1.0)
    bench.start(TaskGoal(GOAL, since=bench.time + 0.3 + 0.5 * PERIOD))
    bench.run(0.3)
    assert bench.behavior.plan_request is None
    bench.run(2.0 * PERIOD)
    assert bench.behavior.plan_request is not None


def test_a_request_is_renewed_towards_where_the_goal_is_then():
    """Not the same request again."""
    bench = Bench()
    bench.run(1.0)
    request = bench.behavior.plan_request
    bench.behavior.move_goal(Pose(0.5, 0.0, 0.0))
    bench.behavior.renew_request()
    assert bench.behavior.plan_request is None
    bench.run(PERIOD)
    assert bench.behavior.plan_request is not request
    assert bench.behavior.plan_request.goal == Pose(0.5, 0.0, 0.0)


def test_an_object_at_its_goal_is_left_alone():
    """It is reached, and nothing is requested."""
    bench = Bench(goal=HOME)
    bench.run(1.0)
    assert bench.behavior.result is NoPushNeeded.REACHED and bench.behavior.finished
    assert bench.behavior.plan_request is None


def test_an_object_whose_poses_are_biased_is_looked_at_until_that_is_too_often():
    """Where they do not show that it is at its goal."""
    settings = dataclasses.replace(SUPERVISION, position_tolerance=0.02, heading_tolerance=0.035)
    bench = Bench(HOME, ControlSettings(pose_bias=0.03), settings)
    for _ in range(MAX_INSPECTIONS):
        bench.run(1.0)
        assert bench.behavior.result is NoPushNeeded.UNSEEN
        bench.start(HOME)
    bench.run(1.0)
    assert isinstance(bench.behavior.result, Abort)
    assert bench.behavior.result.cause.code is TaskEvent.GOAL_UNCERTAIN


@pytest.mark.parametrize('limit', [5.0, 30.0])
def test_a_goal_in_another_unit_is_no_task(limit):
    """It is named with its distance; one that is nearer than the limit is."""
    settings = dataclasses.replace(SUPERVISION, max_goal_distance=limit)
    bench = Bench(Pose(1.1 * limit, 0.0, 0.0), ControlSettings(), settings)
    bench.run(1.0)
    assert bench.behavior.result.failure is TaskFailure.NO_PLAN
    assert bench.behavior.result.cause.code is TaskEvent.GOAL_TOO_FAR
    assert bench.behavior.result.cause.values['distance'] == pytest.approx(1.1 * limit)
    bench = Bench(Pose(0.9 * limit, 0.0, 0.0), ControlSettings(), settings)
    bench.run(1.0)
    assert bench.behavior.plan_request is not None


def test_a_task_without_progress_is_given_up():
    """With the last failure in its reason."""
    bench = Bench()
    bench.run(1.0)
    for _ in range(SUPERVISION.max_attempts):
        bench.progress.count_attempt(BehaviorFailure.OBJECT_NOT_FOUND.report())
    bench.start(GOAL)
    bench.run(1.0)
    assert bench.behavior.result.failure is TaskFailure.NO_PROGRESS
    assert bench.behavior.result.cause.codes == (
        TaskEvent.ATTEMPTS_FAILED, BehaviorFailure.OBJECT_NOT_FOUND)


def test_no_plan_is_requested_soon_after_there_was_none():
    """Unless that is allowed."""
    bench = Bench()
    bench.run(1.0)
    bench.progress.delay_request(bench.time)
    bench.start(GOAL)
    bench.run(RETRY_TIME - 2.0 * PERIOD)
    assert bench.behavior.plan_request is None
    bench.run(3.0 * PERIOD)
    assert bench.behavior.plan_request is not None
    bench.progress.delay_request(bench.time)
    bench.progress.allow_request()
    bench.start(GOAL)
    bench.run(PERIOD)
    assert bench.behavior.plan_request is not None


def test_an_object_that_moves_by_itself_is_waited_for_and_given_up():
    """The reason is stated after a while, in all states of planning together."""
    bench = Bench()
    bench.run(REST_REPORT_TIME - PERIOD, speed=0.5)
    assert bench.behavior.waiting_cause is None
    bench.run(4.0 * PERIOD, speed=0.5)
    assert bench.behavior.waiting_cause.code is PerceptionEvent.OBJECT_MOVES
    bench.run(0.5 * REST_TIME_LIMIT, speed=0.5)
    bench.start(GOAL)
    bench.run(0.5 * REST_TIME_LIMIT - REST_REPORT_TIME - 1.0, speed=0.5)
    assert bench.behavior.result is None and bench.behavior.waiting_cause is not None
    bench.run(3.0, speed=0.5)
    assert bench.behavior.result.failure is TaskFailure.NOT_AT_REST
    assert bench.behavior.plan_request is None


def test_a_robot_that_seems_to_stand_in_the_object_is_moved_beside_it():
    """Before a plan starts there."""
    bench = Bench(robot=Pose(0.3, 0.0, 0.0))
    bench.run(1.0)
    request = bench.behavior.plan_request
    assert math.hypot(request.robot_pose.x, request.robot_pose.y) > 0.3 + 0.02
