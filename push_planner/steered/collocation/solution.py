"""What goes into the program of a push and comes out: variables, bounds on them, result."""

from typing import NamedTuple, Optional

import numpy as np
from push_model.geometry import FloatArray
from push_model.plan_request import PlanFailure
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.collocation.interior_point import Iterate


class Solution(NamedTuple):
    """
    Iterate of the program, in the object's start frame.

    :param free_length: S [m].
    :param nodes: (w, rho, theta, q_x, q_y, phi) at the nodes, shape (n + 1, 6).
    :param changes: of the pushing angle in each step, shape (n,) [rad].
    :param rates: w at the Radau points, shape (n, K) [1/m].
    """

    free_length: float
    nodes: FloatArray
    changes: FloatArray
    rates: FloatArray

    def column(self, dimensions: Dimensions) -> FloatArray:
        """
        Return the variables of the program as one vector.

        :param dimensions: ``Dimensions`` of the program.
        """
        n = dimensions.step_count
        states = dimensions.state_count
        table = np.zeros((n + 1, dimensions.step_size))
        table[:, 0] = self.free_length
        table[:, 1:states] = self.nodes[:, :states - 1]
        table[:n, states] = self.changes
        table[:n, states + 1:] = self.rates
        return table.ravel()[:dimensions.variable_count]

    @classmethod
    def of_column(cls, column: FloatArray, dimensions: Dimensions) -> 'Solution':
        """
        Take the variables of the program from a vector.

        :param column: the vector.
        :param dimensions: ``Dimensions`` of the program.
        """
        n = dimensions.step_count
        states = dimensions.state_count
        table = np.zeros((n + 1, dimensions.step_size))
        # The end has no controls.
        table.ravel()[:len(column)] = column
        nodes = np.zeros((n + 1, 6))
        nodes[:, :states - 1] = table[:, 1:states]
        if dimensions.kind == 'held':
            nodes[:, 5] = nodes[:, 2]
        return cls(float(table[0, 0]), nodes, table[:n, states].copy(),
                   table[:n, states + 1:].copy())


class VariableBounds(NamedTuple):
    """
    Bounds on the variables of the program.

    :param angle: largest pushing angle [rad].
    :param first_angle: (lowest, highest) pushing angle at the start [rad].
    :param rotation: (lowest, highest) rotation of the object [rad].
    """

    angle: float
    first_angle: tuple[float, float]
    rotation: tuple[float, float]


class SolveResult(NamedTuple):
    """
    Result of solving the program.

    :param solution: ``Solution``; None where there is none.
    :param iterations: number of iterations.
    :param failure: ``PlanFailure``; None with a solution.
    :param verdict: the failure in words.
    :param iterate: ``Iterate`` to resume from; None without a solution, and of the relaxed
        program.
    """

    solution: Optional[Solution]
    iterations: int
    failure: Optional[PlanFailure] = None
    verdict: str = ''
    iterate: Optional[Iterate] = None
