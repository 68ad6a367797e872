"""
Corners of a tag to a fraction of a pixel: lines along its four edges, and where these cross.

At points along an edge the grey values I are read from the black inside (a) to the white margin
(b). Where the step between them lies follows from their mean, whatever the blur, as long as that
is symmetric:

    s = b - (b - a) (mean(I) - I(a)) / (I(b) - I(a))

As grey values only enter through sums, noise does not shift it. The lines are fitted to
these points after the distortion of the lens is taken away, which bends them.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from push_model.geometry import FloatArray
from push_tags.camera import CameraIntrinsics
from push_tags.tag_pattern import CELLS

GreyImage = npt.NDArray[np.uint8]
# Passes at most, each from where the last one ended, and the change below which the last one ended
# where it began [pixel]; chosen: far below any noise, and corners that still move are not sharp.
PASSES, CONVERGED = 20, 0.01
# Ends of the profiles from the edge, in cells of the tag; chosen: inside border and margin.
DEPTH_CELLS = 0.5
# The same in pixels: least, as blur has to end within it, and greatest, as the detector errs by no
# more than some pixels; chosen.
DEPTH = 1.2, 5.0
# Corners that go further from where they were detected are none [pixel]; chosen.
MAX_CHANGE = 4.0
# Distance between the values of a profile [pixel]; chosen.
SPACING = 0.25
# Part of an edge that is left out at each end, where the blur of the next edge begins; chosen.
END_RATIO = 0.1
# Points along an edge: least and greatest number; chosen: one a pixel.
POINTS = 6, 60
# Contrast of a point over the median one of its edge below which it is left out; chosen.
MIN_CONTRAST_RATIO = 0.5
# Least number of grey values between inside and margin; chosen: three times the noise of a bad
# camera.
MIN_CONTRAST = 15.0


class _Edge(NamedTuple):
    """A line in the plane of directions: (x - point) . normal = 0."""

    point: FloatArray
    normal: FloatArray


def refine_corners(image: GreyImage, corners: FloatArray,
                   camera: CameraIntrinsics) -> FloatArray | None:
    """
    Improve the corners of the black square of a tag.

    :param image: grey values, shape (height, width).
    :param corners: as they were detected, clockwise, shape (4, 2) [pixel].
    :param camera: that took the image.
    :return: the same, improved; None where the image has no such edges.
    """
    detected = corners
    for _ in range(PASSES):
        before = corners
        edges = [_fit_edge(image, np.roll(corners, -index, axis=0), camera) for index in range(4)]
        lines = [edge for edge in edges if edge is not None]
        if len(lines) < 4:
            return None
        directions = [_intersection(lines[index - 1], lines[index]) for index in range(4)]
        corners = camera.project(np.column_stack((directions, np.ones(4))))
        # False where they are no numbers.
        if not (np.hypot(*(corners - detected).T) <= MAX_CHANGE).all():
            return None
        if np.abs(corners - before).max() < CONVERGED:
            return corners
    return None


def _fit_edge(image: GreyImage, corners: FloatArray, camera: CameraIntrinsics) -> _Edge | None:
    """Fit a line to the step from the first corner to the second; None where there is none."""
    start, end = corners[:2]
    length = float(np.hypot(*(end - start)))
    if length < CELLS:
        return None
    # Along the other two edges: across the edge, profiles of a slanted tag leave it at their side.
    across = 0.5 * (start + end - corners[2] - corners[3])
    width = float(np.hypot(*across))
    outwards = across / max(width, 1.0)
    depth = float(np.clip(DEPTH_CELLS * width / CELLS, *DEPTH))
    count = int(np.clip(length, *POINTS))
    offsets = np.linspace(-depth, depth, 1 + 2 * int(np.ceil(depth / SPACING)))
    points = start + np.linspace(END_RATIO, 1.0 - END_RATIO, count)[:, None] * (end - start)
    profiles = _interpolate(image, points[:, None] + offsets[:, None] * outwards)
    contrast = profiles[:, -1] - profiles[:, 0]
    usual = float(np.median(contrast))
    is_step = contrast > max(MIN_CONTRAST_RATIO * usual, MIN_CONTRAST)
    if np.count_nonzero(is_step) < POINTS[0]:
        return None
    # The trapezoidal rule: its first and last value count half.
    mean = (profiles.sum(axis=1) - 0.5 * (profiles[:, 0] + profiles[:, -1])) / (len(offsets) - 1)
    step = depth - 2.0 * depth * (mean - profiles[:, 0]) / np.where(is_step, contrast, 1.0)
    return _line(camera.directions((points + step[:, None] * outwards)[is_step]))


def _line(points: FloatArray) -> _Edge:
    """Fit a line to points, shape (n, 2), by least squares of their distances from it."""
    middle = points.mean(axis=0)
    _, _, axes = np.linalg.svd(points - middle, full_matrices=False)
    return _Edge(middle, axes[1])


def _intersection(one: _Edge, other: _Edge) -> FloatArray:
    normals = np.stack((one.normal, other.normal))
    if abs(float(np.linalg.det(normals))) < 1e-9:
        return np.full(2, np.nan)
    sides = one.normal @ one.point, other.normal @ other.point
    return np.asarray(np.linalg.solve(normals, sides), dtype=np.float64)


def _interpolate(image: GreyImage, pixels: FloatArray) -> FloatArray:
    """Interpolate grey values linearly, at places within the image, shape (..., 2)."""
    height, width = image.shape
    column = np.clip(pixels[..., 0], 0.0, width - 1.001)
    row = np.clip(pixels[..., 1], 0.0, height - 1.001)
    left, top = column.astype(int), row.astype(int)
    right_weight, bottom_weight = column - left, row - top
    upper = (1.0 - right_weight) * image[top, left] + right_weight * image[top, left + 1]
    lower = ((1.0 - right_weight) * image[top + 1, left]
             + right_weight * image[top + 1, left + 1])
    return np.asarray((1.0 - bottom_weight) * upper + bottom_weight * lower, dtype=np.float64)
