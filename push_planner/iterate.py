"""What goes into the programme of a push, and what comes out."""

from typing import NamedTuple

import numpy as np

from push_planner.stage import NODE, POINTS

RUN_IN_STEPS = 3


class Bounds(NamedTuple):
    """
    What the push must keep to.

    :param slope: tangent of the planning cone's half-angle.
    :param speed: highest speed of the robot's centre, per pushing speed.
    :param turn: highest yaw rate of the robot per pushing speed [1/m].
    :param lowest: lowest gamma - theta [rad].
    :param highest: highest gamma - theta [rad].
    """

    slope: float
    speed: float
    turn: float
    lowest: float
    highest: float


class Ends(NamedTuple):
    """
    Where the push begins and ends.

    :param start: (x, y, theta, gamma) of object and normal.
    :param goal: the same at the goal, angles unwrapped; gamma is not used for a holonomic robot.
    :param run_in: length of the straight push at the end [m].
    :param last_angle: pushing angle of the run-in [rad].
    """

    start: tuple
    goal: tuple
    run_in: float
    last_angle: float


class Solution(NamedTuple):
    """
    Iterate of the programme.

    :param way: S [m].
    :param excess: by how much the worst row of the bounds is exceeded, 0 where a push exists.
    :param angles: pushing angles of the segments, shape (N,) [rad].
    :param nodes: states at the ends of all steps, shape (N + RUN_IN_STEPS, 5), see ``NODE``.
    :param rates: w at the Radau points, shape (N + RUN_IN_STEPS, POINTS) [1/m].
    """

    way: float
    excess: float
    angles: np.ndarray
    nodes: np.ndarray
    rates: np.ndarray

    def column(self):
        """Return the unknowns as one vector."""
        stages = np.column_stack([self.nodes, self.rates])
        return np.concatenate([[self.way, self.excess], self.angles, stages.ravel()])

    @classmethod
    def of(cls, column, segments):
        """
        Take the unknowns from a vector.

        :param column: the vector.
        :param segments: N.
        """
        stages = column[2 + segments:].reshape(segments + RUN_IN_STEPS, len(NODE) + POINTS)
        nodes, rates = stages[:, :len(NODE)], stages[:, len(NODE):]
        return cls(float(column[0]), float(column[1]), column[2:2 + segments], nodes, rates)
