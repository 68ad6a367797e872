"""Errors of placement: how primitives differ that begin a little beside where they should."""

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


# Of a localized robot, and of one that is not sure of its place: measured by closed-loop pushes
# of the simulated plant with odometry that drifts by 2 % and 0.02 rad/m.
LOCALIZED = PlacementDeviations(0.006, math.radians(1.0), 0.003)
UNSURE = PlacementDeviations(0.02, math.radians(1.7), 0.003)


def with_placement_errors(table: PrimitiveTable, deviations: PlacementDeviations = LOCALIZED,
                          seed: int = 1) -> FloatArray:
    """
    Add a normal error of placement to every primitive and guess of friction, one for all lengths.

    The effect of an error is linear, ``d + J_s e_s + J_a e_a + J_l e_l``, with derivatives from
    differences between neighbours in place, tilt and length.

    :param seed: of the random numbers.
    :return: displacements, shape (n, K, L, 3).
    """
    rng = np.random.default_rng(seed)
    displacements = table.displacements
    errors = rng.standard_normal((3, *displacements.shape[:2]))[..., None, None]
    by_place, by_tilt = placement_derivatives(table)
    by_length = np.gradient(displacements, table.lengths, axis=2)
    return (displacements + by_place * (deviations.along * errors[0])
            + by_tilt * (deviations.heading * errors[1])
            + by_length * (deviations.length * errors[2]))


def placement_derivatives(table: PrimitiveTable) -> tuple[FloatArray, FloatArray]:
    """
    Differentiate displacements by the place along the outline and by the direction of motion.

    The other one is held. Where the outline is curved, the normal turns with the place, on a disc
    of radius r at 1 / r, so that the tilt falls by as much.

    :return: derivatives of shape (n, K, L, 3): by place, counter-clockwise [1/m], and by
        direction [1/rad].
    """
    index = {_key(table, number): number for number in range(len(table.tilts))}
    by_place = np.zeros_like(table.displacements)
    by_tilt = np.zeros_like(table.displacements)
    tilts = sorted({round(tilt, DIGITS) for tilt in table.tilts.tolist()})
    for number in range(len(table.tilts)):
        place, tilt, curvature = _key(table, number)
        before, after = (_neighbour(table, place, step) for step in (-1, 1))
        low, high = index[before, tilt, curvature], index[after, tilt, curvature]
        separation = _separation(table, before, after)
        by_place[number] = (table.displacements[high] - table.displacements[low]) / separation
        position = tilts.index(tilt)
        lower, higher = tilts[max(0, position - 1)], tilts[min(len(tilts) - 1, position + 1)]
        # Arcs have no neighbours in tilt; the straight push at their place has the same begin.
        curvature = curvature if (place, lower, curvature) in index else 0.0
        by_tilt[number] = ((table.displacements[index[place, higher, curvature]]
                            - table.displacements[index[place, lower, curvature]])
                           / (higher - lower))
        turn = wrap_angle(table.places[after].normal - table.places[before].normal)
        by_place[number] -= by_tilt[number] * (turn / separation)
    return by_place, by_tilt


def _key(table: PrimitiveTable, number: int) -> tuple[int, float, float]:
    return (int(table.place_indices[number]), round(float(table.tilts[number]), DIGITS),
            round(float(table.curvatures[number]), DIGITS))


def _neighbour(table: PrimitiveTable, place: int, step: int) -> int:
    """Return the next place on the same face, or the place itself at the end of the face."""
    other = (place + step) % len(table.places)
    if table.radius > 0.0 or table.places[other].face == table.places[place].face:
        return other
    return place


def _separation(table: PrimitiveTable, before: int, after: int) -> float:
    """Distance along the outline from one place to another [m]."""
    first, second = table.places[before], table.places[after]
    distance = second.offset - first.offset
    return distance % (2.0 * math.pi * table.radius) if table.radius > 0.0 else distance
