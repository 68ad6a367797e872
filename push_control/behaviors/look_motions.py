"""Motions by which a robot comes to see an object: it waits, turns, or drives along a path."""

import abc
import dataclasses
import math

from push_control.behaviors.behavior import BehaviorContext
from push_control.behaviors.path_execution import blocks, PathExecution
from push_control.perception.perception import TaskPerception
from push_control.perception.view import bearing
from push_model.geometry import Pose, wrap_angle
from push_model.signals import STOP, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import Path
from push_navigation.path_follower import limit_command, turn_in_place

# Time that the robot waits for poses where they should come [s]; chosen: latency and some periods
# of a camera.
WAITING_TIME = 0.8
# Bearing of an object that the robot faces [rad]; chosen: well within any view.
FACED = 0.05
# Yaw rate of a search [rad/s], and its angle, beyond a full turn [rad]; chosen: a camera of 10 Hz
# and 60 degrees has ten pictures of the object.
SEARCH_RATE, SEARCH_ANGLE = 0.9, 2.0 * math.pi + 0.4
# Speed at which a robot drives that may meet an object which it does not see [m/s]; chosen: that
# of a cautious touch.
CAUTIOUS_SPEED = 0.08


class LookMotion(abc.ABC):
    """Motion by which the robot comes to see the object; ``is_over`` once it is done."""

    is_over = False

    @abc.abstractmethod
    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Compute the command."""

    @abc.abstractmethod
    def pause(self) -> None:
        """Note that the robot stands for now."""

    def is_blocked(self, previous: OccupancyMap | None, occupancy_map: OccupancyMap | None,
                   pose: Pose) -> bool:
        """Tell whether a new map has an obstacle in the way where the previous one has none."""
        return False


class Wait(LookMotion):
    """Stands for a while."""

    def __init__(self) -> None:
        self._remaining_time = WAITING_TIME

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Stand."""
        self._remaining_time -= dt
        self.is_over = self._remaining_time <= 0.0
        return STOP

    def pause(self) -> None:
        """Do nothing: the robot stands."""


class Turn(LookMotion):
    """Turns in place until no angle remains."""

    def __init__(self, context: BehaviorContext, max_rate: float = math.inf) -> None:
        limits = context.drive.limited_to(context.robot)
        self._limits = dataclasses.replace(limits, yaw_rate=min(max_rate, limits.yaw_rate))
        self._command = STOP
        # A base that does not turn is not waited for.
        self._remaining_time = (context.supervision.stall_timeout
                                + SEARCH_ANGLE / self._limits.yaw_rate)

    @abc.abstractmethod
    def remaining_angle(self, perception: TaskPerception) -> float:
        """Return the angle that remains [rad]; 0 once there is none."""

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Turn."""
        remaining = self.remaining_angle(perception)
        self._remaining_time -= dt
        self.is_over = remaining == 0.0 or self._remaining_time < 0.0
        requested = Twist(0.0, 0.0, turn_in_place(remaining, self._limits))
        self._command = limit_command(self._command, requested, self._limits, dt)
        return STOP if self.is_over else self._command

    def pause(self) -> None:
        """Turn on from rest."""
        self._command = STOP


class TurnToObject(Turn):
    """Turns to where the object is expected."""

    def remaining_angle(self, perception: TaskPerception) -> float:
        """Return the bearing of the object; 0 once the robot faces it."""
        angle = bearing(perception.robot_pose, perception.expected_object_pose)
        return 0.0 if abs(angle) < FACED else angle


class TurnRound(Turn):
    """Turns round by more than a full turn."""

    def __init__(self, context: BehaviorContext, direction: float) -> None:
        super().__init__(context, SEARCH_RATE)
        self._direction = direction
        self._heading: float | None = None
        self._turned = 0.0

    def remaining_angle(self, perception: TaskPerception) -> float:
        """Return what is left of the turn."""
        heading = perception.robot_pose.theta
        if self._heading is not None:
            self._turned += self._direction * wrap_angle(heading - self._heading)
        self._heading = heading
        return self._direction * max(0.0, SEARCH_ANGLE - self._turned)


class Drive(LookMotion):
    """Drives along a path; a stall ends it."""

    def __init__(self, context: BehaviorContext, path: Path, max_speed: float = math.inf) -> None:
        drive = dataclasses.replace(context.drive, speed=min(max_speed, context.drive.speed))
        self._execution = PathExecution(context.robot, drive, path,
                                        context.supervision.stall_timeout)

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Drive."""
        command = self._execution.step(perception.robot_pose, dt, perception.predicted_pose)
        self.is_over = self._execution.finished or self._execution.failure is not None
        return command

    def pause(self) -> None:
        """End: the path begins elsewhere."""
        self.is_over = True

    def is_blocked(self, previous: OccupancyMap | None, occupancy_map: OccupancyMap | None,
                   pose: Pose) -> bool:
        """Tell whether a new map has an obstacle on the path where the previous one has none."""
        return blocks(self._execution, previous, occupancy_map, pose)
