"""A rollout as a trajectory in the world, with its jumps and its figures."""

import functools
import math
from typing import Any

import casadi as ca
import numpy as np
from push_dynamics.machine_code import RowFunction
from push_model.dynamics import rotated
from push_model.geometry import FloatArray
from push_model.trajectory import COLUMNS, PushTrajectory
from push_planner.problem import PushProblem
from push_planner.steered.collocation.collocation import (
    contact_impulse, Node, robot_yaw_rate, VelocityJumpEffect,
)
from push_planner.steered.integration.rollout import Rollout
from push_planner.steered.plan import Switch
from push_planner.steered.push_parameters import (
    contact_frame, PushKind, PushParameters, SupportLayout)

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

    :param jumps: whether the pushing angle jumps between steps.
    """
    if problem.settings.motion_model == 'quasi_static':
        return ()
    parameters = problem.push_parameters
    switches: list[Switch] = []
    if problem.motion.speed == 0.0:
        node = Node(*rollout.samples[0].tolist())
        response = contact_impulse(problem.kind, parameters, node)
        switches.append(_switch(problem, response, rollout, 0, node.rho))
    if not jumps:
        return tuple(switches)
    changed = np.flatnonzero(rollout.changes[1:]) + 1
    for k, start in zip(changed.tolist(), rollout.starts[1:].tolist()):
        change = float(rollout.changes[k])
        response = contact_impulse(problem.kind, parameters, Node(*rollout.nodes[k].tolist()),
                                   change)
        switches.append(_switch(problem, response, rollout, start, change))
    return tuple(switches)


def build_report(problem: PushProblem, rollout: Rollout,
                 switches: tuple[Switch, ...]) -> dict[str, Any]:
    """
    Describe in numbers what a push does to the contact.

    :param switches: its ``Switch`` values.
    :return: figures by name; ``distance_beyond_planning_cone`` [m] is where the force exceeds the
        planning cone, between the points at which the program keeps it inside (just after the
        touch, mostly).
    """
    outside = _force_angles(rollout.forces) > problem.planning_cone_angle + CONE_TOLERANCE
    return {'pushing_speed': problem.settings.pushing_speed,
            'highest_speed': float(np.sqrt(rollout.v_squared.max())),
            'distance_beyond_planning_cone': float(np.diff(rollout.s)[outside[1:]].sum()),
            'impulses_outside_cone': sum(not switch.in_cone for switch in switches[1:]),
            'longest_blend': max([switch.blend_distance for switch in switches], default=0.0),
            'peak_angle_change': float(np.abs(rollout.changes).max())}


def sample_trajectory(problem: PushProblem, rollout: Rollout) -> PushTrajectory:
    """
    Sample a rollout in the world.

    :return: ``PushTrajectory``; where twists jump it is sampled ``JUMP_TIME`` before, and after.
    """
    s, speed = rollout.s, np.sqrt(rollout.v_squared)
    times = np.zeros(len(s))
    np.cumsum(2.0 * np.diff(s) / (speed[1:] + speed[:-1]), out=times[1:])
    columns: dict[str, Any] = {**_motion(problem, rollout.samples, speed)}
    if len(rollout.starts) > 1:
        before = rollout.starts[1:] - 1
        times[before] -= JUMP_TIME
        for name in ('object', 'contact', 'robot'):
            columns[f'{name}_poses'][before] -= JUMP_TIME * columns[f'{name}_twists'][before]
    return PushTrajectory(times=times, **columns)


def _force_angles(forces: FloatArray) -> FloatArray:
    """Angles of forces from the normal [rad]."""
    return np.abs(np.arctan2(forces[:, 1], forces[:, 0]))


def _switch(problem: PushProblem, response: VelocityJumpEffect, rollout: Rollout, sample: int,
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
        f_n, f_t = rollout.forces[sample + 1]
        reserve = slope * f_n - abs(f_t)
        blend_distance = speed * excess / reserve if reserve > 0.0 else math.inf
    return Switch(float(rollout.s[sample]), change, speed * w_jump, j_n, j_t, in_cone,
                  float(blend_distance))


def _motion(problem: PushProblem, samples: FloatArray, speed: FloatArray) -> dict[str, FloatArray]:
    """Poses and twists of object, contact and robot in the world, by their names."""
    start = problem.start
    # Keep the normal next to the one of the problem.
    turns = round((problem.normal - start.theta - problem.start_normal) / (2.0 * math.pi))
    parameters = problem.push_parameters
    outputs = _world_motion(problem.kind, parameters.supports)({
        'node': samples, 'speed': speed[:, None], 'column': parameters.column(),
        'start': np.array([*start, problem.heading, 2.0 * math.pi * turns])})
    return dict(zip(COLUMNS, outputs))


@functools.lru_cache(maxsize=16)
def _world_motion(kind: PushKind, supports: SupportLayout) -> RowFunction:
    """
    Build poses and twists in the world from a node and the speed of the contact.

    ``start`` are the object's start pose, the robot's heading there, and what is added to the
    normal.
    """
    parameters, column = PushParameters.symbols(supports)
    symbol, speed, start = ca.SX.sym('node', 6), ca.SX.sym('speed'), ca.SX.sym('start', 5)
    start_x, start_y, start_theta, heading, turns = ca.vertsplit(start)
    node, radius = Node(*ca.vertsplit(symbol)), parameters.radius
    delta, c_x, c_y = contact_frame(parameters, node.theta, node.phi)
    omega = speed * node.w
    robot_omega = speed * robot_yaw_rate(kind, parameters, node.rho, node.w)
    lam = parameters.normal_ratio
    gamma_rate = omega if kind == 'held' else lam * omega + (1.0 - lam) * robot_omega
    # Into the world: all angles grow by that of the start.
    theta, gamma = node.theta + start_theta, node.theta + delta + start_theta
    q_x, q_y = rotated(start_theta, node.q_x, node.q_y)
    n_x, n_y = ca.cos(gamma), ca.sin(gamma)
    to_contact = radius if kind == 'rolling' else 0.0
    contact_x, contact_y = start_x + q_x + to_contact * n_x, start_y + q_y + to_contact * n_y
    lever_x, lever_y = rotated(theta, c_x, c_y)
    v_x, v_y = speed * ca.cos(gamma + node.rho), speed * ca.sin(gamma + node.rho)
    results = {
        'object_poses': (contact_x - lever_x, contact_y - lever_y, theta),
        'object_twists': (v_x + omega * lever_y, v_y - omega * lever_x, omega),
        'contact_poses': (contact_x, contact_y, gamma + turns),
        'contact_twists': (v_x, v_y, gamma_rate),
        'robot_poses': (contact_x - radius * n_x, contact_y - radius * n_y, heading + node.phi),
        'robot_twists': (v_x + robot_omega * radius * n_y, v_y - robot_omega * radius * n_x,
                         robot_omega)}
    inputs = {'node': symbol, 'speed': speed, 'column': column, 'start': start}
    outputs: Any = ca.cse([ca.densify(ca.vertcat(*result)) for result in results.values()])
    return RowFunction(ca.Function('world_motion', list(inputs.values()), outputs, list(inputs),
                                   list(results)), is_independent=True)
