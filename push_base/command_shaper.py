"""
Commands that a base can follow: what it cannot drive slowly, it drives in pulses.

Wheels that turn from a least speed on get 0 or more than that, so that the mean is right. With the
desired speed w, the sent one s, and the least one m, the debt d is the distance still owed
(sigma-delta modulation):

    |w| >= m:   s = w,   d = 0
    else:       d' = w - s;   where |d| reaches m T / 2:  s = m d / |d| for a pulse T;   else s = 0

so that d stays within m T / 2 and a step of the command. This is done for each wheel of a
differential drive, and for translation, as a vector, and rotation of a holonomic base. Speeds that
a base rounds to steps are chosen likewise, with the debt of the rounding.

A pulse lasts whole periods of the command, so it may go too far. No pulse starts against the
desired direction: the base waits until as much is desired.
"""

import math

from push_model.base_knowledge import BaseKnowledge
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_model.wheels import twist_of_wheels, wheel_speeds

# Height of a pulse over the least speed that is known: (most, least). Chosen: a value too high by
# a factor of two costs nothing, one too low by a tenth moves nothing; see docs/robots/any_base.md.
MARGINS = 2.2, 1.1
# Greatest height times duration of a pulse, as far as the least margin allows [m]; chosen: a
# little above the tolerance of goals, as the lag of a drive evens it out.
MAX_QUANTUM = 0.02
# Time between two commands after which what is owed is forgotten [s]; chosen: time-out of bases.
MAX_PERIOD = 0.5
# Rounding of times [s].
TIME_ROUNDING = 1e-6

Vector = tuple[float, float]


class _Channel:
    """One wheel, or translation or rotation: a vector of speeds, and what is owed of it."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Owe nothing."""
        self._debt: Vector = (0.0, 0.0)
        self._desired: Vector = (0.0, 0.0)
        self._sent: Vector = (0.0, 0.0)
        # Speed of the present pulse, or of the pause after it.
        self._pulse: Vector = (0.0, 0.0)
        # Time that the pulse lasts yet [s].
        self._remaining = 0.0

    def shape(self, desired: Vector, dt: float, least: float, pulse: float,
              step: float) -> Vector:
        """
        Choose what to send.

        :param desired: speed (x, y) that is desired from now on.
        :param dt: time for which the last one was sent [s]; after none the choice stays where the
            same is desired.
        :param least: height of a pulse; 0 for none.
        :param pulse: its duration [s].
        :param step: to which the base rounds; 0 for none.
        """
        if dt == 0.0 and desired == self._desired:
            return self._sent
        self._debt = (self._debt[0] + (self._desired[0] - self._sent[0]) * dt,
                      self._debt[1] + (self._desired[1] - self._sent[1]) * dt)
        self._remaining -= dt
        self._desired = desired
        if math.hypot(*desired) >= least:
            self._remaining = 0.0
            self._sent = self._rounded(desired, pulse, step)
            return self._sent
        if self._remaining <= TIME_ROUNDING:
            self._limit_debt(least * (pulse + dt))
            self._pulse = self._next_pulse(least, pulse, dt)
        self._sent = self._pulse
        return self._sent

    def _next_pulse(self, least: float, pulse: float, dt: float) -> Vector:
        """Send a pulse where so much is owed, else nothing."""
        # Where nothing is desired, one that goes too far would call for one back, without end.
        longest = pulse if any(self._desired) else pulse + dt
        owed_x, owed_y = self._owed_forward()
        owed = math.hypot(owed_x, owed_y)
        if owed < 0.5 * least * longest:
            return 0.0, 0.0
        self._remaining = pulse
        return least * owed_x / owed, least * owed_y / owed

    def _limit_debt(self, bound: float) -> None:
        """Owe no more than one pulse goes: more is what never could be sent."""
        owed = math.hypot(*self._debt)
        if owed > bound:
            self._debt = bound / owed * self._debt[0], bound / owed * self._debt[1]

    def note_sent(self, sent: Vector) -> None:
        """Count another speed than was chosen as sent from now on."""
        self._sent = sent

    def _owed_forward(self) -> Vector:
        """Return what is owed, without the part against the desired direction."""
        speed = math.hypot(*self._desired)
        if speed == 0.0:
            return self._debt
        e_x, e_y = self._desired[0] / speed, self._desired[1] / speed
        along = self._debt[0] * e_x + self._debt[1] * e_y
        if along >= 0.0:
            return self._debt
        across = self._debt[1] * e_x - self._debt[0] * e_y
        return -across * e_y, across * e_x

    def _rounded(self, desired: Vector, pulse: float, step: float) -> Vector:
        """Round a speed so that its mean is right."""
        if step == 0.0:
            self._debt = 0.0, 0.0
            return desired
        bound = 0.5 * step * pulse
        owed_x, owed_y = (min(bound, max(-bound, debt)) for debt in self._debt)
        self._debt = owed_x, owed_y
        speed = math.hypot(*desired)
        if speed == 0.0:
            return desired
        along = (owed_x * desired[0] + owed_y * desired[1]) / speed
        ratio = step * round((speed + along / pulse) / step) / speed
        return ratio * desired[0], ratio * desired[1]


class CommandShaper:
    """
    Shapes commands for a base.

    ``knowledge``: ``BaseKnowledge`` by which it does so, from the next command on.
    """

    def __init__(self, robot: RoundRobot) -> None:
        """
        Start with what is stated.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._robot = robot
        self._channels = _Channel(), _Channel()
        self._time = -math.inf
        self.knowledge = BaseKnowledge.stated(robot)

    def shape(self, command: Twist, time: float) -> Twist:
        """
        Choose what to send.

        :param command: ``Twist`` that is desired from now on, finite.
        :param time: now [s].
        :return: ``Twist``; the command itself where the base can follow it.
        """
        dt, self._time = time - self._time, time
        if command == STOP or not 0.0 <= dt <= MAX_PERIOD:
            for channel in self._channels:
                channel.clear()
            dt = 0.0
        if command == STOP or not self._is_needed:
            return command
        if self._robot.drive == 'differential':
            return self._shape_wheels(command, dt)
        return self._shape_axes(command, dt)

    def note_sent(self, sent: Twist) -> None:
        """
        Note what was sent in place of what was chosen last, so that what is owed is true.

        :param sent: ``Twist``, finite.
        """
        first, second = self._channels
        if self._robot.drive == 'differential':
            left, right = wheel_speeds(sent, self._robot.wheel_track)
            first.note_sent((left, 0.0))
            second.note_sent((right, 0.0))
        else:
            first.note_sent((sent.v_x, sent.v_y))
            second.note_sent((sent.omega, 0.0))

    @property
    def _is_needed(self) -> bool:
        known = self.knowledge
        return known.min_speed + known.min_yaw_rate + self._robot.speed_step > 0.0

    def _shape_wheels(self, command: Twist, dt: float) -> Twist:
        known, robot = self.knowledge, self._robot
        least, _ = pulse_heights(robot, known)
        desired = wheel_speeds(command, robot.wheel_track)
        left, right = (
            channel.shape((speed, 0.0), dt, least, known.pulse, robot.speed_step)[0]
            for channel, speed in zip(self._channels, desired))
        # Going to wheels and back would change the last digit.
        if (left, right) == desired:
            return command
        return twist_of_wheels(left, right, robot.wheel_track)

    def _shape_axes(self, command: Twist, dt: float) -> Twist:
        known, robot = self.knowledge, self._robot
        lever = 0.5 * robot.wheel_track
        translation, rotation = self._channels
        least_speed, least_yaw_rate = pulse_heights(robot, known)
        v_x, v_y = translation.shape((command.v_x, command.v_y), dt, least_speed, known.pulse,
                                     robot.speed_step)
        omega, _ = rotation.shape((command.omega, 0.0), dt, least_yaw_rate, known.pulse,
                                  robot.speed_step / lever)
        return Twist(v_x, v_y, omega)


def pulse_heights(robot: RoundRobot, known: BaseKnowledge) -> tuple[float, float]:
    """
    Choose the heights of pulses within the limits of a robot.

    :param robot: the ``RoundRobot``, nominal.
    :param known: ``BaseKnowledge`` of it.
    :return: of a wheel or the translation [m/s], and of the rotation of a holonomic base [rad/s].
    """
    lever = 0.5 * robot.wheel_track
    limit = robot.max_speed
    if robot.drive == 'differential':
        # Wheels that turn against each other do not exceed the yaw rate, either.
        limit = min(limit, lever * robot.max_yaw_rate)
    return (min(limit, pulse_height(known.min_speed, known.pulse, MAX_QUANTUM)),
            min(robot.max_yaw_rate,
                pulse_height(known.min_yaw_rate, known.pulse, MAX_QUANTUM / lever)))


def pulse_height(least: float, pulse: float, quantum: float) -> float:
    """
    Choose the height of pulses.

    :param least: speed from which on the base moves [m/s or rad/s].
    :param pulse: duration of a pulse [s].
    :param quantum: greatest distance or angle that a pulse should go [m or rad].
    """
    most, fewest = MARGINS
    return min(most * least, max(fewest * least, quantum / pulse))
