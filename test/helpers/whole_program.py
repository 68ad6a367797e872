"""
The program of a push as casadi evaluates it: one expression, differentiated as a whole.

What the planner's own method evaluates block by block, and eliminates and recurs over, is
compared with this, row by row.
"""

from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_model.geometry import FloatArray
from push_planner.problem import PushProblem
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.collocation.formulation import formulate, Formulation
from push_planner.steered.collocation.interior_point import (
    InteriorPointMethod, Iterate, iterate_shapes, parts_of)
from push_planner.steered.collocation.newton_step import Bounds, DUAL_REGULARIZATION
from push_planner.steered.collocation.push_solver import method_bounds
from push_planner.steered.collocation.solution import Solution
from push_planner.steered.collocation.transcription import Transcription
from push_planner.steered.initial_guess.dubins_routes import routes, tightest_turns

# Largest difference that counts as rounding, over the sum of the terms of a row.
ROUNDING = 1e-7


class Values(NamedTuple):
    """
    The program at a point.

    :param equalities: c, shape (m_e,).
    :param inequalities: g, shape (m_i,).
    :param gradient: of the cost, shape (v,).
    :param equality_slopes: Jacobian of c, shape (m_e, v).
    :param inequality_slopes: Jacobian of g, shape (m_i, v).
    :param hessian: of the Lagrangian ``f + lam' c - y' g``, shape (v, v).
    :param cost: f.
    """

    equalities: FloatArray
    inequalities: FloatArray
    gradient: FloatArray
    equality_slopes: FloatArray
    inequality_slopes: FloatArray
    hessian: FloatArray
    cost: float


class Multipliers(NamedTuple):
    """
    Multipliers in the order of the rows.

    :param equalities: lam, shape (m_e,).
    :param inequalities: y, shape (m_i,).
    """

    equalities: FloatArray
    inequalities: FloatArray


class WholeProgram:
    """
    All programs of the same dimensions, simple bounds among their inequalities.

    Attributes: ``equality_names`` and ``inequality_names`` tell block and number of each row.
    """

    def __init__(self, dimensions: Dimensions) -> None:
        """Differentiate the whole program."""
        self.dimensions = dimensions
        program = Transcription(dimensions)
        x, p = (ca.SX.sym(name, symbol.numel()) for name, symbol in (('x', program.x),
                                                                     ('p', program.p)))
        bounds = ca.SX.sym('bounds', len(Bounds._fields))
        cost, rows = ca.Function('program', [program.x, program.p],
                                 [program.cost, program.rows])(x, p)
        equality = np.flatnonzero(program.equality).tolist()
        inequality = np.flatnonzero(~program.equality).tolist()
        boxes = self._boxes(x, Bounds(*ca.vertsplit(bounds)))
        equalities, inequalities = rows[equality], ca.vertcat(rows[inequality], boxes)
        self._symbols = x, p, bounds
        self._expressions = cost, equalities, inequalities
        lam, y = (ca.SX.sym(name, rows.numel()) for name, rows in (('lam', equalities),
                                                                   ('y', inequalities)))
        lagrangian = cost + ca.dot(lam, equalities) - ca.dot(y, inequalities)
        self._values = ca.Function('values', [x, p, bounds, lam, y], [
            equalities, inequalities, ca.gradient(cost, x), ca.jacobian(equalities, x),
            ca.jacobian(inequalities, x), ca.hessian(lagrangian, x)[0], cost])
        self._name_rows(program.equality)

    def _boxes(self, x: Any, bounds: Bounds) -> Any:
        """Bounds of all nodes, and those of the start, as rows."""
        rows = []
        for k in range(self.dimensions.step_count + 1):
            node = x[k * self.dimensions.step_size:]
            rows += [node[2] - bounds.low, bounds.high - node[2]]
            if self.dimensions.kind == 'rolling':
                rows += [node[3] - bounds.rotation_low, bounds.rotation_high - node[3]]
        return ca.vertcat(*rows, x[0] - bounds.free_length, x[2] - bounds.first_low,
                          bounds.first_high - x[2])

    def _name_rows(self, equality: Any) -> None:
        """Name the rows, and find where the method has their inequalities."""
        shapes = iterate_shapes(self.dimensions)
        n = self.dimensions.step_count
        nodes = self.dimensions.state_count + shapes.dual['nu'][1]
        counts = {'dynamics and moment': nodes, 'first': shapes.dual['eta'][0],
                  'end': shapes.dual['goal'][0]}
        names = [f'step {k}, equality {j}' for k in range(n) for j in range(nodes)]
        for block in ('first', 'end'):
            names += [f'{block}, equality {j}' for j in range(counts[block])]
        self.equality_names = names
        (first,), (_, step), (end,) = (shapes.slacks[name] for name in ('first', 'step', 'end'))
        own = [f'step {k}, inequality {j}' for k in range(n) for j in range(step - end)]
        own += [f'first, inequality {j}' for j in range(first - 3)]
        own += [f'step {k}, inequality {j}' for k in range(n) for j in range(step - end, step)]
        own += [f'end, inequality {j}' for j in range(end)]
        own += [f'first, inequality {j}' for j in range(first - 3, first)]
        self.inequality_names = own
        in_memory = [f'first, inequality {j}' for j in range(first)]
        in_memory += [f'step {k}, inequality {j}' for k in range(n) for j in range(step)]
        in_memory += [f'end, inequality {j}' for j in range(end)]
        # Where each row is in the memory of the method: first, steps, end.
        self.places = np.array([in_memory.index(name) for name in own])
        assert len(names) == int(equality.sum())

    def multipliers(self, dual: FloatArray) -> Multipliers:
        """Arrange the multipliers of the method; its dynamics have the opposite sign."""
        parts = parts_of(dual, iterate_shapes(self.dimensions).dual)
        of_steps = np.hstack([-parts['costates'][1:], parts['nu']])
        slacks = np.concatenate([parts[name].ravel() for name in ('first', 'step', 'end')])
        return Multipliers(np.concatenate([of_steps.ravel(), parts['eta'], parts['goal']]),
                           slacks[self.places])

    def slacks(self, primal: FloatArray) -> FloatArray:
        """Arrange the slacks of the method."""
        parts = parts_of(primal, iterate_shapes(self.dimensions).primal)
        return np.concatenate([parts[name].ravel()
                               for name in ('first', 'step', 'end')])[self.places]

    def evaluate(self, formulation: Formulation, x: FloatArray,
                 multipliers: Multipliers) -> Values:
        """Evaluate the program and its derivatives."""
        arrays = [np.array(part) for part in self._values(
            x, formulation.parameters(), method_bounds(formulation.bounds), *multipliers)]
        flat = [array.ravel() for array in arrays]
        return Values(flat[0], flat[1], flat[2], arrays[3], arrays[4], arrays[5],
                      float(flat[6][0]))

    def ipopt(self, formulation: Formulation, guess: Solution,
              barrier: float = 0.0) -> tuple[FloatArray, Multipliers]:
        """Solve the program, or that with logarithmic barriers, by ipopt: (x, multipliers)."""
        x, p, bounds = self._symbols
        cost, equalities, inequalities = self._expressions
        solver = ca.nlpsol('exact', 'ipopt', {
            'x': x, 'p': ca.vertcat(p, bounds), 'f': cost,
            'g': ca.vertcat(equalities, inequalities)}, {
                'print_time': False, 'ipopt': {
                    'print_level': 0, 'sb': 'yes', 'tol': 1e-9, 'mu_target': barrier,
                    'nlp_scaling_method': 'none', 'bound_relax_factor': 0.0, 'mu_init': 1e-2}})
        count = equalities.numel()
        upper = np.concatenate([np.zeros(count), np.full(inequalities.numel(), np.inf)])
        answer = solver(x0=guess.column(self.dimensions), p=np.concatenate([
            formulation.parameters(), method_bounds(formulation.bounds)]), lbg=0.0, ubg=upper)
        assert solver.stats()['success']
        duals = np.array(answer['lam_g']).ravel()
        return np.array(answer['x']).ravel(), Multipliers(duals[:count], -duals[count:])


def first_program(problem: PushProblem) -> tuple[Formulation, Solution]:
    """Formulate the program of the shortest route."""
    return formulate(problem, routes(problem, tightest_turns(problem))[0])


def random_iterate(formulation: Formulation, guess: Solution,
                   rng: np.random.Generator) -> Iterate:
    """Draw a point beside a guess, where no row holds, with slacks and multipliers of all rows."""
    shapes = iterate_shapes(formulation.dimensions)
    sizes = [sum(int(np.prod(shape)) for shape in part.values()) for part in shapes[:2]]
    inequalities = sum(int(np.prod(shape)) for shape in shapes.slacks.values())
    primal, dual = np.zeros(sizes[0]), 0.3 * rng.normal(size=sizes[1])
    column = guess.column(formulation.dimensions)
    primal[:len(column)] = column + 0.1 * rng.normal(size=len(column))
    primal[-inequalities:] = rng.uniform(0.05, 1.0, inequalities)
    dual[-inequalities:] = rng.uniform(0.05, 1.0, inequalities)
    return Iterate(primal, dual)


def wrong_rows(formulation: Formulation, iterate: Iterate, whole: WholeProgram,
               barrier: float = 1e-2) -> list[str]:
    """
    Take a Newton step of the planner's method; name the rows that casadi's program has otherwise.

    Inequalities are compared by value. All else by the linear equations that the step must
    fulfil: each row to first order, stationarity in each variable, and complementarity.
    """
    memory = InteriorPointMethod(formulation.dimensions)._memory
    bounds = method_bounds(formulation.bounds)
    memory.set_program(formulation.common, formulation.steps, bounds)
    memory.primal[:], memory.dual[:] = iterate
    memory.tuning[:] = barrier, 0.0
    memory.evaluate()
    memory.dual[:] = memory.dual
    rows, measures = memory._rows.copy(), memory._evaluation()
    memory._find_step()
    memory.take_step()
    x = iterate.primal[:whole.dimensions.variable_count]
    dx = memory.primal_step[:len(x)]
    duals, s = whole.multipliers(iterate.dual), whole.slacks(iterate.primal)
    d_duals, ds = whole.multipliers(memory.dual_step), whole.slacks(memory.primal_step)
    values = whole.evaluate(formulation, x, duals)
    lam, y = (old + new for old, new in zip(duals, d_duals))
    softness = np.zeros(len(lam))
    softness[[name.startswith('end') for name in whole.equality_names]] = DUAL_REGULARIZATION
    variables = [f'variable {k}' for k in range(len(x))]
    wrong = _differences(whole.inequality_names, rows[whole.places], -values.inequalities)
    wrong += _differences(whole.equality_names, values.equalities,
                          values.equality_slopes * dx, -softness * d_duals.equalities)
    wrong += _differences(whole.inequality_names, values.inequalities,
                          values.inequality_slopes * dx, -s, -ds)
    wrong += _differences(variables, values.gradient, values.hessian * dx,
                          values.equality_slopes.T * lam, -values.inequality_slopes.T * y)
    wrong += _differences(whole.inequality_names, s * y, duals.inequalities * ds,
                          np.full(len(s), -barrier))
    gap = values.inequalities - s
    stationarity = (values.gradient + values.equality_slopes.T @ duals.equalities
                    - values.inequality_slopes.T @ duals.inequalities)
    expected = (np.abs(values.equalities).sum() + np.abs(gap).sum(),
                values.cost - barrier * np.log(s).sum(),
                max(np.abs(part).max() for part in (values.equalities, gap, stationarity)),
                (s * duals.inequalities).max())
    wrong += _differences(['violation', 'merit', 'error', 'excess'], np.array(measures),
                          -np.array(expected))
    return wrong


def _differences(names: list[str], *terms: FloatArray) -> list[str]:
    """Name the rows whose terms do not add up to 0."""
    columns = np.column_stack(terms)
    off = np.abs(columns.sum(axis=1)) > ROUNDING * (1.0 + np.abs(columns).sum(axis=1))
    return [names[k] for k in np.flatnonzero(off | ~np.isfinite(columns).all(axis=1))]
