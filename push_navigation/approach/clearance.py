"""How near to the object a manoeuvre comes."""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.approach.encoding import (
    ANGLE, CURVES, KIND, LEADS_ON, LENGTH, Manoeuvring, moved, NO_LENGTH, THETA, TOURS, X, Y,
)

# While the robot is leaving the object, the gap grows by at least this fraction of the distance it
# moves. Chosen: the cosine of 75 degrees, nearly.
LEAST_GROWTH = 0.25
# Distance between samples that are tested for their distance from the object [m]. Chosen: between
# samples an arc of 0.1 m radius comes 0.1 mm nearer.
SAMPLE_SPACING = 0.01


@compiled
def gap(given: Manoeuvring, x: float, y: float) -> float:
    """
    Compute the distance between robot and object, negative where they overlap.

    :param given: ``Manoeuvring``.
    :param x: of the robot's centre [m].
    :param y: of the robot's centre [m].
    """
    corners = given.corners
    count = len(corners)
    if count == 1:
        return math.hypot(x - corners[0, 0], y - corners[0, 1]) - given.contact_radius
    best, inside = math.inf, True
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        edge_x, edge_y = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1]
        from_x, from_y = x - corners[i, 0], y - corners[i, 1]
        if edge_x * from_y - edge_y * from_x < 0.0:
            inside = False
        part = (from_x * edge_x + from_y * edge_y) / (edge_x * edge_x + edge_y * edge_y)
        part = min(1.0, max(0.0, part))
        away_x, away_y = from_x - part * edge_x, from_y - part * edge_y
        best = min(best, away_x * away_x + away_y * away_y)
    away = math.sqrt(best)
    return (-away if inside else away) - given.contact_radius


@compiled
def keeps_clear(given: Manoeuvring, segments: Any, count: int) -> bool:
    """
    Tell whether a manoeuvre keeps its distances from the object.

    As long as it has not been clear of the object yet, the gap must grow; on the last straight
    line, which leads on to the object, anything is allowed. From corner to corner of the object
    a tour keeps the clearance by its construction.

    :param given: ``Manoeuvring``.
    :param segments: shape (s, SEGMENT_SIZE).
    :param count: of segments.
    """
    before = gap(given, given.start_x, given.start_y)
    has_left = before >= given.clearance
    for i in range(count):
        row = segments[i]
        if row[KIND] == TOURS or row[KIND] == LEADS_ON:
            has_left = True
            continue
        if has_left:
            before = gap(given, row[X], row[Y])
        limit = given.clearance - NO_LENGTH
        if row[KIND] == CURVES:
            limit -= given.arc_allowance
        s = 0.0
        while s < row[LENGTH]:
            # The gap changes by as much as the robot moves at most.
            step = min(row[LENGTH] - s,
                       max(SAMPLE_SPACING, before - limit) if has_left else SAMPLE_SPACING)
            s += step
            x, y, _ = moved((row[X], row[Y], row[THETA]), s, row[ANGLE] * s / row[LENGTH])
            here = gap(given, x, y)
            if here < limit and (has_left or here - before < LEAST_GROWTH * step - NO_LENGTH):
                return False
            has_left = has_left or here >= given.clearance - NO_LENGTH
            before = here
    return True
