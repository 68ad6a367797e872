"""
Open-loop simulation: an object driven by the segments of a plan, on ``push_model.dynamics``.

The equation of motion is the model's own, in time and with its own axes: nothing of it is shared
with the nonlinear program. Integrated by scipy's LSODA.
"""

from collections.abc import Callable
import math
from typing import Any, NamedTuple, Optional

import numpy as np
from push_model.dynamics import impulse, Input, ObjectTerms, State
from push_model.equation_of_motion import equation_of_motion
from push_model.geometry import FloatArray
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.robot_kinematics import yaw_rate
from push_planner.problem import PushProblem

# Relative tolerance of the integration; the absolute one is a hundredth of it. Chosen: far below
# the errors that plans may have, and above rounding.
TOLERANCE = 1e-9


class PushSegment(NamedTuple):
    """
    A segment of a push: pushing angle and squared speed linear in the path length of the contact.

    :param angles: pushing angle at its start and its end [rad].
    :param speeds: of the contact at its start and its end [m/s].
    :param length: path length of the contact [m].
    """

    angles: tuple[float, float]
    speeds: tuple[float, float]
    length: float

    @property
    def acceleration(self) -> float:
        """Acceleration of the contact along the push [m/s^2]."""
        return 0.5 * (self.speeds[1] ** 2 - self.speeds[0] ** 2) / self.length

    @property
    def duration(self) -> float:
        """Time that it takes [s]."""
        return 2.0 * self.length / (self.speeds[0] + self.speeds[1])

    def at(self, time: float) -> tuple[float, float, float]:
        """
        Find the input after a time.

        :param time: since its start [s].
        :return: (pushing angle [rad], its rate [rad/s], speed [m/s]).
        """
        speed = self.speeds[0] + self.acceleration * time
        angle_slope = (self.angles[1] - self.angles[0]) / self.length
        s = 0.5 * (self.speeds[0] + speed) * time
        return self.angles[0] + angle_slope * s, angle_slope * speed, speed


class SegmentEnd(NamedTuple):
    """
    Result of integrating over a segment.

    :param state: at its end; nan where the integration failed.
    :param force_angle: largest angle of the contact force from the normal [rad]; infinite there.
    """

    state: FloatArray
    force_angle: float


def integrate(rate: Callable[[float, FloatArray], FloatArray],
              force: Callable[[float, FloatArray], FloatArray], duration: float,
              start: FloatArray) -> SegmentEnd:
    """
    Integrate over a segment.

    :param rate: function of (time [s], state) that returns the rate of the state.
    :param force: function of the same that returns the contact force (F_n, F_t) [N].
    :param duration: of the segment [s].
    :param start: state at its start.
    """
    # Imported here: a planner that does not verify its plans needs nothing of scipy.
    from scipy.integrate import solve_ivp
    answer = solve_ivp(rate, (0.0, duration), start, method='LSODA', rtol=TOLERANCE,
                       atol=1e-2 * TOLERANCE)
    if not answer.success:
        return SegmentEnd(np.full(len(start), np.nan), math.inf)
    forces = np.array([force(*sample).copy() for sample in zip(answer.t, answer.y.T)])
    return SegmentEnd(answer.y[:, -1],
                      float(np.abs(np.arctan2(forces[:, 1], forces[:, 0])).max()))


def open_loop_simulation(problem: PushProblem) -> 'OpenLoopSimulation':
    """Make the simulation of a problem, with inertia or without."""
    if problem.settings.motion_model == 'quasi_static':
        return QuasiStaticSimulation(problem)
    return OpenLoopSimulation(problem)


class OpenLoopSimulation:
    """
    The equation of motion under the segments of a plan.

    States are arrays in the order of ``push_model.dynamics.STATE``. The object frame of the start
    is that of the problem in the world.

    :param problem: the ``PushProblem`` with object, contact and robot.
    """

    def __init__(self, problem: PushProblem) -> None:
        """Build the equation of motion."""
        self.problem = problem
        self.segment: Optional[PushSegment] = None
        self._terms = ObjectTerms.of(problem.obj)
        function = equation_of_motion(problem.obj, problem.rolling)
        self._state = np.zeros(7)
        self._input = np.zeros(5)
        self._rate = np.zeros(7)
        self._force = np.zeros(2)
        buffer: Any
        buffer, self._evaluate = function.buffer()
        # Alive as long as what it evaluates.
        self._buffer = buffer
        self._buffer.set_arg(0, self._state.data)
        self._buffer.set_arg(1, self._input.data)
        self._buffer.set_res(0, self._rate.data)
        self._buffer.set_res(1, self._force.data)

    def start(self) -> FloatArray:
        """Start where the problem does, nothing imposed yet; return the state."""
        self.segment = None
        return np.array([*self.problem.start, 0.0, self.problem.normal,
                         *self.problem.contact_point])

    def inputs(self, time: float, state: FloatArray) -> Input:
        """
        Find what the present segment imposes.

        :param time: since its start [s].
        :param state: of the object.
        """
        segment = self._present()
        angle, direction_rate, speed = segment.at(time)
        robot_omega = self._robot_yaw_rate(state, angle, speed)
        lam = self.problem.rolling.normal_ratio
        direction_rate += lam * state[3] + (1.0 - lam) * robot_omega
        c, s = math.cos(state[4] + angle), math.sin(state[4] + angle)
        acceleration = segment.acceleration
        return Input(speed * c, speed * s, acceleration * c - speed * direction_rate * s,
                     acceleration * s + speed * direction_rate * c, robot_omega)

    def respond(self, state: FloatArray, inputs: Input) -> tuple[FloatArray, FloatArray]:
        """
        Find how the object responds.

        :param state: of the object.
        :return: (rate of the state, contact force (F_n, F_t) [N]), overwritten by the next call.
        """
        self._state[:] = state
        self._input[:] = inputs
        self._evaluate()
        return self._rate, self._force

    def evaluate(self, time: float, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """
        Respond to the present segment.

        :param time: since its start [s].
        :param state: of the object.
        :return: as of ``respond``.
        """
        return self.respond(state, self.inputs(time, state))

    def integrate_segment(self, state: FloatArray) -> SegmentEnd:
        """
        Integrate to the end of the present segment.

        :param state: of the object.
        """
        return integrate(lambda time, at: self.evaluate(time, at)[0].copy(),
                         lambda time, at: self.evaluate(time, at)[1], self._present().duration,
                         state)

    def start_segment(self, state: FloatArray,
                      segment: PushSegment) -> tuple[FloatArray, tuple[float, float]]:
        """
        Start a segment: the velocity imposed at the contact may jump.

        :param state: of the object.
        :return: (state after the jump, (v_x, v_y) of the jump [m/s]).
        """
        before = self.segment
        self.segment = segment
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
            before_x, before_y = _velocity(state[4] + before.angles[1], before.speeds[1])
            v_x, v_y = v_x - before_x, v_y - before_y
        return self.apply_velocity_jump(state, (v_x, v_y)), (v_x, v_y)

    def apply_velocity_jump(self, state: FloatArray, jump: tuple[float, float]) -> FloatArray:
        """
        Return the state after a jump of the velocity imposed at the contact.

        :param state: of the object.
        :param jump: (v_x, v_y) [m/s].
        """
        changed = np.array(state)
        changed[3] += float(impulse(self._terms, State(*state), *jump)[0])
        return changed

    def _present(self) -> PushSegment:
        if self.segment is None:
            raise RuntimeError('segment: got none, expected a call of start_segment before')
        return self.segment

    def _robot_yaw_rate(self, state: FloatArray, angle: float, speed: float) -> float:
        problem = self.problem
        if problem.kind == 'rolling':
            return 0.0
        return float(yaw_rate(problem.robot.drive, problem.robot.radius, angle,
                              problem.heading_offset, state[3], speed))


class QuasiStaticSimulation(OpenLoopSimulation):
    """The same without inertia: omega follows from friction alone."""

    def apply_velocity_jump(self, state: FloatArray, jump: tuple[float, float]) -> FloatArray:
        """
        Return the state as it is: nothing has inertia.

        :param jump: (v_x, v_y), not used [m/s].
        """
        return np.array(state)

    def evaluate(self, time: float, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Respond to the present segment with the yaw rate that friction demands."""
        angle, _, speed = self._present().at(time)
        direction = state[4] + angle - state[2]
        state = np.array(state)
        state[3] = quasi_static_yaw_rate(self.problem.obj, tuple(state[5:7]),
                                         *_velocity(direction, speed))
        super().evaluate(time, state)
        self._rate[3] = 0.0
        return self._rate, self._force


def _velocity(angle: float, speed: float) -> tuple[float, float]:
    return speed * math.cos(angle), speed * math.sin(angle)
