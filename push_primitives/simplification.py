"""
Objects with fine outlines and many supports, such as scanned ones, with no more than counts.

Vertices are left out that lie less than a tolerance from the edge that replaces them, by the
algorithm of Ramer (1972) and Douglas and Peucker (1973). Supports are merged in pairs, each time
those whose merger changes the moment of inertia of the load least (Ward, 1963): mass centre, load
and friction stay, and nearly the centre of friction. What has been simplified is not changed by
doing it again.
"""

import dataclasses
import functools

import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import Outline, PushedObject, Support

# Distance from the outline up to which a vertex does not count [m], and the same over the size of
# the object; chosen: contacts this near to a vertex count as at it, and poses are measured worse.
VERTEX_TOLERANCE = 1e-3
TOLERANCE_RATIO = 0.005
# Most vertices and supports; chosen: 48 vertices of a disc of 1 m diameter lie within 1.1 mm of
# it, and friction that is distributed over 12 points is nearly that over all.
MAX_VERTICES = 48
MAX_SUPPORTS = 12
# Growth of the tolerance while there are more vertices; chosen.
TOLERANCE_GROWTH = 1.5


# Kept, as each request for a plan brings the same few objects; 64 of them take some hundred kB.
@functools.lru_cache(maxsize=64)
def simplified_object(obj: PushedObject) -> PushedObject:
    """
    Leave out the vertices and supports of an object that hardly matter.

    :return: ``PushedObject`` of at most 48 vertices and 12 supports; the same one where nothing
        is left out.
    """
    outline = simplified_outline(obj.outline) if obj.outline else obj.outline
    supports = merged_supports(obj)
    if len(outline) == len(obj.outline) and len(supports) == len(obj.supports):
        return obj
    return dataclasses.replace(obj, outline=outline, supports=supports)


def simplified_outline(outline: Outline) -> Outline:
    """
    Leave out vertices that lie within 1 mm of the edge that replaces them.

    The tolerance is less for objects smaller than 0.2 m, and as much more as it takes for 48
    vertices.

    :param outline: vertices (x, y) of a convex polygon, counter-clockwise [m].
    :return: some of them, at least 3.
    """
    vertices = np.array(outline, dtype=float)
    # The two vertices that are farthest apart stay, whatever is left out.
    gaps = [np.hypot(*(vertices - vertex).T) for vertex in vertices]
    first = max(range(len(gaps)), key=lambda index: gaps[index].max())
    second = int(gaps[first].argmax())
    tolerance = min(VERTEX_TOLERANCE, TOLERANCE_RATIO * float(gaps[first].max()))
    while True:
        remaining = [first, *_between(vertices, first, second, tolerance), second,
                     *_between(vertices, second, first + len(vertices), tolerance)]
        if len(remaining) <= MAX_VERTICES:
            break
        tolerance *= TOLERANCE_GROWTH
    if len(remaining) < 3:
        return outline
    return tuple(outline[i] for i in sorted(index % len(vertices) for index in remaining))


def _between(vertices: FloatArray, first: int, last: int, tolerance: float) -> list[int]:
    """List the vertices between two that remain, by index; beyond the end from 0 again."""
    indices = np.arange(first + 1, last)
    if not len(indices):
        return []
    count = len(vertices)
    start, end = vertices[first % count], vertices[last % count]
    x, y = (vertices[indices % count] - start).T
    along_x, along_y = (end - start) / np.hypot(*(end - start))
    distances = np.abs(along_x * y - along_y * x)
    farthest = int(distances.argmax())
    if distances[farthest] <= tolerance:
        return []
    split = int(indices[farthest])
    return [*_between(vertices, first, split, tolerance), split,
            *_between(vertices, split, last, tolerance)]


def merged_supports(obj: PushedObject) -> tuple[Support, ...]:
    """
    Merge supports until there are at most 12.

    :return: ``Support`` each, with the load fractions of those that it stands for.
    """
    if len(obj.supports) <= MAX_SUPPORTS:
        return obj.supports
    # Supports without load carry nothing, and have no part in friction.
    carrying = np.array(obj.loads) > 0.0
    loads = np.array(obj.loads)[carrying]
    frictions = np.array([support.friction_coefficient for support in obj.supports])[carrying]
    positions = np.array([(support.x, support.y) for support in obj.supports])[carrying]
    costs = np.array([_merging_costs(index, positions, loads) for index in range(len(loads))])
    is_remaining = np.ones(len(loads), dtype=bool)
    for _ in range(len(loads) - MAX_SUPPORTS):
        one, other = sorted(divmod(int(costs.argmin()), len(loads)))
        pair = np.array([one, other])
        weights = loads[pair] / loads[pair].sum()
        positions[one], frictions[one] = weights @ positions[pair], weights @ frictions[pair]
        loads[one] += loads[other]
        is_remaining[other] = False
        costs[other] = costs[:, other] = np.inf
        costs[one] = costs[:, one] = np.where(
            is_remaining, _merging_costs(one, positions, loads), np.inf)
    positions, frictions, loads = (
        values[is_remaining] for values in (positions, frictions, loads))
    fractions = loads / loads.sum()
    return tuple(Support(x, y, friction, fraction) for (x, y), friction, fraction
                 in zip(positions.tolist(), frictions.tolist(), fractions.tolist()))


def _merging_costs(index: int, positions: FloatArray, loads: FloatArray) -> FloatArray:
    """Compute what the loads' moment of inertia loses by merging one with each [N m^2]."""
    squares = ((positions - positions[index]) ** 2).sum(axis=1)
    costs = loads[index] * loads / (loads[index] + loads) * squares
    costs[index] = np.inf
    return costs
