"""
A plan integrated anew: in time, on ``push_model.dynamics`` as it stands, by scipy.

A pushed object without feedback runs away from its path by ``exp(s / L)``, so that no integrator
can follow 10 m of push from its begin: errors of 1e-12 grow to metres. Long plans are therefore
integrated in stretches of ``STRETCH`` wheelbases, each from the plan's own state, and all their
mismatches are added up.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import wrap_angle
from push_planner.driven_push import driven_push
from push_planner.pieces import pieces_of

STRETCH = 8.0


class Verification(NamedTuple):
    """
    What a re-integration found.

    :param position_error: distance from the goal at the end, mismatches between stretches
        included [m].
    :param heading_error: the same of the orientation, and of the contact normal between stretches
        [rad]; 0 at a goal where the heading is free.
    :param cone_usage: largest angle of the contact force over the planning cone's half-angle.
    :param friction_usage: the same over the believed friction cone's half-angle.
    :param stretches: number of stretches; 1 is one integration from start to goal.
    """

    position_error: float
    heading_error: float
    cone_usage: float
    friction_usage: float
    stretches: int


def re_integrate(plan):
    """
    Integrate a plan from its start pose under its pushing angles and speeds.

    :param plan: the ``Plan``.
    :return: ``Verification``.
    """
    problem, goal = plan.problem, plan.problem.goal
    push = driven_push(problem)
    state = push.start()
    position, heading, steepest = 0.0, 0.0, 0.0
    stretches, stretch_begin, begin, time = 1, 0.0, 0.0, 0.0
    longest = STRETCH * problem.vehicle.wheelbase
    for piece, end in zip(pieces_of(plan), plan.segment_ends):
        state, _ = push.enter(state, piece)
        if begin > stretch_begin and end - stretch_begin > longest:
            meant = _planned_state(plan, time)
            position += math.hypot(*(state - meant)[:2])
            heading += float(np.abs(state - meant)[[2, 4]].max())
            state, stretch_begin, stretches = meant, begin, stretches + 1
        state, angle = push.follow(state)
        steepest = max(steepest, angle)
        begin, time = end, time + piece.duration
    position += math.hypot(state[0] - goal.x, state[1] - goal.y)
    heading += 0.0 if problem.settings.heading_free else abs(wrap_angle(state[2] - goal.theta))
    return Verification(position, heading, steepest / problem.planning_angle,
                        steepest / problem.friction_angle, stretches)


def _planned_state(plan, time):
    sample = plan.trajectory.at(time)
    problem = plan.problem
    pose = sample['object_poses']
    c_x, c_y = sample['contact_poses'][:2] - pose[:2]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    place = problem.contact_point if problem.kind != 'rolling' else (c * c_x + s * c_y,
                                                                     c * c_y - s * c_x)
    return np.array([*pose, sample['object_twists'][2], sample['contact_poses'][2], *place])
