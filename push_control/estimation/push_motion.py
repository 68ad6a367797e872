"""
Motion of the object under the robot's motion: the quasi-static model of the estimator.

The contact sticks or rolls. With C the contact, F the centre of friction, ``a = C - F`` and v the
velocity imposed at C, in the object's axes,

    ``omega = (a_x v_y - a_y v_x) / (c^2 + |a|^2)``    and    ``v_object = v - omega k x C``.
"""

import math
from typing import NamedTuple

import numpy as np
from push_control.estimation.contact_site import ContactSite
from push_control.estimation.limit_surface_table import LimitSurfaceTable
from push_model.geometry import Coordinates, FloatArray, Pose
from push_model.quasi_static import ellipsoid_yaw_rate
from push_model.robot_kinematics import contact_velocity


class PushState(NamedTuple):
    """
    Estimated state of a push [m, m, rad, rad, m, m, -].

    :param x: of the object frame in the world.
    :param y: of the object frame in the world.
    :param theta: orientation of the object frame in the world.
    :param phi: effective heading of the robot, which takes up odometry drift and placement errors.
    :param p_x: of the centre of friction in the object frame.
    :param p_y: of the centre of friction in the object frame.
    :param q: natural logarithm of the supports' c^2 over the nominal one; the greater, the less a
        push rotates the object.
    """

    x: float
    y: float
    theta: float
    phi: float
    p_x: float
    p_y: float
    q: float = 0.0

    @property
    def pose(self) -> Pose:
        """Pose of the object in the world."""
        return Pose(self.x, self.y, self.theta)

    @property
    def center(self) -> tuple[float, float]:
        """Friction centre in the object frame (x, y) [m]."""
        return self.p_x, self.p_y

    @property
    def relative_heading(self) -> float:
        """Heading of the robot relative to the object, unwrapped [rad]."""
        return self.phi - self.theta


class Rates(NamedTuple):
    """
    Velocity of the object, and what it came from.

    :param x: velocity in the world, x [m/s].
    :param y: the same, y [m/s].
    :param omega: yaw rate [rad/s].
    :param lever: a, C minus F in the object's axes (x, y) [m].
    :param push: v, velocity imposed at C in the object's axes (x, y) [m/s].
    :param c_squared: of the supports for that push [m^2].
    """

    x: float
    y: float
    omega: float
    lever: tuple[float, float]
    push: tuple[float, float]
    c_squared: float


class Linearization(NamedTuple):
    """
    One step of the motion, linearised.

    :param transition: derivative of the next state by the present one, shape (7, 7).
    :param distance: path length of the contact in the step [m].
    """

    transition: FloatArray
    distance: float


class PushMotion(NamedTuple):
    """
    Motion of the estimated state under odometry.

    :param robot_radius: R_p [m].
    :param site: the ``ContactSite``.
    :param supports: the ``LimitSurfaceTable`` of the contact.
    :param is_lost: whether the robot does not touch the object.
    """

    robot_radius: float
    site: ContactSite
    supports: LimitSurfaceTable
    is_lost: bool = False

    def rates(self, state: PushState, twist: Coordinates) -> Rates:
        """
        Velocity of the object; zero while the robot does not press.

        :param state: ``PushState``.
        :param twist: of the robot (v_x, v_y, omega_p), robot's axes [m/s, m/s, rad/s].
        :return: ``Rates``.
        """
        c_x, c_y, normal = self.site.contact_at(state.relative_heading)
        gamma = state.theta + normal
        u_x, u_y = contact_velocity(state.phi, gamma, self.robot_radius, twist)
        lever = c_x - state.p_x, c_y - state.p_y
        if self.is_lost or u_x * math.cos(gamma) + u_y * math.sin(gamma) <= 0.0:
            # Nothing moves, whatever the supports are like.
            return Rates(0.0, 0.0, 0.0, lever, (0.0, 0.0), 1.0)
        cosine, sine = math.cos(state.theta), math.sin(state.theta)
        push = cosine * u_x + sine * u_y, cosine * u_y - sine * u_x
        c_squared = math.exp(state.q) * self.supports.c_squared(push_angle(lever, push))
        omega = ellipsoid_yaw_rate(c_squared, *lever, *push)
        return Rates(u_x + omega * (sine * c_x + cosine * c_y),
                     u_y - omega * (cosine * c_x - sine * c_y), omega, lever, push, c_squared)

    def propagate(self, state: PushState, twist: Coordinates, duration: float,
                  rates: Rates | None = None) -> PushState:
        """
        Carry a state over one step (midpoint rule).

        :param state: ``PushState``.
        :param twist: mean motion of the robot over the step, robot's axes.
        :param duration: of the step [s].
        :param rates: ``Rates`` of that state, where they are known already.
        :return: ``PushState``.
        """
        half = 0.5 * duration
        rates = rates or self.rates(state, twist)
        middle = state._replace(theta=state.theta + half * rates.omega,
                                phi=state.phi + half * twist[2])
        rates = self.rates(middle, twist)
        return PushState(state.x + duration * rates.x, state.y + duration * rates.y,
                         state.theta + duration * rates.omega, state.phi + duration * twist[2],
                         state.p_x, state.p_y, state.q)

    def linearize(self, state: PushState, rates: Rates, duration: float) -> Linearization:
        """
        Linearise one step; the shift of a rolling contact with theta and phi is left out.

        :param state: ``PushState``.
        :param rates: ``Rates`` of that state.
        :param duration: of the step [s].
        :return: ``Linearization``.
        """
        (a_x, a_y), (v_x, v_y), c_squared = rates.lever, rates.push, rates.c_squared
        denominator = c_squared + a_x * a_x + a_y * a_y
        # Derivatives of omega by theta, phi, p_x, p_y and q.
        by_phi = (a_x * v_x + a_y * v_y) / denominator
        slopes = np.array([-by_phi, by_phi, (2.0 * a_x * rates.omega - v_y) / denominator,
                           (2.0 * a_y * rates.omega + v_x) / denominator,
                           -rates.omega * c_squared / denominator])
        cosine, sine = math.cos(state.theta), math.sin(state.theta)
        c_x, c_y = a_x + state.p_x, a_y + state.p_y
        arm_x, arm_y = cosine * c_x - sine * c_y, sine * c_x + cosine * c_y
        # Of the velocities x', y' and omega by the same five.
        jacobian = np.zeros((3, 5))
        jacobian[0], jacobian[1], jacobian[2] = arm_y * slopes, -arm_x * slopes, slopes
        jacobian[0, 0] += rates.omega * arm_x
        jacobian[1, 0] += rates.omega * arm_y
        jacobian[0, 1] -= sine * v_x + cosine * v_y
        jacobian[1, 1] += cosine * v_x - sine * v_y
        transition = np.eye(7)
        transition[:3, 2:] += duration * jacobian
        return Linearization(transition, duration * math.hypot(v_x, v_y))


def push_angle(lever: tuple[float, float], push: tuple[float, float]) -> float:
    """
    Angle alpha from the line C->F to a velocity imposed at C.

    :param lever: C minus F (x, y) [m].
    :param push: the velocity in the same axes [m/s].
    :return: alpha [rad].
    """
    return math.atan2(lever[1] * push[0] - lever[0] * push[1],
                      -lever[0] * push[0] - lever[1] * push[1])
