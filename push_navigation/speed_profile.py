"""
Speed profile of a path: trapezoids of speed along its sections, with stops between them.

Along a section the squared speed grows by ``2 a`` per distance at most, and falls likewise:

    v_i+1^2 <= v_i^2 + 2 a_i l_i,    v_i^2 <= v_i+1^2 + 2 a_i l_i

with l_i and a_i the length and the acceleration limit of segment i, and v = 0 at every stop. At
both ends of the path the robot may be moving.

Where the curvature jumps by k, the yaw rate needs a distance of 2 w to follow, with alpha its
acceleration,

    w = v^2 k / (2 alpha)

so that the heading that can be followed is that of the path averaged over w to both sides. On an
arc the robot is then inside the path by ``k w^2 / 6``, which bounds the speed at the joint.
"""

from collections.abc import Sequence
import itertools
import math
from typing import NamedTuple

from push_model.geometry import Coordinates, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.path import Path, PathSegment
from push_navigation.settings import DriveSettings

# Directions that differ by less count as the same: no stop between two segments. Chosen: as much
# as a rotation in place that is left out [rad].
SAME_DIRECTION = 1e-3
# Fraction of the acceleration limit that the lateral acceleration may take on an arc. Chosen: it
# leaves as much to change the speed, as sqrt(1 - 0.7^2) is 0.71.
LATERAL_FRACTION = 0.7
# Fraction of the acceleration limit that braking is planned with. Chosen: leaves a tenth to
# feedback.
BRAKING_FRACTION = 0.9
# Fraction of the yaw acceleration that curvature is planned with. Chosen: leaves some to feedback.
YAW_FRACTION = 0.85
# A robot whose yaw rate takes time to build up is inside an arc by at most this [m]. Chosen: well
# below the clearance from the object, and as much as feedback lets it deviate elsewhere.
MAX_CORNER_CUT = 0.004
# An arc that begins or ends at rest has no second joint that undoes this: a fraction of it.
# Measured: with this one, the robot passes the end of short paths within 5 mm (see the tests).
CORNER_CUT_AT_REST = 0.4
# Where the robot passes the end of the path, the yaw rate has settled on this fraction of the last
# segment. Measured: the heading is then within 1.5 degrees at the end (see the tests).
PASSING_ROOM = 0.85
# Below this distance the averaging of directions is left out [m]. Chosen: far below what can be
# measured, far above rounding.
MIN_WINDOW = 1e-6
# Time constant with which the speed fades out at a stop; a trapezoid takes as much longer [s].
# Chosen: somewhat above the usual lag of a drive, so that it does not overshoot.
FADE_TIME = 0.15


class SegmentLimits(NamedTuple):
    """Limits of speed [m/s] and acceleration [m/s^2] along a segment."""

    speed: float
    acceleration: float


def segment_limits(segment: PathSegment, limits: DriveSettings) -> SegmentLimits:
    """
    Speed and acceleration limits along a segment.

    The yaw rate bounds them where the heading changes. Where the velocity rotates, in the world or
    in robot axes, lateral and tangential acceleration together keep to the limit.

    :param segment: the ``PathSegment``, with a length above 0.
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    speed, acceleration = limits.speed, limits.acceleration
    length = segment.length
    heading_change = abs(segment.heading_change)
    if heading_change > 0.0:
        speed = min(speed, limits.yaw_rate * length / heading_change)
        acceleration = min(acceleration, limits.yaw_acceleration * length / heading_change)
    curvature = max(abs(segment.arc_angle),
                    abs(segment.arc_angle - segment.heading_change)) / length
    if curvature > 0.0:
        speed = min(speed, math.sqrt(LATERAL_FRACTION * limits.acceleration / curvature))
        lateral = speed * speed * curvature
        acceleration = min(acceleration, math.sqrt(limits.acceleration ** 2 - lateral ** 2))
    return SegmentLimits(speed, acceleration)


def is_continuous(before: PathSegment, after: PathSegment) -> bool:
    """
    Tell whether the robot need not stop between two segments.

    :param after: the ``PathSegment`` that follows.
    """
    if before.length == 0.0 or after.length == 0.0:
        return False
    return abs(wrap_angle(after.directions[0] - before.directions[1])) < SAME_DIRECTION


class CurvatureJump(NamedTuple):
    """
    Joint of two segments with different curvatures.

    :param s: arc length from the beginning of the section [m].
    :param jump: change of the curvature [1/m].
    :param window: distance to both sides over which the direction is averaged [m].
    """

    s: float
    jump: float
    window: float


def smoothing_window(speed: float, jump: float, limits: DriveSettings) -> float:
    """
    Compute the distance before and behind a jump of curvature on which the yaw rate changes [m].

    :param speed: of the robot there [m/s].
    :param jump: of the curvature [1/m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    return speed * speed * abs(jump) / (2.0 * YAW_FRACTION * limits.yaw_acceleration)


def joint_speed_limit(before: PathSegment, after: PathSegment, room: float, corner_cut: float,
                      limits: DriveSettings) -> tuple[float, float]:
    """
    Speed at which the yaw rate of the robot can follow from one segment to the next.

    :param before: ``PathSegment``, with a length above 0.
    :param after: the ``PathSegment`` that follows, with a length above 0.
    :param room: distance from the joint in which the yaw rate must have settled [m].
    :param corner_cut: by which the robot may be inside the arc [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: (speed [m/s], distance before and behind the joint for which it holds [m]).
    """
    jump = abs(after.heading_change / after.length - before.heading_change / before.length)
    top = min(segment_limits(before, limits).speed, segment_limits(after, limits).speed)
    window = smoothing_window(top, jump, limits)
    if window < MIN_WINDOW:
        return top, 0.0
    longest = min(room, math.sqrt(6.0 * corner_cut / jump))
    if window <= longest:
        return top, window
    return top * math.sqrt(longest / window), longest


class JointSpeeds(NamedTuple):
    """
    Greatest speeds at the joints of segments, both ends included.

    :param speeds: one more than segments; 0 where the robot stops [m/s].
    :param windows: distance before and behind each joint on which the speed is that [m].
    """

    speeds: list[float]
    windows: list[float]

    def ramp_length(self, index: int, length: float) -> float:
        """
        Length on which the speed changes on a segment [m].

        :param index: of the segment.
        :param length: of the segment [m].
        """
        return max(0.0, length - self.windows[index] - self.windows[index + 1])


def joint_speeds(segments: Sequence[PathSegment], limits: DriveSettings, *,
                 start_speed: float = 0.0, end_speed: float = 0.0) -> JointSpeeds:
    """
    Find the greatest speeds at the joints of the segments, both ends included.

    :param segments: ``PathSegment`` sequence.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param start_speed: speed along the path at its beginning, at most [m/s].
    :param end_speed: the same at its end [m/s].
    """
    bounds = [segment_limits(segment, limits) if segment.length else SegmentLimits(0.0, 0.0)
              for segment in segments]
    speeds, windows = [0.0] * (len(segments) + 1), [0.0] * (len(segments) + 1)
    moves_on = [False, *map(is_continuous, segments, segments[1:]), end_speed > 0.0]
    for i in range(1, len(segments)):
        if moves_on[i]:
            # Half of a segment for each of its joints.
            passes = moves_on[-1] and i + 1 == len(segments)
            room = min(0.5 * segments[i - 1].length,
                       (PASSING_ROOM if passes else 0.5) * segments[i].length)
            cut = MAX_CORNER_CUT
            if not (moves_on[i - 1] and moves_on[i + 1]):
                cut *= CORNER_CUT_AT_REST
            speeds[i], windows[i] = joint_speed_limit(segments[i - 1], segments[i], room, cut,
                                                      limits)
    joints = JointSpeeds(speeds, windows)
    if segments:
        speeds[0] = min(start_speed, bounds[0].speed)
        speeds[-1] = min(end_speed, bounds[-1].speed)
    # Speeds that can be reached from the joint before, then those from which the next can be.
    for i, (segment, bound) in enumerate(zip(segments, bounds)):
        gain = 2.0 * bound.acceleration * joints.ramp_length(i, segment.length)
        speeds[i + 1] = min(speeds[i + 1], math.sqrt(speeds[i] ** 2 + gain))
    for i, (segment, bound) in reversed(list(enumerate(zip(segments, bounds)))):
        gain = 2.0 * bound.acceleration * joints.ramp_length(i, segment.length)
        speeds[i] = min(speeds[i], math.sqrt(speeds[i + 1] ** 2 + gain))
    return joints


def travel_time(path: Path, robot: RoundRobot, settings: DriveSettings, *,
                start_speed: float = 0.0, end_speed: float = 0.0) -> float:
    """
    Time that a robot takes for a path [s].

    The drive lags behind its commands once at each stop, and where the robot passes the end of
    the path. A robot that moves the other way at the beginning first brakes; how far it rolls
    meanwhile is not counted.

    :param start_speed: speed along the path at its beginning, negative against it [m/s].
    :param end_speed: speed at which it passes the end, if it can [m/s].
    """
    segments, limits = path.segments, settings.limited_to(robot)
    joints = joint_speeds(segments, limits, start_speed=max(0.0, start_speed),
                          end_speed=end_speed)
    time = max(0.0, -start_speed) / limits.acceleration
    if joints.speeds[-1] > 0.0:
        time += robot.time_constant
    for i, segment in enumerate(segments):
        first, last = joints.speeds[i:i + 2]
        if last == 0.0 and (segment.length or segment.heading_change):
            time += robot.time_constant + FADE_TIME
        if segment.length:
            time += sum(window / speed for speed, window in zip((first, last),
                                                                joints.windows[i:i + 2]) if window)
            time += _trapezoid_time(joints.ramp_length(i, segment.length), first, last,
                                    *segment_limits(segment, limits))
        elif segment.heading_change:
            time += _trapezoid_time(abs(segment.heading_change), 0.0, 0.0, limits.yaw_rate,
                                    limits.yaw_acceleration)
    return time


def _trapezoid_time(length: float, first: float, last: float, speed: float,
                    acceleration: float) -> float:
    half = 0.5 * (first * first + last * last)
    peak = min(speed, math.sqrt(half + acceleration * length))
    even = length - (peak * peak - half) / acceleration
    return (2.0 * peak - first - last) / acceleration + even / peak


def stopping_speed(remaining: float, acceleration: float) -> float:
    """
    Speed from which the robot can stop on the remaining distance; it fades out at the end.

    With a the braking acceleration and T the fade time: ``remaining / T`` below a distance of
    ``a T^2``, and ``sqrt(a (2 remaining - a T^2))`` above, which continues it smoothly.

    :param remaining: remaining distance or angle, at least 0 [m or rad].
    :param acceleration: limit [m/s^2 or rad/s^2].
    :return: speed [m/s or rad/s].
    """
    acceleration *= BRAKING_FRACTION
    fading = acceleration * FADE_TIME ** 2
    if remaining < fading:
        return remaining / FADE_TIME
    return math.sqrt(acceleration * (2.0 * remaining - fading))


class MotionSection:
    """
    Section of a path between two stops: where the robot is on it, and what is ahead.

    :param segments: ``PathSegment`` sequence, each with a length.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param end_speed: speed at which the robot passes its end, 0 where it stops there [m/s].
    """

    def __init__(self, segments: Sequence[PathSegment], limits: DriveSettings,
                 end_speed: float = 0.0) -> None:
        self.segments = tuple(segments)
        # Of each segment: limits of speed and acceleration, and curvature.
        self._limits = [segment_limits(segment, limits) for segment in self.segments]
        self._curvatures = [segment.arc_angle / segment.length for segment in self.segments]
        self._starts = [0.0, *itertools.accumulate(segment.length for segment in self.segments)]
        self._speeds, self._windows = joint_speeds(self.segments, limits, end_speed=end_speed)
        self._joints = self._curvature_jumps()
        # The segment that the robot is on.
        self._index = 0
        first = self.segments[0]
        self.is_backwards = math.cos(first.start.theta - first.directions[0]) < 0.0

    @property
    def length(self) -> float:
        """Length of the path of the robot's centre [m]."""
        return self._starts[-1]

    def locate(self, point: Coordinates) -> tuple[float, float]:
        """
        Find how far the robot has come, never back to a segment that it has passed.

        :param point: (x, y) [m].
        :return: (arc length from the beginning [m], lateral offset to the left [m]).
        """
        while True:
            segment = self.segments[self._index]
            along, lateral = segment.project(point)
            if along < segment.length or self._index == len(self.segments) - 1:
                return self._starts[self._index] + along, lateral
            self._index += 1

    def speed(self, s: float) -> float:
        """
        Speed from which everything ahead is still reached slowly enough [m/s].

        Beyond an end at which the robot stops it is below 0; beyond others it stays.

        :param s: arc length from the beginning [m].
        """
        i = self._index
        top, braking = self._limits[i]
        remaining = self._starts[i + 1] - s
        if self._windows[i] and s - self._starts[i] < self._windows[i]:
            top = min(top, self._speeds[i])
        if i == len(self.segments) - 1 and self._speeds[-1] == 0.0:
            return math.copysign(min(top, stopping_speed(abs(remaining), braking)), remaining)
        remaining = max(0.0, remaining - self._windows[i + 1])
        return min(top, math.sqrt(self._speeds[i + 1] ** 2
                                  + 2.0 * BRAKING_FRACTION * braking * remaining))

    def direction(self, s: float) -> float:
        """
        Direction of motion at an arc length, that of the ends beyond them [rad].

        :param s: arc length from the beginning [m].
        """
        index, along = self._segment_at(s)
        return self.segments[index].direction(along)

    def smooth_motion(self, s: float) -> tuple[float, float, float]:
        """
        Motion that a robot can follow whose yaw rate does not jump, on and beside the path.

        The direction is averaged over the distance on which the yaw rate builds up at the nearest
        joint of two segments.

        :param s: arc length from the beginning [m].
        :return: direction [rad], curvature [1/m], offset to the left of the path [m].
        """
        index, along = self._segment_at(s)
        direction, curvature = self.segments[index].direction(along), self._curvatures[index]
        joint = min(self._joints, key=lambda joint: abs(s - joint.s), default=None)
        if joint is None:
            return direction, curvature, 0.0
        offset = curvature * joint.window ** 2 / 6.0
        overlap = joint.window - abs(s - joint.s)
        if overlap > 0.0:
            beyond = math.copysign(1.0, s - joint.s)
            direction += joint.jump * overlap ** 2 / (4.0 * joint.window)
            curvature -= beyond * joint.jump * overlap / (2.0 * joint.window)
            offset -= beyond * joint.jump * overlap ** 3 / (12.0 * joint.window)
        return direction, curvature, offset

    def heading(self, s: float) -> tuple[float, float]:
        """
        Heading of a holonomic base at an arc length, and its rate of change.

        :param s: arc length from the beginning [m].
        :return: heading [rad], change per distance [rad/m].
        """
        index, along = self._segment_at(s)
        segment = self.segments[index]
        return segment.heading(along), segment.heading_change / segment.length

    def _curvature_jumps(self) -> list[CurvatureJump]:
        curvatures = self._curvatures
        return [CurvatureJump(s, after - before, window) for s, window, before, after in zip(
            self._starts[1:], self._windows[1:], curvatures, curvatures[1:]) if window]

    def _segment_at(self, s: float) -> tuple[int, float]:
        """Find the index of the segment at an arc length, and the arc length on it [m]."""
        s = min(self.length, max(0.0, s))
        index = len(self.segments) - 1
        while index and s < self._starts[index]:
            index -= 1
        return index, s - self._starts[index]


def split_at_stops(path: Path, limits: DriveSettings,
                   end_speed: float = 0.0) -> list[MotionSection | PathSegment]:
    """
    Split a path where the robot must stop.

    :param limits: ``DriveSettings`` within the limits of the robot.
    :param end_speed: speed at which it passes the end of the path [m/s].
    :return: list of ``MotionSection``, and of the ``PathSegment`` of each rotation in place.
    """
    groups: list[list[PathSegment]] = []
    for segment in path.segments:
        if groups and is_continuous(groups[-1][-1], segment):
            groups[-1].append(segment)
        elif segment.length or segment.heading_change:
            groups.append([segment])
    speeds = [0.0] * (len(groups) - 1) + [end_speed]
    return [MotionSection(group, limits, speed) if group[0].length else group[0]
            for group, speed in zip(groups, speeds)]
