"""
Routes of the flat output, and the motions along them that the nonlinear program starts from.

A pushed object moves like a vehicle: its flat output z follows a path of arcs and straights, and
its heading that of the path. The contact covers ``1 / cos(alpha)`` times the length of z, with
alpha the steering angle of the turn.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from push_model.dubins import advance_along_arc, DubinsPath
from push_model.geometry import FloatArray, wrap_angle
from push_planner.collocation.formulation import NodeGuess
from push_planner.initial_guess.steady_turns import SteadyTurn
from push_planner.problem import PushProblem
from push_planner.push_parameters import contact_frames

# Largest sine of the robot's steering in the guess of a differential drive. Chosen: an arcsine of
# it exists, and the solver takes over from there.
MAX_STEERING_SINE = 0.9
# Length that stands for a final straight of none [m]: the arcs before it need an end.
NO_LENGTH = 1e-9


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

        :param problem: the ``PushProblem``.
        :param lengths: of the steps, summing to the path length, shape (n,) [m].
        :param points: Radau points of a step, shape (K,).
        """
        return guess_along(self, problem, lengths, points)


class _ObjectPoses(NamedTuple):
    """Rotations [rad] and positions [m] of the object in its start frame, shape (n,) each."""

    theta: FloatArray
    x: FloatArray
    y: FloatArray


def guess_along(route: Route, problem: PushProblem, lengths: FloatArray,
                points: FloatArray) -> NodeGuess:
    """
    Guess the motion along a route.

    :param route: the ``Route``.
    :param problem: the ``PushProblem``.
    :param lengths: of the steps, summing to the path length, shape (n,) [m].
    :param points: Radau points of a step, shape (K,).
    """
    course = _Course(problem, route)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    poses = course.poses_at(ends)
    width = float(np.median(lengths))
    steering, w = course.averaged(ends, width)
    rates = course.averaged(ends[:-1, None] + lengths[:, None] * points, width)[1]
    if problem.kind == 'differential':
        gamma, rho = _differential_steering(problem, poses.theta, steering, lengths)
        q_x, q_y = _contact_positions(poses, problem.contact_point)
        return NodeGuess(np.column_stack([w, rho, poses.theta, q_x, q_y, gamma - gamma[0]]), rates)
    if problem.kind == 'rolling':
        return _rolling_guess(problem, poses, steering, w, rates)
    gamma = poses.theta + problem.start_normal
    q_x, q_y = _contact_positions(poses, problem.contact_point)
    rho = _next_to_zero(steering + (poses.theta + problem.vehicle.angle) - gamma)
    return NodeGuess(np.column_stack([w, rho, poses.theta, q_x, q_y, poses.theta]), rates)


def _rolling_guess(problem: PushProblem, poses: _ObjectPoses, steering: FloatArray, w: FloatArray,
                   rates: FloatArray) -> NodeGuess:
    """Guess of a robot that does not rotate; its centre is the followed point."""
    theta = poses.theta
    phi = np.zeros(len(theta))
    delta, c_x, c_y = contact_frames(problem.push_parameters, theta, phi)
    gamma = theta + delta
    f_x, f_y = problem.friction_center
    psi = theta + np.unwrap(np.arctan2(f_y - c_y, f_x - c_x))
    q_x, q_y = _contact_positions(poses, (c_x, c_y))
    q_x = q_x - problem.robot.radius * np.cos(gamma)
    q_y = q_y - problem.robot.radius * np.sin(gamma)
    rho = _next_to_zero(steering + psi - gamma)
    return NodeGuess(np.column_stack([w, rho, theta, q_x, q_y, phi]), rates)


def _differential_steering(problem: PushProblem, theta: FloatArray, steering: FloatArray,
                           lengths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """
    Let a differential drive's heading settle on the direction of the push, over its radius.

    :return: normals and pushing angles at the nodes, shape (n + 1,) each [rad].
    """
    direction = theta + problem.vehicle.angle + steering
    reach = problem.robot.radius * math.cos(problem.heading_offset)
    start = problem.start_normal
    gammas = [direction[0] + wrap_angle(start - direction[0])]
    angles: list[float] = []
    for target, length in zip(0.5 * (direction[1:] + direction[:-1]), lengths):
        change = (target - gammas[-1] + problem.heading_offset) * (
            1.0 - math.exp(-length / reach))
        sine = max(-MAX_STEERING_SINE, min(MAX_STEERING_SINE, change * reach / length))
        angles.append(math.asin(sine) - problem.heading_offset)
        gammas.append(gammas[-1] + change)
    rho = np.array([angles[0], *(0.5 * (a + b) for a, b in zip(angles, angles[1:])), angles[-1]])
    return np.array(gammas), rho


def _contact_positions(poses: _ObjectPoses,
                       contact: tuple[Any, Any]) -> tuple[FloatArray, FloatArray]:
    c_x, c_y = contact
    c, s = np.cos(poses.theta), np.sin(poses.theta)
    return poses.x + c * c_x - s * c_y, poses.y + s * c_x + c * c_y


def _next_to_zero(angles: FloatArray) -> FloatArray:
    """Shift angles by full turns so that the first is next to 0 [rad]."""
    angles += 2.0 * math.pi * np.round(-angles[0] / (2.0 * math.pi))
    return angles


class _Course:
    """A route as functions of the path length s of the contact."""

    def __init__(self, problem: PushProblem, route: Route) -> None:
        self._vehicle = problem.vehicle
        path = route.path
        # Path length of the contact over that of z, on each segment; the last is straight.
        self._factors = np.array([1.0 / math.cos(turn.steering_angle) for turn in route.turns]
                                 + [1.0])
        lengths = [*path.lengths, max(route.final_straight, NO_LENGTH)]
        self._ends = np.concatenate([[0.0], np.cumsum(np.multiply(lengths, self._factors))])
        self._steering = np.array([turn.steering_angle for turn in route.turns] + [0.0])
        self._rates = np.array([turn.w for turn in route.turns] + [0.0])
        self._curvatures = np.array([*path.curvatures, 0.0])
        poses = []
        pose = path.start
        for length, curvature in zip(lengths, self._curvatures):
            poses.append(pose)
            pose = advance_along_arc(pose, length, float(curvature))
        self._begins = np.array(poses)

    def poses_at(self, s: FloatArray) -> _ObjectPoses:
        """Poses of the object at path lengths of shape (n,)."""
        segment = np.clip(np.searchsorted(self._ends, s, side='right') - 1, 0,
                          len(self._steering) - 1)
        along = (s - self._ends[segment]) / self._factors[segment]
        half = 0.5 * along * self._curvatures[segment]
        chord = along * np.sinc(half / math.pi)
        x, y, heading = self._begins[segment].T
        z_x, z_y = x + chord * np.cos(heading + half), y + chord * np.sin(heading + half)
        theta = heading + 2.0 * half - self._vehicle.angle
        f_x, f_y = self._vehicle.flat_output
        return _ObjectPoses(theta, z_x - np.cos(theta) * f_x + np.sin(theta) * f_y,
                            z_y - np.sin(theta) * f_x - np.cos(theta) * f_y)

    def averaged(self, s: FloatArray, width: float) -> tuple[FloatArray, FloatArray]:
        """Steering angles [rad] and w [1/m] at path lengths, averaged over a width [m]."""
        return self._mean(self._steering, s, width), self._mean(self._rates, s, width)

    def _mean(self, values: FloatArray, s: FloatArray, width: float) -> FloatArray:
        integral = np.concatenate([[0.0], np.cumsum(values * np.diff(self._ends))])
        begin = np.clip(s - 0.5 * width, 0.0, self._ends[-1])
        end = np.clip(s + 0.5 * width, 0.0, self._ends[-1])
        return (np.interp(end, self._ends, integral)
                - np.interp(begin, self._ends, integral)) / (end - begin)
