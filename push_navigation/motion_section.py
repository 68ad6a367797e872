"""A piece of a way between two stops: where the robot is on it, and what is ahead."""

import itertools
import math

from push_navigation.speed_profile import goes_on, joint_speeds, leg_limits

BRAKING = 0.9
SETTLE = 0.15


def braked(left, acceleration):
    """
    Speed from which the rest can still be stopped on; it fades out at the end.

    :param left: way or angle left, at least 0 [m or rad].
    :param acceleration: limit [m/s^2 or rad/s^2].
    :return: speed [m/s or rad/s].
    """
    acceleration *= BRAKING
    fading = acceleration * SETTLE ** 2
    if left < fading:
        return left / SETTLE
    return math.sqrt(acceleration * (2.0 * left - fading))


class Run:
    """
    Legs that are driven without a stop.

    :param legs: ``Leg`` sequence, each with a length.
    :param limits: ``DriveSettings`` within the limits of the robot.
    """

    def __init__(self, legs, limits):
        self.legs, self._limits = tuple(legs), limits
        self._begins = [0.0, *itertools.accumulate(leg.length for leg in self.legs)]
        self._speeds = joint_speeds(self.legs, limits)
        self._number = 0
        first = self.legs[0]
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
            leg = self.legs[self._number]
            way, aside = leg.project(point)
            if way < leg.length or self._number == len(self.legs) - 1:
                return self._begins[self._number] + way, aside
            self._number += 1

    def speed(self, way):
        """
        Speed at a place, such that everything ahead is reached slowly enough [m/s].

        It is below 0 beyond the end.

        :param way: from the beginning [m].
        """
        i = self._number
        top, braking = leg_limits(self.legs[i], self._limits)
        left = self._begins[i + 1] - way
        if i == len(self.legs) - 1:
            return math.copysign(min(top, braked(abs(left), braking)), left)
        return min(top, math.sqrt(self._speeds[i + 1] ** 2
                                  + 2.0 * BRAKING * braking * max(0.0, left)))

    def direction(self, way):
        """
        Direction of motion at a place, that of the ends beyond them [rad].

        :param way: from the beginning [m].
        """
        leg, along = self._leg_at(way)
        return leg.direction(along)

    def smooth_direction(self, way, speed):
        """
        Direction of motion that a robot can follow whose yaw rate does not jump.

        :param way: from the beginning [m].
        :param speed: of the robot [m/s].
        :return: direction [rad], curvature [1/m].
        """
        bent = max(abs(leg.bend) / leg.length for leg in self.legs)
        window = speed * speed * bent / (2.0 * self._limits.yaw_acceleration)
        here = self.direction(way)
        if window < 1e-6:
            leg = self._leg_at(way)[0]
            return here, leg.bend / leg.length
        before, after = self.direction(way - window), self.direction(way + window)
        before, after = (math.remainder(angle - here, 2.0 * math.pi) for angle in (before, after))
        return here + 0.25 * (before + after), (after - before) / (2.0 * window)

    def heading(self, way):
        """
        Heading that a holonomic base has at a place, and its change.

        :param way: from the beginning [m].
        :return: heading [rad], change per way [rad/m].
        """
        leg, along = self._leg_at(way)
        return leg.heading(along), leg.turn / leg.length

    def _leg_at(self, way):
        way = min(self.length, max(0.0, way))
        number = len(self.legs) - 1
        while number and way < self._begins[number]:
            number -= 1
        return self.legs[number], way - self._begins[number]


def stretches(way, limits):
    """
    Cut a way where the robot must stop.

    :param way: the ``Way``.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: list of ``Run``, and of the ``Leg`` of each turn on the spot.
    """
    groups = []
    for leg in way.legs:
        if groups and goes_on(groups[-1][-1], leg):
            groups[-1].append(leg)
        elif leg.length or leg.turn:
            groups.append([leg])
    return [Run(group, limits) if group[0].length else group[0] for group in groups]
