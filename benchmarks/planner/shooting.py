"""
Planning as in the thesis: single shooting, finite differences, a general optimiser.

Unknowns are the path length of the contact and the pushing angles, each constant over an equal
part of it; scipy integrates the push at every iterate. Only for robots that rotate with the
object.
"""

import functools
import math
import time
from typing import Any, NamedTuple

from benchmarks.planner.check import Push
from benchmarks.planner.goals import HEADING_TOLERANCE, POSITION_TOLERANCE
import numpy as np
from push_model.dubins import dubins_paths
from push_model.dynamics import impulse, State
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_planner.problem import PushProblem
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

SAMPLES = 48
ACCURACY, DIFFERENCE = 1e-8, 1e-6
STEPS, KEPT = 100, 64
CONE_TOLERANCE = 1e-3


class Shot(NamedTuple):
    """
    Result of single shooting.

    :param solved: whether the push reaches the goal within the cone.
    :param path_length: of the contact [m].
    :param cpu: CPU time [s].
    :param verdict: message of the optimiser.
    """

    solved: bool
    path_length: float
    cpu: float
    verdict: str


def dubins_guess(problem: PushProblem, segments: int) -> FloatArray:
    """
    Guess from the shortest Dubins path of the flat output that the cone allows.

    :param problem: the ``PushProblem``.
    :param segments: number of segments.
    :return: path length of the contact [m], followed by the pushing angles [rad].
    """
    vehicle, beta, zeta = problem.vehicle, problem.planning_cone_angle, problem.normal_offset
    ahead = vehicle.c_squared / vehicle.arm
    local = Pose(vehicle.flat_output[0], vehicle.flat_output[1], vehicle.angle)
    path = min((math.hypot(1.0, vehicle.wheelbase * max(map(abs, path.curvatures))) * path.length,
                i, path) for i, path in enumerate(dubins_paths(
                    problem.start @ local, problem.goal @ local, ahead / (beta - zeta),
                    ahead / (beta + zeta))))[2]
    stretched = [length * math.hypot(1.0, vehicle.wheelbase * curvature)
                 for length, curvature in zip(path.lengths, path.curvatures)]
    ends = np.cumsum(stretched)
    middles = (np.arange(10 * segments) + 0.5) * ends[-1] / (10 * segments)
    curvatures = np.array(path.curvatures)[np.minimum(np.searchsorted(ends, middles), 2)]
    steering = -np.arctan(vehicle.wheelbase * curvatures) - zeta
    return np.concatenate([[ends[-1]], steering.reshape(segments, 10).mean(axis=1)])


class Shooting:
    """
    The push as a function of the unknowns; the last pushes are kept.

    :param problem: the ``PushProblem``.
    """

    def __init__(self, problem: PushProblem) -> None:
        """Build the equation of motion."""
        self.problem, self._push = problem, Push(problem)
        self._known = functools.lru_cache(KEPT)(self._integrate)
        self._weight = problem.obj.mass
        self._friction = sum(problem.obj.capacities)

    def end(self, unknowns: FloatArray) -> FloatArray:
        """Return the errors at the goal: x, y [m], heading [rad]."""
        return self._shoot(unknowns)[0]

    def reserve(self, unknowns: FloatArray) -> FloatArray:
        """Return the rows of the planning cone, of impulse and forces; at least 0 inside."""
        return self._shoot(unknowns)[1]

    def _shoot(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        # Differences of both constraints ask for the same pushes.
        return self._known(tuple(unknowns.tolist()))

    def _integrate(self, unknowns: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
        problem, push = self.problem, self._push
        speed, slope = problem.settings.pushing_speed, math.tan(problem.planning_cone_angle)
        count = len(unknowns) - 1
        duration = max(unknowns[0], 1e-3) / speed / count
        samples = np.linspace(0.0, duration, SAMPLES // count + 1)
        state = np.array([*problem.start, 0.0, problem.normal, *problem.contact_point,
                          problem.heading])
        pulls, before = [self._impulse(state, unknowns[1])], (0.0, 0.0)
        for angle in unknowns[1:]:
            state = push.jump(state, before, (speed, angle))
            push.steer(0.0, (speed, speed), (angle, angle), duration)
            answer = solve_ivp(push.rate, (0.0, duration), state, method='LSODA', rtol=ACCURACY,
                               atol=ACCURACY, t_eval=samples)
            pulls += [push.force(t, y) / self._friction
                      for t, y in zip(answer.t[1:], answer.y.T[1:])]
            state, before = answer.y[:, -1], (speed, angle)
        along, across = np.array(pulls).T
        goal = problem.goal
        return (np.array([state[0] - goal.x, state[1] - goal.y,
                          wrap_angle(state[2] - goal.theta)]),
                np.concatenate([slope * along - across, slope * along + across]))

    def _impulse(self, state: FloatArray, angle: float) -> FloatArray:
        _, *pull = impulse(self._push.terms, State(*state[:7]), math.cos(state[4] + angle),
                           math.sin(state[4] + angle))
        return np.array([float(value) for value in pull]) / self._weight


def shoot(problem: PushProblem, segments: int = 6) -> Shot:
    """
    Plan by single shooting.

    :param problem: the ``PushProblem``; holonomic drive.
    :param segments: number of segments.
    :return: ``Shot``.
    """
    began = time.process_time()
    shooting = Shooting(problem)
    guess = dubins_guess(problem, segments)
    answer: Any
    answer = minimize(lambda unknowns: unknowns[0], guess, method='SLSQP', jac='2-point',
                      bounds=[(0.02, None)] + [(-1.3, 1.3)] * (len(guess) - 1),
                      constraints=[{'type': 'eq', 'fun': shooting.end},
                                   {'type': 'ineq', 'fun': shooting.reserve}],
                      options={'maxiter': STEPS, 'ftol': 1e-5, 'eps': DIFFERENCE})
    cpu = time.process_time() - began
    x, y, turn = shooting.end(answer.x)
    missed = math.hypot(x, y)
    reached = missed <= POSITION_TOLERANCE and abs(turn) <= HEADING_TOLERANCE
    kept = bool(shooting.reserve(answer.x).min() >= -CONE_TOLERANCE)
    return Shot(bool(reached and kept), float(answer.x[0]), cpu, answer.message)
