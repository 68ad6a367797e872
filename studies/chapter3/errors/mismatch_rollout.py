"""
Execute the inputs of a plan on an object that differs from the one it was made for.

Nothing corrects the path, so that the mismatch of the model appears as an error at the goal. The
contact is assumed to hold; the friction that this needs is reported.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_model.dynamics import Input, STATE
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject
from push_planner.problem import PushProblem
from push_planner.steered.plan import Plan
from push_planner.steered.verification.open_loop import (
    integrate, open_loop_simulation, OpenLoopSimulation)
from push_planner.steered.verification.verification import merge_steady_segments, segments_of

# Numbers in the state of one object.
SIZE = len(STATE)


class Rollout(NamedTuple):
    """
    Rollout of an executed plan.

    :param pose: of the object at the end.
    :param position_error: distance from the goal [m].
    :param heading_error: rotation from the goal, counter-clockwise [rad].
    :param friction_usage: largest angle of the contact force over the half-angle of the true
        friction cone, except in impulses of jumps; the contact would slide above 1.
    """

    pose: Pose
    position_error: float
    heading_error: float
    friction_usage: float


def rollout(plan: Plan, obj: PushedObject | None = None, speed_scale: float = 1.0,
            open_loop: bool = False) -> Rollout:
    """
    Execute a plan over the distance travelled by the contact, from rest.

    Pushing angles are measured from the contact normal, wherever that is: the robot senses how the
    object lies on it. An open-loop robot moves in the world as if the plan came true.

    :param plan: what is executed.
    :param obj: the true object, of the same outline; None for that of the plan.
    :param speed_scale: factor on the plan's speeds.
    :param open_loop: whether the robot does not even sense the contact normal.
    :return: where it leads.
    :raises ValueError: for an open-loop robot whose motion follows the object's in the plan.
    :raises RuntimeError: where the integration fails.
    """
    problem = dataclasses.replace(plan.problem, obj=obj or plan.problem.obj)
    simulation = open_loop_simulation(problem)
    segments = merge_steady_segments(segments_of(plan, speed_scale))
    state, steepest = simulation.start(), 0.0
    if open_loop:
        # The nominal object moves as planned, and the robot with it.
        nominal = _nominal_simulation(plan.problem)
        nominal_state = nominal.start()
        for segment in segments:
            nominal_state, jump = nominal.start_segment(nominal_state, segment)
            state = simulation.apply_velocity_jump(state, jump)
            both = np.concatenate([nominal_state, state])
            both, angle = _integrate_both(nominal, simulation, both, segment.duration)
            nominal_state, state = both[:SIZE], both[SIZE:]
            steepest = max(steepest, angle)
    else:
        for segment in segments:
            state, _ = simulation.start_segment(state, segment)
            state, angle = simulation.integrate_segment(state)
            steepest = max(steepest, angle)
    if not np.isfinite(state).all():
        raise RuntimeError('the integration of the executed plan failed')
    goal = plan.problem.goal
    return Rollout(Pose(*state[:3].tolist()), math.hypot(state[0] - goal.x, state[1] - goal.y),
                   wrap_angle(state[2] - goal.theta), steepest / problem.friction_angle)


def _nominal_simulation(problem: PushProblem) -> OpenLoopSimulation:
    """Simulate the push as it was planned, whose motion an open-loop robot imposes."""
    rotates = problem.kind != 'rolling' and problem.robot.radius > 0.0
    if rotates or problem.settings.motion_model != 'dynamic':
        raise ValueError(f'plan: got a {problem.settings.motion_model} one of a robot of radius '
                         f'{problem.robot.radius:g} m with yaw {problem.settings.robot_yaw}, '
                         'expected a dynamic one of a point or of a robot that does not rotate')
    return open_loop_simulation(problem)


def _integrate_both(nominal: OpenLoopSimulation, true: OpenLoopSimulation, start: FloatArray,
                    duration: float) -> tuple[FloatArray, float]:
    """
    Integrate the nominal and the true object over a segment, both under the nominal input.

    :param start: states of the nominal and the true object, one after the other, shape (14,).
    :param duration: of the segment [s].
    :return: both states at the end, largest angle of the force on the true object [rad].
    """
    def inputs(time: float, both: FloatArray) -> Input:
        return nominal.inputs(time, both[:SIZE])

    def rate(time: float, both: FloatArray) -> FloatArray:
        imposed = inputs(time, both)
        return np.concatenate([nominal.respond(both[:SIZE], imposed)[0],
                               true.respond(both[SIZE:], imposed)[0]])

    def force(time: float, both: FloatArray) -> FloatArray:
        return true.respond(both[SIZE:], inputs(time, both))[1]

    return integrate(rate, force, duration, start)
