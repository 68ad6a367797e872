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
from push_planner.verification.open_loop import open_loop_simulation


class Segment(NamedTuple):
    """
    A piece of a push.

    :param angles: pushing angle at its begin and its end, linear in the way [rad].
    :param speeds: of the contact, its square linear in the way [m/s].
    :param length: way of the contact [m].
    """

    angles: tuple
    speeds: tuple
    length: float

    @property
    def acceleration(self):
        """Of the contact along the push [m/s^2]."""
        return 0.5 * (self.speeds[1] ** 2 - self.speeds[0] ** 2) / self.length

    @property
    def duration(self):
        """Time that it takes [s]."""
        return 2.0 * self.length / (self.speeds[0] + self.speeds[1])

    def at(self, time):
        """Pushing angle [rad], its rate [rad/s], and speed [m/s] after a time [s]."""
        speed = self.speeds[0] + self.acceleration * time
        bend = (self.angles[1] - self.angles[0]) / self.length
        way = 0.5 * (self.speeds[0] + speed) * time
        return self.angles[0] + bend * way, bend * speed, speed


def segments_of(plan, pace=1.0):
    """
    List the pieces of a plan.

    :param plan: the ``Plan``.
    :param pace: factor on all its speeds.
    :return: list of ``Segment``.
    """
    lengths = np.diff(plan.segment_ends, prepend=0.0).tolist()
    return [Segment(angles, (pace * speeds[0], pace * speeds[1]), length)
            for angles, speeds, length in zip(plan.pushing_angles, plan.speeds, lengths)]


def merge_steady_segments(segments):
    """
    Join neighbours that push on at the same angle and speed.

    :param segments: list of ``Segment``.
    :return: list of ``Segment``, as few as there can be.
    """
    found = []
    for segment in segments:
        steady = len({*segment.angles}) == len({*segment.speeds}) == 1
        if found and steady and found[-1][:2] == segment[:2]:
            found[-1] = found[-1]._replace(length=found[-1].length + segment.length)
        else:
            found.append(segment)
    return found


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
    :param intervals: number of stretches; 1 is one integration from start to goal.
    """

    position_error: float
    heading_error: float
    cone_usage: float
    friction_usage: float
    intervals: int


def verify(plan):
    """
    Integrate a plan from its start pose under its pushing angles and speeds.

    :param plan: the ``Plan``.
    :return: ``Verification``.
    """
    problem, goal = plan.problem, plan.problem.goal
    push = open_loop_simulation(problem)
    state = push.start()
    position, heading, steepest = 0.0, 0.0, 0.0
    intervals, stretch_begin, begin, time = 1, 0.0, 0.0, 0.0
    longest = STRETCH * problem.vehicle.wheelbase
    for segment, end in zip(segments_of(plan), plan.segment_ends):
        state, _ = push.start_segment(state, segment)
        if begin > stretch_begin and end - stretch_begin > longest:
            meant = _planned_state(plan, time)
            position += math.hypot(*(state - meant)[:2])
            heading += float(np.abs(state - meant)[[2, 4]].max())
            state, stretch_begin, intervals = meant, begin, intervals + 1
        state, angle = push.integrate_segment(state)
        steepest = max(steepest, angle)
        begin, time = end, time + segment.duration
    position += math.hypot(state[0] - goal.x, state[1] - goal.y)
    heading += 0.0 if problem.settings.heading_free else abs(wrap_angle(state[2] - goal.theta))
    return Verification(position, heading, steepest / problem.planning_cone_angle,
                        steepest / problem.friction_angle, intervals)


def _planned_state(plan, time):
    sample = plan.trajectory.at(time)
    problem = plan.problem
    pose = sample['object_poses']
    c_x, c_y = sample['contact_poses'][:2] - pose[:2]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    place = problem.contact_point if problem.kind != 'rolling' else (c * c_x + s * c_y,
                                                                     c * c_y - s * c_x)
    return np.array([*pose, sample['object_twists'][2], sample['contact_poses'][2], *place])
