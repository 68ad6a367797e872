"""How near to the object a candidate comes."""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.approach.encoding import (
    ANGLE, ApproachProblem, CURVES, DETOURS, KIND, LEADS_ON, LENGTH, moved, NO_LENGTH, THETA, X, Y,
)

# While the robot is leaving the object, the gap grows by at least this fraction of the distance it
# moves. Chosen: the cosine of 75 degrees, nearly.
MIN_GROWTH = 0.25
# Distance between samples that are tested for their distance from the object [m]. Chosen: between
# samples an arc of 0.1 m radius comes 0.1 mm nearer.
SAMPLE_SPACING = 0.01


@compiled
def gap(problem: ApproachProblem, x: float, y: float) -> float:
    """
    Compute the distance between robot and object, negative where they overlap.

    :param x: of the robot's centre [m].
    :param y: of the robot's centre [m].
    """
    corners = problem.corners
    count = len(corners)
    if count == 1:
        return math.hypot(x - corners[0, 0], y - corners[0, 1]) - problem.contact_radius
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
    return (-away if inside else away) - problem.contact_radius


@compiled
def keeps_clear(problem: ApproachProblem, segments: Any, count: int) -> bool:
    """
    Tell whether a candidate keeps its distances from the object.

    As long as it has not been clear of the object yet, the gap must grow; on the last straight
    line, which leads on to the object, anything is allowed. From corner to corner of the object
    a detour keeps the clearance by its construction.

    :param segments: shape (s, SEGMENT_SIZE).
    :param count: of segments.
    """
    before = gap(problem, problem.start_x, problem.start_y)
    has_departed = before >= problem.clearance
    for i in range(count):
        row = segments[i]
        if row[KIND] == DETOURS or row[KIND] == LEADS_ON:
            has_departed = True
            continue
        if has_departed:
            before = gap(problem, row[X], row[Y])
        limit = problem.clearance - NO_LENGTH
        if row[KIND] == CURVES:
            limit -= problem.arc_allowance
        s = 0.0
        while s < row[LENGTH]:
            # The gap changes by as much as the robot moves at most.
            step = min(row[LENGTH] - s,
                       max(SAMPLE_SPACING, before - limit) if has_departed else SAMPLE_SPACING)
            s += step
            x, y, _ = moved((row[X], row[Y], row[THETA]), s, row[ANGLE] * s / row[LENGTH])
            here = gap(problem, x, y)
            if here < limit and (has_departed or here - before < MIN_GROWTH * step - NO_LENGTH):
                return False
            has_departed = has_departed or here >= problem.clearance - NO_LENGTH
            before = here
    return True
