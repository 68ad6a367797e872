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
from push_model.state import ObjectTerms, State
from scipy.integrate import solve_ivp

STRETCH = 8.0
TOLERANCE = 1e-9


class Verification(NamedTuple):
    """
    What a re-integration found.

    :param position_error: distance from the goal at the end, mismatches between stretches
        included [m].
    :param heading_error: the same of the orientation [rad].
    :param cone_usage: largest angle of the contact force over the planning cone's half-angle.
    :param friction_usage: the same over the believed friction cone's half-angle.
    :param stretches: number of stretches; 1 is one integration from start to goal.
    """

    position_error: float
    heading_error: float
    cone_usage: float
    friction_usage: float
    stretches: int


class _Motion:
    """The equation of motion with the robot's constant pushing angle as input."""

    def __init__(self, problem):
        self.problem = problem
        self.terms = ObjectTerms.of(problem.obj)
        self.angle = 0.0
        function = equation_of_motion(problem.obj, problem.rolling)
        self._state, self._input, self._rate, self._force = (np.zeros(n) for n in (7, 5, 7, 2))
        self._buffer, self._evaluate = function.buffer()
        self._buffer.set_arg(0, memoryview(self._state))
        self._buffer.set_arg(1, memoryview(self._input))
        self._buffer.set_res(0, memoryview(self._rate))
        self._buffer.set_res(1, memoryview(self._force))

    def evaluate(self, state):
        problem, speed = self.problem, self.problem.settings.pushing_speed
        turn = speed * float(yaw_rate(problem.robot.drive, problem.robot.radius, self.angle,
                                      problem.heading_offset, state[3] / speed))
        bend = problem.rolling[0] * state[3] + (1.0 - problem.rolling[0]) * turn
        c, s = math.cos(state[4] + self.angle), math.sin(state[4] + self.angle)
        self._state[:] = state
        self._input[:] = speed * c, speed * s, -speed * bend * s, speed * bend * c, turn
        self._evaluate()
        return self._rate, self._force

    def rate(self, _, state):
        return self.evaluate(state)[0].copy()

    def switch(self, state, before, angle):
        speed = self.problem.settings.pushing_speed
        old = (0.0, 0.0) if before is None else (math.cos(state[4] + before),
                                                 math.sin(state[4] + before))
        jump, *_ = impulse(self.terms, State(*state),
                           speed * (math.cos(state[4] + angle) - old[0]),
                           speed * (math.sin(state[4] + angle) - old[1]))
        self.angle = angle
        changed = np.array(state)
        changed[3] += float(jump)
        return changed


def re_integrate(plan):
    """
    Integrate a plan from its start pose under its pushing angles.

    :param plan: the ``Plan``.
    :return: ``Verification``.
    """
    problem = plan.problem
    motion = _Motion(problem)
    state = np.array([*problem.start, 0.0, problem.normal, *problem.contact_point])
    position, heading, steepest = 0.0, 0.0, 0.0
    stretches, stretch_begin, before, begin = 1, 0.0, None, 0.0
    longest = STRETCH * problem.vehicle.wheelbase
    for angle, end in zip(plan.pushing_angles, plan.segment_ends):
        state = motion.switch(state, before, angle)
        if begin > stretch_begin and end - stretch_begin > longest:
            meant = _planned_state(plan, begin)
            position += math.hypot(*(state - meant)[:2])
            heading += abs(state[2] - meant[2])
            state, stretch_begin, stretches = meant, begin, stretches + 1
        state, steepest = _integrate(motion, state, end - begin, steepest)
        before, begin = angle, end
    goal = problem.goal
    position += math.hypot(state[0] - goal.x, state[1] - goal.y)
    heading += abs(wrap_angle(state[2] - goal.theta))
    return Verification(position, heading, steepest / problem.planning_angle,
                        steepest / problem.friction_angle, stretches)


def _integrate(motion, state, way, steepest):
    duration = way / motion.problem.settings.pushing_speed
    answer = solve_ivp(motion.rate, (0.0, duration), state, method='LSODA', rtol=TOLERANCE,
                       atol=1e-2 * TOLERANCE)
    if not answer.success:
        return np.full(7, np.nan), math.inf
    for sample in answer.y.T:
        f_n, f_t = motion.evaluate(sample)[1]
        steepest = max(steepest, abs(math.atan2(f_t, f_n)))
    return answer.y[:, -1], steepest


def _planned_state(plan, way):
    sample = plan.trajectory.at(way / plan.problem.settings.pushing_speed)
    return np.array([*sample['object_poses'], sample['object_twists'][2],
                     sample['contact_poses'][2], *plan.problem.contact_point])
