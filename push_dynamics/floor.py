"""Floor whose friction depends on the place: wet spots, rugs, another flooring."""

import dataclasses
import math
from typing import Any, Sequence

from push_dynamics.compiled import compiled
from push_dynamics.layout import CAPACITY, PLAIN_CAPACITY, SUPPORT_X, SUPPORT_Y
from push_model.quantity import check, MAX_ANGLE, quantity


@dataclasses.dataclass(frozen=True)
class FloorPatch:
    """A rectangle of floor on which the friction under supports is multiplied."""

    x: float = quantity('middle in the world, x', 'm')
    y: float = quantity('middle in the world, y', 'm')
    length: float = quantity('size along its own x', 'm', above=0.0)
    width: float = quantity('size along its own y', 'm', above=0.0)
    factor: float = quantity('what friction is multiplied by', '', 0.0, 100.0)
    theta: float = quantity('orientation in the world', 'rad', -MAX_ANGLE, MAX_ANGLE, default=0.0)
    edge: float = quantity('width over which friction changes at the rim; 0: at once', 'm', 0.0,
                           default=0.0)

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)


def floor_rows(patches: Sequence[FloorPatch]) -> list[tuple[float, ...]]:
    """
    Encode patches for the kernel; the factors of patches that overlap multiply.

    :param patches: ``FloorPatch`` sequence.
    :return: rows (x, y, cosine, sine, half length, half width, factor, edge).
    """
    return [(patch.x, patch.y, math.cos(patch.theta), math.sin(patch.theta), 0.5 * patch.length,
             0.5 * patch.width, patch.factor, patch.edge) for patch in patches]


@compiled
def friction_factor_at(floor: Any, x: float, y: float) -> float:
    """
    Compute the factor on the friction at a place.

    :param floor: rows of ``floor_rows``, shape (k, 8).
    :param x: place in the world, x [m].
    :param y: place in the world, y [m].
    """
    result = 1.0
    for i in range(len(floor)):
        m_x, m_y, c, s, half_length, half_width, factor, edge = floor[i]
        along, across = c * (x - m_x) + s * (y - m_y), c * (y - m_y) - s * (x - m_x)
        depth = min(half_length - abs(along), half_width - abs(across))
        weight = 1.0 if depth > 0.0 else 0.0
        if edge > 0.0:
            weight = min(1.0, max(0.0, 0.5 + depth / edge))
        result *= 1.0 + (factor - 1.0) * weight
    return result


@compiled
def set_local_capacities(floor: Any, supports: Any, x: float, y: float, c: float,
                         s: float) -> None:
    """
    Set the friction capacity of every support to that on the floor under it.

    :param floor: rows of ``floor_rows``, shape (k, 8).
    :param supports: rows in the order of ``layout``, shape (n, 8): CAPACITY is written.
    :param x: mass centre in the world, x [m].
    :param y: mass centre in the world, y [m].
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    """
    for i in range(len(supports)):
        s_x, s_y = supports[i][SUPPORT_X], supports[i][SUPPORT_Y]
        factor = friction_factor_at(floor, x + c * s_x - s * s_y, y + s * s_x + c * s_y)
        supports[i][CAPACITY] = supports[i][PLAIN_CAPACITY] * factor
