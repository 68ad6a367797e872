"""Images become object poses over DDS."""

import math

from geometry_msgs.msg import PoseWithCovarianceStamped
from helpers.extras import import_extra
from helpers.node_bench import bench
from helpers.tag_images import draw_tags, object_in_camera
import numpy as np
from push_model.geometry import Pose
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.conversions.primitives import to_stamp
from push_ros.topics import TAG_DETECTOR
from push_tags.camera import CameraIntrinsics, CameraMounting
from push_tags.tag_layout import read_tag_layout
import pytest
from sensor_msgs.msg import CameraInfo, Image

import_extra('cv2', 'vision')
pytestmark = [pytest.mark.dds, pytest.mark.slow]
CAMERA = CameraIntrinsics.from_view_angle(320, 240, math.radians(60.0))
MOUNTING = CameraMounting(x=0.1, z=0.25, pitch=0.1)
POSE = Pose(0.85, 0.1, 0.4)
STAMP = to_stamp(12.5)


def message_of(pixels, encoding='mono8'):
    """Write grey values as an image."""
    message = Image(width=320, height=240, step=320, encoding=encoding, data=pixels.tobytes())
    message.header.stamp = STAMP
    return message


def test_an_image_becomes_a_pose_of_its_time(tmp_path) -> None:
    """Images in an unknown encoding are refused by name, and those without a tag tell nothing."""
    parameters = {'tags': 'box_04', 'camera.x': MOUNTING.x, 'camera.z': MOUNTING.z,
                  'camera.pitch': MOUNTING.pitch}
    image = draw_tags(read_tag_layout('box_04'), CAMERA,
                      object_in_camera(POSE, MOUNTING.optical_pose), noise=2.0)
    info = CameraInfo(width=320, height=240, k=CAMERA.matrix.ravel().tolist())
    with bench(tmp_path, TAG_DETECTOR, 'push_tags.tag_detector_node', parameters) as b:
        b.subscribe('diagnostics')
        b.subscribe('object_pose', PoseWithCovarianceStamped)

        def send(message):
            b.publish('camera_info', info)
            b.publish('image_raw', message)

        def is_reported(text):
            return any(text in status.message for message in b.received['diagnostics']
                       for status in message.status)
        b.repeat_until(lambda: send(message_of(image, '16UC1')),
                       lambda: is_reported('image_raw.encoding'))
        b.repeat_until(lambda: send(message_of(np.full_like(image, 128))),
                       lambda: is_reported('sees no tag'))
        assert b.received['object_pose'] == []
        b.repeat_until(lambda: send(message_of(image)), lambda: b.received['object_pose'])
    message = b.received['object_pose'][0]
    assert message.header.stamp == STAMP
    measured = from_object_pose_message(message, 'base_link')
    error = np.subtract(measured.pose, POSE)
    # Of a hundred thousand such errors one is beyond it.
    assert error @ np.linalg.solve(measured.covariance.matrix, error) < 26.0
    assert measured.covariance.position_deviation < 0.005
