"""
Straight push: along a line or an arc, into a face or round side, until stopping is best.

First the robot drives on to the contact along the line of the push. From the touch on the
``RolloutLaw`` chooses the curvature and where to stop. The contact may roll and slide: the
ensemble follows it.
"""

import dataclasses
import math

import numpy as np
from push_base.base_identifier import MAX_LEAST_SPEED
from push_base.spin_watch import MAX_SPIN_RATIO, SpinWatch
from push_base.stall_watch import StallWatch
from push_control.behaviors.behavior import Behavior, BehaviorContext
from push_control.behaviors.bumper import bumped
from push_control.behaviors.failures import BehaviorFailure, FailureReport, held_up
from push_control.behaviors.object_touch import locate_at_object, touches_object
from push_control.behaviors.obstacle_guard import (
    blocks_push, guarded_members, ObstacleGuard)
from push_control.behaviors.push_progress import (
    decide, MIN_SPEED, Miss, PushProgress, Stage, Steer, Stop, UNEXPECTED_DISTANCE, UNMEASURED)
from push_control.behaviors.rollout_law import RolloutLaw
from push_control.behaviors.walls_beside import wall_errors, walls_beside
from push_control.perception.contact_consistency import Touch
from push_control.perception.ensemble.contact_hypotheses import ContactHypotheses
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.ensemble.missed_push import after_missed_push
from push_control.perception.object_at_rest import Tap
from push_control.perception.perception import TaskPerception
from push_control.steered.laws.braking import braking_distance
from push_control.steered.status import ControllerStatus, Phase
from push_model.events import sentence
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_primitives.store import PushPrimitives
from push_safety.status import SafetyReport

# Time in which what remains of a push is covered as it ends [s]; chosen: slow enough for a lag of
# 0.1 s, and poses as late as that.
ENDING_TIME = 0.45
# Deceleration towards the touch over the limit of the robot; chosen: leaves half to the lag.
APPROACH_DECELERATION = 0.6
# Gap beyond the expected one and its two standard deviations at which the robot drives at touch
# speed already [m]; chosen.
TOUCH_MARGIN = 0.004
# Distance on which the robot returns to the line of the push before the touch [m]; chosen: about
# what remains from where the approach ends.
RETURN_DISTANCE = 0.12
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
# Time between two choices of the arc [s]; chosen: two periods of the object pose.
STEERING_PERIOD = 0.1
# Remaining distance above which the arc still changes [m], and how much before that the stop is
# chosen at each step [m]; how far a choice of the arc looks: a part of the remaining distance and
# a constant, at most the horizon [m]. Chosen.
MIN_STEERED = 0.08
STOP_CHOICE_DISTANCE = 0.05
HORIZON_RATIO, HORIZON_MARGIN, HORIZON = 1.3, 0.12, 0.7
# How far the choice of the stop looks beyond it, which is also the least that it looks [m]; and
# the time that the base takes to brake besides [s]; chosen.
STOP_MARGIN = 0.05
BRAKING_DELAY = 0.01
# Speed below which a robot that brakes counts as at rest [m/s], and the time after which it does
# so at any rate [s]; chosen: it moves on by a millimetre, and twice what braking takes.
REST_SPEED = 0.012
MAX_STOPPING_TIME = 0.8
# Standard deviation of a robot whose wheels have spun, and of the gap at the object that it
# touches then [m]; chosen: what they spin until that is noticed.
SPUN_STD = 0.1
TOUCHING_STD = 0.01
# Distance beyond the length of a push in which walls may touch object or robot [m]; chosen: both
# are smaller.
WALL_RANGE = 1.5
# Time after the last contact for which the robot is at the object still [s]; chosen: an ensemble
# that knows no wall expects an object that stops to go on, and lets go of it.
CONTACT_MEMORY = 0.3
# Clearance of the object from the map up to which it may touch an obstacle [m]; chosen: half a
# cell.
TOUCHED_WALL = 0.025


def pushing_speed(target: PushTrajectory) -> float:
    """
    Read the greatest speed of the robot off a plan.

    :return: speed [m/s].
    """
    return float(np.hypot(*target.robot_twists[:, :2].T).max())


def touch_speed(target: PushTrajectory) -> float:
    """
    Read the speed of the robot at first touch off a plan.

    :return: speed [m/s].
    """
    return math.hypot(*target.robot_twists[0, :2].tolist())


def ending_speed(speed: float, remaining: float) -> float:
    """
    Choose the speed of a push: the less remains, the slower.

    :param speed: greatest speed of the push [m/s].
    :param remaining: distance to its end [m].
    :return: speed [m/s].
    """
    return min(speed, max(MIN_SPEED, remaining / ENDING_TIME))


class StraightPush(Behavior[TaskPerception]):
    """Drives to the contact and pushes."""

    def __init__(self, context: BehaviorContext, primitives: PushPrimitives,
                 ensemble: ContactHypotheses, target: PushTrajectory, goal: Pose, *,
                 has_spun: bool = False) -> None:
        """
        Start; the robot may be moving already.

        :param goal: goal ``Pose`` of the object.
        :param has_spun: whether the wheels have spun at the object before: the push then goes on
            until it is seen to move, or is seen not to.
        """
        super().__init__()
        self._robot = context.robot
        self._obj = context.obj
        self._map = context.occupancy_map
        self._ensemble = ensemble
        self._target = target
        self._line = target.straight_line()
        self._speed = pushing_speed(target)
        self._touch_speed = touch_speed(target)
        walls = walls_beside(self._map, self._obj, ensemble.object_pose,
                             self._line.length + WALL_RANGE)
        # Of relative poses the place in the map is that of odometry, which drifts.
        ensemble.set_walls(() if ensemble.is_relative else walls, wall_errors(
            self._map, self._obj, ensemble.object_pose, context.control.wall_error,
            ensemble.members.count))
        self._law = RolloutLaw(ensemble.members, primitives.cost_to_go, self._line.face, goal,
                               max(self._speed, 0.05), walls)
        self._control = context.control
        self._progress = PushProgress(
            self._line.length, Steer(self._line.curvature, self._line.length),
            steering_time=STEERING_PERIOD)
        # Direction of motion in the robot's axes from the touch on [rad].
        self._direction = 0.0
        self._memory = ensemble.remember_robot()
        self._command = STOP
        self._spin_watch: SpinWatch | None = None
        self._stall_watch = StallWatch()
        self._has_spun = has_spun
        self._guard = None if self._map is None else ObstacleGuard(
            self._map, context.obj, context.robot, target)

    @property
    def push_status(self) -> ControllerStatus:
        """``ControllerStatus`` of the push."""
        phase = Phase.DONE if self.finished else Phase.PUSHING
        ensemble = self._ensemble
        return ControllerStatus(
            phase=phase if self.failure is None else Phase.FAILED, reason=sentence(self.failure),
            remaining_distance=max(0.0, self._line.length - self._progress.pushed),
            travelled_distance=self._progress.pushed, friction_center=ensemble.friction_center,
            object_pose=ensemble.object_pose, robot_pose=ensemble.pose,
            in_contact=ensemble.contact_ratio > 0.5)

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """Tell whether a new map, unlike the previous one, has an obstacle in the way."""
        return blocks_push(self._target, self._obj, self._robot, self._map, occupancy_map,
                           pose)

    def stop_failure(self, stop: SafetyReport) -> FailureReport | None:
        """Tell of an object at which the base stalls, as that is too heavy or held up."""
        progress, commanded = self._progress, math.hypot(*self._command[:2])
        is_at_object = self._may_touch(progress) and not progress.is_blind
        # Where the object has moved in the open, a least speed that is not known yet explains slow
        # commands.
        is_fast = commanded > MAX_LEAST_SPEED or self._is_at_wall
        is_stalled = not progress.has_moved or (
            is_fast and progress.followed_speed < MAX_SPIN_RATIO * commanded)
        if not (stop.code.is_of_motion and is_at_object and is_stalled):
            return None
        return self._hold_up or BehaviorFailure.BASE_STALLS.report()

    def _may_touch(self, progress: PushProgress) -> bool:
        """Tell whether the robot is at the object, as far as that is known."""
        if progress.stage is Stage.STOPPING:
            return False
        return (self._free_gap(self._ensemble.pose) == 0.0
                or progress.time - progress.last_contact < CONTACT_MEMORY)

    @property
    def _hold_up(self) -> FailureReport | None:
        """``Report`` of what holds up the object; None where it may be too heavy."""
        if self._is_at_wall:
            return held_up(is_in_map=True)
        has_followed = self._spin_watch is not None and self._spin_watch.has_followed
        return held_up(is_in_map=False) if has_followed else None

    @property
    def _is_at_wall(self) -> bool:
        """Tell whether the object may touch an obstacle of the map."""
        return self._map is not None and self._map.object_clearance(
            self._obj, [self._ensemble.object_pose]) < TOUCHED_WALL

    def on_bumped(self, perception: TaskPerception) -> FailureReport | None:
        """Fail where the robot is not at the object yet."""
        is_early = self._progress.stage is Stage.RUN_IN and not touches_object(perception)
        return bumped(perception) if is_early else None

    def pause(self) -> None:
        """End the push: the robot stands."""
        if self._progress.stage is not Stage.STOPPING:
            self._stop()
        self._command = STOP

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Compute the command."""
        command = self._desired(perception, dt)
        if self._progress.stage is Stage.STOPPING and self.failure is None:
            command = self._braked(perception.limited(self._robot), dt)
        self._command = command
        return command

    def _braked(self, robot: RoundRobot, dt: float) -> Twist:
        """Brake at once, or as slowly as the base is known to do."""
        speed = math.hypot(*self._command[:2])
        if robot is self._robot or speed == 0.0:
            return STOP
        ratio = max(0.0, 1.0 - robot.max_acceleration * dt / speed)
        return Twist(*(ratio * value for value in self._command)) if ratio else STOP

    def _desired(self, perception: TaskPerception, dt: float) -> Twist:
        progress = self._progress = self._measured(perception, dt)
        if progress.stage is Stage.STOPPING:
            return self._finish_stop(perception)
        if (progress.has_moved and not progress.is_blind and perception.is_lost
                and perception.on_lost_robot_touched()):
            # The push was planned for a robot that is elsewhere.
            self.failure = BehaviorFailure.LOST_ROBOT_TOUCHES.report()
            return STOP
        if progress.stage is Stage.PUSHING:
            progress = self._progress = self._with_course(progress)
        if progress.is_stalled and not progress.is_blind:
            self.failure = self._hold_up or BehaviorFailure.BASE_STALLS.report()
            return STOP
        decision = decide(progress)
        if isinstance(decision, Stop):
            return self._stop()
        if isinstance(decision, Miss):
            return self._miss(decision.cause, perception)
        if progress.stage is Stage.RUN_IN:
            return self._drive_to_contact(perception)
        return self._push(decision)

    def _measured(self, perception: TaskPerception, dt: float) -> PushProgress:
        """Take in a measurement."""
        progress = self._with_motion(self._progress, perception, dt)
        progress = self._with_object(progress, perception)
        self._stall_watch.add(progress.time, self._command, perception.observation.odometry.twist)
        progress = dataclasses.replace(
            progress, is_stalled=self._stall_watch.is_stalled and self._may_touch(progress))
        if progress.stage is Stage.PUSHING or progress.is_blind:
            progress = dataclasses.replace(
                progress, is_near_obstacle=self._is_near_obstacle(progress.is_blind, dt))
        if progress.stage is Stage.RUN_IN:
            return self._with_contact(progress, perception)
        if progress.stage is Stage.PUSHING:
            watch = self._watch_wheels(progress, perception)
            return dataclasses.replace(
                progress, last_contact=(progress.time if self._ensemble.contact_ratio > 0.5
                                        else progress.last_contact),
                is_spinning=watch.is_spinning,
                is_creeping=(watch.is_creeping
                             and not perception.localization.has_pose_bias),
                is_without_effect=watch.is_without_effect,
                is_hindered=watch.is_hindered(self._has_spun))
        return progress

    def _with_motion(self, progress: PushProgress, perception: TaskPerception,
                     dt: float) -> PushProgress:
        """Add what the robot has driven since the last step."""
        odometry, driven = perception.observation.odometry, progress.driven
        measured, command = odometry.twist, self._command
        speed, commanded = math.hypot(*measured[:2]), math.hypot(*command[:2])
        along = command.v_x * measured.v_x + command.v_y * measured.v_y
        followed = along / commanded if commanded > 0.0 else 0.0
        pushed = speed * dt if progress.stage is Stage.PUSHING else 0.0
        if progress.stage is not Stage.RUN_IN:
            v_x, v_y = perception.robot_pose.rotate(odometry.twist[:2])
            driven = driven[0] + dt * v_x, driven[1] + dt * v_y
        stopped = dt if progress.stage is Stage.STOPPING else 0.0
        predicted = perception.predicted_motion
        pending = math.hypot(*predicted.displacement[:2])
        final_speed = math.hypot(*predicted.velocity[:2])
        return dataclasses.replace(
            progress, time=progress.time + dt, steering_time=progress.steering_time + dt,
            stopping_time=progress.stopping_time + stopped, speed=speed,
            followed_speed=followed, driven=driven, pushed=progress.pushed + pushed,
            course=progress.course._replace(
                remaining=max(0.0, progress.course.remaining - pushed)),
            pending_distance=pending,
            is_pending=perception.base.has_pending_motion(perception.time),
            braking_distance=pending + (
                braking_distance(perception.limited(self._robot), final_speed)
                + BRAKING_DELAY * final_speed))

    def _with_object(self, progress: PushProgress, perception: TaskPerception) -> PushProgress:
        """Compare the object with where it was before the push."""
        measured, deviation = perception.object_pose, self._ensemble.position_deviation
        is_first = progress.before is UNMEASURED
        before = perception.object_at_rest if is_first else progress.before
        x, y, _ = before.pose
        has_moved = progress.has_moved or self._is_seen_to_move(measured, before.pose)
        is_blind = perception.is_blind
        object_x_std, object_y_std, object_heading_std = self._ensemble.object_deviations.tolist()
        moved_distance = distance(measured.pose, before.pose)
        return dataclasses.replace(
            progress, before=before, moved=(measured.pose.x - x, measured.pose.y - y),
            has_moved=has_moved, deviation=deviation,
            unseen_distance=progress.speed * max(0.0, perception.time - measured.time),
            is_lost=(not has_moved and not is_blind
                     and (perception.is_lost or self._has_spun or deviation > LOST_STD)),
            has_touched_early=(
                progress.stage is Stage.RUN_IN and moved_distance > UNEXPECTED_DISTANCE
                and not (is_blind or perception.was_displaced)),
            is_blind=is_blind, was_blind=progress.was_blind or is_blind,
            # Of relative poses the place in the world is that of odometry, which drifts.
            object_std=0.0 if self._ensemble.is_relative else max(object_x_std, object_y_std),
            object_heading_std=object_heading_std)

    def _is_seen_to_move(self, measured: ObjectPose, before: Pose) -> bool:
        """Tell whether the object has moved by more than the noise of a pose."""
        noise = self._control.assumed_covariance(measured)
        return (distance(measured.pose, before) > MOVED_SIGMAS * noise.position_deviation
                or abs(wrap_angle(measured.pose.theta - before.theta))
                > MOVED_SIGMAS * noise.heading_deviation)

    def _with_contact(self, progress: PushProgress, perception: TaskPerception) -> PushProgress:
        """Start to push where ensemble or bumper have the robot touch the object."""
        ensemble = self._ensemble
        # The bumper moves the robot: what is read below comes after that.
        is_touching = self._touches_by_bumper(perception)
        line = ensemble.object_pose @ self._line.start
        if progress.has_touched_early or not (is_touching or ensemble.contact_ratio > 0.5):
            overrun, _ = line.inverse().transform(ensemble.pose[:2])
            return dataclasses.replace(progress, overrun=overrun)
        if self._robot.drive != 'differential':
            self._direction = wrap_angle(line.theta - ensemble.pose.theta)
        return dataclasses.replace(progress, stage=Stage.PUSHING, last_contact=progress.time,
                                   touch_deviation=ensemble.position_deviation)

    def _touches_by_bumper(self, perception: TaskPerception) -> bool:
        """Tell whether the bumper touches the object; the robot is located there."""
        if not (perception.observation.is_bumper_pressed and touches_object(perception)):
            return False
        locate_at_object(perception, self._obj, self._robot)
        return True

    def _watch_wheels(self, progress: PushProgress, perception: TaskPerception) -> SpinWatch:
        """Compare what the wheels drive with how the object moves where it is touched."""
        if self._spin_watch is None:
            self._spin_watch = SpinWatch(progress.before.pose)
        watch, pose, measured = self._spin_watch, perception.robot_pose, perception.object_pose
        direction = pose.theta + self._direction
        contact = (pose.x + self._robot.radius * math.cos(direction),
                   pose.y + self._robot.radius * math.sin(direction))
        noise = self._control.assumed_covariance(measured)
        watch.add_distance(perception.time, progress.pushed)
        if progress.was_blind:
            return watch
        watch.add_object_pose(measured, contact, direction, noise.position_deviation)
        return watch

    def _is_near_obstacle(self, is_blind: bool, dt: float) -> bool:
        """Tell whether an obstacle ends the push; unseen ones are clear wherever they may be."""
        if self._guard is None:
            return False
        if not is_blind:
            return self._guard.is_close([self._ensemble.object_pose], [self._ensemble.pose], dt)
        members = self._ensemble.members
        chosen = guarded_members(members.count)
        return self._guard.is_close(members.object_poses[chosen], members.robot_poses[chosen], dt)

    def _with_course(self, progress: PushProgress) -> PushProgress:
        """Choose the arc now and then, and where to stop on it as the end comes near."""
        course, steering_time = progress.course, progress.steering_time
        if progress.has_moved and steering_time >= STEERING_PERIOD:
            steering_time = 0.0
            if course.remaining > MIN_STEERED:
                horizon = min(HORIZON, HORIZON_RATIO * course.remaining + HORIZON_MARGIN)
                choice = self._law.steer(course.curvature, self._line.curvature, horizon,
                                         self._direction)
                course = Steer(choice.curvature, choice.stopping_distance)
        if progress.is_lost:
            # Where the touch is expected tells little: the object itself has to show it.
            course = course._replace(remaining=progress.length)
        elif course.remaining <= MIN_STEERED + STOP_CHOICE_DISTANCE or not progress.has_moved:
            horizon = max(STOP_MARGIN, course.remaining + STOP_MARGIN)
            choice = self._law.stop(course.curvature, horizon, self._direction)
            course = course._replace(remaining=choice.stopping_distance)
        return dataclasses.replace(progress, course=course, steering_time=steering_time)

    def _drive_to_contact(self, perception: TaskPerception) -> Twist:
        """Drive to the contact along the line of the push."""
        ensemble = self._ensemble
        pose, object_pose = ensemble.pose, ensemble.object_pose
        if perception.base.dead_time > 0.0:
            pose = pose @ perception.predicted_motion.displacement
        line = object_pose @ self._line.start
        _, lateral = line.inverse().transform(pose[:2])
        free_gap = self._free_gap(pose)
        speed = math.sqrt(
            self._touch_speed ** 2
            + 2.0 * APPROACH_DECELERATION * perception.limited(self._robot).max_acceleration
            * free_gap)
        speed = min(speed, self._robot.max_speed)
        return self._along_line(speed, lateral, wrap_angle(pose.theta - line.theta))

    def _free_gap(self, pose: Pose) -> float:
        """
        Compute how far the robot may drive before it may touch the object [m].

        :param pose: of the robot.
        """
        ensemble = self._ensemble
        gap = ensemble.members.gap(ensemble.object_pose, pose)
        return max(0.0, gap - 2.0 * ensemble.position_deviation - TOUCH_MARGIN)

    def _along_line(self, speed: float, lateral: float, heading: float) -> Twist:
        """Keep to the line before the touch."""
        if self._robot.drive == 'differential':
            lateral = min(RETURN_DISTANCE, max(-RETURN_DISTANCE, lateral))
            curvature = -lateral / RETURN_DISTANCE ** 2 - 2.0 * math.sin(heading) / RETURN_DISTANCE
            omega = min(self._robot.max_yaw_rate, max(-self._robot.max_yaw_rate,
                                                      speed * curvature))
            return Twist(speed, 0.0, omega)
        correction = math.atan2(-2.0 * lateral, RETURN_DISTANCE)
        # ``heading`` is that of the robot relative to the line.
        return _moving(speed, correction - heading, 0.0)

    def _push(self, course: Steer) -> Twist:
        """Push along an arc; slowly until the object is seen to move: the touch may be a wall."""
        speed = ending_speed(self._speed if self._progress.has_moved else self._touch_speed,
                             course.remaining - self._progress.pending_distance)
        omega = course.curvature * speed
        if self._robot.drive == 'differential':
            return Twist(speed, 0.0, omega)
        return _moving(speed, self._direction, omega)

    def _stop(self) -> Twist:
        self._progress = dataclasses.replace(self._progress, stage=Stage.STOPPING)
        return STOP

    def _finish_stop(self, perception: TaskPerception) -> Twist:
        """Wait until the robot stands, and note how the push has gone."""
        progress = self._progress
        timeout = MAX_STOPPING_TIME + perception.base.dead_time
        self.finished = (progress.speed < REST_SPEED and not progress.is_pending
                         or progress.stopping_time >= timeout)
        if not self.finished or progress.was_blind:
            # What was not seen tells nothing.
            return STOP
        if progress.has_moved:
            perception.on_push_succeeded(progress.contact)
        is_tap = progress.contact is Touch.TAPPED or not progress.has_moved
        if is_tap:
            perception.on_tapped(self._tap(progress, perception.robot_pose))
        return STOP

    def _tap(self, progress: PushProgress, robot_pose: Pose) -> Tap:
        """Return the tap that this push was: it pushes with what is in front of the robot."""
        x, y = progress.driven
        radius = self._robot.radius
        ratio = radius / max(math.hypot(x, y), 1e-9) if math.isfinite(radius) else 0.0
        front = robot_pose.x + ratio * x, robot_pose.y + ratio * y
        return Tap(progress.before, progress.pushed, progress.driven, front, progress.deviation,
                   None if progress.has_moved else self._missed_memory())

    def _missed_memory(self) -> RobotMemory:
        """Return what is known of the robot if the push has met nothing."""
        memory, odometry = self._memory, self._ensemble.odometry
        if odometry is None or self._ensemble.is_relative:
            return memory
        return after_missed_push(memory, odometry.pose, self._obj, self._robot.radius,
                                 self._progress.before.pose)

    def _miss(self, cause: BehaviorFailure, perception: TaskPerception) -> Twist:
        """Give up, as the robot is not where it is estimated to be."""
        self.failure = cause.report()
        if cause is BehaviorFailure.WHEELS_SPIN:
            self.failure = self._hold_up or self.failure
            perception.localization.inflate_covariance(SPUN_STD)
            perception.update_from_contact(self._obj, self._robot, TOUCHING_STD)
            return STOP
        # What was inferred from a contact that there was not is wrong.
        is_early = cause is BehaviorFailure.TOUCHED_EARLY
        memory = self._memory if is_early else self._missed_memory()
        self._ensemble.restore_robot(memory, MISS_STD, MISS_HEADING_STD)
        if is_early:
            perception.on_unexpected_contact()
            perception.on_object_moved(self._progress.before.pose)
        else:
            progress = self._progress
            perception.on_push_without_effect(
                progress.touch_deviation if progress.is_at_rest else math.inf)
        return STOP


def _moving(speed: float, direction: float, omega: float) -> Twist:
    return Twist(speed * math.cos(direction), speed * math.sin(direction), omega)
