"""ROS node of the tracker."""

import math
import sys
import time
from typing import NamedTuple, Sequence

from push_model.signals import ObjectPose
from push_ros.conversions.measurements import to_object_pose_message
from push_ros.conversions.primitives import exact_stamp, NANOSECONDS
from push_ros.diagnostics import OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode, RateLimiter
from push_ros.node_settings import TrackerOptions
from push_ros.topics import TRACKER
from push_ros.transforms.buffer import TransformBuffer, TransformUnavailable
from push_ros.transforms.listener import NOT_INSTALLED, TransformListener
from push_tracker.object_tracker import ObjectTracker, TagSighting
from push_tracker.settings import TrackerSettings
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

SECTIONS = (('tracker.', TrackerSettings), ('', TrackerOptions))
# Period at which images that wait for a transform are looked after [s]; chosen: below that of any
# camera.
PERIOD = 0.02
# Time without a pose after which that is reported [s]; chosen: longer than a hand hides a tag.
SILENCE = 1.0
# A stamp that lies before the last one by more is of a time that went back [ns]; chosen: longer
# than images come out of order.
BACKWARDS = NANOSECONDS


class _Image(NamedTuple):
    """A time at which tags were seen, and until when its transforms are awaited, monotonic [s]."""

    stamp: int
    deadline: float


class TrackerNode(PushNode):
    """
    Turns the transforms of tags into object poses.

    As soon as a transform of a tag in ``tracker.tags`` has come, as cameras and motion capture
    publish it, the pose of the object at its stamp is published. All tags of that stamp count.
    Where the transform from the camera to ``world_frame`` comes later, it is awaited.

    Publishers
        ``object_pose`` (PoseWithCovarianceStamped, or PoseStamped where
        ``object_pose_with_covariance`` is false) in ``world_frame``; ``/diagnostics``
        (DiagnosticArray).

    Subscribers
        ``/tf`` and ``/tf_static`` (TFMessage).

    ROS parameters
        ``tracker.*``, and those of ``TrackerOptions``.

    Frames
        Poses are in ``world_frame``.
    """

    def __init__(self) -> None:
        super().__init__(TRACKER, SECTIONS)
        settings, self._options = self.settings
        self._frames = tuple(tag.frame for tag in settings.tags)
        self._tracker = ObjectTracker(settings)
        self._buffer = TransformBuffer()
        self._rate = RateLimiter(self._options.max_rate)
        self._images: list[_Image] = []
        self._last_stamp = 0
        self._last_pose = time.monotonic()
        self._poses = self.publisher(
            'object_pose', with_covariance=self._options.object_pose_with_covariance)
        listener = TransformListener(self, self._buffer, self._on_transforms)
        if not listener.is_installed:
            self.refuse_to_start(NOT_INSTALLED)
        self.create_timer(PERIOD, self.guarded(self._look_after),
                          clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.reporter.report(OK, f'waits for transforms of {", ".join(self._frames)}')

    def _on_transforms(self) -> None:
        """Note the images that are new."""
        newest = {stamp for stamp in map(self._buffer.newest, self._frames) if stamp is not None}
        if newest and max(newest) < self._last_stamp - BACKWARDS:
            self._tracker.reset()
            self._images = []
            self._last_stamp = 0
            self._rate = RateLimiter(self._options.max_rate)
        deadline = time.monotonic() + self._options.transform_timeout
        for stamp in sorted(newest):
            if stamp > self._last_stamp and self._rate.due(stamp / NANOSECONDS):
                self._images.append(_Image(stamp, deadline))
                self._last_stamp = stamp
        self._look_after()

    def _look_after(self) -> None:
        now = time.monotonic()
        while self._images:
            image = self._images[0]
            if not self._process(image, is_late=now >= image.deadline):
                break
            self._images.pop(0)
        if now - self._last_pose > SILENCE:
            self._last_pose = now
            self.reporter.report(WARN, 'sees no tag of the object')

    def _process(self, image: _Image, *, is_late: bool) -> bool:
        """Publish the pose of an image; return False where it has to wait."""
        sightings: list[TagSighting] = []
        reason = ''
        for frame in self._frames:
            if self._buffer.newest(frame) is None or not self._buffer.has(frame, image.stamp):
                continue
            try:
                sightings.append(self._sighting(frame, image.stamp))
            except TransformUnavailable as error:
                reason = str(error)
        if reason and not is_late:
            return False
        if not sightings:
            self.reporter.report(WARN, f'no transform to {self._options.world_frame!r} at '
                                       f'{image.stamp / NANOSECONDS:.3f} s: {reason}')
            return True
        update = self._tracker.update(image.stamp / NANOSECONDS, sightings)
        self._report(update.object_pose, update.outliers)
        if update.object_pose is not None:
            self._publish(update.object_pose, image.stamp)
        return True

    def _sighting(self, frame: str, stamp: int) -> TagSighting:
        camera = self._buffer.parent(frame)
        in_camera = self._buffer.lookup(camera, frame, stamp)
        return TagSighting(frame, self._buffer.lookup(self._options.world_frame, frame, stamp),
                           math.hypot(*in_camera[:3]))

    def _publish(self, object_pose: ObjectPose, stamp: int) -> None:
        message = to_object_pose_message(
            object_pose, self._options.world_frame,
            with_covariance=self._options.object_pose_with_covariance)
        message.header.stamp = exact_stamp(stamp)
        self._poses.publish(message)
        self._last_pose = time.monotonic()

    def _report(self, object_pose: ObjectPose | None, outliers: Sequence[str]) -> None:
        values = {'outliers': ', '.join(outliers)}
        if object_pose is None:
            self.reporter.report(WARN, 'sees outliers only', values)
        else:
            self.reporter.report(OK, 'tracks the object', values)


if __name__ == '__main__':
    sys.exit(run(TrackerNode))
