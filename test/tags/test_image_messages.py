"""Images and intrinsics as messages: what is in them, and what is refused by name."""

from helpers.extras import import_extra
import numpy as np
from push_ros.conversions.primitives import MessageRefused
from push_tags.camera import CameraIntrinsics
from push_tags.ros.images import (
    from_camera_info_message, from_compressed_message, from_image_message)
import pytest
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

GREY = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
MATRIX = [300.0, 0.0, 160.0, 0.0, 310.0, 120.0, 0.0, 0.0, 1.0]


def image(encoding='mono8', channels=1, padding=0, **fields):
    """Write a grey image in any encoding, with bytes behind each row."""
    rows = np.repeat(GREY, channels, axis=1)
    data = np.pad(rows, ((0, 0), (0, padding)), constant_values=99)
    values = {'width': 4, 'height': 3, 'step': data.shape[1], **fields}
    return Image(encoding=encoding, data=data.tobytes(), **values)


@pytest.mark.parametrize('message', [image(), image(padding=5), image('rgb8', 3),
                                     image('bgr8', 3, 2)])
def test_a_grey_image_is_the_same_in_every_encoding(message) -> None:
    assert (from_image_message(message) == GREY).all()


def test_green_is_brighter_than_red_and_red_than_blue() -> None:
    colors = np.eye(3, dtype=np.uint8) * 255
    grey = [from_image_message(Image(encoding=encoding, width=3, height=1, step=9,
                                     data=colors.tobytes()))[0].tolist()
            for encoding in ('rgb8', 'bgr8')]
    red, green, blue = grey[0]
    assert green > red > blue and grey[1] == [blue, green, red]


@pytest.mark.parametrize('message, field', [
    (image('16UC1'), 'encoding'), (image(step=3), 'step'), (image(height=2), 'data'),
    (image(width=0), 'step'), (image('rgb8', 1), 'step')])
def test_what_is_no_image_is_refused_by_its_field(message, field) -> None:
    with pytest.raises(MessageRefused, match=f'image_raw.{field}: got'):
        from_image_message(message)


def test_a_compressed_image_is_the_one_that_was_compressed() -> None:
    cv2 = import_extra('cv2', 'vision')
    data = cv2.imencode('.png', GREY)[1].tobytes()
    assert (from_compressed_message(CompressedImage(format='png', data=data)) == GREY).all()
    for data in (b'', b'no image'):
        with pytest.raises(MessageRefused, match='compressed.data: got'):
            from_compressed_message(CompressedImage(data=data))


def test_intrinsics_are_those_of_the_message() -> None:
    info = CameraInfo(width=320, height=240, k=MATRIX, distortion_model='plumb_bob',
                      d=[-0.3, 0.1, 0.01, 0.02, 0.03])
    camera = from_camera_info_message(info)
    assert camera == CameraIntrinsics(320, 240, 300.0, 310.0, 160.0, 120.0, -0.3, 0.1, 0.01, 0.02,
                                      0.03)
    assert camera.matrix.ravel().tolist() == MATRIX
    assert from_camera_info_message(CameraInfo(width=320, height=240, k=MATRIX)).k_1 == 0.0


@pytest.mark.parametrize('fields, name', [
    ({'k': [0.0] * 9}, 'f_x'), ({'k': [float('nan')] * 9}, 'f_x'), ({'binning_x': 2}, 'roi'),
    ({'distortion_model': 'rational_polynomial', 'd': [0.1] * 8}, r'\.d'),
    ({'width': 0}, 'width')])
def test_a_camera_that_is_not_calibrated_is_refused(fields, name) -> None:
    with pytest.raises(MessageRefused, match=f'camera_info.*{name}: got'):
        from_camera_info_message(
            CameraInfo(**{'width': 320, 'height': 240, 'k': MATRIX, **fields}))
