"""Node that calibrates a base: it runs the program, and records what comes."""

from collections.abc import Callable
import dataclasses
import math
import signal
import time
from typing import Any

from geometry_msgs.msg import PoseStamped
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording import Interruption, ReceivedPose
from push_base.calibration.touch_program import TouchPlan
from push_model.parameters import PushedObject, RoundRobot
from push_model.quantity import check, quantity
from push_model.signals import Odometry, STOP, Twist
from push_ros import qos
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.conversions.primitives import MessageRefused, nanoseconds, seconds
from push_ros.conversions.serialized import serialize_command
from push_ros.diagnostics import ERROR, WARN
from push_ros.node import PushNode
from push_ros.node_settings import Frames

NAME = 'push_calibration'
# Period of commands while no odometry comes [s]; chosen: below the time-out of every base.
PERIOD = 0.05
# Time on the wall after which a simulator in lockstep that is silent has ended [s]; chosen:
# longer than a busy computer takes for a step.
LOCKSTEP_TIMEOUT = 60.0
# Zeros at the end of the process, which an interrupted one may owe still.
FINAL_ZEROS = 5


@dataclasses.dataclass(frozen=True)
class CalibrationOptions:
    """Options of the calibration."""

    side: float = quantity('side of the free square, in whose middle the robot stands', 'm', 1.0,
                           20.0, default=2.0)
    enable_stamped_cmd_vel: bool = quantity('publish TwistStamped on cmd_vel, else Twist',
                                            default=True)
    object_pose_with_covariance: bool = quantity(
        'object_pose is PoseWithCovarianceStamped, else PoseStamped', default=False)
    lockstep: bool = quantity('for a simulator in lockstep: answer every measurement with one '
                              'command with its stamp; time is that of the stamps', default=False)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


SECTIONS = (('object.', PushedObject), ('robot.', RoundRobot), ('', Frames),
            ('', CalibrationOptions))


class Calibrator(PushNode):
    """
    Drives the base through the program of the calibration, within its free square.

    Publishers
        ``cmd_vel`` (TwistStamped, or Twist); ``/diagnostics`` (DiagnosticArray).

    Subscribers
        ``odom`` (Odometry); ``object_pose`` (PoseStamped, or PoseWithCovarianceStamped), of an
        object that stands still; ``robot_pose`` (PoseStamped), of the robot in a fixed frame, as
        of motion capture.

    ROS parameters
        ``object.*`` and ``robot.*``, nominal; ``world_frame``; those of ``CalibrationOptions``.
    """

    def __init__(self, on_end: Callable[[CalibrationProgram], None],
                 on_progress: Callable[[CalibrationProgram], None],
                 touch_sides: int = 0, *, touches_only: bool = False) -> None:
        """
        Read the parameters.

        :param on_end: takes the ``CalibrationProgram`` once the robot has been stopped.
        :param on_progress: takes it at each command.
        :param touch_sides: sides of the object to touch, 0, 1 or 2.
        :param touches_only: whether nothing else is measured.
        """
        super().__init__(NAME, SECTIONS)
        obj, robot, self._frames, self._options = self.settings
        self._on_end, self._on_progress = on_end, on_progress
        self._program = CalibrationProgram(
            robot, self._options.side,
            TouchPlan(obj, touch_sides, touches_only) if touch_sides else None)
        # Frames of the poses of object and robot, which a touch compares.
        self._pose_frames: dict[str, str] = {}
        self._publisher = self.publisher('cmd_vel', self._options.enable_stamped_cmd_vel)
        self._command = STOP
        # When a command is due where nothing comes, or in lockstep the end [s].
        self._due = math.inf if self._options.lockstep else 0.0
        self.subscribe('odom', self._on_odometry, real_time=True)
        self.subscribe('object_pose', self._on_object_pose, real_time=True,
                       with_covariance=self._options.object_pose_with_covariance)
        self.create_subscription(PoseStamped, 'robot_pose', self.guarded(self._on_robot_pose),
                                 qos.SENSOR, callback_group=self.background)

    def start(self) -> None:
        """Wait for odometry."""
        others = [name for name in self.publishers_of('cmd_vel') if name != f'/{NAME}']
        if others:
            self.reporter.report(WARN, f'{", ".join(others)} commands the base too: end it')

    @property
    def wake_time(self) -> float:
        """Time on the wall at which a command is due [s]."""
        return self._due

    def poll(self) -> bool:
        """Handle what has come, and command where nothing comes."""
        has_come = super().poll()
        if time.monotonic() < self._due:
            return has_come
        if self._options.lockstep:
            self._due = math.inf
            self._program.interrupt(Interruption.ODOMETRY_LOST, self._time())
            signal.raise_signal(signal.SIGTERM)
        else:
            self._step(self._time(), None)
        return has_come

    def close(self) -> None:
        """Stop the robot and keep what there is: called once, whatever ends the process."""
        program = self._program
        if not program.is_done:
            program.interrupt(Interruption.BY_USER, self._time())
        try:
            for _ in range(FINAL_ZEROS):
                self._send(STOP, self.now())
        finally:
            self._on_end(program)

    def _time(self) -> float:
        return seconds(self.now())

    def _on_odometry(self, message: Any) -> None:
        try:
            odometry = from_odometry_message(message, self._frames.world_frame)
        except MessageRefused as refusal:
            self.reporter.report(ERROR, str(refusal))
            return
        if self._options.lockstep:
            self._step(odometry.time, odometry, message.header.stamp)
        else:
            self._step(self._time(), odometry)

    def _step(self, now: float, odometry: Odometry | None, stamp: Any = None) -> None:
        if self._program.is_done:
            return
        self._due = time.monotonic() + (LOCKSTEP_TIMEOUT if self._options.lockstep else PERIOD)
        self._command = self._program.step(now, odometry)
        self._send(self._command, self.now() if stamp is None else stamp)
        self._on_progress(self._program)
        if self._program.is_done:
            # As Ctrl-C, which ends every node.
            signal.raise_signal(signal.SIGTERM)

    def _send(self, twist: Twist, stamp: Any) -> None:
        self._publisher.publish(serialize_command(
            twist, nanoseconds(stamp), self._frames.base_frame,
            stamped=self._options.enable_stamped_cmd_vel))

    def _on_object_pose(self, message: Any) -> None:
        self._note(message, 'object_pose', self._program.recording.object_poses)
        if self._options.lockstep:
            self._send(self._command, message.header.stamp)

    def _on_robot_pose(self, message: Any) -> None:
        self._note(message, 'robot_pose', self._program.recording.robot_poses)

    def _note(self, message: Any, topic: str, poses: list[ReceivedPose]) -> None:
        # In any frame: of a body that stands, or compared with odometry up to a transform.
        try:
            pose = from_object_pose_message(message, message.header.frame_id, topic)
        except MessageRefused as refusal:
            self.reporter.report(ERROR, str(refusal))
            return
        self._compare_frames(topic, message.header.frame_id)
        now = pose.time if self._options.lockstep else self._time()
        poses.append(ReceivedPose(now, pose))

    def _compare_frames(self, topic: str, frame: str) -> None:
        """Touch nothing where it is not known where the object is for the robot."""
        if self._program.recording.object is None:
            return
        self._pose_frames[topic] = frame
        expected = self._pose_frames.get('robot_pose', self._frames.world_frame)
        object_frame = self._pose_frames.get('object_pose', expected)
        self._program.may_touch = object_frame == expected
        # At first, robot_pose may not have come yet.
        if not self._program.may_touch and self._program.progress > 0.0:
            self.reporter.report(ERROR, f'object_pose is in {object_frame!r}, expected '
                                 f'{expected!r}: nothing is touched')
