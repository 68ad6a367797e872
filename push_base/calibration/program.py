"""
Commands by which a base is calibrated, as a state machine that knows neither ROS nor a clock.

The program is a list of blocks, each a list of segments: a constant command or a ramp, for a time.
Between blocks the robot goes back to where the block starts. All motions are timed, as the
integral of a command does not depend on how late or slowly the base follows it; odometry says
where the robot is, and ends a segment that would leave the free square.
"""

from collections import deque
from collections.abc import Callable
import math
from typing import NamedTuple

from push_base.calibration.motion_watch import MotionWatch, SPEED_RATIO
from push_base.calibration.recording import (
    Interruption, Purpose, ReceivedOdometry, Recording, SentCommand,
)
from push_base.calibration.touch_program import TouchPlan, TouchProgram
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist

# Side of the free square, in whose middle the robot starts [m].
SIDE = 2.0
# Distance that the robot keeps from its edge beside what it needs to stop [m]; chosen: what
# odometry may be off by within the program.
MARGIN = 0.05
# What a base needs at most until a stop acts: dead time and lag [s], and part of its stated
# acceleration; chosen: above what is drivable at all.
STOP_DELAY, BRAKING_RATIO = 0.5, 0.4
# Speeds of steps and lines [m/s]; chosen: above every dead band that can be pushed with.
STEP_SPEEDS = 0.3, 0.18
MIN_STEP_SPEED = 0.12
# Rest at the start, and until the robot rests for sure after a segment [s].
REST_TIME, SETTLE_TIME = 5.0, 1.2
# Ramps: rates [m/s^2, rad/s^2], greatest values [m/s, rad/s], and motion that ends them [m, rad].
RAMP_RATE, YAW_RAMP_RATE = 0.025, 0.1
RAMP_TOP, YAW_RAMP_TOP = 0.3, 1.2
RAMP_TRAVEL, YAW_RAMP_TRAVEL = 0.25, 0.8
RAMP_REPEATS = 2
# Greatest yaw rate of turns [rad/s], and turns in each direction.
MAX_TURN_RATE, TURNS = 2.5, 1.5
# Distance from the start of a block, and heading, that are put right before it [m, rad].
NEAR, NEAR_HEADING = 0.08, 0.12
# Time without odometry after which the robot stops [s].
ODOMETRY_TIMEOUT = 0.5
# Time after the end in which zeros are sent [s].
ENDING_TIME = 0.5
# Part of what the first steps should move the robot by, below which it does not move; chosen.
MIN_MOVED_RATIO = 0.3
# Measured speed below which it is noise [m/s]; chosen.
STANDING_SPEED = 0.05


class Segment(NamedTuple):
    """
    A command for a while.

    :param purpose: what it is for.
    :param duration: longest time [s].
    :param twist: ``Twist`` at its start.
    :param rate: by which it grows, each second.
    :param max_travel: distance or angle after which it ends [m or rad].
    """

    purpose: Purpose
    duration: float
    twist: Twist = STOP
    rate: Twist = STOP
    max_travel: float = math.inf

    @property
    def expected_duration(self) -> float:
        """Time that it takes where the base moves as commanded [s]."""
        rate = max(map(abs, self.rate))
        return self.duration if rate == 0.0 else min(
            self.duration, math.sqrt(2.0 * self.max_travel / rate))

    def command(self, elapsed: float) -> Twist:
        """
        Return the command at a time.

        :param elapsed: since the start of the segment [s].
        """
        return Twist(*(value + rate * elapsed for value, rate in zip(self.twist, self.rate)))


SETTLE = Segment(Purpose.SETTLE, SETTLE_TIME)


class Block(NamedTuple):
    """
    Segments that belong together.

    :param title: what is measured, for people.
    :param start: place where it starts, ahead of the middle [m].
    :param segments: in their order.
    :param is_check: whether the program ends where these do not move the robot as they should.
    """

    title: str
    start: float
    segments: tuple[Segment, ...]
    is_check: bool = False

    @property
    def duration(self) -> float:
        """Time that it takes where the base moves as commanded [s]."""
        return sum(segment.expected_duration for segment in self.segments)


class CalibrationProgram:
    """
    Commands a base, and records what comes of it.

    ``recording``: the ``Recording``. ``title``: what is measured now. ``is_done``: whether there
    is nothing to send any more. ``may_touch``: whether it is known where the object is for the
    robot; may be set.
    """

    def __init__(self, robot: RoundRobot, side: float = SIDE,
                 touch: TouchPlan | None = None) -> None:
        """
        Start before the first measurement.

        :param side: of the free square, in whose middle the robot stands [m].
        :param touch: an object beside the square to touch at the end; None for none.
        :raises ValueError: where the square is too small.
        """
        radius = robot.radius if math.isfinite(robot.radius) else 0.0
        self._extent = 0.5 * side - radius - MARGIN
        if self._extent < 0.5:
            raise ValueError(f'side: got {side:g} m, expected at least '
                             f'{2.0 * (radius + MARGIN + 0.5):.2g} m for this robot')
        self._robot = robot
        blocks = make_blocks(robot, self._extent)
        self._blocks = blocks[:1] if touch is not None and touch.is_only else blocks
        self._total = sum(block.duration for block in self._blocks)
        self._block_index = -1
        self._segments: deque[Segment] = deque()
        self._segment = Segment(Purpose.SETTLE, 0.0)
        self._segment_count = 0
        self._segment_start = -math.inf
        self._travel_start = self._pose = Pose(0.0, 0.0, 0.0)
        # Where the steps of the present block started, and how long they lasted [s].
        self._step_poses: list[Pose] = []
        self._step_durations: list[float] = []
        self._first_pose: Pose | None = None
        self._velocity = STOP
        self._odometry_arrival = -math.inf
        self._end_time = math.inf
        self._time = -math.inf
        self._watch = MotionWatch(robot)
        self.recording = Recording(robot, object=None if touch is None else touch.object)
        self._touch = None if touch is None else TouchProgram(
            robot, touch, step_speeds(robot)[-1], return_yaw_rate(robot))
        self.title = 'waits for odometry'
        self.may_touch = True

    @property
    def progress(self) -> float:
        """Part of the program that is done, 0 to 1."""
        done = sum(block.duration for block in self._blocks[:max(0, self._block_index)])
        return 1.0 if self.is_ending else done / self._total

    @property
    def is_ending(self) -> bool:
        """Tell whether only zeros are sent from now on."""
        return self._end_time < math.inf

    @property
    def is_done(self) -> bool:
        """Tell whether the robot has been stopped, and nothing is left to send."""
        return self._time >= self._end_time

    def interrupt(self, reason: Interruption, time: float) -> None:
        """
        Stop the robot, and keep what has been recorded.

        :param reason: why.
        :param time: now [s].
        """
        if not self.is_ending:
            self.recording.interruption = reason
            self._end(time)

    def step(self, time: float, odometry: Odometry | None) -> Twist:
        """
        Take what was measured, and choose a command.

        :param time: now [s]; not before the last one.
        :param odometry: that has come since the last step; None where none has.
        :return: ``Twist`` to send.
        """
        self._time = time
        if odometry is not None:
            self._take(time, odometry)
        if self._first_pose is None:
            return STOP
        if time - self._odometry_arrival > ODOMETRY_TIMEOUT:
            self.interrupt(Interruption.ODOMETRY_LOST, time)
        while not self.is_ending and self._is_segment_over(time):
            self._start_next_segment(time)
        is_moving = not self.is_ending
        twist = self._segment.command(time - self._segment_start) if is_moving else STOP
        if is_moving and not self._may_go_on(twist):
            self._set_segment(SETTLE, time)
            twist = STOP
        self._watch.add_command(time, twist)
        self.recording.commands.append(
            SentCommand(time, twist, self._segment_count, self._segment.purpose))
        return twist

    def _take(self, time: float, odometry: Odometry) -> None:
        self.recording.odometry.append(ReceivedOdometry(time, odometry))
        if self._first_pose is None:
            self._first_pose = odometry.pose
        self._pose = self._first_pose.inverse() @ odometry.pose
        self._velocity = odometry.twist
        self._odometry_arrival = time
        fault = self._watch.check(time, odometry.twist)
        if fault is not None:
            self.interrupt(fault, time)

    def _end(self, time: float) -> None:
        self._segments.clear()
        self._set_segment(Segment(Purpose.SETTLE, math.inf), time)
        self._end_time = time + ENDING_TIME
        self.title = 'stops'

    def _set_segment(self, segment: Segment, time: float) -> None:
        if self._segment.purpose is Purpose.STEP:
            self._step_durations.append(time - self._segment_start)
        self._segment, self._segment_start = segment, time
        self._travel_start = self._pose
        self._segment_count += 1
        if segment.purpose is Purpose.STEP:
            self._step_poses.append(self._pose)

    def _is_segment_over(self, time: float) -> bool:
        segment = self._segment
        if time - self._segment_start >= segment.duration - 1e-9:
            return True
        if segment.max_travel == math.inf:
            return False
        moved = self._travel_start.inverse() @ self._pose
        is_turn = segment.rate.omega != 0.0
        return (abs(wrap_angle(moved.theta)) if is_turn
                else math.hypot(moved.x, moved.y)) >= segment.max_travel

    def _start_next_segment(self, time: float) -> None:
        if not self._segments:
            self._start_next_block(time)
        if self._segments:
            self._set_segment(self._segments.popleft(), time)

    def _start_next_block(self, time: float) -> None:
        if 0 <= self._block_index < len(self._blocks) and (
                self._blocks[self._block_index].is_check):
            fault = self._motion_fault(self._blocks[self._block_index].segments[0])
            if fault is not None:
                self.interrupt(fault, time)
                return
        if self._block_index + 1 >= len(self._blocks):
            self._block_index = len(self._blocks)
            self._start_next_touch(time)
            return
        self._block_index += 1
        block = self._blocks[self._block_index]
        self.title = block.title
        self._step_poses.clear()
        self._step_durations.clear()
        self._segments.extend((*self._return_to(block.start), *block.segments))

    def _start_next_touch(self, time: float) -> None:
        self.title = 'touches the object'
        drives = [] if self._touch is None or self._first_pose is None or not self.may_touch else (
            self._touch.next_drives(self.recording, self._first_pose @ self._pose))
        self._segments.extend(Segment(*drive) for drive in drives)
        if not drives:
            self._end(time)

    def _motion_fault(self, segment: Segment) -> Interruption | None:
        """
        Compare what the first segment of a block moved the robot by with what it should.

        A segment that the square ended early should have moved it by less.
        """
        if len(self._step_poses) < 2:
            return Interruption.NO_MOTION
        is_turn = segment.twist.omega != 0.0
        speed = segment.twist.omega if is_turn else segment.twist.v_x
        expected = self._step_durations[0] * speed
        moved = self._step_poses[0].inverse() @ self._step_poses[1]
        amount = abs(moved.theta) if is_turn else math.hypot(moved.x, moved.y)
        if amount < MIN_MOVED_RATIO * abs(expected):
            return Interruption.NO_MOTION
        along = moved.theta if is_turn else moved.x
        if along * expected <= 0.5 * amount * abs(expected):
            return Interruption.WRONG_MOTION
        is_too_short = amount < MIN_MOVED_RATIO * segment.duration * abs(speed)
        is_too_fast = amount > SPEED_RATIO * abs(expected)
        return Interruption.RUNAWAY if is_too_short and is_too_fast else None

    def _may_go_on(self, twist: Twist) -> bool:
        """Tell whether the robot could still stop within the square, where it is to stay there."""
        if self._block_index == len(self._blocks):
            return True
        for velocity, threshold in ((twist, 0.0), (self._velocity, STANDING_SPEED)):
            speed = math.hypot(velocity.v_x, velocity.v_y)
            if speed <= threshold:
                continue
            braking = speed / (2.0 * BRAKING_RATIO * self._robot.max_acceleration)
            ahead = self._pose.transform((velocity.v_x * (STOP_DELAY + braking),
                                          velocity.v_y * (STOP_DELAY + braking)))
            for now, then in zip(self._pose[:2], ahead):
                if abs(then) > self._extent and abs(then) > abs(now):
                    return False
        return True

    def _return_to(self, start: float) -> list[Segment]:
        """Choose segments that bring the robot to a place ahead of the middle, heading ahead."""
        pose, segments = self._pose, []
        offset = (start - pose.x, -pose.y)
        distance, heading = math.hypot(*offset), pose.theta
        if distance >= NEAR and self._robot.drive == 'differential':
            bearing = wrap_angle(math.atan2(offset[1], offset[0]) - heading)
            is_forward = abs(bearing) <= 0.5 * math.pi
            turn = bearing if is_forward else wrap_angle(bearing + math.pi)
            segments += self._turn(turn)
            heading += turn
            segments += self._drive(distance if is_forward else -distance, 0.0)
        segments += self._turn(wrap_angle(-heading))
        if distance >= NEAR and self._robot.drive != 'differential':
            segments += self._drive(*offset)
        return segments

    def _turn(self, angle: float) -> list[Segment]:
        if abs(angle) < NEAR_HEADING:
            return []
        rate = return_yaw_rate(self._robot)
        return [Segment(Purpose.RETURN, abs(angle) / rate,
                        Twist(0.0, 0.0, math.copysign(rate, angle))), SETTLE]

    def _drive(self, x: float, y: float) -> list[Segment]:
        speed, distance = step_speeds(self._robot)[-1], math.hypot(x, y)
        return [Segment(Purpose.RETURN, distance / speed,
                        Twist(speed * x / distance, speed * y / distance, 0.0)), SETTLE]


def step_speeds(robot: RoundRobot) -> list[float]:
    """Choose the speeds of steps, the greatest first."""
    return [max(min(MIN_STEP_SPEED, robot.max_speed), min(speed, ratio * robot.max_speed))
            for speed, ratio in zip(STEP_SPEEDS, (1.0, 0.6))]


def return_yaw_rate(robot: RoundRobot) -> float:
    """Choose the yaw rate of short turns, at which wheels turn that have a dead band."""
    return min(robot.max_yaw_rate, 2.0 * STEP_SPEEDS[-1] / robot.wheel_track)


def line_speed(robot: RoundRobot, length: float) -> float:
    """
    Choose the speed of a line: the greatest that the base can reach and leave within it.

    :param length: of the line [m].
    """
    # Half of the line at constant speed: s = v^2 / a + v t.
    a = robot.max_acceleration
    reachable = math.sqrt((0.5 * STOP_DELAY * a) ** 2 + 0.4 * length * a) - 0.5 * STOP_DELAY * a
    return min(robot.max_speed, max(STEP_SPEEDS[0], reachable))


def make_blocks(robot: RoundRobot, extent: float) -> list[Block]:
    """
    List the blocks of the program.

    :param extent: distance that the robot may go from the middle, along each axis [m].
    """
    axes: list[Callable[[float], Twist]] = [lambda v: Twist(v, 0.0, 0.0)]
    if robot.drive != 'differential':
        axes.append(lambda v: Twist(0.0, v, 0.0))
    fast, slow = step_speeds(robot)
    yaw_rate = return_yaw_rate(robot)
    blocks = [Block('noise at rest', 0.0, (Segment(Purpose.REST, REST_TIME),)),
              Block('steps', 0.0, _there_and_back(Purpose.STEP, 1.0, axes[0](fast)), True),
              Block('steps of rotation', 0.0,
                    _there_and_back(Purpose.STEP, 1.0, Twist(0.0, 0.0, yaw_rate)), True)]
    for axis in axes:
        blocks.append(Block('steps', 0.0, (
            *_there_and_back(Purpose.STEP, 1.0, axis(slow)),
            *_there_and_back(Purpose.STEP, 1.0, axis(fast)), *_levels(axis, slow, fast))))
    blocks.append(Block('steps of rotation', 0.0, (
        *_there_and_back(Purpose.STEP, 0.8, Twist(0.0, 0.0, 0.8 * yaw_rate)),
        *_there_and_back(Purpose.STEP, 0.8, Twist(0.0, 0.0, yaw_rate)))))
    top = min(RAMP_TOP, robot.max_speed)
    for axis in axes:
        ramp = Segment(Purpose.RAMP, top / RAMP_RATE, rate=axis(RAMP_RATE),
                       max_travel=RAMP_TRAVEL)
        back = ramp._replace(rate=axis(-RAMP_RATE))
        blocks.append(Block('least speed', 0.0, RAMP_REPEATS * (ramp, SETTLE, back, SETTLE)))
    yaw_top = min(YAW_RAMP_TOP, robot.max_yaw_rate)
    ramp = Segment(Purpose.RAMP, yaw_top / YAW_RAMP_RATE, rate=Twist(0.0, 0.0, YAW_RAMP_RATE),
                   max_travel=YAW_RAMP_TRAVEL)
    back = ramp._replace(rate=Twist(0.0, 0.0, -YAW_RAMP_RATE))
    blocks.append(Block('least yaw rate', 0.0, (ramp, SETTLE, back, SETTLE)))
    turn = min(MAX_TURN_RATE, robot.max_yaw_rate)
    blocks.append(Block('turns', 0.0, _there_and_back(
        Purpose.TURN, TURNS * 2.0 * math.pi / turn, Twist(0.0, 0.0, turn))))
    # A line ends before it has to be stopped.
    length = 2.0 * extent - 0.2
    speed = line_speed(robot, length)
    room = STOP_DELAY * speed + speed * speed / (2.0 * BRAKING_RATIO * robot.max_acceleration)
    start = -0.5 * length
    duration = max(0.5, (2.0 * extent - 0.2 - room) / speed)
    line = Segment(Purpose.LINE, duration, axes[0](speed))
    home = Segment(Purpose.LINE, duration, axes[0](-speed))
    blocks.append(Block('lines', start, 2 * (line, SETTLE, home, SETTLE)))
    return blocks


def _there_and_back(purpose: Purpose, duration: float, twist: Twist) -> tuple[Segment, ...]:
    back = Twist(*(-value if value else 0.0 for value in twist))
    return (Segment(purpose, duration, twist), SETTLE, Segment(purpose, duration, back), SETTLE)


def _levels(axis: Callable[[float], Twist], slow: float, fast: float) -> tuple[Segment, ...]:
    """Change between two speeds: small changes show the lag and not the acceleration limit."""
    middle = 0.5 * (slow + fast)
    forward = [Segment(Purpose.LEVELS, 0.5, axis(speed)) for speed in (slow, middle, slow)]
    back = [Segment(Purpose.LEVELS, 0.5, axis(-speed)) for speed in (slow, middle, slow)]
    return (*forward, SETTLE, *back, SETTLE)
