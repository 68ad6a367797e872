"""Images as messages."""

import numpy as np
from numpy.typing import NDArray
from push_mujoco.camera import SimulatedCamera
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

# Frame of images, whose axes are those of REP-103 for cameras.
OPTICAL_FRAME = 'camera_optical_frame'


def to_image_message(pixels: NDArray[np.uint8], header: Header) -> Image:
    """
    Write an image.

    :param pixels: red, green and blue, shape (rows, columns, 3).
    :param header: with time and frame.
    """
    rows, columns, channels = pixels.shape
    message = Image(header=header, height=rows, width=columns, encoding='rgb8', is_bigendian=0,
                    step=columns * channels)
    message.data.frombytes(pixels.tobytes())
    return message


def to_camera_info(camera: SimulatedCamera, header: Header) -> CameraInfo:
    """
    Write the intrinsics of a camera without distortion.

    :param camera: ``SimulatedCamera``.
    :param header: that of the image.
    """
    matrix = camera.matrix
    projection = np.column_stack((matrix, np.zeros(3)))
    return CameraInfo(
        header=header, height=camera.height, width=camera.width, distortion_model='plumb_bob',
        d=[0.0] * 5, k=matrix.ravel().tolist(), r=np.eye(3).ravel().tolist(),
        p=projection.ravel().tolist())
