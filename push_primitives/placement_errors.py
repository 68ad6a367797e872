"""Sensitivity of primitives to errors of the contact position."""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, wrap_angle
from push_primitives.table import PrimitiveTable

# Digits to which tilts and curvatures are compared.
DIGITS = 6


class PlacementDeviations(NamedTuple):
    """
    Standard deviations of where and how far a primitive is driven.

    :param along: of the first contact along the outline [m].
    :param heading: of the direction of motion [rad].
    :param length: of the driven length [m].
    """

    along: float
    heading: float
    length: float


# Of a localized robot, and of one that is not sure of its position: measured by closed-loop pushes
# of the simulated plant with odometry that drifts by 2 % and 0.02 rad/m.
LOCALIZED = PlacementDeviations(0.006, math.radians(1.0), 0.003)
UNSURE = PlacementDeviations(0.02, math.radians(1.7), 0.003)


def with_placement_errors(table: PrimitiveTable, deviations: PlacementDeviations = LOCALIZED,
                          seed: int = 1) -> FloatArray:
    """
    Add a normal error of placement to every primitive and guess of friction, one for all lengths.

    The effect of an error is linear, ``d + J_s e_s + J_a e_a + J_l e_l``, with derivatives from
    differences between neighbours in position, angle and length.

    :param seed: of the random numbers.
    :return: displacements, shape (n, K, L, 3).
    """
    rng = np.random.default_rng(seed)
    displacements = table.displacements
    errors = rng.standard_normal((3, *displacements.shape[:2]))[..., None, None]
    by_position, by_angle = contact_derivatives(table)
    by_length = np.gradient(displacements, table.lengths, axis=2)
    return (displacements + by_position * (deviations.along * errors[0])
            + by_angle * (deviations.heading * errors[1])
            + by_length * (deviations.length * errors[2]))


def contact_derivatives(table: PrimitiveTable) -> tuple[FloatArray, FloatArray]:
    """
    Differentiate displacements by the position along the outline and by the direction of motion.

    The other one is held. Where the outline is curved, the normal turns with the position, on a
    disc of radius r at 1 / r, so that the approach angle falls by as much.

    :return: derivatives of shape (n, K, L, 3): by position, counter-clockwise [1/m], and
        by direction [1/rad].
    """
    rows = {_key(table, row): row for row in range(len(table.approach_angles))}
    by_position = np.zeros_like(table.displacements)
    by_angle = np.zeros_like(table.displacements)
    angles = sorted({round(angle, DIGITS) for angle in table.approach_angles.tolist()})
    for row in range(len(table.approach_angles)):
        point, angle, curvature = _key(table, row)
        before, after = (_neighbour(table, point, step) for step in (-1, 1))
        low, high = rows[before, angle, curvature], rows[after, angle, curvature]
        separation = _separation(table, before, after)
        by_position[row] = (table.displacements[high] - table.displacements[low]) / separation
        rank = angles.index(angle)
        lower, higher = angles[max(0, rank - 1)], angles[min(len(angles) - 1, rank + 1)]
        # Arcs have no neighbours in angle; the straight push at their point has the same start.
        curvature = curvature if (point, lower, curvature) in rows else 0.0
        by_angle[row] = ((table.displacements[rows[point, higher, curvature]]
                          - table.displacements[rows[point, lower, curvature]])
                         / (higher - lower))
        turn = wrap_angle(table.face_points[after].normal - table.face_points[before].normal)
        by_position[row] -= by_angle[row] * (turn / separation)
    return by_position, by_angle


def _key(table: PrimitiveTable, row: int) -> tuple[int, float, float]:
    return (int(table.point_indices[row]), round(float(table.approach_angles[row]), DIGITS),
            round(float(table.curvatures[row]), DIGITS))


def _neighbour(table: PrimitiveTable, point: int, step: int) -> int:
    """Return the next point on the same face, or the point itself at the end of the face."""
    other = (point + step) % len(table.face_points)
    if table.radius > 0.0 or table.face_points[other].face == table.face_points[point].face:
        return other
    return point


def _separation(table: PrimitiveTable, before: int, after: int) -> float:
    """Return the distance along the outline from one point to another [m]."""
    first, second = table.face_points[before], table.face_points[after]
    distance = second.offset - first.offset
    return distance % (2.0 * math.pi * table.radius) if table.radius > 0.0 else distance
