"""Goals that replace each other, with a pursuit that is played here; no topic is needed."""

import dataclasses
import logging
import math
from types import SimpleNamespace

from geometry_msgs.msg import PoseStamped
from helpers.objects import bin_, box
import numpy as np
from push_control.events import TaskEvent
from push_control.goal import GoalOutcome, GoalProgress, PushGoal
from push_control.ros.goal_entry import GoalEntry
from push_control.ros.pursuit import settings_for_goal
from push_control.ros.start_state import StartState
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose
from push_ros.conversions.primitives import MessageRefused, to_pose_message, to_stamp
import pytest

FIRST, SECOND = (PushGoal(Pose(x, 0.0, 0.0)) for x in (1.0, 2.0))


class Robot:
    """A pursuit whose robot backs off after a goal until it is let go."""

    def __init__(self):
        self.is_commanding = False
        self.start_state = StartState.STARTED
        self.progress = GoalProgress()
        self.goals = []
        self.now, self.clock_offset = 100.0, 0.0

    def set_goal(self, goal):
        """Pursue a goal."""
        self.goals.append(goal)
        self.is_commanding = True

    def cancel(self, cause):
        """Back off."""

    def halt(self, cause):
        """Stand at once."""
        self.is_commanding = False


@pytest.fixture
def robot():
    """Make the pursuit."""
    return Robot()


@pytest.fixture
def goals(robot):
    """Make the entry of goals."""
    node = SimpleNamespace(reporter=SimpleNamespace(log=lambda *_: None),
                           get_logger=lambda: logging.getLogger('goals'),
                           now=lambda: to_stamp(robot.now + robot.clock_offset),
                           running_time=lambda: robot.now)
    return GoalEntry(node, robot, 'odom', is_lockstep=False)


def test_a_goal_for_another_object_waits_until_the_robot_stands(goals, robot):
    """The robot backs off from the former one; then the object is changed, then it begins."""
    done = []
    first = goals.start(FIRST)
    second = goals.start(SECOND, prepare=lambda: done.append(goals.is_idle))
    goals.update(1.0)
    assert robot.goals == [FIRST] and not done and first.outcome is None
    robot.is_commanding = False
    goals.update(2.0)
    assert first.outcome is GoalOutcome.REPLACED and robot.goals == [FIRST, SECOND]
    assert done == [True] and goals.current is second


def test_a_goal_that_is_replaced_at_once_is_told_before_the_next_begins(goals, robot):
    """Once, and with the reason."""
    ended = []
    first = goals.start(FIRST, on_end=lambda handle: ended.append((handle, list(robot.goals))))
    second = goals.start(SECOND)
    assert ended == [(first, [FIRST])] and robot.goals == [FIRST, SECOND]
    assert first.outcome is GoalOutcome.REPLACED
    assert first.cause.code is TaskEvent.GOAL_REPLACED
    assert goals.current is second and second.outcome is None


@pytest.mark.parametrize('end, outcome', [
    (lambda goals: goals.cancel(), GoalOutcome.CANCELLED),
    (lambda goals: goals.start(FIRST), GoalOutcome.REPLACED),
    (lambda goals: goals.interrupt(GoalOutcome.INTERRUPTED, TaskEvent.TIME_WENT_BACK.report()),
     GoalOutcome.INTERRUPTED)], ids=['cancelled', 'replaced', 'interrupted'])
def test_a_goal_that_waits_may_end(goals, robot, end, outcome):
    """It never begins, and its client is told once."""
    ended = []
    goals.start(FIRST)
    goals.start(SECOND, ended.append, prepare=lambda: pytest.fail('it begins'))
    end(goals)
    robot.is_commanding = False
    goals.update(1.0)
    goals.update(2.0)
    assert [handle.outcome for handle in ended] == [outcome]
    assert SECOND not in robot.goals


def test_a_cancelled_goal_ends_where_odometry_is_lost(goals, robot):
    """The robot cannot back off, and stands."""
    handle = goals.start(FIRST)
    goals.update(1.0)
    goals.cancel()
    goals.update(1.1)
    assert handle.outcome is None
    goals.on_odometry_lost()
    assert handle.outcome is GoalOutcome.CANCELLED and not robot.is_commanding
    assert handle.cause.code is TaskEvent.ODOMETRY_LOST


def test_a_clock_that_is_set_ahead_takes_no_time_of_a_goal(goals, robot) -> None:
    """Its limit is one of time that has passed."""
    handle = goals.start(dataclasses.replace(FIRST, time_limit=120.0))
    goals.update(100.0)
    goals.update(110.0)
    # Its odometry is refused for some seconds.
    robot.clock_offset, robot.now = 3600.0, robot.now + 12.0
    goals.on_odometry_lost()
    assert handle.pending_outcome is None and handle.elapsed_time == pytest.approx(12.0)
    goals.on_time_ahead(3600.0)
    for elapsed, outcome in ((13.0, None), (119.0, None), (121.0, GoalOutcome.TIMED_OUT)):
        goals.update(100.0 + 3600.0 + elapsed)
        assert handle.elapsed_time == pytest.approx(elapsed)
        assert handle.pending_outcome is outcome


def test_time_passes_where_odometry_is_lost(goals, robot):
    """From the goal on; the goal for another object begins then."""
    handle = goals.start(dataclasses.replace(FIRST, time_limit=5.0))
    robot.now += 4.0
    goals.on_odometry_lost()
    assert handle.outcome is None
    robot.now += 2.0
    goals.on_odometry_lost()
    assert handle.outcome is GoalOutcome.TIMED_OUT
    assert handle.last_feedback[1:] == pytest.approx((6.0, -1.0))
    goals.start(FIRST)
    second = goals.start(SECOND, prepare=lambda: None)
    goals.on_odometry_lost()
    assert goals.current is second


def test_a_goal_that_is_repeated_is_not_begun_again(goals, robot):
    """As by a source that publishes it all the time; once it has ended it is."""
    message = PoseStamped(pose=to_pose_message(FIRST.pose))
    message.header.frame_id = 'odom'
    for _ in range(3):
        goals.on_message(message, lambda: None)
    assert robot.goals == [FIRST] and goals.current.outcome is None
    message.pose.position.x = SECOND.pose.x
    goals.on_message(message, lambda: None)
    assert robot.goals == [FIRST, SECOND]
    robot.is_commanding = False
    goals.on_message(message, lambda: None)
    assert robot.goals == [FIRST, SECOND, SECOND]


def test_a_stopped_controller_takes_no_goal(goals, robot):
    """Until it is started."""
    message = PoseStamped(pose=to_pose_message(FIRST.pose))
    message.header.frame_id = 'odom'
    robot.start_state = StartState.STOPPED
    with pytest.raises(MessageRefused, match='controller/start'):
        goals.on_message(message, lambda: None)
    assert not robot.goals and goals.is_idle
    robot.start_state = StartState.STARTED
    goals.on_message(message, lambda: None)
    assert robot.goals == [FIRST]


def test_a_goal_is_abandoned_after_its_time(goals, robot):
    """From the first measurement on; it has timed out once the robot stands."""
    handle = goals.start(dataclasses.replace(FIRST, time_limit=5.0))
    for time in (10.0, 14.9):
        goals.update(time)
        assert handle.pending_outcome is None
    goals.update(15.1)
    assert handle.pending_outcome is GoalOutcome.TIMED_OUT and handle.outcome is None
    robot.is_commanding = False
    goals.update(15.2)
    assert handle.outcome is GoalOutcome.TIMED_OUT


@pytest.mark.parametrize('settings', [ControlSettings(), SupervisionSettings()],
                         ids=['single push', 'task'])
def test_a_goal_with_any_heading_is_one_in_both_modes(
        settings: ControlSettings | SupervisionSettings) -> None:
    """Also where the action has rounded its tolerance to single precision."""
    goal = PushGoal(FIRST.pose, heading_tolerance=float(np.float32(math.tau)))
    free = settings_for_goal(settings, goal)
    assert free.heading_tolerance >= math.tau
    with pytest.raises(ValueError, match='heading_tolerance: got 6.4, expected .* to 6.3'):
        PushGoal(FIRST.pose, heading_tolerance=6.4)


@pytest.mark.parametrize('is_free', [True, False])
def test_a_heading_that_a_goal_states_holds_for_a_round_object(is_free: bool) -> None:
    """Whatever the parameters say; a goal that states none leaves it to them."""
    settings = SupervisionSettings(disc_heading_free=is_free)
    stated = settings_for_goal(settings, PushGoal(FIRST.pose, heading_tolerance=0.02))
    for obj in (bin_(), box()):
        assert stated.for_object(obj).heading_tolerance == 0.02
        for goal in (None, FIRST, PushGoal(FIRST.pose, position_tolerance=0.03)):
            assert settings_for_goal(settings, goal).for_object(obj).heading_tolerance == (
                settings.for_object(obj).heading_tolerance)
