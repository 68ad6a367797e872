"""
Beams of a scan that see the pushed object, which no map has.

A beam sees it that crosses its outline, widened by a margin, and does not end before it. From a
lidar within the margin all beams do; then those count that lead into the angle of the outline.
"""

import math

import numpy as np
from push_localization.scan_points import ScanPoints
from push_model.geometry import BoolArray, FloatArray, Pose
from push_model.parameters import PushedObject

# Angle by which the outline is widened for a lidar that is within the margin [rad]; chosen: some
# centimetres at half a metre.
CONTACT_ANGLE = 0.1
# Corners of the polygon round a round object; chosen: it is wider by less than a hundredth.
ROUND_CORNERS = 24
# Below this a beam is parallel to a side.
PARALLEL = 1e-12


def sees_object(scan: ScanPoints, obj: PushedObject, pose: Pose, margin: float) -> BoolArray:
    """
    Tell which beams see the object.

    :param scan: ``ScanPoints``.
    :param pose: ``Pose`` of the object in the frame of the points.
    :param margin: by which its outline is widened [m].
    :return: shape (n,).
    """
    corners = np.array([pose.transform(corner) for corner in _outline(obj)])
    sides = np.roll(corners, -1, axis=0) - corners
    normals = np.stack((sides[:, 1], -sides[:, 0]), axis=1)
    normals /= np.hypot(*normals.T)[:, None]
    rays = scan.points - scan.lenses
    # Of the lenses from each side, positive outside, and how fast beams get there.
    heights = scan.lenses @ normals.T - ((corners * normals).sum(axis=1) + margin)
    rates = rays @ normals.T
    return np.where((heights < 0.0).all(axis=1), _leads_to(corners, scan.lenses, rays),
                    _crosses(heights, rates))


def _outline(obj: PushedObject) -> list[tuple[float, float]]:
    if obj.outline:
        return list(obj.outline)
    radius = obj.radius / math.cos(math.pi / ROUND_CORNERS)
    return [(radius * math.cos(angle), radius * math.sin(angle))
            for angle in np.linspace(0.0, 2.0 * math.pi, ROUND_CORNERS, endpoint=False).tolist()]


def _crosses(heights: FloatArray, rates: FloatArray) -> BoolArray:
    """Tell whether beams, from 0 to 1, get within all sides: clipping by Cyrus and Beck."""
    with np.errstate(divide='ignore', invalid='ignore'):
        fractions = -heights / rates
    is_parallel = np.abs(rates) < PARALLEL
    entry = np.where(rates < -PARALLEL, fractions, -np.inf).max(axis=1)
    end = np.where(rates > PARALLEL, fractions, np.inf).min(axis=1)
    is_beside = (is_parallel & (heights > 0.0)).any(axis=1)
    return ~is_beside & (entry <= end) & (end >= 0.0) & (entry <= 1.0)


def _leads_to(corners: FloatArray, lenses: FloatArray, rays: FloatArray) -> BoolArray:
    """Tell whether beams lead into the angle of an outline that they begin at."""
    to_corners = corners[None] - lenses[:, None]
    cross = rays[:, None, 0] * to_corners[..., 1] - rays[:, None, 1] * to_corners[..., 0]
    along = (rays[:, None] * to_corners).sum(axis=2)
    bearings = np.arctan2(cross, along)
    is_between = (bearings.min(axis=1) < 0.0) & (bearings.max(axis=1) > 0.0)
    spans = bearings.max(axis=1) - bearings.min(axis=1)
    # Corners on either side of the beam, and not of its backward extension.
    is_inside = is_between & (spans < math.pi)
    return is_inside | (np.abs(bearings).min(axis=1) < CONTACT_ANGLE)
