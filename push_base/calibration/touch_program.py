"""
Drives to an object, pushes it slowly, backs off, and does so from the other side, if wanted.

Each drive is timed, from where robot and object are at rest. What is missed then is driven again.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

import numpy as np
from push_base.calibration.recording import Purpose, ReceivedPose, Recording
from push_base.calibration.topics import pose_rows
from push_base.calibration.touch import evaluate_touches
from push_model.contact import face_normal
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP, Twist

# Speed of a push [m/s]; chosen: the least at which a base must move to push at all.
SPEED = 0.1
# Distance of a push, and of the way before and behind it [m].
DISTANCE, STANDOFF, RETREAT = 0.3, 0.25, 0.3
# Rest before and behind a push, and between drives [s].
REST_TIME, SETTLE_TIME = 2.0, 1.2
# Distance between robot and object on the way round it [m].
CLEARANCE = 0.25
# Greatest distance from the place that a push starts at, and error of the heading [m, rad], and
# drives that are tried; chosen: what an edge of 0.2 m forgives.
NEAR, NEAR_HEADING, MAX_DRIVES = 0.05, 0.06, 5
# Greatest distance of an object that is believed to be meant [m].
MAX_DISTANCE = 3.0
# Time of poses that are averaged [s], and poses that it needs.
AVERAGED_TIME, MIN_POSES = 0.8, 5


class TouchPlan(NamedTuple):
    """
    Object and poses of the touch program.

    :param object: the nominal ``PushedObject``.
    :param sides: 1, or 2 for opposite ones.
    :param is_only: whether nothing else is measured.
    """

    object: PushedObject
    sides: int = 1
    is_only: bool = False


class Drive(NamedTuple):
    """A command for a time [s], and its ``Purpose``."""

    purpose: Purpose
    duration: float
    twist: Twist = STOP


class TouchProgram:
    """Chooses drives, one after the other, from where robot and object are."""

    def __init__(self, robot: RoundRobot, plan: TouchPlan, drive_speed: float,
                 turn_rate: float) -> None:
        """
        Start anywhere before the object.

        :param robot: the nominal ``RoundRobot``.
        :param plan: ``TouchPlan``.
        :param drive_speed: [m/s].
        :param turn_rate: [rad/s].
        """
        self._robot, self._plan = robot, plan
        self._speed, self._rate = drive_speed, turn_rate
        self._normal: float | None = None
        self._drives = 0
        # Stages that are left.
        self._stages: list[Callable[[Pose, Pose], list[Drive]]] = [self._go_to_start, self._push]
        if plan.sides == 2:
            self._stages += [self._go_sideways, self._go_past, self._go_behind, self._go_to_start,
                             self._push]

    def next_drives(self, recording: Recording, robot: Pose) -> list[Drive]:
        """
        Choose what is driven next.

        :param recording: so far; its poses of object and robot are those of now.
        :param robot: ``Pose`` of the robot by odometry, at rest.
        :return: ``Drive`` list; empty at the end, or where the object is not seen ahead.
        """
        obj = object_in_odometry(recording, robot)
        if obj is None or math.dist(obj[:2], robot[:2]) > MAX_DISTANCE:
            return []
        if self._stages and self._stages[0] == self._go_sideways and self._drives == 0:
            result = evaluate_touches(recording)
            # By wheels that have spun the robot does not know where it is.
            if result is None or result.is_too_weak:
                return []
        while self._stages:
            drives = self._stages[0](obj, robot)
            self._drives += 1
            if drives and self._drives > MAX_DRIVES:
                return []
            if self._stages[0] == self._push:
                self._stages.pop(0)
                self._drives = 0
                return drives
            if drives:
                return [*drives, Drive(Purpose.APPROACH, SETTLE_TIME)]
            self._stages.pop(0)
            self._drives = 0
        return []

    def _frame(self, obj: Pose, robot: Pose) -> Pose:
        """Return a frame in the middle of the object, x along the push."""
        if self._normal is None:
            self._normal = _push_direction(self._plan.object, obj, robot)
        x, y = obj.transform(self._plan.object.center_of_mass)
        return Pose(x, y, obj.theta + self._normal)

    def _start_distance(self, frame: Pose, obj: Pose) -> float:
        """Return how far before the middle a push starts [m]."""
        return _extent(self._plan.object, obj, frame) + self._radius + STANDOFF

    @property
    def _radius(self) -> float:
        return self._robot.radius if math.isfinite(self._robot.radius) else 0.0

    def _go_to_start(self, obj: Pose, robot: Pose) -> list[Drive]:
        frame = self._frame(obj, robot)
        return self._go(robot, frame @ Pose(-self._start_distance(frame, obj), 0.0, 0.0), True)

    def _go_sideways(self, obj: Pose, robot: Pose) -> list[Drive]:
        return self._go(robot, self._corner(obj, robot, -1.0, 1.0), False)

    def _go_past(self, obj: Pose, robot: Pose) -> list[Drive]:
        return self._go(robot, self._corner(obj, robot, 1.0, 1.0), False)

    def _go_behind(self, obj: Pose, robot: Pose) -> list[Drive]:
        drives = self._go(robot, self._corner(obj, robot, 1.0, 0.0), False)
        if not drives and self._normal is not None:
            # What follows is the same from the other side.
            self._normal += math.pi
        return drives

    def _corner(self, obj: Pose, robot: Pose, x: float, y: float) -> Pose:
        """Return a position on the way round the object."""
        distance = 0.5 * self._plan.object.size + self._radius + CLEARANCE
        return self._frame(obj, robot) @ Pose(x * distance, y * distance, 0.0)

    def _go(self, robot: Pose, target: Pose, has_heading: bool) -> list[Drive]:
        """Choose drives to a place; none where the robot is there."""
        x, y = robot.inverse().transform(target[:2])
        distance, drives = math.hypot(x, y), list[Drive]()
        heading = robot.theta
        if distance > NEAR:
            bearing = math.atan2(y, x)
            if self._robot.drive == 'holonomic':
                ratio = self._speed / distance
                return [Drive(Purpose.APPROACH, distance / self._speed,
                              Twist(x * ratio, y * ratio, 0.0))]
            is_forward = abs(bearing) <= 0.5 * math.pi
            turn = bearing if is_forward else wrap_angle(bearing + math.pi)
            drives += self._turn(turn, NEAR_HEADING)
            drives.append(Drive(Purpose.APPROACH, distance / self._speed,
                                Twist(self._speed if is_forward else -self._speed, 0.0, 0.0)))
            drives.append(Drive(Purpose.APPROACH, SETTLE_TIME))
            heading += turn
        if has_heading:
            drives += self._turn(wrap_angle(target.theta - heading), NEAR_HEADING)
        return drives

    def _turn(self, angle: float, tolerance: float) -> list[Drive]:
        if abs(angle) < tolerance:
            return []
        return [Drive(Purpose.APPROACH, abs(angle) / self._rate,
                      Twist(0.0, 0.0, math.copysign(self._rate, angle))),
                Drive(Purpose.APPROACH, SETTLE_TIME)]

    def _push(self, obj: Pose, robot: Pose) -> list[Drive]:
        """Push, rest in contact, and back off."""
        frame = self._frame(obj, robot)
        x, _ = frame.inverse().transform(robot[:2])
        free = -x - _extent(self._plan.object, obj, frame) - self._radius
        speed = min(SPEED, self._robot.max_speed)
        forward = Twist(speed, 0.0, 0.0)
        return [Drive(Purpose.APPROACH, REST_TIME),
                Drive(Purpose.TOUCH, (max(0.0, free) + DISTANCE) / speed, forward),
                Drive(Purpose.CONTACT, REST_TIME),
                Drive(Purpose.APPROACH, RETREAT / speed, Twist(-speed, 0.0, 0.0)),
                Drive(Purpose.APPROACH, SETTLE_TIME)]


def object_in_odometry(recording: Recording, robot: Pose) -> Pose | None:
    """
    Find where the object is, for a robot at rest.

    :param recording: whose last poses count.
    :param robot: ``Pose`` of the robot by odometry.
    :return: ``Pose`` in the frame of odometry; None where no poses come. Where ``robot_pose``
        measures the robot, object poses are in its frame, else in that of odometry.
    """
    now = recording.commands[-1].time if recording.commands else 0.0
    obj = _last(recording.object_poses, now)
    if obj is None:
        return None
    in_world = _last(recording.robot_poses, now)
    return obj if in_world is None else robot @ in_world.inverse() @ obj


def _last(poses: list[ReceivedPose], now: float) -> Pose | None:
    """Average what came last."""
    recent = [item.measured.pose for item in poses[-200:] if item.arrival > now - AVERAGED_TIME]
    if len(recent) < MIN_POSES:
        return None
    rows = pose_rows(recent)
    return Pose(*np.median(rows, axis=0).tolist())


def _push_direction(obj: PushedObject, pose: Pose, robot: Pose) -> float:
    """Choose the direction of the push, object frame: that of the face before the robot."""
    x, y = pose.inverse().transform(robot[:2])
    bearing = math.atan2(obj.center_of_mass[1] - y, obj.center_of_mass[0] - x)
    if not obj.outline:
        return bearing
    normals = [face_normal(obj, index) for index in range(len(obj.outline))]
    return min(normals, key=lambda normal: abs(wrap_angle(normal - bearing)))


def _extent(obj: PushedObject, pose: Pose, frame: Pose) -> float:
    """Return how far the object reaches before its middle, against the push [m]."""
    if not obj.outline:
        return obj.radius
    return max(-frame.inverse().transform(pose.transform(vertex))[0] for vertex in obj.outline)
