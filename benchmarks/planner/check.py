"""
A plan driven anew: its robot's motion, and what scipy makes of it on the equation of motion.

Takes nothing of the planner but the plan's trajectory: speed and direction at which it moves the
contact, against its normal. A push without feedback runs away from its path by ``exp(s / L)``, so
that long ones are driven in stretches, each from the plan's own state; what they miss is added up.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.dynamics import equation_of_motion, impulse, ObjectTerms, SMOOTHING, State
from push_model.geometry import Pose, wrap_angle
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.robot_kinematics import yaw_rate
from scipy.integrate import solve_ivp

SECTION_LENGTH = 8.0
MAX_SEGMENT_LENGTH = 1.0
ACCURACY = 1e-9
INSTANT = 2e-6
STRAIGHT = 1e-7
SLOWER = 1e-3


class Replay(NamedTuple):
    """
    How a plan ends when driven.

    :param position_error: distance from the goal, with what the stretches miss [m].
    :param heading_error: the same of the heading, unless it is free, and of the contact normal
        between stretches [rad].
    :param steepest: largest angle of the contact force from the normal [rad].
    :param path_length: of the contact [m].
    :param sections: number of stretches.
    """

    position_error: float
    heading_error: float
    steepest: float
    path_length: float
    sections: int


class ContactMotion(NamedTuple):
    """Samples of what moves the contact: times, speeds, pushing angles; where pieces begin."""

    times: np.ndarray
    speeds: np.ndarray
    angles: np.ndarray
    arc_lengths: np.ndarray
    breaks: list


def contact_motion(trajectory, longest, slower=1.0):
    """
    Read speed and pushing angle off a trajectory, and cut it where they bend or jump.

    :param trajectory: the ``PushTrajectory``.
    :param longest: way after which it is cut in any case, for stretches to end there [m].
    :param slower: factor on all speeds.
    :return: ``ContactMotion``; between breaks the speed is linear in time, the angle in
        arc length.
    """
    times, twists = np.array(trajectory.times), trajectory.contact_twists
    speeds = np.hypot(twists[:, 0], twists[:, 1])
    angles = np.arctan2(twists[:, 1], twists[:, 0]) - trajectory.contact_poses[:, 2]
    angles = np.array([wrap_angle(angle) for angle in angles])
    still = np.flatnonzero(speeds < 1e-9)
    angles[still] = angles[np.maximum(still - 1, 0)]
    jumps = np.flatnonzero(np.diff(times) < INSTANT)
    times[jumps] = times[jumps + 1]
    steps = np.diff(times)
    arc_lengths = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * steps)])
    bends = (np.diff(angles) / np.maximum(np.diff(arc_lengths), 1e-12),
             np.diff(speeds) / np.maximum(steps, 1e-12))
    cut = np.zeros(len(times), dtype=bool)
    for slopes in bends:
        cut[1:-1] |= np.abs(np.diff(slopes)) > STRAIGHT * (1.0 + np.abs(slopes[1:]))
    cut[1:] |= np.diff(arc_lengths // longest) > 0.0
    cut[[0, -1]] = True
    return ContactMotion(times / slower, speeds * slower, angles, arc_lengths,
                         np.flatnonzero(cut).tolist())


class Push:
    """
    The equation of motion under a plan's input; state: ``State`` and the robot's heading.

    :param problem: the ``PushProblem``.
    :param slower: factor on the speed at which friction under the supports turns viscous.
    :param slow: whether omega follows from friction alone.
    """

    def __init__(self, problem, slower=1.0, slow=False):
        """Build the equation."""
        self.problem, self._slow = problem, slow
        self._turns = problem.kind != 'rolling'
        self.terms = ObjectTerms.of(problem.obj)
        self._piece = None
        self._arrays = [np.zeros(size) for size in (7, 5, 7, 2)]
        self._buffer, self._evaluate = equation_of_motion(
            problem.obj, problem.rolling, SMOOTHING * slower).buffer()
        for i, array in enumerate(self._arrays):
            (self._buffer.set_arg if i < 2 else self._buffer.set_res)(i % 2, memoryview(array))

    def steer(self, begin, speeds, angles, duration):
        """Set the input of a piece: its begin [s], and speed and angle at both ends."""
        change = (speeds[1] - speeds[0]) / duration
        path_length = 0.5 * (speeds[0] + speeds[1]) * duration
        self._piece = begin, speeds[0], change, angles[0], (angles[1] - angles[0]) / path_length

    def rate(self, time, state):
        """Return the rate of the state; the contact force is kept."""
        begin, speed, change, angle, slope = self._piece
        passed = time - begin
        angle += slope * (speed + 0.5 * change * passed) * passed
        speed += change * passed
        share, (robot, (held, fed, rates, _)) = self.problem.rolling[0], (
            self.problem.robot, self._arrays)
        held[:] = state[:7]
        if self._slow:
            ahead = state[4] + angle - state[2]
            held[3] = quasi_static_yaw_rate(self.problem.obj, state[5:7], speed * math.cos(ahead),
                                            speed * math.sin(ahead))
        turn = 0.0
        if self._turns:
            turn = float(yaw_rate(robot.drive, robot.radius, angle, state[4] - state[7], held[3],
                                  speed))
        bend = share * held[3] + (1.0 - share) * turn + slope * speed
        c, s = math.cos(state[4] + angle), math.sin(state[4] + angle)
        fed[:] = (speed * c, speed * s, change * c - speed * bend * s,
                  change * s + speed * bend * c, turn)
        self._evaluate()
        if self._slow:
            rates[3] = 0.0
        return np.append(rates, turn)

    def jump(self, state, before, after):
        """Return the state after a jump of (speed, angle) of the contact."""
        (v_0, a_0), (v_1, a_1) = before, after
        gamma = state[4]
        turn, *_ = impulse(self.terms, State(*state[:7]),
                           v_1 * math.cos(gamma + a_1) - v_0 * math.cos(gamma + a_0),
                           v_1 * math.sin(gamma + a_1) - v_0 * math.sin(gamma + a_0))
        changed = np.array(state)
        changed[3] += float(turn)
        return changed

    def force(self, time, state):
        """Return the contact force along and across the normal, shape (2,) [N]."""
        self.rate(time, state)
        return self._arrays[3].copy()


def replay(plan, section_length=SECTION_LENGTH):
    """
    Drive a plan.

    :param plan: with ``problem`` and ``trajectory``.
    :param section_length: length of the stretches over the wheelbase.
    :return: ``Replay``; not finite where the integration fails.
    """
    problem = plan.problem
    # Without inertia is the limit of slow pushes, forces included.
    slow = problem.settings.motion_model == 'quasi_static'
    slower = SLOWER if slow else 1.0
    wheelbase = problem.vehicle.wheelbase
    track = contact_motion(plan.trajectory, MAX_SEGMENT_LENGTH * wheelbase, slower)
    push, longest = Push(problem, slower, slow), section_length * wheelbase
    state = np.array([*problem.start, 0.0, problem.normal, *problem.contact_point,
                      problem.heading])
    state = push.jump(state, (0.0, 0.0), (track.speeds[0], track.angles[0]))
    missed, begun, sections, steepest = np.zeros(2), 0.0, 1, 0.0
    for first, last in zip(track.breaks, track.breaks[1:]):
        ends, duration = [first, last], track.times[last] - track.times[first]
        if duration == 0.0:
            state = push.jump(state, *zip(track.speeds[ends], track.angles[ends]))
            continue
        if track.arc_lengths[first] > begun and track.arc_lengths[last] - begun > longest:
            meant = _planned(plan.trajectory, problem, first, slower)
            missed += math.hypot(*(state - meant)[:2]), np.abs(state - meant)[[2, 4]].max()
            state, begun, sections = meant, track.arc_lengths[first], sections + 1
        push.steer(track.times[first], track.speeds[ends], track.angles[ends], duration)
        answer = solve_ivp(push.rate, track.times[ends], state, method='LSODA', rtol=ACCURACY,
                           atol=1e-2 * ACCURACY)
        if not answer.success:
            return Replay(math.inf, math.inf, math.inf, track.arc_lengths[-1], sections)
        forces = np.array([*map(push.force, answer.t, answer.y.T)])
        steepest = max(steepest, np.abs(np.arctan2(forces[:, 1], forces[:, 0])).max())
        state = answer.y[:, -1]
    heading_error = 0.0
    if not problem.settings.heading_free:
        heading_error = wrap_angle(state[2] - problem.goal.theta)
    missed += math.hypot(state[0] - problem.goal.x, state[1] - problem.goal.y), abs(heading_error)
    return Replay(*missed.tolist(), float(steepest), float(track.arc_lengths[-1]), sections)


def _planned(trajectory, problem, index, slower):
    pose, (x, y, gamma) = Pose(*trajectory.object_poses[index]), trajectory.contact_poses[index]
    return np.array([*pose, slower * trajectory.object_twists[index, 2], gamma,
                     *pose.inverse().transform((x, y)), trajectory.robot_poses[index, 2]])
