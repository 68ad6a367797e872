"""What a programme is built for, and the numbers that it is then given."""

from typing import NamedTuple

POINTS = 2
ROWS_OF = {
    'cone': 'the friction cone', 'touch': 'the friction cone at first touch',
    'rate': 'the rate of the pushing angle', 'turn': 'the yaw rate of the robot',
    'speed': 'the speed of the robot', 'vertex': 'the range of normals at the vertex', '': ''}
STEP_FIELDS = ('length', 'share', 'square', 'slope', 'free', 'rate', 'pace')


class Dimensions(NamedTuple):
    """
    What a programme is built for.

    :param kind: one of ``push_planner.push_parameters.PUSH_KINDS``.
    :param supports: number of supports.
    :param steps: number of steps.
    :param jumps: whether the pushing angle jumps between steps, or changes linearly.
    :param straight: whether the end is a straight push through the friction centre.
    :param heading_free: whether the heading at the goal is free.
    """

    kind: str
    supports: int
    steps: int
    jumps: bool
    straight: bool
    heading_free: bool

    @property
    def states(self):
        """Number of states of a stage."""
        return 7 if self.kind == 'differential' else 6

    @property
    def width(self):
        """Number of unknowns of a stage."""
        return self.states + 1 + POINTS


class Limits(NamedTuple):
    """
    What a push must keep to; the slacks are 0, or large where a cone does not count.

    :param slope: tangent of the planning cone's half-angle.
    :param slack: of the cone on forces.
    :param touch_slack: of the cone on the impulse of the first touch.
    :param speed: highest speed of the robot's centre [m/s].
    :param turn: highest yaw rate of the robot [rad/s].
    :param lowest: lowest normal in the object frame [rad].
    :param highest: highest normal in the object frame [rad].
    """

    slope: float
    slack: float
    touch_slack: float
    speed: float
    turn: float
    lowest: float
    highest: float


class BoundaryValues(NamedTuple):
    """
    Where the push begins and ends, in the object's start frame.

    :param q_x: followed point at the start [m].
    :param q_y: the same, y.
    :param w: present w of an object that moves already [1/m].
    :param moving: 1 where it does, 0 at rest.
    :param x: object at the goal [m].
    :param y: the same, y.
    :param theta: its turn until the goal, unwrapped [rad].
    :param delta: normal in the object frame at the goal [rad]; for a differential drive.
    :param f_x: friction centre in the object frame [m].
    :param f_y: the same, y.
    """

    q_x: float
    q_y: float
    w: float
    moving: float
    x: float
    y: float
    theta: float
    delta: float
    f_x: float
    f_y: float
