"""
What a slow push at a known object tells of radius, tracker and pushing force.

At rest in contact, robot and object do not move, so that no delay counts. There the gap g between
stated outline and stated disc, by the poses, is

    g = e + b n,

where e is what radius and size of the object are greater than stated, b the offset of the object
poses in the object's axes, and n the direction of the push there. One touch shows their sum. Two
from opposite sides show both e and the part of b along n. While both move with v, poses that are
measured a time tau before their stamps add -v tau to the gap.

With F = sum mu_i N_i of the stated object, the base pushes with more than F where the object moves
as far as the wheels turn, and with less where the wheels spin.
"""

import math
from typing import NamedTuple

import numpy as np
from push_base.calibration.recording import Purpose, ReceivedPose, Recording
from push_base.calibration.topics import pose_rows
from push_base.push_force import needed_force
from push_model.contact import contact_point, find_contact, robot_gap
from push_model.geometry import Coordinates, FloatArray, Pose
from push_model.interval import Interval
from push_model.parameters import PushedObject, RoundRobot

# Time at the end of a rest that is averaged [s].
AVERAGED_TIME = 0.8
# Poses that an average needs.
MIN_POSES = 5
# Distance of a push behind the touch that is not compared, while the contact settles [m].
SETTLING_DISTANCE = 0.05
# Least half widths of the intervals of gaps [m] and delays [s]; measured on drawn bases: what
# averages at rest, and a speed that is not quite constant, leave.
MIN_GAP_WIDTH, MIN_DELAY_WIDTH = 1.5e-3, 0.015
# Ratio of object and wheels below which wheels spin, and below which they slip; chosen: healthy
# pushes stay above 0.48 in tasks, and straight ones on a floor as stated above 0.95.
SPIN_RATIO, SLIP_RATIO = 0.3, 0.85
# Part of the way that the robot itself comes, by ``robot_pose``, from which on its wheels cannot
# be the reason why an object stands; chosen.
MIN_PROGRESS = 0.6
# Cosine of the angle between opposite pushes, at most.
OPPOSITE = -0.9


class Touch(NamedTuple):
    """
    One push.

    :param direction: of the push, at the contact, object frame [rad].
    :param gap: g at rest in contact [m]; None where it is not known whether they touch.
    :param stamp_delay: tau [s]; None where the object did not move.
    :param object_ratio: way of the object's point of contact over that of the wheels.
    :param robot_ratio: way of the robot in the world over that of the wheels; None where nothing
        measures it.
    """

    direction: float
    gap: Interval | None
    stamp_delay: Interval | None
    object_ratio: float
    robot_ratio: float | None

    @property
    def is_object_unseen(self) -> bool:
        """Tell whether the robot moved on, and the object did not by its poses."""
        return (self.object_ratio < SPIN_RATIO and self.robot_ratio is not None
                and self.robot_ratio > MIN_PROGRESS)

    @property
    def is_spinning(self) -> bool:
        """Tell whether the wheels turned, and the object hardly moved."""
        return self.object_ratio < SPIN_RATIO and not self.is_object_unseen

    @property
    def is_slipping(self) -> bool:
        """Tell whether the object came less far than the wheels turned."""
        return SPIN_RATIO <= self.object_ratio < SLIP_RATIO


class TouchResult(NamedTuple):
    """
    Result of all pushes.

    :param touches: ``Touch`` of each.
    :param combined: e + b n, where they cannot be told apart [m].
    :param size_error: e, of radius or size of the object [m].
    :param pose_offset: b n, along the first push [m].
    :param stamp_delay: tau [s].
    :param needed_force: of the object, as stated [N].
    """

    touches: tuple[Touch, ...]
    combined: Interval | None
    size_error: Interval | None
    pose_offset: Interval | None
    stamp_delay: Interval | None
    needed_force: float

    @property
    def is_too_weak(self) -> bool:
        """Tell whether the base pushes with less than the object needs."""
        return any(touch.is_spinning for touch in self.touches)


def evaluate_touches(recording: Recording) -> TouchResult | None:
    """
    Find out what pushes tell.

    :return: ``TouchResult``; None where nothing was touched.
    """
    if recording.object is None:
        return None
    tracks = _Tracks(recording, recording.object)
    touches = [touch for touch in map(tracks.evaluate, _pushes(recording)) if touch is not None]
    if not touches:
        return None
    first = touches[0]
    opposite = [touch for touch in touches[1:]
                if math.cos(touch.direction - first.direction) < OPPOSITE]
    delays = [touch.stamp_delay for touch in touches if touch.stamp_delay is not None]
    combined = size_error = pose_offset = None
    if first.gap is not None and opposite and opposite[0].gap is not None:
        size_error = _half(first.gap, opposite[0].gap, 1.0)
        pose_offset = _half(first.gap, opposite[0].gap, -1.0)
    else:
        combined = first.gap
    return TouchResult(tuple(touches), combined, size_error, pose_offset,
                       delays[0] if delays else None, needed_force(recording.object))


def touch_start(recording: Recording) -> float:
    """Return when the robot leaves its square for the object [s]."""
    return next((item.time for item in recording.commands if item.purpose is Purpose.APPROACH),
                math.inf)


class _Push(NamedTuple):
    """
    Times of a push [s].

    :param start: of the drive.
    :param stop: its end.
    :param end: of the rest behind it.
    """

    start: float
    stop: float
    end: float


def _pushes(recording: Recording) -> list[_Push]:
    """List the pushes that were driven to their end, with the rest behind them."""
    times: dict[int, list[float]] = {}
    purposes: dict[int, Purpose] = {}
    for item in recording.commands:
        times.setdefault(item.segment, []).append(item.time)
        purposes[item.segment] = item.purpose
    return [_Push(times[segment][0], times[segment + 1][0], times[segment + 1][-1])
            for segment, purpose in purposes.items() if purpose is Purpose.TOUCH
            and purposes.get(segment + 1) is Purpose.CONTACT]


class _Tracks:
    """Tracks of robot and object, by their stamps."""

    def __init__(self, recording: Recording, obj: PushedObject) -> None:
        self._object = obj
        self._robot: RoundRobot = recording.robot
        self._offset = _clock_offset(recording)
        self._objects = _rows(recording.object_poses)
        self._wheels = np.array([(item.odometry.time, *item.odometry.pose)
                                 for item in recording.odometry]).reshape(-1, 4)
        self._is_measured = len(recording.robot_poses) >= MIN_POSES
        self._robots = _rows(recording.robot_poses) if self._is_measured else self._wheels

    def evaluate(self, push: _Push) -> Touch | None:
        """Evaluate a push; return None where too few poses came."""
        push = _Push(*(time - self._offset for time in push))
        before = self._mean_object(push.start)
        after = self._mean_object(push.end)
        if before is None or after is None:
            return None
        gaps = self._gaps(push.end - AVERAGED_TIME, push.end)
        robot = self._robot_at(push.end)
        touched = find_contact(self._object, after, robot, self._robot.radius)
        contact = contact_point(self._object, touched.contact)
        direction = math.cos(touched.gamma), math.sin(touched.gamma)
        travel = _displacement(before.transform(contact), after.transform(contact), direction)
        wheels = self._wheel_travel(push, before, direction)
        object_ratio = travel / wheels if wheels > 0.0 else 1.0
        robot_ratio = self._robot_ratio(push, direction) if self._is_measured else None
        is_moved = object_ratio >= SPIN_RATIO
        gap = _mean(gaps, MIN_GAP_WIDTH) if is_moved or self._is_measured else None
        is_unseen = not is_moved and (robot_ratio or 0.0) > MIN_PROGRESS
        return Touch(touched.gamma - after.theta, None if is_unseen else gap,
                     self._stamp_delay(push, travel, gap) if is_moved else None,
                     object_ratio, robot_ratio)

    def _mean_object(self, end: float) -> Pose | None:
        times = self._objects[:, 0]
        rows = self._objects[(times > end - AVERAGED_TIME) & (times <= end)]
        return Pose(*rows[:, 1:].mean(axis=0).tolist()) if len(rows) >= MIN_POSES else None

    def _robot_at(self, time: float) -> Pose:
        rows = self._robots
        near = rows[(rows[:, 0] > time - AVERAGED_TIME) & (rows[:, 0] <= time)]
        return Pose(*near[:, 1:].mean(axis=0).tolist()) if len(near) else Pose(
            *rows[-1, 1:].tolist())

    def _gaps(self, start: float, end: float) -> FloatArray:
        """Return the gap at each object pose within some time, shape (k,) [m]."""
        times = self._objects[:, 0]
        rows = self._objects[(times > start) & (times <= end)]
        robots = np.array([np.interp(rows[:, 0], self._robots[:, 0], self._robots[:, k])
                           for k in (1, 2, 3)]).T
        return np.array([robot_gap(self._object, row[1:], robot, self._robot.radius)
                         for row, robot in zip(rows, robots)], dtype=np.float64)

    def _wheel_travel(self, push: _Push, before: Pose, direction: Coordinates) -> float:
        """Return how far the wheels turned behind the touch [m]."""
        first = self._robot_at(push.start)
        free = robot_gap(self._object, before, first, self._robot.radius)
        start, end = (self._wheels_at(time) for time in (push.start, push.end))
        return math.dist(start[:2], end[:2]) - max(0.0, free)

    def _wheels_at(self, time: float) -> Pose:
        return Pose(*(float(np.interp(time, self._wheels[:, 0], self._wheels[:, k]))
                      for k in (1, 2, 3)))

    def _robot_ratio(self, push: _Push, direction: Coordinates) -> float:
        """Compare the way of robot and wheels, of the second half of the drive."""
        middle = 0.5 * (push.start + push.stop)
        travel = _displacement(self._at(middle), self._at(push.stop), direction)
        wheels = math.dist(self._wheels_at(middle)[:2], self._wheels_at(push.stop)[:2])
        return travel / wheels if wheels > 0.0 else 1.0

    def _stamp_delay(self, push: _Push, travel: float, gap: Interval | None) -> Interval | None:
        """Return by how much poses are measured before their stamps say [s]."""
        speed = self._speed(push)
        if gap is None or travel <= 2.0 * SETTLING_DISTANCE or speed <= 0.0:
            return None
        start = push.stop - (travel - SETTLING_DISTANCE) / speed
        gaps = self._gaps(start, push.stop)
        if len(gaps) < MIN_POSES:
            return None
        moving = _mean(gaps, 0.0)
        value = (gap.value - moving.value) / speed
        width = max(MIN_DELAY_WIDTH, (moving.high - moving.low + gap.high - gap.low) / speed / 4.0)
        return Interval(value, value - width, value + width)

    def _speed(self, push: _Push) -> float:
        """Return the speed of the robot in the second half of the drive [m/s]."""
        middle = 0.5 * (push.start + push.stop)
        return (math.dist(self._at(middle), self._at(push.stop))
                / max(1e-3, push.stop - middle))

    def _at(self, time: float) -> tuple[float, float]:
        """Return the position of the robot (x, y) at a time [m]."""
        x, y = (float(np.interp(time, self._robots[:, 0], self._robots[:, k])) for k in (1, 2))
        return x, y


def _rows(poses: list[ReceivedPose]) -> FloatArray:
    times = np.array([item.measured.time for item in poses]).reshape(-1, 1)
    rows = np.hstack([times, pose_rows([item.measured.pose for item in poses])])
    return rows[np.argsort(rows[:, 0], kind='stable')]


def _clock_offset(recording: Recording) -> float:
    """Return by how much the clock of commands is ahead of stamps of odometry [s]."""
    ages = [item.arrival - item.odometry.time for item in recording.odometry]
    age = float(np.median(ages)) if ages else 0.0
    return age if not -0.005 <= age <= 1.0 else 0.0


def _displacement(start: Coordinates, end: Coordinates, direction: Coordinates) -> float:
    """Return the distance from one point to another along a direction [m]."""
    return float((end[0] - start[0]) * direction[0] + (end[1] - start[1]) * direction[1])


def _mean(values: FloatArray, min_width: float) -> Interval:
    mean = float(values.mean())
    width = max(min_width, 2.0 * float(values.std(ddof=1)) / math.sqrt(len(values)))
    return Interval(mean, mean - width, mean + width)


def _half(first: Interval, second: Interval, sign: float) -> Interval:
    value = 0.5 * (first.value + sign * second.value)
    width = 0.25 * math.hypot(first.high - first.low, second.high - second.low)
    return Interval(value, value - width, value + width)
