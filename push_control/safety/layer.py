"""
Safety layer: the last thing between a controller and the base.

Whatever the controller does, a command that leaves this layer is finite and within the limits of
the robot, and it is zero from the moment on at which the robot does not do what it is commanded to
do, or odometry contradicts itself, until the robot has stood for a while.
"""

import math

from push_control.observation import Observation
from push_control.safety.drive_models import RESPONSE_TIME
from push_control.safety.heading_check import HeadingCheck
from push_control.safety.motion_monitor import MotionMonitor
from push_control.safety.odometry_check import LONG_STEP, OdometryCheck
from push_control.safety.pose_check import PoseCheck
from push_control.safety.stamp_check import AGREEING_COUNT
from push_control.safety.status import SafetyReason, SafetyReport, SafetyState
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP, Twist

# Below this a robot counts as standing [m/s], [rad/s]; chosen: above the noise of odometry.
STANDING_SPEED = 0.02
STANDING_YAW_RATE = 0.1
# Time for which it stands before it may go on [s]; chosen: longer than a drive takes to react.
STANDING_TIME = 0.5
# The same where it was stopped again so soon after it had been let go on [s]; chosen: beyond the
# drop-outs and restarts of most parts, so that one of them is not counted as many.
RELAPSE_TIME = 5.0
RELAPSE_STANDING_TIME = 5.0
# Time without odometry after which a robot slows down, at least, and over the longest between two
# messages of late; and in which it then comes to stand [s]; chosen: three messages at 50 Hz, and
# before the time-out of odometry. What was the longest fades with every message by a factor.
SILENCE = 0.06
SILENCE_RATIO = 1.5
SLOWING_TIME = 0.15
FADING = 0.99
# The longest gap as long as none is known [s]; chosen: odometry at 10 Hz.
FIRST_GAP = 0.1
# Shift of the clock of odometry from which on the robot stands until it has caught up [s]; chosen:
# two periods at 50 Hz, by which stamps of messages that are made in a hurry come out of order.
LEAST_SHIFT = 0.04
# Ratio beyond a limit that is only rounding; chosen: far above that of double precision.
ROUNDING = 1.0 + 1e-9


class SafetyLayer:
    """
    Limits commands, and stops a robot that does not follow them.

    ``report``: why the robot is stopped; stays until it has stood for a while, None while all is
    well. ``other_commanders``: names of those who may command the base, too; empty for nobody.
    """

    def __init__(self, robot: RoundRobot, obj: PushedObject, *, heading_count: int = 0,
                 is_odometry_absolute: bool = False) -> None:
        """
        Begin with a robot that nobody commands.

        :param robot: the ``RoundRobot``, nominal.
        :param obj: the ``PushedObject``, for its symmetry.
        :param heading_count: as of ``HeadingCheck``.
        :param is_odometry_absolute: whether the pose of odometry is measured in the world.
        """
        self._robot = robot
        self._obj = obj
        self._heading_count = heading_count
        self._is_odometry_absolute = is_odometry_absolute
        self._monitor = MotionMonitor(robot)
        self.other_commanders = ''
        self.reset()

    def reset(self) -> None:
        """Forget everything measured, as where time went back."""
        self._odometry: Odometry | None = None
        # Longest time between two messages of late [s]; the odometry at the last command, and when
        # the first one was sent that rests on it [s].
        self._longest_gap = FIRST_GAP
        self._answered: tuple[Odometry | None, float] = None, 0.0
        self._odometry_check = OdometryCheck(self._robot,
                                             is_absolute=self._is_odometry_absolute)
        self._standing_since: float | None = None
        # When the robot was last let go on after a stop [s].
        self._released_at = -math.inf
        # Stamp of odometry that was not newer and came last [s], and how many in a row agree.
        self._late_stamp = -math.inf
        self._late_count = 0
        self.set_object(self._obj)
        self.release()

    def set_object(self, obj: PushedObject) -> None:
        """
        Expect poses of another object.

        :param obj: the ``PushedObject``.
        """
        self._obj = obj
        self._heading_check = HeadingCheck(obj, self._heading_count)
        self._pose_check = PoseCheck()
        self._object_pose: tuple[ObjectPose, ObjectPose] | None = None

    def release(self) -> None:
        """Note that the robot is not commanded: others may drive it."""
        self._monitor.reset()
        self.report: SafetyReport | None = None

    def interrupt(self) -> None:
        """Note that the base may have got other commands than these, or none for a while."""
        self._monitor.interrupt()

    @property
    def flip(self) -> float:
        """Angle by which the tracker mistakes the heading of the object [rad], else 0."""
        return -self._heading_check.flip

    @property
    def state(self) -> SafetyState:
        """The ``SafetyState``."""
        return SafetyState.CLEAR if self.report is None else SafetyState.STOPPED

    def observe(self, odometry: Odometry) -> SafetyReport | None:
        """
        Compare odometry with what was commanded, and with itself.

        :param odometry: ``Odometry``; one that is not finite, or comes again, is ignored. Of
            those that are older than the last, some in a row mean that its clock has fallen back.
        :return: what is wrong with this one, or None.
        """
        if not all(map(math.isfinite, (odometry.time, *odometry.pose, *odometry.twist))):
            return None
        if self._odometry is not None and odometry.time <= self._odometry.time:
            return self._observe_late(odometry, self._odometry.time - odometry.time)
        self._odometry = odometry
        self._late_stamp, self._late_count = -math.inf, 0
        fault = self._odometry_check.check(odometry) or self._motion_fault(odometry)
        self._note_standing(odometry, fault is not None)
        if fault is not None and self._is_news(fault):
            self.report = fault
        return fault

    def _is_news(self, fault: SafetyReport) -> bool:
        """Tell whether a fault is the first, or says more of a base that does not follow."""
        says_more = fault.reason.is_of_odometry or fault.reason is SafetyReason.FOLLOWS_LATE
        return self.report is None or self.report.reason.is_of_motion and says_more

    def _motion_fault(self, odometry: Odometry) -> SafetyReport | None:
        """Find out why the robot does not follow: others, odometry, or the base itself."""
        fault = self._monitor.check(odometry)
        # What is wrong may show in the last centimetres of a robot that has been stopped for it.
        is_suspect = self.report is not None and self.report.reason.is_of_motion
        if fault is None and not is_suspect:
            return None
        if fault is not None and self.other_commanders:
            return SafetyReason.COMMANDED_BY_OTHERS.report(others=self.other_commanders)
        return self._odometry_check.early_contradiction() or fault

    def _observe_late(self, odometry: Odometry, shift: float) -> SafetyReport | None:
        """Stop the robot where odometry goes on at an earlier time, until that has caught up."""
        if shift == 0.0 or odometry.time == self._late_stamp:
            return None
        self._odometry_check.continue_late(odometry)
        self._late_count = self._late_count + 1 if odometry.time > self._late_stamp else 1
        self._late_stamp = odometry.time
        if self._late_count < AGREEING_COUNT or shift < LEAST_SHIFT:
            return None
        fault = SafetyReason.CLOCK_FELL_BACK.report(shift=shift)
        self.stop(fault)
        return fault

    def believed(self, observation: Observation) -> Observation:
        """
        Take back what a tracker mistakes, and hold back what cannot be true.

        :param observation: ``Observation``.
        :return: the same, with the object pose as it is believed: with another heading where the
            object looks the same, and the last one that was possible.
        """
        measured = observation.object_pose
        if measured is None:
            return observation
        if self._object_pose is None or measured is not self._object_pose[0]:
            continued = self._heading_check.believed(measured)
            self._object_pose = measured, self._pose_check.believed(continued)
        return Observation(observation.time, observation.odometry, self._object_pose[1],
                           self._pose_check.doubt)

    def filter(self, command: Twist, time: float) -> Twist:
        """
        Let a command pass, within the limits of the robot, or stop it.

        :param command: ``Twist`` in the robot's axes, whatever it is.
        :param time: of the newest measurement [s].
        :return: the ``Twist`` to send.
        """
        if not all(map(math.isfinite, command)):
            self.report = SafetyReason.COMMAND_NOT_FINITE.report(command=tuple(command))
        sent = STOP if self.report is not None else self._limited(command)
        ratio = self._speed_ratio(time)
        if ratio < 1.0:
            sent = Twist(*(ratio * value for value in sent))
        self._monitor.add_command(sent, self._odometry_time(time))
        self._odometry_check.add_command(sent, time)
        return sent

    def _speed_ratio(self, time: float) -> float:
        """Part of its speed that a robot keeps whose odometry has not come for a while."""
        known, since = self._answered
        if self._odometry is None or self._odometry is not known or time < since:
            self._note_gap(math.inf if known is None else time - since)
            self._answered = self._odometry, time
            return 1.0
        silence = max(SILENCE, SILENCE_RATIO * self._longest_gap)
        return min(1.0, max(0.0, 1.0 - (time - since - silence) / SLOWING_TIME))

    def _odometry_time(self, time: float) -> float:
        """Tell the time on the clock of odometry [s]; object poses may be stamped ahead of it."""
        if self._odometry is None:
            return time
        elapsed = time - self._answered[1]
        return self._odometry.time + (elapsed if elapsed > SILENCE else 0.0)

    def _note_gap(self, gap: float) -> None:
        """Learn how long it may take until the next odometry, lost or late on its way."""
        self._longest_gap *= FADING
        if gap < LONG_STEP:
            self._longest_gap = max(self._longest_gap, gap)

    def stop(self, report: SafetyReport) -> None:
        """
        Stop the robot for a reason that is not of this layer.

        :param report: the ``SafetyReport``.
        """
        self.report = self.report or report
        self._standing_since = None

    def _note_standing(self, odometry: Odometry, is_faulty: bool) -> None:
        """Clear the fault of a robot that has stood for a while."""
        if is_faulty or not is_standing(odometry.twist):
            self._standing_since = None
        elif self._standing_since is None:
            self._standing_since = odometry.time
        elif self.report and self._has_stood(self._standing_since, odometry.time):
            self._odometry_check.restart(odometry)
            self._monitor.forgive()
            self.report = None
            self._released_at = odometry.time

    def _has_stood(self, since: float, time: float) -> bool:
        """Tell whether a robot that was stopped has stood for long enough."""
        has_relapsed = since - self._released_at < RELAPSE_TIME
        return time - since > (RELAPSE_STANDING_TIME if has_relapsed else STANDING_TIME)

    def _limited(self, command: Twist) -> Twist:
        """Shorten a command that is beyond the limits of speed and acceleration."""
        robot = self._robot
        measured = STOP if self._odometry is None else self._odometry.twist
        # No more than the drive reaches while it responds, beyond its lag.
        time = RESPONSE_TIME + robot.time_constant
        speed = math.hypot(command.v_x, command.v_y)
        limit = min(robot.max_speed, robot.max_acceleration * time
                    + math.hypot(measured.v_x, measured.v_y))
        yaw_limit = min(robot.max_yaw_rate,
                        robot.max_yaw_acceleration * time + abs(measured.omega))
        ratio = min(1.0, limit / speed) if speed > 0.0 else 1.0
        sideways = 0.0 if robot.drive == 'differential' else command.v_y
        is_within = (speed <= limit * ROUNDING and abs(command.omega) <= yaw_limit * ROUNDING
                     and sideways == command.v_y)
        if is_within:
            return command
        return Twist(ratio * command.v_x, ratio * sideways,
                     min(yaw_limit, max(-yaw_limit, command.omega)))


def is_standing(twist: Twist) -> bool:
    """
    Tell whether a robot counts as standing.

    :param twist: ``Twist`` as measured.
    """
    return (math.hypot(twist.v_x, twist.v_y) < STANDING_SPEED
            and abs(twist.omega) < STANDING_YAW_RATE)
