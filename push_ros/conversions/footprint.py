"""Footprint: outline of the robot, and of the object that it pushes."""

import math

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point32, PolygonStamped
from push_model.geometry import convex_hull, Coordinates, Pose
from push_model.parameters import PushedObject, RoundRobot

# Vertices that stand for a circle; those of its polygon lie outside by 2 % of the radius at most.
CIRCLE_VERTICES = 16


def robot_footprint(robot: RoundRobot) -> list[tuple[float, float]]:
    """
    Outline a robot.

    :return: vertices in the frame of the robot, counter-clockwise, around its disc [m].
    """
    return convex_hull(_circle(robot.radius))


def pushing_footprint(robot: RoundRobot, obj: PushedObject, robot_pose: Pose,
                      object_pose: Pose) -> list[tuple[float, float]]:
    """
    Outline a robot with the object that it pushes.

    :param robot_pose: ``Pose`` of the robot in the world.
    :param object_pose: ``Pose`` of the object in the world.
    :return: vertices in the frame of the robot, counter-clockwise, around both [m].
    """
    in_robot = robot_pose.inverse() @ object_pose
    outline: list[Coordinates] = [*(obj.outline or _circle(obj.radius))]
    return convex_hull([*_circle(robot.radius), *map(in_robot.transform, outline)])


def grown_outline(obj: PushedObject, margin: float) -> list[tuple[float, float]]:
    """
    Outline an object with a strip around it: its Minkowski sum with a disc.

    :param margin: width of the strip, which is up to 2 % wider at rounded corners [m].
    :return: vertices in the frame of the object, counter-clockwise [m].
    """
    outline = obj.outline or _circle(obj.radius)
    strip = _circle(margin) if margin else [(0.0, 0.0)]
    return convex_hull([(x + dx, y + dy) for x, y in outline for dx, dy in strip])


def to_footprint_message(vertices: list[tuple[float, float]], stamp: Time,
                         frame: str) -> PolygonStamped:
    """
    Convert a footprint to a message.

    :param vertices: (x, y) each [m].
    :param stamp: ``builtin_interfaces/Time``.
    :param frame: id of the robot's frame.
    """
    message = PolygonStamped()
    message.header.stamp, message.header.frame_id = stamp, frame
    message.polygon.points = [Point32(x=x, y=y, z=0.0) for x, y in vertices]
    return message


def _circle(radius: float) -> list[Coordinates]:
    """Make the polygon around a circle; that of a flat pusher is a point."""
    if not math.isfinite(radius):
        return [(0.0, 0.0)]
    outside = radius / math.cos(math.pi / CIRCLE_VERTICES)
    angles = [2.0 * math.pi / CIRCLE_VERTICES * index for index in range(CIRCLE_VERTICES)]
    return [(outside * math.cos(angle), outside * math.sin(angle)) for angle in angles]
