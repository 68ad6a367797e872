"""Integrated segments as trajectory and report."""

import math
from typing import NamedTuple

import numpy as np

from push_model.drive import yaw_rate
from push_model.trajectory import PushTrajectory
from push_planner.stage import NODE

INSTANT = 1e-6


def trajectory_of(problem, driven):
    """
    Sample integrated segments.

    :param problem: the ``PushProblem``.
    :param driven: list of (pushing angle [rad], length [m], ``Segment``).
    :return: ``PushTrajectory``; twists jump at a switch: it is sampled ``INSTANT`` before, and
        after.
    """
    ways, nodes, angles, way = [], [], [], 0.0
    for angle, length, segment in driven:
        ways += (way + np.concatenate([[0.0], segment.ways])).tolist()
        nodes += [segment.begin, *segment.nodes]
        angles += [angle] * (1 + len(segment.ways))
        way += length
        ways[-1] = way
    before = np.flatnonzero(np.diff(ways) == 0.0)
    return _trajectory(problem, np.array(ways), np.array(nodes), np.array(angles), before)


class Switch(NamedTuple):
    """
    A jump of the pushing angle, and what it takes if it happens at once.

    :param way: where it is [m].
    :param change: change of the pushing angle [rad]; at the first touch the angle itself.
    :param d_omega: jump of the object's yaw rate [rad/s].
    :param normal_impulse: J_n [N s].
    :param tangential_impulse: J_t [N s].
    :param in_cone: whether the impulse lies within the believed friction cone.
    :param blend: way over which the change must be spread at least, for the contact to hold [m];
        0 inside the cone.
    """

    way: float
    change: float
    d_omega: float
    normal_impulse: float
    tangential_impulse: float
    in_cone: bool
    blend: float


def switches_of(problem, driven):
    """
    List the switches of a push; the first is the first touch.

    :param problem: the ``PushProblem``.
    :param driven: list of (pushing angle [rad], length [m], ``Segment``).
    :return: tuple of ``Switch``, one per segment.
    """
    speed, slope = problem.settings.pushing_speed, math.tan(problem.friction_angle)
    found, way, before = [], 0.0, 0.0
    negligible = 1e-9 * problem.obj.mass * speed
    for angle, length, segment in driven:
        jump, j_n, j_t = segment.impulse
        excess = abs(j_t) - slope * j_n
        f_n, f_t = segment.forces[-1]
        reserve = slope * f_n - abs(f_t)
        blend = 0.0
        if excess > negligible:
            blend = speed * excess / reserve if reserve > 0.0 else math.inf
        found.append(Switch(way, angle - before, speed * jump, j_n, j_t,
                            bool(excess <= negligible), float(blend)))
        way, before = way + length, angle
    return tuple(found)


def report_of(problem, driven, switches):
    """
    Say what a push does to the contact, in numbers.

    :param problem: the ``PushProblem``.
    :param driven: list of (pushing angle [rad], length [m], ``Segment``).
    :param switches: the ``Switch`` of each segment.
    :return: dict; ``way_beyond_planning_cone`` [m] is where the force exceeds the planning cone,
        between the points at which the programme asks for it (just after switches, mostly).
    """
    beyond = 0.0
    for _, _, segment in driven:
        steps = np.diff(segment.force_ways, prepend=0.0)
        use = np.abs(np.arctan2(segment.forces[:, 1], segment.forces[:, 0]))
        beyond += float(steps[use > problem.planning_angle + 1e-3].sum())
    length = float(sum(length for _, length, _ in driven))
    return {'pushing_speed': problem.settings.pushing_speed,
            'path_length': length,
            'duration': length / problem.settings.pushing_speed,
            'way_beyond_planning_cone': beyond,
            'impulses_outside_cone': sum(not switch.in_cone for switch in switches[1:]),
            'longest_blend': max(switch.blend for switch in switches),
            'shortest_segment': float(min(length for _, length, _ in driven))}


def _trajectory(problem, ways, nodes, angles, before):
    speed, radius = problem.settings.pushing_speed, problem.robot.radius
    x, y, theta, w, gamma = (nodes[:, NODE.index(name)] for name in NODE)
    lever_x, lever_y = _turned(theta, *problem.contact_point)
    n_x, n_y = np.cos(gamma), np.sin(gamma)
    v_x, v_y = speed * np.cos(gamma + angles), speed * np.sin(gamma + angles)
    omega = speed * w
    offset = problem.heading_offset
    turn = np.array([speed * float(yaw_rate(problem.robot.drive, radius, angle, offset, rate))
                     for angle, rate in zip(angles, w)])
    share = problem.rolling[0]
    bend = share * omega + (1.0 - share) * turn
    phi = problem.heading + gamma - gamma[0]
    values = {
        'object_poses': np.column_stack([x, y, theta]),
        'object_twists': np.column_stack([v_x + omega * lever_y, v_y - omega * lever_x, omega]),
        'contact_poses': np.column_stack([x + lever_x, y + lever_y, gamma]),
        'contact_twists': np.column_stack([v_x, v_y, bend]),
        'robot_poses': np.column_stack([x + lever_x - radius * n_x, y + lever_y - radius * n_y,
                                        phi]),
        'robot_twists': np.column_stack([v_x + turn * radius * n_y, v_y - turn * radius * n_x,
                                         turn])}
    times = ways / speed
    times[before] -= INSTANT
    for name in ('object', 'contact', 'robot'):
        values[f'{name}_poses'][before] -= INSTANT * values[f'{name}_twists'][before]
    return PushTrajectory(times=times, **values)


def _turned(angle, x, y):
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
