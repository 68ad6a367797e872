"""
Approach paths: the quickest path of the robot to a contact, which ends along the line of a push.

The robot leaves the object, turns by arcs rather than in place, and meets the line of the push
straight, without a stop before the contact. Candidates are candidates, scanned coarsely and
refined, and the path with rotations in place of ``path_planner``.
"""

from collections.abc import Callable, Iterator
import functools
import itertools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import Outline, PushedObject, RoundRobot
from push_navigation.approach.encoding import (
    ANGLE, ApproachProblem, ARRIVAL, ARRIVAL_ANGLE, ARRIVAL_RADIUS, CANDIDATE_SIZE,
    CORNER_SEGMENTS, DEPARTURE, DEPARTURE_ANGLE, DEPARTURE_RADIUS, DIRECTION, FIRST_RADIUS,
    LAST_RADIUS, LENGTH, moved, NO_LENGTH, OTHER_SEGMENTS, REVERSES, SEGMENT_SIZE, THETA, X, Y,
)
from push_navigation.approach.layout import lay_out
from push_navigation.approach.search import refine, scan, SHAPES
from push_navigation.map_clearance import CERTAIN, map_clearance, MapContext, PositionUncertainty
from push_navigation.obstacle import inflate, InflatedObstacle
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import (
    differential_path, holonomic_path, NoPathFound, Path, sample_path, Waypoint,
)
from push_navigation.path_planner import (
    check_goal, check_robot, check_start, finite_pose, MAX_ARC_ANGLE, MAX_DEPARTURE_ANGLE,
    path_with_clearance, with_enough_room,
)
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import LATERAL_FRACTION, travel_time

# Length of the straight line on to the object, at least [m]. Chosen: a path follower with a usual
# lag has settled on the line of the push by then (measured in its tests).
FINAL_STRAIGHT = 0.03
# Speed at the contact, where the caller names none [m/s]. Chosen: that of an ordinary push.
END_SPEED = 0.2
# Length of the straight line off the object, at least [m]. Chosen: far enough to be free of the
# contact, wherever an uncertain contact normal points.
FIRST_STRAIGHT = 0.02
# By this fraction of the clearance arcs at both ends of the path may be nearer to the object: they
# are short, slow, and next to a contact that is meant. Chosen: 18 of 40 mm.
ARC_ALLOWANCE = 0.45
# Radius of arcs that are scanned, as a fraction of the least that can be driven at full speed, and
# the least radius that refinement comes to [m].
RADIUS_FRACTION = 0.5
MIN_RADIUS = 0.08
# Angles of the arcs at departure and arrival that are scanned [rad].
SHUNT_ANGLES = (0.0, 0.5, -0.5, 1.2, -1.2)
# What is added to the least straight lines off and on to the object [m].
EXTRA_STRAIGHTS = (0.0, 0.15)
# Only in less time than this a path that stops may be quicker than the candidates,
# with a holonomic base [s]. Measured: in 2 of 160 such approaches, by 0.05 s; with a differential
# drive in none of 504.
LONG_APPROACH = 3.0
# Directions in which a holonomic base departs, from the outward normal [rad].
HOLONOMIC_DIRECTIONS = (0.0, 0.6, -0.6, 1.2, -1.2)


class Approach(NamedTuple):
    """
    Situation for which an approach is planned, without the map.

    :param robot: the ``RoundRobot``, neither a point nor a flat pusher.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot, at rest.
    :param contact_pose: the robot's centre at the first touch, and the direction of motion there;
        a holonomic base keeps the heading that it has.
    :param settings: ``DriveSettings``.
    :param final_straight: length of the straight line on to the object, at least [m].
    :param end_speed: speed at the contact, 0 where the robot stops there [m/s].
    """

    robot: RoundRobot
    obj: PushedObject
    object_pose: Pose
    start: Pose
    contact_pose: Pose
    settings: DriveSettings
    final_straight: float = FINAL_STRAIGHT
    end_speed: float = END_SPEED

    @property
    def goal(self) -> Pose:
        """Pose of the robot at the contact."""
        if self.robot.drive == 'holonomic':
            return self.contact_pose._replace(theta=self.start.theta)
        return self.contact_pose

    def time(self, path: Path) -> float:
        """Time that a path takes [s]."""
        return travel_time(path, self.robot, self.settings, end_speed=self.end_speed)


def plan_approach(robot: RoundRobot, obj: PushedObject, object_pose: Pose, start: Pose,
                  contact_pose: Pose, settings: DriveSettings, *,
                  occupancy_map: OccupancyMap | None = None,
                  uncertainty: PositionUncertainty = CERTAIN,
                  final_straight: float = FINAL_STRAIGHT, end_speed: float = END_SPEED) -> Path:
    """
    Plan the quickest path to a contact, which ends moving along the line of the push.

    :param robot: the ``RoundRobot``, neither a point nor a flat pusher.
    :param start: ``Pose`` of the robot, at rest.
    :param contact_pose: the robot's centre at the first touch, and the direction of motion there;
        a holonomic base keeps the heading that it has.
    :param occupancy_map: ``OccupancyMap``, or None for free floor all around.
    :param uncertainty: ``PositionUncertainty`` of the robot, for its clearance from obstacles.
    :param final_straight: length of the straight line on to the object, at least [m].
    :param end_speed: speed at the contact, 0 where the robot stops there [m/s].
    :return: ``Path`` up to the contact.
    :raises NoPathFound: where a pose lies inside the object, or obstacles are in the way.
    :raises ValueError: naming what is not finite, or a robot that is not round.
    """
    approach = Approach(robot, obj, *_finite(object_pose, start, contact_pose), settings,
                        final_straight, end_speed)
    return with_enough_room(
        settings, None if occupancy_map is None else MapContext(occupancy_map, uncertainty),
        lambda drive, context: _plan(approach._replace(settings=drive), context))


def _plan(approach: Approach, context: MapContext | None) -> Path:
    is_free = _free_of_obstacles(approach, context)
    for index, (time, segments) in enumerate(_candidates(approach)):
        path = _to_path(approach, segments)
        if is_free(path):
            if index == 0 and not _may_be_slower(approach, time):
                return path
            # What meets obstacles may be replaced by something quicker than this.
            return min((path, *_stopping_paths(approach, context)), key=approach.time)
    return _stopping_path(approach, context)


def approach_time(robot: RoundRobot, obj: PushedObject, object_pose: Pose, start: Pose,
                  contact_pose: Pose, settings: DriveSettings, *,
                  final_straight: float = FINAL_STRAIGHT, end_speed: float = END_SPEED) -> float:
    """
    Compute the time of the path of ``plan_approach`` on open floor, in less time than that takes.

    :param robot: the ``RoundRobot``, neither a point nor a flat pusher.
    :param start: ``Pose`` of the robot, at rest.
    :param contact_pose: as of ``plan_approach``.
    :param final_straight: length of the straight line on to the object, at least [m].
    :param end_speed: speed at the contact, 0 where the robot stops there [m/s].
    :return: time [s].
    :raises NoPathFound: where a pose lies inside the object.
    :raises ValueError: naming what is not finite, or a robot that is not round.
    """
    approach = Approach(robot, obj, *_finite(object_pose, start, contact_pose), settings,
                        final_straight, end_speed)
    time, _ = next(_candidates(approach), (math.inf, None))
    if not _may_be_slower(approach, time):
        return time
    return min([time, *map(approach.time, _stopping_paths(approach, None))])


def _finite(object_pose: Pose, start: Pose, contact_pose: Pose) -> tuple[Pose, Pose, Pose]:
    return (finite_pose('object_pose', object_pose), finite_pose('start', start),
            finite_pose('contact_pose', contact_pose))


def _candidates(approach: Approach) -> Iterator[tuple[float, FloatArray]]:
    """Yield time and segments of candidates that keep clear of the object, quickest first."""
    robot, obj, settings = approach.robot, approach.obj, approach.settings
    check_robot(robot)
    limits = settings.limited_to(robot)
    to_object = approach.object_pose.inverse()
    start, goal = to_object @ approach.start, to_object @ approach.contact_pose
    body = inflate(obj.outline, obj.radius, robot.radius + limits.clearance)
    check_start(robot, body, start, limits.clearance)
    check_goal(body, goal, limits.clearance)
    departures = _departures(robot, body, start, limits)
    if departures is None:
        return
    # Off the object in any case.
    reverse_limit = max(limits.reverse_limit, float(departures[:, DEPARTURE].min()) + NO_LENGTH)
    problem = ApproachProblem(
        _corners(body.core), obj.radius + robot.radius, limits.clearance,
        ARC_ALLOWANCE * limits.clearance, robot.drive == 'holonomic', start.x, start.y,
        robot.drive == 'differential', goal.x, goal.y, goal.theta, limits.speed, limits.yaw_rate,
        limits.acceleration, limits.yaw_acceleration, approach.end_speed, robot.time_constant,
        reverse_limit)
    results = np.zeros((SHAPES + 1, CANDIDATE_SIZE + 2))
    segments = np.zeros((OTHER_SEGMENTS + CORNER_SEGMENTS * len(body.core), SEGMENT_SIZE))
    steps, least = _refinement(robot.drive, approach.final_straight)
    arrivals = _arrivals(limits, robot.drive, approach.final_straight)
    scan(problem, departures, arrivals, results, segments)
    refine(problem, steps, least, results, segments)
    for index in np.argsort(results[:SHAPES, 0], kind='stable').tolist():
        time = float(results[index, 0])
        if not math.isfinite(time):
            break
        count = lay_out(problem, results[index, 1:], segments)
        yield time, segments[:count]


def _departures(robot: RoundRobot, body: InflatedObstacle, start: Pose,
                limits: DriveSettings) -> FloatArray | None:
    """List the starts of candidates, None where none leads off the object."""
    gap, outward = body.nearest(start.x, start.y)
    patterns = _departure_patterns(limits, robot.drive)
    rows = patterns.copy()
    is_clear = gap > -NO_LENGTH
    if robot.drive == 'holonomic':
        rows[:, DIRECTION] += outward
        if not is_clear:
            lengths = {direction: body.ray_exit(start.x, start.y, outward + direction)
                       for direction in HOLONOMIC_DIRECTIONS}
            rows[:, DEPARTURE] += [lengths[direction]
                                   for direction in patterns[:, DIRECTION].tolist()]
        return rows
    rows[:, DIRECTION] = start.theta + math.pi
    if is_clear:
        return rows
    inclination = wrap_angle(outward - start.theta - math.pi)
    if abs(inclination) > MAX_DEPARTURE_ANGLE:
        return None
    rows[:, DEPARTURE] += body.ray_exit(start.x, start.y, start.theta + math.pi)
    return rows


# The drives and settings of a process are few.
@functools.lru_cache(maxsize=16)
def _departure_patterns(limits: DriveSettings, drive: str) -> FloatArray:
    radius = RADIUS_FRACTION * _full_speed_radius(limits, drive)
    directions = HOLONOMIC_DIRECTIONS if drive == 'holonomic' else (0.0,)
    angles = (0.0,) if drive == 'holonomic' else SHUNT_ANGLES
    rows: list[FloatArray] = []
    for direction, length, angle, sense in itertools.product(
            directions, EXTRA_STRAIGHTS, angles, (0.0, 1.0, -1.0)):
        # Behind an arc a turn in place is never the quickest.
        if angle and not sense:
            continue
        row = np.zeros(CANDIDATE_SIZE)
        row[[DIRECTION, DEPARTURE, DEPARTURE_ANGLE, DEPARTURE_RADIUS, FIRST_RADIUS]] = (
            direction, length, angle, radius, sense * radius)
        rows.append(row)
    return np.array(rows)


@functools.lru_cache(maxsize=16)
def _arrivals(limits: DriveSettings, drive: str, final_straight: float) -> FloatArray:
    radius = RADIUS_FRACTION * _full_speed_radius(limits, drive)
    angles = (0.0,) if drive == 'holonomic' else SHUNT_ANGLES
    rows: list[FloatArray] = []
    for angle, length, sense in itertools.product(angles, EXTRA_STRAIGHTS, (0.0, 1.0, -1.0)):
        if angle and not sense:
            continue
        row = np.zeros(CANDIDATE_SIZE)
        straight = max(final_straight, limits.clearance) + length
        row[[LAST_RADIUS, ARRIVAL_ANGLE, ARRIVAL_RADIUS, ARRIVAL]] = (
            sense * radius, angle, radius, straight)
        rows.append(row)
    return np.array(rows)


def _full_speed_radius(limits: DriveSettings, drive: str) -> float:
    """Least radius of an arc that is driven at full speed [m]."""
    lateral = limits.speed ** 2 / (LATERAL_FRACTION * limits.acceleration)
    return lateral if drive == 'holonomic' else max(lateral, limits.speed / limits.yaw_rate)


@functools.lru_cache(maxsize=16)
def _refinement(drive: str, final_straight: float) -> tuple[FloatArray, FloatArray]:
    """First steps of the values of a candidate, and their least magnitudes."""
    steps, least = np.zeros(CANDIDATE_SIZE), np.zeros(CANDIDATE_SIZE)
    steps[[DEPARTURE, ARRIVAL]] = 0.05
    steps[[FIRST_RADIUS, LAST_RADIUS]] = 0.04
    least[[FIRST_RADIUS, LAST_RADIUS, DEPARTURE_RADIUS, ARRIVAL_RADIUS]] = MIN_RADIUS
    least[[DEPARTURE, ARRIVAL]] = FIRST_STRAIGHT, final_straight
    if drive == 'holonomic':
        steps[DIRECTION] = 0.2
    else:
        steps[[DEPARTURE_ANGLE, ARRIVAL_ANGLE]] = 0.3
        steps[[DEPARTURE_RADIUS, ARRIVAL_RADIUS]] = 0.04
    return steps, least


@functools.lru_cache(maxsize=64)
def _corners(core: Outline) -> FloatArray:
    return np.array(core, dtype=float)


def _to_path(approach: Approach, segments: FloatArray) -> Path:
    """Make a path in the world of the segments of a candidate."""
    waypoints: list[Waypoint] = []
    backwards: list[bool] = []
    for row in segments.tolist():
        if row[LENGTH] == 0.0:
            continue
        count = max(1, math.ceil(abs(row[ANGLE]) / MAX_ARC_ANGLE))
        for i in range(count):
            part = (i + 1) / count
            x, y, _ = moved((row[X], row[Y], row[THETA]), part * row[LENGTH],
                            part * row[ANGLE])
            waypoints.append(Waypoint(*approach.object_pose.transform((x, y)),
                                      row[ANGLE] / count))
            backwards.append(row[REVERSES] > 0.0)
    if approach.robot.drive == 'holonomic':
        return holonomic_path(approach.start, approach.goal, waypoints)
    return differential_path(approach.start, approach.goal, waypoints, backwards)


def _stopping_path(approach: Approach, context: MapContext | None) -> Path:
    """Plan a path that stops before the contact, and goes straight on to it."""
    goal, direction = approach.goal, approach.contact_pose.theta
    distance = approach.settings.standoff
    standoff = goal._replace(x=goal.x - distance * math.cos(direction),
                             y=goal.y - distance * math.sin(direction))
    path = path_with_clearance(approach.robot, approach.obj, approach.object_pose, approach.start,
                               standoff, approach.settings, context=context)
    return Path((*path.poses, goal), (*path.arc_angles, 0.0))


def _stopping_paths(approach: Approach, context: MapContext | None) -> list[Path]:
    """List the path that stops before the contact, if there is one."""
    try:
        return [_stopping_path(approach, context)]
    except NoPathFound:
        return []


def _may_be_slower(approach: Approach, time: float) -> bool:
    """
    Tell whether a path that stops before the contact may be quicker than a candidate.

    :param time: of the candidate [s].
    """
    is_short = approach.robot.drive == 'holonomic' and time < LONG_APPROACH
    return is_short or not math.isfinite(time)


def _free_of_obstacles(approach: Approach, context: MapContext | None) -> Callable[[Path], bool]:
    """Return the test whether a path keeps clear of the obstacles of a map."""
    if context is None:
        return lambda path: True
    robot, spacing = approach.robot, context.occupancy_map.resolution
    margins = map_clearance(robot, approach.start, approach.goal, approach.settings, context)
    return lambda path: margins.is_free(sample_path(path, robot, spacing))
