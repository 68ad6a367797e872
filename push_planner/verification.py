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
from push_model.drive import yaw_rate
from push_model.dynamics import equation_of_motion, impulse
from push_model.geometry import wrap_angle
from push_model.quasi_static import turning_rate
from push_model.state import ObjectTerms, State
from scipy.integrate import solve_ivp

STRETCH = 8.0
TOLERANCE = 1e-9


class Verification(NamedTuple):
    """
    What a re-integration found.

    :param position_error: distance from the goal at the end, mismatches between stretches
        included [m].
    :param heading_error: the same of the orientation [rad]; 0 where the heading is free.
    :param cone_usage: largest angle of the contact force over the planning cone's half-angle.
    :param friction_usage: the same over the believed friction cone's half-angle.
    :param stretches: number of stretches; 1 is one integration from start to goal.
    """

    position_error: float
    heading_error: float
    cone_usage: float
    friction_usage: float
    stretches: int


class _Piece(NamedTuple):
    """A piece of the push: pushing angles, squared speeds, length."""

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
        """Pushing angle, its rate, and speed after a time."""
        speed = self.speeds[0] + self.acceleration * time
        bend = (self.angles[1] - self.angles[0]) / self.length
        way = 0.5 * (self.speeds[0] + speed) * time
        return self.angles[0] + bend * way, bend * speed, speed


class _Motion:
    """The equation of motion under the pieces of a plan; the object frame is the world's."""

    def __init__(self, problem):
        self.problem = problem
        # Where robot and object turn as one, the contact stays: omega_p is omega.
        self.terms, self.held = ObjectTerms.of(problem.obj), problem.kind == 'held'
        function = equation_of_motion(problem.obj, problem.rolling)
        self._state, self._input, self._rate, self._force = (np.zeros(n) for n in (7, 5, 7, 2))
        self._buffer, self._evaluate = function.buffer()
        self._buffer.set_arg(0, memoryview(self._state))
        self._buffer.set_arg(1, memoryview(self._input))
        self._buffer.set_res(0, memoryview(self._rate))
        self._buffer.set_res(1, memoryview(self._force))
        self.piece = None

    def robot_rate(self, state, angle, speed):
        problem = self.problem
        if problem.kind == 'rolling':
            return 0.0
        return float(yaw_rate(problem.robot.drive, problem.robot.radius, angle,
                              problem.heading_offset, state[3], speed))

    def evaluate(self, time, state):
        angle, bend, speed = self.piece.at(time)
        turn = self.robot_rate(state, angle, speed)
        share = self.problem.rolling[0]
        bend += share * state[3] + (1.0 - share) * turn
        c, s, faster = math.cos(state[4] + angle), math.sin(state[4] + angle), (
            self.piece.acceleration)
        self._state[:] = state
        self._input[:] = (speed * c, speed * s, faster * c - speed * bend * s,
                          faster * s + speed * bend * c, turn)
        self._evaluate()
        return self._rate, self._force

    def rate(self, time, state):
        return self.evaluate(time, state)[0].copy()

    def enter(self, state, piece):
        """Begin a piece: the velocity imposed at the contact may jump."""
        before, self.piece = self.piece, piece
        changed = np.array(state)
        motion = self.problem.motion
        if before is not None and before.angles[1] == piece.angles[0] and (
                before.speeds[1] == piece.speeds[0]):
            return changed
        if before is None and motion.speed > 0.0:
            changed[3] = motion.yaw_rate / motion.speed * piece.speeds[0]
            return changed
        v_x, v_y = _velocity(state[4] + piece.angles[0], piece.speeds[0])
        if before is not None:
            was_x, was_y = _velocity(state[4] + before.angles[1], before.speeds[1])
            v_x, v_y = v_x - was_x, v_y - was_y
        jump, *_ = impulse(self.terms, State(*state), v_x, v_y)
        changed[3] += float(jump)
        return changed


class _SlowMotion(_Motion):
    """The same without inertia: omega follows from friction alone."""

    def enter(self, state, piece):
        self.piece = piece
        return np.array(state)

    def evaluate(self, time, state):
        angle, _, speed = self.piece.at(time)
        direction = state[4] + angle - state[2]
        state = np.array(state)
        state[3] = turning_rate(self.problem.obj, tuple(state[5:7]),
                                *_velocity(direction, speed))
        super().evaluate(time, state)
        self._rate[3] = 0.0
        return self._rate, self._force


def re_integrate(plan):
    """
    Integrate a plan from its start pose under its pushing angles and speeds.

    :param plan: the ``Plan``.
    :return: ``Verification``.
    """
    problem, goal = plan.problem, plan.problem.goal
    slow = problem.settings.motion_model == 'quasi_static'
    motion = (_SlowMotion if slow else _Motion)(problem)
    state = np.array([*problem.start, 0.0, problem.normal, *problem.contact_point])
    position, heading, steepest = 0.0, 0.0, 0.0
    stretches, stretch_begin, begin, time = 1, 0.0, 0.0, 0.0
    longest = STRETCH * problem.vehicle.wheelbase
    for angles, speeds, end in zip(plan.pushing_angles, plan.speeds, plan.segment_ends):
        piece = _Piece(angles, speeds, end - begin)
        state = motion.enter(state, piece)
        if begin > stretch_begin and end - stretch_begin > longest:
            meant = _planned_state(plan, time)
            position += math.hypot(*(state - meant)[:2])
            heading += abs(state[2] - meant[2])
            state, stretch_begin, stretches = meant, begin, stretches + 1
        state, steepest = _integrate(motion, state, steepest)
        begin, time = end, time + piece.duration
    position += math.hypot(state[0] - goal.x, state[1] - goal.y)
    heading += 0.0 if problem.settings.heading_free else abs(wrap_angle(state[2] - goal.theta))
    return Verification(position, heading, steepest / problem.planning_angle,
                        steepest / problem.friction_angle, stretches)


def _integrate(motion, state, steepest):
    answer = solve_ivp(motion.rate, (0.0, motion.piece.duration), state, method='LSODA',
                       rtol=TOLERANCE, atol=1e-2 * TOLERANCE)
    if not answer.success:
        return np.full(7, np.nan), math.inf
    for time, sample in zip(answer.t, answer.y.T):
        f_n, f_t = motion.evaluate(time, sample)[1]
        steepest = max(steepest, abs(math.atan2(f_t, f_n)))
    return answer.y[:, -1], steepest


def _velocity(angle, speed):
    return speed * math.cos(angle), speed * math.sin(angle)


def _planned_state(plan, time):
    sample = plan.trajectory.at(time)
    problem = plan.problem
    pose = sample['object_poses']
    c_x, c_y = sample['contact_poses'][:2] - pose[:2]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    place = problem.contact_point if problem.kind != 'rolling' else (c * c_x + s * c_y,
                                                                     c * c_y - s * c_x)
    return np.array([*pose, sample['object_twists'][2], sample['contact_poses'][2], *place])
