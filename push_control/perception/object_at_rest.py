"""The object at rest: average of its poses, their noise, and whether it has moved."""

from __future__ import annotations

from collections import deque
import math
from typing import Collection, NamedTuple

import numpy as np
from push_control.events import PerceptionEvent
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.events import Report
from push_model.geometry import distance, Pose, wrap_angle
from push_model.signals import ObjectPose, PoseCovariance

# Poses of which noise is estimated, and its ratio to what is stated above which it is greater;
# chosen: a second or two of poses, and more than an estimate from these errs by.
NOISE_POSES = 30
NOISY_RATIO = 1.6
# Shift from the first to the last of them, over that noise, by which the object moves steadily;
# chosen: noise alone shifts them by 1.4 of it, in the root mean square.
MOVING_SIGMAS = 10.0
# Part of these that may be outliers, while the object is at rest by the others; chosen: a tracker
# errs less often by chance, and noise of which too little is stated gives two in three.
MAX_OUTLIER_RATIO = 1.0 / 3.0
# Poses from which on it is told whether successive errors are correlated, and by how many standard
# deviations these differ less from one to the next than independent ones; chosen: none of ten
# thousand averages of independent errors.
MIN_CORRELATED, CORRELATED_SIGMAS = 20, 4.0
# Poses from which on it is told whether their stated errors differ from pose to pose, and the part
# of their variance below which these mostly do not; chosen. Fewer poses must vary still less, as
# independent errors of a heading do in one average of twenty (standard deviations of a normal).
MIN_COMMON, COMMON_RATIO, COMMON_SIGMAS = 6, 0.3, 1.645
# Motion of an object at rest that shows a push too short to be seen at once, in standard errors;
# chosen.
PUSHED_SIGMAS = 3.0
# Least cosine of the angle by which the point that a robot pushes moves beside its direction;
# measured: 0.90 in 199 pushes with all objects, up to 0.40 in taps with poses that are mirrored.
MIN_FORWARD = math.cos(math.radians(45.0))


class ObjectAtRest(NamedTuple):
    """
    An object at rest.

    :param pose: average of the measured poses.
    :param duration: time for which it has been at rest by these and those before them [s].
    :param position_error: standard error of the position along each axis [m].
    :param heading_error: standard error of the heading [rad].
    :param is_biased: whether these are mostly errors that further poses from the same side do not
        reduce.
    :param is_in_map: whether these are mostly errors of the robot's place in a map, which
        further poses do not reduce.
    :param common_position_error: standard deviation of errors along each axis that all poses have
        alike, as those of a camera that is mounted amiss [m].
    :param common_heading_error: the same of the heading [rad].
    """

    pose: Pose
    duration: float
    position_error: float
    heading_error: float
    is_biased: bool = False
    is_in_map: bool = False
    common_position_error: float = 0.0
    common_heading_error: float = 0.0

    @property
    def has_common_errors(self) -> bool:
        """Tell whether further poses reduce only a part of the errors."""
        return self.common_position_error > 0.0 or self.common_heading_error > 0.0


class _Sample(NamedTuple):
    """
    A measured pose in a window, or the sum of all of them.

    :param time: [s].
    :param x: [m].
    :param y: [m].
    :param rotation: since the first pose [rad].
    :param position_variance: of its error along each axis [m^2].
    :param heading_variance: of its error [rad^2].
    """

    time: float
    x: float
    y: float
    rotation: float
    position_variance: float
    heading_variance: float


class StationarityWindow:
    """Averages measured poses while the object is at rest; starts over when it has moved."""

    def __init__(self, control: ControlSettings, supervision: SupervisionSettings) -> None:
        """
        Start without measurements.

        :param control: ``ControlSettings``, for the noise of the poses.
        """
        self._control = control
        self._supervision = supervision
        self._latest: deque[ObjectPose] = deque(maxlen=NOISE_POSES)
        self._are_outliers: deque[bool] = deque(maxlen=NOISE_POSES)
        self.clear()

    def clear(self) -> None:
        """Forget the average; the poses that show how noisy they are stay."""
        self._samples: deque[_Sample] = deque()
        self._sum = _Sample(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self._at_rest_since = 0.0
        # Standard errors of position and heading over those of independent errors.
        self._growth = 1.0, 1.0
        # Headings are averaged relative to the first, clear of the seam of angles.
        self._first_heading = 0.0
        self._average: ObjectAtRest | None = None

    def add(self, measured: ObjectPose, is_outlier: bool = False) -> None:
        """
        Add a measurement to the average.

        :param measured: ``ObjectPose``, finite; one that is not newer than the last is ignored.
        :param is_outlier: whether nothing explains it; such a pose counts only if many do not.
        """
        if self._samples and measured.time <= self._samples[-1].time:
            return
        if is_outlier and self._latest and measured.time <= self._latest[-1].time:
            return
        self._latest.append(measured)
        self._are_outliers.append(is_outlier)
        if is_outlier and sum(self._are_outliers) <= MAX_OUTLIER_RATIO * len(self._latest):
            return
        noise = self._control.assumed_covariance(measured)
        position_std, heading_std = noise.position_deviation, noise.heading_deviation
        gate, pose = self._supervision.motion_gate_sigmas, measured.pose
        before = None if self._average is None else self._average.pose
        if (before is not None and (
                distance(pose, before) > gate * position_std
                or abs(wrap_angle(pose.theta - before.theta)) > gate * heading_std)):
            self.clear()
        if not self._samples:
            self._first_heading, self._at_rest_since = pose.theta, measured.time
        self._append(_Sample(measured.time, pose.x, pose.y,
                             wrap_angle(pose.theta - self._first_heading),
                             position_std ** 2, heading_std ** 2))
        self._average = self._averaged()

    @property
    def repeats_pose(self) -> bool:
        """Tell whether the last poses are one, to the last digit."""
        return (len(self._latest) == NOISE_POSES
                and len({measured.pose for measured in self._latest}) == 1)

    @property
    def object_at_rest(self) -> ObjectAtRest | None:
        """The ``ObjectAtRest``; None before the first measurement."""
        return self._average

    def motion_report(self) -> Report[PerceptionEvent]:
        """Report why the object does not come to rest."""
        poses = [measured.pose for measured in self._latest]
        steps = np.array([(b.x - a.x, b.y - a.y, wrap_angle(b.theta - a.theta))
                          for a, b in zip(poses, poses[1:])])
        if len(steps) < 2:
            return PerceptionEvent.NO_POSES_COME.report()
        # Of independent errors, by which three successive ones differ from a straight line.
        noise = np.sqrt((np.diff(steps, axis=0) ** 2).mean(axis=0) / 6.0)
        position, heading = float(noise[:2].max()), float(noise[2])
        shift = np.abs(steps.sum(axis=0))
        duration = self._latest[-1].time - self._latest[0].time
        if (shift > MOVING_SIGMAS * noise).any() and len(poses) == NOISE_POSES:
            return PerceptionEvent.OBJECT_MOVES.report(
                speed=math.hypot(shift[0], shift[1]) / duration,
                yaw_rate=math.degrees(shift[2]) / duration)
        stated = self._control.assumed_covariance(self._latest[-1])
        values = {'position': 1e3 * position, 'heading': math.degrees(heading)}
        if max(position / stated.position_deviation,
               heading / stated.heading_deviation) < NOISY_RATIO:
            return PerceptionEvent.OBJECT_POSES_DIFFER.report(**values)
        return PerceptionEvent.OBJECT_POSES_NOISIER_THAN_STATED.report(
            **values, stated_position=1e3 * stated.position_deviation,
            stated_heading=math.degrees(stated.heading_deviation))

    def _append(self, sample: _Sample) -> None:
        """Add a sample to the window and its sum, and drop those that are not needed."""
        samples, settings = self._samples, self._supervision
        samples.append(sample)
        total = _Sample(*(a + b for a, b in zip(self._sum, sample)))
        while sample.time - samples[0].time > settings.max_averaging_time:
            without_oldest = _Sample(*(a - b for a, b in zip(total, samples[0])))
            if (sample.time - samples[0].time <= settings.averaging_time_limit
                    and not settings.is_precise(
                        *self._errors(without_oldest, len(samples) - 1))):
                break
            samples.popleft()
            total = without_oldest
        self._sum = total
        self._growth = _correlation_growth(samples)

    def _averaged(self) -> ObjectAtRest:
        count, total = len(self._samples), self._sum
        return ObjectAtRest(
            Pose(total.x / count, total.y / count,
                 wrap_angle(self._first_heading + total.rotation / count)),
            self._samples[-1].time - self._at_rest_since, *self._errors(total, count))._replace(
                **self._common_errors())

    def _common_errors(self) -> dict[str, float]:
        """Return the errors that poses which state their covariance have alike, by field."""
        if self._latest[-1].covariance is None:
            return {}
        position, heading = _common_errors(self._samples)
        return {'common_position_error': position, 'common_heading_error': heading}

    def _errors(self, total: _Sample, count: int) -> tuple[float, float]:
        """Compute the standard errors of position [m] and heading [rad] of an average."""
        position_growth, heading_growth = self._growth
        return (position_growth * math.sqrt(total.position_variance) / count,
                heading_growth * math.sqrt(total.heading_variance) / count)


def _correlation_growth(samples: Collection[_Sample]) -> tuple[float, float]:
    """
    Estimate by how much correlated errors increase the error of their average.

    By the ratio of von Neumann, of the mean squares of steps and of deviations, which is 2 (1 - r)
    where errors are correlated by r from one to the next; the variance of their average is greater
    by (1 + r) / (1 - r).

    :param samples: poses of the object at rest.
    :return: ratios for position and heading, 1 where no correlation shows.
    """
    count = len(samples)
    if count < MIN_CORRELATED:
        return 1.0, 1.0
    values = np.array(samples)
    poses, stated = values[:, 1:4], values[:, [4, 4, 5]].mean(axis=0)
    deviations = poses.var(axis=0)
    steps = (np.diff(poses, axis=0) ** 2).mean(axis=0)
    are_correlated = steps < (2.0 - CORRELATED_SIGMAS * 2.0 / math.sqrt(count)) * deviations
    variances = np.zeros_like(stated)
    np.divide(deviations * (4.0 * deviations - steps), steps, out=variances,
              where=are_correlated & (steps > 0.0))
    # An average is no worse than one of its poses.
    x, y, heading = np.sqrt(np.clip(variances / stated, 1.0, count)).tolist()
    return max(x, y), heading


def _common_errors(samples: Collection[_Sample]) -> tuple[float, float]:
    """
    Estimate the standard deviations of errors that all poses have alike, [m] and [rad].

    Errors that differ from pose to pose by less than is stated are mostly the same in each.

    The mean of n - 1 squared steps of independent errors, over its expectation, has the variance
    v = (3 n - 4) / (n - 1)^2. With that of a chi square its cube root is about normal, around
    1 - v / 9 with the variance v / 9 (Wilson and Hilferty 1931).
    """
    values = np.array(samples)
    position_variance, heading_variance = values[:, 4:6].mean(axis=0).tolist()
    if len(samples) < MIN_COMMON:
        return math.sqrt(position_variance), math.sqrt(heading_variance)
    count = len(samples)
    variance = (3.0 * count - 4.0) / (count - 1.0) ** 2 / 9.0
    ratio = min(COMMON_RATIO, (1.0 - variance - COMMON_SIGMAS * math.sqrt(variance)) ** 3)
    # Steps have twice the variance of independent errors.
    x, y, heading = (0.5 * (np.diff(values[:, 1:4], axis=0) ** 2).mean(axis=0)).tolist()
    return (_common_error(position_variance, 0.5 * (x + y), ratio),
            _common_error(heading_variance, heading, ratio))


def _common_error(stated: float, independent: float, ratio: float) -> float:
    """Return what a stated variance holds beyond a much less independent one, as deviation."""
    return math.sqrt(stated - independent) if independent < ratio * stated else 0.0


def has_moved(before: Pose, pose: Pose, settings: SupervisionSettings,
              noise: PoseCovariance | None = None) -> bool:
    """
    Tell whether an object has moved too far for its plan.

    :param before: ``Pose`` that it had.
    :param pose: ``Pose`` that it has.
    :param noise: ``PoseCovariance`` of the pose that it has, where that is a single measured one.
    """
    max_distance, max_angle = settings.moved_distance, settings.moved_angle
    if noise is not None:
        gate = settings.motion_gate_sigmas
        max_distance = max(max_distance, gate * noise.position_deviation)
        max_angle = max(max_angle, gate * noise.heading_deviation)
    return (distance(pose, before) > max_distance
            or abs(wrap_angle(pose.theta - before.theta)) > max_angle)


class TapMotion(NamedTuple):
    """
    Motion of the point that was tapped, beside the direction of the robot's motion.

    :param lateral_excess: distance by which it has moved further to the side than forward [m].
    :param std: standard deviation of that [m].
    """

    lateral_excess: float
    std: float


class Tap(NamedTuple):
    """
    A push too short to tell at once how it has moved the object, or several in a row.

    :param before: the ``ObjectAtRest`` before it.
    :param pushed: length of the robot's path in contact [m].
    :param driven: displacement of the robot from the touch to the stop, in the world [m].
    :param point: the point that it pushes, in the world [m].
    :param point_std: standard deviation of that [m].
    :param if_missed: what is known of the robot if it has met nothing; None where the object was
        seen to move.
    """

    before: ObjectAtRest
    pushed: float
    driven: tuple[float, float]
    point: tuple[float, float]
    point_std: float
    if_missed: RobotMemory | None

    def after(self, previous: Tap | None) -> Tap:
        """
        Add the tap before it, of which the noise of the poses has hidden the effect.

        :param previous: that tap, or None.
        """
        if previous is None:
            return self
        (x, y), (previous_x, previous_y) = self.driven, previous.driven
        return self._replace(before=previous.before, pushed=self.pushed + previous.pushed,
                             driven=(x + previous_x, y + previous_y))

    def has_moved_object(self, after: ObjectAtRest) -> bool:
        """
        Check whether the averages show that the object was moved.

        :param after: the ``ObjectAtRest`` after the push.
        """
        if self.if_missed is None:
            return True
        before = self.before
        rotation = abs(wrap_angle(after.pose.theta - before.pose.theta))
        return (distance(after.pose, before.pose) > PUSHED_SIGMAS * after.position_error
                or rotation > PUSHED_SIGMAS * after.heading_error)

    def is_too_short(self, after: ObjectAtRest, object_size: float) -> bool:
        """
        Check whether noise hides what the push may have moved.

        :param after: the ``ObjectAtRest`` after the push.
        :param object_size: of the object [m].
        """
        before, lever_arm = self.before, 0.5 * object_size
        hidden = PUSHED_SIGMAS * (
            math.hypot(after.position_error, before.position_error)
            + lever_arm * math.hypot(after.heading_error, before.heading_error))
        # Taps from opposite sides leave the object where it was.
        return min(self.pushed, math.hypot(*self.driven)) <= hidden

    def motion(self, after: ObjectAtRest) -> TapMotion:
        """
        Compare the motion of the point that was pushed with that of the robot.

        A robot that pushes takes this point along, however the object turns; its origin may move
        in another direction.

        :param after: the ``ObjectAtRest`` after the push, which has to have driven.
        """
        before = self.before
        was_at = before.pose.transform(after.pose.inverse().transform(self.point))
        x, y = self.point[0] - was_at[0], self.point[1] - was_at[1]
        rotation = wrap_angle(after.pose.theta - before.pose.theta)
        variance = (before.position_error ** 2 + after.position_error ** 2
                    + (rotation * self.point_std) ** 2
                    + distance(self.point, after.pose) ** 2
                    * (before.heading_error ** 2 + after.heading_error ** 2))
        forward = (x * self.driven[0] + y * self.driven[1]) / math.hypot(*self.driven)
        # Noise alone adds as much to the mean square along each axis.
        moved = math.sqrt(max(0.0, x * x + y * y - 2.0 * variance))
        return TapMotion(MIN_FORWARD * moved - forward, math.sqrt(variance))
