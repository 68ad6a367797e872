"""
Finding out how a base follows its commands: dead time, accelerations, least speeds, pulses.

What is sent is followed by models with the nominal lag and no dead time, x_a(t): one accelerates
as stated, one is quicker. The dead time is the shift by which the better of them fits what
odometry measures best,

    (tau, a) = argmin_(d, a)  mean |v(t) - x_a(t - d)|^2

where ``AccelerationSearch`` may find models that accelerate less to be the better ones. And a
wheel, or axis, does not turn yet where in a window v covers far less than x(t - tau) does.
The greatest command in that window is then below its least speed. Pulses that move nothing,
although they are above that, get longer where the acceleration of the base does not allow it to
reach their height, and higher else, and come back once they move it. A least speed
whose pulses move the base comes down with them, until its pulses are so small that a lower one
would gain nothing: what seemed to stand may have been blocked.

All models follow what a base with the believed gains makes of the commands (``speed_gain``), so
that ``GainSearch`` looks for what its gains are over these.

``push_safety.delay_search`` looks for a fault, whatever the base is like: it leaves out constant
differences, as of a wheel of another size, and has one model. Here a difference is an error. A
recording is fitted in ``calibration.drive_fit``, with lag, scales and accelerations unknown, too.
"""

from collections import deque
from collections.abc import Iterator
import itertools
import math
import statistics
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_base.acceleration_search import AccelerationSearch, AS_STATED, SLOW_RATIOS
from push_base.command_shaper import MARGINS, pulse_heights
from push_base.gain_search import GainChange, GainSearch, GainWindow, SHIFTS
from push_base.gain_search import PERIOD as GAIN_PERIOD
from push_base.gain_search import WINDOW as GAIN_WINDOW
from push_base.speed_gain import delivered, gain_matrix
from push_base.velocity_history import VelocityHistory
from push_dynamics.actuation import track_commands
from push_model.base_knowledge import BaseKnowledge, PULSE
from push_model.geometry import FloatArray
from push_model.parabola import vertex_offset
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist

# Grid of the model, and history that is kept [s]; chosen: half a period of odometry, and some
# starts and stops of the base.
STEP = 0.01
HISTORY = 3.0
# Accelerations of the models over the limit, of bases as stated; chosen: they are mostly quicker.
# Behind them are the slow ones.
STATED_RATIOS = 1.0, 1.5
STATED_COUNT = len(STATED_RATIOS)
ACCELERATION_RATIOS = *STATED_RATIOS, *SLOW_RATIOS
# The last one of a list of models, whose response comes first, tells whether a wheel turns.
QUICKER = -1
# Part of the variance that models as stated have to leave to look for slow ones; chosen: what a
# lag that is half as long or twice leaves.
MIN_UNEXPLAINED = 0.02
# Longest dead time that is looked for, step and period of the search [s]; chosen: twice what a
# robot can push with.
MAX_SHIFT = 0.6
SHIFT_STEP = 0.02
PERIOD = 0.1
# Velocity has to vary by so much for a search [m/s], and the best shift to leave at most this part
# of its variance; chosen: noise of odometry explains neither.
MIN_VARIATION = 0.03
MAX_UNEXPLAINED = 0.3
# Number of results of which the median counts, and from which on it does; chosen: half a second.
RESULTS, ENOUGH_RESULTS = 9, 5
# A dead time below this is none, and a change below this is no news [s]; chosen: a value right to
# 0.05 s is as good as an exact one.
MIN_DEAD_TIME = 0.06
MIN_CHANGE = 0.02
# Window in which a wheel is evaluated [s], distance or angle that it is asked for at least
# [m], [rad], part of it that it covers at most where it does not turn, and range where it does.
# Chosen: above the noise of odometry, and below what any good base covers.
WINDOW = 0.4
MIN_DISTANCE, MIN_ANGLE = 0.004, 0.02
STUCK_RATIO = 0.25
# The same of the distance covered to and fro, with noise, and the part of it that the commands
# have in one direction at least: while a wheel reverses its lag tells.
COVERED_RATIO = 0.5
MIN_STRAIGHTNESS = 0.9
MOVING_RATIOS = 0.6, 1.6
# Height times duration of a pulse below which a least speed that is too high costs nothing [m];
# chosen: about the tolerance of goals, which the lag of a drive evens out.
FREE_QUANTUM = 0.012
# Rounding of speeds.
ROUNDING = 1.0 - 1e-6
# Least speeds above these are not believed [m/s], [rad/s]: such a base is blocked, or off. Chosen.
MAX_LEAST_SPEED, MAX_LEAST_YAW_RATE = 0.13, 0.35
# Commands up to this ratio of the height of pulses tell that pulses of that height move the base;
# chosen: faster ones move it whatever its least speed is.
PULSED_RATIO = 1.2
# Pulses that move nothing are at least so high over the least speed; how pulses get longer, at
# most [s], and then higher, and how they come back; time between two changes [s]. Chosen: the base
# is asked a few times at each.
PULSE_RATIO = 1.5
LONGER, HIGHER, MAX_PULSE = 1.3, 1.3, 0.16
SHORTER, LOWER = 0.85, 0.95
CHANGE_PERIOD = 0.5
# Gains within this part of 1 count as 1, as odometry errs by some per cent itself; and the range
# of gains that are believed. Chosen: below, a base is stopped rather than driven.
EQUAL_GAIN = 0.07
GAINS = 0.4, 1.6
# Time of driving from which on gains are looked for although no dead time was found [s]; chosen:
# slow accelerations are known by then.
GAIN_DELAY = 2.0
# A gap of odometry, or of commands, after which nothing is known of the time before [s].
MAX_GAP = 0.5
# Rounding of times [s].
TIME_ROUNDING = 1e-6


class _Window(NamedTuple):
    """
    Commands and motion of a wheel or axis in a window of time.

    :param expected: distance or angle by the commands, at least 0 [m or rad].
    :param measured: the same by odometry, in the same direction.
    :param covered: distance by odometry, to and fro.
    :param top: greatest command [m/s or rad/s].
    :param reverses: whether it is asked to go to and fro.
    """

    expected: float
    measured: float
    covered: float
    top: float
    reverses: bool

    @property
    def is_stuck(self) -> bool:
        """Tell whether it has hardly moved although it should have."""
        return (self.measured < STUCK_RATIO * self.expected
                and self.covered < COVERED_RATIO * self.expected)

    @classmethod
    def of(cls, expected: FloatArray, measured: FloatArray, commands: FloatArray) -> '_Window':
        """
        Sum velocities up, each of shape (n, 1) or (n, 2).

        :param expected: by the commands [m/s or rad/s].
        :param measured: by odometry.
        :param commands: themselves.
        """
        asked, done = WINDOW * expected.mean(axis=0), WINDOW * measured.mean(axis=0)
        distance = float(np.linalg.norm(asked))
        along = float(asked @ done) / distance if distance > 0.0 else 0.0
        asked_distance, covered = (WINDOW * float(np.linalg.norm(values, axis=1).mean())
                                   for values in (expected, measured))
        return cls(distance, along, covered, float(np.linalg.norm(commands, axis=1).max()),
                   distance < MIN_STRAIGHTNESS * asked_distance)


class BaseIdentifier:
    """
    Learns what a base does with its commands.

    ``knowledge``: the ``BaseKnowledge`` so far, at first as stated.
    """

    def __init__(self, robot: RoundRobot) -> None:
        """
        Start with what is stated.

        :param robot: the ``RoundRobot``, nominal.
        """
        self._robot = robot
        self._drives: FloatArray = np.array([
            (robot.time_constant, ratio * robot.max_acceleration,
             ratio * robot.max_yaw_acceleration) for ratio in ACCELERATION_RATIOS])
        half = 0.5 * robot.wheel_track
        # From a twist to what counts: speeds of wheels, or translation and rotation.
        self._is_differential = robot.drive == 'differential'
        self._channels: FloatArray = np.array(
            [[1.0, 0.0, -half], [1.0, 0.0, half]] if self._is_differential
            else [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, half]], dtype=np.float64)
        self._half_track = half
        self._results: deque[float] = deque(maxlen=RESULTS)
        # Of translation and rotation.
        self._accelerations = AccelerationSearch(), AccelerationSearch()
        self._gains = GainSearch(robot, self._channels)
        self._last_change = -math.inf
        # Time for which it was driven [s].
        self._driving_time = 0.0
        # Least speed or yaw rate as measured, without what pulses needed besides.
        self._measured_min_speeds = [robot.min_speed, robot.min_yaw_rate]
        self.knowledge = BaseKnowledge.stated(robot)
        self.forget()

    @property
    def has_dead_time(self) -> bool:
        """Tell whether the dead time was identified."""
        return len(self._results) >= ENOUGH_RESULTS

    def forget(self) -> None:
        """Forget what was sent and measured, as where others command the base."""
        self._command = STOP
        # Of the models, shape (m, 3) [m/s, m/s, rad/s].
        self._velocities: FloatArray = np.zeros((len(ACCELERATION_RATIOS), 3))
        self._start: float | None = None
        # Commands and responses of the models on the grid, and measurements.
        length = round((HISTORY + MAX_SHIFT) / STEP)
        self._responses = VelocityHistory(length, len(ACCELERATION_RATIOS))
        self._commands = VelocityHistory(length)
        self._count = 0
        self._measured: deque[tuple[float, ...]] = deque()
        self._due = self._gains_due = -math.inf
        self._gains.clear()

    def start_from(self, knowledge: BaseKnowledge) -> None:
        """Take what was learned before as known, unless nothing is to be learned."""
        if not self._robot.identify_base:
            return
        translation, rotation = self._accelerations
        translation.start_from(knowledge.max_acceleration / self._robot.max_acceleration)
        rotation.start_from(knowledge.max_yaw_acceleration / self._robot.max_yaw_acceleration)
        self._measured_min_speeds = [knowledge.min_speed, knowledge.min_yaw_rate]
        self.knowledge = self._with_accelerations(knowledge)

    def restore(self, knowledge: BaseKnowledge) -> None:
        """Know no more than before: what has come since was of a base that was stopped."""
        self.knowledge = knowledge
        self._measured_min_speeds = [min(known, measured) for known, measured in zip(
            (knowledge.min_speed, knowledge.min_yaw_rate), self._measured_min_speeds)]

    def add_command(self, command: Twist, time: float) -> None:
        """
        Note a command that was sent.

        :param command: ``Twist``, finite.
        :param time: when, on the clock of odometry [s].
        """
        self._advance(time)
        self._command = delivered(command, self._robot, self.knowledge)

    def observe(self, odometry: Odometry, *, has_changed: bool = False) -> None:
        """
        Compare a measured velocity with the commands before it.

        :param odometry: ``Odometry``, finite; one that comes again with the time of the last is
            ignored, and one from before it starts over.
        :param has_changed: whether the base may just have failed, so that other gains would hide
            that.
        """
        time, measured = odometry.time, self._measured
        if not self._robot.identify_base or measured and time == measured[-1][0]:
            return
        if measured and not 0.0 < time - measured[-1][0] <= MAX_GAP:
            self.forget()
        self._advance(time)
        if self._start is None:
            self._start = time
        self._measured.append((time, *odometry.twist))
        while self._measured[0][0] < time - HISTORY:
            self._measured.popleft()
        if self._count * STEP < WINDOW:
            return
        if time >= self._gains_due and not has_changed:
            self._find_gains(time)
        if time < self._due:
            return
        self._due = time + PERIOD - TIME_ROUNDING
        samples = np.array(self._measured, dtype=np.float64)
        self._find_dead_time(samples)
        if self.has_dead_time:
            self._find_least_speeds(samples[samples[:, 0] > time - WINDOW], time)

    def _advance(self, time: float) -> None:
        """Let the models follow the command until now; forget all where time jumps."""
        if self._start is None:
            return
        if abs(time - self._start - self._count * STEP) > MAX_GAP + STEP:
            self.forget()
            return
        end = time + TIME_ROUNDING
        if self._start + (self._count + 1) * STEP > end:
            return
        commands: FloatArray = np.empty_like(self._velocities)
        commands[:] = self._command
        while self._start + (self._count + 1) * STEP <= end:
            self._commands.append(self._command)
            track_commands(self._velocities, commands, self._drives, STEP)
            self._responses.append(self._velocities)
            self._count += 1

    def _places(self, times: FloatArray) -> NDArray[np.int_]:
        """Tell where in the histories the velocities at some times are."""
        after_start = np.rint((times - (self._start or 0.0)) / STEP).astype(int)
        return after_start - 1 - (self._count - len(self._commands))

    def _find_dead_time(self, samples: FloatArray) -> None:
        velocities = samples[:, 1:] @ self._channels.T
        variance = float(velocities.var(axis=0).sum())
        if variance < MIN_VARIATION ** 2:
            return
        shifts = np.arange(0.0, MAX_SHIFT + 0.5 * SHIFT_STEP, SHIFT_STEP)
        places = self._places(samples[:, 0] - shifts[:, None])
        errors_by_model = [
            ((velocities - response @ self._channels.T) ** 2).sum(axis=2).mean(axis=1)
            for response in self._candidates(places)]
        errors = min(errors_by_model, key=np.min)
        best = int(errors.argmin())
        is_explained = errors[best] <= MIN_UNEXPLAINED * variance
        if not (is_explained and self._is_as_stated) and self._find_accelerations(samples, places):
            return
        if errors[best] > MAX_UNEXPLAINED * variance:
            return
        self._results.append(float(shifts[best])
                             + SHIFT_STEP * vertex_offset(errors.tolist(), best))
        if not self.has_dead_time:
            return
        dead_time = statistics.median(self._results)
        dead_time = dead_time if dead_time >= MIN_DEAD_TIME else 0.0
        if abs(dead_time - self.knowledge.dead_time) >= MIN_CHANGE:
            self.knowledge = self.knowledge._replace(dead_time=dead_time)

    @property
    def _is_as_stated(self) -> bool:
        return all(search.model == AS_STATED for search in self._accelerations)

    def _candidates(self, places: NDArray[np.int_]) -> list[FloatArray]:
        """Look up the responses of the models that the base may have; the quicker one is last."""
        translation, rotation = (search.model for search in self._accelerations)
        if translation == rotation == AS_STATED:
            return [self._responses.at(places, row) for row in range(STATED_COUNT)]
        response = self._responses.at(places, _row(translation))
        response[..., 2] = self._responses.at(places, _row(rotation))[..., 2]
        return [response]

    def _find_accelerations(self, samples: FloatArray, places: NDArray[np.int_]) -> bool:
        """
        Find out whether the base accelerates otherwise than is believed.

        :param samples: of odometry, shape (n, 4).
        :param places: of the responses in the histories, by shift and sample, shape (d, n).
        :return: whether that explains its motion far better.
        """
        measured = samples[:, 1:] * (1.0, 1.0, self._half_track)
        squares = np.stack([
            (measured - self._responses.at(places, row) * (1.0, 1.0, self._half_track)) ** 2
            for row in range(len(ACCELERATION_RATIOS))])
        is_better = False
        for search, channels in zip(self._accelerations, (slice(0, 2), slice(2, 3))):
            errors = squares[..., channels].sum(axis=3).mean(axis=2).min(axis=1)
            errors = np.array([errors[:STATED_COUNT].min(), *errors[STATED_COUNT:]])
            is_better |= search.add(errors, float(measured[:, channels].var(axis=0).sum()))
        known = self._with_accelerations(self.knowledge)
        if known != self.knowledge:
            # The dead times until now were those of another model.
            self._results.clear()
            self.knowledge = known
        return is_better

    def _with_accelerations(self, knowledge: BaseKnowledge) -> BaseKnowledge:
        """State the accelerations of the models that are believed."""
        limits = [math.inf if search.ratio is None else search.ratio * stated
                  for search, stated in zip(self._accelerations, (
                      self._robot.max_acceleration, self._robot.max_yaw_acceleration))]
        return knowledge._replace(max_acceleration=limits[0], max_yaw_acceleration=limits[1])

    def _find_gains(self, time: float) -> None:
        """Find out whether the speeds are another part of what is commanded."""
        self._gains_due = time + GAIN_PERIOD - TIME_ROUNDING
        if self._command != STOP:
            self._driving_time += GAIN_PERIOD
        # A dead time, or slow accelerations, show at the first starts and stops.
        is_known = self.has_dead_time or self._driving_time > GAIN_DELAY
        if not (is_known and self._is_as_stated):
            return
        start = time - GAIN_WINDOW - TIME_ROUNDING
        newest_first = itertools.takewhile(lambda sample: sample[0] >= start,
                                           reversed(self._measured))
        samples = np.array([*newest_first])[::-1]
        if len(samples) <= ENOUGH_RESULTS:
            return
        times = samples[:, 0]
        between = (0.5 * (times[1:] + times[:-1]) - self.knowledge.dead_time
                   - np.array(SHIFTS)[:, None])
        change = self._gains.add(GainWindow(times, samples[:, 1:],
                                            self._commands.at(self._places(between))))
        if change is not None:
            self._change_gains(change, time)

    def _change_gains(self, change: GainChange, time: float) -> None:
        """Believe other gains, and let the past be that of a base with them."""
        known = self.knowledge
        gains = [believed * ratio for believed, ratio in zip(known.gains, change[:2])]
        gains = [1.0 if abs(gain - 1.0) < EQUAL_GAIN else gain for gain in gains]
        if not all(GAINS[0] <= gain <= GAINS[1] for gain in gains):
            return
        first, second = gains
        deviation = 0.0 if first == second == 1.0 else max(gains) * change.deviation
        self.knowledge = known._replace(first_gain=first, second_gain=second,
                                        gain_deviation=deviation)
        matrix = gain_matrix(self._robot, first / known.first_gain, second / known.second_gain)
        self._command = Twist(*(matrix @ self._command).tolist())
        self._velocities = self._velocities @ matrix.T
        for history in (self._commands, self._responses):
            history.transform(matrix)
        self._gains_due = time + GAIN_WINDOW

    def _find_least_speeds(self, samples: FloatArray, time: float) -> None:
        """Find out which wheels or axes do not turn although they should."""
        places = self._places(samples[:, 0] - self.knowledge.dead_time)
        measured = samples[:, 1:] @ self._channels.T
        commands = self._commands.at(places) @ self._channels.T
        models = [response @ self._channels.T for response in self._candidates(places)]

        def windows(channels: slice, unit: float = 1.0) -> Iterator[_Window]:
            return (_Window.of(expected[:, channels] / unit, measured[:, channels] / unit,
                               commands[:, channels] / unit) for expected in reversed(models))

        if self._is_differential:
            # A wheel that only the contact holds, as one about which the robot turns, tells
            # nothing; where neither wheel turns, the robot does not turn about one.
            asked, done = (WINDOW * np.abs(values.mean(axis=0))
                           for values in (models[QUICKER], measured))
            if asked.min() > MIN_DISTANCE or done.max() < STUCK_RATIO * MIN_DISTANCE:
                for wheel in (0, 1):
                    self._evaluate(0, windows(slice(wheel, wheel + 1)), time)
            return
        self._evaluate(0, windows(slice(0, 2)), time)
        self._evaluate(1, windows(slice(2, 3), self._half_track), time)

    def _evaluate(self, axis: int, windows: Iterator['_Window'], time: float) -> None:
        """
        Evaluate one wheel or axis.

        :param axis: 0 for wheels and translation, 1 for rotation.
        :param windows: what it did beside what each model expects, the quicker one first.
        :param time: now [s].
        """
        window = next(windows)
        least, top = self.knowledge[1 + axis], window.top
        smallest, cap = ((MIN_DISTANCE, MAX_LEAST_SPEED),
                         (MIN_ANGLE, MAX_LEAST_YAW_RATE))[axis]
        # A base that only coasts tells nothing of what it does with slow commands.
        if min(window.expected, WINDOW * top) <= smallest or window.reverses:
            return
        pulse_height = pulse_heights(self._robot, self.knowledge)[axis]
        # Long pulses are lower than by that ratio.
        is_pulsed = 0.0 < ROUNDING * min(PULSE_RATIO * least, pulse_height) <= top
        is_stuck = window.is_stuck and all(each.is_stuck for each in windows)
        if is_stuck and not is_pulsed and top <= cap:
            self._measured_min_speeds[axis] = max(self._measured_min_speeds[axis], top)
            self._set(axis, max(least, top))
        elif is_pulsed and time >= self._last_change + CHANGE_PERIOD:
            moved = window.measured / window.expected
            if is_stuck and top <= 2.5 * cap:
                self._last_change = time
                self._escalate(axis, top)
            elif (top <= PULSED_RATIO * pulse_height
                    and MOVING_RATIOS[0] < moved < MOVING_RATIOS[1]):
                self._last_change = time
                self._relax(axis, max(self._floor(axis), LOWER * least))

    def _floor(self, axis: int) -> float:
        """Return below what a least speed that moves the base does not come down."""
        unit = (1.0, self._half_track)[axis]
        return min(self._measured_min_speeds[axis], FREE_QUANTUM / (MARGINS[0] * PULSE * unit))

    def _escalate(self, axis: int, top: float) -> None:
        """
        Make pulses longer where the base cannot reach their height within them, else higher.

        :param top: height of pulses that moved nothing [m/s or rad/s].
        """
        known, acceleration = self.knowledge, self._drives[0, 1 + axis]
        if known.pulse < MAX_PULSE and MARGINS[0] * known[1 + axis] > acceleration * known.pulse:
            self.knowledge = self.knowledge._replace(
                pulse=min(MAX_PULSE, LONGER * known.pulse))
            return
        cap = (MAX_LEAST_SPEED, MAX_LEAST_YAW_RATE)[axis]
        self._measured_min_speeds[axis] = max(self._measured_min_speeds[axis], min(cap, top))
        self._set(axis, min(cap, max(HIGHER * known[1 + axis], top)))

    def _relax(self, axis: int, lower: float) -> None:
        """Make pulses shorter and lower again, as they move the base."""
        self.knowledge = self.knowledge._replace(
            pulse=max(PULSE, SHORTER * self.knowledge.pulse))
        self._set(axis, lower)

    def _set(self, axis: int, least: float) -> None:
        self.knowledge = (self.knowledge._replace(min_speed=least) if axis == 0
                          else self.knowledge._replace(min_yaw_rate=least))


def _row(model: int) -> int:
    """Return the index in ``ACCELERATION_RATIOS`` of a model of ``AccelerationSearch``."""
    return 0 if model == AS_STATED else STATED_COUNT + model - 1
