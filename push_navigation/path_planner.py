"""
Path planner: the quickest path of the robot round the object, and through a map.

At the object a path is straight: it departs to the clearance, or arrives from there. Between the
two it follows the inflated outline of the object, on either side, or a grid among the obstacles of
a map.
"""

from collections.abc import Callable, Iterator, Sequence
import math
from typing import NamedTuple

from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.grid_planner import grid_waypoints
from push_navigation.map_clearance import (
    CERTAIN, map_clearance, MapClearance, MapContext, PositionUncertainty,
)
from push_navigation.obstacle import inflate, InflatedObstacle
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import (
    differential_path, holonomic_path, NoPathFound, Path, PathFailure, sample_path, Waypoint,
)
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time

# Arcs round a corner are cut into segments of at most this angle [rad]. Chosen: well below the
# full circle at which the chord of a segment vanishes.
MAX_ARC_ANGLE = 2.0
# A differential drive leaves the object along its heading where that is within this angle of the
# normal. Chosen: at 75 degrees it already moves four times the clearance to get clear.
MAX_DEPARTURE_ANGLE = math.radians(75.0)
# Parts of the clearances that a path keeps, and standard deviations of the place; the later
# ones where there is no room for more. Chosen: 2 of the usual 5 cm from obstacles are twice the
# error with which a path is followed; of robots that drift, one in eight at most would touch.
CLEARANCE_STEPS = ((1.0, 2.0), (0.6, 1.5), (0.4, 1.5))
# The goal of a path may overlap the object by this much: contact, give or take a few millimetres
# of localization [m]. Chosen.
CONTACT_TOLERANCE = 0.005
# Clearance that a path along a grid may lack between places where it was looked at [m]; chosen.
GRID_SLACK = 1e-3
# Rounding of positions on the surface of the inflated object [m].
SURFACE_TOLERANCE = 1e-7


class Departure(NamedTuple):
    """
    Straight segment that leads off the object, or on to it the other way round.

    :param end: its end (x, y) at the clearance, or the robot's position if that is as far away.
    :param is_needed: whether there is such a segment.
    :param is_backwards: whether the robot leaves backwards.
    """

    end: tuple[float, float]
    is_needed: bool
    is_backwards: bool


class PathEnds(NamedTuple):
    """
    Both ends of a path, in one frame.

    :param start: ``Pose`` of the robot.
    :param goal: ``Pose`` of the robot.
    :param departure: ``Departure`` from the start.
    :param arrival: ``Departure`` from the goal, along which the robot arrives.
    """

    start: Pose
    goal: Pose
    departure: Departure
    arrival: Departure


def plan_path(robot: RoundRobot, obj: PushedObject, object_pose: Pose, start: Pose, goal: Pose,
              settings: DriveSettings, *, occupancy_map: OccupancyMap | None = None,
              uncertainty: PositionUncertainty = CERTAIN) -> Path:
    """
    Plan the quickest path to a pose that keeps clear of the object, and of obstacles.

    Where start or goal is nearer to the object than the clearance, the path is straight there:
    along the heading of a differential drive if that leads off well, or else along the normal.
    A robot that starts nearer to an obstacle than the clearance keeps the distance that it has.
    Where a map has no room for the clearances, they are reduced.

    :param robot: the ``RoundRobot``, neither a point nor a flat pusher.
    :param occupancy_map: ``OccupancyMap``, or None for free floor all around.
    :param uncertainty: ``PositionUncertainty`` of the robot, for its clearance from obstacles.
    :raises NoPathFound: where a pose lies inside the object, or obstacles are in the way.
    :raises ValueError: naming what is not finite, or a robot that is not round.
    """
    check_robot(robot)
    object_pose, start, goal = (finite_pose(name, pose) for name, pose in (
        ('object_pose', object_pose), ('start', start), ('goal', goal)))
    return with_enough_room(
        settings, None if occupancy_map is None else MapContext(occupancy_map, uncertainty),
        lambda drive, context: path_with_clearance(robot, obj, object_pose, start, goal, drive,
                                                   context=context))


def with_enough_room(settings: DriveSettings, context: MapContext | None,
                     plan: Callable[[DriveSettings, MapContext | None], Path]) -> Path:
    """
    Plan a path with the clearances of the settings, or with less where a map has no room for them.

    :param context: ``MapContext``, or None for free floor all around.
    :param plan: plans the path with ``DriveSettings`` in a ``MapContext``, or raises
        ``NoPathFound``.
    :raises NoPathFound: as with the clearances of the settings.
    """
    if context is None:
        return plan(settings, None)
    first_failure: NoPathFound | None = None
    for fraction, sigmas in CLEARANCE_STEPS:
        try:
            return plan(settings.with_clearances(fraction), context._replace(sigmas=sigmas))
        except NoPathFound as failure:
            first_failure = first_failure or failure
    raise first_failure or NoPathFound(PathFailure.NO_CLEARANCE.report())


def path_with_clearance(robot: RoundRobot, obj: PushedObject, object_pose: Pose, start: Pose,
                        goal: Pose, settings: DriveSettings, *,
                        context: MapContext | None = None) -> Path:
    """
    Plan the same path, with the clearances of the settings.

    :param object_pose: ``Pose`` of the object, finite.
    :param start: ``Pose`` of the robot, finite.
    :param goal: ``Pose`` of the robot, finite.
    :param context: ``MapContext``, or None for free floor all around.
    :raises NoPathFound: where a pose lies inside the object, or obstacles are in the way.
    """
    body = inflate(obj.outline, obj.radius, robot.radius + settings.clearance)
    to_object = object_pose.inverse()
    departure = departure_from_start(robot, body, to_object @ start, settings.clearance)
    arrival = departure_from_goal(robot, body, to_object @ goal, settings.clearance)

    routes = waypoints_around_object(body, departure.end, arrival.end)
    ends = PathEnds(start, goal,
                    departure._replace(end=object_pose.transform(departure.end)),
                    arrival._replace(end=object_pose.transform(arrival.end)))
    reversing = min(settings.max_reverse_distance, settings.reverse_limit)
    paths: list[Path] = []
    for route in routes:
        waypoints = [Waypoint(*object_pose.transform((x, y)), arc_angle)
                     for x, y, arc_angle in route]
        paths += assemble_paths(robot, ends, waypoints, reversing)
    if context is not None:
        margins = map_clearance(robot, start, goal, settings, context)
        spacing = context.occupancy_map.resolution
        paths = [path for path in paths if margins.is_free(sample_path(path, robot, spacing))]
        if not paths:
            paths = [path for waypoints in _grid_routes(margins, body, object_pose, ends)
                     for path in assemble_paths(robot, ends, waypoints, reversing)
                     if margins.is_free(sample_path(path, robot, spacing), GRID_SLACK)]
        if not paths:
            raise NoPathFound(PathFailure.ROBOT_TOO_UNCERTAIN.report())
    return min(paths, key=lambda path: travel_time(path, robot, settings))


def _grid_routes(margins: MapClearance, body: InflatedObstacle, object_pose: Pose,
                 ends: PathEnds) -> Iterator[list[Waypoint]]:
    """
    Generate routes on a grid: one that is free wherever the robot drifts, or may be.

    :raises NoPathFound: where there is none at all.
    """
    try:
        yield grid_waypoints(margins, body, object_pose, ends.departure.end, ends.arrival.end)
    except NoPathFound:
        if margins.context.uncertainty.drift == 0.0:
            raise
        yield grid_waypoints(margins._replace(counts_drift=False), body, object_pose,
                             ends.departure.end, ends.arrival.end)


def check_robot(robot: RoundRobot) -> None:
    """
    Check that a robot is round.

    :raises ValueError: where it is a point or a flat pusher.
    """
    if not 0.0 < robot.radius < math.inf:
        raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot, neither '
                         'a point nor a flat pusher')


def waypoints_around_object(body: InflatedObstacle, start: tuple[float, float],
                            goal: tuple[float, float]) -> list[list[Waypoint]]:
    """
    Find the shortest routes past the object: the straight one, or those to either side of it.

    :param start: (x, y), not inside [m].
    :param goal: (x, y), not inside [m].
    :return: list of routes, each a list of ``Waypoint`` without the start.
    """
    bearing = math.atan2(goal[1] - start[1], goal[0] - start[0])
    here, there = body.cone(*start), body.cone(*goal)
    if not (here.occludes(bearing) and there.occludes(bearing + math.pi)):
        return [[Waypoint(*goal)]]
    count = len(body.core)
    routes: list[list[Waypoint]] = []
    for side, first, last, initial, final in (
            (1, here.right_index, there.left_index, here.right, there.left),
            (-1, here.left_index, there.right_index, here.left, there.right)):
        vertices = [(first + side * i) % count for i in range((side * (last - first)) % count + 1)]
        # Directions of motion: into the first corner, along the edges, out of the last corner.
        directions = [initial, *(_edge_direction(body.core, *pair)
                                 for pair in zip(vertices, vertices[1:])), final + math.pi]
        routes.append([*_wound_round(body, float(side), vertices, directions), Waypoint(*goal)])
    return routes


def _edge_direction(core: Sequence[tuple[float, float]], index: int, following: int) -> float:
    (x0, y0), (x1, y1) = core[index], core[following]
    return math.atan2(y1 - y0, x1 - x0)


def _wound_round(body: InflatedObstacle, side: float, vertices: Sequence[int],
                 directions: Sequence[float]) -> list[Waypoint]:
    """
    Find the tangent points of a route round corners, with the arcs between them.

    :param side: 1 counter-clockwise round the object, -1 clockwise.
    :param vertices: numbers of the corners.
    :param directions: of motion before each corner and after the last [rad].
    """
    waypoints: list[Waypoint] = []

    def tangent_point(vertex: int, direction: float) -> tuple[float, float]:
        x, y = body.core[vertex]
        return (x + side * body.radius * math.sin(direction),
                y - side * body.radius * math.cos(direction))

    for vertex, before, after in zip(vertices, directions, directions[1:]):
        # An angle that is negative by rounding is 0, not a full circle.
        arc_angle = (side * (after - before) + 1e-6) % (2.0 * math.pi) - 1e-6
        waypoints.append(Waypoint(*tangent_point(vertex, before)))
        count = max(1, math.ceil(arc_angle / MAX_ARC_ANGLE))
        for i in range(count):
            direction = before + side * ((i + 1) / count) * arc_angle
            waypoints.append(Waypoint(*tangent_point(vertex, direction),
                                      side * arc_angle / count))
    return waypoints


def departure_from_start(robot: RoundRobot, body: InflatedObstacle, pose: Pose,
                         clearance: float) -> Departure:
    """
    Find the straight segment off the object from the robot's pose.

    :param body: ``InflatedObstacle``, inflated by the robot's radius and the clearance.
    :param pose: ``Pose`` of the robot in the object frame.
    :param clearance: distance from the object at which the segment ends [m].
    :return: ``Departure``, in the object frame.
    :raises NoPathFound: where the robot's centre is inside the object.
    """
    check_start(robot, body, pose, clearance)
    return _departure(robot, body, pose)


def departure_from_goal(robot: RoundRobot, body: InflatedObstacle, pose: Pose,
                        clearance: float) -> Departure:
    """
    Find the straight segment off the object from the goal; the robot arrives along it.

    :param body: ``InflatedObstacle``, inflated by the robot's radius and the clearance.
    :param pose: goal ``Pose`` in the object frame.
    :param clearance: distance from the object at which the segment ends [m].
    :return: ``Departure``, in the object frame.
    :raises NoPathFound: where the robot would overlap the object.
    """
    check_goal(body, pose, clearance)
    return _departure(robot, body, pose)


def check_start(robot: RoundRobot, body: InflatedObstacle, pose: Pose, clearance: float) -> None:
    """
    Check that a path can start at a pose.

    :param body: ``InflatedObstacle``, inflated by the robot's radius and the clearance.
    :param pose: ``Pose`` of the robot in the object frame.
    :param clearance: by which it is inflated [m].
    :raises NoPathFound: where the robot's centre is inside the object.
    """
    overlap = _overlap(body, pose, clearance)
    if overlap > robot.radius:
        raise NoPathFound(PathFailure.START_IN_OBJECT.report(overlap=overlap))


def check_goal(body: InflatedObstacle, pose: Pose, clearance: float) -> None:
    """
    Check that a path can end at a pose.

    :param body: ``InflatedObstacle``, inflated by the robot's radius and the clearance.
    :param pose: ``Pose`` of the robot in the object frame.
    :param clearance: by which it is inflated [m].
    :raises NoPathFound: where the robot would overlap the object.
    """
    overlap = _overlap(body, pose, clearance)
    if overlap > CONTACT_TOLERANCE:
        raise NoPathFound(PathFailure.GOAL_IN_OBJECT.report(overlap=overlap))


def _overlap(body: InflatedObstacle, pose: Pose, clearance: float) -> float:
    gap, _ = body.nearest(pose.x, pose.y)
    return -gap - clearance


def _departure(robot: RoundRobot, body: InflatedObstacle, pose: Pose) -> Departure:
    gap, outward = body.nearest(pose.x, pose.y)
    if gap > -SURFACE_TOLERANCE:
        return Departure((pose.x, pose.y), False, False)
    is_backwards = abs(wrap_angle(outward - pose.theta)) > 0.5 * math.pi
    along = pose.theta + (math.pi if is_backwards else 0.0)
    if robot.drive == 'differential' and abs(wrap_angle(outward - along)) <= MAX_DEPARTURE_ANGLE:
        outward = along
    length = body.ray_exit(pose.x, pose.y, outward)
    end = pose.x + length * math.cos(outward), pose.y + length * math.sin(outward)
    return Departure(end, True, is_backwards)


def assemble_paths(robot: RoundRobot, ends: PathEnds, waypoints: Sequence[Waypoint],
                   max_reverse_distance: float) -> list[Path]:
    """
    Join departure, waypoints and arrival: forwards, and backwards too where that is short.

    :param waypoints: from behind the end of the departure to the start of the arrival.
    :param max_reverse_distance: longest path on which a differential drive moves backwards [m].
    :return: list of ``Path``.
    """
    start, goal, departure, arrival = ends
    joined = list(waypoints)
    if departure.is_needed:
        joined.insert(0, Waypoint(*departure.end))
    if arrival.is_needed:
        joined.append(Waypoint(goal.x, goal.y))
    if robot.drive == 'holonomic':
        keeps_heading = departure.is_needed, arrival.is_needed
        return [holonomic_path(start, goal, joined, keeps_heading)]
    paths: list[Path] = []
    for is_backwards in (False, True):
        backwards = [is_backwards] * len(waypoints)
        if departure.is_needed:
            backwards.insert(0, departure.is_backwards)
        if arrival.is_needed:
            backwards.append(not arrival.is_backwards)
        paths.append(differential_path(start, goal, joined, backwards))
    forwards, reversing = paths
    return paths if reversing.length <= max_reverse_distance else [forwards]


def finite_pose(name: str, pose: Pose) -> Pose:
    """
    Return a pose, of which all numbers are finite.

    :param name: of the pose, for the message.
    :raises ValueError: where one is not.
    """
    pose = Pose(*pose)
    if not pose.is_finite():
        raise ValueError(f'{name}: got {tuple(pose)}, expected finite numbers')
    return pose
