"""
Velocities that a base has which follows its commands, for every delay and lag that it may have.

After its delay a base follows a command c with first order and limited acceleration, ``v' = (c -
v) / T`` of length a at most, translation as a vector and rotation by itself. Which delay, T and a
it has is not known beforehand; hence there is one model for each of their combinations, side by
side in arrays (`m` models, 3 axes).
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_safety.tolerances import ACCELERATION_RATIOS, LAGS, MAX_RESPONSE_TIME

# Step of the delays of the models [s]; chosen: what is between two is within the tolerance.
DELAY_STEP = 0.05
# Longest step of the models, in which each follows one command [s]; chosen: that of their delays.
MAX_STEP = DELAY_STEP
# Lag and acceleration of the nominal model, which has no delay.
NOMINAL_LAG, NOMINAL_ACCELERATION = LAGS[1], ACCELERATION_RATIOS[2]
# Error in place of none [m/s, rad/s]; chosen: it decays at once.
MIN_ERROR = 1e-9
# Time constant in place of none [s]; chosen: far below any period.
MIN_LAG = 1e-4
# Commands that there is space for at first; chosen: a second of 50 Hz and of object poses.
INITIAL_CAPACITY = 64


@compiled
def choose_commands(commands: Any, delays: Any, times: Any, twists: Any, time: float) -> None:
    """
    Look up the command that every model follows.

    :param commands: of the models, shape (m, 3), is written [m/s, m/s, rad/s].
    :param delays: of the models, shape (m,) [s].
    :param times: of the commands that were sent, in order, shape (k,) [s].
    :param twists: these commands, shape (k, 3).
    :param time: now [s].
    """
    for i in range(len(commands)):
        k = len(times) - 1
        while k > 0 and times[k] > time - delays[i]:
            k -= 1
        for j in range(3):
            commands[i, j] = twists[k, j]


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
        # What remains of an error is shortened alike along both axes of translation.
        size = math.sqrt(error_x * error_x + error_y * error_y)
        translation = min(limits[i, 0] * dt / max(size, MIN_ERROR), decay)
        rotation = min(limits[i, 1] * dt / max(abs(error_omega), MIN_ERROR), decay)
        velocities[i, 0] += translation * error_x
        velocities[i, 1] += translation * error_y
        velocities[i, 2] += rotation * error_omega
        rates[i, 0] = abs(translation * error_x) / dt
        rates[i, 1] = abs(translation * error_y) / dt
        rates[i, 2] = abs(rotation * error_omega) / dt


class _Model(NamedTuple):
    """Delay [s], lag (ratio, margin [s]) and acceleration ratio of a model."""

    delay: float
    lag: tuple[float, float]
    acceleration_ratio: float


class _CommandHistory:
    """Commands that were sent; the first one counts for all before it."""

    def __init__(self, max_age: float) -> None:
        """
        Start with a robot that nobody has commanded.

        :param max_age: time for which commands are needed [s].
        """
        self._max_age = max_age
        self._times: FloatArray = np.empty(INITIAL_CAPACITY)
        self._twists: FloatArray = np.empty((INITIAL_CAPACITY, 3))
        self.restart(STOP)

    def __len__(self) -> int:
        return self._count

    @property
    def times(self) -> FloatArray:
        """Times at which they were sent, shape (k,) [s]."""
        return self._times[:self._count]

    @property
    def twists(self) -> FloatArray:
        """The commands, shape (k, 3)."""
        return self._twists[:self._count]

    def restart(self, twist: Twist) -> None:
        """Forget all commands; the robot has had one velocity until now."""
        self._count, self._newest = 0, -math.inf
        self.append(twist, -math.inf)

    def append(self, twist: Twist, time: float) -> None:
        """Add a command; one before the last counts as sent with it."""
        if self._count == len(self._times):
            self._grow()
        self._newest = max(time, self._newest)
        self._times[self._count], self._twists[self._count] = self._newest, twist
        self._count += 1

    def _grow(self) -> None:
        """Keep the commands that models may follow yet, with as much space again behind them."""
        first = max(0, int(np.searchsorted(self.times, self._newest - self._max_age, 'right')) - 1)
        times, twists = self.times[first:], self.twists[first:]
        self._count = len(times)
        capacity = max(INITIAL_CAPACITY, 2 * self._count)
        self._times, self._twists = np.empty(capacity), np.empty((capacity, 3))
        self._times[:self._count], self._twists[:self._count] = times, twists


class DriveModels:
    """
    Lets all models follow the commands that were sent.

    ``velocities``: of each model, in the robot's axes [m/s, m/s, rad/s], shape (m, 3). ``rates``:
    how fast they changed in the last step, at least 0 [m/s^2, m/s^2, rad/s^2], shape (m, 3).
    ``commands``: which each of them followed in it, shape (m, 3).
    """

    def __init__(self, robot: RoundRobot) -> None:
        """Start with a robot at rest, as stated, that nobody has commanded."""
        delays: list[float] = np.arange(
            0.0, MAX_RESPONSE_TIME + 0.5 * DELAY_STEP, DELAY_STEP, dtype=np.float64).tolist()
        models = [_Model(delay, lag, ratio) for delay in delays for lag in LAGS
                  for ratio in ACCELERATION_RATIOS]
        self._nominal = models.index(_Model(0.0, NOMINAL_LAG, NOMINAL_ACCELERATION))
        self._delays = np.array([model.delay for model in models])
        self._lags = np.array([max(MIN_LAG, ratio * robot.time_constant + margin)
                               for ratio, margin in (model.lag for model in models)])
        limits = robot.max_acceleration, robot.max_yaw_acceleration
        self._limits = np.outer([model.acceleration_ratio for model in models], limits)
        # Commands since the last reset.
        self._sent = _CommandHistory(2.0 * MAX_RESPONSE_TIME)
        self.velocities: FloatArray = np.zeros((len(models), 3))
        self.rates: FloatArray = np.zeros((len(models), 3))
        self.commands: FloatArray = np.zeros((len(models), 3))
        # Changes nothing; but loads machine code before the robot moves.
        self._choose_commands(0.0)
        follow_commands(self.velocities, self.rates, self.commands, self._lags, self._limits, 1.0)

    @property
    def is_commanded(self) -> bool:
        """Tell whether there is any command to follow since the last reset."""
        return len(self._sent) > 1

    @property
    def nominal_velocity(self) -> Twist:
        """Velocity of a drive that follows without a delay, and as stated."""
        return Twist(*self.velocities[self._nominal].tolist())

    @property
    def nominal_error(self) -> list[float]:
        """Difference of the velocity of that drive from its command [m/s, m/s, rad/s]."""
        commands, velocities = self.commands[self._nominal], self.velocities[self._nominal]
        return [a - b for a, b in zip(commands.tolist(), velocities.tolist())]

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command that was sent.

        :param command: ``Twist``, finite.
        :param time: when [s]; one before the last counts as sent with it.
        """
        self._sent.append(command, time)

    def reset(self, measured: Twist) -> None:
        """Restart at a velocity, which somebody has commanded."""
        self._sent.restart(measured)
        self.velocities[:] = measured
        self.rates[:] = 0.0

    def update(self, time: float, dt: float) -> None:
        """
        Let every model follow its commands for a step; commands may change within a long one.

        :param time: end of the step [s].
        :param dt: its duration, above 0 [s].
        """
        count = max(1, math.ceil(dt / MAX_STEP))
        part = dt / count
        for remaining in range(count, 0, -1):
            self._choose_commands(time - remaining * part + 0.5 * part)
            follow_commands(self.velocities, self.rates, self.commands, self._lags, self._limits,
                            part)

    def _choose_commands(self, time: float) -> None:
        sent = self._sent
        choose_commands(self.commands, self._delays, sent.times, sent.twists, time)
