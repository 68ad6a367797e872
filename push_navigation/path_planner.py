"""The quickest way of the robot round the object."""

import math

from push_model.geometry import Pose
from push_navigation.grid_planner import grid_waypoints
from push_navigation.obstacle import inflate
from push_navigation.path import sample_path, travel_time
from push_navigation.path_ends import (
    assemble_paths, departure_from_goal, departure_from_start, NoPathFound,
)

LONGEST_ARC = 2.0


def waypoints_around_object(body, start, goal):
    """
    Find the shortest tracks past the object: the straight one, or those to either side of it.

    :param body: ``InflatedObstacle``.
    :param start: (x, y), not inside [m].
    :param goal: the same.
    :return: list of tracks, each a list of (x, y, bend of the leg that leads there [rad]) without
        the start.
    """
    ahead = math.atan2(goal[1] - start[1], goal[0] - start[0])
    here, there = body.cone(*start), body.cone(*goal)
    if not (here.occludes(ahead) and there.occludes(ahead + math.pi)):
        return [[(*goal, 0.0)]]
    count = len(body.core)
    found = []
    for side, first, last, begin, end in (
            (1.0, here.right_index, there.left_index, here.right, there.left),
            (-1.0, here.left_index, there.right_index, here.left, there.right)):
        step = int(side)
        numbers = [(first + step * i) % count for i in range((step * (last - first)) % count + 1)]
        angles = [begin, *(_face(body.core, *pair) for pair in zip(numbers, numbers[1:])),
                  end + math.pi]
        found.append(_wound(body, side, numbers, angles, goal))
    return found


def _face(core, number, following):
    (x0, y0), (x1, y1) = core[number], core[following]
    return math.atan2(y1 - y0, x1 - x0)


def _wound(body, side, numbers, angles, goal):
    waypoints = []

    def touch(number, angle):
        x, y = body.core[number]
        return (x + side * body.radius * math.sin(angle),
                y - side * body.radius * math.cos(angle))

    for number, before, after in zip(numbers, angles, angles[1:]):
        arc_angle = (side * (after - before) + 1e-6) % (2.0 * math.pi) - 1e-6
        waypoints.append((*touch(number, before), 0.0))
        pieces = max(1, math.ceil(arc_angle / LONGEST_ARC))
        for i in range(pieces):
            share = (i + 1) / pieces
            waypoints.append((*touch(number, before + side * share * arc_angle), side * arc_angle / pieces))
    return [*waypoints, (*goal, 0.0)]


def plan_path(robot, obj, object_pose, start, goal, settings, occupancy_map=None):
    """
    Find the quickest way to a pose that keeps clear of the object, and of obstacles.

    Where start or goal is nearer to the object than the clearance, the way leads straight off:
    along the heading of a differential drive if that leads off well, or else along the normal.
    A robot that starts nearer to an obstacle than the clearance keeps what it has.

    :param robot: the ``RoundRobot``, neither a point nor a fence.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot.
    :param goal: ``Pose`` of the robot.
    :param settings: ``DriveSettings``.
    :param occupancy_map: ``OccupancyMap``, or None for free floor all around.
    :return: ``Path``.
    :raises NoWay: where a pose lies inside the object, or obstacles are in the way.
    :raises ValueError: naming what is not finite, or a robot that is not round.
    """
    if not 0.0 < robot.radius < math.inf:
        raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot, neither '
                         'a point nor a fence')
    object_pose, start, goal = (_finite(name, pose) for name, pose in (
        ('object_pose', object_pose), ('start', start), ('goal', goal)))
    body = inflate(obj.outline, obj.radius, robot.radius + settings.clearance)
    inside = object_pose.inverse()
    off = departure_from_start(robot, body, inside @ start, settings.clearance)
    on = departure_from_goal(robot, body, inside @ goal, settings.clearance)

    found = waypoints_around_object(body, off.place, on.place)
    off, on = (end._replace(place=object_pose.transform(end.place)) for end in (off, on))
    ways = []
    for waypoints in found:
        waypoints = [(*object_pose.transform((x, y)), arc_angle) for x, y, arc_angle in waypoints]
        ways += assemble_paths(robot, start, goal, off, on, waypoints, settings.max_reverse_distance)
    if occupancy_map is not None:
        margin = _margin(robot, start, goal, settings, occupancy_map)
        ways = [way for way in ways if occupancy_map.robot_is_free(
            robot, sample_path(way, robot, occupancy_map.resolution), margin)]
        if not ways:
            waypoints = grid_waypoints(occupancy_map, robot.radius + margin, body, object_pose, off.place,
                                       on.place)
            ways = assemble_paths(robot, start, goal, off, on, waypoints, settings.max_reverse_distance)
    return min(ways, key=lambda way: travel_time(way, robot, settings))


def _margin(robot, start, goal, settings, occupancy_map):
    here, there = occupancy_map.clearance([start[:2], goal[:2]]) - robot.radius
    if here < 0.0:
        raise NoPathFound(f'the robot at {start.x:.2f} m, {start.y:.2f} m stands in an obstacle of the '
                          'map, or too near to one')
    margin = min(settings.map_clearance, here)
    if there < margin:
        raise NoPathFound(f'the goal of the way, {goal.x:.2f} m, {goal.y:.2f} m, is too near to an '
                          'obstacle of the map')
    return margin


def _finite(name, pose):
    pose = Pose(*pose)
    if not pose.is_finite():
        raise ValueError(f'{name}: got {tuple(pose)}, expected finite numbers')
    return pose
