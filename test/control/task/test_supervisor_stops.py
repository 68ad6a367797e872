"""A supervisor that is stopped, or cannot go on, states why, and gives up after a while."""

import math
from types import SimpleNamespace

import numpy as np
from push_control.behaviors.progress import (
    MAX_SAFETY_STOPS, REST_REPORT_TIME, REST_TIME_LIMIT, RETRY_TIME)
from push_control.events import PerceptionEvent, TaskEvent
from push_control.goal import TaskFailure
from push_control.task.stand_reasons import MEASUREMENT_TIME_LIMIT
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.events import PushEvent
from push_model.geometry import distance, Pose
from push_model.observation import Observation
from push_model.plan_request import PlanFailure
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_safety.status import SafetyReason
from push_scenario.definition.loader import load_scenario
import pytest

PERIOD = 0.1
# Of object poses that come seldom, but are not stale [s].
SLOW_PERIOD = 0.25
SCENARIO = load_scenario('task_tap')
NO_MAP = TaskEvent.NO_USABLE_MAP.report(map_fault='no map')


def supervisor():
    """Make a supervisor with a goal."""
    made = Supervisor(SCENARIO.object, SCENARIO.robot, SCENARIO.control, SCENARIO.task.drive,
                      SCENARIO.task.supervision)
    made.set_goal(SCENARIO.goal.pose)
    return made


def measured(time, noise=(0.0, 0.0, 0.0)):
    """Observe a robot and an object at rest."""
    pose = Pose(*(a + b for a, b in zip(SCENARIO.start.object.pose, noise)))
    return Observation(time, Odometry(time, SCENARIO.robot_start, STOP), ObjectPose(time, pose))


@pytest.mark.slow
def test_poses_that_are_too_noisy_are_named_and_end_the_task():
    """With what their noise is, and what it should be; a moment of rest is no new beginning."""
    made, rng = supervisor(), np.random.default_rng(1)
    causes, has_rested = {}, False
    for time in np.arange(0.0, REST_TIME_LIMIT + 4.0, SLOW_PERIOD).tolist():
        noise = rng.standard_normal(3) * (0.0 if 39.0 < time < 40.0 else 0.02)
        assert made.step(measured(time, noise.tolist()), SLOW_PERIOD) == STOP
        causes[time] = made.status.state, made.cause
        has_rested = has_rested or made.plan_request is not None
    state, cause = causes[REST_REPORT_TIME + 1.0]
    assert state is TaskState.PLAN
    assert cause.code is PerceptionEvent.OBJECT_POSES_NOISIER_THAN_STATED
    assert cause.values['stated_position'] == pytest.approx(2.0)
    assert has_rested
    assert made.status.state is TaskState.FAILED
    assert made.status.failure is TaskFailure.NOT_AT_REST and made.plan_request is None


def test_a_hold_lasts_until_it_is_released():
    """Nothing is requested meanwhile; then the task goes on by itself."""
    made = supervisor()
    made.hold(NO_MAP)
    for i in range(30):
        assert made.step(measured(i * PERIOD), PERIOD if i else 0.0) == STOP
    assert made.cause is NO_MAP and made.plan_request is None
    made.hold(None)
    for i in range(30, 40):
        made.step(measured(i * PERIOD), PERIOD)
    assert made.plan_request is not None and made.cause is not NO_MAP


def test_plans_for_an_object_elsewhere_are_outlasted_for_seconds_and_named_within_a_minute():
    """They are requested again every second: whoever sends them may have been mistaken."""
    made = supervisor()
    elsewhere = load_scenario('task_tap').start.object.pose @ Pose(0.3, 0.0, 0.0)
    plan = SimpleNamespace(object_poses=np.array([elsewhere]))
    times = []
    for time in np.arange(0.0, 60.0, PERIOD).tolist():
        made.step(measured(time), PERIOD)
        if made.plan_request is not None:
            made.set_plan(plan)
            times.append(time)
    assert np.diff(times).min() > RETRY_TIME - PERIOD and times[-1] - times[0] > 5.0
    assert made.status.state is TaskState.FAILED
    assert TaskEvent.PLAN_STARTS_ELSEWHERE in made.status.codes


@pytest.mark.slow
def test_poses_that_stop_coming_end_the_task():
    """After a minute, with the reason that has stood there all the time."""
    made, last = supervisor(), measured(0.5)
    for time in np.arange(0.0, MEASUREMENT_TIME_LIMIT + 2.0, PERIOD).tolist():
        seen = measured(time) if time < 1.0 else measured(time)._replace(
            object_pose=last.object_pose)
        assert made.step(seen, PERIOD) == STOP
        if 1.5 < time < 50.0:
            assert made.status.state is TaskState.PLAN
            assert PushEvent.OBJECT_POSE_STALE in made.status.codes
    assert made.status.failure is TaskFailure.NO_MEASUREMENTS
    assert PushEvent.OBJECT_POSE_STALE in made.status.codes


def test_a_robot_that_is_stopped_again_and_again_fails_with_the_reason():
    """What is the same in state, history and failure."""
    made, stop = supervisor(), SafetyReason.FOLLOWS_LATE.report(delay=0.5)
    for number in range(MAX_SAFETY_STOPS):
        assert made.status.state is TaskState.PLAN and made.status.recoveries == number
        made.on_safety_report(stop, stop)
        made.step(measured(0.2 + number), 0.1)
        made.on_safety_report(None, None)
        made.step(measured(0.3 + number), 0.1)
    assert made.status.state is TaskState.FAILED
    assert made.status.failure is TaskFailure.ROBOT_STOPPED
    assert made.status.codes == (TaskEvent.ABORTED, SafetyReason.FOLLOWS_LATE)


def test_a_task_that_fails_names_what_stopped_the_robot_before() -> None:
    """It may be why; a stop in an earlier task is none of its reasons."""
    made, stop = supervisor(), SafetyReason.FOLLOWS_LATE.report(delay=0.5)
    for is_later_task in (False, True):
        if is_later_task:
            made.set_goal(SCENARIO.goal.pose)
        else:
            made.on_safety_report(None, stop)
            made.on_safety_report(None, None)
        time = made.perception.time + PERIOD
        while made.state is not TaskState.FAILED and time < 60.0:
            made.step(measured(time), PERIOD)
            if made.plan_request is not None:
                made.on_planning_failed(PlanFailure.NO_FEASIBLE_SITE, 'no site')
            time += PERIOD
        assert made.status.failure is TaskFailure.NO_PLAN
        assert (SafetyReason.FOLLOWS_LATE in made.status.codes) is not is_later_task


JUMP = SafetyReason.ODOMETRY_JUMPED.report(distance=2.0, rotation=90.0)
ELSEWHERE = Pose(5.0, 5.0, 1.0)
AHEAD = Twist(0.2, 0.0, 0.0)


def driven(made, count, twist):
    """Let a robot stand for a while, then drive; return the last observation."""
    last = measured(0.0)
    for i in range(count):
        last = measured(i * PERIOD)
        if i > count // 2:
            way = Pose((i - count // 2) * PERIOD * twist.v_x, 0.0, 0.0)
            pose = last.odometry.pose @ way
            last = last._replace(odometry=Odometry(last.time, pose, twist))
        made.step(last, PERIOD if i else 0.0)
    return last


def jump(made, last, pose, twist):
    """Let odometry jump to a pose, and the safety layer stop the robot for it."""
    made.on_safety_report(JUMP, JUMP)
    time = last.time + PERIOD
    observation = last._replace(time=time, odometry=Odometry(time, pose, twist))
    made.step(observation, PERIOD)
    return observation


def stand(made, last, count):
    """Let a robot stand that may go on."""
    made.on_safety_report(None, None)
    for i in range(1, count + 1):
        time = last.time + i * PERIOD
        made.step(measured(time)._replace(
            odometry=last.odometry._replace(time=time, twist=STOP)), PERIOD)


@pytest.mark.parametrize('state', [TaskState.PLAN, TaskState.IDLE, TaskState.PAUSED])
def test_a_robot_that_stands_is_where_its_odometry_jumps_to(state):
    """As by a reset of the simulator: nothing known holds; what was wanted stays, and is said."""
    made = supervisor()
    if state is TaskState.PAUSED:
        made.pause()
    elif state is TaskState.IDLE:
        made.stop(TaskEvent.NO_GOAL.report())
    last = jump(made, driven(made, 20, STOP), ELSEWHERE, STOP)
    stand(made, last, 1)
    assert made.status.robot_pose == pytest.approx(ELSEWHERE, abs=0.01)
    assert made.history[-1].state is state
    assert made.history[-1].codes == (TaskEvent.STARTED_OVER,)
    assert made.state is state and not made.history[-1].is_requested
    if state is TaskState.PLAN:
        assert made.plan_request is None
        stand(made, last._replace(time=last.time + PERIOD), 20)
        assert made.plan_request.robot_pose == pytest.approx(ELSEWHERE, abs=0.01)


def test_no_pose_of_the_object_is_believed_from_before_the_jump():
    """It stands where it is measured then, however long it was elsewhere."""
    made = supervisor()
    last = driven(made, 60, STOP)
    last = jump(made, last, ELSEWHERE, STOP)
    made.on_safety_report(None, None)
    there = Pose(3.0, 3.0, 0.0)
    for i in range(1, 20):
        time = last.time + i * PERIOD
        measured_pose = last.object_pose if i < 3 else ObjectPose(time, there)
        made.step(Observation(time, Odometry(time, ELSEWHERE, STOP), measured_pose), PERIOD)
    assert made.object_estimate.pose == pytest.approx(there, abs=0.01)
    assert made.plan_request.object_pose == pytest.approx(there, abs=1e-3)


def test_a_robot_that_drives_on_is_not_where_its_odometry_jumps_to():
    """The jump is not added up: the robot is where it was, a little less certain."""
    made = supervisor()
    last = driven(made, 20, AHEAD)
    before = made.status.robot_pose
    last = jump(made, last, ELSEWHERE, AHEAD)
    after = made.status.robot_pose
    assert math.hypot(after.x - before.x, after.y - before.y) < 0.03
    assert made.cause is JUMP
    stand(made, last, 5)
    assert distance(made.status.robot_pose, after) < 0.03


def test_a_robot_that_stands_at_once_while_it_drove_was_put_elsewhere():
    """It starts over there, once the safety layer lets it go on."""
    made = supervisor()
    last = jump(made, driven(made, 20, AHEAD), ELSEWHERE, STOP)
    assert made.status.robot_pose != pytest.approx(ELSEWHERE, abs=1.0)
    stand(made, last, 1)
    assert made.status.robot_pose == pytest.approx(ELSEWHERE, abs=0.01)
    assert made.state is TaskState.PLAN


def test_odometry_that_comes_back_has_not_jumped():
    """As after some garbage: what was known of the robot holds."""
    made = supervisor()
    last = driven(made, 20, STOP)
    before = made.status.robot_pose
    there = jump(made, last, ELSEWHERE, STOP)
    stand(made, jump(made, there, last.odometry.pose, STOP), 3)
    assert made.status.robot_pose == pytest.approx(before, abs=1e-3)
    assert not any(TaskEvent.STARTED_OVER in change.codes for change in made.history)
