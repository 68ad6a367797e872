"""
Open-loop check of a plan: scipy integrates the equation of motion under the plan's input.

Nothing of the planner is used but the plan's trajectory: speed and direction at which it moves the
contact, relative to its normal. A push without feedback diverges from its path by ``exp(s / L)``,
so that long ones are simulated in sections, each from the plan's own state; the errors at the ends
of the sections are summed up.
"""

import math
from typing import Any, NamedTuple, Sequence, Union

import numpy as np
from push_model.dynamics import impulse, ObjectTerms, SMOOTHING, State
from push_model.equation_of_motion import equation_of_motion
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.robot_kinematics import yaw_rate
from push_model.trajectory import PushTrajectory
from push_planner.problem import PushProblem
from push_planner.steered.plan import Plan
from scipy.integrate import solve_ivp

# Lengths over the wheelbase, chosen: of sections, over which an error grows by exp(8) = 3000, and
# of the segments that are integrated at once.
SECTION_LENGTH = 8.0
MAX_SEGMENT_LENGTH = 1.0
# Relative tolerance of the integration; chosen: times 3000 still far below that of plans.
ACCURACY = 1e-9
# Samples that are closer in time are those before and after a jump [s]; chosen above the
# planner's spacing of such samples.
INSTANT = 2e-6
# Speed below which the direction of motion is not defined [m/s], least divisors of slopes, and
# relative change of a slope that is a break and no rounding; chosen.
MIN_SPEED = 1e-9
MIN_STEP = 1e-12
SLOPE_TOLERANCE = 1e-7
# Factor on all speeds for plans without inertia; chosen: inertia then counts 1e-6 as much.
QUASI_STATIC_FACTOR = 1e-3
Values = Union[Sequence[float], FloatArray]


class Replay(NamedTuple):
    """
    Result of simulating a plan in open loop.

    :param position_error: distance from the goal, plus the errors at the ends of sections [m].
    :param heading_error: the same of the heading, unless it is free, and of the contact normal
        between sections [rad].
    :param steepest: largest angle of the contact force from the normal [rad].
    :param path_length: of the contact [m].
    :param sections: number of sections.
    """

    position_error: float
    heading_error: float
    steepest: float
    path_length: float
    sections: int


class ContactMotion(NamedTuple):
    """
    Samples of the motion of the contact.

    :param times: shape (n,) [s].
    :param speeds: shape (n,) [m/s].
    :param angles: pushing angles, shape (n,) [rad].
    :param arc_lengths: of the contact, shape (n,) [m].
    :param breaks: indices of the samples at the ends of segments, increasing.
    """

    times: FloatArray
    speeds: FloatArray
    angles: FloatArray
    arc_lengths: FloatArray
    breaks: list[int]


class SegmentInput(NamedTuple):
    """
    Input on a segment: the speed is linear in time, the angle in arc length.

    :param start: when it begins [s].
    :param speed: of the contact at the start [m/s].
    :param acceleration: of the contact [m/s^2].
    :param angle: pushing angle at the start [rad].
    :param slope: of the pushing angle over the arc length [rad/m].
    """

    start: float
    speed: float
    acceleration: float
    angle: float
    slope: float


def contact_motion(trajectory: PushTrajectory, max_length: float,
                   speed_factor: float = 1.0) -> ContactMotion:
    """
    Read speed and pushing angle off a trajectory, and split it where their slopes change.

    :param trajectory: the ``PushTrajectory``.
    :param max_length: arc length after which it is split in any case [m].
    :param speed_factor: factor on all speeds.
    :return: ``ContactMotion``; between breaks the speed is linear in time, the angle in
        arc length.
    """
    times, twists = np.array(trajectory.times), trajectory.contact_twists
    speeds = np.hypot(twists[:, 0], twists[:, 1])
    angles = np.arctan2(twists[:, 1], twists[:, 0]) - trajectory.contact_poses[:, 2]
    angles = np.array([wrap_angle(angle) for angle in angles])
    still = np.flatnonzero(speeds < MIN_SPEED)
    angles[still] = angles[np.maximum(still - 1, 0)]
    jumps = np.flatnonzero(np.diff(times) < INSTANT)
    times[jumps] = times[jumps + 1]
    steps = np.diff(times)
    arc_lengths = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * steps)])
    angle_slopes = np.diff(angles) / np.maximum(np.diff(arc_lengths), MIN_STEP)
    speed_slopes = np.diff(speeds) / np.maximum(steps, MIN_STEP)
    cut = np.zeros(len(times), dtype=bool)
    for slopes in (angle_slopes, speed_slopes):
        cut[1:-1] |= np.abs(np.diff(slopes)) > SLOPE_TOLERANCE * (1.0 + np.abs(slopes[1:]))
    cut[1:] |= np.diff(arc_lengths // max_length) > 0.0
    cut[[0, -1]] = True
    return ContactMotion(times / speed_factor, speeds * speed_factor, angles, arc_lengths,
                         np.flatnonzero(cut).tolist())


class Push:
    """
    The equation of motion under a plan's input; state: ``State`` and the robot's heading.

    :param problem: the ``PushProblem``.
    :param speed_factor: factor on the speed below which friction at the supports is viscous.
    :param is_quasi_static: whether omega follows from friction alone.
    """

    def __init__(self, problem: PushProblem, speed_factor: float = 1.0,
                 is_quasi_static: bool = False) -> None:
        """Build the equation."""
        self.problem = problem
        self.terms = ObjectTerms.of(problem.obj)
        self._is_quasi_static = is_quasi_static
        self._robot_rotates = problem.kind != 'rolling'
        self._segment = SegmentInput(0.0, 0.0, 0.0, 0.0, 0.0)
        # State, input, rate of the state, force: memory that casadi reads and writes.
        self._arrays = [np.zeros(size) for size in (7, 5, 7, 2)]
        buffer: Any
        buffer, self._evaluate = equation_of_motion(
            problem.obj, problem.rolling, SMOOTHING * speed_factor).buffer()
        self._buffer = buffer
        memory: Any
        for i, memory in enumerate(self._arrays):
            (buffer.set_arg if i < 2 else buffer.set_res)(i % 2, memoryview(memory))

    def steer(self, start: float, speeds: Values, angles: Values, duration: float) -> None:
        """Set the input of a segment: its start [s], speed and angle at both ends, duration."""
        acceleration = (speeds[1] - speeds[0]) / duration
        path_length = 0.5 * (speeds[0] + speeds[1]) * duration
        self._segment = SegmentInput(start, speeds[0], acceleration, angles[0],
                                     (angles[1] - angles[0]) / path_length)

    def rate(self, time: float, state: FloatArray) -> FloatArray:
        """Compute the rate of the state; the contact force is stored."""
        start, speed, acceleration, angle, slope = self._segment
        passed = time - start
        angle += slope * (speed + 0.5 * acceleration * passed) * passed
        speed += acceleration * passed
        rolling_fraction, robot = self.problem.rolling[0], self.problem.robot
        state_in, input_in, rates, _ = self._arrays
        state_in[:] = state[:7]
        if self._is_quasi_static:
            toward = state[4] + angle - state[2]
            state_in[3] = quasi_static_yaw_rate(self.problem.obj, state[5:7],
                                                speed * math.cos(toward), speed * math.sin(toward))
        robot_omega = 0.0
        if self._robot_rotates:
            robot_omega = float(yaw_rate(robot.drive, robot.radius, angle, state[4] - state[7],
                                         state_in[3], speed))
        turning = (rolling_fraction * state_in[3] + (1.0 - rolling_fraction) * robot_omega
                   + slope * speed)
        c, s = math.cos(state[4] + angle), math.sin(state[4] + angle)
        input_in[:] = (speed * c, speed * s, acceleration * c - speed * turning * s,
                       acceleration * s + speed * turning * c, robot_omega)
        self._evaluate()
        if self._is_quasi_static:
            rates[3] = 0.0
        return np.append(rates, robot_omega)

    def jump(self, state: FloatArray, before: Values, after: Values) -> FloatArray:
        """Return the state after a jump of (speed, angle) of the contact."""
        (v_0, a_0), (v_1, a_1) = before, after
        gamma = state[4]
        d_omega, *_ = impulse(self.terms, State(*state[:7]),
                              v_1 * math.cos(gamma + a_1) - v_0 * math.cos(gamma + a_0),
                              v_1 * math.sin(gamma + a_1) - v_0 * math.sin(gamma + a_0))
        changed = np.array(state)
        changed[3] += float(d_omega)
        return changed

    def force(self, time: float, state: FloatArray) -> FloatArray:
        """Return the contact force along and across the normal, shape (2,) [N]."""
        self.rate(time, state)
        return self._arrays[3].copy()


def replay(plan: Plan, section_length: float = SECTION_LENGTH) -> Replay:
    """
    Simulate a plan in open loop.

    :param plan: the ``Plan``.
    :param section_length: length of the sections over the wheelbase.
    :return: ``Replay``; not finite where the integration fails.
    """
    problem = plan.problem
    # A push without inertia is the limit of slow pushes, forces included.
    is_quasi_static = problem.settings.motion_model == 'quasi_static'
    speed_factor = QUASI_STATIC_FACTOR if is_quasi_static else 1.0
    wheelbase = problem.vehicle.wheelbase
    track = contact_motion(plan.trajectory, MAX_SEGMENT_LENGTH * wheelbase, speed_factor)
    push, max_length = Push(problem, speed_factor, is_quasi_static), section_length * wheelbase
    state = np.array([*problem.start, 0.0, problem.normal, *problem.contact_point,
                      problem.heading])
    state = push.jump(state, (0.0, 0.0), (track.speeds[0], track.angles[0]))
    errors = np.zeros(2)
    section_start, sections, steepest = 0.0, 1, 0.0
    for first, last in zip(track.breaks, track.breaks[1:]):
        ends = [first, last]
        duration = track.times[last] - track.times[first]
        if duration == 0.0:
            state = push.jump(state, *zip(track.speeds[ends], track.angles[ends]))
            continue
        if (track.arc_lengths[first] > section_start
                and track.arc_lengths[last] - section_start > max_length):
            planned = _planned_state(plan.trajectory, problem, first, speed_factor)
            errors += math.hypot(*(state - planned)[:2]), np.abs(state - planned)[[2, 4]].max()
            state, section_start, sections = planned, track.arc_lengths[first], sections + 1
        push.steer(track.times[first], track.speeds[ends], track.angles[ends], duration)
        course = solve_ivp(push.rate, track.times[ends], state, method='LSODA', rtol=ACCURACY,
                           atol=1e-2 * ACCURACY)
        if not course.success:
            return Replay(math.inf, math.inf, math.inf, track.arc_lengths[-1], sections)
        forces = np.array([*map(push.force, course.t, course.y.T)])
        steepest = max(steepest, np.abs(np.arctan2(forces[:, 1], forces[:, 0])).max())
        state = course.y[:, -1]
    heading_error = 0.0
    if not problem.settings.heading_free:
        heading_error = wrap_angle(state[2] - problem.goal.theta)
    errors += (math.hypot(state[0] - problem.goal.x, state[1] - problem.goal.y),
               abs(heading_error))
    return Replay(float(errors[0]), float(errors[1]), float(steepest),
                  float(track.arc_lengths[-1]), sections)


def _planned_state(trajectory: PushTrajectory, problem: PushProblem, index: int,
                   speed_factor: float) -> FloatArray:
    pose = Pose(*trajectory.object_poses[index].tolist())
    x, y, gamma = trajectory.contact_poses[index]
    return np.array([*pose, speed_factor * trajectory.object_twists[index, 2], gamma,
                     *pose.inverse().transform((x, y)), trajectory.robot_poses[index, 2]])
