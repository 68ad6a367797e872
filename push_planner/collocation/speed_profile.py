"""Speed profile of a push: squared speed over arc length, and the time that it takes."""

import math
from typing import NamedTuple

from push_planner.problem import InitialMotion

RAMP_SHARE = 0.5
NEARLY = 0.98


class SpeedProfile(NamedTuple):
    """
    Squared speeds and the lengths over which they change.

    :param first: V at the start [m^2/s^2].
    :param highest: V in between.
    :param last: V at the goal.
    :param rise: length of the soft start [m].
    :param fall: length of the braking [m].
    """

    first: float
    highest: float
    last: float
    rise: float
    fall: float


def ramps(settings, motion, way):
    """
    Find the speeds of a push; near goals get a lower one, for which there is room.

    :param settings: ``PlannerSettings``.
    :param motion: ``InitialMotion``.
    :param way: way of the contact, about [m].
    :return: ``SpeedProfile``.
    """
    highest = settings.pushing_speed ** 2
    last = min(settings.end_speed ** 2, highest) if settings.deceleration > 0.0 else highest
    gain = settings.acceleration
    first = highest if gain == 0.0 else min(settings.end_speed ** 2, highest)
    if motion.speed > 0.0:
        # A push under way may have to speed up even where the first touch is at full speed.
        gain = gain or settings.deceleration
        slower = gain > 0.0 and motion.speed < NEARLY * settings.pushing_speed
        first = motion.speed ** 2 if slower else highest
    rise, fall = (0.5 / rate if rate > 0.0 else 0.0 for rate in (gain, settings.deceleration))
    room = RAMP_SHARE * way
    needed = rise * (highest - first) + fall * (highest - last)
    if needed > room:
        touches = gain == 0.0
        highest = (room + (0.0 if touches else rise * first) + fall * last) / (rise + fall)
        highest = max(highest, last, 0.0 if touches else first)
        first = highest if touches else first
    return SpeedProfile(first, highest, last, rise * (highest - first), fall * (highest - last))


def push_time(settings, way):
    """
    Time of a push from the first touch [s].

    :param settings: ``PlannerSettings``.
    :param way: of the contact [m].
    """
    speeds = ramps(settings, InitialMotion(), way)
    highest = math.sqrt(speeds.highest)
    even = way - speeds.rise - speeds.fall
    return even / highest + sum(
        2.0 * length / (highest + math.sqrt(end))
        for length, end in ((speeds.rise, speeds.first), (speeds.fall, speeds.last)))
