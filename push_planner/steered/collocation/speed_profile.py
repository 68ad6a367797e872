"""
Speed profile of a push: squared speed V = v^2 over the path length s of the contact, and its time.

Under a constant acceleration a, V is linear in s: ``dV/ds = 2 a``. V rises from the start, is
constant in between, and falls before the goal.
"""

import math
from typing import NamedTuple

from push_planner.problem import InitialMotion
from push_planner.settings import PlannerSettings

# Largest fraction of a push on which it may speed up and brake; near goals get a lower speed
# instead. Chosen: half of the path is left at constant speed, where the pushing angle is free.
MAX_RAMP_FRACTION = 0.5
# Ratio below which a push under way counts as slower than the pushing speed. Chosen: a smaller
# difference is within the noise of odometry and not worth a ramp.
NEARLY_AT_SPEED = 0.98


class SpeedProfile(NamedTuple):
    """
    Squared speeds, and the lengths over which they change.

    :param v_squared_start: V at the start [m^2/s^2].
    :param v_squared_max: V in between [m^2/s^2].
    :param v_squared_end: V at the goal [m^2/s^2].
    :param rise_length: length of the acceleration [m].
    :param fall_length: length of the deceleration [m].
    """

    v_squared_start: float
    v_squared_max: float
    v_squared_end: float
    rise_length: float
    fall_length: float

    @property
    def rise_slope(self) -> float:
        """Slope dV/ds of the acceleration; 0 without one [m/s^2]."""
        if self.rise_length == 0.0:
            return 0.0
        return (self.v_squared_max - self.v_squared_start) / self.rise_length

    @property
    def fall_slope(self) -> float:
        """Slope dV/ds of the deceleration; 0 without one [m/s^2]."""
        if self.fall_length == 0.0:
            return 0.0
        return (self.v_squared_end - self.v_squared_max) / self.fall_length


def speed_profile(settings: PlannerSettings, motion: InitialMotion,
                  path_length: float) -> SpeedProfile:
    """
    Find the speeds of a push; near goals get a lower one, for which the path is long enough.

    :param path_length: approximate path length of the contact [m].
    """
    top = settings.pushing_speed ** 2
    end = min(settings.end_speed ** 2, top) if settings.deceleration > 0.0 else top
    acceleration = settings.acceleration
    start = top if acceleration == 0.0 else min(settings.end_speed ** 2, top)
    if motion.speed > 0.0:
        # A push under way may have to speed up even where the first touch is at full speed.
        acceleration = acceleration or settings.deceleration
        is_slower = (acceleration > 0.0
                     and motion.speed < NEARLY_AT_SPEED * settings.pushing_speed)
        start = motion.speed ** 2 if is_slower else top
    # Lengths per change of V: 1 / (2 a).
    rise = 0.5 / acceleration if acceleration > 0.0 else 0.0
    fall = 0.5 / settings.deceleration if settings.deceleration > 0.0 else 0.0
    available = MAX_RAMP_FRACTION * path_length
    if rise * (top - start) + fall * (top - end) > available:
        if acceleration == 0.0:
            top = (available + fall * end) / (rise + fall)
            top = max(top, end, 0.0)
            start = top
        else:
            top = (available + rise * start + fall * end) / (rise + fall)
            top = max(top, end, start)
    return SpeedProfile(start, top, end, rise * (top - start), fall * (top - end))


def push_time(settings: PlannerSettings, path_length: float) -> float:
    """
    Time of a push from the first touch [s].

    :param path_length: of the contact [m].
    """
    profile = speed_profile(settings, InitialMotion(), path_length)
    speed = math.sqrt(profile.v_squared_max)
    constant = path_length - profile.rise_length - profile.fall_length
    ramps = ((profile.rise_length, profile.v_squared_start),
             (profile.fall_length, profile.v_squared_end))
    return constant / speed + sum(2.0 * length / (speed + math.sqrt(v_squared))
                                  for length, v_squared in ramps)
