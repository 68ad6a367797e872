"""Markers for RViz and Foxglove: object and its estimate, robot, contact, plan, goal, text."""

import math
from typing import Any, NamedTuple, Sequence

from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Point
import numpy as np
from push_model.contact import contact_point, find_contact
from push_model.geometry import Coordinates, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectEstimate, PoseCovariance
from push_model.trajectory import PushTrajectory
from push_ros.conversions.primitives import to_pose_message
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

Color = tuple[float, float, float]


def _color(text: str) -> Color:
    """Read a colour ``#rrggbb``."""
    red, green, blue = (int(text[i:i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue


# Colours of the page (``push_view/page/page.css``), in which everything looks the same.
OBJECT = _color('#0b3c8c')
GOAL = _color('#007a5e')
ROBOT = _color('#6d737b')
BELIEVED = _color('#b35c00')
FORCE = _color('#b3261e')
CONE = _color('#6a3d9a')
PLAN = _color('#4c5159')
INK = _color('#1c1e21')
ORIGIN = Pose(0.0, 0.0, 0.0)
# Sizes [m], chosen by eye for objects of about half a metre.
LINE_WIDTH = 0.01
ARROW_WIDTH = 0.03
SUPPORT_SIZE = 0.03
ROBOT_HEIGHT = 0.1
ARROW_LENGTH = 0.25
PUSHER_LENGTH = 2.0
TEXT_HEIGHT = 0.1
TEXT_ELEVATION = 0.3
OBJECT_HEIGHT = 0.2
FLAT = 0.002
CENTER_SIZE = 0.04
# Opacity of the estimated object, of the ghost at its goal, and of the estimate's ellipse.
OBJECT_ALPHA = 0.6
GHOST_ALPHA = 0.25
ELLIPSE_ALPHA = 0.4
# Standard deviations that the ellipse shows; chosen: 99 of 100 places are within three.
ELLIPSE_SIGMAS = 3.0
# Whatever is not drawn again for a second disappears: markers come twice a second and more.
LIFETIME = Duration(sec=1)
CIRCLE_VERTICES = 20


class MarkerHeader(NamedTuple):
    """
    Values that all markers of one drawing share.

    :param stamp: ``builtin_interfaces/Time``.
    :param frame: id of the world frame.
    :param namespace: of the markers.
    """

    stamp: Time
    frame: str
    namespace: str


def scene_markers(header: MarkerHeader, obj: PushedObject, robot: RoundRobot,
                  object_pose: Coordinates, robot_pose: Coordinates, *,
                  color: Color = OBJECT) -> MarkerArray:
    """
    Draw object, supports, robot and their contact.

    :param object_pose: ``Pose`` of the object.
    :param robot_pose: ``Pose`` of the robot.
    :param color: of the object, (r, g, b).
    """
    outline = _marker(header, 'object', Marker.LINE_STRIP, object_pose, color)
    _set_scale(outline, LINE_WIDTH)
    outline.points = [_point(p) for p in _closed_outline(obj)]
    supports = _marker(header, 'supports', Marker.SPHERE_LIST, object_pose, color)
    _set_scale(supports, SUPPORT_SIZE, SUPPORT_SIZE, SUPPORT_SIZE)
    supports.points = [_point((support.x, support.y)) for support in obj.supports]
    return MarkerArray(markers=[
        outline, supports, *_robot_markers(header, robot, robot_pose),
        *_contact_markers(header, obj, robot, object_pose, robot_pose)])


def estimate_markers(header: MarkerHeader, obj: PushedObject,
                     estimate: ObjectEstimate) -> MarkerArray:
    """Draw what is estimated of an object: body, ellipse of its position, friction centre."""
    markers = [_body(header, obj, estimate.pose, BELIEVED, OBJECT_ALPHA)]
    if estimate.covariance is not None:
        markers.append(_ellipse(header, estimate.pose, estimate.covariance))
    x, y = estimate.pose.transform(estimate.friction_center)
    center = _marker(header, 'friction_center', Marker.SPHERE, Pose(x, y, 0.0), BELIEVED)
    _set_scale(center, CENTER_SIZE, CENTER_SIZE, CENTER_SIZE)
    center.pose.position.z = OBJECT_HEIGHT
    return MarkerArray(markers=[*markers, center])


def goal_markers(header: MarkerHeader, obj: PushedObject, pose: Coordinates) -> MarkerArray:
    """
    Draw the ghost of an object at its goal; it stays until it is replaced.

    :param pose: goal ``Pose``.
    """
    ghost = _body(header, obj, pose, GOAL, GHOST_ALPHA)
    ghost.lifetime = Duration()
    return MarkerArray(markers=[ghost])


def erased(header: MarkerHeader) -> MarkerArray:
    """Make the marker that removes all others of its topic."""
    marker = _marker(header, 'all', Marker.CUBE, ORIGIN, INK)
    marker.action = Marker.DELETEALL
    return MarkerArray(markers=[marker])


def plan_markers(header: MarkerHeader, trajectory: PushTrajectory) -> MarkerArray:
    """Draw the paths of object, contact and robot in a plan."""
    lines: list[Any] = []
    for name, poses, color in (('object', trajectory.object_poses, PLAN),
                               ('contact', trajectory.contact_poses, FORCE),
                               ('robot', trajectory.robot_poses, ROBOT)):
        lines.append(line_marker(header, name, poses[:, :2].tolist(), color))
    return MarkerArray(markers=lines)


def line_marker(header: MarkerHeader, name: str, points: Sequence[Coordinates],
                color: Color) -> Any:
    """
    Draw a line on the floor; it stays until it is replaced.

    :param points: (x, y) along it [m].
    :param color: (r, g, b).
    """
    line = _marker(header, name, Marker.LINE_STRIP, ORIGIN, color)
    _set_scale(line, LINE_WIDTH / 2)
    line.lifetime = Duration()
    line.points = [_point(point) for point in points]
    return line


def disc_marker(header: MarkerHeader, name: str, pose: Coordinates, axes: tuple[float, float],
                color: Color) -> Any:
    """
    Draw an ellipse on the floor, transparent; it stays until it is replaced.

    :param pose: of its middle and its long axis.
    :param axes: their whole lengths [m].
    :param color: (r, g, b).
    """
    disc = _marker(header, name, Marker.CYLINDER, pose, color)
    _set_scale(disc, max(axes[0], FLAT), max(axes[1], FLAT), FLAT)
    disc.color.a = ELLIPSE_ALPHA
    disc.lifetime = Duration()
    return disc


def label_marker(header: MarkerHeader, name: str, position: Coordinates, text: str,
                 color: Color = INK) -> Any:
    """
    Write a text above a place; it stays until it is replaced.

    :param position: (x, y) [m].
    :param color: (r, g, b).
    """
    marker = _text(header, name, Pose(position[0], position[1], 0.0), text, color)
    marker.lifetime = Duration()
    return marker


def outline_marker(header: MarkerHeader, name: str, obj: PushedObject, pose: Coordinates,
                   color: Color) -> Any:
    """
    Draw the outline of an object; it stays until it is replaced.

    :param pose: ``Pose`` of the object.
    :param color: (r, g, b).
    """
    return line_marker(header, name, [Pose(*pose).transform(vertex)
                                      for vertex in _closed_outline(obj)], color)


def ring_marker(header: MarkerHeader, name: str, position: Coordinates, radius: float,
                color: Color) -> Any:
    """
    Draw a circle on the floor; it stays until it is replaced.

    :param position: (x, y) of its middle [m].
    :param color: (r, g, b).
    """
    angles = [2.0 * math.pi / CIRCLE_VERTICES * index for index in range(CIRCLE_VERTICES + 1)]
    return line_marker(header, name, [
        (position[0] + radius * math.cos(angle), position[1] + radius * math.sin(angle))
        for angle in angles], color)


def text_markers(header: MarkerHeader, pose: Coordinates, text: str) -> MarkerArray:
    """
    Write a text above a place.

    :param pose: ``Pose`` of the place.
    :param text: what is written.
    """
    return MarkerArray(markers=[_text(header, 'text', pose, text, INK)])


def _text(header: MarkerHeader, name: str, pose: Coordinates, text: str, color: Color) -> Any:
    marker = _marker(header, name, Marker.TEXT_VIEW_FACING, pose, color)
    _set_scale(marker, 0.0, 0.0, TEXT_HEIGHT)
    marker.pose.position.z = TEXT_ELEVATION
    marker.text = text
    return marker


def _body(header: MarkerHeader, obj: PushedObject, pose: Coordinates, color: Color,
          alpha: float) -> Any:
    """Draw an object as a solid: its outline extruded, as triangles."""
    if not obj.outline:
        body = _marker(header, 'body', Marker.CYLINDER, pose, color)
        _set_scale(body, 2.0 * obj.radius, 2.0 * obj.radius, OBJECT_HEIGHT)
        body.pose.position.z = OBJECT_HEIGHT / 2
    else:
        body = _marker(header, 'body', Marker.TRIANGLE_LIST, pose, color)
        _set_scale(body, 1.0, 1.0, 1.0)
        body.points = _extruded(obj.outline)
    body.color.a = alpha
    return body


def _ellipse(header: MarkerHeader, pose: Pose, covariance: PoseCovariance) -> Any:
    """Draw where a place may be, as a disc on top of the object."""
    variances, axes = np.linalg.eigh(covariance.matrix[:2, :2])
    direction = math.atan2(axes[1, 1], axes[0, 1])
    ellipse = _marker(header, 'ellipse', Marker.CYLINDER, Pose(pose.x, pose.y, direction),
                      BELIEVED)
    minor, major = (2.0 * ELLIPSE_SIGMAS * np.sqrt(np.maximum(0.0, variances))).tolist()
    _set_scale(ellipse, max(major, FLAT), max(minor, FLAT), FLAT)
    ellipse.pose.position.z = OBJECT_HEIGHT
    ellipse.color.a = ELLIPSE_ALPHA
    return ellipse


def _extruded(outline: Sequence[Coordinates]) -> list[Point]:
    """Make the triangles of a prism over a convex outline: its top and its sides."""
    low = [_point(vertex) for vertex in outline]
    high = [_point(vertex, OBJECT_HEIGHT) for vertex in outline]
    triangles: list[Point] = []
    for i in range(2, len(high)):
        triangles += [high[0], high[i - 1], high[i]]
    for i in range(len(low)):
        j = (i + 1) % len(low)
        triangles += [low[i], low[j], high[j], low[i], high[j], high[i]]
    return triangles


def _robot_markers(header: MarkerHeader, robot: RoundRobot, pose: Coordinates) -> list[Any]:
    """Draw the robot and its heading; a point robot as a thin disc, a flat pusher as a bar."""
    radius = max(robot.radius, LINE_WIDTH)
    body = _marker(header, 'robot', Marker.CYLINDER, pose, ROBOT)
    _set_scale(body, 2 * radius, 2 * radius, ROBOT_HEIGHT)
    if math.isinf(robot.radius):
        body.type = Marker.CUBE
        _set_scale(body, LINE_WIDTH, PUSHER_LENGTH, ROBOT_HEIGHT)
    body.pose.position.z = ROBOT_HEIGHT / 2
    heading = _marker(header, 'heading', Marker.ARROW, pose, INK)
    _set_scale(heading, min(radius, ARROW_LENGTH), ARROW_WIDTH, ARROW_WIDTH)
    heading.pose.position.z = ROBOT_HEIGHT
    return [body, heading]


def _contact_markers(header: MarkerHeader, obj: PushedObject, robot: RoundRobot,
                     object_pose: Coordinates, robot_pose: Coordinates) -> list[Any]:
    """Draw the contact normal and the friction cone."""
    contact, normal_angle, _ = find_contact(obj, object_pose, robot_pose, robot.radius)
    point = Pose(*object_pose).transform(contact_point(obj, contact))
    pose = Pose(*point, normal_angle)
    cone = _marker(header, 'friction_cone', Marker.LINE_LIST, pose, CONE)
    _set_scale(cone, LINE_WIDTH)
    friction_angle = math.atan(obj.contact_friction_coefficient)
    for angle in (-friction_angle, friction_angle):
        cone.points += [_point((0.0, 0.0)), _point((ARROW_LENGTH * math.cos(angle),
                                                    ARROW_LENGTH * math.sin(angle)))]
    normal = _marker(header, 'contact', Marker.ARROW, pose, FORCE)
    _set_scale(normal, ARROW_LENGTH, LINE_WIDTH, LINE_WIDTH)
    return [cone, normal]


def _marker(header: MarkerHeader, name: str, kind: int, pose: Coordinates, color: Color) -> Any:
    result = Marker(ns=f'{header.namespace}/{name}', type=kind, action=Marker.ADD,
                    lifetime=LIFETIME)
    result.header.stamp = header.stamp
    result.header.frame_id = header.frame
    result.pose = to_pose_message(pose)
    result.color = ColorRGBA(r=color[0], g=color[1], b=color[2], a=1.0)
    return result


def _set_scale(marker: Any, x: float, y: float = 0.0, z: float = 0.0) -> None:
    marker.scale.x = x
    marker.scale.y = y
    marker.scale.z = z


def _closed_outline(obj: PushedObject) -> Sequence[Coordinates]:
    if obj.outline:
        return [*obj.outline, obj.outline[0]]
    angles = [2.0 * math.pi / CIRCLE_VERTICES * index for index in range(CIRCLE_VERTICES + 1)]
    return [(obj.radius * math.cos(angle), obj.radius * math.sin(angle)) for angle in angles]


def _point(position: Coordinates, height: float = 0.0) -> Point:
    return Point(x=float(position[0]), y=float(position[1]), z=height)
