"""Following one path to its end, and noticing that the robot is stalled; behaviours that do so."""

import abc

import numpy as np
from push_control.behaviors.behavior import Behavior, BehaviorContext, Perception
from push_control.behaviors.bumper import bumped
from push_control.behaviors.failures import BehaviorFailure, FailureReport, no_path
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import Path, sample_path
from push_navigation.path_follower import PathFollower
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time

# Spacing at which a path is checked against a map [m]; chosen: below the cells of most maps.
SPACING = 0.02
# Displacement that counts as motion [m]; chosen: above the noise of odometry at rest.
MOTION_THRESHOLD = 0.005
# Distance from the start of a path within which the bumper may still touch what is left [m];
# chosen: what an object slides on when its push ends.
LEAVING_DISTANCE = 0.02
# A path may take this many times its travel time, and the stall time-out besides; chosen.
TRAVEL_TIME_FACTOR = 2.0


def displacement(pose: Pose, other: Pose, radius: float) -> float:
    """
    Measure how far a disc has moved; a rotation counts as the motion of its rim.

    :param pose: ``Pose`` of the disc.
    :param other: another one.
    :param radius: of the disc [m].
    :return: the greater one of translation and motion of the rim [m].
    """
    return max(distance(pose, other), radius * abs(wrap_angle(pose.theta - other.theta)))


class PathExecution:
    """
    Drives along a path, and fails where the robot is stalled or takes too long.

    ``finished``: whether the end is reached. ``failure``: why it never will be, None
    while it may.
    """

    def __init__(self, robot: RoundRobot, drive: DriveSettings, path: Path,
                 stall_timeout: float, *, end_speed: float = 0.0,
                 handover_distance: float = 0.0) -> None:
        """
        Start.

        :param stall_timeout: time without motion after which the robot is stalled [s].
        :param end_speed: speed at which the robot passes the end, 0 where it stops there [m/s].
        :param handover_distance: distance before the end at which it counts as passed [m].
        """
        self._follower = PathFollower(robot, drive, path, end_speed=end_speed,
                                      handover_distance=handover_distance)
        self._robot = robot
        self._path = path
        self._stall_timeout = stall_timeout
        self._drive = drive
        self._end_speed = end_speed
        self._remaining_time = self._time_limit(robot)
        self._last_motion: Pose | None = None
        self._standing_time = 0.0
        self.finished = False
        self.failure: FailureReport | None = None

    def _time_limit(self, robot: RoundRobot) -> float:
        """Return the time in which a robot has to come to the end of the path [s]."""
        return (TRAVEL_TIME_FACTOR * travel_time(self._path, robot, self._drive,
                                                 end_speed=self._end_speed)
                + self._stall_timeout)

    @property
    def has_missed_end(self) -> bool:
        """Tell whether the robot has come beside an end that it was to pass, and stops."""
        return self._follower.missed

    def has_left_start(self, pose: Pose) -> bool:
        """Tell whether the robot has left what it may have touched at the start."""
        return distance(self._path.poses[0], pose) > LEAVING_DISTANCE

    def is_free(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """
        Tell whether the remainder of the path touches no obstacle.

        :param occupancy_map: the ``OccupancyMap``, or None for open floor.
        """
        poses = sample_path(self._path, self._robot, SPACING)
        nearest = int(np.hypot(*(poses[:, :2] - pose[:2]).T).argmin())
        return (occupancy_map is None
                or occupancy_map.robot_is_free(self._robot, poses[nearest:], 0.0))

    def limit_to(self, robot: RoundRobot) -> None:
        """
        Keep to other limits on the remainder of the path; where they are lower it takes longer.

        :param robot: the ``RoundRobot`` as known by now.
        """
        if self._follower.limit_to(robot):
            self._remaining_time = max(self._remaining_time, self._time_limit(robot))

    def step(self, pose: Pose, dt: float, predicted: Pose | None = None) -> Twist:
        """
        Compute the command.

        :param dt: time since the last call [s].
        :param predicted: as of ``PathFollower.step``.
        :return: ``Twist``; STOP once there is a ``failure``.
        """
        self._remaining_time -= dt
        self._standing_time += dt
        if (self._last_motion is None
                or displacement(self._last_motion, pose, self._robot.radius) > MOTION_THRESHOLD):
            self._last_motion = pose
            self._standing_time = 0.0
        command = self._follower.step(pose, dt, predicted)
        self.finished = self._follower.finished
        is_stalled = self._remaining_time < 0.0 or self._standing_time > self._stall_timeout
        if is_stalled and not self.finished:
            self.failure = BehaviorFailure.STALLED.report(
                distance=self._follower.remaining_distance)
            return STOP
        return command


class PathBehavior(Behavior[Perception]):
    """
    Drives along one path, planned at the first step and again after a pause.

    Ends well at once where there is none to drive.

    ``context``: the ``BehaviorContext``.
    """

    def __init__(self, context: BehaviorContext, end_speed: float = 0.0) -> None:
        """
        Start.

        :param end_speed: speed with which the robot passes the end, 0 where it stops there [m/s].
        """
        super().__init__()
        self.context = context
        self._end_speed = end_speed
        self._execution: PathExecution | None = None
        # Whether the bumper has closed on the path, and has not opened since.
        self._has_touched = False

    @abc.abstractmethod
    def plan(self, perception: Perception) -> Path | None:
        """
        Plan the path.

        :param perception: ``RawPerception`` of the robot, and of where the object was seen last.
        :return: ``Path``, or None where there is nothing to drive.
        :raises ValueError: with the reason, where there should be a path and is none.
        """

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """Tell whether a new map has an obstacle on the path where the previous one has none."""
        return blocks(self._execution, self.context.occupancy_map, occupancy_map, pose)

    def on_bumped(self, perception: Perception) -> FailureReport | None:
        """Note it for the step: it counts once the start is left, and what was touched there."""
        self._has_touched = True

    def _touch_failure(self, perception: Perception) -> FailureReport | None:
        """Report what the bumper touches, but for what the robot leaves."""
        execution = self._execution
        self._has_touched = self._has_touched and bool(perception.observation.is_bumper_pressed)
        has_left = execution is not None and execution.has_left_start(perception.robot_pose)
        return bumped(perception) if self._has_touched and has_left else None

    def pause(self) -> None:
        """Forget the path; the next step plans another one."""
        self._execution = None
        self._has_touched = False

    def step(self, perception: Perception, dt: float) -> Twist:
        """
        Compute the command.

        :param perception: ``RawPerception`` of the robot, and of where the object was seen last.
        """
        self.failure = self._touch_failure(perception)
        if self.failure is not None:
            return STOP
        if self._execution is None:
            try:
                path = self.plan(perception)
            except ValueError as error:
                self.failure = no_path(error)
                return STOP
            if path is None:
                self.finished = True
                return STOP
            self._execution = PathExecution(
                self.context.robot, self.context.drive, path,
                self.context.supervision.stall_timeout, end_speed=self._end_speed)
        execution = self._execution
        execution.limit_to(perception.limited(self.context.robot))
        command = execution.step(perception.robot_pose, dt, perception.predicted_pose)
        # Beside the end of a path that is passed at speed is good enough, too.
        self.finished = execution.finished or execution.has_missed_end
        self.failure = execution.failure
        return command


def blocks(execution: PathExecution | None, previous: OccupancyMap | None,
           occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
    """
    Tell whether a new map has an obstacle on a path where the previous one has none.

    :param execution: the ``PathExecution``, or None where the robot stands.
    :param previous: ``OccupancyMap``, or None for open floor.
    :param occupancy_map: the new one.
    """
    return (execution is not None and not execution.is_free(occupancy_map, pose)
            and execution.is_free(previous, pose))
