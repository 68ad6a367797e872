"""ROS node that makes odometry of motion capture."""

import sys
import time
from typing import Any

from push_model.geometry import Pose
from push_ros.conversions.measurements import from_object_pose_message, to_odometry_message
from push_ros.conversions.primitives import (
    exact_stamp, MessageRefused, NANOSECONDS, nanoseconds)
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode
from push_ros.node_settings import MocapOptions
from push_ros.topics import MOCAP
from push_ros.transforms.buffer import TransformBuffer, TransformUnavailable
from push_ros.transforms.listener import NOT_INSTALLED, TransformListener
from push_tracker.mocap_odometry import MocapOdometry
from push_tracker.mocap_settings import MocapSettings
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

SECTIONS = (('mocap.', MocapSettings), ('', MocapOptions))
# Time without a pose after which that is reported, and how often it is looked for [s]; chosen:
# longer than somebody who walks by hides a robot.
SILENCE = 1.0
PERIOD = 0.2
# A stamp that lies before the last one by more is of a time that went back [ns]; chosen: longer
# than poses come out of order.
BACKWARDS = NANOSECONDS


class MocapNode(PushNode):
    """
    Turns poses of a rigid body on the robot into its odometry.

    The poses come on ``robot_pose``, or as transforms of ``robot_frame`` where that is named.

    Publishers
        ``odom`` (Odometry) from ``world_frame`` to ``base_frame``, with the covariance of the
        pose; ``/diagnostics`` (DiagnosticArray).

    Subscribers
        ``robot_pose`` (PoseStamped), in ``world_frame``; or ``/tf`` and ``/tf_static``
        (TFMessage).

    ROS parameters
        ``mocap.*``, and those of ``MocapOptions``.
    """

    def __init__(self) -> None:
        super().__init__(MOCAP, SECTIONS)
        settings, self._options = self.settings
        self._odometry = MocapOdometry(settings)
        self._buffer = TransformBuffer()
        self._last_stamp = 0
        self._last_pose = time.monotonic()
        self._publisher = self.publisher('odom')
        self._source = 'poses on robot_pose'
        if self._options.robot_frame:
            self._source = f'transforms of {self._options.robot_frame}'
            if not TransformListener(self, self._buffer, self._on_transforms).is_installed:
                self.refuse_to_start(NOT_INSTALLED)
        else:
            self.subscribe('robot_pose', self._on_pose)
        self.create_timer(PERIOD, self.guarded(self._look_after),
                          clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.reporter.report(OK, f'waits for {self._source}')

    def _on_pose(self, message: Any) -> None:
        try:
            measured = from_object_pose_message(message, self._options.world_frame, 'robot_pose')
        except MessageRefused as error:
            self.reporter.report(ERROR, str(error))
            return
        self._update(nanoseconds(message.header.stamp), measured.pose)

    def _on_transforms(self) -> None:
        frame = self._options.robot_frame
        stamp = self._buffer.newest(frame)
        if stamp is None or stamp == self._last_stamp:
            return
        try:
            transform = self._buffer.lookup(self._options.world_frame, frame, stamp)
        except TransformUnavailable as error:
            self.reporter.report(WARN, str(error))
            return
        self._update(stamp, transform.planar)

    def _update(self, stamp: int, body: Pose) -> None:
        """Publish odometry of the time of a pose."""
        if stamp < self._last_stamp - BACKWARDS:
            self._odometry.reset()
        self._last_stamp = stamp
        odometry = self._odometry.update(stamp / NANOSECONDS, body)
        self._last_pose = time.monotonic()
        if odometry is None:
            if self._odometry.outliers:
                self.reporter.report(WARN, 'poses are out of reach of the robot: is another '
                                           'rigid body taken for it?')
            return
        self.reporter.report(OK, 'follows the robot')
        message = to_odometry_message(odometry, self._options.world_frame,
                                      self._options.base_frame)
        message.header.stamp = exact_stamp(stamp)
        self._publisher.publish(message)

    def _look_after(self) -> None:
        if time.monotonic() - self._last_pose > SILENCE:
            self._last_pose = time.monotonic()
            self.reporter.report(WARN, f'gets no {self._source}')


if __name__ == '__main__':
    sys.exit(run(MocapNode))
