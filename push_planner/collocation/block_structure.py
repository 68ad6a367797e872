"""
A nonlinear program of n equal steps, with the derivatives that solvers ask for.

Variables are x = (z_0, ..., z_{n-1}, z_n), with z_k those of step k and z_n the states at the end.
The rows of all blocks are stacked, permuted into the order P of the solver, and coupled:

    g(x) = P [r(z_0), ..., r(z_{n-1}), r_first(z_0), r_end(z_n)] + C x

where C adds the states of the next step to the dynamics of each. Every step is evaluated by the
same small function, and so are its Jacobian and Hessian, whose nonzeros are then put in place: a
fraction of the time and of the building that one expression of all steps takes.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.geometry import IntArray
from push_planner.collocation.fatrop_layout import FatropLayout


class Block(NamedTuple):
    """
    Rows in some variables, and a cost on them.

    :param rows: function (variables, given...) -> rows.
    :param jacobian: function of the same -> (rows, their Jacobian).
    :param lagrangian: function (variables, given..., multipliers, factor of the cost) ->
        (gradient, Hessian) of the Lagrangian.
    """

    rows: Any
    jacobian: Any
    lagrangian: Any

    @classmethod
    def differentiate(cls, variables: Any, given: Sequence[Any], rows: Any, cost: Any) -> 'Block':
        """
        Differentiate rows and cost.

        :param variables: column of symbols.
        :param given: columns of symbols.
        :param rows: column of expressions.
        :param cost: expression.
        """
        rows = ca.cse(rows)
        multipliers = ca.SX.sym('multipliers', rows.numel())
        factor = ca.SX.sym('factor')
        hessian, gradient = ca.hessian(ca.dot(multipliers, rows) + factor * cost, variables)
        known = [variables, *given]
        with_jacobian: Any = ca.cse([rows, ca.jacobian(rows, variables)])
        derivatives: Any = ca.cse([ca.densify(gradient), hessian])
        return cls(ca.Function('rows', known, [rows]),
                   ca.Function('jacobian', known, with_jacobian),
                   ca.Function('lagrangian', [*known, multipliers, factor], derivatives))

    @property
    def row_count(self) -> int:
        """Number of rows."""
        return self.rows.size1_out(0)


class Blocks(NamedTuple):
    """
    Blocks of a program.

    :param step: of every step; given its parameters, and those of the whole push.
    :param first: of the first step besides; given the same.
    :param end: of the states at the end; given the parameters of the whole push.
    """

    step: Block
    first: Block
    end: Block


class ProgramSizes(NamedTuple):
    """
    Sizes of a program.

    :param steps: n, number of steps.
    :param step_variables: number of variables of a step.
    :param end_variables: number of variables of the end.
    :param step_parameters: number of parameters of a step.
    :param common_parameters: number of parameters of the whole push.
    """

    steps: int
    step_variables: int
    end_variables: int
    step_parameters: int
    common_parameters: int

    @property
    def variables(self) -> int:
        """Number of variables of all steps and the end."""
        return self.steps * self.step_variables + self.end_variables


class _Placed(NamedTuple):
    """A block matrix at its (row, column) of the whole."""

    row: int
    column: int
    sparsity: Any


class BlockStructuredNlp:
    """
    The program: ``x`` variables, ``p`` parameters, ``rows`` and ``cost``.

    Parameters are those of the whole push, followed by those of each step.

    :param blocks: ``Blocks``.
    :param sizes: ``ProgramSizes``.
    :param layout: ``FatropLayout`` of the rows.
    :param cost: function of the variables.
    """

    def __init__(self, blocks: Blocks, sizes: ProgramSizes, layout: FatropLayout,
                 cost: Callable[[Any], Any]) -> None:
        """Join the blocks."""
        self._blocks = blocks
        self._sizes = sizes
        self._layout = layout
        self.x = ca.MX.sym('x', sizes.variables)
        self._common = ca.MX.sym('common', sizes.common_parameters)
        self._step_data = ca.MX.sym('steps', sizes.step_parameters, sizes.steps)
        self.p = ca.veccat(self._common, self._step_data)
        self.cost = cost(self.x)
        coupled = len(layout.coupling_rows)
        self._coupling = ca.DM.triplet(
            layout.coupling_rows.tolist(), layout.coupling_variables.tolist(), ca.DM.ones(coupled),
            len(layout.order), sizes.variables)
        self.rows = self._join_rows(self._call('rows', ((), (), ())))

    def derivatives(self) -> dict[str, Any]:
        """
        Build the Jacobian of the rows and the Hessian of the Lagrangian.

        :return: functions by the names that casadi's solvers look for.
        """
        evaluated = self._call('jacobian', ((), (), ()))
        jacobian = ca.Function('nlp_jac_g', [self.x, self.p], [
            self._join_rows([rows for rows, _ in evaluated]),
            self._join_jacobians([matrix for _, matrix in evaluated])],
            ['x', 'p'], ['g', 'jac_g_x'])
        factor = ca.MX.sym('lam_f')
        multipliers = ca.MX.sym('lam_g', len(self._layout.order))
        hessian = ca.Function('nlp_hess_l', [self.x, self.p, factor, multipliers],
                              self._join_lagrangians(factor, multipliers),
                              ['x', 'p', 'lam_f', 'lam_g'], ['grad_gamma_x', 'hess_gamma_x_x'])
        return {'nlp_jac_g': jacobian, 'nlp_hess_l': hessian}

    def _call(self, name: str, more: Sequence[Sequence[Any]]) -> list[Any]:
        """Evaluate a function of all blocks; ``more`` are further arguments (step, first, end)."""
        step, first, end = (getattr(block, name) for block in self._blocks)
        sizes = self._sizes
        inner = self.x[:sizes.steps * sizes.step_variables]
        first_variables = self.x[:sizes.step_variables]
        end_variables = self.x[sizes.steps * sizes.step_variables:]
        of_steps = ca.reshape(inner, sizes.step_variables, sizes.steps)
        return [step.map(sizes.steps)(of_steps, self._step_data, self._common, *more[0]),
                first(first_variables, self._step_data[:, 0], self._common, *more[1]),
                end(end_variables, self._common, *more[2])]

    def _join_rows(self, evaluated: Sequence[Any]) -> Any:
        return (ca.veccat(*evaluated)[self._layout.order.tolist()]
                + ca.mtimes(self._coupling, self.x))

    def _join_jacobians(self, matrices: Sequence[Any]) -> Any:
        step, first, end = (block.jacobian.sparsity_out(1) for block in self._blocks)
        n = self._sizes.steps
        size = self._sizes.step_variables
        placed = [_Placed(k * step.size1(), k * size, step) for k in range(n)]
        placed += [_Placed(n * step.size1(), 0, first),
                   _Placed(n * step.size1() + first.size1(), n * size, end)]
        rows, columns = _nonzeros(placed)
        coupling_rows, coupling_columns = self._coupling.sparsity().get_triplet()
        values = ca.vertcat(*[ca.MX(matrix).nz[:] for matrix in matrices],
                            ca.DM.ones(len(coupling_rows)))
        return _sparse(len(self._layout.order), self._sizes.variables,
                       np.concatenate([self._layout.position[rows], coupling_rows]),
                       np.concatenate([columns, coupling_columns]), values)

    def _join_lagrangians(self, factor: Any, multipliers: Any) -> list[Any]:
        of_blocks = self._split_multipliers(multipliers)
        (g_steps, h_steps), (g_first, h_first), (g_end, h_end) = self._call(
            'lagrangian', [(multiplier, factor) for multiplier in of_blocks])
        n = self._sizes.steps
        size = self._sizes.step_variables
        total = self._sizes.variables
        step = self._blocks.step.lagrangian.sparsity_out(1)
        end = self._blocks.end.lagrangian.sparsity_out(1)
        rows, columns = _nonzeros([_Placed(k * size, k * size, step) for k in range(n)]
                                  + [_Placed(n * size, n * size, end)])
        hessian = _sparse(total, total, rows, columns, ca.vertcat(h_steps.nz[:], h_end.nz[:]))
        hessian += ca.diagcat(h_first, ca.MX(total - size, total - size))
        gradient = ca.veccat(g_steps, g_end) + ca.mtimes(self._coupling.T, multipliers)
        gradient += ca.vertcat(g_first, ca.DM.zeros(total - size))
        return [gradient, hessian]

    def _split_multipliers(self, multipliers: Any) -> list[Any]:
        """Multipliers of the rows of each block; those of the steps a column each."""
        of_rows = multipliers[self._layout.position.tolist()]
        n = self._sizes.steps
        step, first, end = (block.row_count for block in self._blocks)
        ends = np.cumsum([0, n * step, first, end]).tolist()
        of_blocks = [of_rows[begin:end] for begin, end in zip(ends, ends[1:])]
        return [ca.reshape(of_blocks[0], step, n), *of_blocks[1:]]


def _nonzeros(placed: Sequence[_Placed]) -> tuple[IntArray, IntArray]:
    """Rows and columns of all nonzeros of placed blocks, in their order."""
    found = [np.array(block.sparsity.get_triplet(), dtype=int).reshape(2, -1)
             + [[block.row], [block.column]] for block in placed]
    rows, columns = np.concatenate(found, axis=1)
    return rows, columns


def _sparse(height: int, width: int, rows: IntArray, columns: IntArray, values: Any) -> Any:
    """Sparse matrix of values at (rows, columns)."""
    sparsity, order = ca.Sparsity.triplet(height, width, rows.tolist(), columns.tolist(), False)
    return ca.MX(sparsity, values[order])
