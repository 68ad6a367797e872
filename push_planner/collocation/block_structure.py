"""
Equations of equal stages joined to one programme, with the derivatives that solvers ask for.

Every stage is evaluated by the same small function: a fraction of the time and of the building
that one expression of all stages takes.
"""

from typing import NamedTuple

import casadi as ca
import numpy as np


class Block(NamedTuple):
    """
    Rows on some unknowns, and a cost on them.

    :param rows: function (unknowns, given...) -> rows.
    :param jacobian: function of the same -> (rows, their Jacobian).
    :param lagrange: function (unknowns, given..., multipliers, factor of the cost) -> (gradient,
        Hessian) of the Lagrangian.
    """

    rows: ca.Function
    jacobian: ca.Function
    lagrange: ca.Function

    @classmethod
    def of(cls, unknowns, given, rows, cost):
        """
        Differentiate rows and cost.

        :param unknowns: column of symbols.
        :param given: list of columns of symbols.
        :param rows: column of expressions.
        :param cost: expression.
        """
        rows, prices, factor = ca.cse(rows), ca.SX.sym('prices', rows.numel()), ca.SX.sym('factor')
        hessian, gradient = ca.hessian(ca.dot(prices, rows) + factor * cost, unknowns)
        known = [unknowns, *given]
        return cls(ca.Function('rows', known, [rows]),
                   ca.Function('jacobian', known, ca.cse([rows, ca.jacobian(rows, unknowns)])),
                   ca.Function('lagrange', [*known, prices, factor],
                               ca.cse([ca.densify(gradient), hessian])))


class BlockStructuredNlp:
    """
    The programme of n stages; unknowns are theirs in order, followed by those of the end.

    :param parts: ``Block`` of (a stage, the first stage besides, the end); stages are given their
        numbers and the common ones, the end the common ones only.
    :param sizes: number of (stages, unknowns of a stage, unknowns of the end, given of a stage,
        common numbers).
    :param order: for each row of the programme its index among those of all stages, of the first
        and of the end.
    :param following: (row of the programme, unknown) where an unknown is added to a row.
    :param cost: function of the unknowns.
    """

    def __init__(self, parts, sizes, order, following, cost):
        """Join the parts."""
        self._parts, self._sizes = parts, sizes
        self._order, self._place = order, np.argsort(order)
        count, width, end, given, common = sizes
        self.x = ca.MX.sym('x', count * width + end)
        self.common = ca.MX.sym('common', common)
        self.grid = ca.MX.sym('grid', given, count)
        self.p = ca.veccat(self.common, self.grid)
        self.cost = cost(self.x)
        self._first, self._last = self.x[:width], self.x[count * width:]
        self._given = (ca.reshape(self.x[:count * width], width, count), self.grid, self.common)
        rows, columns = following
        self._after = ca.DM.triplet(rows.tolist(), columns.tolist(), ca.DM.ones(len(rows)),
                                    len(order), self.x.numel())
        self.rows = self._rows(self._call('rows'))

    def derivatives(self):
        """
        Build the Jacobian of the rows and the Hessian of the Lagrangian.

        :return: dict of functions by the names that casadi's solvers look for.
        """
        called = self._call('jacobian')
        jacobian = ca.Function('nlp_jac_g', [self.x, self.p], [
            self._rows([rows for rows, _ in called]),
            self._jacobian([matrix for _, matrix in called])],
            ['x', 'p'], ['g', 'jac_g_x'])
        factor, prices = ca.MX.sym('lam_f'), ca.MX.sym('lam_g', len(self._order))
        hessian = ca.Function('nlp_hess_l', [self.x, self.p, factor, prices],
                              self._lagrange(factor, prices), ['x', 'p', 'lam_f', 'lam_g'],
                              ['grad_gamma_x', 'hess_gamma_x_x'])
        return {'nlp_jac_g': jacobian, 'nlp_hess_l': hessian}

    def _call(self, name, *more):
        """Evaluate all parts; ``more`` are further arguments (of the stages, first, end)."""
        stage, first, last = (getattr(part, name) for part in self._parts)
        begun = (self._first, self.grid[:, 0], self.common)
        more = more or ((), (), ())
        return [stage.map(self._sizes[0])(*self._given, *more[0]), first(*begun, *more[1]),
                last(self._last, self.common, *more[2])]

    def _rows(self, called):
        return ca.veccat(*called)[self._order.tolist()] + ca.mtimes(self._after, self.x)

    def _jacobian(self, matrices):
        count, width, *_ = self._sizes
        stage, first, last = (part.jacobian.sparsity_out(1) for part in self._parts)
        blocks = [(k * stage.size1(), k * width, stage) for k in range(count)]
        blocks += [(count * stage.size1(), 0, first),
                   (count * stage.size1() + first.size1(), count * width, last)]
        rows, columns = _triplets(blocks)
        after = self._after.sparsity().get_triplet()
        values = ca.vertcat(*[ca.MX(matrix).nz[:] for matrix in matrices],
                            ca.DM.ones(len(after[0])))
        return _filled(len(self._order), self.x.numel(),
                       np.concatenate([self._place[rows], after[0]]),
                       np.concatenate([columns, after[1]]), values)

    def _lagrange(self, factor, prices):
        count, width, *_ = self._sizes
        sorted_ = prices[self._place.tolist()]
        sizes = [part.rows.size1_out(0) for part in self._parts]
        ends = np.cumsum([0, count * sizes[0], *sizes[1:]]).tolist()
        shares = [sorted_[begin:end] for begin, end in zip(ends, ends[1:])]
        shares[0] = ca.reshape(shares[0], sizes[0], count)
        (g_all, h_all), (g_first, h_first), (g_last, h_last) = self._call(
            'lagrange', *[(share, factor) for share in shares])
        total, stage, last = self.x.numel(), *(self._parts[i].lagrange.sparsity_out(1)
                                               for i in (0, 2))
        rows, columns = _triplets([(k * width, k * width, stage) for k in range(count)]
                                  + [(count * width, count * width, last)])
        hessian = _filled(total, total, rows, columns, ca.vertcat(h_all.nz[:], h_last.nz[:]))
        hessian += ca.diagcat(h_first, ca.MX(total - width, total - width))
        gradient = ca.veccat(g_all, g_last) + ca.mtimes(self._after.T, prices)
        gradient += ca.vertcat(g_first, ca.DM.zeros(total - width))
        return [gradient, hessian]


def _triplets(blocks):
    """Rows and columns of all nonzeros of blocks (row, column, sparsity), in their order."""
    found = [np.array(sparsity.get_triplet(), dtype=int).reshape(2, -1) + [[row], [column]]
             for row, column, sparsity in blocks]
    return np.concatenate(found, axis=1)


def _filled(height, width, rows, columns, values):
    sparsity, order = ca.Sparsity.triplet(height, width, rows.tolist(), columns.tolist(), False)
    return ca.MX(sparsity, values[order])
