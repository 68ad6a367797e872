"""
Fit of the drive's model to a recording: dead time, lag, accelerations, scales, least speeds.

The residuals are those of the velocities that odometry states, rotation times half of the track.

1. The dead time is searched on a grid with the stated lag and 1.5 times the stated acceleration.
2. Least squares with Huber's loss give dead time, lag, accelerations and scales.
3. The least speeds are profiled on the ramps with all else fixed, before the lag and behind it;
   likewise the step of speeds. The place that fits better is taken, and all else is fitted again.

Intervals: of what is fitted, by the linearized problem; of least speeds, by their profile. Both
count the residuals as fewer than they are, by the correlation of neighbours.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_base.calibration.drive_response import DriveResponse, predict
from push_base.calibration.recording import Purpose, Recording
from push_model.geometry import FloatArray
from push_model.interval import Interval
from push_model.parameters import RoundRobot
from scipy.optimize import least_squares

# Which samples count, shape (n,).
Mask = NDArray[np.bool_]
# Dead times that are searched [s].
DEAD_TIMES = np.arange(0.0, 0.81, 0.04)
SEARCH_ACCELERATION_RATIO = 1.5
# Bounds of dead time [s], lag [s], accelerations [m/s^2, rad/s^2], scales, and the unit of each;
# chosen: beyond any base.
LOWER = np.array([0.0, 2e-3, 0.05, 0.1, 0.2, 0.2])
UPPER = np.array([1.0, 2.0, 20.0, 200.0, 2.0, 2.0])
UNITS = np.array([0.02, 0.02, 0.2, 1.0, 0.02, 0.02])
# Steps of the differences, relative; chosen: a step by which few samples change sides.
DIFFERENCE = 1e-4
# Residual above which Huber's loss is linear [m/s]; chosen: above the noise of odometry.
OUTLIER = 0.03
# Least speeds that are compared, in the units of a wheel [m/s]; those around the best one, in
# units of their distance; and steps of speeds [m/s].
MIN_SPEEDS = np.arange(0.0, 0.3, 0.004)
FINER = 0.1 * np.arange(-20.0, 21.0)
STEPS = np.concatenate([[0.0], np.arange(0.005, 0.0501, 0.0005)])
# Increase of the normalized sum of squares at the ends of an interval of 95 %, and by which a step
# of speeds is better than none; chosen: a grid of a hundred is searched.
CONFIDENCE_INCREASE, STEP_INCREASE = 3.84, 40.0
# Part of the sum of squares that a step has to explain; chosen: more than what the grid leaves.
MIN_STEP_SHARE = 0.1
# Standard deviations of an interval of 95 %.
DEVIATIONS = 1.96
# Least half widths of the intervals of dead time [s], lag [s] and least speeds [m/s]; measured on
# drawn bases: what the periods of commands and odometry leave.
MIN_WIDTHS = 0.01, 0.008, 4e-3
# Relative standard deviation above which an acceleration is not identified, and value that none
# reaches that is.
MAX_DEVIATION = 0.2
# Samples behind that count for the correlation of residuals.
CORRELATED = 20
# Commands and samples that are needed.
MIN_SAMPLES = 50
FITTED = {Purpose.STEP, Purpose.LEVELS, Purpose.TURN, Purpose.LINE, Purpose.SETTLE,
          Purpose.RETURN}


class Signals(NamedTuple):
    """
    A recording as arrays.

    :param sent: times of commands, shape (k,) [s].
    :param commands: shape (k, 3).
    :param segments: numbers of their segments, shape (k,).
    :param purposes: their ``Purpose``, by segment.
    :param times: of odometry, shape (n,) [s].
    :param velocities: measured, shape (n, 3).
    """

    sent: FloatArray
    commands: FloatArray
    segments: FloatArray
    purposes: dict[int, Purpose]
    times: FloatArray
    velocities: FloatArray

    @classmethod
    def of(cls, recording: Recording, *, by_stamp: bool) -> 'Signals':
        """
        Lay a recording out.

        :param by_stamp: whether stamps are times of odometry; else its arrival is.
        """
        commands, odometry = recording.commands, recording.odometry
        times = np.array([item.odometry.time if by_stamp else item.arrival for item in odometry])
        order = np.argsort(times, kind='stable') if len(times) else np.zeros(0, dtype=int)
        twists = np.array([item.odometry.twist for item in odometry]).reshape(-1, 3)
        return cls(np.array([item.time for item in commands]),
                   np.array([item.twist for item in commands]).reshape(-1, 3),
                   np.array([item.segment for item in commands]),
                   {item.segment: item.purpose for item in commands},
                   times[order], twists[order])

    def during(self, purposes: set[Purpose], dead_time: float) -> Mask:
        """
        Mark the samples at which the base follows segments of some purposes.

        :param purposes: set of ``Purpose``.
        :param dead_time: of the base [s].
        :return: shape (n,).
        """
        index = np.searchsorted(self.sent, self.times - dead_time, 'right') - 1
        segments = self.segments[np.maximum(index, 0)]
        segment_indices = [segment for segment, purpose in self.purposes.items()
                           if purpose in purposes]
        return np.isin(segments, segment_indices) & (index >= 0)


class DriveFit(NamedTuple):
    """
    Fit of the drive to a recording.

    :param response: ``DriveResponse`` that fits best.
    :param dead_time: [s].
    :param time_constant: [s].
    :param acceleration: [m/s^2]; None where the base was not asked for more.
    :param yaw_acceleration: [rad/s^2]; likewise.
    :param scales: of wheels, or translation and rotation.
    :param least_speeds: of wheels [m/s], or of translation [m/s] and rotation [rad/s]; None where
        no ramp moved it.
    :param speed_step: [m/s].
    :param residual: standard deviation [m/s].
    """

    response: DriveResponse
    dead_time: Interval
    time_constant: Interval
    acceleration: Interval | None
    yaw_acceleration: Interval | None
    scales: tuple[Interval, Interval]
    least_speeds: tuple[Interval | None, Interval | None]
    speed_step: float
    residual: float


class _Problem:
    """Compares responses with what was measured."""

    def __init__(self, robot: RoundRobot, signals: Signals) -> None:
        self.robot = robot
        self.signals = signals
        self.units: FloatArray = np.array([1.0, 1.0, 0.5 * robot.wheel_track])

    def residuals(self, response: DriveResponse) -> FloatArray:
        """Return differences of velocities, shape (n, 3) [m/s]."""
        signals = self.signals
        predicted = predict(self.robot, response, signals.sent, signals.commands, signals.times)
        return (signals.velocities - predicted) * self.units

    def fit(self, start: DriveResponse, mask: Mask) -> tuple[DriveResponse, FloatArray]:
        """Fit all but least speeds and step; return the covariance, too."""
        def difference(scaled: FloatArray) -> FloatArray:
            response = _with_values(start, scaled * UNITS)
            return np.asarray(self.residuals(response)[mask].ravel(), dtype=np.float64)

        first = np.clip(_values_of(start), LOWER + 1e-6, UPPER - 1e-6)
        solution = least_squares(difference, first / UNITS, bounds=(LOWER / UNITS, UPPER / UNITS),
                                 loss='huber', f_scale=OUTLIER, diff_step=DIFFERENCE, max_nfev=30)
        response = _with_values(start, solution.x * UNITS)
        variance = effective_variance(self.residuals(response)[mask])
        information = solution.jac.T @ solution.jac
        covariance = variance * np.linalg.pinv(information)
        return response, np.outer(UNITS, UNITS) * covariance

    def cost(self, response: DriveResponse, mask: Mask, channel: int) -> float:
        """Return the sum of squares of wheels, or of translation or rotation."""
        residuals = self.residuals(response)[mask]
        if self.robot.drive == 'differential':
            sign = -1.0 if channel == 0 else 1.0
            return float(np.square(residuals[:, 0] + sign * residuals[:, 2]).sum())
        axes = residuals[:, :2] if channel == 0 else residuals[:, 2:]
        return float(np.square(axes).sum())


def fit_drive(robot: RoundRobot, signals: Signals) -> DriveFit | None:
    """
    Fit the model of the drive.

    :return: ``DriveFit``; None where too little was recorded, or nothing moved.
    """
    if len(signals.times) < MIN_SAMPLES or len(signals.sent) < MIN_SAMPLES:
        return None
    if not np.any(signals.commands) or np.abs(signals.velocities).max() < OUTLIER:
        return None
    problem = _Problem(robot, signals)
    response = _search_dead_time(problem)
    response = _find_limits(problem, response)
    steps = signals.during(FITTED, response.dead_time)
    response, _ = problem.fit(response, steps)
    ramps = signals.during({Purpose.RAMP}, response.dead_time)
    if ramps.any():
        response = _locate_least_speeds(problem, response, ramps, steps)
    response, covariance = problem.fit(response, steps | ramps)
    least: tuple[Interval | None, Interval | None] = (None, None)
    if ramps.any():
        response, _ = _profiles(problem, response, ramps)
        response = _find_step(problem, response, ramps)
        response, least = _profiles(problem, response, ramps)
    residual = float(np.sqrt(np.mean(np.square(problem.residuals(response)[steps]))))
    return _result(response, covariance, least, residual)


def effective_variance(residuals: FloatArray) -> float:
    """
    Estimate a variance by which correlated residuals may be counted as independent ones.

    :param residuals: in the order of their times, shape (n, c).
    """
    total = float(np.mean(np.square(residuals)))
    if total == 0.0:
        return 0.0
    ratio = 1.0
    for k in range(1, min(CORRELATED, len(residuals) - 1)):
        ratio += 2.0 * max(0.0, float(np.mean(residuals[k:] * residuals[:-k])) / total)
    return total * ratio


def _values_of(response: DriveResponse) -> FloatArray:
    return np.array([*response[:4], *response.scales])


def _with_values(response: DriveResponse, values: FloatArray) -> DriveResponse:
    fitted = values.tolist()
    return response._replace(dead_time=fitted[0], time_constant=fitted[1],
                             acceleration=fitted[2], yaw_acceleration=fitted[3],
                             scales=(fitted[4], fitted[5]))


def _search_dead_time(problem: _Problem) -> DriveResponse:
    robot = problem.robot
    ratio = SEARCH_ACCELERATION_RATIO
    responses = [DriveResponse(dead_time, max(robot.time_constant, 0.02),
                               ratio * robot.max_acceleration, ratio * robot.max_yaw_acceleration)
                 for dead_time in DEAD_TIMES.tolist()]
    return min(responses, key=lambda response: float(
        np.square(problem.residuals(response)).sum()))


def _find_limits(problem: _Problem, response: DriveResponse) -> DriveResponse:
    """Find speeds that the base does not reach although it reaches lower ones."""
    speed = _plateau(problem, response, Purpose.LINE, 0)
    yaw_rate = _plateau(problem, response, Purpose.TURN, 2)
    return response._replace(max_speed=speed, max_yaw_rate=yaw_rate)


def _plateau(problem: _Problem, response: DriveResponse, purpose: Purpose, axis: int) -> float:
    """Return the speed that a base keeps in fast segments, where that is less than asked for."""
    fast = plateau_ratios(problem.signals, response.dead_time, purpose, axis)
    slow = plateau_ratios(problem.signals, response.dead_time, Purpose.STEP, axis)
    if not fast or not slow:
        return np.inf
    scale = float(np.median([ratio for ratio, _ in slow]))
    ratio = float(np.median([ratio for ratio, _ in fast]))
    asked = float(np.median([abs(command) for _, command in fast]))
    return asked * ratio / scale if 0.0 < ratio < 0.95 * scale else np.inf


def plateau_ratios(signals: Signals, dead_time: float, purpose: Purpose,
                   axis: int) -> list[tuple[float, float]]:
    """
    Compare the end of each segment with its command.

    :param dead_time: of the base [s].
    :param purpose: of the segments.
    :param axis: 0, 1 or 2.
    :return: (measured over commanded velocity, commanded velocity) of each segment.
    """
    ratios: list[tuple[float, float]] = []
    for segment, kind in signals.purposes.items():
        if kind is not purpose:
            continue
        inside = np.flatnonzero(signals.segments == segment)
        command = float(signals.commands[inside[-1], axis])
        start, end = signals.sent[inside[0]], signals.sent[inside[-1]]
        times = signals.times - dead_time
        window = (times > end - 0.25 * (end - start)) & (times <= end)
        if command != 0.0 and window.any():
            measured = float(np.median(signals.velocities[window, axis]))
            ratios.append((measured / command, command))
    return ratios


def _locate_least_speeds(problem: _Problem, response: DriveResponse, ramps: Mask,
                         steps: Mask) -> DriveResponse:
    """Find least speeds before the lag and behind it, and take what fits better."""
    candidates: list[tuple[float, DriveResponse]] = []
    for is_behind_lag in (False, True):
        candidate = response._replace(is_behind_lag=is_behind_lag)
        for _ in range(2):
            least = [_best(problem, candidate, ramps, channel) for channel in (0, 1)]
            candidate = candidate._replace(least_speeds=(least[0], least[1]))
            candidate, _ = problem.fit(candidate, steps | ramps)
        cost = float(np.square(problem.residuals(candidate)[steps | ramps]).sum())
        candidates.append((cost, candidate))
    return min(candidates, key=lambda pair: pair[0])[1]


def _with_least(response: DriveResponse, channel: int, value: float) -> DriveResponse:
    least = list(response.least_speeds)
    least[channel] = value
    return response._replace(least_speeds=(least[0], least[1]))


def _grid(problem: _Problem, channel: int) -> FloatArray:
    """Return least speeds to compare, in the units of the channel."""
    is_rotation = channel == 1 and problem.robot.drive != 'differential'
    unit = float(problem.units[2]) if is_rotation else 1.0
    return np.asarray(MIN_SPEEDS / unit, dtype=np.float64)


def _costs(problem: _Problem, response: DriveResponse, mask: Mask, channel: int,
           make: Callable[[float], DriveResponse], values: FloatArray) -> FloatArray:
    return np.array([problem.cost(make(value), mask, channel) for value in values.tolist()],
                    dtype=np.float64)


def _best(problem: _Problem, response: DriveResponse, mask: Mask, channel: int) -> float:
    values = _grid(problem, channel)
    costs = _costs(problem, response, mask, channel,
                   lambda value: _with_least(response, channel, value), values)
    return float(values[int(costs.argmin())])


def _profiles(
        problem: _Problem, response: DriveResponse,
        mask: Mask) -> tuple[DriveResponse, tuple[Interval | None, Interval | None]]:
    """Put both least speeds in where they fit best; return their intervals, too."""
    intervals = [_profile(problem, response, mask, channel) for channel in (0, 1)]
    for channel, interval in enumerate(intervals):
        if interval is not None:
            response = _with_least(response, channel, interval.value)
    return response, (intervals[0], intervals[1])


def _profile(problem: _Problem, response: DriveResponse, mask: Mask,
             channel: int) -> Interval | None:
    """Return a least speed and its interval, by the profile of the sum of squares."""
    grid = _grid(problem, channel)
    coarse = _best(problem, response, mask, channel)
    if coarse == grid[-1]:
        return None
    unit = float(grid[1])
    values = np.unique(np.maximum(0.0, coarse + unit * FINER))
    costs = _costs(problem, response, mask, channel,
                   lambda value: _with_least(response, channel, value), values)
    # A channel is the sum of two residuals, but for a rotation.
    count = 2.0 if problem.robot.drive == 'differential' or channel == 0 else 1.0
    variance = count * effective_variance(problem.residuals(response)[mask])
    inside = values[costs <= costs.min() + CONFIDENCE_INCREASE * max(variance, 1e-10)]
    low, high = float(inside.min()), float(inside.max())
    best = 0.0 if low == 0.0 else float(values[int(costs.argmin())])
    width = MIN_WIDTHS[2] * unit / MIN_SPEEDS[1]
    return Interval(best, max(0.0, min(low, best - width)), max(high, best + width))


def _find_step(problem: _Problem, response: DriveResponse, mask: Mask) -> DriveResponse:
    """Find the step to which the base rounds speeds."""
    variance = effective_variance(problem.residuals(response)[mask])
    first, second = (_costs(problem, response, mask, channel,
                            lambda value: response._replace(step=value), STEPS)
                     for channel in (0, 1))
    costs = first + second
    best = int(np.argmin(costs))
    is_better = costs[0] - costs[best] > max(STEP_INCREASE * variance,
                                             MIN_STEP_SHARE * costs[0])
    return response._replace(step=float(STEPS[best])) if is_better else response


def _result(response: DriveResponse, covariance: FloatArray,
            least: tuple[Interval | None, Interval | None], residual: float) -> DriveFit:
    values = _values_of(response).tolist()
    deviations = np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()
    minimal = [MIN_WIDTHS[0], MIN_WIDTHS[1], 0.0, 0.0, 1e-3, 1e-3]
    intervals = [_interval(value, max(width, DEVIATIONS * deviation))
                 for value, deviation, width in zip(values, deviations, minimal)]
    accelerations = [interval if deviation < MAX_DEVIATION * value and value < 0.9 * top else None
                     for interval, value, deviation, top in zip(
                         intervals[2:4], values[2:4], deviations[2:4], UPPER[2:4])]
    return DriveFit(response, intervals[0], intervals[1], accelerations[0], accelerations[1],
                    (intervals[4], intervals[5]), least, response.step, residual)


def _interval(value: float, width: float) -> Interval:
    return Interval(value, max(0.0, value - width), value + width)
