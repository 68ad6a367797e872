"""
The push as a nonlinear programme.

Unknowns: way S of the manoeuvre, pushing angle of each of N equal segments, node states and the
turning rates w at the Radau points. A straight run-in of given length and pushing angle follows.
Object, speed, cone, start and goal are parameters, so that a programme is built once.
"""

import functools
from typing import NamedTuple

import casadi as ca
import numpy as np

from push_planner.stage import NODE, POINTS, Constants, collocate, robot_motion, switch

RUN_IN_STEPS = 3
SMOOTHNESS = 1e-3
SHORTEST_WAY = 0.02
STEEPEST_ANGLE = 1.3
UNBOUNDED = 1e9
OPTIONS = {
    'print_time': False,
    'error_on_fail': False,
    'ipopt': {'print_level': 0, 'sb': 'yes', 'max_iter': 150, 'tol': 1e-7, 'mu_init': 1e-2,
              'acceptable_iter': 0, 'linear_solver': 'mumps'}}


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
    :param angles: pushing angles of the segments, shape (N,) [rad].
    :param nodes: states at the ends of all steps, shape (N + RUN_IN_STEPS, 5), see ``NODE``.
    :param rates: w at the Radau points, shape (N + RUN_IN_STEPS, POINTS) [1/m].
    """

    way: float
    angles: np.ndarray
    nodes: np.ndarray
    rates: np.ndarray

    def column(self):
        """Return the unknowns as one vector."""
        stages = np.column_stack([self.nodes, self.rates])
        return np.concatenate([[self.way], self.angles, stages.ravel()])

    @classmethod
    def of(cls, column, segments):
        """
        Take the unknowns from a vector.

        :param column: the vector.
        :param segments: N.
        """
        stages = column[1 + segments:].reshape(segments + RUN_IN_STEPS, len(NODE) + POINTS)
        return cls(float(column[0]), column[1:1 + segments], stages[:, :len(NODE)],
                   stages[:, len(NODE):])


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
        self._differential = drive == 'differential'
        stage, size = _stage_function(drive, supports)
        parameters = ca.MX.sym('p', size + 10)
        physics, start, goal = parameters[:size], parameters[size:size + 4], parameters[size + 4:]
        way, angles = ca.MX.sym('way'), ca.MX.sym('angles', 1, segments)
        steps = segments + RUN_IN_STEPS
        stages = ca.MX.sym('stages', len(NODE) + POINTS, steps)
        nodes, rates = stages[:len(NODE), :], stages[len(NODE):, :]
        first = ca.vertcat(start[:3], 0.0, start[3])
        before = ca.horzcat(first, nodes[:, :-1])
        run_in, last_angle = goal[4], goal[5]
        used = ca.horzcat(angles, ca.repmat(last_angle, 1, RUN_IN_STEPS))
        previous = ca.horzcat(0.0, used[:, :-1])
        moving = ca.DM([[0.0] + [1.0] * (steps - 1)])
        lengths = ca.horzcat(ca.repmat(way / segments, 1, segments),
                             ca.repmat(run_in / RUN_IN_STEPS, 1, RUN_IN_STEPS))
        end, equal, bounded = stage.map(steps)(before, previous, moving, used, lengths, rates,
                                               ca.repmat(physics, 1, steps))
        reached = nodes[[0, 1, 2, 4], -1] - goal[:4]
        kept = 4 if self._differential else 3
        constraints = ca.vertcat(ca.vec(nodes - end), ca.vec(equal), reached[:kept],
                                 ca.vec(bounded))
        self._equalities = constraints.numel() - bounded.numel()
        self._size = constraints.numel()
        unknowns = ca.vertcat(way, angles.T, ca.vec(stages))
        cost = way + SMOOTHNESS * ca.sumsqr(ca.diff(used, 1, 1))
        self._solver = ca.nlpsol('push', 'ipopt', {'x': unknowns, 'p': parameters, 'f': cost,
                                                   'g': constraints}, OPTIONS)

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
        low[0] = SHORTEST_WAY
        low[1:1 + self.segments], high[1:1 + self.segments] = -STEEPEST_ANGLE, STEEPEST_ANGLE
        upper = np.zeros(self._size)
        upper[self._equalities:] = np.inf
        parameters = np.concatenate([constants.column(), bounds, ends.start, ends.goal,
                                     [ends.run_in, ends.last_angle]])
        answer = self._solver(x0=column, p=parameters, lbx=low, ubx=high, lbg=0.0, ubg=upper)
        stats = self._solver.stats()
        found = np.array(answer['x']).ravel()
        verdict, count = stats['return_status'], int(stats['iter_count'])
        if not stats['success'] or not np.isfinite(found).all():
            return None, verdict, count
        return Solution.of(found, self.segments), verdict, count


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


def _stage_function(drive, supports):
    constants, flat = Constants.symbols(supports)
    limits = ca.SX.sym('limits', len(Bounds._fields))
    bounds = Bounds(*ca.vertsplit(limits))
    node = ca.SX.sym('node', len(NODE))
    rates = ca.SX.sym('rates', POINTS)
    before, moving, angle, length = (ca.SX.sym(name) for name in
                                     ('before', 'moving', 'angle', 'length'))
    parts = tuple(ca.vertsplit(node))
    jump, j_n, j_t = switch(constants, parts, before, angle, moving)
    end, residuals, forces = collocate(drive, constants, parts, parts[3] + jump, angle, length,
                                       ca.vertsplit(rates))
    friction = sum(support[2] for support in constants.terms.supports)
    rows = []
    for f_n, f_t in forces:
        rows += [(bounds.slope * f_n - f_t) / friction, (bounds.slope * f_n + f_t) / friction]
    # The impulse counts at the first touch only; elsewhere the row is always kept.
    scale = (1 - moving) / constants.terms.mass
    rows += [scale * (bounds.slope * j_n - j_t) + moving,
             scale * (bounds.slope * j_n + j_t) + moving]
    along, across, turn = robot_motion(drive, constants, angle, end[3])
    rows += [bounds.turn - turn, bounds.turn + turn,
             bounds.speed ** 2 - along ** 2 - across ** 2]
    rows += [end[4] - end[2] - bounds.lowest, bounds.highest - end[4] + end[2]]
    inputs = [node, before, moving, angle, length, rates, ca.vertcat(flat, limits)]
    scaled = [residual / friction for residual in residuals]
    function = ca.Function('stage', inputs,
                           [ca.vertcat(*end), ca.vertcat(*scaled), ca.vertcat(*rows)])
    return function, flat.numel() + limits.numel()
