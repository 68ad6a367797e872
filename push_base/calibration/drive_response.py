"""
Velocities that a base should have after the commands that were sent to it.

A command passes dead time, least speed and step of the wheels, their scale, and the lag with its
acceleration limits, which is that of ``push_dynamics.actuation``. A least speed may also be
behind the lag, where slower wheels rest.
"""

from typing import Any, NamedTuple

import numpy as np
from push_dynamics.actuation import track_command
from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray
from push_model.parameters import RoundRobot


class DriveResponse(NamedTuple):
    """
    Response of a base to its commands.

    :param dead_time: [s].
    :param time_constant: lag [s].
    :param acceleration: greatest [m/s^2].
    :param yaw_acceleration: greatest [rad/s^2].
    :param scales: measured over commanded speed: of (left, right) wheel, or of (translation,
        rotation).
    :param least_speeds: least speed of (left, right) wheel [m/s], or of translation [m/s] and
        rotation [rad/s].
    :param is_behind_lag: whether the least speeds are those of the wheels behind the lag.
    :param step: of speeds [m/s].
    :param max_speed: speed to which the base limits commands [m/s].
    :param max_yaw_rate: the same of the rotation [rad/s].
    """

    dead_time: float
    time_constant: float
    acceleration: float
    yaw_acceleration: float
    scales: tuple[float, float] = (1.0, 1.0)
    least_speeds: tuple[float, float] = (0.0, 0.0)
    is_behind_lag: bool = False
    step: float = 0.0
    max_speed: float = np.inf
    max_yaw_rate: float = np.inf


@compiled
def follow(start_times: Any, commands: Any, drive: Any, times: Any, velocities: Any) -> None:
    """
    Follow commands with lag and limited acceleration, from rest.

    :param start_times: from which each command acts, in order, shape (k,) [s].
    :param commands: shape (k, 3) [m/s, m/s, rad/s].
    :param drive: numbers in the order of ``layout``.
    :param times: at which the velocity is asked for, in order, shape (n,) [s].
    :param velocities: at these times, shape (n, 3), is written.
    """
    v_x = v_y = omega = 0.0
    k = -1
    now = min(start_times[0], times[0])
    for i in range(len(times)):
        while now < times[i]:
            while k + 1 < len(start_times) and start_times[k + 1] <= now:
                k += 1
            until = times[i]
            if k + 1 < len(start_times):
                until = min(until, start_times[k + 1])
            if k >= 0:
                end = track_command(v_x, v_y, omega, commands[k], drive, until - now)
                v_x, v_y, omega = end[0], end[1], end[2]
            now = until
        velocities[i, 0], velocities[i, 1], velocities[i, 2] = v_x, v_y, omega


def predict(robot: RoundRobot, response: DriveResponse, sent: FloatArray, commands: FloatArray,
            times: FloatArray) -> FloatArray:
    """
    Predict the velocities of a base.

    :param sent: when commands were sent, in order, shape (k,) [s].
    :param commands: shape (k, 3).
    :param times: at which it is measured, in order, shape (n,) [s].
    :return: velocities in the robot's own axes, shape (n, 3).
    """
    least = (0.0, 0.0) if response.is_behind_lag else response.least_speeds
    limited = _limited(commands, response.max_speed, response.max_yaw_rate)
    asked = np.ascontiguousarray(_driven(robot, limited, response, least, response.step))
    velocities = np.empty((len(times), 3))
    drive = np.array([response.time_constant, response.acceleration, response.yaw_acceleration])
    follow(np.ascontiguousarray(sent + response.dead_time), asked, drive,
           np.ascontiguousarray(times), velocities)
    if not response.is_behind_lag:
        return velocities
    unscaled = response._replace(scales=(1.0, 1.0))
    return _driven(robot, velocities, unscaled, response.least_speeds, 0.0)


def to_channels(robot: RoundRobot, twists: FloatArray) -> FloatArray:
    """
    Compute the speeds of both wheels, or translation and rotation, with its sign along x or y.

    :param twists: shape (n, 3).
    :return: shape (n, 2).
    """
    if robot.drive == 'differential':
        half = 0.5 * robot.wheel_track * twists[:, 2]
        return np.column_stack([twists[:, 0] - half, twists[:, 0] + half])
    size = np.hypot(twists[:, 0], twists[:, 1])
    return np.column_stack([size, twists[:, 2]])


def _limited(commands: FloatArray, max_speed: float, max_yaw_rate: float) -> FloatArray:
    if max_speed == np.inf and max_yaw_rate == np.inf:
        return commands
    speed = np.hypot(commands[:, 0], commands[:, 1])
    ratio = np.minimum(1.0, max_speed / np.maximum(speed, 1e-9))
    return np.column_stack([commands[:, 0] * ratio, commands[:, 1] * ratio,
                            np.clip(commands[:, 2], -max_yaw_rate, max_yaw_rate)])


def _driven(robot: RoundRobot, twists: FloatArray, response: DriveResponse,
            least: tuple[float, float], step: float) -> FloatArray:
    """Let wheels, or translation and rotation, round, rest below their least speed, and scale."""
    channels = to_channels(robot, twists)
    steps = np.array([step, step])
    if robot.drive != 'differential':
        steps[1] /= 0.5 * robot.wheel_track
    driven = channels
    if step > 0.0:
        driven = steps * np.round(channels / steps)
    driven = np.where(np.abs(driven) >= least, driven, 0.0) * response.scales
    if robot.drive == 'differential':
        left, right = driven.T
        return np.column_stack([0.5 * (left + right), np.zeros(len(left)),
                                (right - left) / robot.wheel_track])
    ratio = driven[:, 0] / np.maximum(channels[:, 0], 1e-9)
    return np.column_stack([ratio * twists[:, 0], ratio * twists[:, 1], driven[:, 1]])
