"""
Where a candidate leads: its straight lines and arcs, tangent to each other.

Each curve is a circle with a sense: its signed radius is positive where it is left round. Two
such circles with centres d apart and radii r1, r2 have one common tangent, in the direction

    psi = atan2(d_y, d_x) - asin((r2 - r1) / |d|)

and a turn in place is a circle of radius 0.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled, wrap_angles
from push_navigation.approach.encoding import (
    append, ApproachProblem, ARRIVAL, ARRIVAL_ANGLE, ARRIVAL_RADIUS, CURVES, DEPARTURE,
    DEPARTURE_ANGLE, DEPARTURE_RADIUS, DETOURS, DIRECTION, FIRST_RADIUS, GEAR, KEEPS_OFF,
    LAST_RADIUS, LEADS_OFF, LEADS_ON, moved, NO_ANGLE, SIDE,
)

# An arc of a curve is not longer than this [rad]. Chosen: three quarters of a circle, beyond which
# the other sense is quicker.
MAX_ARC = 1.5 * math.pi


class Circle(NamedTuple):
    """
    Circle on which the robot moves; a turn in place has no radius.

    :param x: of its centre [m].
    :param y: of its centre [m].
    :param radius: signed: positive where it is left round [m].
    """

    x: float
    y: float
    radius: float


class Tangent(NamedTuple):
    """
    Straight line between two circles.

    :param direction: of motion [rad].
    :param length: [m]; -1 where there is none.
    """

    direction: float
    length: float


class Detour(NamedTuple):
    """
    Corners of the object that the robot passes.

    :param first: number of the first one.
    :param corners: number of them; 0 where it need not go round the object, -1 where it cannot.
    :param step: from one number to the next: 1 counter-clockwise, -1 clockwise.
    """

    first: int
    corners: int
    step: int


@compiled
def circle_of(pose: tuple[float, float, float], radius: float) -> Circle:
    """
    Find the circle on which the robot moves on.

    :param pose: (x, y, direction of motion).
    :param radius: signed [m].
    """
    return Circle(pose[0] - radius * math.sin(pose[2]), pose[1] + radius * math.cos(pose[2]),
                  radius)


@compiled
def point_on(circle: Circle, direction: float) -> tuple[float, float]:
    """
    Find where the robot is on a circle as it moves in a direction.

    :param direction: of motion [rad].
    :return: (x, y) [m].
    """
    return (circle.x + circle.radius * math.sin(direction),
            circle.y - circle.radius * math.cos(direction))


@compiled
def common_tangent(start: Circle, end: Circle) -> Tangent:
    """
    Find the straight line that leads from one circle to another.

    :param start: ``Circle`` that it leaves.
    :param end: ``Circle`` that it leads to.
    :return: ``Tangent``, of length -1 where one circle is inside the other.
    """
    to_x, to_y = end.x - start.x, end.y - start.y
    growth = end.radius - start.radius
    squared = to_x * to_x + to_y * to_y - growth * growth
    if not squared > 0.0:
        return Tangent(0.0, -1.0)
    length = math.sqrt(squared)
    return Tangent(math.atan2(to_y, to_x) - math.atan2(growth, length), length)


@compiled
def corner_circle(problem: ApproachProblem, index: int, side: float) -> Circle:
    """
    Return the circle on which the robot rounds a corner of the object.

    :param index: of the corner.
    :param side: of the detour.
    """
    return Circle(problem.corners[index, 0], problem.corners[index, 1],
                  side * (problem.contact_radius + problem.clearance))


@compiled
def first_corner(problem: ApproachProblem, circle: Circle, side: float) -> int:
    """
    Find the corner that a detour round the object meets first.

    :param circle: ``Circle`` of the first curve.
    :param side: of the detour.
    :return: number of the corner, -1 where the curve overlaps with one.
    """
    reference, corner_index, least_angle = 0.0, -1, math.inf
    for i in range(len(problem.corners)):
        corner = corner_circle(problem, i, side)
        to_x, to_y = corner.x - circle.x, corner.y - circle.y
        growth, away = corner.radius - circle.radius, math.hypot(to_x, to_y)
        if away <= abs(growth):
            return -1
        direction = math.atan2(to_y, to_x) - math.asin(growth / away)
        if i == 0:
            reference = direction
        angle = side * wrap_angles(direction - reference)
        if angle < least_angle:
            corner_index, least_angle = i, angle
    return corner_index


@compiled
def detour_between(problem: ApproachProblem, first: Circle, last: Circle, side: float) -> Detour:
    """
    Find the corners that a detour passes.

    :param first: ``Circle`` of the first curve.
    :param last: ``Circle`` of the last curve.
    :param side: of the detour, 0 for none.
    :return: ``Detour``, with -1 corners where a curve overlaps with a corner.
    """
    if side == 0.0:
        return Detour(0, 0, 1)
    step = 1 if side > 0.0 else -1
    start = first_corner(problem, first, side)
    # Seen from the other end, the detour goes round the other side.
    end = first_corner(problem, Circle(last.x, last.y, -last.radius), -side)
    if start < 0 or end < 0:
        return Detour(0, -1, step)
    return Detour(start, (step * (end - start)) % len(problem.corners) + 1, step)


@compiled
def curve_angle(before: float, after: float, radius: float) -> float:
    """
    Compute the angle of a curve between two directions of motion, in its own sense.

    :param before: direction of motion [rad].
    :param after: direction of motion [rad].
    :param radius: of the curve, signed; 0 for a turn in place, the short way round [m].
    """
    angle = wrap_angles(after - before)
    if radius > 0.0 and angle < -NO_ANGLE:
        return angle + 2.0 * math.pi
    if radius < 0.0 and angle > NO_ANGLE:
        return angle - 2.0 * math.pi
    return angle


@compiled
def lay_detour(problem: ApproachProblem, candidate: Any, segments: Any, count: int,
               first: tuple[float, float, float], last: tuple[float, float, float]) -> int:
    """
    Lay out curves and tangents between departure and arrival.

    :param candidate: values of the candidate.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments so far.
    :param first: (x, y, direction of motion) at the end of the departure.
    :param last: (x, y, direction of motion) at the beginning of the arrival.
    :return: count of segments now, 0 where there is no such detour.
    """
    side = candidate[SIDE]
    reverses = 1.0 if candidate[GEAR] < 0.0 else 0.0
    circle = circle_of(first, candidate[FIRST_RADIUS])
    last_circle = circle_of(last, candidate[LAST_RADIUS])
    detour = detour_between(problem, circle, last_circle, side)
    if detour.corners < 0:
        return 0
    x, y, direction = first
    for passed in range(detour.corners + 1):
        following = last_circle
        if passed < detour.corners:
            corner = (detour.first + detour.step * passed) % len(problem.corners)
            following = corner_circle(problem, corner, side)
        tangent = common_tangent(circle, following)
        angle = curve_angle(direction, tangent.direction, circle.radius)
        if tangent.length < 0.0 or abs(angle) > MAX_ARC:
            return 0
        count = append(segments, count, DETOURS if passed > 0 else CURVES, (x, y, direction),
                       (abs(circle.radius * angle), angle), reverses)
        x, y = point_on(circle, tangent.direction)
        # Between two corners it keeps the clearance by construction.
        is_between = 0 < passed < detour.corners
        count = append(segments, count, DETOURS if is_between else KEEPS_OFF,
                       (x, y, tangent.direction), (tangent.length, 0.0), reverses)
        x, y = point_on(following, tangent.direction)
        direction, circle = tangent.direction, following
    angle = curve_angle(direction, last[2], circle.radius)
    if abs(angle) > MAX_ARC:
        return 0
    return append(segments, count, CURVES, (x, y, direction),
                  (abs(circle.radius * angle), angle), reverses)


@compiled
def lay_out(problem: ApproachProblem, candidate: Any, segments: Any) -> int:
    """
    Lay out a candidate.

    :param candidate: its values.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :return: count of segments, 0 where there is no such candidate.
    """
    backwards = 1.0 if problem.starts_backwards else 0.0
    here = problem.start_x, problem.start_y, candidate[DIRECTION]
    count = append(segments, 0, LEADS_OFF, here, (candidate[DEPARTURE], 0.0), backwards)
    here = moved(here, candidate[DEPARTURE], 0.0)
    angle = candidate[DEPARTURE_ANGLE]
    length = abs(angle) * candidate[DEPARTURE_RADIUS]
    count = append(segments, count, CURVES, here, (length, angle), backwards)
    here = moved(here, length, angle)
    reverses = candidate[GEAR] < 0.0
    if reverses != problem.starts_backwards:
        here = here[0], here[1], here[2] + math.pi

    # From the goal, the arrival backwards.
    goal = problem.goal_x, problem.goal_y, problem.goal_direction + math.pi
    joint = moved(goal, candidate[ARRIVAL], 0.0)
    angle = candidate[ARRIVAL_ANGLE]
    length = abs(angle) * candidate[ARRIVAL_RADIUS]
    there = moved(joint, length, -angle)
    arrival = there[0], there[1], there[2] + math.pi
    count = lay_detour(problem, candidate, segments, count, here, there if reverses else arrival)
    if count == 0:
        return 0
    count = append(segments, count, CURVES, arrival, (length, angle), 0.0)
    return append(segments, count, LEADS_ON, (joint[0], joint[1], problem.goal_direction),
                  (candidate[ARRIVAL], 0.0), 0.0)
