"""
Verification of a plan: integrated once more, independently of how it was found.

A push in open loop runs away from its path by ``exp(s / L)``, with L the wheelbase, so that no
integrator can follow 10 m of push from the start: errors of 1e-12 grow to metres. Long plans are
therefore integrated in intervals, each from the plan's own state, and all their mismatches are
added up.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, wrap_angle
from push_planner.steered.plan import Plan
from push_planner.steered.verification.open_loop import open_loop_simulation, PushSegment

# Length of an interval in wheelbases. Chosen: an open-loop push diverges as exp(s / L), so that
# errors grow by exp(8) = 3000 over an interval.
INTERVAL_WHEELBASES = 8.0


class Verification(NamedTuple):
    """
    Result of a verification.

    :param position_error: distance from the goal at the end, mismatches between intervals
        included [m].
    :param heading_error: the same of the orientation, and of the contact normal between intervals
        [rad]; the goal does not count where its heading is free.
    :param cone_usage: largest angle of the contact force over the planning cone's half-angle.
    :param friction_usage: the same over the nominal friction cone's half-angle.
    :param intervals: number of intervals; 1 is one integration from start to goal.
    """

    position_error: float
    heading_error: float
    cone_usage: float
    friction_usage: float
    intervals: int


def verify(plan: Plan) -> Verification:
    """Integrate a plan from its start pose under its pushing angles and speeds."""
    problem, goal = plan.problem, plan.problem.goal
    simulation = open_loop_simulation(problem)
    state = simulation.start()
    position_error = heading_error = largest_force_angle = 0.0
    intervals = 1
    interval_start = segment_start = time = 0.0
    longest = INTERVAL_WHEELBASES * problem.vehicle.wheelbase
    for segment, segment_end in zip(segments_of(plan), plan.segment_ends):
        state, _ = simulation.start_segment(state, segment)
        if segment_start > interval_start and segment_end - interval_start > longest:
            planned = _planned_state(plan, time)
            position_error += math.hypot(*(state - planned)[:2])
            heading_error += float(np.abs(state - planned)[[2, 4]].max())
            state = planned
            interval_start = segment_start
            intervals += 1
        state, force_angle = simulation.integrate_segment(state)
        largest_force_angle = max(largest_force_angle, force_angle)
        segment_start = segment_end
        time += segment.duration
    position_error += math.hypot(state[0] - goal.x, state[1] - goal.y)
    if not problem.settings.heading_free:
        heading_error += abs(wrap_angle(state[2] - goal.theta))
    return Verification(position_error, heading_error,
                        largest_force_angle / problem.planning_cone_angle,
                        largest_force_angle / problem.friction_angle, intervals)


def segments_of(plan: Plan, speed_scale: float = 1.0) -> list[PushSegment]:
    """
    List the segments of a plan.

    :param speed_scale: factor on all its speeds.
    """
    lengths = np.diff(plan.segment_ends, prepend=0.0).tolist()
    return [PushSegment(angles, (speed_scale * speeds[0], speed_scale * speeds[1]), length)
            for angles, speeds, length in zip(plan.pushing_angles, plan.speeds, lengths)]


def merge_steady_segments(segments: list[PushSegment]) -> list[PushSegment]:
    """
    Merge neighbours that push on at the same constant angle and speed.

    :param segments: list of ``PushSegment``.
    :return: list of ``PushSegment``, as few as there can be.
    """
    merged: list[PushSegment] = []
    for segment in segments:
        steady = (segment.angles[0] == segment.angles[1]
                  and segment.speeds[0] == segment.speeds[1])
        if merged and steady and merged[-1][:2] == segment[:2]:
            merged[-1] = merged[-1]._replace(length=merged[-1].length + segment.length)
        else:
            merged.append(segment)
    return merged


def _planned_state(plan: Plan, time: float) -> FloatArray:
    """State of the plan's own trajectory, in the order of ``push_model.dynamics.STATE``."""
    sample = plan.trajectory.at(time)
    problem = plan.problem
    pose = sample['object_poses']
    contact_x, contact_y = problem.contact_point
    if problem.kind == 'rolling':
        c_x, c_y = sample['contact_poses'][:2] - pose[:2]
        c, s = math.cos(pose[2]), math.sin(pose[2])
        contact_x, contact_y = c * c_x + s * c_y, c * c_y - s * c_x
    return np.array([*pose, sample['object_twists'][2], sample['contact_poses'][2], contact_x,
                     contact_y])
