"""From a recording to what the base and its sensors are like."""

from collections.abc import Callable
import dataclasses
from typing import TypeVar

from push_base.calibration.drive_fit import DriveFit, fit_drive, Signals
from push_base.calibration.odometry_errors import odometry_errors, OdometryErrors
from push_base.calibration.recording import ReceivedPose, Recording
from push_base.calibration.topics import (
    Noise, pose_noise, rest_end, topic_times, TopicTimes, velocity_noise,
)
from push_base.calibration.touch import evaluate_touches, touch_start, TouchResult

Value = TypeVar('Value')
# Ages of odometry that one clock, or two that agree, can give [s]; chosen.
MIN_AGE, MAX_AGE = -0.005, 1.0


@dataclasses.dataclass(frozen=True)
class BaseCalibration:
    """
    Calibration of a base; None for what was not measured.

    :param recording: ``Recording`` that it is from, before any touch.
    :param signals: the same as arrays.
    :param is_clock_common: whether stamps of odometry and times of commands are of one clock, so
        that delays are measured by stamps; else by arrival.
    :param drive: ``DriveFit``.
    :param errors: ``OdometryErrors``.
    :param velocity_noise: of odometry.
    :param object_noise: of the poses of the object.
    :param robot_noise: of the poses of the robot in the world.
    :param odometry_times: ``TopicTimes``.
    :param object_times: of the poses of the object.
    :param robot_times: of the poses of the robot in the world.
    :param full_recording: ``Recording`` with the touches.
    :param touches: ``TouchResult``.
    :param failures: what could not be computed, and why.
    """

    recording: Recording
    signals: Signals
    is_clock_common: bool
    drive: DriveFit | None
    errors: OdometryErrors | None
    velocity_noise: Noise | None
    object_noise: Noise | None
    robot_noise: Noise | None
    odometry_times: TopicTimes | None
    object_times: TopicTimes | None
    robot_times: TopicTimes | None
    full_recording: Recording
    touches: TouchResult | None = None
    failures: tuple[str, ...] = ()


def estimate(recording: Recording) -> BaseCalibration:
    """
    Find out what a recording says.

    Where one part of it cannot be computed, the others are; ``failures`` names it.

    :param recording: ``Recording``, of any length.
    """
    failures: list[str] = []
    full_recording = recording
    touches = _attempt('touches', failures, lambda: evaluate_touches(recording))
    # At an object, wheels may spin, and the object moves.
    recording = recording.until(touch_start(recording))
    odometry_times = topic_times([item.arrival for item in recording.odometry],
                                 [item.odometry.time for item in recording.odometry])
    is_clock_common = (odometry_times is not None
                       and MIN_AGE <= odometry_times.age <= MAX_AGE)
    signals = Signals.of(recording, by_stamp=is_clock_common)
    end = rest_end(recording)
    drive = _attempt('fit of the drive', failures, lambda: fit_drive(recording.robot, signals))
    errors = _attempt('errors of odometry', failures, lambda: odometry_errors(recording))
    return BaseCalibration(
        recording, signals, is_clock_common, drive, errors, velocity_noise(recording),
        pose_noise(recording.object_poses, end), pose_noise(recording.robot_poses, end),
        odometry_times, _times_of(recording.object_poses), _times_of(recording.robot_poses),
        full_recording, touches, tuple(failures))


def _attempt(name: str, failures: list[str],
             compute: Callable[[], Value | None]) -> Value | None:
    """Compute something, or note why that fails: minutes of driving are not lost for it."""
    try:
        return compute()
    except Exception as error:  # noqa: B902 (named in the report)
        failures.append(f'{name}: {type(error).__name__}: {error}')
        return None


def _times_of(poses: list[ReceivedPose]) -> TopicTimes | None:
    return topic_times([item.arrival for item in poses], [item.measured.time for item in poses])
