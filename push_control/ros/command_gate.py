"""Between a mode and ``cmd_vel``: the safety layer, and what is known of the time of messages."""

import math
import time
from typing import Any

from push_control.observation import Observation
from push_control.ros.measurements import OdometryCheck, OdometryState, OdometryWatchdog
from push_control.ros.mode import ControllerParameters, Mode
from push_control.ros.other_commanders import OtherCommanders
from push_control.safety.layer import SafetyLayer
from push_control.safety.stamp_check import StampCheck, StampVerdict
from push_control.safety.status import SafetyReason
from push_model.parameters import PushedObject
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_ros.conversions.primitives import MessageRefused, nanoseconds
from push_ros.node import PushNode
from push_ros.node_settings import ControllerOptions


# Times that odometry may come again with the same stamp in lockstep; chosen: a simulator asks
# again now and then where there is no answer, and a clock that stands shows in a quarter second.
MOST_REPETITIONS = 12


class CommandGate:
    """Lets the commands of a mode pass, or stops the robot."""

    def __init__(self, node: PushNode, mode: Mode, parameters: ControllerParameters,
                 options: ControllerOptions, others: OtherCommanders) -> None:
        """
        Begin with a robot that nobody commands.

        :param node: the ``PushNode``, for its clock.
        :param mode: the ``Mode``.
        :param parameters: ``ControllerParameters``.
        :param options: ``ControllerOptions``.
        :param others: ``OtherCommanders``.
        """
        self._others = others
        self._node = node
        self._mode = mode
        is_absolute = parameters.supervision.odometry_reference == 'absolute'
        self._layer = SafetyLayer(parameters.robot, parameters.object,
                                  heading_count=parameters.control.heading_count,
                                  is_odometry_absolute=is_absolute)
        self._flip = 0.0
        self._is_lockstep = options.lockstep
        self._watchdog = OdometryWatchdog(
            options.watchdog_timeout,
            is_simulated=bool(node.get_parameter('use_sim_time').value))
        self.reset()

    def reset(self) -> None:
        """Forget everything measured, as where time went back."""
        self._layer.reset()
        self._stamps = StampCheck()
        self._watchdog.reset()
        # Whether the mode has commanded the robot at the last step, and whether it waits until
        # somebody who did so before has ended.
        self._was_commanding = False
        self._yields = False
        # Time of the newest odometry [s], and how often it has come again since.
        self._newest_stamp: float | None = None
        self._repetitions = 0

    def accept(self, measured: Odometry | ObjectPose, message: Any) -> bool:
        """
        Check the stamp of a measurement.

        :param measured: ``Odometry`` or ``ObjectPose``.
        :param message: its message.
        :return: whether everything before it is of another time, and is to be forgotten.
        :raises MessageRefused: where the stamp is off.
        """
        now = time.monotonic()
        is_odometry = isinstance(measured, Odometry)
        difference = self._stamps.difference(measured.time)
        check = self._stamps.check_odometry if is_odometry else self._stamps.check_pose
        verdict = check(measured.time, now)
        if verdict is StampVerdict.REFUSED:
            raise MessageRefused(self._stamp_fault('odom' if is_odometry else 'object_pose',
                                                   difference))
        if verdict is StampVerdict.TIME_WENT_AHEAD:
            self._node.get_logger().warning(
                f'odom: time went ahead by {difference:.2f} s; goes on at the new one')
        if is_odometry:
            is_new = self._newest_stamp is None or measured.time > self._newest_stamp
            self._repetitions = 0 if is_new else self._repetitions + 1
            self._newest_stamp = measured.time if is_new else self._newest_stamp
            if not is_new:
                self._layer.observe(measured)
            clock = self._node.get_clock().now().nanoseconds
            if is_new and not self._is_lockstep:
                self._note_gap(clock, now)
            self._watchdog.feed(nanoseconds(message.header.stamp), clock, now)
        return verdict is StampVerdict.TIME_WENT_BACK

    def _stamp_fault(self, topic: str, difference: float) -> str:
        """Describe a stamp that is off by some time [s], and who may be to blame."""
        relation = 'ahead of' if difference > 0.0 else 'behind'
        fault = (f'{topic}: got a stamp that is {abs(difference):.2f} s {relation} the last '
                 'odometry, expected one of the same clock')
        publishers = self._node.publishers_of(topic)
        return fault if len(publishers) < 2 else (
            f'{fault}; {topic} is published by {" and ".join(publishers)}, expected one of them')

    def _note_gap(self, clock: int, now: float) -> None:
        """Take note that no odometry has come for a while, as in a process that slept."""
        if self._watchdog.is_missing(clock, now):
            # The base was sent zeros, or has stopped by itself.
            self._layer.interrupt()
        if self._watchdog.has_gap(now):
            # What was sent meanwhile may be lost.
            self._mode.renew_request()

    @property
    def is_commanding(self) -> bool:
        """Whether the base is commanded, be it to stand; not while somebody else was first."""
        return self._mode.is_commanding and not self._yields

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Let the mode answer a measurement, and check the answer.

        :param observation: ``Observation``.
        :param dt: time since the last one [s].
        :return: the ``Twist`` to send.
        """
        is_commanding = self._mode.is_commanding
        is_blocked = self._yields or not self._was_commanding
        self._yields = is_commanding and is_blocked and self._others.is_commanding
        self._was_commanding = is_commanding
        if not is_commanding:
            self._layer.release()
        elif self._yields or self._others.is_driving:
            self._layer.stop(SafetyReason.COMMANDED_BY_OTHERS.report(others=self._others.names))
        self._layer.other_commanders = self._others.names
        observation = self._layer.believed(observation)
        self._warn_of_flip()
        fault = self._layer.observe(observation.odometry)
        self._mode.on_safety_report(fault, self._layer.report)
        command = self._mode.step(observation, dt)
        return self._layer.filter(command if self._is_odometry_fresh else STOP, observation.time)

    @property
    def _is_odometry_fresh(self) -> bool:
        """Whether a command may rest on odometry; in lockstep time waits for the answer."""
        if self._is_lockstep:
            return self._repetitions < MOST_REPETITIONS
        return self.check_odometry().state is OdometryState.PRESENT

    def set_object(self, obj: PushedObject) -> None:
        """
        Expect poses of another object.

        :param obj: the ``PushedObject``.
        """
        self._layer.set_object(obj)

    def _warn_of_flip(self) -> None:
        """Log once that the tracker mistakes the heading."""
        flip, before = self._layer.flip, self._flip
        self._flip = flip
        if flip and not before:
            self._node.get_logger().warning(
                f'object_pose: its heading has jumped by {math.degrees(flip):.0f} deg, at which '
                'the object looks the same: taken as a mistake of the tracker '
                '(control.heading_count)')

    def check_odometry(self) -> OdometryCheck:
        """Find out how long odometry has been missing."""
        return self._watchdog.check(self._node.get_clock().now().nanoseconds, time.monotonic())
