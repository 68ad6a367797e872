"""Detection of tags in an image."""

from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray
from push_tags.camera import CameraIntrinsics
from push_tags.corner_refinement import GreyImage, refine_corners

# Places of our corners, from the upper left one as a tag is printed, among those of OpenCV, which
# holds the family upside down.
CORNER_ORDER = [2, 3, 0, 1]


class TagDetection(NamedTuple):
    """
    A tag in an image.

    :param id: its number.
    :param corners: of the black square, clockwise from the upper left one as one looks at it,
        shape (4, 2) [pixel].
    """

    id: int
    corners: FloatArray


class TagDetector:
    """
    Detects tags of the family 36h11 in the images of a camera.

    :param camera: ``CameraIntrinsics``.
    :raises ModuleNotFoundError: where OpenCV is not installed.
    """

    def __init__(self, camera: CameraIntrinsics) -> None:
        # Imported here: whatever has no camera does without it.
        import cv2
        self.camera = camera
        family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36H11)
        self._detector = cv2.aruco.ArucoDetector(family)

    def detect(self, image: GreyImage) -> list[TagDetection]:
        """
        Detect tags, each of them once.

        :param image: grey values, shape (height, width).
        :return: those whose corners are sharp.
        :raises ValueError: where the image has another size than those of the camera.
        """
        size = (self.camera.height, self.camera.width)
        if image.shape != size or image.dtype != np.uint8:
            raise ValueError(f'image: got {image.dtype} values of the shape {image.shape}, '
                             f'expected uint8 and {size}, as camera_info has it')
        outlines, ids, _ = self._detector.detectMarkers(image)
        # None where there is no tag.
        numbers = [int(number) for number in np.ravel(ids)] if len(outlines) > 0 else []
        detections: list[TagDetection] = []
        for number, outline in zip(numbers, outlines):
            corners = np.reshape(np.asarray(outline, dtype=np.float64), (4, 2))
            refined = refine_corners(image, corners, self.camera)
            if refined is not None and numbers.count(number) == 1:
                detections.append(TagDetection(number, refined[CORNER_ORDER]))
        return detections
