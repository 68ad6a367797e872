"""
An object driven by the pieces of a plan, on ``push_model.dynamics`` as it stands.

The object frame of the start is that of the world.
"""

import math

import numpy as np
from push_model.dynamics import equation_of_motion, impulse, Input, ObjectTerms, State
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.robot_kinematics import yaw_rate
from scipy.integrate import solve_ivp

TOLERANCE = 1e-9


def integrate(rate, force, duration, start):
    """
    Integrate over a piece.

    :param rate: function of (time [s], state) that returns the rate of the state.
    :param force: function of the same that returns the contact force (F_n, F_t) [N].
    :param duration: of the piece [s].
    :param start: state at its begin.
    :return: (state at its end, largest angle of the force from the normal [rad]); nan and
        infinite where the integration fails.
    """
    answer = solve_ivp(rate, (0.0, duration), start, method='LSODA', rtol=TOLERANCE,
                       atol=1e-2 * TOLERANCE)
    if not answer.success:
        return np.full(len(start), np.nan), math.inf
    pressed = np.array([force(*sample).copy() for sample in zip(answer.t, answer.y.T)])
    return answer.y[:, -1], float(np.abs(np.arctan2(pressed[:, 1], pressed[:, 0])).max())


def open_loop_simulation(problem):
    """
    Make what drives the object of a problem, with inertia or without.

    :param problem: the ``PushProblem``.
    :return: ``OpenLoopSimulation``.
    """
    slow = problem.settings.motion_model == 'quasi_static'
    return (QuasiStaticSimulation if slow else OpenLoopSimulation)(problem)


class OpenLoopSimulation:
    """
    The equation of motion under the pieces of a plan.

    States are arrays in the order of ``push_model.dynamics.STATE``.

    :param problem: the ``PushProblem`` with object, contact and robot.
    """

    def __init__(self, problem):
        """Build the equation of motion."""
        self.problem = problem
        self.terms = ObjectTerms.of(problem.obj)
        function = equation_of_motion(problem.obj, problem.rolling)
        self._state, self._input, self._rate, self._force = (np.zeros(n) for n in (7, 5, 7, 2))
        self._buffer, self._evaluate = function.buffer()
        self._buffer.set_arg(0, memoryview(self._state))
        self._buffer.set_arg(1, memoryview(self._input))
        self._buffer.set_res(0, memoryview(self._rate))
        self._buffer.set_res(1, memoryview(self._force))
        self.segment = None

    def start(self):
        """Begin where the problem does, nothing imposed yet; return the state."""
        self.segment = None
        return np.array([*self.problem.start, 0.0, self.problem.normal,
                         *self.problem.contact_point])

    def inputs(self, time, state):
        """
        Find what the present piece imposes.

        :param time: since its begin [s].
        :param state: of the object.
        :return: ``Input``.
        """
        angle, bend, speed = self.segment.at(time)
        turn = self._robot_rate(state, angle, speed)
        share = self.problem.rolling[0]
        bend += share * state[3] + (1.0 - share) * turn
        c, s, faster = math.cos(state[4] + angle), math.sin(state[4] + angle), (
            self.segment.acceleration)
        return Input(speed * c, speed * s, faster * c - speed * bend * s,
                     faster * s + speed * bend * c, turn)

    def respond(self, state, inputs):
        """
        Find how the object answers.

        :param state: of the object.
        :param inputs: ``Input``.
        :return: (rate of the state, contact force (F_n, F_t) [N]), overwritten by the next call.
        """
        self._state[:] = state
        self._input[:] = inputs
        self._evaluate()
        return self._rate, self._force

    def evaluate(self, time, state):
        """Answer to the present piece; as ``respond``."""
        return self.respond(state, self.inputs(time, state))

    def integrate_segment(self, state):
        """
        Drive the object to the end of the present piece.

        :param state: of the object.
        :return: as ``integrate``.
        """
        return integrate(lambda time, at: self.evaluate(time, at)[0].copy(),
                         lambda time, at: self.evaluate(time, at)[1], self.segment.duration, state)

    def start_segment(self, state, segment):
        """
        Begin a piece: the velocity imposed at the contact may jump.

        :param state: of the object.
        :param segment: ``Segment``.
        :return: (state after the jump, (v_x, v_y) of the jump [m/s]).
        """
        before, self.segment = self.segment, segment
        if before is not None and before.angles[1] == segment.angles[0] and (
                before.speeds[1] == segment.speeds[0]):
            return np.array(state), (0.0, 0.0)
        motion = self.problem.motion
        if before is None and motion.speed > 0.0:
            changed = np.array(state)
            changed[3] = motion.yaw_rate / motion.speed * segment.speeds[0]
            return changed, (0.0, 0.0)
        v_x, v_y = _velocity(state[4] + segment.angles[0], segment.speeds[0])
        if before is not None:
            was_x, was_y = _velocity(state[4] + before.angles[1], before.speeds[1])
            v_x, v_y = v_x - was_x, v_y - was_y
        return self.apply_velocity_jump(state, (v_x, v_y)), (v_x, v_y)

    def apply_velocity_jump(self, state, jump):
        """
        Return the state after a jump of the velocity imposed at the contact.

        :param state: of the object.
        :param jump: (v_x, v_y) [m/s].
        """
        changed = np.array(state)
        changed[3] += float(impulse(self.terms, State(*state), *jump)[0])
        return changed

    def _robot_rate(self, state, angle, speed):
        problem = self.problem
        if problem.kind == 'rolling':
            return 0.0
        return float(yaw_rate(problem.robot.drive, problem.robot.radius, angle,
                              problem.heading_offset, state[3], speed))


class QuasiStaticSimulation(OpenLoopSimulation):
    """The same without inertia: omega follows from friction alone."""

    def apply_velocity_jump(self, state, jump):
        """Return the state as it is: nothing has inertia."""
        return np.array(state)

    def evaluate(self, time, state):
        """As in the base class, at the turning rate that friction has."""
        angle, _, speed = self.segment.at(time)
        direction = state[4] + angle - state[2]
        state = np.array(state)
        state[3] = quasi_static_yaw_rate(self.problem.obj, tuple(state[5:7]),
                                         *_velocity(direction, speed))
        super().evaluate(time, state)
        self._rate[3] = 0.0
        return self._rate, self._force


def _velocity(angle, speed):
    return speed * math.cos(angle), speed * math.sin(angle)
