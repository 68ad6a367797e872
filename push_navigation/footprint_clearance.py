"""
Clearance of a footprint from the occupied cells of a map, exact to the square that a cell is.

The separation of two convex polygons is the largest gap across an edge of either; where it is
negative, it is the shortest way out of the overlap. Where it is positive, the distance is that of
a vertex of one from the other. Only cells nearby are looked at: those in a row that the distance
field of the map rules out are skipped.
"""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_model.geometry import FloatArray

# By how much distances between cell centres are too short at most [cells], see
# ``distance_field``; and what is longer than any edge of a cell.
FIELD_ERROR = 2.0
FAR = 1e18


@compiled
def footprint_clearance(distances: Any, cells_per_metre: float, footprint: Any, pose: Any,
                        enough: float) -> float:
    """
    Measure the clearance of a footprint, or find some that is enough.

    :param distances: clearances of cell centres, with a border of one cell, negative in obstacles,
        shape (r, c) [m].
    :param cells_per_metre: of the map [1/m].
    :param footprint: vertices of a convex polygon, counter-clockwise, shape (n, 2) [m], and the
        radius by which it is inflated [m]; a disc has one vertex.
    :param pose: (x, y, theta) of the footprint in the frame of the map.
    :param enough: clearance from which on no exact value is needed [m]; below 0 where an overlap
        is allowed.
    :return: distance [m], negative where the footprint overlaps an obstacle or leaves the map.
    """
    vertices, radius = footprint
    side = 1.0 / cells_per_metre
    rows, columns = distances.shape[0] - 2, distances.shape[1] - 2
    box = _bounds(vertices, pose)
    to_rim = min(box[0], columns * side - box[1], box[2], rows * side - box[3])
    if to_rim < radius and to_rim <= 0.0:
        return to_rim - radius
    most = enough + radius
    least = min(most, to_rim)
    around = max(0.0, least)
    first = max(0, int(math.floor((box[0] - around) * cells_per_metre)))
    last = min(columns - 1, int(math.floor((box[1] + around) * cells_per_metre)))
    low = max(0, int(math.floor((box[2] - around) * cells_per_metre)))
    high = min(rows - 1, int(math.floor((box[3] + around) * cells_per_metre)))
    for i in range(low, high + 1):
        j = first
        while j <= last:
            free = distances[i + 1, j + 1]
            if free < 0.0:
                gap = _gap_to_square(vertices, pose, box, ((j + 0.5) * side, (i + 0.5) * side),
                                     0.5 * side, least)
                least = min(least, gap)
                j += 1
            else:
                # The edge of the next square in the row is as far away.
                j += max(1, int(free * cells_per_metre + 1.0))
    # Rounding of the sum must not make less of what is enough.
    return enough if least >= most else least - radius


@compiled
def footprint_clearances(distances: Any, cells_per_metre: float, footprint: Any, poses: FloatArray,
                         enough: float, clearances: FloatArray) -> None:
    """
    Measure the clearances of a footprint at several poses.

    Other arguments are as of ``footprint_clearance``.

    :param poses: shape (k, 3).
    :param clearances: shape (k,), is written.
    """
    vertices, _ = footprint
    rows, columns = distances.shape
    for k in range(poses.shape[0]):
        limit = enough
        c, s = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        for vertex in range(vertices.shape[0]):
            u, v = vertices[vertex, 0], vertices[vertex, 1]
            column = int(math.floor((poses[k, 0] + c * u - s * v) * cells_per_metre)) + 1
            row = int(math.floor((poses[k, 1] + s * u + c * v) * cells_per_metre)) + 1
            if 0 <= row < rows and 0 <= column < columns:
                # A vertex bounds the clearance, by that of the cell in which it lies.
                limit = min(limit, max(0.0, distances[row, column])
                            + FIELD_ERROR / cells_per_metre)
        clearances[k] = footprint_clearance(
            distances, cells_per_metre, footprint, (poses[k, 0], poses[k, 1], poses[k, 2]), limit)


@compiled
def _bounds(vertices: Any, pose: Any) -> tuple[float, float, float, float]:
    """Find the least and largest x, and the least and largest y, of a polygon."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    low_x, high_x, low_y, high_y = FAR, -FAR, FAR, -FAR
    for k in range(vertices.shape[0]):
        x = pose[0] + c * vertices[k, 0] - s * vertices[k, 1]
        y = pose[1] + s * vertices[k, 0] + c * vertices[k, 1]
        low_x, high_x = min(low_x, x), max(high_x, x)
        low_y, high_y = min(low_y, y), max(high_y, y)
    return low_x, high_x, low_y, high_y


@compiled
def _gap_to_square(vertices: Any, pose: Any, box: Any, center: Any, half: float,
                   enough: float) -> float:
    """
    Measure the gap of a polygon to a square along the axes of the map.

    :param box: bounds of the polygon (x, x, y, y) [m].
    :param center: (x, y) of the square [m].
    :param half: half its side [m].
    :param enough: gap from which on no exact value is needed [m].
    """
    separation = max(max(box[0] - center[0], center[0] - box[1]),
                     max(box[2] - center[1], center[1] - box[3])) - half
    if separation >= enough:
        return separation
    c, s = math.cos(pose[2]), math.sin(pose[2])
    d_x, d_y = center[0] - pose[0], center[1] - pose[1]
    u, v = c * d_x + s * d_y, c * d_y - s * d_x
    count = vertices.shape[0]
    for k in range(count if count > 1 else 0):
        following = k + 1 if k + 1 < count else 0
        e_x, e_y = vertices[following, 0] - vertices[k, 0], vertices[following, 1] - vertices[k, 1]
        outward = (u - vertices[k, 0]) * e_y - (v - vertices[k, 1]) * e_x
        extent = half * (abs(c * e_y + s * e_x) + abs(s * e_y - c * e_x))
        separation = max(separation, (outward - extent) / math.sqrt(e_x * e_x + e_y * e_y))
        if separation >= enough:
            return separation
    if separation <= 0.0:
        return separation
    return max(separation, math.sqrt(_squared_distance(vertices, (c, s), (d_x, d_y), half)))


@compiled
def _squared_distance(vertices: Any, turn: Any, center: Any, half: float) -> float:
    """
    Square of the distance of a polygon from a square that it does not overlap.

    :param turn: cosine and sine of the heading of the polygon.
    :param center: (x, y) of the square from the frame of the polygon, in axes of the map [m].
    """
    (c, s), count, least = turn, vertices.shape[0], FAR
    for k in range(count):
        # From the vertex to the square.
        beyond_x = abs(c * vertices[k, 0] - s * vertices[k, 1] - center[0]) - half
        beyond_y = abs(s * vertices[k, 0] + c * vertices[k, 1] - center[1]) - half
        beyond_x, beyond_y = max(0.0, beyond_x), max(0.0, beyond_y)
        least = min(least, beyond_x * beyond_x + beyond_y * beyond_y)
        following = k + 1 if k + 1 < count else 0
        e_x, e_y = vertices[following, 0] - vertices[k, 0], vertices[following, 1] - vertices[k, 1]
        square = e_x * e_x + e_y * e_y
        for corner in range(4 if square > 0.0 else 0):
            # From a corner of the square to the edge.
            m_x = center[0] + (half if corner % 2 else -half)
            m_y = center[1] + (half if corner > 1 else -half)
            d_x = c * m_x + s * m_y - vertices[k, 0]
            d_y = c * m_y - s * m_x - vertices[k, 1]
            t = min(1.0, max(0.0, (d_x * e_x + d_y * e_y) / square))
            d_x, d_y = d_x - t * e_x, d_y - t * e_y
            least = min(least, d_x * d_x + d_y * d_y)
    return least
