"""Between measurements, goals and ``cmd_vel``: stamps, other commanders and the safety layer."""

import math
from pathlib import Path
import time
from typing import Any, NamedTuple, TYPE_CHECKING, TypeAlias

from push_control.ros.base_memory import BaseMemory
from push_control.ros.measurements import ClockCheck, OdometryState, OdometryWatchdog
from push_control.ros.other_commanders import OtherCommanders
from push_control.ros.parameters import ControllerParameters
from push_control.settings import ControlSettings
from push_model.observation import Observation
from push_model.parameters import PushedObject
from push_model.signals import LidarScan, ObjectPose, Odometry, RobotPlace, STOP, Twist
from push_ros.conversions.primitives import MessageRefused, nanoseconds
from push_ros.diagnostics import WARN
from push_ros.node import PushNode
from push_safety.layer import SafetyLayer
from push_safety.stamp_check import StampCheck, StampVerdict
from push_safety.status import SafetyReason
from push_safety.stop import is_at_rest

if TYPE_CHECKING:  # It is imported once the node has reported.
    from push_control.ros.pursuit import GoalPursuit


# Times that odometry may come again with the same stamp in lockstep; chosen: a simulator asks
# again now and then where there is no answer, and a clock that stands shows in a quarter second.
MAX_REPETITIONS = 12
AnyMeasurement: TypeAlias = Odometry | ObjectPose | LidarScan | RobotPlace
# Topics of measurements, by their types.
TOPIC_OF = {Odometry: 'odom', ObjectPose: 'object_pose', LidarScan: 'scan', RobotPlace: 'place'}


class StampNews(NamedTuple):
    """
    News in the stamp of a measurement, besides its time.

    :param went_back: whether everything before it is of another time, and is to be forgotten.
    :param has_gap: whether nothing had come for so long that messages may have been lost.
    :param ahead: by how much clocks were set ahead [s]; 0 for not at all.
    """

    went_back: bool
    has_gap: bool
    ahead: float = 0.0


class CommandGate:
    """
    Lets commands pass, or stops the robot.

    ``yields``: whether this node waits, as somebody else commanded the base before it.
    """

    def __init__(self, node: PushNode, parameters: ControllerParameters,
                 others: OtherCommanders) -> None:
        """
        Start with a robot that nobody commands.

        :param node: the ``PushNode``, for its clock.
        """
        self._others = others
        self._node = node
        is_absolute = parameters.supervision.odometry_reference == 'absolute'
        self._layer = SafetyLayer(parameters.robot, parameters.object,
                                  heading_count=parameters.control.heading_count,
                                  is_odometry_absolute=is_absolute,
                                  standstill_limit=parameters.control.standstill_limit)
        file = parameters.options.base_file
        self._memory = BaseMemory(Path(file) if file else None, parameters.robot)
        known, fault = self._memory.recall()
        if known is not None:
            self._layer.start_from(known)
        if fault:
            node.reporter.report(WARN, fault, always=True)
        self._heading_jump = 0.0
        self._is_lockstep = parameters.options.lockstep
        self._watchdog = OdometryWatchdog(
            parameters.options.watchdog_timeout,
            is_simulated=bool(node.get_parameter('use_sim_time').value))
        self.reset()

    def reset(self) -> None:
        """Forget everything measured, as where time went back."""
        self._layer.reset()
        self._stamps = StampCheck()
        self._watchdog.reset()
        # Whether the robot was commanded at the last step.
        self._was_commanding = False
        self.yields = False
        # Time of the newest odometry [s], and how often it has come again since.
        self._newest_stamp: float | None = None
        self._repetitions = 0

    def check(self, measured: AnyMeasurement, message: Any) -> StampNews:
        """
        Check the stamp of a measurement.

        :param measured: the measurement.
        :param message: its message.
        :raises MessageRefused: where the stamp is off.
        """
        now = time.monotonic()
        is_odometry = isinstance(measured, Odometry)
        difference = self._stamps.difference(measured.time)
        check = self._stamps.check_odometry if is_odometry else self._stamps.check_pose
        verdict = check(measured.time, now)
        if verdict is StampVerdict.REFUSED:
            raise MessageRefused(self._stamp_fault(TOPIC_OF[type(measured)], difference))
        if verdict is StampVerdict.TIME_WENT_AHEAD:
            self._node.get_logger().warning(
                f'odom: time went ahead by {difference:.2f} s; goes on at the new one')
            self._layer.excuse_gap(self._stamps.ahead)
        has_gap = False
        if is_odometry:
            is_new = self._newest_stamp is None or measured.time > self._newest_stamp
            self._repetitions = 0 if is_new else self._repetitions + 1
            self._newest_stamp = measured.time if is_new else self._newest_stamp
            if not is_new:
                self._layer.observe(measured)
            clock = self._node.get_clock().now().nanoseconds
            if is_new and not self._is_lockstep:
                has_gap = self._note_gap(clock, now)
            self._watchdog.feed(nanoseconds(message.header.stamp), clock, now)
        return StampNews(
            verdict is StampVerdict.TIME_WENT_BACK, has_gap,
            self._stamps.ahead if verdict is StampVerdict.TIME_WENT_AHEAD else 0.0)

    def _stamp_fault(self, topic: str, difference: float) -> str:
        """Describe a stamp that is off by some time [s], and who may be to blame."""
        relation = 'ahead of' if difference > 0.0 else 'behind'
        fault = (f'{topic}: got a stamp that is {abs(difference):.2f} s {relation} the last '
                 'odometry, expected one of the same clock')
        publishers = self._node.publishers_of(topic)
        return fault if len(publishers) < 2 else (
            f'{fault}; {topic} is published by {" and ".join(publishers)}, expected one of them')

    def _note_gap(self, clock: int, now: float) -> bool:
        """Tell whether messages may be lost as no odometry came, as in a process that slept."""
        if self._watchdog.is_missing(clock, now):
            # The base was sent zeros, or has stopped by itself.
            self._layer.interrupt()
        return self._watchdog.has_gap(now)

    def guard(self, pursuit: 'GoalPursuit', observation: Observation, dt: float) -> Twist:
        """
        Let the pursuit decide on a command, and check it.

        :param dt: time since the last one [s].
        :return: the ``Twist`` to send.
        """
        others, is_commanding = self._others, pursuit.is_commanding
        others.take()
        is_blocked = self.yields or not self._was_commanding
        self.yields = is_commanding and is_blocked and others.is_commanding
        self._was_commanding = is_commanding
        interference = None
        if is_commanding and (self.yields or others.is_driving):
            interference = SafetyReason.COMMANDED_BY_OTHERS.report(others=others.names)
        self._layer.other_commanders = others.names

        def decide(checked: Observation) -> Twist:
            command = pursuit.step(checked, dt)
            return command if self._is_odometry_fresh else STOP
        command = self._layer.guard(observation, pursuit, decide, is_commanding=is_commanding,
                                    interference=interference)
        self._warn_of_heading_jump()
        if not is_commanding and is_at_rest(observation.odometry.twist):
            self.keep_base()
        return command

    def keep_base(self) -> None:
        """Keep what was learned of the base, once the robot stands."""
        fault = self._memory.keep(self._layer.base_knowledge)
        if fault:
            self._node.reporter.report(WARN, fault, always=True)

    @property
    def _is_odometry_fresh(self) -> bool:
        """Tell whether a command may rest on odometry; in lockstep time waits for the answer."""
        if self._is_lockstep:
            return self._repetitions < MAX_REPETITIONS
        return self.check_odometry().state is OdometryState.PRESENT

    def set_settings(self, control: ControlSettings) -> None:
        """Set under way for how long the base may stand."""
        self._layer.standstill_limit = control.standstill_limit

    def limit_speed(self, limit: float) -> None:
        """
        Limit the speed for now.

        :param limit: greatest speed [m/s]; infinite for none.
        """
        self._layer.speed_limit = limit

    def set_object(self, obj: PushedObject) -> None:
        """Expect poses of another object."""
        self._layer.set_object(obj)

    def _warn_of_heading_jump(self) -> None:
        """Log once that the tracker mistakes the heading."""
        jump, before = self._layer.heading_jump, self._heading_jump
        self._heading_jump = jump
        if jump and not before:
            self._node.get_logger().warning(
                f'object_pose: its heading has jumped by {math.degrees(jump):.0f} deg, at which '
                'the object looks the same: taken as a mistake of the tracker '
                '(control.heading_count)')

    def check_odometry(self) -> ClockCheck:
        """Find out how long odometry has been missing."""
        return self._watchdog.check(self._node.get_clock().now().nanoseconds, time.monotonic())
