"""The quickest way of the robot round the object."""

import math

from push_drive.ends import joined, NoWay, off_goal, off_start
from push_drive.grid_way import grid_track
from push_drive.inflated import inflated
from push_drive.round_object import tracks
from push_drive.way import sampled, travel_time
from push_model.geometry import Pose


def find_way(robot, obj, object_pose, start, goal, settings, workspace=None):
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
    :param workspace: ``Workspace``, or None for free floor all around.
    :return: ``Way``.
    :raises NoWay: where a pose lies inside the object, or obstacles are in the way.
    :raises ValueError: naming what is not finite, or a robot that is not round.
    """
    if not 0.0 < robot.radius < math.inf:
        raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot, neither '
                         'a point nor a fence')
    object_pose, start, goal = (_finite(name, pose) for name, pose in (
        ('object_pose', object_pose), ('start', start), ('goal', goal)))
    body = inflated(obj.outline, obj.radius, robot.radius + settings.clearance)
    inside = object_pose.inverse()
    off = off_start(robot, body, inside @ start, settings.clearance)
    on = off_goal(robot, body, inside @ goal, settings.clearance)

    found = tracks(body, off.place, on.place)
    off, on = (end._replace(place=object_pose.transform(end.place)) for end in (off, on))
    ways = []
    for track in found:
        track = [(*object_pose.transform((x, y)), bend) for x, y, bend in track]
        ways += joined(robot, start, goal, off, on, track, settings.reverse)
    if workspace is not None:
        margin = _margin(robot, start, goal, settings, workspace)
        ways = [way for way in ways if workspace.robot_is_free(
            robot, sampled(way, robot, workspace.resolution), margin)]
        if not ways:
            track = grid_track(workspace, robot.radius + margin, body, object_pose, off.place,
                               on.place)
            ways = joined(robot, start, goal, off, on, track, settings.reverse)
    return min(ways, key=lambda way: travel_time(way, robot, settings))


def _margin(robot, start, goal, settings, workspace):
    here, there = workspace.clearance([start[:2], goal[:2]]) - robot.radius
    if here < 0.0:
        raise NoWay(f'the robot at {start.x:.2f} m, {start.y:.2f} m stands in an obstacle of the '
                    'map, or too near to one')
    margin = min(settings.map_clearance, here)
    if there < margin:
        raise NoWay(f'the goal of the way, {goal.x:.2f} m, {goal.y:.2f} m, is too near to an '
                    'obstacle of the map')
    return margin


def _finite(name, pose):
    pose = Pose(*pose)
    if not pose.is_finite():
        raise ValueError(f'{name}: got {tuple(pose)}, expected finite numbers')
    return pose
