"""Speeds of the two wheels of a differential drive, and the twist that they give."""

from push_model.signals import Twist


def wheel_speeds(twist: Twist, track: float) -> tuple[float, float]:
    """
    Compute the speeds of the wheels of a differential drive.

    :param twist: of the robot, own axes; ``v_y`` does not count.
    :param track: distance between the wheels [m].
    :return: (left, right) [m/s].
    """
    half = 0.5 * track * twist.omega
    return twist.v_x - half, twist.v_x + half


def twist_of_wheels(left: float, right: float, track: float) -> Twist:
    """
    Compute the twist that a differential drive has by its wheels.

    :param left: speed of the left wheel [m/s].
    :param right: speed of the right wheel [m/s].
    :param track: distance between the wheels, above 0 [m].
    """
    return Twist(0.5 * (left + right), 0.0, (right - left) / track)
