"""From where the robot is on its way to what it should do."""

import math

from push_drive.run import braked, SETTLE
from push_model.geometry import Pose, wrap_angle
from push_model.signals import Twist

# Way on which a differential drive comes back to its line.
RETURN = 0.15
ASTRAY = 0.6
SIDEWAYS = 0.1


def limited_change(before, wanted, limits, dt):
    """
    Bring a command within the limits, the change from the one before included.

    :param before: ``Twist`` that was commanded.
    :param wanted: ``Twist`` that is wanted.
    :param limits: ``DriveSettings`` within the limits of the robot.
    :param dt: time between the two [s].
    :return: ``Twist``.
    """
    x, y = wanted.v_x - before.v_x, wanted.v_y - before.v_y
    change = math.hypot(x, y)
    share = min(1.0, limits.acceleration * dt / change) if change else 0.0
    x, y = before.v_x + share * x, before.v_y + share * y
    excess = max(1.0, math.hypot(x, y) / limits.speed)
    step = limits.yaw_acceleration * dt
    omega = before.omega + min(step, max(-step, wanted.omega - before.omega))
    return Twist(x / excess, y / excess, min(limits.yaw_rate, max(-limits.yaw_rate, omega)))


def turning(left, limits):
    """
    Yaw rate of a turn on the spot [rad/s].

    :param left: angle left [rad].
    :param limits: ``DriveSettings`` within the limits of the robot.
    """
    rate = min(limits.yaw_rate, braked(abs(left), limits.yaw_acceleration))
    return math.copysign(rate, left)


def driven(run, pose, way, aside, limits):
    """
    Command of a differential drive: curvature by how far it is off, sideways and in heading.

    :param run: the ``Run``.
    :param pose: ``Pose`` of the robot.
    :param way: how far it has come [m].
    :param aside: how far it is to the left of the run [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: ``Twist``.
    """
    speed = run.speed(way)
    direction, curvature = run.smooth_direction(way, speed)
    off = wrap_angle(pose.theta + math.pi * run.is_backwards - direction)
    if abs(off) > ASTRAY:
        return Twist(0.0, 0.0, turning(-off, limits))
    aside = min(RETURN, max(-RETURN, aside))
    omega = max(0.0, speed) * (curvature - aside / RETURN ** 2 - 2.0 * math.sin(off) / RETURN)
    share = min(1.0, limits.yaw_rate / abs(omega)) if omega else 1.0
    return Twist(share * (-speed if run.is_backwards else speed), 0.0, share * omega)


def held(run, pose, way, aside, limits):
    """
    Command of a holonomic base: along the run, back to it sideways, and turned as it should be.

    :param run: the ``Run``.
    :param pose: ``Pose`` of the robot.
    :param way: how far it has come [m].
    :param aside: how far it is to the left of the run [m].
    :param limits: ``DriveSettings`` within the limits of the robot.
    :return: ``Twist``.
    """
    speed = run.speed(way)
    direction, _ = run.smooth_direction(way, speed)
    heading, turned = run.heading(way)
    across = min(SIDEWAYS, max(-SIDEWAYS, aside / SETTLE))
    x, y = Pose(0.0, 0.0, direction - pose.theta).rotate((speed, -across))
    return Twist(x, y, speed * turned + turning(wrap_angle(heading - pose.theta), limits))
