"""
Look: back off and turn to where the object is in view, and search for one that is not there.

The robot stops as soon as poses of the object come. Until then it tries, in this order: to stand,
where it should see the object already; to drive and turn to where it should; and to turn round,
each time from another place, farther and farther from the first one. An object that it has never
seen may be too near to be seen: the first of these places are just beside, and it drives to them
as slowly as it touches an object.
"""

from collections.abc import Iterator
import math

from push_control.behaviors.behavior import Abort, Behavior, BehaviorContext, MeasurementNeed
from push_control.behaviors.bumper import bumped
from push_control.behaviors.failures import FailureReport
from push_control.behaviors.inspection import distance_at_gap
from push_control.behaviors.look_motions import (
    CAUTIOUS_SPEED, Drive, LookMotion, TurnRound, TurnToObject, Wait)
from push_control.behaviors.path_execution import PathBehavior
from push_control.behaviors.retreat import retreat_path, SPACING
from push_control.events import TaskEvent
from push_control.goal import TaskFailure
from push_control.perception.perception import TaskPerception
from push_control.perception.view import bearing, GAP_MARGIN, View
from push_model.geometry import distance, FloatArray, Pose
from push_model.signals import STOP, Twist
from push_navigation.map_clearance import map_clearance, MapContext
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import (
    differential_path, holonomic_path, NoPathFound, Path, sample_path, Waypoint)
from push_navigation.path_planner import plan_path

# Distance by which a look is taken from farther off than the nearest one with poses, how much is
# added after a look that has not lasted, and up to what [m]; chosen: a nearest distance that is
# stated too small is learned in a few looks.
LOOK_MARGIN, ADDED_MARGIN, MAX_MARGIN = 0.05, 0.05, 0.3
# Time after a look within which another one means that it has not lasted [s]; chosen: a plan is
# made meanwhile, and no push.
LASTING_TIME = 3.0
# Longest time that the robot stands where poses come, but of no object at rest [s]; chosen: some
# periods of a camera.
GLIMPSE_TIME = 1.0
# Directions from its heading in which a robot drives off an object that it has never seen [rad];
# chosen: most likely it faces the object, as somebody has placed it or since its last push.
DIRECTIONS_OFF = math.pi, 0.0, 0.5 * math.pi, -0.5 * math.pi
# Distance below which a robot has come back to where it was [m].
BACK_AT_START = 0.03
# Rounds of a search, and the distance from its start that each of them adds [m]; chosen: what an
# object is displaced by, and what hides it.
ROUNDS, ROUND_DISTANCE = 4, 0.35
# Standard deviation of a robot beside which an object is not where it should be [m]; chosen: the
# object would be in view by less.
MISSING_STD = 0.2
# Directions in which the next place of a search is sought, each beside the one before by this
# angle [rad].
DIRECTIONS, DIRECTION_STEP = 8, 0.25 * math.pi
# Bearings round an object, from that of the robot on, in which a place to see it from is sought
# [rad]; chosen: all round, the nearest ones first.
VIEWING_BEARINGS = tuple(k * math.pi / 4.0 for k in (0, 1, -1, 2, -2, 3, -3, 4))


class RetreatIntoView(PathBehavior[TaskPerception]):
    """Drives straight off the object until it is in view; a holonomic base turns to it."""

    measurement_need = MeasurementNeed.ODOMETRY

    def __init__(self, context: BehaviorContext, shortest: float, end_speed: float) -> None:
        """
        Start.

        :param shortest: how far to drive at least [m].
        :param end_speed: speed with which the robot passes the end [m/s]; in a map it stops there.
        """
        # How far it rolls out is not checked.
        super().__init__(context, end_speed if context.occupancy_map is None else 0.0)
        self._shortest = shortest
        self._start: Pose | None = None

    def plan(self, perception: TaskPerception) -> Path | None:
        """
        Find the straight path off the object.

        :return: ``Path``, or None where drive or map allow none that leads away.
        """
        self._start = perception.robot_pose
        return path_off(self.context, perception, GAP_MARGIN, self._shortest)

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Compute the command; end early where the object is seen."""
        command = super().step(perception, dt)
        if (self._start is not None and perception.sees_object_at_rest
                and distance(self._start, perception.robot_pose) >= self._shortest):
            self.finished = True
        return command


class LookMargin:
    """Learns from how far off looks have to be taken: a look that has not lasted was too near."""

    def __init__(self) -> None:
        """Start as stated."""
        self.value = LOOK_MARGIN
        self._seen_at = -math.inf

    def start_look(self, time: float) -> None:
        """
        Note that the object has to be looked for.

        :param time: now [s].
        """
        if time - self._seen_at < LASTING_TIME:
            self.value = min(MAX_MARGIN, self.value + ADDED_MARGIN)

    def end_look(self, time: float) -> None:
        """
        Note that the object is seen.

        :param time: now [s].
        """
        self._seen_at = time


class Look(Behavior[TaskPerception]):
    """Brings the object into view, and ends once it is seen at rest."""

    measurement_need = MeasurementNeed.ODOMETRY

    def __init__(self, context: BehaviorContext, margin: LookMargin) -> None:
        """
        Start.

        :param margin: the ``LookMargin``, which learns from this look.
        """
        super().__init__()
        self._context = context
        self._view = View.from_settings(context.supervision)
        self._margin = margin
        self._motions: Iterator[LookMotion] | None = None
        self._motion: LookMotion | None = None
        # Time for which poses have come, of an object at rest or not [s].
        self._glimpse_time = 0.0

    def is_blocked(self, occupancy_map: OccupancyMap | None, pose: Pose) -> bool:
        """Tell whether a new map has an obstacle on the path where the previous one has none."""
        return self._motion is not None and self._motion.is_blocked(
            self._context.occupancy_map, occupancy_map, pose)

    def on_bumped(self, perception: TaskPerception) -> FailureReport | None:
        """Fail: it looks from where nothing is."""
        return bumped(perception)

    def pause(self) -> None:
        """Turn on from wherever the robot is, and leave a path out that it was on."""
        if self._motion is not None:
            self._motion.pause()

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Stand where poses come, else compute the command of the present motion."""
        if self._motions is None:
            self._margin.start_look(perception.time)
            self._motions = self._plan_motions(perception)
        self._glimpse_time = self._glimpse_time + dt if perception.has_fresh_pose else 0.0
        if perception.sees_object_at_rest or self._glimpse_time >= GLIMPSE_TIME:
            self._margin.end_look(perception.time)
            self.finished = True
            return STOP
        if perception.has_fresh_pose:
            self.pause()
            return STOP
        if self._motion is None or self._motion.is_over:
            self._motion = next(self._motions, None)
        if self._motion is None:
            self.result = Abort(TaskFailure.OBJECT_NOT_SEEN, TaskEvent.OBJECT_NOT_FOUND.report())
            self.finished = True
            return STOP
        return self._motion.step(perception, dt)

    def _plan_motions(self, perception: TaskPerception) -> Iterator[LookMotion]:
        """List what to do, each planned when it begins."""
        context = self._context
        if perception.localization.has_object:
            if perception.expects_pose:
                yield Wait()
            path = self._path_into_view(perception)
            if path is not None:
                yield Drive(context, path)
            if self._view.half_angle < math.pi:
                yield TurnToObject(context)
            yield Wait()
        start = perception.robot_pose
        yield self._look_round(0)
        if not perception.localization.has_object and self._view.nearest > 0.0:
            yield from self._look_from_beside(perception, start)
        for index in range(1, ROUNDS + 1):
            path = self._search_path(perception, start, index)
            if path is not None:
                yield Drive(context, path)
                yield self._look_round(index)

    def _look_from_beside(self, perception: TaskPerception,
                          start: Pose) -> Iterator[LookMotion]:
        """
        Look round from where an object is in view that is too near at the start.

        :param start: ``Pose`` of the robot at its start.
        """
        length = self._view.nearest + LOOK_MARGIN
        for index, direction in enumerate(DIRECTIONS_OFF, 1):
            position = start.transform((length * math.cos(direction),
                                        length * math.sin(direction)))
            # Where it has driven before, there is no object.
            path = self._path_by(start, perception.robot_pose, position)
            if self._is_free(perception, path):
                yield Drive(self._context, path, CAUTIOUS_SPEED)
                yield self._look_round(index)

    def _look_round(self, index: int) -> LookMotion:
        """Turn round, to the left and to the right by turns; wait where all sides are seen."""
        if self._view.half_angle >= math.pi:
            return Wait()
        # So that errors of the turns cancel.
        return TurnRound(self._context, -1.0 if index % 2 else 1.0)

    def _path_into_view(self, perception: TaskPerception) -> Path | None:
        """Plan a path to where the object is in view; None where the robot is far enough."""
        margin = self._margin.value if self._view.nearest > 0.0 else 0.0
        gap = _expected_gap(perception)
        if gap >= self._view.nearest + margin:
            return None
        path = path_off(self._context, perception, margin)
        if path is not None:
            return path
        return self._detour(perception, self._view.nearest + margin)

    def _detour(self, perception: TaskPerception, gap: float) -> Path | None:
        """Plan a path to a place round the object that has a gap to it; None where none is."""
        context, robot_pose = self._context, perception.robot_pose
        object_pose = perception.expected_object_pose
        direction = math.atan2(robot_pose.y - object_pose.y, robot_pose.x - object_pose.x)
        for offset in VIEWING_BEARINGS:
            facing = Pose(object_pose.x, object_pose.y, direction + offset)
            away = distance_at_gap(context, object_pose, facing, gap)
            try:
                return plan_path(context.robot, context.obj, object_pose, robot_pose,
                                 facing @ Pose(away, 0.0, math.pi), context.drive,
                                 occupancy_map=context.occupancy_map,
                                 uncertainty=perception.position_uncertainty)
            except NoPathFound:
                continue
        return None

    def _search_path(self, perception: TaskPerception, start: Pose, index: int) -> Path | None:
        """
        Plan a path to the next place of a search; None where there is no room for one.

        :param start: ``Pose`` of the robot at its start.
        :param index: of the round, from 1 on.
        """
        length = index * ROUND_DISTANCE
        for k in range(DIRECTIONS):
            direction = start.theta + (2 * index + k) * DIRECTION_STEP
            position = Pose(start.x, start.y, direction).transform((length, 0.0))
            path = self._straight_path(perception.robot_pose, position)
            if self._is_free(perception, path):
                return path
        return None

    def _straight_path(self, robot_pose: Pose, position: tuple[float, float]) -> Path:
        direction = math.atan2(position[1] - robot_pose.y, position[0] - robot_pose.x)
        end, waypoints = Pose(*position, direction), [Waypoint(*position)]
        if self._context.robot.drive == 'differential':
            return differential_path(robot_pose, end, waypoints, [False])
        return holonomic_path(robot_pose, end, waypoints)

    def _path_by(self, start: Pose, robot_pose: Pose, position: tuple[float, float]) -> Path:
        """Lead back to the start, and straight from there; with little turning, also backwards."""
        positions = [position] if distance(robot_pose, start) < BACK_AT_START else [
            start[:2], position]
        waypoints = [Waypoint(*each) for each in positions]
        if self._context.robot.drive != 'differential':
            return holonomic_path(robot_pose, Pose(*position, robot_pose.theta), waypoints)
        heading, before = robot_pose.theta, robot_pose[:2]
        are_backwards = []
        for each in positions:
            direction = math.atan2(each[1] - before[1], each[0] - before[0])
            are_backwards.append(math.cos(direction - heading) < 0.0)
            heading, before = direction + math.pi * are_backwards[-1], each
        return differential_path(robot_pose, Pose(*position, heading), waypoints, are_backwards)

    def _is_free(self, perception: TaskPerception, path: Path) -> bool:
        """Tell whether a path keeps clear of obstacles, and of where the object may be."""
        drive = self._context.drive
        poses = sample_path(path, self._context.robot, SPACING)
        if not self._is_clear(perception, poses):
            return False
        if not perception.localization.has_object:
            return True
        members, object_pose = perception.localization.members, perception.expected_object_pose
        least_gap = min(drive.clearance, _expected_gap(perception))
        return all(members.gap(object_pose, Pose(*pose)) >= least_gap for pose in poses.tolist())

    def _is_clear(self, perception: TaskPerception, poses: FloatArray) -> bool:
        """Tell whether a path keeps clear of obstacles, wherever the robot may be."""
        context, uncertainty = self._context, perception.position_uncertainty
        if context.occupancy_map is None:
            return True
        if perception.localization.has_object and not perception.is_robot_measured:
            # The object may be elsewhere, or the robot.
            uncertainty = uncertainty._replace(
                position=math.hypot(uncertainty.position, MISSING_STD))
        try:
            clearance = map_clearance(
                context.robot, Pose(*poses[0].tolist()), Pose(*poses[-1].tolist()), context.drive,
                MapContext(context.occupancy_map, uncertainty))
        except NoPathFound:
            return False
        return clearance.is_free(poses)


def path_off(context: BehaviorContext, perception: TaskPerception, margin: float,
             shortest: float = 0.0) -> Path | None:
    """
    Find the straight path off an object to where it is in view.

    :param margin: by which the gap has to exceed the nearest one with poses [m].
    :param shortest: least length of the path [m].
    :return: ``Path``, whose end faces the object where the base can; None where there is none.
    """
    if not perception.localization.has_object:
        return None
    view = View.from_settings(context.supervision)
    object_pose = perception.expected_object_pose
    needed = view.nearest + margin if view.nearest > 0.0 else 0.0
    path = retreat_path(context, perception.robot_pose, object_pose,
                        max(shortest, needed - _expected_gap(perception)),
                        perception.position_deviation)
    if path is None or context.robot.drive == 'differential' or view.half_angle >= math.pi:
        return path
    start, end = path.poses
    return Path((start, end._replace(theta=end.theta + bearing(end, object_pose))))


def _expected_gap(perception: TaskPerception) -> float:
    """Return the gap between the robot and where the object is expected [m]."""
    return perception.localization.members.gap(perception.expected_object_pose,
                                               perception.robot_pose)
