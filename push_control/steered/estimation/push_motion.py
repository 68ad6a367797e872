"""
Motion of the object under the robot's motion: the quasi-static model of the estimator.

The contact sticks or rolls. With C the contact, F the centre of friction, ``a = C - F`` and v the
velocity imposed at C, in the object's axes,

    ``omega = (a_x v_y - a_y v_x) / (c^2 + |a|^2)``    and    ``v_object = v - omega k x C``.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_control.steered.estimation.contact_site import rolled_contact, RollingContact
from push_control.steered.estimation.limit_surface_table import (
    LimitSurfaceTable, tabulated_c_squared)
from push_dynamics.compiled import compiled, interpreted
from push_model import quasi_static, robot_kinematics
from push_model.geometry import Coordinates, FloatArray, Pose

contact_velocity = compiled(robot_kinematics.contact_velocity)
ellipsoid_yaw_rate = compiled(quasi_static.ellipsoid_yaw_rate)


class MotionState(NamedTuple):
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


class MotionModel(NamedTuple):
    """
    The numbers of a ``PushMotion``, as compiled functions read them.

    :param contact: the ``RollingContact``.
    :param is_lost: whether the robot does not touch the object.
    :param c_squared: ``LimitSurfaceTable.values`` of the contact [m^2].
    """

    contact: RollingContact
    is_lost: bool
    c_squared: Any


@compiled
def object_rates(model: MotionModel, state: MotionState, twist: Any) -> Rates:
    """
    Velocity of the object; zero while the robot does not press.

    :param twist: of the robot (v_x, v_y, omega_p), robot's axes [m/s, m/s, rad/s].
    """
    c_x, c_y, normal = rolled_contact(model.contact, state.phi - state.theta)
    gamma = state.theta + normal
    u_x, u_y = contact_velocity(state.phi, gamma, model.contact.robot_radius, twist)
    lever = (c_x - state.p_x, c_y - state.p_y)
    if model.is_lost or u_x * math.cos(gamma) + u_y * math.sin(gamma) <= 0.0:
        # Nothing moves, whatever the supports are like.
        return Rates(0.0, 0.0, 0.0, lever, (0.0, 0.0), 1.0)
    cosine, sine = math.cos(state.theta), math.sin(state.theta)
    push = (cosine * u_x + sine * u_y, cosine * u_y - sine * u_x)
    c_squared = math.exp(state.q) * tabulated_c_squared(model.c_squared, push_angle(lever, push))
    omega = ellipsoid_yaw_rate(c_squared, lever[0], lever[1], push[0], push[1])
    return Rates(u_x + omega * (sine * c_x + cosine * c_y),
                 u_y - omega * (cosine * c_x - sine * c_y), omega, lever, push, c_squared)


@compiled
def propagated_state(model: MotionModel, state: MotionState, rates: Rates, twist: Any,
                     duration: float) -> MotionState:
    """
    Carry a state over one step (midpoint rule).

    :param rates: ``Rates`` of that state.
    :param twist: mean motion of the robot over the step, robot's axes.
    :param duration: of the step [s].
    """
    half = 0.5 * duration
    middle = MotionState(state.x, state.y, state.theta + half * rates.omega,
                         state.phi + half * twist[2], state.p_x, state.p_y, state.q)
    mean = object_rates(model, middle, twist)
    return MotionState(state.x + duration * mean.x, state.y + duration * mean.y,
                       state.theta + duration * mean.omega, state.phi + duration * twist[2],
                       state.p_x, state.p_y, state.q)


@compiled
def linearize_step(state: MotionState, rates: Rates, duration: float, transition: Any) -> float:
    """
    Linearise one step; the shift of a rolling contact with theta and phi is left out.

    :param rates: ``Rates`` of that state.
    :param duration: of the step [s].
    :param transition: derivative of the next state by the present one, shape (7, 7), is written.
    :return: path length of the contact in the step [m].
    """
    (a_x, a_y), (v_x, v_y), c_squared = rates.lever, rates.push, rates.c_squared
    denominator = c_squared + a_x * a_x + a_y * a_y
    # Derivatives of omega by theta, phi, p_x, p_y and q.
    by_phi = (a_x * v_x + a_y * v_y) / denominator
    slopes = (-by_phi, by_phi, (2.0 * a_x * rates.omega - v_y) / denominator,
              (2.0 * a_y * rates.omega + v_x) / denominator,
              -rates.omega * c_squared / denominator)
    cosine, sine = math.cos(state.theta), math.sin(state.theta)
    c_x, c_y = a_x + state.p_x, a_y + state.p_y
    arm_x, arm_y = cosine * c_x - sine * c_y, sine * c_x + cosine * c_y
    for i in range(7):
        for j in range(7):
            transition[i, j] = 1.0 if i == j else 0.0
    # Of the velocities x', y' and omega by the same five.
    for j in range(5):
        transition[0, 2 + j] += duration * arm_y * slopes[j]
        transition[1, 2 + j] -= duration * arm_x * slopes[j]
        transition[2, 2 + j] += duration * slopes[j]
    transition[0, 2] += duration * rates.omega * arm_x
    transition[1, 2] += duration * rates.omega * arm_y
    transition[0, 3] -= duration * (sine * v_x + cosine * v_y)
    transition[1, 3] += duration * (cosine * v_x - sine * v_y)
    return duration * math.sqrt(v_x * v_x + v_y * v_y)


@compiled
def push_angle(lever: tuple[float, float], push: tuple[float, float]) -> float:
    """
    Angle alpha from the line C->F to a velocity imposed at C.

    :param lever: C minus F (x, y) [m].
    :param push: the velocity in the same axes [m/s].
    :return: alpha [rad].
    """
    return math.atan2(lever[1] * push[0] - lever[0] * push[1],
                      -lever[0] * push[0] - lever[1] * push[1])


class PushMotion(NamedTuple):
    """
    Motion of the estimated state under odometry.

    :param robot_radius: R_p [m].
    :param site: the ``RollingContact``.
    :param supports: the ``LimitSurfaceTable`` of the contact.
    :param is_lost: whether the robot does not touch the object.
    """

    robot_radius: float
    site: RollingContact
    supports: LimitSurfaceTable
    is_lost: bool = False

    @property
    def model(self) -> MotionModel:
        """The ``MotionModel``."""
        return MotionModel(self.site, self.is_lost, self.supports.values)

    def rates(self, state: MotionState, twist: Coordinates) -> Rates:
        """
        Velocity of the object; zero while the robot does not press.

        :param twist: of the robot (v_x, v_y, omega_p), robot's axes [m/s, m/s, rad/s].
        """
        return interpreted(object_rates)(self.model, state, twist)

    def propagate(self, state: MotionState, twist: Coordinates, duration: float) -> MotionState:
        """
        Carry a state over one step (midpoint rule).

        :param twist: mean motion of the robot over the step, robot's axes.
        :param duration: of the step [s].
        """
        return interpreted(propagated_state)(self.model, state, self.rates(state, twist), twist,
                                             duration)

    def linearize(self, state: MotionState, rates: Rates, duration: float) -> Linearization:
        """
        Linearise one step; the shift of a rolling contact with theta and phi is left out.

        :param rates: ``Rates`` of that state.
        :param duration: of the step [s].
        """
        transition: FloatArray = np.empty((7, 7))
        distance = interpreted(linearize_step)(state, rates, duration, transition)
        return Linearization(transition, distance)
