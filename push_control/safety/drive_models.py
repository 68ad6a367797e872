"""
Velocities that a base has which follows its commands, for every delay and lag that it may have.

After its delay a base follows a command c with first order and limited acceleration, ``v' = (c -
v) / T`` of length a at most, translation as a vector and rotation by itself. Which delay, T and a
it has is not known beforehand; hence there is one model for each of their combinations, side by
side in arrays (`m` models, 3 axes).
"""

import bisect
import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist

# Delays with which a drive may begin to follow, odometry included: the longest, and their step
# [s]; chosen: latencies of bases that are driven over a network are 0.05 to 0.2 s.
RESPONSE_TIME = 0.3
DELAY_STEP = 0.05
# How a drive may follow then: (ratio, margin [s]) of its lag over the nominal one, and
# acceleration over its limit; chosen: loaded bases are slower than stated, empty ones quicker.
LAGS = ((0.3, 0.0), (1.0, 0.0), (2.0, 0.05))
ACCELERATION_RATIOS = (0.5, 1.0, 2.0)
# Lag and acceleration of the nominal model, which has no delay.
NOMINAL_LAG, NOMINAL_ACCELERATION = LAGS[1], ACCELERATION_RATIOS[1]
# Error in place of none [m/s, rad/s]; chosen: it decays at once.
LEAST_ERROR = 1e-9
# Time constant in place of none [s]; chosen: far below any period.
LEAST_LAG = 1e-4


@compiled
def follow_commands(velocities: Any, rates: Any, commands: Any, lags: Any, limits: Any,
                    dt: float) -> None:
    """
    Let every model follow its command for a step.

    :param velocities: of the models, shape (m, 3), is written [m/s, m/s, rad/s].
    :param rates: how fast they changed, shape (m, 3), is written [m/s^2, m/s^2, rad/s^2].
    :param commands: shape (m, 3).
    :param lags: time constants, shape (m,) [s].
    :param limits: of the accelerations of translation and rotation, shape (m, 2).
    :param dt: duration, above 0 [s].
    """
    for i in range(len(velocities)):
        error_x = commands[i, 0] - velocities[i, 0]
        error_y = commands[i, 1] - velocities[i, 1]
        error_omega = commands[i, 2] - velocities[i, 2]
        decay = -math.expm1(-dt / lags[i])
        # What is left of an error is shortened alike along both axes of translation.
        size = math.sqrt(error_x * error_x + error_y * error_y)
        translation = min(limits[i, 0] * dt / max(size, LEAST_ERROR), decay)
        rotation = min(limits[i, 1] * dt / max(abs(error_omega), LEAST_ERROR), decay)
        velocities[i, 0] += translation * error_x
        velocities[i, 1] += translation * error_y
        velocities[i, 2] += rotation * error_omega
        rates[i, 0] = abs(translation * error_x) / dt
        rates[i, 1] = abs(translation * error_y) / dt
        rates[i, 2] = abs(rotation * error_omega) / dt


class _Model(NamedTuple):
    """Delay [s], lag (ratio, margin [s]) and acceleration ratio of a model."""

    delay_index: int
    lag: tuple[float, float]
    acceleration_ratio: float


class DriveModels:
    """
    Lets all models follow the commands that were sent.

    ``velocities``: of each model, in the robot's axes [m/s, m/s, rad/s], shape (m, 3). ``rates``:
    how fast they changed in the last step, at least 0 [m/s^2, m/s^2, rad/s^2], shape (m, 3).
    ``commands``: which each of them followed in it, shape (m, 3).
    """

    def __init__(self, robot: RoundRobot) -> None:
        """
        Begin with a robot at rest that nobody has commanded.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._delays: list[float] = np.arange(
            0.0, RESPONSE_TIME + 0.5 * DELAY_STEP, DELAY_STEP, dtype=np.float64).tolist()
        models = [_Model(i, lag, ratio) for i in range(len(self._delays)) for lag in LAGS
                  for ratio in ACCELERATION_RATIOS]
        self._nominal = models.index(_Model(0, NOMINAL_LAG, NOMINAL_ACCELERATION))
        self._delay_indices = [model.delay_index for model in models]
        self._lags = np.array([max(LEAST_LAG, ratio * robot.time_constant + margin)
                               for ratio, margin in (model.lag for model in models)])
        limits = robot.max_acceleration, robot.max_yaw_acceleration
        self._limits = np.outer([model.acceleration_ratio for model in models], limits)
        # Commands since the last reset; the first stands for all before it.
        self._times = [-math.inf]
        self._twists = [STOP]
        self.velocities: FloatArray = np.zeros((len(models), 3))
        self.rates: FloatArray = np.zeros((len(models), 3))
        self.commands: FloatArray = np.zeros((len(models), 3))
        # Changes nothing; but loads machine code before the robot moves.
        follow_commands(self.velocities, self.rates, self.commands, self._lags, self._limits, 1.0)

    @property
    def is_commanded(self) -> bool:
        """Whether there is any command to follow since the last reset."""
        return len(self._times) > 1

    @property
    def nominal_velocity(self) -> Twist:
        """Velocity of a drive that follows without a delay, and as stated."""
        return Twist(*self.velocities[self._nominal].tolist())

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command that was sent.

        :param command: ``Twist``, finite.
        :param time: when [s]; one before the last counts as sent with it.
        """
        time = max(time, self._times[-1])
        self._times.append(time)
        self._twists.append(command)
        # Of those that no model follows any more, the last one is what they followed.
        first = bisect.bisect_right(self._times, time - 2.0 * RESPONSE_TIME) - 1
        if first > 0:
            del self._times[:first], self._twists[:first]

    def reset(self, measured: Twist) -> None:
        """
        Begin at a velocity, which somebody has commanded.

        :param measured: ``Twist``.
        """
        self._times, self._twists = [-math.inf], [measured]
        self.velocities[:] = measured
        self.rates[:] = 0.0

    def update(self, time: float, dt: float) -> None:
        """
        Let every model follow its command for a step.

        :param time: end of the step [s].
        :param dt: its duration, above 0 [s].
        """
        start, last = time - dt, len(self._times) - 1
        found = [max(0, min(last, bisect.bisect_right(self._times, start - delay + 0.5 * dt) - 1))
                 for delay in self._delays]
        recent = np.array([self._twists[i] for i in found], dtype=np.float64)
        self.commands = recent[self._delay_indices]
        follow_commands(self.velocities, self.rates, self.commands, self._lags, self._limits, dt)
