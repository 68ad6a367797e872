"""How the object moves when the robot does: the estimator's quasi-static model."""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import Pose
from push_model.quasi_static import ellipsoid_yaw_rate
from push_model.robot_kinematics import contact_velocity


class PushState(NamedTuple):
    """
    Estimated state of a push [m, m, rad, rad, m, m, -].

    x, y, theta: object frame in the world. phi: effective heading of the robot, which takes up
    odometry drift and placement errors. p_x, p_y: friction centre in the object frame. q: natural
    logarithm of the supports' c^2 over the believed; the greater, the less a push turns.
    """

    x: float
    y: float
    theta: float
    phi: float
    p_x: float
    p_y: float
    q: float = 0.0

    @property
    def pose(self):
        """Pose of the object in the world."""
        return Pose(self.x, self.y, self.theta)

    @property
    def center(self):
        """Friction centre in the object frame (x, y) [m]."""
        return self.p_x, self.p_y


class Rates(NamedTuple):
    """Velocity of the object (world), and what it came from (object frame, at C)."""

    x: float
    y: float
    omega: float
    lever: tuple
    push: tuple


class PushMotion(NamedTuple):
    """
    Motion of belief under odometry, for a contact that sticks or rolls.

    :param robot_radius: R_p [m].
    :param site: the contact ``ContactSite``.
    :param supports: the ``LimitSurfaceTable`` of the contact.
    :param lost: whether the robot does not touch the object.
    """

    robot_radius: float
    site: object
    supports: object
    lost: bool = False

    def rates(self, belief, twist):
        """
        Velocity of the object; zero while the robot does not press.

        :param belief: ``PushState``.
        :param twist: robot (v_x, v_y, omega_p), body axes.
        :return: ``Rates``.
        """
        c_x, c_y, normal = self.site.at(belief.phi - belief.theta)
        gamma = belief.theta + normal
        u_x, u_y = contact_velocity(belief.phi, gamma, self.robot_radius, twist)
        lever = c_x - belief.p_x, c_y - belief.p_y
        if self.lost or u_x * math.cos(gamma) + u_y * math.sin(gamma) <= 0.0:
            return Rates(0.0, 0.0, 0.0, lever, (0.0, 0.0))
        cosine, sine = math.cos(belief.theta), math.sin(belief.theta)
        push = cosine * u_x + sine * u_y, cosine * u_y - sine * u_x
        square = math.exp(belief.q) * self.supports.c_squared(push_angle(lever, push))
        omega = ellipsoid_yaw_rate(square, *lever, *push)
        return Rates(u_x + omega * (sine * c_x + cosine * c_y),
                     u_y - omega * (cosine * c_x - sine * c_y), omega, lever, push)

    def moved(self, belief, twist, duration):
        """
        Carry a belief over one step (midpoint rule).

        :param belief: ``PushState``.
        :param twist: mean motion of the robot over the step, body axes.
        :param duration: of the step [s].
        :return: ``PushState``.
        """
        half = 0.5 * duration
        rates = self.rates(belief, twist)
        middle = belief._replace(theta=belief.theta + half * rates.omega,
                                 phi=belief.phi + half * twist[2])
        rates = self.rates(middle, twist)
        return PushState(belief.x + duration * rates.x, belief.y + duration * rates.y,
                         belief.theta + duration * rates.omega, belief.phi + duration * twist[2],
                         belief.p_x, belief.p_y, belief.q)

    def jacobian(self, belief, twist, duration):
        """
        Linearise one step; the shift of a rolling contact with theta and phi is left out.

        :param belief: ``PushState``.
        :param twist: mean motion of the robot over the step, body axes.
        :param duration: of the step [s].
        :return: transition matrix, shape (7, 7); way of the contact in the step [m].
        """
        rates = self.rates(belief, twist)
        (a_x, a_y), (v_x, v_y) = rates.lever, rates.push
        own = math.exp(belief.q) * self.supports.c_squared(push_angle(rates.lever, rates.push))
        square = own + a_x * a_x + a_y * a_y
        turn = (a_x * v_x + a_y * v_y) / square
        slopes = np.array([-turn, turn, (2.0 * a_x * rates.omega - v_y) / square,
                           (2.0 * a_y * rates.omega + v_x) / square,
                           -rates.omega * own / square])
        cosine, sine = math.cos(belief.theta), math.sin(belief.theta)
        c_x, c_y = a_x + belief.p_x, a_y + belief.p_y
        arm_x, arm_y = cosine * c_x - sine * c_y, sine * c_x + cosine * c_y
        step = np.zeros((3, 5))
        step[0], step[1], step[2] = arm_y * slopes, -arm_x * slopes, slopes
        step[0, 0] += rates.omega * arm_x
        step[1, 0] += rates.omega * arm_y
        step[0, 1] -= sine * v_x + cosine * v_y
        step[1, 1] += cosine * v_x - sine * v_y
        transition = np.eye(7)
        transition[:3, 2:] += duration * step
        return transition, duration * math.hypot(v_x, v_y)


def push_angle(lever, push):
    """
    Angle alpha from the line C->F to a velocity imposed at C [rad].

    :param lever: C less F (x, y) [m].
    :param push: the velocity in the same axes [m/s].
    """
    return math.atan2(lever[1] * push[0] - lever[0] * push[1],
                      -lever[0] * push[0] - lever[1] * push[1])
