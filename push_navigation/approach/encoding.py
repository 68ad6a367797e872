"""Approach candidates and their segments as compiled code encodes them: rows of values."""

import math
from typing import Any, NamedTuple

from push_dynamics.compiled import compiled

# Values of a candidate.
GEAR = 0                # between departure and arrival: 1 forwards, -1 backwards
SIDE = 1                # of the detour round the object: 1 counter-clockwise, -1, or 0 for none
DIRECTION = 2           # of motion at the beginning [rad]
DEPARTURE = 3           # length of the first straight line [m]
DEPARTURE_ANGLE = 4     # of the arc behind it, positive to the left [rad]
DEPARTURE_RADIUS = 5    # of that arc [m]
FIRST_RADIUS = 6        # of the first curve, signed [m]
LAST_RADIUS = 7         # of the last curve, signed [m]
ARRIVAL_ANGLE = 8       # of the arc before the last straight line [rad]
ARRIVAL_RADIUS = 9      # of that arc [m]
ARRIVAL = 10            # length of the last straight line [m]
CANDIDATE_SIZE = 11

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
# Segments of a candidate but for those of its detour round corners, at most, and segments of a
# detour for each corner: an arc and an edge. The first is above what any shape has.
OTHER_SEGMENTS = 32
CORNER_SEGMENTS = 2

# Kinds of segments, which differ in the distance that they keep from the object.
LEADS_OFF, CURVES, KEEPS_OFF, DETOURS, LEADS_ON = 0, 1, 2, 3, 4

# Rounding of an arc that has no length [rad].
NO_ANGLE = 1e-7
# Rounding of lengths, and of distances from the object [m].
NO_LENGTH = 1e-7


class ApproachProblem(NamedTuple):
    """
    Situation for which candidates are laid out.

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


@compiled
def append(segments: Any, count: int, kind: int, start: tuple[float, float, float],
           extent: tuple[float, float], reverses: float) -> int:
    """
    Append a segment, unless it has neither length nor angle.

    :param segments: shape (s, SEGMENT_SIZE), changed.
    :param count: of segments so far.
    :param kind: of the segment.
    :param start: (x, y, direction of motion) where it begins.
    :param extent: (length, 0 for a turn in place [m]; change of the direction [rad]).
    :param reverses: 1 where a differential drive moves backwards, else 0.
    :return: count of segments now.
    """
    length, angle = extent
    if length < NO_LENGTH and abs(angle) < NO_ANGLE:
        return count
    row = segments[count]
    row[X], row[Y], row[THETA] = start
    row[LENGTH], row[ANGLE], row[REVERSES], row[KIND] = length, angle, reverses, kind
    return count + 1


@compiled
def moved(start: tuple[float, float, float], length: float,
          angle: float) -> tuple[float, float, float]:
    """
    Move along an arc.

    :param start: (x, y, direction of motion) at its beginning.
    :param length: [m].
    :param angle: change of the direction [rad].
    :return: the same at its end.
    """
    half = 0.5 * angle
    chord = length * math.sin(half) / half if abs(half) > 1e-8 else length
    return (start[0] + chord * math.cos(start[2] + half),
            start[1] + chord * math.sin(start[2] + half), start[2] + angle)
