"""A rollout as trajectory and report."""

import math

import numpy as np
from push_model.geometry import wrap_angle
from push_model.trajectory import PushTrajectory
from push_planner.collocation.collocation import contact_impulse, Node, robot_yaw_rate
from push_planner.plan import Switch
from push_planner.push_parameters import places

INSTANT = 1e-6
NEGLIGIBLE = 1e-9


def find_switches(problem, rollout, jumps):
    """
    List the jumps of a push; the first is the first touch, unless the push is under way already.

    :param problem: the ``PushProblem``.
    :param rollout: ``Rollout``.
    :param jumps: whether the pushing angle jumps between steps.
    :return: tuple of ``Switch``.
    """
    if problem.settings.motion_model == 'quasi_static':
        return ()
    push_parameters, found = problem.push_parameters, []
    begins = np.flatnonzero(rollout.begins)
    if problem.motion.speed == 0.0:
        node = Node(*rollout.samples[0].tolist())
        found.append(_switch(problem, contact_impulse(problem.kind, push_parameters, node), rollout, begins[0],
                             node.rho))
    for k in range(1, len(rollout.changes)) if jumps else ():
        change = float(rollout.changes[k])
        if change != 0.0:
            jump = contact_impulse(problem.kind, push_parameters, Node(*rollout.nodes[k].tolist()), change)
            found.append(_switch(problem, jump, rollout, begins[k], change))
    return tuple(found)


def _switch(problem, jump, rollout, sample, change):
    speed = math.sqrt(rollout.squares[sample])
    d_omega, j_n, j_t = (float(value) for value in jump)
    j_n, j_t = (problem.obj.mass * speed * value for value in (j_n, j_t))
    slope = math.tan(problem.friction_angle)
    excess, blend = abs(j_t) - slope * j_n, 0.0
    inside = excess <= NEGLIGIBLE * problem.obj.mass * speed
    if not inside:
        after = rollout.forces[sample + 1:]
        f_n, f_t = after[np.flatnonzero(~np.isnan(after[:, 0]))[0]]
        reserve = slope * f_n - abs(f_t)
        blend = speed * excess / reserve if reserve > 0.0 else math.inf
    return Switch(float(rollout.ways[sample]), change, speed * d_omega, j_n, j_t, inside,
                  float(blend))


def build_report(problem, rollout, trajectory, switches):
    """
    Say what a push does to the contact, in numbers.

    :param problem: the ``PushProblem``.
    :param rollout: ``Rollout``.
    :param trajectory: its ``PushTrajectory``.
    :param switches: its ``Switch`` values.
    :return: dict; ``way_beyond_planning_cone`` [m] is where the force exceeds the planning cone,
        between the points at which the programme asks for it (just after the touch, mostly).
    """
    use = np.abs(np.arctan2(rollout.forces[:, 1], rollout.forces[:, 0]))
    steps = np.diff(rollout.ways, prepend=0.0)
    x, y, theta = trajectory.object_poses[-1]
    goal = problem.goal
    turned = 0.0 if problem.settings.heading_free else wrap_angle(theta - goal.theta)
    steepest = float(np.nanmax(use))
    return {'pushing_speed': problem.settings.pushing_speed,
            'highest_speed': float(np.sqrt(rollout.squares.max())),
            'path_length': float(rollout.ways[-1]),
            'duration': trajectory.duration,
            'position_error': math.hypot(x - goal.x, y - goal.y),
            'heading_error': abs(turned),
            'cone_usage': steepest / problem.planning_cone_angle,
            'friction_usage': steepest / problem.friction_angle,
            'distance_beyond_planning_cone': float(
                steps[use > problem.planning_cone_angle + 1e-3].sum()),
            'impulses_outside_cone': sum(not switch.in_cone for switch in switches[1:]),
            'longest_blend': max([switch.blend for switch in switches], default=0.0),
            'peak_angle_change': float(np.abs(rollout.changes).max())}


def sample_trajectory(problem, rollout):
    """
    Sample a rollout in the world.

    :param problem: the ``PushProblem``.
    :param rollout: ``Rollout``.
    :return: ``PushTrajectory``; where twists jump it is sampled ``INSTANT`` before, and after.
    """
    again = rollout.begins.copy()
    again[0] = False
    # The end of one step is the begin of the next, unless there is a jump between them.
    jumps = again & (np.abs(np.diff(rollout.samples[:, 1], prepend=0.0)) > 0.0)
    keep = ~again | jumps
    ways, squares = rollout.ways[keep], rollout.squares[keep]
    speed = np.sqrt(squares)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(ways) / (speed[1:] + speed[:-1]))])
    before = np.flatnonzero(jumps[keep]) - 1
    values = _motion(problem, rollout.samples[keep], speed)
    times[before] -= INSTANT
    for name in ('object', 'contact', 'robot'):
        values[f'{name}_poses'][before] -= INSTANT * values[f'{name}_twists'][before]
    return PushTrajectory(times=times, **values)


def _motion(problem, samples, speed):
    w, rho, theta, q_x, q_y, phi = samples.T
    push_parameters, radius = problem.push_parameters, problem.robot.radius
    delta, c_x, c_y = places(push_parameters, theta, phi)
    turn = np.array(robot_yaw_rate(problem.kind, push_parameters, rho, w)).ravel() * speed
    gamma, omega, start = theta + delta, speed * w, problem.start
    share = problem.rolling[0]
    bend = omega if problem.kind == 'held' else share * omega + (1.0 - share) * turn
    # Into the world: all angles grow by that of the start.
    theta, gamma = theta + start.theta, gamma + start.theta
    # Keep the normal next to the one that was asked for.
    gamma = gamma + 2.0 * math.pi * round((problem.normal - gamma[0]) / (2.0 * math.pi))
    q_x, q_y = _turned(start.theta, q_x, q_y)
    n_x, n_y = np.cos(gamma), np.sin(gamma)
    out = radius if problem.kind == 'rolling' else 0.0
    contact_x, contact_y = start.x + q_x + out * n_x, start.y + q_y + out * n_y
    lever_x, lever_y = _turned(theta, c_x, c_y)
    v_x, v_y = speed * np.cos(gamma + rho), speed * np.sin(gamma + rho)
    return {
        'object_poses': np.column_stack([contact_x - lever_x, contact_y - lever_y, theta]),
        'object_twists': np.column_stack([v_x + omega * lever_y, v_y - omega * lever_x, omega]),
        'contact_poses': np.column_stack([contact_x, contact_y, gamma]),
        'contact_twists': np.column_stack([v_x, v_y, bend]),
        'robot_poses': np.column_stack([contact_x - radius * n_x, contact_y - radius * n_y,
                                        problem.heading + phi]),
        'robot_twists': np.column_stack([v_x + turn * radius * n_y, v_y - turn * radius * n_x,
                                         turn])}


def _turned(angle, x, y):
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
