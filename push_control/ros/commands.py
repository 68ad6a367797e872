"""Velocity commands: published while the robot is driven, then zeros for a moment, then none."""

from builtin_interfaces.msg import Time
from push_control.ros.other_commanders import OtherCommanders
from push_model.signals import STOP, Twist
from push_ros.conversions.primitives import nanoseconds
from push_ros.conversions.serialized import serialize_command
from push_ros.node import PushNode
from push_ros.node_settings import ControllerOptions
from rclpy.duration import Duration

# Zeros after the last command; chosen: 0.5 s of them by the watchdog alone, as long as velocity
# multiplexers commonly hold a source that has fallen silent.
STOP_COMMANDS = 10
# Time within which the last command must be acknowledged [s]; chosen: enough for some resends to
# a base whose computer is busy.
FLUSH_TIMEOUT = 1.0


class CommandPublisher:
    """
    Publishes commands on ``cmd_vel``.

    An idle controller publishes nothing, so that teleoperation and navigation may drive the robot.
    In lockstep the simulator waits for answers: there every command is published, with the stamp
    of the measurement that it answers.
    """

    def __init__(self, node: PushNode, frame: str, options: ControllerOptions,
                 others: OtherCommanders) -> None:
        """
        Start silent.

        :param frame: id of the robot's frame, in whose axes commands are.
        :param others: ``OtherCommanders``, who get to know what is published here.
        """
        self._others = others
        self._node = node
        self._frame = frame
        self._is_stamped = options.enable_stamped_cmd_vel
        self._is_lockstep = options.lockstep
        self._publisher = node.publisher('cmd_vel', self._is_stamped)
        self._remaining_zeros = 0

    @property
    def is_silent(self) -> bool:
        """Tell whether nothing is published until the robot is commanded again."""
        return not self._remaining_zeros

    def answer(self, twist: Twist, stamp: Time, *, is_commanding: bool) -> None:
        """
        Answer a measurement.

        :param twist: ``Twist`` in the robot's axes.
        :param stamp: of the measurement; that of the command in lockstep.
        :param is_commanding: whether the robot is commanded; else it gets the zeros that are left.
        """
        if self._is_lockstep:
            self._publish(twist, stamp)
        elif is_commanding:
            if self.is_silent:
                self._node.get_logger().debug('commands the robot')
            self._remaining_zeros = STOP_COMMANDS
            self._publish(twist, self._node.now())
        else:
            self.stop()

    def stop(self) -> None:
        """Publish one of the zeros that are left after the last command."""
        if self._remaining_zeros:
            self._remaining_zeros -= 1
            self._publish(STOP, self._node.now())
            if self.is_silent:
                self._node.get_logger().debug('commands the robot no more')

    def flush(self) -> None:
        """Publish all zeros that are left, and wait until the last one is acknowledged."""
        if self._is_lockstep:
            self._remaining_zeros = 1
        while not self.is_silent:
            self.stop()
        self._publisher.wait_for_all_acked(Duration(seconds=FLUSH_TIMEOUT))

    def _publish(self, twist: Twist, stamp: Time) -> None:
        time = nanoseconds(stamp)
        self._others.add_own(twist, time)
        self._publisher.publish(serialize_command(twist, time, self._frame,
                                                  stamped=self._is_stamped))
