"""
Manoeuvres of the robot round the object, laid out and timed: compiled.

A manoeuvre is a sequence of straight lines and arcs from one pose to another,

    departure (straight, arc) - first curve - round corners of the object - last curve -
    arrival (arc, straight)

Each curve is a circle with a sense: its signed radius is positive where it is left round. Two
such circles with centres d apart and radii r1, r2 have one common tangent, in the direction

    psi = atan2(d_y, d_x) - asin((r2 - r1) / |d|)

and a turn in place is a circle of radius 0. A differential drive departs and arrives in one gear
and moves between the two in the same or in the other one, so that it changes its direction once
at most; for a holonomic base only directions of motion count. Frame of the object, SI units.
"""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled, wrap_angles
from push_navigation.path import MIN_ROTATION
from push_navigation.speed_profile import (
    CORNER_CUT_AT_REST, FADE_TIME, LATERAL_FRACTION, MAX_CORNER_CUT, MIN_WINDOW, PASSING_ROOM,
    YAW_FRACTION,
)

# Numbers of a manoeuvre.
GEAR = 0                # between departure and arrival: 1 forwards, -1 backwards
SIDE = 1                # of the tour round the object: 1 counter-clockwise, -1, or 0 for none
DIRECTION = 2           # of motion at the beginning [rad]
DEPARTURE = 3           # length of the first straight line [m]
DEPARTURE_ANGLE = 4     # of the arc behind it, positive to the left [rad]
DEPARTURE_RADIUS = 5    # of that arc [m]
FIRST_RADIUS = 6        # of the first curve, signed [m]
LAST_RADIUS = 7         # of the last curve, signed [m]
ARRIVAL_ANGLE = 8       # of the arc before the last straight line [rad]
ARRIVAL_RADIUS = 9      # of that arc [m]
ARRIVAL = 10            # length of the last straight line [m]
MANOEUVRE_SIZE = 11

# Numbers of a segment.
X, Y, THETA = 0, 1, 2   # where it begins, and the direction of motion there
LENGTH = 3              # 0 for a turn in place
ANGLE = 4               # change of the direction of motion, positive to the left
REVERSES = 5            # 1 where a differential drive moves backwards on it
KIND = 6                # one of those below
TOP_SPEED = 7
ACCELERATION = 8
JOINT_SPEED = 9         # squared speed at its end
WINDOW = 10             # distance before and behind its end on which the speed is that
RAMP = 11               # length on which the speed changes
SEGMENT_SIZE = 12
# Segments of a manoeuvre but for those of its tour round corners, at most, and segments of a tour
# for each corner: an arc and an edge. The first is above what any shape has.
OTHER_SEGMENTS = 32
CORNER_SEGMENTS = 2

# Kinds of segments, which differ in the distance that they keep from the object.
LEADS_OFF, CURVES, KEEPS_OFF, TOURS, LEADS_ON = 0, 1, 2, 3, 4

# An arc of a curve is not longer than this [rad]. Chosen: three quarters of a circle, beyond which
# the other sense is quicker.
LONGEST_ARC = 1.5 * math.pi
# Rounding of an arc that has no length [rad].
NO_ANGLE = 1e-7
# Rounding of lengths, and of distances from the object [m].
NO_LENGTH = 1e-7
# Gears, sides, and senses of both curves.
SHAPES = 54
# Scanned manoeuvres that are slower than the quickest by more than this are left out, and
# likewise refined ones [s]. Chosen: above what refining usually gains.
SCAN_MARGIN = 1.0
REFINE_MARGIN = 0.7
# Refined are at most so many shapes, in so many rounds. Measured on 300 approaches: with seven
# shapes none was quicker, with twelve rounds the mean by 4 ms.
REFINED_SHAPES = 4
HALVINGS = 8
# While the robot is leaving the object, the gap grows by at least this fraction of the distance it
# moves. Chosen: the cosine of 75 degrees, nearly.
LEAST_GROWTH = 0.25
# Distance between samples that are tested for their distance from the object [m]. Chosen: between
# samples an arc of 0.1 m radius comes 0.1 mm nearer.
SAMPLE_SPACING = 0.01


class Manoeuvring(NamedTuple):
    """
    What manoeuvres are laid out for.

    :param corners: of the object, counter-clockwise, shape (n, 2); one for a disc [m].
    :param contact_radius: distance of the robot's centre from the corners at contact [m].
    :param clearance: distance that the robot keeps from the object [m].
    :param arc_allowance: by which arcs may be nearer [m].
    :param is_holonomic: whether the base is.
    :param start_x: of the robot's centre [m].
    :param start_y: of the robot's centre [m].
    :param starts_backwards: whether a differential drive departs backwards.
    :param goal_x: of the robot's centre [m].
    :param goal_y: of the robot's centre [m].
    :param goal_direction: of motion at the end [rad].
    :param speed: limit [m/s].
    :param yaw_rate: limit [rad/s].
    :param acceleration: limit [m/s^2].
    :param yaw_acceleration: limit [rad/s^2].
    :param end_speed: at which the robot passes the goal, 0 where it stops there [m/s].
    :param time_constant: lag of the drive [s].
    :param reverse_limit: distance that a differential drive may move backwards [m].
    """

    corners: Any
    contact_radius: float
    clearance: float
    arc_allowance: float
    is_holonomic: bool
    start_x: float
    start_y: float
    starts_backwards: bool
    goal_x: float
    goal_y: float
    goal_direction: float
    speed: float
    yaw_rate: float
    acceleration: float
    yaw_acceleration: float
    end_speed: float
    time_constant: float
    reverse_limit: float


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


class Tour(NamedTuple):
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
def moved(begin: tuple[float, float, float], length: float,
          angle: float) -> tuple[float, float, float]:
    """
    Move along an arc.

    :param begin: (x, y, direction of motion) at its beginning.
    :param length: [m].
    :param angle: change of the direction [rad].
    :return: the same at its end.
    """
    half = 0.5 * angle
    chord = length * math.sin(half) / half if abs(half) > 1e-8 else length
    return (begin[0] + chord * math.cos(begin[2] + half),
            begin[1] + chord * math.sin(begin[2] + half), begin[2] + angle)


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
def append(segments: Any, count: int, kind: int, begin: tuple[float, float, float],
           extent: tuple[float, float], reverses: float) -> int:
    """
    Append a segment, unless it has neither length nor angle.

    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments so far.
    :param kind: of the segment.
    :param begin: (x, y, direction of motion) where it begins.
    :param extent: (length, 0 for a turn in place [m]; change of the direction [rad]).
    :param reverses: 1 where a differential drive moves backwards, else 0.
    :return: count of segments now.
    """
    length, angle = extent
    if length < NO_LENGTH and abs(angle) < NO_ANGLE:
        return count
    row = segments[count]
    row[X], row[Y], row[THETA] = begin
    row[LENGTH], row[ANGLE], row[REVERSES], row[KIND] = length, angle, reverses, kind
    return count + 1


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

    :param circle: ``Circle``.
    :param direction: of motion [rad].
    :return: (x, y) [m].
    """
    return (circle.x + circle.radius * math.sin(direction),
            circle.y - circle.radius * math.cos(direction))


@compiled
def common_tangent(begin: Circle, end: Circle) -> Tangent:
    """
    Find the straight line that leads from one circle to another.

    :param begin: ``Circle`` that it leaves.
    :param end: ``Circle`` that it leads to.
    :return: ``Tangent``, of length -1 where one circle is inside the other.
    """
    to_x, to_y = end.x - begin.x, end.y - begin.y
    growth = end.radius - begin.radius
    squared = to_x * to_x + to_y * to_y - growth * growth
    if not squared > 0.0:
        return Tangent(0.0, -1.0)
    length = math.sqrt(squared)
    return Tangent(math.atan2(to_y, to_x) - math.atan2(growth, length), length)


@compiled
def corner_circle(given: Manoeuvring, number: int, side: float) -> Circle:
    """
    Return the circle on which the robot rounds a corner of the object.

    :param given: ``Manoeuvring``.
    :param number: of the corner.
    :param side: of the tour.
    """
    return Circle(given.corners[number, 0], given.corners[number, 1],
                  side * (given.contact_radius + given.clearance))


@compiled
def first_corner(given: Manoeuvring, circle: Circle, side: float) -> int:
    """
    Find the corner that a tour round the object meets first.

    :param given: ``Manoeuvring``.
    :param circle: ``Circle`` of the first curve.
    :param side: of the tour.
    :return: number of the corner, -1 where the curve overlaps with one.
    """
    reference, found, least_angle = 0.0, -1, math.inf
    for i in range(len(given.corners)):
        corner = corner_circle(given, i, side)
        to_x, to_y = corner.x - circle.x, corner.y - circle.y
        growth, away = corner.radius - circle.radius, math.hypot(to_x, to_y)
        if away <= abs(growth):
            return -1
        direction = math.atan2(to_y, to_x) - math.asin(growth / away)
        if i == 0:
            reference = direction
        angle = side * wrap_angles(direction - reference)
        if angle < least_angle:
            found, least_angle = i, angle
    return found


@compiled
def tour_between(given: Manoeuvring, first: Circle, last: Circle, side: float) -> Tour:
    """
    Find the corners that a tour passes.

    :param given: ``Manoeuvring``.
    :param first: ``Circle`` of the first curve.
    :param last: ``Circle`` of the last curve.
    :param side: of the tour, 0 for none.
    :return: ``Tour``, with -1 corners where a curve overlaps with a corner.
    """
    if side == 0.0:
        return Tour(0, 0, 1)
    step = 1 if side > 0.0 else -1
    begin = first_corner(given, first, side)
    # Seen from the other end, the tour goes round the other side.
    end = first_corner(given, Circle(last.x, last.y, -last.radius), -side)
    if begin < 0 or end < 0:
        return Tour(0, -1, step)
    return Tour(begin, (step * (end - begin)) % len(given.corners) + 1, step)


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
def lay_tour(given: Manoeuvring, manoeuvre: Any, segments: Any, count: int,
             first: tuple[float, float, float], last: tuple[float, float, float]) -> int:
    """
    Lay out curves and tangents between departure and arrival.

    :param given: ``Manoeuvring``.
    :param manoeuvre: numbers of the manoeuvre.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments so far.
    :param first: (x, y, direction of motion) at the end of the departure.
    :param last: (x, y, direction of motion) at the beginning of the arrival.
    :return: count of segments now, 0 where there is no such tour.
    """
    side = manoeuvre[SIDE]
    reverses = 1.0 if manoeuvre[GEAR] < 0.0 else 0.0
    circle = circle_of(first, manoeuvre[FIRST_RADIUS])
    last_circle = circle_of(last, manoeuvre[LAST_RADIUS])
    tour = tour_between(given, circle, last_circle, side)
    if tour.corners < 0:
        return 0
    x, y, direction = first
    for passed in range(tour.corners + 1):
        following = last_circle
        if passed < tour.corners:
            corner = (tour.first + tour.step * passed) % len(given.corners)
            following = corner_circle(given, corner, side)
        tangent = common_tangent(circle, following)
        angle = curve_angle(direction, tangent.direction, circle.radius)
        if tangent.length < 0.0 or abs(angle) > LONGEST_ARC:
            return 0
        count = append(segments, count, TOURS if passed > 0 else CURVES, (x, y, direction),
                       (abs(circle.radius * angle), angle), reverses)
        x, y = point_on(circle, tangent.direction)
        # Between two corners it keeps the clearance by construction.
        is_between = 0 < passed < tour.corners
        count = append(segments, count, TOURS if is_between else KEEPS_OFF,
                       (x, y, tangent.direction), (tangent.length, 0.0), reverses)
        x, y = point_on(following, tangent.direction)
        direction, circle = tangent.direction, following
    angle = curve_angle(direction, last[2], circle.radius)
    if abs(angle) > LONGEST_ARC:
        return 0
    return append(segments, count, CURVES, (x, y, direction),
                  (abs(circle.radius * angle), angle), reverses)


@compiled
def lay_out(given: Manoeuvring, manoeuvre: Any, segments: Any) -> int:
    """
    Lay out a manoeuvre.

    :param given: ``Manoeuvring``.
    :param manoeuvre: its numbers.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :return: count of segments, 0 where there is no such manoeuvre.
    """
    backwards = 1.0 if given.starts_backwards else 0.0
    here = given.start_x, given.start_y, manoeuvre[DIRECTION]
    count = append(segments, 0, LEADS_OFF, here, (manoeuvre[DEPARTURE], 0.0), backwards)
    here = moved(here, manoeuvre[DEPARTURE], 0.0)
    angle = manoeuvre[DEPARTURE_ANGLE]
    length = abs(angle) * manoeuvre[DEPARTURE_RADIUS]
    count = append(segments, count, CURVES, here, (length, angle), backwards)
    here = moved(here, length, angle)
    reverses = manoeuvre[GEAR] < 0.0
    if reverses != given.starts_backwards:
        here = here[0], here[1], here[2] + math.pi

    # From the goal, the arrival backwards.
    goal = given.goal_x, given.goal_y, given.goal_direction + math.pi
    joint = moved(goal, manoeuvre[ARRIVAL], 0.0)
    angle = manoeuvre[ARRIVAL_ANGLE]
    length = abs(angle) * manoeuvre[ARRIVAL_RADIUS]
    there = moved(joint, length, -angle)
    arrival = there[0], there[1], there[2] + math.pi
    count = lay_tour(given, manoeuvre, segments, count, here, there if reverses else arrival)
    if count == 0:
        return 0
    count = append(segments, count, CURVES, arrival, (length, angle), 0.0)
    return append(segments, count, LEADS_ON, (joint[0], joint[1], given.goal_direction),
                  (manoeuvre[ARRIVAL], 0.0), 0.0)


@compiled
def limit_segment(given: Manoeuvring, row: Any) -> None:
    """
    Find speed and acceleration limits of a segment, as ``speed_profile.segment_limits`` does.

    :param given: ``Manoeuvring``.
    :param row: of the segment, changed.
    """
    speed, acceleration = given.speed, given.acceleration
    angle = abs(row[ANGLE])
    if row[LENGTH] > 0.0 and angle > 0.0:
        radius = row[LENGTH] / angle
        if not given.is_holonomic:
            speed = min(speed, given.yaw_rate * radius)
            acceleration = min(acceleration, given.yaw_acceleration * radius)
        speed = min(speed, math.sqrt(LATERAL_FRACTION * given.acceleration * radius))
        lateral = speed * speed / radius
        acceleration = min(acceleration,
                           math.sqrt(given.acceleration * given.acceleration
                                     - lateral * lateral))
    row[TOP_SPEED], row[ACCELERATION] = speed, acceleration


@compiled
def moves_on(given: Manoeuvring, segments: Any, number: int, count: int) -> bool:
    """
    Tell whether the robot need not stop at the end of a segment.

    :param given: ``Manoeuvring``.
    :param segments: shape (s, SEGMENT_SIZE).
    :param number: of the segment, -1 for the beginning of the first.
    :param count: of segments.
    """
    if number < 0:
        return False
    if number + 1 == count:
        return given.end_speed > 0.0
    before, after = segments[number], segments[number + 1]
    return before[LENGTH] > 0.0 and after[LENGTH] > 0.0 and before[REVERSES] == after[REVERSES]


@compiled
def limit_joint(given: Manoeuvring, segments: Any, number: int, count: int) -> None:
    """
    Bound the speed between two segments, as ``speed_profile.joint_speed_limit`` does.

    :param given: ``Manoeuvring``.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param number: of the first of them.
    :param count: of segments.
    """
    before, after = segments[number], segments[number + 1]
    top = min(before[TOP_SPEED], after[TOP_SPEED])
    before[JOINT_SPEED] = top * top
    if given.is_holonomic:
        return
    jump = abs(after[ANGLE] / after[LENGTH] - before[ANGLE] / before[LENGTH])
    window = top * top * jump / (2.0 * YAW_FRACTION * given.yaw_acceleration)
    if window < MIN_WINDOW:
        return
    goes_on = moves_on(given, segments, number + 1, count)
    cut = MAX_CORNER_CUT
    if not (goes_on and moves_on(given, segments, number - 1, count)):
        cut *= CORNER_CUT_AT_REST
    passes = goes_on and number + 2 == count
    longest = min(0.5 * before[LENGTH], (PASSING_ROOM if passes else 0.5) * after[LENGTH],
                  math.sqrt(6.0 * cut / jump))
    before[WINDOW] = min(window, longest)
    before[JOINT_SPEED] *= before[WINDOW] / window


@compiled
def ramp_time(length: float, first: float, last: float, speed: float,
              acceleration: float) -> float:
    """
    Time of a trapezoid of speed [s].

    :param length: [m or rad].
    :param first: squared speed at its beginning.
    :param last: squared speed at its end.
    :param speed: limit.
    :param acceleration: limit.
    """
    half = 0.5 * (first + last)
    peak = min(speed, math.sqrt(half + acceleration * length))
    even = length - (peak * peak - half) / acceleration
    return (2.0 * peak - math.sqrt(first) - math.sqrt(last)) / acceleration + even / peak


@compiled
def limit_joints(given: Manoeuvring, segments: Any, count: int) -> None:
    """
    Find the greatest speeds at the joints of segments, as ``speed_profile.joint_speeds`` does.

    :param given: ``Manoeuvring``.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments, at least one.
    """
    for i in range(count):
        limit_segment(given, segments[i])
        segments[i, JOINT_SPEED], segments[i, WINDOW] = 0.0, 0.0
    for i in range(count - 1):
        if moves_on(given, segments, i, count):
            limit_joint(given, segments, i, count)
    if segments[count - 1, LENGTH] > 0.0:
        segments[count - 1, JOINT_SPEED] = min(given.end_speed,
                                               segments[count - 1, TOP_SPEED]) ** 2
    before, window = 0.0, 0.0
    for i in range(count):
        row = segments[i]
        row[RAMP] = max(0.0, row[LENGTH] - window - row[WINDOW])
        before = min(row[JOINT_SPEED], before + 2.0 * row[ACCELERATION] * row[RAMP])
        row[JOINT_SPEED], window = before, row[WINDOW]
    for i in range(count - 1, 0, -1):
        row = segments[i]
        segments[i - 1, JOINT_SPEED] = min(
            segments[i - 1, JOINT_SPEED], row[JOINT_SPEED] + 2.0 * row[ACCELERATION] * row[RAMP])


@compiled
def duration(given: Manoeuvring, segments: Any, count: int) -> float:
    """
    Compute the time of a manoeuvre from rest, as ``speed_profile.travel_time`` does [s].

    :param given: ``Manoeuvring``.
    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments, at least one.
    """
    limit_joints(given, segments, count)
    time = given.time_constant if segments[count - 1, JOINT_SPEED] > 0.0 else 0.0
    before = 0.0
    for i in range(count):
        row = segments[i]
        last = row[JOINT_SPEED]
        if row[LENGTH] > 0.0:
            time += ramp_time(row[RAMP], before, last, row[TOP_SPEED], row[ACCELERATION])
            if last == 0.0:
                time += given.time_constant + FADE_TIME
            elif row[WINDOW] > 0.0:
                time += 2.0 * row[WINDOW] / math.sqrt(last)
        elif not given.is_holonomic and abs(row[ANGLE]) > MIN_ROTATION:
            time += (ramp_time(abs(row[ANGLE]), 0.0, 0.0, given.yaw_rate, given.yaw_acceleration)
                     + given.time_constant + FADE_TIME)
        before = last
    return time


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


@compiled
def evaluate(given: Manoeuvring, manoeuvre: Any, segments: Any, bound: float) -> float:
    """
    Compute the time of a manoeuvre.

    :param given: ``Manoeuvring``.
    :param manoeuvre: its numbers.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :param bound: of the times that count [s].
    :return: time [s]; infinite where it is not below the bound, not a number where the object is
        in the way, the robot would move backwards too far, or there is no such manoeuvre.
    """
    count = lay_out(given, manoeuvre, segments)
    if count == 0:
        return math.nan
    length = backwards = 0.0
    for i in range(count):
        length += segments[i, LENGTH]
        backwards += segments[i, LENGTH] * segments[i, REVERSES]
    if backwards > given.reverse_limit:
        return math.nan
    if length >= bound * given.speed:
        return math.inf
    time = duration(given, segments, count)
    if time >= bound:
        return math.inf
    return time if keeps_clear(given, segments, count) else math.nan


@compiled
def shape_of(manoeuvre: Any) -> int:
    """
    Return the number of the shape of a manoeuvre: gear, side, and sense of both curves.

    :param manoeuvre: its numbers.
    """
    first = (manoeuvre[FIRST_RADIUS] > 0.0) - (manoeuvre[FIRST_RADIUS] < 0.0)
    last = (manoeuvre[LAST_RADIUS] > 0.0) - (manoeuvre[LAST_RADIUS] < 0.0)
    number = 3 * (first + 1) + last + 1
    return 9 * (3 * (manoeuvre[GEAR] > 0.0) + int(manoeuvre[SIDE]) + 1) + number


@compiled
def scan_sides(given: Manoeuvring, row: Any, found: Any, segments: Any, quickest: float) -> float:
    """
    Keep a manoeuvre on either side of the object where it is the quickest of its shape.

    :param given: ``Manoeuvring``.
    :param row: numbers of the manoeuvre, of which the side is changed.
    :param found: as of ``scan``, changed.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :param quickest: time of the quickest manoeuvre so far [s].
    :return: the same now [s].
    """
    for side in (0.0, 1.0, -1.0):
        row[SIDE] = side
        best = found[shape_of(row)]
        time = evaluate(given, row, segments, min(best[0], quickest + SCAN_MARGIN))
        if time < best[0]:
            best[0] = time
            quickest = min(quickest, time)
            for k in range(MANOEUVRE_SIZE):
                best[1 + k] = row[k]
        # Where the object is not in the way, going round it is no quicker.
        if side == 0.0 and not math.isnan(time):
            break
    return quickest


@compiled
def scan(given: Manoeuvring, starts: Any, ends: Any, found: Any, segments: Any) -> None:
    """
    Find the quickest manoeuvre of each shape, among given departures and arrivals.

    :param given: ``Manoeuvring``.
    :param starts: numbers of manoeuvres up to ``FIRST_RADIUS``, shape (n, MANOEUVRE_SIZE).
    :param ends: the others, shape (m, MANOEUVRE_SIZE).
    :param found: time and numbers for each shape, changed, shape (SHAPES + 1, MANOEUVRE_SIZE + 2);
        its last row is scratch.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    """
    for i in range(SHAPES):
        found[i, 0] = math.inf
    quickest = math.inf
    row = found[SHAPES, 1:]
    for gear in (1.0, -1.0):
        if gear < 0.0 and not given.starts_backwards:
            continue
        row[GEAR] = gear
        for i in range(len(starts)):
            for j in range(len(ends)):
                # In the gear in which it departs or arrives, the first or last curve is the arc.
                if starts[i, DEPARTURE_ANGLE] if gear < 0.0 else ends[j, ARRIVAL_ANGLE]:
                    continue
                for k in range(DIRECTION, MANOEUVRE_SIZE):
                    row[k] = starts[i, k] if k < LAST_RADIUS else ends[j, k]
                quickest = scan_sides(given, row, found, segments, quickest)


@compiled
def refine(given: Manoeuvring, steps: Any, least: Any, found: Any, segments: Any) -> float:
    """
    Make the quickest manoeuvres quicker, one number after the other.

    :param given: ``Manoeuvring``.
    :param steps: first step of each number, 0 where it stays, shape (MANOEUVRE_SIZE,).
    :param least: least magnitude of each number, shape (MANOEUVRE_SIZE,).
    :param found: as of ``scan``, changed.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :return: time of the quickest [s].
    """
    quickest = math.inf
    for i in range(SHAPES):
        quickest = min(quickest, found[i, 0])
    for _ in range(REFINED_SHAPES):
        best = -1
        for i in range(SHAPES):
            if found[i, 0] < quickest + REFINE_MARGIN and found[i, MANOEUVRE_SIZE + 1] == 0.0 and (
                    best < 0 or found[i, 0] < found[best, 0]):
                best = i
        if best < 0:
            break
        refine_one(given, steps, least, found[best], segments)
        found[best, MANOEUVRE_SIZE + 1] = 1.0
        quickest = min(quickest, found[best, 0])
    return quickest


@compiled
def refine_one(given: Manoeuvring, steps: Any, least: Any, row: Any, segments: Any) -> None:
    """
    Make one manoeuvre quicker by pattern search.

    :param given: ``Manoeuvring``.
    :param steps: first step of each number, 0 where it stays, shape (MANOEUVRE_SIZE,).
    :param least: least magnitude of each number, shape (MANOEUVRE_SIZE,).
    :param row: time and numbers, changed, shape (MANOEUVRE_SIZE + 2,).
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    """
    manoeuvre = row[1:]
    scale = 1.0
    for _ in range(HALVINGS):
        for k in range(DIRECTION, MANOEUVRE_SIZE):
            value = manoeuvre[k]
            # A turn in place stays one; an arc that is not there stays away.
            if steps[k] == 0.0 or (value == 0.0 and (k == FIRST_RADIUS or k == LAST_RADIUS)):
                continue
            # Both senses count alike, so that mirror images stay mirror images.
            chosen = value
            for sign in (1.0, -1.0):
                trial = value + sign * scale * steps[k]
                # Straight lines have no sense; one of no length becomes no shorter.
                if trial < 0.0 and (k == DEPARTURE or k == ARRIVAL):
                    trial = least[k]
                if k != DIRECTION and (abs(trial) < least[k] or trial * value < 0.0):
                    trial = math.copysign(least[k], value)
                manoeuvre[k] = trial
                time = evaluate(given, manoeuvre, segments, row[0])
                if time < row[0]:
                    row[0], chosen = time, trial
            manoeuvre[k] = chosen
        scale *= 0.6
