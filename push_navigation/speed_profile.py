"""
Speed profile of a path: trapezoids of speed along its sections, with stops between them.

Along a section the squared speed grows by ``2 a`` per distance at most, and falls likewise:

    v_i+1^2 <= v_i^2 + 2 a_i l_i,    v_i^2 <= v_i+1^2 + 2 a_i l_i

with l_i and a_i the length and the acceleration limit of segment i, and v = 0 at every stop.
"""

from collections.abc import Sequence
import itertools
import math

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
# Time constant with which the speed fades out at a stop; a trapezoid takes as much longer [s].
# Chosen: somewhat above the usual lag of a drive, so that it does not overshoot.
FADE_TIME = 0.15


def segment_limits(segment: PathSegment, limits: DriveSettings) -> tuple[float, float]:
    """
    Speed and acceleration limits along a segment.

    The yaw rate bounds them where the heading changes. Where the velocity rotates, in the world or
    in robot axes, lateral and tangential acceleration together keep to the limit.

    :param segment: the ``PathSegment``, with a length above 0.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: (speed [m/s], acceleration [m/s^2]).
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
    return speed, acceleration


def is_continuous(before: PathSegment, after: PathSegment) -> bool:
    """
    Tell whether the robot need not stop between two segments.

    :param before: ``PathSegment``.
    :param after: the ``PathSegment`` that follows.
    """
    if before.length == 0.0 or after.length == 0.0:
        return False
    return abs(wrap_angle(after.directions[0] - before.directions[1])) < SAME_DIRECTION


def joint_speeds(segments: Sequence[PathSegment], limits: DriveSettings) -> list[float]:
    """
    Greatest speeds at the joints of the segments, both ends included.

    :param segments: ``PathSegment`` sequence.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: speeds [m/s], one more than segments; 0 where the robot stops.
    """
    bounds = [segment_limits(segment, limits) if segment.length else (0.0, 0.0)
              for segment in segments]
    v_squared = [0.0] * (len(segments) + 1)
    for i in range(1, len(segments)):
        if is_continuous(segments[i - 1], segments[i]):
            v_squared[i] = min(bounds[i - 1][0], bounds[i][0]) ** 2
    for i, (segment, (_, acceleration)) in enumerate(zip(segments, bounds)):
        v_squared[i + 1] = min(v_squared[i + 1],
                               v_squared[i] + 2.0 * acceleration * segment.length)
    for i in reversed(range(len(segments))):
        v_squared[i] = min(v_squared[i],
                           v_squared[i + 1] + 2.0 * bounds[i][1] * segments[i].length)
    return [math.sqrt(value) for value in v_squared]


def travel_time(path: Path, robot: RoundRobot, settings: DriveSettings) -> float:
    """
    Time that a robot takes for a path, from rest to rest [s].

    The drive lags behind its commands once at each stop.

    :param path: the ``Path``.
    :param robot: the ``RoundRobot``.
    :param settings: ``DriveSettings``.
    """
    segments, limits = path.segments, settings.limited_to(robot)
    speeds = joint_speeds(segments, limits)
    time = 0.0
    for segment, first, last in zip(segments, speeds, speeds[1:]):
        if last == 0.0 and (segment.length or segment.heading_change):
            time += robot.time_constant + FADE_TIME
        if segment.length:
            time += _trapezoid_time(segment.length, first, last, *segment_limits(segment, limits))
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


def stopping_speed(left: float, acceleration: float) -> float:
    """
    Speed from which the robot can stop on what is left; it fades out at the end.

    With a the braking acceleration and T the fade time: ``left / T`` below a distance of
    ``a T^2``, and ``sqrt(a (2 left - a T^2))`` above, which continues it smoothly.

    :param left: distance or angle left, at least 0 [m or rad].
    :param acceleration: limit [m/s^2 or rad/s^2].
    :return: speed [m/s or rad/s].
    """
    acceleration *= BRAKING_FRACTION
    fading = acceleration * FADE_TIME ** 2
    if left < fading:
        return left / FADE_TIME
    return math.sqrt(acceleration * (2.0 * left - fading))


class MotionSection:
    """
    Section of a path between two stops: where the robot is on it, and what is ahead.

    :param segments: ``PathSegment`` sequence, each with a length.
    :param limits: ``DriveSettings`` within the limits of the robot.
    """

    def __init__(self, segments: Sequence[PathSegment], limits: DriveSettings) -> None:
        self.segments = tuple(segments)
        self._limits = limits
        self._starts = [0.0, *itertools.accumulate(segment.length for segment in self.segments)]
        self._speeds = joint_speeds(self.segments, limits)
        # The segment that the robot is on.
        self._number = 0
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
            segment = self.segments[self._number]
            along, lateral = segment.project(point)
            if along < segment.length or self._number == len(self.segments) - 1:
                return self._starts[self._number] + along, lateral
            self._number += 1

    def speed(self, s: float) -> float:
        """
        Speed from which everything ahead is still reached slowly enough [m/s].

        It is below 0 beyond the end.

        :param s: arc length from the beginning [m].
        """
        i = self._number
        top, braking = segment_limits(self.segments[i], self._limits)
        left = self._starts[i + 1] - s
        if i == len(self.segments) - 1:
            return math.copysign(min(top, stopping_speed(abs(left), braking)), left)
        return min(top, math.sqrt(self._speeds[i + 1] ** 2
                                  + 2.0 * BRAKING_FRACTION * braking * max(0.0, left)))

    def direction(self, s: float) -> float:
        """
        Direction of motion at an arc length, that of the ends beyond them [rad].

        :param s: arc length from the beginning [m].
        """
        segment, along = self._segment_at(s)
        return segment.direction(along)

    def smooth_direction(self, s: float, speed: float) -> tuple[float, float]:
        """
        Direction of motion that a robot can follow whose yaw rate does not jump.

        It is averaged over the distance on which the yaw rate of the sharpest arc builds up.

        :param s: arc length from the beginning [m].
        :param speed: of the robot [m/s].
        :return: direction [rad], curvature [1/m].
        """
        sharpest = max(abs(segment.arc_angle) / segment.length for segment in self.segments)
        window = speed * speed * sharpest / (2.0 * self._limits.yaw_acceleration)
        here = self.direction(s)
        if window < 1e-6:
            segment, _ = self._segment_at(s)
            return here, segment.arc_angle / segment.length
        before, after = (math.remainder(self.direction(s + offset) - here, 2.0 * math.pi)
                         for offset in (-window, window))
        return here + 0.25 * (before + after), (after - before) / (2.0 * window)

    def heading(self, s: float) -> tuple[float, float]:
        """
        Heading of a holonomic base at an arc length, and its rate of change.

        :param s: arc length from the beginning [m].
        :return: heading [rad], change per distance [rad/m].
        """
        segment, along = self._segment_at(s)
        return segment.heading(along), segment.heading_change / segment.length

    def _segment_at(self, s: float) -> tuple[PathSegment, float]:
        s = min(self.length, max(0.0, s))
        number = len(self.segments) - 1
        while number and s < self._starts[number]:
            number -= 1
        return self.segments[number], s - self._starts[number]


def split_at_stops(path: Path, limits: DriveSettings) -> list[MotionSection | PathSegment]:
    """
    Split a path where the robot must stop.

    :param path: the ``Path``.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: list of ``MotionSection``, and of the ``PathSegment`` of each rotation in place.
    """
    groups: list[list[PathSegment]] = []
    for segment in path.segments:
        if groups and is_continuous(groups[-1][-1], segment):
            groups[-1].append(segment)
        elif segment.length or segment.heading_change:
            groups.append([segment])
    return [MotionSection(group, limits) if group[0].length else group[0] for group in groups]
