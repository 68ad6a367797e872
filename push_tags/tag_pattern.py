"""
Patterns of tags of the family 36h11, to be printed and drawn.

A tag is a square of 8 x 8 cells: a black border, and 6 x 6 cells that hold its code word. It needs
a white margin of a cell at least.
"""

import numpy as np
import numpy.typing as npt

# Cells along an edge of the black square, and of the white margin.
CELLS = 8
MARGIN = 1
WHITE = 255


def tag_pattern(tag_id: int) -> npt.NDArray[np.uint8]:
    """
    Draw a tag with its margin, a pixel for a cell, its upper edge in the first row.

    OpenCV holds the family upside down: its patterns are rotated by half a turn against those of
    the AprilTag library, which ``apriltag_ros`` uses and everybody prints.

    :param tag_id: its number.
    :return: 0 for black and 255 for white, shape (10, 10).
    """
    import cv2
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36H11)
    square = np.asarray(cv2.aruco.generateImageMarker(family, tag_id, CELLS), dtype=np.uint8)
    return np.pad(np.rot90(square, 2), MARGIN, constant_values=WHITE)
