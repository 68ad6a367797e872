"""ROS node that makes object poses of images of tags."""

from importlib import util
import sys
import time
from typing import Any, Callable, Sequence

from push_model.optional import how_to_install
from push_model.signals import ObjectPose
from push_ros.conversions.measurements import to_object_pose_message
from push_ros.conversions.primitives import (
    exact_stamp, MessageRefused, NANOSECONDS, nanoseconds)
from push_ros.diagnostics import ERROR, OK, WARN
from push_ros.executor import run
from push_ros.node import PushNode
from push_ros.node_settings import DetectorOptions
from push_ros.topics import TAG_DETECTOR
from push_tags.camera import CameraMounting
from push_tags.corner_refinement import GreyImage
from push_tags.detection import TagDetection, TagDetector
from push_tags.pose_fit import View
from push_tags.ros.images import (
    from_camera_info_message, from_compressed_message, from_image_message)
from push_tags.settings import DetectorSettings
from push_tags.tag_layout import read_tag_layout
from push_tags.tagged_object import TaggedObject
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

SECTIONS = (('camera.', CameraMounting), ('detector.', DetectorSettings), ('', DetectorOptions))
# Time without an image after which that is reported, and how often it is looked for [s]; chosen:
# longer than any camera pauses.
SILENCE = 1.0
PERIOD = 0.2
# A stamp that lies before the last one by more is of a time that went back [ns]; chosen: longer
# than images come out of order.
BACKWARDS = NANOSECONDS


class TagDetectorNode(PushNode):
    """
    Turns images of AprilTags into object poses.

    An image without a tag of an object tells nothing of it. A pose has the stamp of its image.

    Publishers
        ``object_pose`` (PoseWithCovarianceStamped, or PoseStamped where
        ``object_pose_with_covariance`` is false) in ``pose_frame``, of several objects
        ``objects/NAME/object_pose`` each; ``/diagnostics`` (DiagnosticArray).

    Subscribers
        ``image_raw`` (Image) or ``image_raw/compressed`` (CompressedImage), not rectified;
        ``camera_info`` (CameraInfo).

    ROS parameters
        ``camera.*``, ``detector.*``, and those of ``DetectorOptions``.
    """

    def __init__(self) -> None:
        super().__init__(TAG_DETECTOR, SECTIONS)
        mounting, settings, self._options = self.settings
        if util.find_spec('cv2') is None:
            self.refuse_to_start(how_to_install('cv2'))
        self._optical_pose = mounting.optical_pose
        self._detector: TagDetector | None = None
        self._last_stamp = 0
        self._last_image = time.monotonic()
        try:
            self._objects = {name: TaggedObject(read_tag_layout(tags), settings)
                             for name, tags in self._options.tags_by_object.items()}
        except ValueError as error:
            self.refuse_to_start(f'tags: {error}')
        self._poses = {name: self.publisher(
            'object_pose', with_covariance=self._options.object_pose_with_covariance,
            object_name=name) for name in self._objects}
        self.subscribe('camera_info', self._on_camera_info)
        if self._options.compressed:
            self._image_topic = 'image_raw/compressed'
            self.subscribe(self._image_topic, self._reader(from_compressed_message))
        else:
            self._image_topic = 'image_raw'
            self.subscribe(self._image_topic, self._reader(from_image_message))
        self.create_timer(PERIOD, self.guarded(self._look_after),
                          clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.reporter.report(OK, 'waits for images')

    def _on_camera_info(self, message: Any) -> None:
        try:
            camera = from_camera_info_message(message)
        except MessageRefused as error:
            self.reporter.report(ERROR, str(error))
            return
        if self._detector is None or self._detector.camera != camera:
            self._detector = TagDetector(camera)

    def _reader(self, read: Callable[[Any], GreyImage]) -> Callable[[Any], None]:
        """Make the callback of images of a form."""
        def receive(message: Any) -> None:
            self._last_image = time.monotonic()
            if self._detector is None:
                self.reporter.report(WARN, 'got an image, but no camera_info that fits')
                return
            try:
                detections = self._detector.detect(read(message))
            # A MessageRefused is one, too.
            except ValueError as error:
                self.reporter.report(ERROR, str(error))
                return
            self._locate(nanoseconds(message.header.stamp), detections,
                         View(self._detector.camera, self._optical_pose))
        return receive

    def _locate(self, stamp: int, detections: Sequence[TagDetection], view: View) -> None:
        """Publish the poses of the objects in an image."""
        if stamp < self._last_stamp - BACKWARDS:
            for tagged in self._objects.values():
                tagged.reset()
        self._last_stamp = stamp
        texts: list[str] = []
        values: dict[str, Any] = {'tags': ', '.join(str(tag.id) for tag in detections)}
        for name, tagged in self._objects.items():
            located = tagged.locate(stamp / NANOSECONDS, detections, view)
            if located.object_pose is not None:
                self._publish(name, located.object_pose, stamp)
            if located.failure is not None:
                texts.append(f'{name}: {located.failure.value}' if name
                             else located.failure.value)
            if located.outliers:
                values['.'.join(filter(None, (name, 'outliers')))] = ', '.join(
                    map(str, located.outliers))
        self.reporter.report(WARN if texts else OK, '; '.join(texts) or 'sees every object',
                             values)

    def _publish(self, name: str, object_pose: ObjectPose, stamp: int) -> None:
        message = to_object_pose_message(
            object_pose, self._options.pose_frame,
            with_covariance=self._options.object_pose_with_covariance)
        message.header.stamp = exact_stamp(stamp)
        self._poses[name].publish(message)

    def _look_after(self) -> None:
        if time.monotonic() - self._last_image > SILENCE:
            self._last_image = time.monotonic()
            self.reporter.report(WARN, f'gets no images on {self._image_topic}')


if __name__ == '__main__':
    sys.exit(run(TagDetectorNode))
