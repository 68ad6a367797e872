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
from push_planner.verification.open_loop import driven_push


class Piece(NamedTuple):
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


def pieces_of(plan, pace=1.0):
    """
    List the pieces of a plan.

    :param plan: the ``Plan``.
    :param pace: factor on all its speeds.
    :return: list of ``Piece``.
    """
    lengths = np.diff(plan.segment_ends, prepend=0.0).tolist()
    return [Piece(angles, (pace * speeds[0], pace * speeds[1]), length)
            for angles, speeds, length in zip(plan.pushing_angles, plan.speeds, lengths)]


def joined(pieces):
    """
    Join neighbours that push on at the same angle and speed.

    :param pieces: list of ``Piece``.
    :return: list of ``Piece``, as few as there can be.
    """
    found = []
    for piece in pieces:
        steady = len({*piece.angles}) == len({*piece.speeds}) == 1
        if found and steady and found[-1][:2] == piece[:2]:
            found[-1] = found[-1]._replace(length=found[-1].length + piece.length)
        else:
            found.append(piece)
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
