"""Dimensions of the nonlinear program of a push, and the layout of its parameters."""

import enum
from typing import Any, NamedTuple

from push_planner.steered.push_parameters import PushKind, SupportLayout

# Radau points of a step. Chosen: two, of order 3 at the end of a step, keep the program small; the
# rollout makes up for what they miss.
POINTS = 2


class Constraint(enum.Enum):
    """Inequality of the program; its value says what is limited."""

    CONE = 'the friction cone'
    TOUCH = 'the friction cone at first touch'
    ANGLE_RATE = 'the rate of the pushing angle'
    YAW_RATE = 'the yaw rate of the robot'
    SPEED = 'the speed of the robot'
    VERTEX = 'the range of normals at the vertex'


class Dimensions(NamedTuple):
    """
    Key of the expressions of a program: programs of equal dimensions share them.

    :param kind: how the contact moves with the robot.
    :param support_count: number of supports.
    :param step_count: n, number of collocation steps.
    :param jumps: whether the pushing angle jumps between steps, or changes linearly.
    :param straight_end: whether the end is a straight push through the centre of friction.
    :param heading_free: whether the heading at the goal is free.
    :param transfers_loads: whether the push shifts loads from support to support.
    """

    kind: PushKind
    support_count: int
    step_count: int
    jumps: bool
    straight_end: bool
    heading_free: bool
    transfers_loads: bool = False

    @property
    def supports(self) -> SupportLayout:
        """Layout of the supports among the parameters."""
        return SupportLayout(self.support_count, self.transfers_loads)

    @property
    def state_count(self) -> int:
        """Number of states of a step: S, w, rho, theta, q_x, q_y and, of a drive, phi."""
        return 7 if self.kind == 'differential' else 6

    @property
    def step_size(self) -> int:
        """Number of variables of a step: states, change of the pushing angle, w at the points."""
        return self.state_count + 1 + POINTS

    @property
    def variable_count(self) -> int:
        """Number of variables of the program: of all steps, and the states at the end."""
        return self.step_size * self.step_count + self.state_count


class StepData(NamedTuple):
    """
    Parameters of a collocation step, in their order in the program.

    :param length: fixed part of the length [m].
    :param free_fraction: fraction of the free length S that is added to it.
    :param v_squared: V at the start [m^2/s^2].
    :param v_squared_slope: dV/ds [m/s^2].
    :param may_steer: 1 where the pushing angle may change, else 0.
    :param max_angle_slope: largest change of the pushing angle per length [rad/m].
    :param v_squared_end: V at the end [m^2/s^2].
    """

    length: Any
    free_fraction: Any
    v_squared: Any
    v_squared_slope: Any
    may_steer: Any
    max_angle_slope: Any
    v_squared_end: Any


class Limits(NamedTuple):
    """
    Limits of a push; the slacks are 0, or large where a cone does not count.

    :param cone_slope: tangent of the planning cone's half-angle.
    :param cone_slack: of the cone on forces.
    :param touch_slack: of the cone on impulse and force at the first touch.
    :param speed: highest speed of the robot's centre [m/s].
    :param yaw_rate: highest yaw rate of the robot [rad/s].
    :param min_normal: lowest angle of the normal in the object frame [rad].
    :param max_normal: highest angle of the normal in the object frame [rad].
    """

    cone_slope: Any
    cone_slack: Any
    touch_slack: Any
    speed: Any
    yaw_rate: Any
    min_normal: Any
    max_normal: Any


class BoundaryValues(NamedTuple):
    """
    Start and end of a push, in the object's start frame.

    :param q_x: followed point at the start, x [m].
    :param q_y: the same, y [m].
    :param w: present w of an object that moves already [1/m].
    :param moving: 1 where it does, 0 at rest.
    :param x: object at the goal, x [m].
    :param y: the same, y [m].
    :param theta: rotation of the object until the goal, unwrapped [rad].
    :param delta: normal in the object frame at the goal, of a differential drive [rad].
    :param f_x: centre of friction in the object frame, x [m].
    :param f_y: the same, y [m].
    """

    q_x: Any
    q_y: Any
    w: Any
    moving: Any
    x: Any
    y: Any
    theta: Any
    delta: Any
    f_x: Any
    f_y: Any
