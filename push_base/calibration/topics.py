"""Rate, age and noise of what comes from sensors."""

from collections.abc import Sequence
import math
from typing import NamedTuple

import numpy as np
from push_base.calibration.recording import Purpose, ReceivedPose, Recording
from push_model.geometry import FloatArray, Pose
from push_model.interval import Interval
from scipy.stats import binom

# Messages that a rate needs.
MIN_MESSAGES = 5
# Part of the messages that are not older than the greatest age.
MAX_AGE_PART = 0.99


class TopicTimes(NamedTuple):
    """
    Times at which messages of a topic came.

    :param rate: [Hz], by the median period of their stamps.
    :param age: arrival minus stamp, median [s].
    :param max_age: the same, exceeded by 1 %, with its interval of 95 % [s].
    :param longest_gap: between arrivals [s].
    """

    rate: float
    age: float
    max_age: Interval
    longest_gap: float


class Noise(NamedTuple):
    """
    Standard deviations at rest.

    :param position: of x and y [m], or of velocities [m/s].
    :param heading: [rad], or of yaw rates [rad/s].
    """

    position: float
    heading: float


def topic_times(arrivals: Sequence[float], stamps: Sequence[float]) -> TopicTimes | None:
    """
    Measure rate and age.

    :param arrivals: of messages, in order [s].
    :param stamps: theirs [s].
    :return: ``TopicTimes``; None where too few came.
    """
    if len(arrivals) < MIN_MESSAGES:
        return None
    ages = np.subtract(arrivals, stamps)
    periods = np.diff(np.sort(stamps))
    period = float(np.median(periods[periods > 0.0])) if (periods > 0.0).any() else math.inf
    return TopicTimes(1.0 / period, float(np.median(ages)), _quantile(ages, MAX_AGE_PART),
                      float(np.diff(arrivals).max()))


def _quantile(values: FloatArray, part: float) -> Interval:
    """Return a quantile, with an interval by the ranks that it may have among the values."""
    ranks = binom.ppf((0.025, 0.975), len(values), part).astype(int)
    low, high = np.sort(values)[np.clip((ranks[0] - 1, ranks[1]), 0, len(values) - 1)].tolist()
    value = float(np.quantile(values, part))
    return Interval(value, min(low, value), max(high, value))


def velocity_noise(recording: Recording) -> Noise | None:
    """Measure the noise of the velocities of odometry at rest."""
    end = rest_end(recording)
    twists = np.array([item.odometry.twist for item in recording.odometry
                       if item.arrival <= end]).reshape(-1, 3)
    if len(twists) < MIN_MESSAGES:
        return None
    deviations = twists.std(axis=0, ddof=1)
    return Noise(float(deviations[:2].max()), float(deviations[2]))


def pose_noise(poses: Sequence[ReceivedPose], end: float) -> Noise | None:
    """
    Measure the noise of poses while nothing moves.

    :param poses: ``ReceivedPose`` sequence.
    :param end: until when nothing moves [s].
    """
    rows = pose_rows([item.measured.pose for item in poses if item.arrival <= end])
    if len(rows) < MIN_MESSAGES:
        return None
    # Of differences from the line through them: what creeps is no noise.
    deviations = np.diff(rows, axis=0).std(axis=0, ddof=1) / math.sqrt(2.0)
    return Noise(float(deviations[:2].max()), float(deviations[2]))


def pose_rows(poses: Sequence[Pose]) -> FloatArray:
    """
    Lay poses out with unwrapped headings.

    :param poses: ``Pose`` sequence.
    :return: shape (n, 3).
    """
    rows = np.array(poses, dtype=np.float64).reshape(-1, 3)
    rows[:, 2] = np.unwrap(rows[:, 2])
    return rows


def rest_end(recording: Recording) -> float:
    """Return when the rest at the start ends [s]."""
    moving = [item.time for item in recording.commands
              if item.purpose not in (Purpose.REST, Purpose.SETTLE)]
    return moving[0] if moving else math.inf
