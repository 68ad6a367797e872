"""
What a drive can steer: steady turns in which object and robot move as one.

A holonomic robot holds the contact normal, and any direction of the push. A differential drive
cannot move sideways: ``omega_p = v_C sin(b) / (R_p cos D)``, b from its heading to the push and
``D = gamma - phi``. Where it holds a turn, ``omega_p = omega``, b follows from the place alone:

    kappa (R_p + L) = D - zeta,    zeta = gamma - (direction from C to F), small angles

At a vertex D is kept and zeta is free, so that the cone bounds kappa to ``(D -+ beta)/(r + R_p)``.
On a face the normal is fixed, and rolling without slip conserves ``offset + R_p (phi - theta)``:
with F ahead of the face by n_f, ``kappa (R_p + L) = D_0 - zeta_0 - (offset - offset_0)
(1/n_f - 1/R_p)``. Nothing steers where R_p = n_f: the place that it starts from decides the turn.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.steady_turn import steady_force, steady_yaw_rate
from push_model.contact import contact_point, normal_range
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.robot_kinematics import center_velocity, yaw_rate
from scipy.optimize import brentq

SAMPLES = 25
RIGHT_ANGLE = 0.5 * math.pi - 1e-3
EXACT = 1e-9


class SteadyPush(NamedTuple):
    """
    A steady turn of object and robot as one, in the object frame.

    :param curvature: of the path of the flat point z, turning rate over speed from C to F [1/m];
        above 0 to the left.
    :param contact_point: C (x, y) [m].
    :param normal: angle of n [rad].
    :param heading: of the robot [rad].
    :param twist: (v_x, v_y, omega) of the robot, own axes [m/s, rad/s].
    :param force_angle: from n to the force on the object [rad].
    """

    curvature: float
    contact_point: tuple
    normal: float
    heading: float
    twist: tuple
    force_angle: float


def steering_range(obj, contact, robot, speed, heading_offset=0.0):
    """
    Find the sharpest steady turns that the contact, and the limits of the drive, bear.

    :param obj: the ``PushedObject``.
    :param contact: where the push starts; a differential drive may roll on from there.
    :param robot: the ``RoundRobot``.
    :param speed: of the contact [m/s], above 0.
    :param heading_offset: D at the start, from the robot's heading to n [rad]; without effect on a
        holonomic robot.
    :return: ``SteadyPush`` of lowest and of highest curvature; None where none holds.
    :raises ValueError: for a fence, or a differential drive without radius.
    """
    if math.isinf(robot.radius) or robot.drive == 'differential' and robot.radius == 0.0:
        raise ValueError(f'robot.radius: got {robot.radius:g}, expected a round robot')
    if robot.drive == 'differential':
        location = pushing_location(obj, contact, robot.radius, None, -heading_offset)
        ends = _turns(location)

        def push_at(turn):
            return steady_differential_push(obj, location, turn, speed)
    else:
        normal, toward = _facing(obj, contact)
        ends = toward - RIGHT_ANGLE, toward + RIGHT_ANGLE

        def push_at(direction):
            return steady_holonomic_push(obj, contact, robot.radius, normal, direction, speed)

    holding = _holding(push_at, ends, lambda push: _reserve(obj, robot, push))
    if not holding:
        return None
    return (min(holding, key=lambda push: push.curvature),
            max(holding, key=lambda push: push.curvature))


def steady_holonomic_push(obj, contact, robot_radius, normal, direction, speed):
    """
    Find the steady turn in which a holonomic robot, which faces the contact, holds it.

    :param obj: the ``PushedObject``.
    :param contact: where.
    :param robot_radius: R_p [m].
    :param normal: angle of n in the object frame [rad].
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s].
    :return: ``SteadyPush``; None for a push away from the mass or friction centre.
    """
    return _steady_push(obj, contact_point(obj, contact), normal, normal, direction, speed,
                        robot_radius)


def steady_differential_push(obj, location, turn, speed):
    """
    Find the steady turn that a differential drive holds, once it has rolled to a place.

    :param obj: the ``PushedObject``.
    :param location: ``PushingLocation`` of the start, where the push is along the heading.
    :param turn: of the object from there, as the robot sees it [rad].
    :param speed: of the contact [m/s].
    :return: ``SteadyPush``; None where it cannot push straight ahead, or towards F.
    """
    heading, offset = location.forward - turn, -float(location.rho(turn))
    aim = tuple(map(float, location.friction_center(turn)))
    x_f, y_f = friction_center(obj)
    x, y = Pose(0.0, 0.0, heading).rotate(aim)
    point, toward = (x_f - x, y_f - y), math.atan2(aim[1], aim[0])
    if not all(_is_ahead(obj, point, heading + angle) for angle in (0.0, toward)):
        return None

    def residual(angle):
        return (steady_yaw_rate(obj, point, heading + angle, speed)
                - float(yaw_rate('differential', location.robot_radius, angle - offset, offset,
                                 0.0, speed)))

    # Pushed straight ahead it turns and the robot does not; towards F, the other way round.
    more = math.copysign(EXACT, toward)
    angle = brentq(residual, -more, toward + more, xtol=1e-13)
    push = _steady_push(obj, point, heading + offset, heading, heading + angle, speed,
                        location.robot_radius)
    return push._replace(twist=(push.twist[0], 0.0, push.twist[2]))


def _steady_push(obj, point, normal, heading, direction, speed, radius):
    if not _is_ahead(obj, point, direction):
        return None
    x_f, y_f = friction_center(obj)
    along = math.cos(direction - math.atan2(y_f - point[1], x_f - point[0]))
    omega = steady_yaw_rate(obj, point, direction, speed)
    force_n, force_t = steady_force(obj, point, direction, speed, normal)
    base = map(float, center_velocity(radius, direction - normal, omega, speed))
    twist = (*Pose(0.0, 0.0, normal - heading).rotate(tuple(base)), omega)
    return SteadyPush(omega / (speed * along), point, normal, heading, twist,
                      math.atan2(force_t, force_n))


def _is_ahead(obj, point, direction):
    return all(math.cos(direction - math.atan2(y - point[1], x - point[0])) > EXACT
               for x, y in (friction_center(obj), obj.center_of_mass))


def _facing(obj, contact):
    (x_c, y_c), (x_f, y_f) = contact_point(obj, contact), friction_center(obj)
    toward = math.atan2(y_f - y_c, x_f - x_c)
    low, high = normal_range(obj, contact)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return middle + min(half, max(-half, wrap_angle(toward - middle))), toward


def _turns(location):
    low, high = location.turns
    share = location.rolling[0]
    if share > 0.0:
        low = max(low, (location.pushing_angle - RIGHT_ANGLE) / share)
        high = min(high, (location.pushing_angle + RIGHT_ANGLE) / share)
    return low, high


def _reserve(obj, robot, push):
    """Angle, yaw rate and speed that are left, the least of them; below 0 it does not hold."""
    if push is None:
        return -1.0
    cone = math.atan(obj.contact_friction_coefficient)
    return min(cone - abs(push.force_angle), robot.max_yaw_rate - abs(push.twist[2]),
               robot.max_speed - math.hypot(*push.twist[:2])) + EXACT


def _holding(push_at, ends, reserve):
    places = np.linspace(*ends, SAMPLES)
    left = np.array([reserve(push_at(place)) for place in places])
    edges = [brentq(lambda place: reserve(push_at(place)), places[i], places[i + 1], xtol=1e-10)
             for i in np.flatnonzero((left[:-1] < 0.0) != (left[1:] < 0.0))]
    found = map(push_at, [*places[left >= 0.0], *edges])
    return [push for push in found if push is not None]
