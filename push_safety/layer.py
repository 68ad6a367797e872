"""
The guard: the last thing between a controller and the base.

Whatever the controller does, a command that leaves this layer is finite and within the limits of
the robot, and it is zero from the moment on at which the robot does not do what it is commanded to
do, or odometry contradicts itself, until the robot has been at rest for a while; or until somebody
lets it go on, where the base has been at rest for longer than it may.
"""

from collections.abc import Callable
import math
from typing import Protocol

from push_base.base_identifier import BaseIdentifier
from push_base.command_ramp import CommandRamp
from push_base.command_shaper import CommandShaper
from push_base.speed_gain import compensated
from push_model.base_knowledge import BaseKnowledge
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_safety.learned_motion import LearnedMotionCheck
from push_safety.odometry_check import OdometryCheck
from push_safety.pose_check import PoseCheck
from push_safety.status import SafetyReason, SafetyReport, SafetyState
from push_safety.stop import is_at_rest, SafetyStop
from push_safety.tolerances import (
    AGREEING_MESSAGES, MAX_CLOCK_SHIFT, MAX_ODOMETRY_STEP, MAX_RESPONSE_TIME, MAX_SILENCE,
    SILENCE_RATIO, SLOWING_TIME)

# Factor by which the longest gap between two messages fades with each of them; chosen.
FADING = 0.99
# The longest gap as long as none is known [s]; chosen: odometry at 10 Hz.
FIRST_GAP = 0.1
# Ratio beyond a limit that is only rounding; chosen: far above that of double precision.
ROUNDING = 1.0 + 1e-9


class GuardedController(Protocol):
    """Controller that commands the robot, and is told why it is stopped."""

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stays stopped until somebody lets it go on."""
        ...

    @property
    def backs_off(self) -> bool:
        """Tell whether what it pushes has stopped it just now, and it backs off from that."""
        ...

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer reports; called before each step.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """


class SafetyLayer:
    """
    Limits commands, and stops a robot that does not follow them.

    ``guard`` is the way of every command, in the node, in simulations and in playbacks. It applies
    three of the four checks: object poses, odometry against itself, motion against commands. A
    node refuses messages by their stamps before that, with ``StampCheck``.

    ``other_commanders``: names of those who may command the base, too; empty for nobody.
    ``speed_limit``: greatest speed for now, below that of the robot [m/s].
    """

    def __init__(self, robot: RoundRobot, obj: PushedObject, *, heading_count: int = 0,
                 is_odometry_absolute: bool = False,
                 standstill_limit: float = math.inf) -> None:
        """
        Start with a robot that nobody commands.

        :param robot: nominal.
        :param obj: for its symmetry.
        :param heading_count: as of ``PoseCheck``.
        :param is_odometry_absolute: whether the pose of odometry is measured in the world.
        :param standstill_limit: ``SafetyStop.max_standstill`` [s].
        """
        self._robot = robot
        self._obj = obj
        self._heading_count = heading_count
        self._is_odometry_absolute = is_odometry_absolute
        self._motion_check = LearnedMotionCheck(robot)
        self._ramp = CommandRamp(robot)
        self._shaper = CommandShaper(robot)
        self._identifier = BaseIdentifier(robot)
        # What was known of the base when it last moved.
        self._moving_knowledge = self._identifier.knowledge
        self._stop = SafetyStop(standstill_limit)
        self.other_commanders = ''
        self.speed_limit = math.inf
        self.reset()

    def reset(self) -> None:
        """Forget everything measured, as where time went back."""
        self._odometry: Odometry | None = None
        # Longest time between two recent messages [s]; the odometry at the last command, and when
        # the first one was sent that rests on it [s].
        self._longest_gap = FIRST_GAP
        self._answered: tuple[Odometry | None, float] = None, 0.0
        self._odometry_check = OdometryCheck(self._robot,
                                             is_absolute=self._is_odometry_absolute)
        # Stamp of odometry that was not newer and came last [s], and how many in a row agree.
        self._late_stamp = -math.inf
        self._late_count = 0
        self.set_object(self._obj)
        self._stop.reset()
        self.release()

    def set_object(self, obj: PushedObject) -> None:
        """Expect poses of another object."""
        self._obj = obj
        self._pose_check = PoseCheck(obj, self._heading_count)

    def release(self) -> None:
        """Note that the robot is not commanded: others may drive it."""
        self._motion_check.reset()
        self._identifier.forget()
        self._ramp.reset()
        self._stop.release()
        self._expects_odometry = False

    def interrupt(self) -> None:
        """Note that the base may have got other commands than these, or none for a while."""
        self._motion_check.interrupt()
        self._identifier.forget()

    def excuse_gap(self, duration: float) -> None:
        """
        Note that the stamps of odometry go on at a later time: it was not missing.

        :param duration: by how much later, beside what has passed [s].
        """
        self._stop.excuse(duration)
        # As before the first command.
        self._expects_odometry = False

    @property
    def report(self) -> SafetyReport | None:
        """Why the robot is stopped, None while all is well."""
        return self._stop.report

    @property
    def base_knowledge(self) -> BaseKnowledge:
        """Knowledge of the base, as stated and as learned from its motion."""
        return self._identifier.knowledge

    def start_from(self, knowledge: BaseKnowledge) -> None:
        """
        Drive the base as what was learned of it before says; the checks take no notice of it.

        :param knowledge: ``BaseKnowledge``.
        """
        self._identifier.start_from(knowledge)
        self._moving_knowledge = self._identifier.knowledge

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stays stopped until ``resume``."""
        return self._stop.awaits_resume

    @property
    def standstill_limit(self) -> float:
        """``SafetyStop.max_standstill`` [s]."""
        return self._stop.max_standstill

    @standstill_limit.setter
    def standstill_limit(self, limit: float) -> None:
        self._stop.max_standstill = limit

    def resume(self) -> None:
        """Let a robot go on that waits for it."""
        if self._odometry is None or not self.awaits_resume:
            return
        self._forgive(self._odometry)
        self._stop.resume()

    def _forgive(self, odometry: Odometry) -> None:
        """Forget what was wrong: the robot goes on from where it is at rest."""
        self._odometry_check.restart(odometry)
        self._motion_check.forgive()

    @property
    def heading_jump(self) -> float:
        """Angle by which the tracker mistakes the heading of the object [rad], else 0."""
        return self._pose_check.heading_jump

    @property
    def state(self) -> SafetyState:
        """The ``SafetyState``."""
        return SafetyState.CLEAR if self.report is None else SafetyState.STOPPED

    def guard(self, observation: Observation, controller: GuardedController,
              step: Callable[[Observation], Twist], *, is_commanding: bool = True,
              interference: SafetyReport | None = None) -> Twist:
        """
        Answer a measurement: check it, let the controller decide, check what it decides.

        :param observation: ``Observation``, as measured.
        :param controller: ``GuardedController`` that is told why the robot is stopped.
        :param step: its decision: takes the ``Observation`` as it was checked, returns the
            ``Twist`` that it commands.
        :param is_commanding: whether it commands the robot; else others may drive it.
        :param interference: why the robot is stopped from outside, or None.
        :return: the ``Twist`` to send.
        """
        if not controller.awaits_resume:
            self.resume()
        if not is_commanding:
            self.release()
        elif interference is not None:
            self.stop(interference)
        checked = self.with_checked_pose(observation)
        fault = self.observe(checked.odometry)
        controller.on_safety_report(fault, self.report)
        if controller.backs_off:
            self._let_back_off(checked.odometry)
        return self.filter(step(checked._replace(base=self.base_knowledge)), checked.time)

    def _let_back_off(self, odometry: Odometry) -> None:
        """
        Let a robot go on at once that an object has stopped, so that it presses no longer.

        Until it has had time to respond, what is left of its motion is no fault.
        """
        self._motion_check.interrupt()
        self._stop.go_on(odometry.time)

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
        gap = 0.0 if self._odometry is None else odometry.time - self._odometry.time
        self._odometry = odometry
        self._identifier.observe(odometry, has_changed=self._motion_check.has_changed)
        if not is_at_rest(odometry.twist):
            self._moving_knowledge = self._identifier.knowledge
        self._late_stamp, self._late_count = -math.inf, 0
        if self._motion_check.learn(self._identifier.knowledge):
            self._stop.explain()
        fault = self._odometry_check.check(odometry) or self._motion_fault(odometry)
        if self._stop.may_go_on(odometry, fault is not None):
            self._forgive(odometry)
        if fault is not None and fault.code is SafetyReason.ODOMETRY_JUMPED:
            # The object may have been put elsewhere with the robot.
            self._pose_check.restart()
        self._stop.observe(odometry, fault, gap if self._expects_odometry else 0.0)
        if self.awaits_resume:
            # Somebody has stopped the base: that it stood tells nothing of slow commands.
            self._identifier.restore(self._moving_knowledge)
        return fault

    def _motion_fault(self, odometry: Odometry) -> SafetyReport | None:
        """Find out why the robot does not follow: others, odometry, or the base itself."""
        fault = self._motion_check.check(odometry)
        # What is wrong may show in the last centimetres of a robot that has been stopped for it.
        is_suspect = self.report is not None and self.report.code.is_of_motion
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
        if self._late_count < AGREEING_MESSAGES or shift < MAX_CLOCK_SHIFT:
            return None
        fault = SafetyReason.CLOCK_FELL_BACK.report(shift=shift)
        self.stop(fault)
        return fault

    def with_checked_pose(self, observation: Observation) -> Observation:
        """
        Return an observation with the object pose that its check lets pass.

        :param observation: ``Observation``, as measured.
        """
        measured = observation.object_pose
        if measured is None:
            return observation
        checked = self._pose_check.check(measured)
        return observation._replace(object_pose=checked, pose_rejection=self._pose_check.fault)

    def filter(self, command: Twist, time: float) -> Twist:
        """
        Let a command pass, within the limits of the robot, or stop it.

        :param command: ``Twist`` in the robot's axes, whatever it is.
        :param time: of the newest measurement [s].
        :return: the ``Twist`` to send.
        """
        if not all(map(math.isfinite, command)):
            self._stop.report = SafetyReason.COMMAND_NOT_FINITE.report(command=tuple(command))
        self._shaper.knowledge = self._identifier.knowledge
        if self.report is None:
            allowed = self._ramp.limit(self._limited(command), self._identifier.knowledge, time)
        else:
            allowed = STOP
            self._ramp.reset()
        # Pulses that are slowed down would not move the base: what is desired is slowed down.
        ratio = min(self._speed_ratio(time), self._limit_ratio(allowed))
        if ratio < 1.0:
            allowed = Twist(*(ratio * value for value in allowed))
        allowed = compensated(allowed, self._robot, self._identifier.knowledge)
        chosen = self._shaper.shape(allowed, time)
        sent = self._limited(chosen)
        if sent != chosen:
            self._shaper.note_sent(sent)
        self._expects_odometry = True
        self._motion_check.add_command(sent, self._odometry_time(time))
        self._identifier.add_command(sent, self._odometry_time(time))
        self._odometry_check.add_command(sent, time)
        return sent

    def _limit_ratio(self, command: Twist) -> float:
        """Part of a command that keeps below the speed limit, on the same arc."""
        speed = math.hypot(command.v_x, command.v_y)
        return min(1.0, self.speed_limit / speed) if speed > 0.0 else 1.0

    def _speed_ratio(self, time: float) -> float:
        """Part of its speed that a robot keeps whose odometry has not come for a while."""
        known, since = self._answered
        if self._odometry is None or self._odometry is not known or time < since:
            self._note_gap(math.inf if known is None else time - since)
            self._answered = self._odometry, time
            return 1.0
        silence = max(MAX_SILENCE, SILENCE_RATIO * self._longest_gap)
        return min(1.0, max(0.0, 1.0 - (time - since - silence) / SLOWING_TIME))

    def _odometry_time(self, time: float) -> float:
        """Tell the time on the clock of odometry [s]; object poses may be stamped ahead of it."""
        if self._odometry is None:
            return time
        elapsed = time - self._answered[1]
        return self._odometry.time + (elapsed if elapsed > MAX_SILENCE else 0.0)

    def _note_gap(self, gap: float) -> None:
        """Learn how long it may take until the next odometry, lost or late on its way."""
        self._longest_gap *= FADING
        if gap < MAX_ODOMETRY_STEP:
            self._longest_gap = max(self._longest_gap, gap)

    def stop(self, report: SafetyReport) -> None:
        """Stop the robot for a reason that is not of this layer."""
        self._stop.stop(report)

    def _limited(self, command: Twist) -> Twist:
        """Shorten a command that is beyond the limits of speed and acceleration."""
        robot = self._robot
        measured = STOP if self._odometry is None else self._odometry.twist
        # No more than the drive reaches while it responds, beyond its lag.
        time = MAX_RESPONSE_TIME + robot.time_constant
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
