"""Approaches: a robot that faces the object, and one whose object is moved by others."""

import math
from typing import Callable, NamedTuple

from helpers.objects import box
from helpers.straight_pushes import straight_push
from push_control.behaviors.approach import (
    facing_path, FACING_SPACING, MovingApproach, StandoffApproach)
from push_control.behaviors.behavior import BehaviorContext
from push_control.behaviors.failures import BehaviorFailure, FailureReport
from push_control.perception.perception import TaskPerception
from push_control.perception.view import bearing
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.path import Path
from push_navigation.settings import DriveSettings
import pytest

OBJECT = Pose(0.5, 0.6, 0.3)
# Straight on, then a quarter of a circle to the left.
WAY_ROUND = Path((Pose(0.0, 0.0, 0.4), Pose(1.0, 0.0, 0.4), Pose(1.5, 0.5, 0.4)),
                 (0.0, 0.5 * math.pi))


def test_a_holonomic_base_faces_the_object_on_the_same_way():
    """At every pose but the first, where it stands already."""
    path = facing_path(WAY_ROUND, OBJECT)
    assert path.poses[0] == WAY_ROUND.poses[0]
    assert path.poses[-1][:2] == pytest.approx(WAY_ROUND.poses[-1][:2])
    assert path.length == pytest.approx(WAY_ROUND.length)
    assert max(segment.length for segment in path.segments) < FACING_SPACING + 1e-9
    for pose in path.poses[1:]:
        assert bearing(pose, OBJECT) == pytest.approx(0.0, abs=1e-9)


def test_it_turns_the_short_way_from_one_pose_to_the_next():
    """Also where the direction of the object passes the seam of angles."""
    path = facing_path(WAY_ROUND, Pose(0.5, -0.3, 0.0))
    turns = [after.theta - before.theta for before, after in zip(path.poses[1:], path.poses[2:])]
    assert max(map(abs, turns)) < 0.5


ROBOT = RoundRobot(radius=0.17, drive='holonomic', max_speed=0.3, max_yaw_rate=1.9,
                   max_acceleration=0.9)
CONTEXT = BehaviorContext(box(), ROBOT, ControlSettings(), DriveSettings(), SupervisionSettings())
# Time at which the object starts to move [s], and that up to which the robot is watched.
MOVES_AT, END, STEP = 3.0, 6.0, 0.025


class Halt(NamedTuple):
    """When the robot first stands after the object has moved, how often, and why it gave up."""

    time: float
    halts: int
    failure: FailureReport | None


def approach(object_x: Callable[[float], float], period: float) -> Halt:
    """
    Approach an object from 2 m away.

    :param object_x: x of the object over time [m].
    :param period: of its poses [s].
    """
    perception = TaskPerception(box(), ROBOT, CONTEXT.control, CONTEXT.supervision)
    behavior = MovingApproach(CONTEXT, straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.3))
    pose, time, command, halts = Pose(-2.0, 1.0, 0.0), 0.0, STOP, []
    measured = ObjectPose(0.0, Pose(object_x(0.0), 0.0, 0.0))
    while time < END and behavior.failure is None and not behavior.finished:
        time += STEP
        v_x, v_y = pose.rotate(command[:2])
        pose = Pose(pose.x + STEP * v_x, pose.y + STEP * v_y, pose.theta + STEP * command.omega)
        if time >= measured.time + period - 1e-9:
            measured = ObjectPose(time, Pose(object_x(time), 0.0, 0.0))
        perception.update(Observation(time, Odometry(time, pose, command), measured))
        command = STOP if time < 2.0 * period else behavior.step(perception, STEP)
        if time > MOVES_AT and command == STOP:
            halts.append(time)
    return Halt(min(halts, default=math.inf), len(halts), behavior.failure)


@pytest.mark.parametrize('period', [0.05, 0.1])
@pytest.mark.parametrize('speed', [0.3, -0.6, 1.0, -1.4])
def test_an_object_that_moves_by_itself_stops_the_robot_while_it_moves(speed: float,
                                                                       period: float) -> None:
    """Away or nearer: within five poses and the time in which it moves as far as is tolerated."""
    halt = approach(lambda time: speed * max(0.0, time - MOVES_AT), period)
    assert halt.failure is not None
    assert halt.failure.code is BehaviorFailure.OBJECT_MOVED
    tolerated = CONTEXT.supervision.moved_distance / abs(speed)
    assert halt.time < MOVES_AT + tolerated + 5.0 * period


def test_an_object_whose_poses_come_seldom_stops_it_by_the_first_that_nothing_explains() -> None:
    """Further ones tell that it was moved."""
    halt = approach(lambda time: 0.3 if time > MOVES_AT else 0.0, 0.5)
    assert halt.time <= MOVES_AT + 0.5 + STEP
    assert halt.failure is not None
    assert halt.failure.code is BehaviorFailure.OBJECT_MOVED


def test_single_poses_that_are_far_off_stop_no_robot() -> None:
    """As those of a tag that is mistaken now and then."""
    halt = approach(lambda time: 0.3 if int(time / 0.05 + 0.5) % 12 == 0 else 0.0, 0.05)
    assert halt.halts == 0
    assert halt.failure is None


@pytest.mark.parametrize('gap, code', [(0.005, BehaviorFailure.RAN_INTO_OBJECT),
                                       (0.3, BehaviorFailure.BUMPED)])
def test_a_touch_of_the_object_on_the_way_is_told_from_that_of_anything_else(
        gap: float, code: BehaviorFailure) -> None:
    """By where the object is: beside the face at which the push is not to begin."""
    perception = TaskPerception(box(), ROBOT, CONTEXT.control, CONTEXT.supervision)
    behavior = StandoffApproach(CONTEXT, straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.3))
    pose = Pose(0.0, 0.37 + gap, 0.0)
    for step in range(20):
        time = 0.05 * step
        perception.update(Observation(time, Odometry(time, pose, STOP),
                                      ObjectPose(time, Pose(0.0, 0.0, 0.0))))
    failure = behavior.on_bumped(perception)
    assert failure is not None and failure.code is code
