"""Measurements that cannot be used: not finite, missing, or too old."""

import math

from push_control.settings import ControlSettings
from push_model.events import EventReport, PushEvent
from push_model.observation import Observation
from push_model.signals import Odometry


def measurement_fault(observation: Observation, last_pose_time: float | None,
                      settings: ControlSettings, *, needs_object: bool = True
                      ) -> EventReport | None:
    """
    Tell why the measurements cannot be used.

    :param last_pose_time: time of the last finite object pose [s], or None.
    :param needs_object: whether the object must have been measured at all.
    :return: ``EventReport``, or None where they can.
    """
    odometry, measured = observation.odometry, observation.object_pose
    if not is_finite_odometry(odometry):
        return PushEvent.ODOMETRY_NOT_FINITE.report()
    if observation.refusal is not None:
        return observation.refusal
    if measured is None and not needs_object:
        return _odometry_fault(observation, settings)
    if measured is None:
        return PushEvent.NO_OBJECT_POSE.report()
    if last_pose_time is None or not (measured.pose.is_finite() and math.isfinite(measured.time)):
        return PushEvent.OBJECT_POSE_NOT_FINITE.report()
    age = observation.time - last_pose_time
    if age > settings.pose_timeout:
        if observation.pose_rejection is not None:
            return observation.pose_rejection
        return PushEvent.OBJECT_POSE_STALE.report(age=age, limit=settings.pose_timeout)
    return _odometry_fault(observation, settings)


def _odometry_fault(observation: Observation, settings: ControlSettings) -> EventReport | None:
    age = observation.time - observation.odometry.time
    if age > settings.odometry_timeout:
        return PushEvent.ODOMETRY_STALE.report(age=age, limit=settings.odometry_timeout)
    return None


def is_finite_odometry(odometry: Odometry) -> bool:
    """
    Tell whether all values of an odometry are finite.

    :return: whether it is.
    """
    v_x, v_y, omega = odometry.twist
    # Written out, as it is asked at every control step.
    return (math.isfinite(odometry.time) and odometry.pose.is_finite() and math.isfinite(v_x)
            and math.isfinite(v_y) and math.isfinite(omega))
