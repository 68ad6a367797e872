"""Integrated segments as trajectory and report."""

import math

import numpy as np

from push_model.trajectory import PushTrajectory
from push_planner.drive import yaw_rate
from push_planner.stage import NODE


def trajectory_of(problem, driven):
    """
    Sample integrated segments.

    :param problem: the ``PushProblem``.
    :param driven: list of (pushing angle [rad], length [m], ``Segment``).
    :return: ``PushTrajectory``; at a switch the twists are those after it.
    """
    ways, nodes, angles, way = [], [], [], 0.0
    for number, (angle, length, segment) in enumerate(driven):
        last = number == len(driven) - 1
        count = len(segment.ways) + last
        ways += (way + np.concatenate([[0.0], segment.ways]))[:count].tolist()
        nodes += [segment.begin, *segment.nodes][:count]
        angles += [angle] * count
        way += length
    return _trajectory(problem, np.array(ways), np.array(nodes), np.array(angles))


def report_of(problem, driven):
    """
    Say what a push does to the contact.

    :param problem: the ``PushProblem``.
    :param driven: list of (pushing angle [rad], length [m], ``Segment``).
    :return: dict: ``switches`` (one dict each: way, change of the pushing angle, d_omega, J_n,
        J_t, in_cone, blend), how many leave the cone, the longest blend, and where the planning
        cone is exceeded between the points at which it was asked for.
    """
    speed, total = problem.settings.pushing_speed, sum(problem.obj.capacities)
    slope = math.tan(problem.friction_angle)
    switches, way, before = [], 0.0, None
    exceeded = 0.0
    for angle, length, segment in driven:
        jump, j_n, j_t = segment.impulse
        f_n, f_t = segment.forces[0]
        switches.append({'way': way, 'change': angle - (0.0 if before is None else before),
                         'd_omega': speed * jump, 'j_n': j_n, 'j_t': j_t,
                         'in_cone': bool(j_n > 0.0 and abs(j_t) <= slope * j_n),
                         'blend': _blend(speed, slope, segment)})
        steps = np.diff(segment.force_ways, prepend=0.0)
        use = np.abs(np.arctan2(segment.forces[:, 1], segment.forces[:, 0]))
        exceeded += float(steps[use > problem.planning_angle + 1e-3].sum())
        way, before = way + length, angle
    leaving = [switch for switch in switches[1:] if not switch['in_cone']]
    return {'path_length': way, 'duration': way / speed, 'pushing_speed': speed,
            'first_touch': switches[0], 'switches': switches[1:],
            'impulses_outside_cone': len(leaving),
            'longest_blend': max((switch['blend'] for switch in switches[1:]), default=0.0),
            'way_beyond_planning_cone': exceeded,
            'support_friction': total}


def _blend(speed, slope, segment):
    """Way over which a switch must be spread for the contact to hold [m]; 0 inside the cone."""
    _, j_n, j_t = segment.impulse
    f_n, f_t = segment.forces[-1]
    need = abs(j_t) - slope * j_n
    slack = slope * f_n - abs(f_t)
    if need <= 0.0:
        return 0.0
    return speed * need / slack if slack > 0.0 else math.inf


def _trajectory(problem, ways, nodes, angles):
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
    return PushTrajectory(
        times=ways / speed,
        object_poses=np.column_stack([x, y, theta]),
        object_twists=np.column_stack([v_x + omega * lever_y, v_y - omega * lever_x, omega]),
        contact_poses=np.column_stack([x + lever_x, y + lever_y, gamma]),
        contact_twists=np.column_stack([v_x, v_y, bend]),
        robot_poses=np.column_stack([x + lever_x - radius * n_x, y + lever_y - radius * n_y, phi]),
        robot_twists=np.column_stack([v_x + turn * radius * n_y, v_y - turn * radius * n_x, turn]))


def _turned(angle, x, y):
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
