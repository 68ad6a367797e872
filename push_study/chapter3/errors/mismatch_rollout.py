"""
A plan's inputs played on an object that is not the one that was believed.

Nobody looks at the way: what the plan left out comes out as the error at the end. The contact is
taken to hold; the friction that this takes is told.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_model.dynamics import STATE
from push_model.geometry import Pose, wrap_angle
from push_planner.verification.open_loop import integrate, open_loop_simulation
from push_planner.verification.verification import merge_steady_segments, segments_of

SIZE = len(STATE)


class Replay(NamedTuple):
    """
    Where a played plan leads.

    :param pose: ``Pose`` of the object at the end.
    :param position_error: its distance from the goal [m].
    :param heading_error: its turn from the goal, counter-clockwise [rad].
    :param friction_usage: largest angle of the contact force over the half-angle of the true
        friction cone, impulses of jumps apart; the contact would slide above 1.
    """

    pose: Pose
    position_error: float
    heading_error: float
    friction_usage: float


def replay(plan, obj=None, pace=1.0, blind=False):
    """
    Play a plan over the way of the contact, from its start at rest.

    Its pushing angles count from the normal of the contact, wherever that is: the robot feels how
    the object lies on it. A blind robot moves in the world as if the plan came true.

    :param plan: the ``Plan``.
    :param obj: the true ``PushedObject``, of the same outline; None for the believed one.
    :param pace: factor on the plan's speeds.
    :param blind: whether the robot does not even feel the object.
    :return: ``Replay``.
    :raises ValueError: for a blind robot whose motion follows the object's in the plan.
    :raises RuntimeError: where the integration fails.
    """
    problem = dataclasses.replace(plan.problem, obj=obj or plan.problem.obj)
    push = open_loop_simulation(problem)
    lead = _lead(plan) if blind else push
    led, state, steepest = lead.start(), push.start(), 0.0
    for segment in merge_steady_segments(segments_of(plan, pace)):
        led, jump = lead.start_segment(led, segment)
        if blind:
            led, state, angle = _side_by_side(lead, push, led, push.apply_velocity_jump(state, jump))
        else:
            led, angle = push.integrate_segment(led)
            state = led
        steepest = max(steepest, angle)
    if not np.isfinite(state).all():
        raise RuntimeError('the integration of the played plan failed')
    goal = plan.problem.goal
    return Replay(Pose(*state[:3].tolist()), math.hypot(state[0] - goal.x, state[1] - goal.y),
                  wrap_angle(state[2] - goal.theta), steepest / problem.friction_angle)


def _lead(plan):
    """Make the push as it was believed, which a blind robot imposes."""
    problem = plan.problem
    turns = problem.kind != 'rolling' and problem.robot.radius > 0.0
    if turns or problem.settings.motion_model != 'dynamic':
        raise ValueError(f'plan: got a {problem.settings.motion_model} one of a robot of radius '
                         f'{problem.robot.radius:g} m with yaw {problem.settings.robot_yaw}, '
                         'expected a dynamic one of a point or of a robot that does not turn')
    return open_loop_simulation(problem)


def _side_by_side(lead, push, led, state):
    """Drive the believed and the true object, both under the input of the former."""
    def inputs(time, both):
        return lead.inputs(time, both[:SIZE])

    def rate(time, both):
        imposed = inputs(time, both)
        return np.concatenate([lead.respond(both[:SIZE], imposed)[0],
                               push.respond(both[SIZE:], imposed)[0]])

    end, angle = integrate(
        rate, lambda time, both: push.respond(both[SIZE:], inputs(time, both))[1],
        lead.segment.duration, np.concatenate([led, state]))
    return end[:SIZE], end[SIZE:], angle
