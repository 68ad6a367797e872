"""A base that has stood although it was commanded does not set off by itself."""

import dataclasses
import math
from typing import NamedTuple

from push_control.behaviors.progress import MAX_SAFETY_STOPS
from push_control.events import TaskEvent
from push_control.settings import ControlSettings
from push_control.steered.controller import Controller
from push_control.task.stand_reasons import STOP_TIME_LIMIT
from push_control.task.status import TaskState
from push_control.task.supervisor import Supervisor
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_safety.layer import SafetyLayer
from push_safety.status import SafetyReason
from push_safety.stop import SafetyStop
from push_scenario.definition.loader import load_scenario
import pytest

SCENARIO = load_scenario('task_tap')
PERIOD = 0.02
LIMIT = ControlSettings().standstill_limit
LATE = SafetyReason.FOLLOWS_LATE.report(delay=0.5)
STOOD = SafetyReason.BASE_STOOD.report(duration=3.0)


class Drive(NamedTuple):
    """When a base that is commanded all the time was sent what, and how it ended."""

    layer: SafetyLayer
    commands: list[tuple[float, Twist]]

    def is_driven(self, start: float, end: float) -> bool:
        """Whether any command from a time to another was not zero."""
        return any(twist != STOP for time, twist in self.commands if start <= time < end)


def drive(length: float, *, limit: float = LIMIT, start: float = 2.0, duration: float = 15.0,
          word_at: float = math.inf, speed: float = 0.15, ratio: float = 0.0,
          silent: bool = False) -> Drive:
    """
    Drive ahead; for some time the base moves by a ratio of what is commanded, or is silent.

    Somebody lets the robot go on at ``word_at``, and is heard where it waits for that.
    """
    layer = SafetyLayer(SCENARIO.robot, SCENARIO.object, standstill_limit=limit)
    pose, twist, commands = Pose(0.0, 0.0, 0.0), STOP, []
    for i in range(round(duration / PERIOD)):
        time = i * PERIOD
        is_away = start <= time < start + length
        if not (is_away and silent):
            layer.observe(Odometry(time, pose, twist))
        if word_at <= time:
            layer.resume()
        command = layer.filter(Twist(speed, 0.0, 0.0), time)
        commands.append((time, command))
        twist = Twist(*((ratio if is_away else 1.0) * value for value in command))
        pose = pose @ Pose(*(PERIOD * value for value in twist))
    return Drive(layer, commands)


@pytest.mark.parametrize('length', [3.4, 5.0, 9.0])
@pytest.mark.parametrize('speed', [0.05, 0.15, 0.3])
def test_a_base_that_was_away_for_long_does_not_set_off_again(length: float,
                                                              speed: float) -> None:
    """Zeros are all that it gets, and the reason says what the robot waits for."""
    driven = drive(length, speed=speed)
    assert not driven.is_driven(2.0 + length, math.inf)
    assert driven.layer.awaits_resume
    assert driven.layer.report.code in (
        SafetyReason.BASE_STOOD, SafetyReason.ODOMETRY_WAS_MISSING)


@pytest.mark.parametrize('length', [0.3, 1.0, 2.0])
def test_a_base_that_was_away_for_a_moment_goes_on(length: float) -> None:
    """By itself, and within two seconds."""
    driven = drive(length)
    assert driven.is_driven(2.0 + length, 4.0 + length) and driven.layer.report is None


def test_somebody_lets_the_robot_go_on() -> None:
    """A word before the robot waits for it lets nothing go on; one after it does at once."""
    driven = drive(5.0, word_at=8.0)
    assert not driven.is_driven(7.0, 8.0)
    assert driven.is_driven(8.0, 8.1) and driven.layer.report is None
    # While the base is away still, the robot waits again.
    driven = drive(9.0, word_at=6.0, duration=6.1)
    assert driven.layer.report is None


def test_without_a_limit_the_robot_goes_on_by_itself() -> None:
    """As for a base that drops out now and then."""
    driven = drive(5.0, limit=math.inf)
    assert driven.is_driven(7.0, 15.0) and driven.layer.report is None


def test_a_base_that_moves_otherwise_is_no_base_that_was_stopped() -> None:
    """It is let go on by itself, and does not wait for anybody."""
    driven = drive(2.0, ratio=-1.0)
    assert driven.is_driven(9.0, 15.0) and driven.layer.report is None


@pytest.mark.parametrize('length, waits', [(5.0, True), (2.0, False)])
def test_odometry_that_was_missing_for_long_is_waited_after(length: float, waits: bool) -> None:
    """As of a base that was off; of one that is not commanded nothing is expected."""
    driven = drive(length, silent=True)
    assert driven.layer.awaits_resume is waits
    assert driven.is_driven(2.5 + length, 15.0) is not waits
    layer = SafetyLayer(SCENARIO.robot, SCENARIO.object, standstill_limit=LIMIT)
    for time in (0.0, length):
        layer.release()
        layer.observe(Odometry(time, Pose(0.0, 0.0, 0.0), STOP))
        layer.filter(STOP, time)
    assert layer.report is None


def test_a_clock_that_jumps_is_no_gap() -> None:
    """Whoever notices it says so."""
    layer = SafetyLayer(SCENARIO.robot, SCENARIO.object, standstill_limit=LIMIT)
    for time in (0.0, PERIOD, 100.0):
        if time == 100.0:
            layer.excuse_gap(100.0)
        layer.observe(Odometry(time, Pose(0.0, 0.0, 0.0), STOP))
        layer.filter(STOP, time)
    assert layer.report is None


@pytest.mark.parametrize('jump', [0.0, 3600.0])
def test_a_clock_that_is_set_ahead_lets_no_base_stand_for_longer(jump: float) -> None:
    """A person is awaited after the same time."""
    stop = SafetyStop(LIMIT)
    fault = SafetyReason.NOT_MOVING.report()
    waited = []
    for i in range(round(2.0 * LIMIT / PERIOD)):
        time = i * PERIOD
        if time == 50 * PERIOD:
            stop.excuse(jump)
        shift = jump if time >= 50 * PERIOD else 0.0
        stop.observe(Odometry(time + shift, Pose(0.0, 0.0, 0.0), STOP),
                     fault if i == 0 else None, 0.0)
        waited.append(stop.awaits_resume)
    assert waited.index(True) == pytest.approx(LIMIT / PERIOD, abs=1.5)


def supervisor() -> Supervisor:
    """Make a supervisor that waits, as its base was stopped."""
    made = Supervisor(SCENARIO.object, SCENARIO.robot, SCENARIO.control, SCENARIO.task.drive,
                      SCENARIO.task.supervision)
    made.set_goal(SCENARIO.goal.pose)
    wait(made)
    assert made.awaits_resume and made.state is TaskState.PLAN
    return made


def wait(made: Supervisor | Controller, duration: float = STOP_TIME_LIMIT + 2.0) -> None:
    """Let time pass for a robot that stands."""
    for i in range(round(duration / 0.1)):
        time = 0.1 * i
        odometry = Odometry(time, SCENARIO.robot_start, STOP)
        made.on_safety_report(None, STOOD)
        assert made.step(Observation(time, odometry, ObjectPose(
            time, SCENARIO.start.object.pose)), 0.1) == STOP


def test_a_task_waits_without_an_end_and_goes_on_when_it_is_told() -> None:
    """Nothing counts as a failure meanwhile."""
    made = supervisor()
    assert made.cause is STOOD and made.recoveries == 0
    made.resume()
    assert not made.awaits_resume and made.state is TaskState.PLAN
    assert made.history[-1].codes == (TaskEvent.RESUMED,)


def test_whoever_lets_a_task_go_on_has_looked_after_the_stops_before() -> None:
    """A base that is stopped by hand, once in each attempt, ends no task."""
    made = Supervisor(SCENARIO.object, SCENARIO.robot, SCENARIO.control, SCENARIO.task.drive,
                      SCENARIO.task.supervision)
    made.set_goal(SCENARIO.goal.pose)
    for _ in range(2 * MAX_SAFETY_STOPS):
        made.on_safety_report(None, LATE)
        made.on_safety_report(None, STOOD)
        made.resume()
        made.on_safety_report(None, None)
    assert made.state is not TaskState.FAILED
    for _ in range(MAX_SAFETY_STOPS):
        made.on_safety_report(None, LATE)
        made.on_safety_report(None, None)
    assert made.state is TaskState.FAILED


def test_another_goal_lets_a_task_go_on_and_the_end_of_it_does_not_move_the_robot() -> None:
    """A robot that was cancelled while it waits does not back off."""
    made = supervisor()
    made.set_goal(SCENARIO.goal.pose)
    assert not made.awaits_resume
    made = supervisor()
    made.cancel(TaskEvent.GOAL_CANCELLED.report())
    assert made.state is TaskState.IDLE and not made.awaits_resume
    made.set_goal(SCENARIO.goal.pose)
    assert not made.awaits_resume


def test_a_pause_while_the_robot_waits_ends_with_one_word() -> None:
    """That of the pause."""
    made = supervisor()
    made.pause()
    assert made.state is TaskState.PAUSED and not made.awaits_resume
    made.resume()
    assert made.state is TaskState.PLAN and not made.awaits_resume


def test_the_choice_is_one_of_two() -> None:
    """What is no choice is named with both."""
    assert ControlSettings(resume_after_stop='automatic').standstill_limit == math.inf
    assert ControlSettings(max_standstill=2.0).standstill_limit == 2.0
    with pytest.raises(ValueError, match='resume_after_stop.*on_request.*automatic'):
        dataclasses.replace(ControlSettings(), resume_after_stop='never')
