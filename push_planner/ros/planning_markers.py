"""Markers of what is planned, as numbered ghosts of the object, and of what stands against it."""

from collections.abc import Sequence
import math
from typing import Any

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.path import sample_path
from push_planner.planned_pushes import PlannedPush
from push_planner.refusal_marks import FaceMark, NarrowPlace, RefusalMarks
from push_ros.conversions.markers import (
    BELIEVED, disc_marker, erased, FORCE, INK, label_marker, line_marker, MarkerHeader,
    outline_marker, PLAN, ring_marker, ROBOT)
from visualization_msgs.msg import MarkerArray

# Distance of points on the robot's way to a push [m]; chosen: arcs look round.
SPACING = 0.05
# Standard deviations that the ellipse of the robot's position shows, as on the page.
ELLIPSE_SIGMAS = 2.0


def pushes_markers(header: MarkerHeader, obj: PushedObject, robot: RoundRobot,
                   pushes: Sequence[PlannedPush]) -> MarkerArray:
    """
    Draw planned pushes in place of whatever was drawn before.

    :param pushes: ``PlannedPush`` of each; the next one is the first.
    """
    markers: list[Any] = list(erased(header).markers)
    for index, push in enumerate(pushes):
        drawn = [outline_marker(header, 'objects', obj, push.end, PLAN),
                 ring_marker(header, 'robots', push.robot_start[:2], robot.radius, ROBOT),
                 label_marker(header, 'numbers', push.end[:2], str(index + 1))]
        if push.approach is not None:
            points = np.asarray(sample_path(push.approach, robot, SPACING))[:, :2].tolist()
            drawn.append(line_marker(header, 'paths', points, ROBOT))
        markers += _numbered(drawn, index)
    return MarkerArray(markers=markers)


def refusal_markers(header: MarkerHeader, obj: PushedObject, robot: RoundRobot,
                    marks: RefusalMarks) -> MarkerArray:
    """Draw what stands against a plan in place of whatever was drawn before."""
    markers: list[Any] = list(erased(header).markers)
    if marks.robot_path:
        markers.append(line_marker(header, 'paths', marks.robot_path, BELIEVED))
    if marks.narrow_place is not None:
        markers += _place_markers(header, marks.narrow_place)
    for index, face in enumerate(marks.faces):
        markers += _numbered(_face_markers(header, face, robot.radius), index)
    for name, pose, color in (('overlap', marks.overlap, FORCE), ('nearest', marks.nearest, INK)):
        if pose is not None:
            markers.append(outline_marker(header, name, obj, pose, color))
    return MarkerArray(markers=markers)


def _place_markers(header: MarkerHeader, place: NarrowPlace) -> list[Any]:
    """Draw the free floor, that which is needed, and where the robot may be."""
    pose, text = Pose(place.x, place.y, 0.0), f'{place.width:.2f} m free'
    markers = [disc_marker(header, 'free', pose, (place.width, place.width), FORCE)]
    if place.needed_width is not None:
        text += f', {place.needed_width:.2f} m needed'
        markers.append(ring_marker(header, 'needed', pose[:2], 0.5 * place.needed_width, FORCE))
    if place.ellipse is not None:
        major, minor, angle = place.ellipse
        markers.append(disc_marker(
            header, 'position', pose._replace(theta=angle),
            (2.0 * ELLIPSE_SIGMAS * major, 2.0 * ELLIPSE_SIGMAS * minor), BELIEVED))
    return [*markers, label_marker(header, 'widths', pose[:2], text, FORCE)]


def _face_markers(header: MarkerHeader, face: FaceMark, radius: float) -> list[Any]:
    """Draw the robot at a face, crossed out where it has no room."""
    if face.has_room:
        return [ring_marker(header, 'faces', (face.x, face.y), radius, INK)]
    half = radius * math.sqrt(0.5)
    return [ring_marker(header, 'faces', (face.x, face.y), radius, FORCE),
            *(line_marker(header, f'crosses {name}', [
                (face.x - half, face.y - side * half), (face.x + half, face.y + side * half)],
                FORCE) for name, side in (('up', 1.0), ('down', -1.0)))]


def _numbered(markers: list[Any], index: int) -> list[Any]:
    """Tell markers of one name apart by an index."""
    for marker in markers:
        marker.id = index
    return markers
