"""A piece of a way between two stops: where the robot is on it, and what is ahead."""

import itertools
import math

from push_navigation.speed_profile import is_continuous, joint_speeds, segment_limits

BRAKING = 0.9
FADE_TIME = 0.15


def stopping_speed(left, acceleration):
    """
    Speed from which the rest can still be stopped on; it fades out at the end.

    :param left: way or angle left, at least 0 [m or rad].
    :param acceleration: limit [m/s^2 or rad/s^2].
    :return: speed [m/s or rad/s].
    """
    acceleration *= BRAKING
    fading = acceleration * FADE_TIME ** 2
    if left < fading:
        return left / FADE_TIME
    return math.sqrt(acceleration * (2.0 * left - fading))


class MotionSection:
    """
    Legs that are driven without a stop.

    :param segments: ``PathSegment`` sequence, each with a length.
    :param limits: ``DriveSettings`` within the limits of the robot.
    """

    def __init__(self, segments, limits):
        self.segments, self._limits = tuple(segments), limits
        self._begins = [0.0, *itertools.accumulate(segment.length for segment in self.segments)]
        self._speeds = joint_speeds(self.segments, limits)
        self._number = 0
        first = self.segments[0]
        self.is_backwards = math.cos(first.start.theta - first.directions[0]) < 0.0

    @property
    def length(self):
        """Length of the way of the robot's centre [m]."""
        return self._begins[-1]

    def locate(self, point):
        """
        Find how far the robot has come, never back to a leg that it has passed.

        :param point: (x, y) [m].
        :return: (way from the beginning [m], distance to the left of the run [m]).
        """
        while True:
            segment = self.segments[self._number]
            way, aside = segment.project(point)
            if way < segment.length or self._number == len(self.segments) - 1:
                return self._begins[self._number] + way, aside
            self._number += 1

    def speed(self, way):
        """
        Speed at a place, such that everything ahead is reached slowly enough [m/s].

        It is below 0 beyond the end.

        :param way: from the beginning [m].
        """
        i = self._number
        top, braking = segment_limits(self.segments[i], self._limits)
        left = self._begins[i + 1] - way
        if i == len(self.segments) - 1:
            return math.copysign(min(top, stopping_speed(abs(left), braking)), left)
        return min(top, math.sqrt(self._speeds[i + 1] ** 2
                                  + 2.0 * BRAKING * braking * max(0.0, left)))

    def direction(self, way):
        """
        Direction of motion at a place, that of the ends beyond them [rad].

        :param way: from the beginning [m].
        """
        segment, along = self._leg_at(way)
        return segment.direction(along)

    def smooth_direction(self, way, speed):
        """
        Direction of motion that a robot can follow whose yaw rate does not jump.

        :param way: from the beginning [m].
        :param speed: of the robot [m/s].
        :return: direction [rad], curvature [1/m].
        """
        bent = max(abs(segment.arc_angle) / segment.length for segment in self.segments)
        window = speed * speed * bent / (2.0 * self._limits.yaw_acceleration)
        here = self.direction(way)
        if window < 1e-6:
            segment = self._leg_at(way)[0]
            return here, segment.arc_angle / segment.length
        before, after = self.direction(way - window), self.direction(way + window)
        before, after = (math.remainder(angle - here, 2.0 * math.pi) for angle in (before, after))
        return here + 0.25 * (before + after), (after - before) / (2.0 * window)

    def heading(self, way):
        """
        Heading that a holonomic base has at a place, and its change.

        :param way: from the beginning [m].
        :return: heading [rad], change per way [rad/m].
        """
        segment, along = self._leg_at(way)
        return segment.heading(along), segment.heading_change / segment.length

    def _leg_at(self, way):
        way = min(self.length, max(0.0, way))
        number = len(self.segments) - 1
        while number and way < self._begins[number]:
            number -= 1
        return self.segments[number], way - self._begins[number]


def split_at_stops(way, limits):
    """
    Cut a way where the robot must stop.

    :param way: the ``Path``.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: list of ``MotionSection``, and of the ``PathSegment`` of each turn on the spot.
    """
    groups = []
    for segment in way.segments:
        if groups and is_continuous(groups[-1][-1], segment):
            groups[-1].append(segment)
        elif segment.length or segment.heading_change:
            groups.append([segment])
    return [MotionSection(group, limits) if group[0].length else group[0] for group in groups]
