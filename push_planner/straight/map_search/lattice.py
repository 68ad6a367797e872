"""Lattice of poses and faces, of each cell of which a search keeps the cheapest node only."""

import math
from typing import Any

from push_dynamics.compiled import compiled, wrap_angles
from push_planner.straight.map_search.problem import CELL, FREE

# Cells near the goal, where otherwise all corrections would fall into one: side [m], headings of a
# turn; chosen.
FINE_CELL, FINE_HEADINGS = 0.02, 72
FINE_DISTANCE, FINE_ANGLE = 0.25, 0.6
# The same on the way to a goal from which no push leads back; chosen.
ENCLOSED_CELL, ENCLOSED_HEADINGS = 0.04, 48
ENCLOSED_DISTANCE = 0.6
# Distance from the goal within which a disc is rolled to its heading [m], and headings of a turn
# that are told apart there; chosen: wide enough for half a turn.
ROLLING_RANGE, ROLLING_HEADINGS = 1.5, 12


@compiled
def is_rolled(query: Any, is_disc: bool, x: float, y: float) -> bool:
    """
    Tell whether the object is a disc that is so near to its goal that its heading counts.

    :param query: ``Query``.
    :param x: of the object in the frame of the map [m].
    :param y: likewise [m].
    """
    d_x, d_y = query.goal.x - x, query.goal.y - y
    return (is_disc and query.settings.heading_tolerance < FREE
            and d_x * d_x + d_y * d_y < ROLLING_RANGE * ROLLING_RANGE)


@compiled
def cell_key(query: Any, pose: Any, face: int, is_disc: bool) -> int:
    """
    Return the key of the cell in which a pose lies.

    :param query: ``Query``.
    :param pose: (x, y, theta) of the object in the frame of the map.
    :param face: that was pushed last.
    :param is_disc: whether the object is round.
    """
    goal, cell, headings, kind = query.goal, query.lattice.cell, query.lattice.headings, 0
    if (abs(goal.x - pose[0]) < FINE_DISTANCE and abs(goal.y - pose[1]) < FINE_DISTANCE
            and abs(wrap_angles(goal.theta - pose[2])) < FINE_ANGLE):
        cell, headings, kind = FINE_CELL, FINE_HEADINGS, 1
    elif (query.is_goal_enclosed and abs(goal.x - pose[0]) < ENCLOSED_DISTANCE
          and abs(goal.y - pose[1]) < ENCLOSED_DISTANCE):
        cell, headings, kind = ENCLOSED_CELL, ENCLOSED_HEADINGS, 2
    elif is_disc:
        headings = ROLLING_HEADINGS if is_rolled(query, is_disc, pose[0], pose[1]) else 1
        face = 0
    column, row = int(math.floor(pose[0] / cell)), int(math.floor(pose[1] / cell))
    heading = int(math.floor(pose[2] * headings / (2.0 * math.pi) + 0.5)) % headings
    key = (column * 1048576 + row) * 128 + heading
    return (key * 64 + face) * 4 + kind


@compiled
def find_slot(slots: Any, cell: int) -> int:
    """
    Find the slot of a cell in the hash table, or the free one for it.

    :param slots: of ``Memory``.
    :param cell: key of the cell.
    """
    mask = slots.shape[0] - 1
    # Spreads the keys of neighbouring cells; without overflow, compiled or not.
    slot = ((cell ^ (cell >> 17) ^ (cell >> 31)) & 0xFFFFFFFF) * 40503 & mask
    while slots[slot, CELL] not in (-1, cell):
        slot = (slot + 1) & mask
    return slot
