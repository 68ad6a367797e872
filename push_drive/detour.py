"""The quickest way of the robot round the object."""

import math

from push_drive.inflated import inflated
from push_drive.round_object import tracks
from push_drive.way import driven_way, sampled, travel_time, turned_way
from push_model.geometry import Pose, wrap_angle

SLANT = math.radians(60.0)
TOUCHING = 0.005
REACHED = 1e-7


class NoWay(ValueError):
    """
    There is no way, and why.

    :param reason: why, one phrase.
    """

    def __init__(self, reason):
        super().__init__(reason)
        self.reason = reason


def find_way(robot, obj, object_pose, start, goal, settings, workspace=None):
    """
    Find the quickest way to a pose that keeps clear of the object.

    Where start or goal is nearer to the object than the clearance, the way leads straight off:
    along the heading of a differential drive if that leads off well, or else along the normal.

    :param robot: the ``RoundRobot``, neither a point nor a fence.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot.
    :param goal: ``Pose`` of the robot.
    :param settings: ``DriveSettings``.
    :param workspace: ``Workspace``, or None for free floor all around.
    :return: ``Way``.
    :raises NoWay: where a pose lies inside the object.
    :raises ValueError: naming what is not finite, or a robot that is not round.
    """
    if not 0.0 < robot.radius < math.inf:
        raise ValueError(f'robot.radius: got {robot.radius:g} m, expected a round robot, neither '
                         'a point nor a fence')
    object_pose, start, goal = (_finite(name, pose) for name, pose in (
        ('object_pose', object_pose), ('start', start), ('goal', goal)))
    ways = candidates(robot, obj, object_pose, start, goal, settings)
    if workspace is not None:
        ways = [way for way in ways if workspace.robot_is_free(
            robot, sampled(way, robot, workspace.resolution), settings.map_clearance)]
    if not ways:
        raise NoWay('obstacles of the map are in the way')
    return min(ways, key=lambda way: travel_time(way, robot, settings))


def candidates(robot, obj, object_pose, start, goal, settings):
    """
    List the ways among which the quickest is: to either side, forwards and backwards.

    :param robot: the ``RoundRobot``.
    :param obj: the ``PushedObject``.
    :param object_pose: ``Pose`` of the object.
    :param start: ``Pose`` of the robot.
    :param goal: ``Pose`` of the robot.
    :param settings: ``DriveSettings``.
    :return: list of ``Way``.
    :raises NoWay: where a pose lies inside the object.
    """
    body = inflated(obj.outline, obj.radius, robot.radius + settings.clearance)
    inside = object_pose.inverse()
    here, there = inside @ start, inside @ goal
    off = _way_off(robot, body, here, settings, 'start')
    on = _way_off(robot, body, there, settings, 'goal')
    found = []
    for track in tracks(body, off[:2] if off else here[:2], on[:2] if on else there[:2]):
        legs = ([(*off[:2], 0.0)] if off else []) + track + ([(*there[:2], 0.0)] if on else [])
        legs = [(*object_pose.transform((x, y)), bend) for x, y, bend in legs]
        if robot.drive == 'holonomic':
            found.append(turned_way(start, goal, legs, (bool(off), bool(on))))
            continue
        for back in (False, True):
            flags = [back] * len(track)
            flags = ([off[2]] if off else []) + flags + ([not on[2]] if on else [])
            way = driven_way(start, goal, legs, flags)
            if not back or way.length <= settings.reverse:
                found.append(way)
    return found


def _way_off(robot, body, pose, settings, name):
    gap, outward = body.nearest(pose.x, pose.y)
    if gap > -REACHED:
        return None
    overlap = -gap - settings.clearance
    if overlap > (robot.radius if name == 'start' else TOUCHING):
        raise NoWay(f'the {name} of the way lies {overlap:.3f} m inside the object')
    aslant = wrap_angle(outward - pose.theta)
    backwards = abs(aslant) > 0.5 * math.pi
    if robot.drive == 'differential':
        along = pose.theta + math.pi * backwards
        if abs(wrap_angle(outward - along)) <= SLANT:
            outward = along
    way = body.exit(pose.x, pose.y, outward)
    return (pose.x + way * math.cos(outward), pose.y + way * math.sin(outward), backwards)


def _finite(name, pose):
    pose = Pose(*pose)
    if not pose.is_finite():
        raise ValueError(f'{name}: got {tuple(pose)}, expected finite numbers')
    return pose
