"""
The push as a nonlinear programme.

Unknowns: way S of the manoeuvre, pushing angle of each of N equal segments, node states and the
turning rates w at the Radau points. A straight run-in of given length and pushing angle follows.
One more unknown, the excess, widens all bounds at a price: where no push exists the programme
still converges, and tells how far the bounds would have to give way.
Object, speed, cone, start and goal are parameters, so that a programme is built once.
"""

import functools

import casadi as ca
import numpy as np

from push_planner.iterate import RUN_IN_STEPS, Solution
from push_planner.stage import NODE, POINTS
from push_planner.stage_functions import EQUALITIES, ROWS, StageFunctions

SMOOTHNESS = 1e-3
PENALTY = 100.0
NEGLIGIBLE = 1e-5
SHORTEST_WAY = 0.02
STEEPEST_ANGLE = 1.3
OPTIONS = {
    'print_time': False,
    'error_on_fail': False,
    'ipopt': {'print_level': 0, 'sb': 'yes', 'max_iter': 50, 'tol': 1e-7, 'mu_init': 1e-2,
              'acceptable_iter': 0, 'linear_solver': 'mumps'}}


class Programme:
    """
    The programme for one drive, number of supports and number of segments.

    :param drive: the robot's drive.
    :param supports: number of supports of the object.
    :param segments: N.
    """

    def __init__(self, drive, supports, segments):
        """Build the programme."""
        self.segments = segments
        stage = StageFunctions(drive, supports)
        steps = segments + RUN_IN_STEPS
        self._rows = stage.rows
        self._end_conditions = 4 if drive == 'differential' else 3
        x = ca.MX.sym('x', 2 + segments + EQUALITIES * steps)
        p = ca.MX.sym('p', stage.parameters + 10)
        start, goal = p[-10:-6], p[-6:]
        way, excess, angles = x[0], x[1], x[2:2 + segments].T
        stages = ca.reshape(x[2 + segments:], EQUALITIES, steps)
        nodes, rates = stages[:len(NODE), :], stages[len(NODE):, :]
        first = ca.vertcat(start[:3], 0.0, start[3])
        used = ca.horzcat(angles, ca.repmat(goal[5], 1, RUN_IN_STEPS))
        lengths = ca.horzcat(ca.repmat(way / segments, 1, segments),
                             ca.repmat(goal[4] / RUN_IN_STEPS, 1, RUN_IN_STEPS))
        inputs = ca.vertcat(ca.horzcat(first, nodes[:, :-1]),
                            ca.horzcat(0.0, used[:, :-1]), used, lengths, rates)
        kept = ca.vertcat(nodes, ca.MX.zeros(POINTS, steps),
                          ca.repmat(excess, stage.rows - EQUALITIES, steps))
        reached = (nodes[[0, 1, 2, 4], -1] - goal[:4])[:self._end_conditions]
        cost = way + PENALTY * excess + SMOOTHNESS * ca.sumsqr(ca.diff(used, 1, 1))
        self._upper = np.tile(np.repeat([0.0, np.inf], [EQUALITIES, stage.rows - EQUALITIES]),
                              steps)
        self._upper = np.append(self._upper, np.zeros(self._end_conditions))
        nlp, exact = _assemble(stage, steps, x, p, inputs, kept, reached, cost)
        self._solver = ca.nlpsol('push', 'ipopt', nlp, {**OPTIONS, **exact})

    def solve(self, constants, bounds, ends, guess):
        """
        Solve the programme.

        :param constants: ``Constants`` of the push.
        :param bounds: ``Bounds``.
        :param ends: ``Ends``.
        :param guess: ``Solution`` to start from.
        :return: (``Solution`` or None, the solver's own verdict, iterations).
        """
        column = guess.column()
        low, high = np.full(column.size, -np.inf), np.full(column.size, np.inf)
        low[:2] = SHORTEST_WAY, 0.0
        angles = slice(2, 2 + self.segments)
        low[angles], high[angles] = -STEEPEST_ANGLE, STEEPEST_ANGLE
        parameters = np.concatenate([constants.column(), bounds, ends.start, ends.goal,
                                     [ends.run_in, ends.last_angle]])
        answer = self._solver(x0=column, p=parameters, lbx=low, ubx=high, lbg=0.0,
                              ubg=self._upper)
        stats = self._solver.stats()
        found = np.array(answer['x']).ravel()
        verdict, count = stats['return_status'], int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(found).all():
            return None, verdict, count
        solution = Solution.of(found, self.segments)
        if solution.excess > NEGLIGIBLE:
            return None, self._culprit(np.array(answer['lam_g']), solution.excess), count
        return solution, verdict, count

    def _culprit(self, multipliers, excess):
        prices = multipliers[:multipliers.size - self._end_conditions].reshape(-1, self._rows)
        worst = np.abs(prices[:, EQUALITIES:]).max(axis=0).argmax()
        return f'{ROWS[min(worst, len(ROWS) - 1)]} would be exceeded by {excess:.2g}'


@functools.lru_cache(maxsize=16)
def programme(drive, supports, segments):
    """
    Build a programme, or take it from earlier.

    :param drive: the robot's drive.
    :param supports: number of supports.
    :param segments: N.
    :return: ``Programme``.
    """
    return Programme(drive, supports, segments)


def _assemble(stage, steps, x, p, inputs, kept, reached, cost):
    """Chain the stages' derivatives: far cheaper than differentiating the whole programme."""
    moving = ca.DM([[0.0] + [1.0] * (steps - 1)])
    given = (inputs, moving, ca.repmat(p[:stage.parameters], 1, steps))
    size = stage.rows * steps
    chain = ca.evalf(ca.jacobian(ca.vec(inputs), x))
    linear = ca.evalf(ca.jacobian(ca.vertcat(ca.vec(kept), reached), x))
    fixed = ca.evalf(ca.hessian(cost, x)[0])
    value = ca.vertcat(ca.vec(kept + stage.value.map(steps)(*given)), reached)
    out, slopes = stage.slope.map(steps)(*given)
    rows = ca.vertcat(ca.mtimes(_diagonal(slopes, stage.rows, stage.width, steps), chain),
                      ca.MX(reached.numel(), x.numel()))
    again = ca.vertcat(ca.vec(kept + out), reached)
    lam_f, lam_g = ca.MX.sym('lam_f'), ca.MX.sym('lam_g', size + reached.numel())
    bends = stage.bend.map(steps)(*given, ca.reshape(lam_g[:size], stage.rows, steps))
    bend = ca.mtimes([chain.T, _diagonal(bends, stage.width, stage.width, steps), chain])
    exact = {'jac_g': ca.Function('jac_g', [x, p], [again, rows + linear]),
             'hess_lag': ca.Function('hess_lag', [x, p, lam_f, lam_g],
                                     [ca.triu(bend + lam_f * fixed)])}
    return {'x': x, 'p': p, 'f': cost, 'g': value}, exact


def _diagonal(blocks, rows, columns, count):
    """Set dense blocks, side by side, on the diagonal."""
    pattern = ca.diagcat(*[ca.Sparsity.dense(rows, columns)] * count)
    return ca.MX(pattern, ca.vec(blocks))
