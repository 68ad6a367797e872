"""Markers for RViz and Foxglove: object, robot, supports, contact, friction cone, plan."""

import math

from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point
from push_model.contact import contact_point, find_contact
from push_model.geometry import Pose
from push_ros.conversions.primitives import to_pose_message
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

BROWN, GREEN, GREY = (0.72, 0.53, 0.31), (0.2, 0.65, 0.35), (0.35, 0.35, 0.4)
BLUE, RED, ORANGE = (0.15, 0.45, 0.85), (0.85, 0.2, 0.2), (0.95, 0.6, 0.1)
ORIGIN = Pose(0.0, 0.0, 0.0)
LINE, HEIGHT, ARROW, FENCE, ABOVE = 0.01, 0.1, 0.25, 2.0, 0.3
SHORT = Duration(sec=1)


def scene_markers(stamp, frame, namespace, obj, robot, object_pose, robot_pose, colour=BROWN):
    """
    Draw object, supports, robot and their contact.

    :param stamp: of the markers.
    :param frame: id of the world frame.
    :param namespace: of the markers.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param object_pose: ``Pose`` of the object.
    :param robot_pose: ``Pose`` of the robot.
    :param colour: of the object, (r, g, b).
    :return: ``MarkerArray``.
    """
    def marker(name, *arguments):
        return _marker(stamp, frame, f'{namespace}/{name}', *arguments)

    outline = marker('object', Marker.LINE_STRIP, object_pose, (LINE, 0.0, 0.0), colour)
    outline.points = [_point(p) for p in _outline(obj)]
    supports = marker('supports', Marker.SPHERE_LIST, object_pose, (0.03, 0.03, 0.03), GREY)
    supports.points = [_point((foot.x, foot.y)) for foot in obj.supports]
    body = marker('robot', Marker.CYLINDER, robot_pose,
                  (2 * max(robot.radius, LINE), 2 * max(robot.radius, LINE), HEIGHT), GREEN)
    if math.isinf(robot.radius):
        body.type = Marker.CUBE
        body.scale.x, body.scale.y = LINE, FENCE
    body.pose.position.z = HEIGHT / 2
    nose = marker('heading', Marker.ARROW, robot_pose,
                  (min(max(robot.radius, LINE), ARROW), 0.03, 0.03), GREY)
    nose.pose.position.z = HEIGHT
    contact, gamma, _ = find_contact(obj, object_pose, robot_pose, robot.radius)
    place = Pose(*object_pose).transform(contact_point(obj, contact))
    cone = marker('friction_cone', Marker.LINE_LIST, Pose(*place, gamma), (LINE, 0.0, 0.0), RED)
    angle = math.atan(obj.contact_friction_coefficient)
    for side in (-angle, angle):
        cone.points += [_point((0.0, 0.0)),
                        _point((ARROW * math.cos(side), ARROW * math.sin(side)))]
    normal = marker('contact', Marker.ARROW, Pose(*place, gamma), (ARROW, LINE, LINE), RED)
    return MarkerArray(markers=[outline, supports, body, nose, cone, normal])


def plan_markers(stamp, frame, trajectory):
    """
    Draw the ways of object, contact and robot in a plan.

    :param stamp: of the markers.
    :param frame: id of the world frame.
    :param trajectory: ``PushTrajectory``.
    :return: ``MarkerArray``.
    """
    result = MarkerArray()
    for joint, colour in (('object', BLUE), ('contact', ORANGE), ('robot', GREEN)):
        line = _marker(stamp, frame, f'plan/{joint}', Marker.LINE_STRIP, ORIGIN,
                       (LINE / 2, 0.0, 0.0), colour)
        line.lifetime = Duration()
        line.points = [_point(p) for p in getattr(trajectory, f'{joint}_poses')[:, :2].tolist()]
        result.markers.append(line)
    return result


def text_markers(stamp, frame, namespace, pose, text):
    """
    Write a text above a place.

    :param stamp: of the markers.
    :param frame: id of the world frame.
    :param namespace: of the markers.
    :param pose: ``Pose`` of the place.
    :param text: what is written.
    :return: ``MarkerArray``.
    """
    words = _marker(stamp, frame, f'{namespace}/text', Marker.TEXT_VIEW_FACING, pose,
                    (0.0, 0.0, HEIGHT), GREY)
    words.pose.position.z, words.text = ABOVE, text
    return MarkerArray(markers=[words])


def _marker(stamp, frame, namespace, kind, pose, scale, colour):
    result = Marker(ns=namespace, type=kind, action=Marker.ADD, lifetime=SHORT)
    result.header.stamp, result.header.frame_id = stamp, frame
    result.pose = to_pose_message(pose)
    result.scale.x, result.scale.y, result.scale.z = scale
    result.color = ColorRGBA(r=colour[0], g=colour[1], b=colour[2], a=1.0)
    return result


def _outline(obj):
    if obj.outline:
        return [*obj.outline, obj.outline[0]]
    return [(obj.radius * math.cos(0.1 * math.pi * i), obj.radius * math.sin(0.1 * math.pi * i))
            for i in range(21)]


def _point(xy):
    return Point(x=float(xy[0]), y=float(xy[1]), z=0.0)
