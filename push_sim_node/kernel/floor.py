"""A floor whose friction depends on the place: wet spots, rugs, another flooring."""

import dataclasses
import math

from push_model.quantity import check, quantity
from push_sim_node.kernel.compiled import compiled

PATCH_SIZE = 8


@dataclasses.dataclass(frozen=True)
class FloorPatch:
    """A rectangle of floor on which the friction under supports is multiplied."""

    x: float = quantity('middle in the world, x', 'm')
    y: float = quantity('middle in the world, y', 'm')
    length: float = quantity('size along its own x', 'm', above=0.0)
    width: float = quantity('size along its own y', 'm', above=0.0)
    factor: float = quantity('what friction is multiplied by', '', 0.0, 100.0)
    theta: float = quantity('orientation in the world', 'rad', default=0.0)
    edge: float = quantity('width over which friction changes at the rim; 0: at once', 'm', 0.0,
                           default=0.0)

    def __post_init__(self):
        """Validate the fields."""
        check(self)


def floor_rows(patches):
    """
    Write patches down for the kernel; where they overlap they multiply.

    :param patches: ``FloorPatch`` sequence.
    """
    return [(patch.x, patch.y, math.cos(patch.theta), math.sin(patch.theta), 0.5 * patch.length,
             0.5 * patch.width, patch.factor, patch.edge) for patch in patches]


@compiled
def friction_factor_at(floor, x, y):
    """
    Factor on the friction at a place.

    :param floor: rows (x, y, cosine, sine, half length, half width, factor, edge), shape (k, 8).
    :param x: place in the world, x [m].
    :param y: the same, y [m].
    """
    result = 1.0
    for i in range(len(floor)):
        m_x, m_y, c, s, half_x, half_y, factor, edge = floor[i]
        along, across = c * (x - m_x) + s * (y - m_y), c * (y - m_y) - s * (x - m_x)
        depth = min(half_x - abs(along), half_y - abs(across))
        share = 1.0 if depth > 0.0 else 0.0
        if edge > 0.0:
            share = min(1.0, max(0.0, 0.5 + depth / edge))
        result *= 1.0 + (factor - 1.0) * share
    return result


@compiled
def set_local_capacities(floor, supports, x, y, c, s):
    """
    Set the capacity of every support to that of the floor under it.

    :param floor: as for ``friction_factor_at``.
    :param supports: rows (x, y from the mass centre [m], capacity here, capacity on plain floor
        [N]), shape (k, 4): the third number is written.
    :param x: mass centre in the world, x [m].
    :param y: the same, y [m].
    :param c: cosine of the object's orientation.
    :param s: sine of it.
    """
    for i in range(len(supports)):
        s_x, s_y, plain = supports[i][0], supports[i][1], supports[i][3]
        supports[i][2] = plain * friction_factor_at(floor, x + c * s_x - s * s_y, y + s * s_x + c * s_y)
