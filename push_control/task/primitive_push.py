"""
Unsteered push: straight, or along an arc, into a face or round side, until stopping is best.

First the robot drives on to the contact along the line of the push. From the touch on the
``RolloutLaw`` chooses the curvature and where to stop. The contact may roll and slide: the
ensemble follows it.
"""

import enum
import math
from typing import NamedTuple

import numpy as np
from push_control.laws.braking import braking_distance
from push_control.localization.contact_evidence import Contact
from push_control.localization.push_ensemble import PushEnsemble
from push_control.push.obstacle_guard import blocks_push, ObstacleGuard
from push_control.push.rollout_law import RolloutLaw
from push_control.push.status import ControllerStatus, Phase
from push_control.settings import ControlSettings
from push_control.task.behavior import Behavior, BehaviorContext
from push_control.task.perception import TaskPerception
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_primitives.store import PushPrimitives
from push_primitives.table import PrimitiveTable

# Slowest push [m/s], and time in which what is left of a push is covered as it ends [s]; chosen:
# slow enough for a lag of 0.1 s, and poses as late as that.
LEAST_SPEED = 0.035
ENDING_TIME = 0.45
# Deceleration towards the touch over the limit of the robot; chosen: leaves half to the lag.
APPROACH_DECELERATION = 0.6
# Gap beyond the expected one and its two standard deviations at which the robot drives at touch
# speed already [m]; chosen.
TOUCH_MARGIN = 0.004
# Distance on which the robot returns to the line of the push before the touch [m]; chosen: about
# what is left from where the approach ends.
RETURN_DISTANCE = 0.12
# Distance beyond the expected touch, and standard deviations besides, after which an object that
# has not moved is not there [m]; chosen.
MISS_DISTANCE = 0.08
MISS_SIGMAS = 2.5
# Motion of the object that tells of a touch, in standard deviations of a pose; chosen: one pose in
# ten thousand moves as far by itself.
MOVED_SIGMAS = 4.0
# Standard deviation that a miss adds to the robot's position [m] and heading [rad]; chosen.
MISS_STD = 0.03
MISS_HEADING_STD = 0.03
# Standard deviation of the robot's position above which a push does not rest on what the ensemble
# expects until the object moves [m]; chosen: a robot that has only driven round the object is
# known better.
LOST_STD = 0.05
# Distance by which the object has moved before the ensemble has the robot touch it at which the
# robot is elsewhere [m]; chosen: above what is pushed while a pose is under way.
UNEXPECTED_DISTANCE = 0.05
# Time between two choices of the arc [s]; chosen: two periods of the object pose.
STEERING_PERIOD = 0.1
# Least distance left in which the arc still changes [m], and the longest that is looked ahead.
LEAST_STEERED = 0.08
HORIZON = 0.7
# Speed below which a robot that brakes counts as at rest [m/s], and the time after which it does
# so at any rate [s]; chosen: it moves on by a millimetre, and twice what braking takes.
REST_SPEED = 0.012
MAX_STOPPING_TIME = 0.8
# Distance that a push may exceed its plan by, and a multiple of it besides [m]; chosen: what is
# left is for the next push.
EXCESS_DISTANCE = 0.3
EXCESS_RATIO = 2.0
# Cosine of the angle between the displacements of object and robot from which on the one may have
# pushed the other, and the least displacements that are compared [m]; measured: 0.61 to 1 in tasks
# with all objects, and -0.98 to 0.66 with poses that are mirrored.
LEAST_ALONG = 0.5
LEAST_COMPARED = 0.03
# Time after which a push that does not end has failed, over its length [s]; chosen.
PATIENCE = 10.0


class PushLine(NamedTuple):
    """
    Line along which the robot drives to the contact, in the object frame.

    :param start: centre of the robot at first contact and direction of motion.
    :param curvature: of the robot's path after it [1/m].
    :param length: of that path [m].
    """

    start: Pose
    curvature: float
    length: float


class _Stage(enum.Enum):
    """Where a push stands."""

    RUN_IN = 'run-in'
    PUSHING = 'pushing'
    STOPPING = 'stopping'


def push_line(target: PushTrajectory) -> PushLine:
    """
    Read the line of an unsteered push off its plan.

    :param target: ``PushTrajectory`` of style ``UNSTEERED``.
    :return: ``PushLine``.
    """
    poses = target.robot_poses
    steps = np.diff(poses[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    moved = np.flatnonzero(lengths > 1e-6)
    directions = np.unwrap(np.arctan2(steps[moved, 1], steps[moved, 0]))
    length = float(lengths.sum())
    # The first and the last chord are apart by the whole path less half of each.
    between = length - 0.5 * float(lengths[moved[0]] + lengths[moved[-1]])
    curvature = float(directions[-1] - directions[0]) / between if len(moved) > 1 else 0.0
    direction = float(directions[0]) - 0.5 * curvature * float(lengths[moved[0]])
    start = Pose(float(poses[0, 0]), float(poses[0, 1]), direction)
    return PushLine(Pose(*target.object_poses[0].tolist()).inverse() @ start, curvature, length)


def pushing_speed(target: PushTrajectory) -> float:
    """
    Read the greatest speed of the robot off a plan.

    :param target: ``PushTrajectory``.
    :return: speed [m/s].
    """
    return float(np.hypot(*target.robot_twists[:, :2].T).max())


def touch_speed(target: PushTrajectory) -> float:
    """
    Read the speed of the robot at first touch off a plan.

    :param target: ``PushTrajectory``.
    :return: speed [m/s].
    """
    return math.hypot(*target.robot_twists[0, :2].tolist())


def ending_speed(speed: float, left: float) -> float:
    """
    Choose the speed of a push: the less is left, the slower.

    :param speed: greatest speed of the push [m/s].
    :param left: what is left of it [m].
    :return: speed [m/s].
    """
    return min(speed, max(LEAST_SPEED, left / ENDING_TIME))


def face_at(table: PrimitiveTable, start: Pose) -> int:
    """
    Find the face at which a push begins.

    :param table: ``PrimitiveTable``.
    :param start: ``Pose`` of the robot at first contact, object frame.
    :return: number of the face.
    """
    away = np.hypot(*(table.starts[:, :2] - start[:2]).T)
    return int(table.faces[away.argmin()])


class PrimitivePush(Behavior):
    """Drives to the contact and pushes."""

    def __init__(self, context: BehaviorContext, primitives: PushPrimitives,
                 ensemble: PushEnsemble, target: PushTrajectory, goal: Pose) -> None:
        """
        Start; the robot may be moving already.

        :param context: the ``BehaviorContext``.
        :param primitives: the ``PushPrimitives`` of the object.
        :param ensemble: the ``PushEnsemble``.
        :param target: the ``PushTrajectory``.
        :param goal: goal ``Pose`` of the object.
        """
        super().__init__()
        self._robot = context.robot
        self._obj = context.obj
        self._map = context.occupancy_map
        self._ensemble = ensemble
        self._target = target
        self._line = push_line(target)
        self._speed = pushing_speed(target)
        self._touch_speed = touch_speed(target)
        self._law = RolloutLaw(
            ensemble.members, primitives.cost_to_go,
            face_at(primitives.table, self._line.start), goal, max(self._speed, 0.05))
        self._progress = _Progress(self._line, context.control)
        self._memory = ensemble.remember_robot()
        self._guard = None if self._map is None else ObstacleGuard(
            self._map, context.obj, context.robot, target)

    @property
    def push_status(self) -> ControllerStatus:
        """``ControllerStatus`` of the push."""
        phase = Phase.DONE if self.finished else Phase.PUSHING
        ensemble = self._ensemble
        return ControllerStatus(
            phase=Phase.FAILED if self.failure_reason else phase, reason=self.failure_reason,
            remaining_distance=max(0.0, self._line.length - self._progress.pushed),
            travelled_distance=self._progress.pushed, friction_center=ensemble.friction_center,
            object_pose=ensemble.object_pose, robot_pose=ensemble.pose,
            in_contact=ensemble.contact_ratio > 0.5)

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """
        Tell whether a new map has an obstacle in the way of the push where the former has none.

        :param occupancy_map: the new ``OccupancyMap``, or None for open floor.
        :param pose: ``Pose`` of the robot.
        """
        return blocks_push(self._target, self._obj, self._robot, self._map, occupancy_map,
                           pose)

    def pause(self) -> None:
        """End the push: the robot stands."""
        if self._progress.stage is not _Stage.STOPPING:
            self._stop()

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """
        Compute the command.

        :param perception: ``TaskPerception`` of robot and object.
        :param dt: time since the last call [s].
        :return: ``Twist``.
        """
        progress = self._progress
        progress.advance(perception, dt)
        if progress.stage is _Stage.STOPPING:
            self.finished = (progress.speed < REST_SPEED
                             or progress.stage_time >= MAX_STOPPING_TIME)
            if self.finished and progress.has_moved:
                perception.on_push_succeeded(progress.contact)
            elif self.finished:
                perception.on_push_unseen(progress.start)
            return STOP
        if progress.has_moved and perception.is_lost and perception.on_lost_robot_touched():
            # The push was planned for a robot that is elsewhere.
            self.failure_reason = 'the robot, which was lost, touches the object'
            return STOP
        limit = EXCESS_DISTANCE + EXCESS_RATIO * self._line.length
        if progress.pushed > limit or progress.time > PATIENCE + limit / LEAST_SPEED:
            return self._stop()
        if progress.stage is _Stage.RUN_IN:
            if progress.moved_distance > UNEXPECTED_DISTANCE and not perception.was_displaced:
                return self._miss_touch(perception)
            return self._run_in(perception)
        ensemble = self._ensemble
        if self._guard is not None and self._guard.is_close(ensemble.object_pose, ensemble.pose,
                                                            dt):
            return self._stop()
        return self._push(perception)

    def _run_in(self, perception: TaskPerception) -> Twist:
        """Drive to the contact along the line of the push."""
        progress, ensemble = self._progress, self._ensemble
        pose, object_pose = ensemble.pose, ensemble.object_pose
        line = object_pose @ self._line.start
        local = line.inverse().transform(pose[:2])
        gap = ensemble.members.gap(object_pose, pose)
        deviation = ensemble.position_deviation
        if ensemble.contact_ratio > 0.5:
            progress.enter(_Stage.PUSHING)
            return self._push(perception)
        if local[0] > MISS_DISTANCE + MISS_SIGMAS * deviation:
            return self._miss_object(perception, 'the robot does not find the object')
        speed = self._touch_speed
        rest = max(0.0, gap - 2.0 * deviation - TOUCH_MARGIN)
        speed = math.sqrt(speed ** 2 + 2.0 * APPROACH_DECELERATION * self._robot.max_acceleration
                          * rest)
        speed = min(speed, self._robot.max_speed)
        return self._along_line(speed, local[1], wrap_angle(pose.theta - line.theta))

    def _along_line(self, speed: float, lateral: float, heading: float) -> Twist:
        """Keep to the line before the touch."""
        if self._robot.drive == 'differential':
            lateral = min(RETURN_DISTANCE, max(-RETURN_DISTANCE, lateral))
            curvature = -lateral / RETURN_DISTANCE ** 2 - 2.0 * math.sin(heading) / RETURN_DISTANCE
            omega = min(self._robot.max_yaw_rate, max(-self._robot.max_yaw_rate,
                                                      speed * curvature))
            return Twist(speed, 0.0, omega)
        aside = math.atan2(-2.0 * lateral, RETURN_DISTANCE)
        # ``heading`` is that of the robot relative to the line.
        return _moving(speed, aside - heading, 0.0)

    def _push(self, perception: TaskPerception) -> Twist:
        """Go on along the best arc, or stop."""
        progress, robot = self._progress, self._robot
        direction = self._direction()
        is_lost = not progress.has_moved and (
            perception.is_lost or self._ensemble.position_deviation > LOST_STD)
        if progress.has_moved and progress.steering_time >= STEERING_PERIOD:
            progress.steering_time = 0.0
            horizon = min(HORIZON, 1.3 * progress.left + 0.12)
            if progress.left > LEAST_STEERED:
                decision = self._law.steer(progress.curvature, self._line.curvature, horizon,
                                           direction)
                progress.curvature = decision.curvature
                progress.left = decision.stopping_distance
        if is_lost:
            # Where the touch is expected tells little: the object itself has to show it.
            progress.left = self._line.length
        elif progress.left <= LEAST_STEERED + 0.05 or not progress.has_moved:
            horizon = max(0.05, progress.left + 0.05)
            progress.left = self._law.stop(progress.curvature, horizon,
                                           direction).stopping_distance
        if not progress.has_moved and progress.pushed - progress.unseen_distance > (
                MISS_DISTANCE + MISS_SIGMAS * self._ensemble.position_deviation):
            return self._miss_object(perception, 'the object does not move')
        braking = braking_distance(robot, progress.speed) + 0.01 * progress.speed
        if progress.left <= braking and not is_lost:
            return self._stop()
        # No faster before the object is seen to move: the touch may be a wall.
        speed = ending_speed(self._speed if progress.has_moved else self._touch_speed,
                             progress.left)
        omega = progress.curvature * speed
        if robot.drive == 'differential':
            return Twist(speed, 0.0, omega)
        return _moving(speed, direction, omega)

    def _direction(self) -> float:
        """Direction of motion in the robot's axes [rad]."""
        if self._robot.drive == 'differential':
            return 0.0
        progress = self._progress
        if progress.direction is None:
            line = self._ensemble.object_pose @ self._line.start
            progress.direction = wrap_angle(line.theta - self._ensemble.pose.theta)
        return progress.direction

    def _stop(self) -> Twist:
        self._progress.enter(_Stage.STOPPING)
        return STOP

    def _miss_touch(self, perception: TaskPerception) -> Twist:
        """Give up, as the object moves although the robot should not touch it yet."""
        command = self._miss('the robot touches the object before it should')
        perception.on_unexpected_contact()
        perception.on_object_moved(self._obj, self._robot, self._progress.start)
        return command

    def _miss_object(self, perception: TaskPerception, reason: str) -> Twist:
        """Give up, as the object has not moved."""
        command = self._miss(reason)
        perception.on_push_in_vain()
        return command

    def _miss(self, reason: str) -> Twist:
        """Give up, as the robot is not where it is estimated to be."""
        # What was inferred from a contact that there was not is wrong.
        self._ensemble.restore_robot(self._memory, MISS_STD, MISS_HEADING_STD)
        self.failure_reason = reason
        return STOP


class _Progress:
    """How far a push has come."""

    def __init__(self, line: PushLine, control: ControlSettings) -> None:
        self._moved_distance = MOVED_SIGMAS * control.pose_noise
        self._moved_angle = MOVED_SIGMAS * control.heading_noise
        self.stage = _Stage.RUN_IN
        self.stage_time = 0.0
        self.time = 0.0
        self.curvature = line.curvature
        self.steering_time = STEERING_PERIOD
        self.speed = 0.0
        self.pushed = 0.0
        # Displacement of the robot while it pushes, and of the object, in the world [m].
        self.driven = np.zeros(2)
        self.moved = np.zeros(2)
        # What the robot has driven since the last pose of the object was measured.
        self.unseen_distance = 0.0
        self.left = line.length
        self.has_moved = False
        self.direction: float | None = None
        # Pose of the object at the beginning, and how far it has moved from it [m].
        self.start = Pose(0.0, 0.0, 0.0)
        self.moved_distance = 0.0
        self._has_start = False

    @property
    def contact(self) -> Contact:
        """Compare how the object has moved with how the robot has."""
        driven, moved = math.hypot(*self.driven.tolist()), math.hypot(*self.moved.tolist())
        if min(driven, moved) < LEAST_COMPARED:
            return Contact.TAPPED
        is_along = float(self.driven @ self.moved) > LEAST_ALONG * driven * moved
        return Contact.PUSHED if is_along else Contact.ASIDE

    def enter(self, stage: _Stage) -> None:
        self.stage = stage
        self.stage_time = 0.0

    def advance(self, perception: TaskPerception, dt: float) -> None:
        """Take in a measurement."""
        self.time += dt
        self.stage_time += dt
        self.steering_time += dt
        odometry = perception.observation.odometry
        self.speed = math.hypot(odometry.twist.v_x, odometry.twist.v_y)
        self.unseen_distance = self.speed * max(0.0, perception.time - perception.object_pose.time)
        measured = perception.object_pose.pose
        if not self._has_start:
            self.start, self._has_start = perception.object_at_rest.pose, True
        self.moved_distance = distance(measured, self.start)
        self.moved = np.subtract(measured[:2], self.start[:2])
        if not self.has_moved:
            self.has_moved = (
                self.moved_distance > self._moved_distance
                or abs(wrap_angle(measured.theta - self.start.theta)) > self._moved_angle)
        if self.stage is _Stage.PUSHING:
            self.pushed += self.speed * dt
            self.left = max(0.0, self.left - self.speed * dt)
        if self.stage is not _Stage.RUN_IN:
            self.driven += dt * np.array(perception.robot_pose.rotate(odometry.twist[:2]))


def _moving(speed: float, direction: float, omega: float) -> Twist:
    return Twist(speed * math.cos(direction), speed * math.sin(direction), omega)
