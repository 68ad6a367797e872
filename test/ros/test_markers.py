"""What displays and costmaps are shown has the shape and the size of what is meant."""

import math

from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import ObjectEstimate, PoseCovariance
from push_navigation.map_clearance import PositionEllipse
from push_navigation.path import Path
from push_planner.planned_pushes import PlannedPush
from push_planner.refusal_marks import FaceMark, NarrowPlace, RefusalMarks
from push_planner.ros.planning_markers import pushes_markers, refusal_markers
from push_ros.conversions.footprint import (
    pushing_footprint, robot_footprint, to_footprint_message,
)
from push_ros.conversions.markers import (
    ELLIPSE_SIGMAS, erased, estimate_markers, goal_markers, MarkerHeader, OBJECT_HEIGHT,
)
from push_ros.conversions.primitives import from_pose_message, to_stamp
import pytest
from scipy.spatial import ConvexHull
from visualization_msgs.msg import Marker

BOX = box()
DISC = PushedObject(mass=1.0, inertia=0.01, radius=0.2, supports=(Support(0.0, 0.0, 0.5),))
ROBOT = RoundRobot(0.17, 'holonomic')
HEADER = MarkerHeader(to_stamp(1.0), 'odom', 'controller')
POSE = Pose(1.0, 2.0, 0.5)


def volume(points):
    """Compute the volume under triangles whose normals point outwards."""
    corners = np.array([(p.x, p.y, p.z) for p in points]).reshape(-1, 3, 3)
    return sum(np.linalg.det(triangle) for triangle in corners) / 6.0


def test_the_body_is_the_outline_extruded():
    """Its triangles enclose area times height, though its bottom is left open."""
    ghost, = goal_markers(HEADER, BOX, POSE).markers
    assert ghost.type == Marker.TRIANGLE_LIST and 0.0 < ghost.color.a < 1.0
    area = ConvexHull(BOX.outline).volume
    assert volume(ghost.points) == pytest.approx(area * OBJECT_HEIGHT)
    assert from_pose_message(ghost.pose, '') == pytest.approx(POSE)
    round_ghost, = goal_markers(HEADER, DISC, POSE).markers
    assert round_ghost.type == Marker.CYLINDER and round_ghost.scale.x == pytest.approx(0.4)


def test_the_ellipse_is_that_of_the_covariance():
    """Along its axes it ends at the chosen number of standard deviations."""
    turned = Pose(0.0, 0.0, 0.8)
    axes = np.array([turned.rotate((1.0, 0.0)), turned.rotate((0.0, 1.0))]).T
    matrix = np.eye(3)
    matrix[:2, :2] = axes @ np.diag((0.03 ** 2, 0.01 ** 2)) @ axes.T
    estimate = ObjectEstimate(1.0, POSE, PoseCovariance.from_matrix(matrix), (0.05, -0.02))
    body, ellipse, center = estimate_markers(HEADER, BOX, estimate).markers
    assert ellipse.scale.x == pytest.approx(2 * ELLIPSE_SIGMAS * 0.03)
    assert ellipse.scale.y == pytest.approx(2 * ELLIPSE_SIGMAS * 0.01)
    direction = from_pose_message(ellipse.pose, '').theta
    assert math.sin(direction - 0.8) == pytest.approx(0.0, abs=1e-9)
    assert (center.pose.position.x, center.pose.position.y) == pytest.approx(
        POSE.transform((0.05, -0.02)))
    assert from_pose_message(body.pose, '') == pytest.approx(POSE)
    assert erased(HEADER).markers[0].action == Marker.DELETEALL


@pytest.mark.parametrize('obj', [BOX, DISC])
def test_the_footprint_holds_robot_and_object(obj):
    """In the frame of the robot, counter-clockwise, and not more than their convex hull."""
    robot_pose, object_pose = Pose(3.0, 1.0, 2.0), Pose(3.1, 1.4, -0.5)
    vertices = pushing_footprint(ROBOT, obj, robot_pose, object_pose)
    hull = ConvexHull(vertices)
    assert len(hull.vertices) == len(vertices)
    rim = [(math.cos(angle), math.sin(angle)) for angle in np.linspace(0.0, 2 * math.pi, 50)]
    inside = [(0.17 * x, 0.17 * y) for x, y in rim]
    in_world = map(object_pose.transform, obj.outline or [(0.2 * x, 0.2 * y) for x, y in rim])
    inside += [robot_pose.inverse().transform(point) for point in in_world]
    heights = hull.equations[:, :2] @ np.array(inside).T + hull.equations[:, 2:]
    assert heights.max() < 1e-9
    exact = ConvexHull(inside).volume
    assert exact <= hull.volume < 1.06 * exact
    x, y = np.array(vertices).T
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0.0


def test_the_footprint_of_the_robot_alone_is_its_disc():
    """A message has it in the frame of the robot."""
    vertices = robot_footprint(ROBOT)
    message = to_footprint_message(vertices, to_stamp(2.0), 'base_link')
    assert message.header.frame_id == 'base_link'
    distances = [math.hypot(point.x, point.y) for point in message.polygon.points]
    assert min(distances) >= 0.17 and max(distances) < 0.175
    assert robot_footprint(RoundRobot(math.inf, 'holonomic')) == [(0.0, 0.0)]


def test_planned_pushes_are_ghosts_where_the_object_comes_to_stand() -> None:
    """Each with its number and the robot's path to it; the next picture replaces this one."""
    poses, start = [Pose(0.5, 0.1, 0.4), Pose(0.9, 0.6, 1.0)], Pose(-0.4, 0.0, 0.0)
    pushes = [PlannedPush(pose, pose, start, Path((Pose(-2.0, 1.0, 0.0), start)))
              for pose in poses]
    pushes.append(PlannedPush(poses[0], poses[1], start, None))
    first, *markers = pushes_markers(HEADER, BOX, ROBOT, pushes).markers
    assert first.action == Marker.DELETEALL
    assert len({(marker.ns, marker.id) for marker in markers}) == len(markers) == 4 + 4 + 3
    drawn = {name: [marker for marker in markers if marker.ns.endswith(name)]
             for name in ('objects', 'numbers', 'paths')}
    for ghost, number, pose in zip(drawn['objects'], drawn['numbers'], poses):
        corners = np.array([(point.x, point.y) for point in ghost.points[:-1]])
        assert corners == pytest.approx(np.array(list(map(pose.transform, BOX.outline))))
        assert (number.pose.position.x, number.pose.position.y) == pytest.approx(pose[:2])
    assert [number.text for number in drawn['numbers']] == ['1', '2', '3']
    for path in drawn['paths']:
        assert (path.points[0].x, path.points[0].y) == pytest.approx((-2.0, 1.0))
        assert (path.points[-1].x, path.points[-1].y) == pytest.approx(start[:2])
    # They stay until they are replaced.
    assert not any(marker.lifetime.sec or marker.lifetime.nanosec for marker in markers)


def test_what_stands_against_a_plan_is_as_wide_as_it_is() -> None:
    """Widths of the floor, the ellipse along its axis, a cross where the robot has no room."""
    marks = RefusalMarks(
        NarrowPlace(1.0, -2.0, 0.5, 0.8, PositionEllipse(0.2, 0.05, 0.5)),
        (FaceMark(0.0, 1.0, True), FaceMark(1.0, 0.0, False)), POSE,
        robot_path=((0.0, 0.5), (1.0, -2.0)))
    first, *markers = refusal_markers(HEADER, BOX, ROBOT, marks).markers
    assert first.action == Marker.DELETEALL
    assert len({(marker.ns, marker.id) for marker in markers}) == len(markers)
    by_name = {(marker.ns.partition('/')[2], marker.id): marker for marker in markers}
    free, ellipse = by_name['free', 0], by_name['position', 0]
    assert (free.scale.x, free.scale.y) == (0.5, 0.5)
    assert (ellipse.scale.x, ellipse.scale.y) == pytest.approx((0.8, 0.2))
    assert from_pose_message(ellipse.pose, '') == pytest.approx((1.0, -2.0, 0.5))
    for point in by_name['needed', 0].points:
        assert math.hypot(point.x - 1.0, point.y + 2.0) == pytest.approx(0.4)
    assert '0.50 m' in by_name['widths', 0].text and '0.80 m' in by_name['widths', 0].text
    assert [(point.x, point.y) for point in by_name['paths', 0].points] == list(marks.robot_path)
    assert [index for name, index in by_name if name == 'crosses up'] == [1]
    corners = np.array([(point.x, point.y) for point in by_name['overlap', 0].points[:-1]])
    assert corners == pytest.approx(np.array(list(map(POSE.transform, BOX.outline))))
