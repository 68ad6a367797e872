"""Approach: drive round the object to the pose from which the robot goes straight to contact."""

from collections.abc import Sequence
import math

import numpy as np
from push_control.behaviors.behavior import Behavior, BehaviorContext
from push_control.behaviors.bumper import bumped, STOPPING_TIME
from push_control.behaviors.failures import BehaviorFailure, FailureReport, no_path
from push_control.behaviors.object_touch import locate_at_object, touches_object
from push_control.behaviors.path_execution import blocks, displacement, PathExecution
from push_control.behaviors.straight_push import touch_speed
from push_control.perception.object_at_rest import has_moved
from push_control.perception.perception import TaskPerception
from push_control.perception.view import View
from push_control.steered.start import robot_start_pose
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import PoseCovariance, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.approach.approach_path import plan_approach
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, Path
from push_navigation.path_planner import plan_path
from push_navigation.settings import DriveSettings

# Paths that may be driven until the pre-push pose is reached within its tolerance; chosen: the
# second one corrects the first, a third one is needed where the object moves meanwhile.
MAX_PATHS = 3
# Overlap of robot and object, and motion of the object, that are no errors of measurement [m];
# chosen: five standard deviations of an object pose with 2 mm of noise.
OVERLAP_TOLERANCE = 0.01
# Distance before the contact at which the push takes over [m], and by how many standard deviations
# of the robot's position, and by how much at most, earlier; chosen: what the robot needs to brake
# from its path to a tap.
HANDOVER_DISTANCE = 0.02
HANDOVER_SIGMAS = 2.0
MAX_HANDOVER_MARGIN = 0.04
# Straight end of the path before that, on which the path follower settles [m]; chosen.
SETTLING_DISTANCE = 0.02
# Distance of the straight end of the path before the object gets too near to be seen, where it is
# a landmark, and length of the segments on which a holonomic base faces it [m]; chosen: some
# periods of a camera, and turns of some degrees.
LAST_LOOK_DISTANCE, FACING_SPACING = 0.12, 0.1
# Distance and angle from the start of a push at which a touch is that of the push [m, rad];
# chosen: what the push itself corrects.
MAX_TOUCH_ERROR, MAX_TOUCH_ANGLE = 0.03, 0.15
# Standard deviations of the robot's position that a gap must exceed to be there for certain.
CERTAIN_SIGMAS = 3.0


def approach_direction(robot: RoundRobot, target: PushTrajectory, start: Pose) -> float:
    """
    Find the direction in which a robot goes straight to its contact.

    :param start: ``Pose`` of the robot at the start of the push, as the object stands now.
    :return: world angle [rad]: the heading of a differential drive, else the contact normal.
    """
    if robot.drive == 'differential':
        return start.theta
    return start.theta + float(target.contact_poses[0][2] - target.robot_poses[0][2])


class StandoffApproach(Behavior[TaskPerception]):
    """Drives round the object to the pre-push pose, at a standoff from the contact."""

    def __init__(self, context: BehaviorContext, target: PushTrajectory) -> None:
        """Start."""
        super().__init__()
        self._context = context
        self._target = target
        self._execution: PathExecution | None = None
        self._paths_driven = 0
        self._first_object_pose: Pose | None = None
        self._moved_distance = OVERLAP_TOLERANCE

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """Tell whether a new map has an obstacle on the path where the previous one has none."""
        return blocks(self._execution, self._context.occupancy_map, occupancy_map, pose)

    def on_bumped(self, perception: TaskPerception) -> FailureReport | None:
        """Fail; a robot that seems to be at the object is there."""
        if not touches_object(perception):
            return bumped(perception)
        locate_at_object(perception, self._context.obj, self._context.robot)
        perception.on_unexpected_contact()
        perception.restart_averaging(perception.time + STOPPING_TIME)
        return BehaviorFailure.RAN_INTO_OBJECT.report()

    def pause(self) -> None:
        """Forget the path; the next step plans another one."""
        self._execution = None

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Compute the command."""
        if not perception.is_blind:
            self._check_object(perception)
            if self.failure is not None:
                perception.restart_averaging(perception.time + STOPPING_TIME)
                return STOP
            if perception.awaits_explanation:
                self.pause()
                return STOP
        robot_pose = perception.robot_pose
        object_pose = perception.object_at_rest.pose
        if self._execution is None:
            try:
                self._execution = self._plan_path(perception, object_pose)
            except ValueError as error:
                self.failure = no_path(error)
                return STOP
        self._execution.limit_to(perception.limited(self._context.robot))
        command = self._execution.step(robot_pose, dt, perception.predicted_pose)
        self.failure = self._execution.failure
        if self._execution.has_missed_end:
            self._execution = None
            self._paths_driven += 1
            if self._paths_driven >= MAX_PATHS:
                self.failure = BehaviorFailure.PATH_END_MISSED.report()
            return STOP
        if self._execution.finished:
            self._execution = None
            self._check_arrival(robot_pose, object_pose)
        return command

    def _plan_path(self, perception: TaskPerception, object_pose: Pose) -> PathExecution:
        context, drive = self._context, self._drive(perception, object_pose)
        path = plan_path(context.robot, context.obj, object_pose, perception.robot_pose,
                         self._pre_push_pose(object_pose), drive,
                         occupancy_map=context.occupancy_map,
                         uncertainty=perception.position_uncertainty)
        return PathExecution(context.robot, drive, path, context.supervision.stall_timeout)

    def _drive(self, perception: TaskPerception, object_pose: Pose) -> DriveSettings:
        supervision, growth = self._context.supervision, 0.0
        if not (perception.is_robot_measured or perception.is_robot_placed):
            growth = (max(supervision.odometry_scale, supervision.odometry_drift)
                      * distance(perception.robot_pose, object_pose))
        return self._context.drive.for_uncertain_robot(
            math.hypot(perception.localization.position_deviation, growth))

    def _check_object(self, perception: TaskPerception) -> None:
        """Fail where somebody has moved the object, or the robot itself has run into it."""
        obj, robot, settings = self._context.obj, self._context.robot, self._context.supervision
        # Where poses are relative to the robot, their relation is measured, and needs no contact.
        is_relative = perception.localization.is_relative
        gap = perception.gap
        deviation = perception.localization.position_deviation
        was_displaced = perception.was_displaced
        if gap < -OVERLAP_TOLERANCE and not (was_displaced or is_relative):
            perception.update_from_contact(obj, robot, OVERLAP_TOLERANCE)
        at_rest = perception.object_at_rest
        pose, noise = at_rest.pose, self._pose_noise(perception)
        planned = Pose(*self._target.object_poses[0].tolist())
        if self._first_object_pose is None:
            self._first_object_pose = pose
            # As it is seen from other sides, an object with biased poses seems to move.
            if at_rest.is_biased:
                self._moved_distance += CERTAIN_SIGMAS * at_rest.position_error
        may_touch = gap < settings.probe_distance + CERTAIN_SIGMAS * deviation
        moved_distance = self._moved_distance
        if noise is not None:
            moved_distance = max(moved_distance,
                                 settings.motion_gate_sigmas * noise.position_deviation)
        has_shifted = distance(pose, self._first_object_pose) > moved_distance
        if may_touch and has_shifted and not (was_displaced or is_relative):
            contact_deviation = OVERLAP_TOLERANCE
            if gap > OVERLAP_TOLERANCE + CERTAIN_SIGMAS * deviation:
                # Either its pose is wrong by that, or somebody else has moved the object.
                perception.localization.inflate_covariance(gap)
                contact_deviation = 0.5 * gap
            perception.update_from_contact(obj, robot, contact_deviation)
            perception.on_unexpected_contact()
            self.failure = BehaviorFailure.RAN_INTO_OBJECT.report()
        elif has_moved(planned, pose, settings, noise):
            perception.on_object_moved(planned)
            self.failure = BehaviorFailure.OBJECT_MOVED.report()

    def _pose_noise(self, perception: TaskPerception) -> PoseCovariance | None:
        """Return the noise of the object at rest where that is one pose, as while it moves."""
        if perception.object_at_rest.duration > 0.0:
            return None
        return self._context.control.assumed_covariance(perception.object_pose)

    def _check_arrival(self, robot_pose: Pose, object_pose: Pose) -> None:
        error = displacement(robot_pose, self._pre_push_pose(object_pose),
                             self._context.robot.radius)
        self._paths_driven += 1
        self.finished = error <= self._context.supervision.pre_push_tolerance
        if not self.finished and self._paths_driven >= MAX_PATHS:
            self.failure = BehaviorFailure.NOT_AT_PRE_PUSH_POSE.report(distance=1e3 * error)

    def _pre_push_pose(self, object_pose: Pose) -> Pose:
        start = robot_start_pose(self._target, object_pose)
        angle = approach_direction(self._context.robot, self._target, start)
        standoff = self._context.drive.standoff
        return Pose(start.x - standoff * math.cos(angle), start.y - standoff * math.sin(angle),
                    start.theta)


class MovingApproach(StandoffApproach):
    """Drives round the object on to the line of a straight push, without a stop before it."""

    def __init__(self, context: BehaviorContext, target: PushTrajectory) -> None:
        """
        Start.

        :param target: the ``PushTrajectory``, of style ``STRAIGHT``.
        """
        super().__init__(context, target)
        self._line = target.straight_line()
        self._end_speed = touch_speed(target)
        self._has_touched = False
        self._view = View.from_settings(context.supervision)

    def on_bumped(self, perception: TaskPerception) -> FailureReport | None:
        """Hand over to the push where it touches about where it should; else fail."""
        self._has_touched = touches_object(perception) and self._is_at_contact(perception)
        return None if self._has_touched else super().on_bumped(perception)

    def _is_at_contact(self, perception: TaskPerception) -> bool:
        """Tell whether the robot is where the push begins, as well as that is known."""
        start = perception.object_at_rest.pose @ self._line.start
        error = start.inverse() @ perception.robot_pose
        deviation = perception.localization.position_deviation
        return (math.hypot(error.x, error.y) < math.hypot(MAX_TOUCH_ERROR,
                                                          CERTAIN_SIGMAS * deviation)
                and (self._context.robot.drive == 'holonomic'
                     or abs(wrap_angle(error.theta)) < MAX_TOUCH_ANGLE))

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Compute the command."""
        if self._has_touched:
            self.finished = True
            return STOP
        return super().step(perception, dt)

    def _plan_path(self, perception: TaskPerception, object_pose: Pose) -> PathExecution:
        context, drive = self._context, self._drive(perception, object_pose)
        handover_distance = HANDOVER_DISTANCE + min(
            MAX_HANDOVER_MARGIN, HANDOVER_SIGMAS * perception.localization.position_deviation)
        straights = [handover_distance + SETTLING_DISTANCE]
        if perception.is_object_landmark and self._view.nearest > 0.0:
            straights.insert(0, self._view.nearest + LAST_LOOK_DISTANCE)
        path = self._planned(perception, object_pose, drive, straights)
        if context.robot.drive == 'holonomic' and self._view.half_angle < math.pi:
            path = facing_path(path, object_pose)
        return PathExecution(context.robot, drive, path, context.supervision.stall_timeout,
                             end_speed=self._end_speed, handover_distance=handover_distance)

    def _planned(self, perception: TaskPerception, object_pose: Pose, drive: DriveSettings,
                 straights: Sequence[float]) -> Path:
        """
        Plan the path, which ends on a straight line on to the object.

        :param straights: lengths of that [m]; the first one counts that there is room for.
        """
        context = self._context
        for index, straight in enumerate(straights, 1):
            try:
                return plan_approach(
                    context.robot, context.obj, object_pose, perception.robot_pose,
                    object_pose @ self._line.start, drive, occupancy_map=context.occupancy_map,
                    uncertainty=perception.position_uncertainty, end_speed=self._end_speed,
                    final_straight=straight)
            except NoPathFound:
                if index == len(straights):
                    raise
        raise ValueError('straights: got none, expected one at least')

    def _check_arrival(self, robot_pose: Pose, object_pose: Pose) -> None:
        self.finished = True


def facing_path(path: Path, object_pose: Pose) -> Path:
    """
    Let a holonomic base face an object all along a path, so that it sees it.

    :param path: ``Path`` of it.
    :param object_pose: ``Pose`` of the object.
    :return: ``Path`` of the same positions, in segments that are short where headings change.
    """
    poses = [path.poses[0]]
    arc_angles: list[float] = []
    for segment in path.segments:
        count = max(1, math.ceil(segment.length / FACING_SPACING))
        for x, y, _ in segment.poses(np.arange(1, count + 1) / count).tolist():
            before = poses[-1].theta
            direction = math.atan2(object_pose.y - y, object_pose.x - x)
            poses.append(Pose(x, y, before + wrap_angle(direction - before)))
            arc_angles.append(segment.arc_angle / count)
    return Path(tuple(poses), tuple(arc_angles))
