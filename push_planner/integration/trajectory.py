"""A rollout as a trajectory in the world, with its jumps and its figures."""

import math
from typing import Any

import numpy as np
from push_model.geometry import FloatArray, wrap_angle
from push_model.trajectory import PushTrajectory
from push_planner.collocation.collocation import (
    contact_impulse, ContactImpulse, Node, robot_yaw_rate,
)
from push_planner.integration.rollout import Rollout
from push_planner.plan import Switch
from push_planner.problem import PushProblem
from push_planner.push_parameters import contact_frames

# Time between the samples before and after a jump of the twists [s]. Chosen: trajectories have
# increasing times, and nothing moves by a micrometre in it.
JUMP_TIME = 1e-6
# Impulse outside the cone that counts as inside, per momentum of the object: rounding.
IMPULSE_ROUNDING = 1e-9
# How far beyond the planning cone a force counts as outside [rad]. Chosen: 0.06 degrees, so that
# forces at the edge, where optimal pushes are, do not count.
CONE_TOLERANCE = 1e-3


def find_switches(problem: PushProblem, rollout: Rollout, jumps: bool) -> tuple[Switch, ...]:
    """
    List the jumps of a push; the first is the first touch, unless the push is under way already.

    :param problem: the ``PushProblem``.
    :param rollout: ``Rollout``.
    :param jumps: whether the pushing angle jumps between steps.
    """
    if problem.settings.motion_model == 'quasi_static':
        return ()
    parameters = problem.push_parameters
    found: list[Switch] = []
    begins = np.flatnonzero(rollout.is_begin)
    if problem.motion.speed == 0.0:
        node = Node(*rollout.samples[0].tolist())
        response = contact_impulse(problem.kind, parameters, node)
        found.append(_switch(problem, response, rollout, begins[0], node.rho))
    if not jumps:
        return tuple(found)
    for k in range(1, len(rollout.changes)):
        change = float(rollout.changes[k])
        if change != 0.0:
            response = contact_impulse(problem.kind, parameters,
                                       Node(*rollout.nodes[k].tolist()), change)
            found.append(_switch(problem, response, rollout, begins[k], change))
    return tuple(found)


def build_report(problem: PushProblem, rollout: Rollout, trajectory: PushTrajectory,
                 switches: tuple[Switch, ...]) -> dict[str, Any]:
    """
    Describe in numbers what a push does to the contact.

    :param problem: the ``PushProblem``.
    :param rollout: ``Rollout``.
    :param trajectory: its ``PushTrajectory``.
    :param switches: its ``Switch`` values.
    :return: figures by name; ``distance_beyond_planning_cone`` [m] is where the force exceeds the
        planning cone, between the points at which the program keeps it inside (just after the
        touch, mostly).
    """
    force_angles = np.abs(np.arctan2(rollout.forces[:, 1], rollout.forces[:, 0]))
    steps = np.diff(rollout.s, prepend=0.0)
    x, y, theta = trajectory.object_poses[-1]
    goal = problem.goal
    rotation = 0.0 if problem.settings.heading_free else wrap_angle(theta - goal.theta)
    steepest = float(np.nanmax(force_angles))
    outside = force_angles > problem.planning_cone_angle + CONE_TOLERANCE
    return {'pushing_speed': problem.settings.pushing_speed,
            'highest_speed': float(np.sqrt(rollout.v_squared.max())),
            'path_length': float(rollout.s[-1]),
            'duration': trajectory.duration,
            'position_error': math.hypot(x - goal.x, y - goal.y),
            'heading_error': abs(rotation),
            'cone_usage': steepest / problem.planning_cone_angle,
            'friction_usage': steepest / problem.friction_angle,
            'distance_beyond_planning_cone': float(steps[outside].sum()),
            'impulses_outside_cone': sum(not switch.in_cone for switch in switches[1:]),
            'longest_blend': max([switch.blend_distance for switch in switches], default=0.0),
            'peak_angle_change': float(np.abs(rollout.changes).max())}


def sample_trajectory(problem: PushProblem, rollout: Rollout) -> PushTrajectory:
    """
    Sample a rollout in the world.

    :param problem: the ``PushProblem``.
    :param rollout: ``Rollout``.
    :return: ``PushTrajectory``; where twists jump it is sampled ``JUMP_TIME`` before, and after.
    """
    repeated = rollout.is_begin.copy()
    repeated[0] = False
    # The end of one step is the begin of the next, unless there is a jump between them.
    jumps = repeated & (np.abs(np.diff(rollout.samples[:, 1], prepend=0.0)) > 0.0)
    kept = ~repeated | jumps
    s, v_squared = rollout.s[kept], rollout.v_squared[kept]
    speed = np.sqrt(v_squared)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(s) / (speed[1:] + speed[:-1]))])
    before = np.flatnonzero(jumps[kept]) - 1
    columns: dict[str, Any] = {**_motion(problem, rollout.samples[kept], speed)}
    times[before] -= JUMP_TIME
    for name in ('object', 'contact', 'robot'):
        columns[f'{name}_poses'][before] -= JUMP_TIME * columns[f'{name}_twists'][before]
    return PushTrajectory(times=times, **columns)


def _switch(problem: PushProblem, response: ContactImpulse, rollout: Rollout, sample: int,
            change: float) -> Switch:
    speed = math.sqrt(rollout.v_squared[sample])
    momentum = problem.obj.mass * speed
    w_jump = float(response.w_jump)
    j_n = momentum * float(response.normal)
    j_t = momentum * float(response.tangential)
    slope = math.tan(problem.friction_angle)
    excess = abs(j_t) - slope * j_n
    in_cone = excess <= IMPULSE_ROUNDING * problem.obj.mass * speed
    blend_distance = 0.0
    if not in_cone:
        # Spread over a distance, the force that presses meanwhile makes up for the excess.
        after = rollout.forces[sample + 1:]
        f_n, f_t = after[np.flatnonzero(~np.isnan(after[:, 0]))[0]]
        reserve = slope * f_n - abs(f_t)
        blend_distance = speed * excess / reserve if reserve > 0.0 else math.inf
    return Switch(float(rollout.s[sample]), change, speed * w_jump, j_n, j_t, in_cone,
                  float(blend_distance))


def _motion(problem: PushProblem, samples: FloatArray, speed: FloatArray) -> dict[str, FloatArray]:
    """Poses and twists of object, contact and robot in the world, by their names."""
    w, rho, theta, q_x, q_y, phi = samples.T
    parameters, radius, start = problem.push_parameters, problem.robot.radius, problem.start
    delta, c_x, c_y = contact_frames(parameters, theta, phi)
    robot_w = np.array(robot_yaw_rate(problem.kind, parameters, rho, w)).ravel()
    robot_omega = robot_w * speed
    gamma, omega = theta + delta, speed * w
    lam = problem.rolling.normal_ratio
    gamma_rate = omega if problem.kind == 'held' else lam * omega + (1.0 - lam) * robot_omega
    # Into the world: all angles grow by that of the start.
    theta, gamma = theta + start.theta, gamma + start.theta
    # Keep the normal next to the one of the problem.
    gamma = gamma + 2.0 * math.pi * round((problem.normal - gamma[0]) / (2.0 * math.pi))
    q_x, q_y = _rotated(start.theta, q_x, q_y)
    n_x, n_y = np.cos(gamma), np.sin(gamma)
    to_contact = radius if problem.kind == 'rolling' else 0.0
    contact_x = start.x + q_x + to_contact * n_x
    contact_y = start.y + q_y + to_contact * n_y
    lever_x, lever_y = _rotated(theta, c_x, c_y)
    v_x, v_y = speed * np.cos(gamma + rho), speed * np.sin(gamma + rho)
    return {
        'object_poses': np.column_stack([contact_x - lever_x, contact_y - lever_y, theta]),
        'object_twists': np.column_stack([v_x + omega * lever_y, v_y - omega * lever_x, omega]),
        'contact_poses': np.column_stack([contact_x, contact_y, gamma]),
        'contact_twists': np.column_stack([v_x, v_y, gamma_rate]),
        'robot_poses': np.column_stack([contact_x - radius * n_x, contact_y - radius * n_y,
                                        problem.heading + phi]),
        'robot_twists': np.column_stack([v_x + robot_omega * radius * n_y,
                                         v_y - robot_omega * radius * n_x, robot_omega])}


def _rotated(angle: Any, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
