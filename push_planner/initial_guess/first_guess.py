"""A route of the flat point as an iterate of the programme."""

import math
from typing import NamedTuple

import numpy as np
from push_model.dubins import advance_along_arc
from push_model.geometry import wrap_angle
from push_planner.push_parameters import places


class Guess(NamedTuple):
    """
    First guess, in the object's start frame.

    :param nodes: (w, rho, theta, q_x, q_y, phi) at the nodes, shape (n + 1, 6).
    :param rates: w at the Radau points, shape (n, K).
    """

    nodes: np.ndarray
    rates: np.ndarray


def guess(problem, route, lengths, points):
    """
    Follow a route.

    :param problem: the ``PushProblem``.
    :param route: the ``Route``.
    :param lengths: of the steps, summing to the cost of the route, shape (n,) [m].
    :param points: places of the Radau points in a step, shape (K,).
    :return: ``Guess``.
    """
    course = _Course(problem, route)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    theta, x, y = course.at(ends)
    steering_angle, w = course.smooth(ends, np.median(lengths))
    rates = course.smooth(ends[:-1, None] + lengths[:, None] * points, np.median(lengths))[1]
    gamma = theta + problem.start_normal
    if problem.kind == 'differential':
        return _followed(problem, theta, x, y, steering_angle, w, lengths, rates)
    psi = theta + problem.vehicle.angle
    c_x, c_y = problem.contact_point
    phi = theta
    if problem.kind == 'rolling':
        phi = np.zeros(len(theta))
        delta, c_x, c_y = places(problem.push_parameters, theta, phi)
        gamma = theta + delta
        f_x, f_y = problem.friction_center
        psi = theta + np.unwrap(np.arctan2(f_y - c_y, f_x - c_x))
    q_x, q_y = x + np.cos(theta) * c_x - np.sin(theta) * c_y, y + np.sin(
        theta) * c_x + np.cos(theta) * c_y
    if problem.kind == 'rolling':
        q_x = q_x - problem.robot.radius * np.cos(gamma)
        q_y = q_y - problem.robot.radius * np.sin(gamma)
    rho = steering_angle + psi - gamma
    rho += 2.0 * math.pi * np.round(-rho[0] / (2.0 * math.pi))
    return Guess(np.column_stack([w, rho, theta, q_x, q_y, phi]), rates)


class _Course:
    """A route as functions of the way of the contact."""

    def __init__(self, problem, route):
        self.vehicle, path = problem.vehicle, route.path
        factors = [1.0 / math.cos(turn.steering_angle) for turn in route.turns] + [1.0]
        lengths = [*path.lengths, max(route.final_straight, 1e-9)]
        self.ways = np.concatenate([[0.0], np.cumsum(np.multiply(lengths, factors))])
        self.steers = np.array([turn.steering_angle for turn in route.turns] + [0.0])
        self.rates = np.array([turn.w for turn in route.turns] + [0.0])
        self.factors, self.curvatures = np.array(factors), np.array([*path.curvatures, 0.0])
        poses, pose = [], path.start
        for length, curvature in zip(lengths, self.curvatures):
            poses.append(pose)
            pose = advance_along_arc(pose, length, float(curvature))
        self.poses = np.array(poses)

    def at(self, ways):
        """Turn and place of the object, of shapes (n,)."""
        piece = np.clip(np.searchsorted(self.ways, ways, side='right') - 1, 0,
                        len(self.steers) - 1)
        along = (ways - self.ways[piece]) / self.factors[piece]
        half = 0.5 * along * self.curvatures[piece]
        chord = along * np.sinc(half / math.pi)
        x, y, theta = self.poses[piece].T
        z_x, z_y = x + chord * np.cos(theta + half), y + chord * np.sin(theta + half)
        theta = theta + 2.0 * half - self.vehicle.angle
        f_x, f_y = self.vehicle.flat_output
        return (theta, z_x - np.cos(theta) * f_x + np.sin(theta) * f_y,
                z_y - np.sin(theta) * f_x - np.cos(theta) * f_y)

    def smooth(self, ways, width):
        """Steer and w, averaged over a width."""
        found = []
        for values in (self.steers, self.rates):
            knots = np.concatenate([[0.0], np.cumsum(values * np.diff(self.ways))])
            begin = np.clip(ways - 0.5 * width, 0.0, self.ways[-1])
            end = np.clip(ways + 0.5 * width, 0.0, self.ways[-1])
            found.append((np.interp(end, self.ways, knots) - np.interp(begin, self.ways, knots))
                         / (end - begin))
        return found


def _followed(problem, theta, x, y, steering_angle, w, lengths, rates):
    """Let a differential drive's heading settle on the direction of the push."""
    direction = theta + problem.vehicle.angle + steering_angle
    reach = problem.robot.radius * math.cos(problem.heading_offset)
    start = problem.start_normal
    start = direction[0] + wrap_angle(start - direction[0])
    gammas, angles = [start], []
    for wanted, length in zip(0.5 * (direction[1:] + direction[:-1]), lengths):
        change = (wanted - gammas[-1] + problem.heading_offset) * (1.0 - math.exp(-length / reach))
        angles.append(math.asin(max(-0.9, min(0.9, change * reach / length)))
                      - problem.heading_offset)
        gammas.append(gammas[-1] + change)
    rho = np.array([angles[0], *(0.5 * (a + b) for a, b in zip(angles, angles[1:])), angles[-1]])
    c_x, c_y = problem.contact_point
    return Guess(np.column_stack([
        w, rho, theta, x + np.cos(theta) * c_x - np.sin(theta) * c_y,
        y + np.sin(theta) * c_x + np.cos(theta) * c_y, np.array(gammas) - start]), rates)
