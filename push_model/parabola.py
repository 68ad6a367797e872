"""The minimum of a function that is known on a grid, between two points of it."""

from collections.abc import Sequence


def vertex_offset(values: Sequence[float], index: int) -> float:
    """
    Find the vertex of the parabola through the least value and its neighbours.

    :param values: on a grid.
    :param index: of the least one.
    :return: how far the vertex is from it, in steps of the grid; 0 at an end of the grid.
    """
    if not 0 < index < len(values) - 1:
        return 0.0
    before, here, after = (float(value) for value in values[index - 1:index + 2])
    curvature = before - 2.0 * here + after
    return 0.5 * (before - after) / curvature if curvature > 0.0 else 0.0
