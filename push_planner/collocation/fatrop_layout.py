"""
Order of rows that the solver fatrop wants, and how the steps of a push are coupled.

Fatrop solves optimal control problems stage by stage. The rows of stage k must be, in this order:
the dynamics, which couple the states of stage k to those of stage k + 1; the other equalities; the
inequalities (L. Vanroye et al., FATROP: a fast constrained optimal control problem solver for
robot trajectory optimization and control, IROS 2023; in CasADi ``structure_detection='auto'``).
A stage is a collocation step here, and the end of the push a last one.

The rows come from three blocks that are evaluated apart: all rows of every step, the rows of the
first step alone, and those of the end:

    steps   k = 0 ... n - 1:  [dynamics | collocation | inequalities]
    first   [equalities | inequalities]
    end     [equalities]
"""

from typing import NamedTuple

import numpy as np
from push_model.geometry import IntArray


class RowCounts(NamedTuple):
    """
    Numbers of rows of the blocks.

    :param dynamics: of a step.
    :param collocation: of a step.
    :param step: all rows of a step, inequalities included.
    :param first_equalities: of the first step alone.
    :param first: all rows of the first step alone.
    :param end: rows of the end.
    """

    dynamics: int
    collocation: int
    step: int
    first_equalities: int
    first: int
    end: int


class FatropLayout(NamedTuple):
    """
    Permutation of the rows, and the coupling of the steps.

    :param order: index among the rows of the blocks, of each row of the program, shape (m,).
    :param position: the inverse, row of the program of each row of the blocks, shape (m,).
    :param coupling_rows: rows of the program to which a state of the next step is added.
    :param coupling_variables: the variables that are added there.
    """

    order: IntArray
    position: IntArray
    coupling_rows: IntArray
    coupling_variables: IntArray

    @classmethod
    def build(cls, step_count: int, step_size: int, counts: RowCounts) -> 'FatropLayout':
        """
        Lay out the rows of n steps.

        :param step_count: n.
        :param step_size: number of variables of a step; the first are its states, as many as it
            has rows of dynamics.
        :param counts: ``RowCounts``.
        """
        step = np.arange(counts.step)
        first = counts.step * step_count + np.arange(counts.first)
        end = counts.step * step_count + counts.first + np.arange(counts.end)
        dynamics, collocation, inequalities = np.split(
            step, [counts.dynamics, counts.dynamics + counts.collocation])
        order = np.concatenate([
            dynamics, first[:counts.first_equalities], collocation,
            first[counts.first_equalities:], inequalities,
            *(step + counts.step * k for k in range(1, step_count)), end])
        position = np.argsort(order)
        states = np.arange(counts.dynamics)
        rows = (counts.step * np.arange(step_count)[:, None] + states).ravel()
        variables = (step_size * np.arange(1, step_count + 1)[:, None] + states).ravel()
        return cls(order, position, position[rows], variables)
