"""
Routes of the flat output, and the motions along them that the nonlinear program starts from.

A pushed object moves like a vehicle: its flat output z follows a path of arcs and straights, and
its heading that of the path. The contact covers ``1 / cos(alpha)`` times the length of z, with
alpha the steering angle of the turn.
"""

import functools
import math
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction
from push_model.dubins import DubinsPath
from push_model.geometry import FloatArray, wrap_angle
from push_planner.problem import PushProblem
from push_planner.steered.collocation.formulation import NodeGuess
from push_planner.steered.initial_guess.steady_turns import SteadyTurn
from push_planner.steered.push_parameters import contact_frames

# Largest sine of the robot's steering in the guess of a differential drive. Chosen: an arcsine of
# it exists, and the solver takes over from there.
MAX_STEERING_SINE = 0.9
# Half of an angle below which an arc is as long as its chord [rad]: rounding.
STRAIGHT = 1e-9


class Route(NamedTuple):
    """
    A path of the flat output, in the object's start frame, and the turns along it.

    :param path: ``DubinsPath`` of z, up to the final straight.
    :param turns: ``SteadyTurn`` on each segment of it.
    :param final_straight: length of the straight push after it [m].
    :param path_length: path length of the contact, final straight included [m].
    """

    path: DubinsPath
    turns: tuple[SteadyTurn, ...]
    final_straight: float
    path_length: float

    @property
    def rotation(self) -> float:
        """Angle by which the object rotates [rad]."""
        return sum(a * b for a, b in zip(self.path.lengths, self.path.curvatures))

    @property
    def name(self) -> str:
        """Letters of its segments."""
        return self.path.word

    def guess(self, problem: PushProblem, lengths: FloatArray, points: FloatArray) -> NodeGuess:
        """
        Follow the route.

        :param lengths: of the steps, summing to the path length, shape (n,) [m].
        :param points: Radau points of a step, shape (K,).
        """
        return guess_along(self, problem, lengths, points)


class _Motion(NamedTuple):
    """
    Motion along a route, in the object's start frame, at m path lengths of the contact.

    :param theta: rotation of the object, shape (m,) [rad].
    :param x: position of the object, shape (m,) [m].
    :param y: the same, shape (m,) [m].
    :param steering: steering angle, shape (m,) [rad].
    :param w: yaw rate of the object over the pushing speed, shape (m,) [1/m].
    """

    theta: FloatArray
    x: FloatArray
    y: FloatArray
    steering: FloatArray
    w: FloatArray


def guess_along(route: Route, problem: PushProblem, lengths: FloatArray,
                points: FloatArray) -> NodeGuess:
    """
    Guess the motion along a route.

    :param lengths: of the steps, summing to the path length, shape (n,) [m].
    :param points: Radau points of a step, shape (K,).
    """
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    at_points = ends[:-1, None] + lengths[:, None] * points
    # Nodes and points alike; steering and w are averages over the length of a step.
    middle = len(lengths) // 2
    everywhere = _motion_along(route, problem, np.concatenate([ends, at_points.ravel()]),
                               float(np.partition(lengths, middle)[middle]))
    motion = _Motion(*everywhere[:len(ends)].T)
    rates = everywhere[len(ends):, 4].reshape(at_points.shape)
    if problem.kind == 'rolling':
        return _rolling_guess(problem, motion, rates)
    q_x, q_y = _contact_positions(motion, problem.contact_point)
    if problem.kind == 'differential':
        gamma, rho = _differential_steering(problem, motion, lengths)
        phi = gamma - gamma[0]
    else:
        phi = motion.theta
        rho = _next_to_zero(motion.steering + (problem.vehicle.angle - problem.start_normal))
    return NodeGuess(np.array([motion.w, rho, motion.theta, q_x, q_y, phi]).T, rates)


def _rolling_guess(problem: PushProblem, motion: _Motion, rates: FloatArray) -> NodeGuess:
    """Guess of a robot that does not rotate; its centre is the followed point."""
    theta = motion.theta
    phi = np.zeros(len(theta))
    delta, c_x, c_y = contact_frames(problem.push_parameters, theta, phi)
    gamma = theta + delta
    f_x, f_y = problem.friction_center
    psi = theta + np.unwrap(np.arctan2(f_y - c_y, f_x - c_x))
    q_x, q_y = _contact_positions(motion, (c_x, c_y))
    q_x = q_x - problem.robot.radius * np.cos(gamma)
    q_y = q_y - problem.robot.radius * np.sin(gamma)
    rho = _next_to_zero(motion.steering + psi - gamma)
    return NodeGuess(np.array([motion.w, rho, theta, q_x, q_y, phi]).T, rates)


def _differential_steering(problem: PushProblem, motion: _Motion,
                           lengths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """
    Let a differential drive's heading settle on the direction of the push, over its radius.

    :return: normals and pushing angles at the nodes, shape (n + 1,) each [rad].
    """
    direction = motion.theta + problem.vehicle.angle + motion.steering
    lever = problem.robot.radius * math.cos(problem.heading_offset)
    first, start = float(direction[0]), problem.start_normal
    gammas = [first + wrap_angle(start - first)]
    angles: list[float] = []
    targets = 0.5 * (direction[1:] + direction[:-1]) + problem.heading_offset
    for target, length in zip(targets.tolist(), lengths.tolist()):
        change = (target - gammas[-1]) * (1.0 - math.exp(-length / lever))
        sine = max(-MAX_STEERING_SINE, min(MAX_STEERING_SINE, change * lever / length))
        angles.append(math.asin(sine) - problem.heading_offset)
        gammas.append(gammas[-1] + change)
    rho = np.array([angles[0], *(0.5 * (a + b) for a, b in zip(angles, angles[1:])), angles[-1]])
    return np.array(gammas), rho


def _contact_positions(motion: _Motion,
                       contact: tuple[Any, Any]) -> tuple[FloatArray, FloatArray]:
    c_x, c_y = contact
    c, s = np.cos(motion.theta), np.sin(motion.theta)
    return motion.x + c * c_x - s * c_y, motion.y + s * c_x + c * c_y


def _next_to_zero(angles: FloatArray) -> FloatArray:
    """Shift angles by full turns so that the first is next to 0 [rad]."""
    return angles - 2.0 * math.pi * round(float(angles[0]) / (2.0 * math.pi))


def _motion_along(route: Route, problem: PushProblem, s: FloatArray, width: float) -> FloatArray:
    """Columns of ``_Motion`` at path lengths s of the contact, averaged over a width [m]."""
    vehicle, path = problem.vehicle, route.path
    cosines = [math.cos(turn.steering_angle) for turn in route.turns]
    segments = [(length / cosine, cosine, curvature, turn.steering_angle, turn.w)
                for length, cosine, curvature, turn in zip(path.lengths, cosines,
                                                           path.curvatures, route.turns)]
    segments.append((route.final_straight, 1.0, 0.0, 0.0, 0.0))
    motion, = _follow_route(len(segments))({
        's': s[:, None], 'width': np.array([width]), 'segments': np.array(segments).ravel(),
        'start': np.array(path.start, dtype=float),
        'vehicle': np.array([vehicle.angle, *vehicle.flat_output])})
    return motion


@functools.lru_cache(maxsize=8)
def _follow_route(count: int) -> RowFunction:
    """
    Build the motion along a route of some segments.

    A segment has five numbers: length of the contact's path, and that of z over it, curvature of
    the path of z, steering angle and w.
    """
    s, width = ca.SX.sym('s'), ca.SX.sym('width')
    segments, vehicle = ca.SX.sym('segments', 5, count), ca.SX.sym('vehicle', 3)
    start = ca.SX.sym('start', 3)
    total = ca.sum2(segments[0, :])
    low = ca.fmin(ca.fmax(s - 0.5 * width, 0.0), total)
    high = ca.fmin(ca.fmax(s + 0.5 * width, 0.0), total)
    x, y, heading = ca.vertsplit(start)
    before, steering, w = ca.SX(0.0), ca.SX(0.0), ca.SX(0.0)
    for i in range(count):
        length, ratio, curvature, angle, rate = ca.vertsplit(segments[:, i])
        # What lies beyond the last segment goes on as that.
        along = ratio * _covered(s, before, length if i < count - 1 else ca.inf)
        half = 0.5 * along * curvature
        chord = along * ca.if_else(ca.fabs(half) > STRAIGHT, ca.sin(half) / half, 1.0)
        x += chord * ca.cos(heading + half)
        y += chord * ca.sin(heading + half)
        heading += 2.0 * half
        within = _covered(high, before, length) - _covered(low, before, length)
        steering += angle * within
        w += rate * within
        before += length
    theta = heading - vehicle[0]
    c, d = ca.cos(theta), ca.sin(theta)
    motion = ca.vertcat(theta, x - c * vehicle[1] + d * vehicle[2],
                        y - d * vehicle[1] - c * vehicle[2],
                        steering / (high - low), w / (high - low))
    inputs = {'s': s, 'width': width, 'segments': segments, 'start': start, 'vehicle': vehicle}
    return RowFunction(ca.Function('follow_route', list(inputs.values()), [ca.cse(motion)],
                                   list(inputs), ['motion']), is_independent=True)


def _covered(s: Any, before: Any, length: Any) -> Any:
    """Part of a segment that lies before s."""
    return ca.fmin(ca.fmax(s - before, 0.0), length)
