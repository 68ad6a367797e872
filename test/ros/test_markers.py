"""What displays and costmaps are shown has the shape and the size of what is meant."""

import math

from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import ObjectEstimate, PoseCovariance
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
