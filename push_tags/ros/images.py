"""Images and intrinsics of cameras, of messages."""

import numpy as np
from push_ros.conversions.primitives import MessageRefused
from push_tags.camera import CameraIntrinsics
from push_tags.corner_refinement import GreyImage
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

# Channels of the encodings that are read, and which of them are red, green and blue.
CHANNELS = {'mono8': 1, 'rgb8': 3, 'bgr8': 3}
# Weights of red, green and blue in grey values (ITU-R BT.601), in 256ths.
RED, GREEN, BLUE = 77, 150, 29
WEIGHTS = {'rgb8': (RED, GREEN, BLUE), 'bgr8': (BLUE, GREEN, RED)}
DISTORTION_MODEL = 'plumb_bob'
COEFFICIENTS = 5


def from_image_message(message: Image, topic: str = 'image_raw') -> GreyImage:
    """
    Read the grey values of an image.

    :param message: ``sensor_msgs/Image``, of mono8, rgb8 or bgr8.
    :param topic: what errors call the message.
    :return: shape (height, width).
    :raises MessageRefused: naming the field, what came and what was expected.
    """
    channels = CHANNELS.get(message.encoding)
    if channels is None:
        raise MessageRefused(f'{topic}.encoding: got {message.encoding!r}, expected one of '
                             + ', '.join(CHANNELS))
    row = message.width * channels
    if message.width == 0 or message.step < row:
        raise MessageRefused(f'{topic}.step: got {message.step} bytes for {message.width} columns '
                             f'of {message.encoding}, expected at least {row}, and a column')
    if message.height == 0 or len(message.data) != message.step * message.height:
        raise MessageRefused(f'{topic}.data: got {len(message.data)} bytes, expected '
                             f'{message.height} rows of {message.step}, and a row')
    rows = np.frombuffer(message.data, dtype=np.uint8).reshape(message.height, message.step)
    pixels = rows[:, :row]
    if channels == 1:
        return np.ascontiguousarray(pixels)
    weights = np.array(WEIGHTS[message.encoding], dtype=np.uint16)
    colors = pixels.reshape(message.height, message.width, channels).astype(np.uint16)
    return (colors @ weights >> 8).astype(np.uint8)


def from_compressed_message(message: CompressedImage,
                            topic: str = 'image_raw/compressed') -> GreyImage:
    """
    Read the grey values of a compressed image, as JPEG or PNG.

    :param message: ``sensor_msgs/CompressedImage``.
    :param topic: what errors call the message.
    :return: shape (height, width).
    :raises MessageRefused: where it is none.
    """
    import cv2
    data = np.frombuffer(message.data, dtype=np.uint8)
    image = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if len(data) else None
    if image is None:
        raise MessageRefused(f'{topic}.data: got {len(data)} bytes that are no image '
                             f'({message.format!r}), expected JPEG or PNG')
    return np.asarray(image, dtype=np.uint8)


def from_camera_info_message(message: CameraInfo, topic: str = 'camera_info') -> CameraIntrinsics:
    """
    Read the intrinsics of a camera.

    :param message: ``sensor_msgs/CameraInfo`` of the raw image.
    :param topic: what errors call the message.
    :raises MessageRefused: where the camera is not calibrated, or its model is another.
    """
    distortion = [float(value) for value in message.d]
    if any(distortion) and (message.distortion_model != DISTORTION_MODEL
                            or len(distortion) != COEFFICIENTS):
        raise MessageRefused(f'{topic}.d: got {len(distortion)} coefficients of '
                             f'{message.distortion_model!r}, expected {COEFFICIENTS} of '
                             f'{DISTORTION_MODEL!r}, or none')
    if message.binning_x > 1 or message.binning_y > 1 or message.roi.width or message.roi.height:
        raise MessageRefused(f'{topic}.roi: got a part of the image, or one with fewer pixels, '
                             'expected the whole one')
    matrix = [float(value) for value in message.k]
    try:
        return CameraIntrinsics(message.width, message.height, matrix[0], matrix[4], matrix[2],
                                matrix[5], *(distortion if any(distortion) else ()))
    except ValueError as error:
        raise MessageRefused(f'{topic}: {error}') from error
