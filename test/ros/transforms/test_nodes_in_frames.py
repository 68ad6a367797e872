"""Nodes that are given goals, maps and object poses in other frames than the world's, over DDS."""

import math

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from helpers.build_interfaces import available_tf2_msgs
from helpers.node_bench import bench
import numpy as np
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest, RequestKind
from push_model.rigid_transform import RigidTransform
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP
from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.map import to_map_message
from push_ros.conversions.measurements import (
    from_object_pose_message, to_object_pose_message, to_odometry_message,
)
from push_ros.conversions.plan import from_plan_message, no_plan_message
from push_ros.conversions.plan_request import from_request_message, to_request_message
from push_ros.conversions.primitives import from_pose_message, to_pose_message, to_stamp
from push_ros.topics import CONTROLLER, PLANNER, TRACKER
from push_ros.transforms.listener import (
    DYNAMIC_QOS, DYNAMIC_TOPIC, STATIC_QOS, STATIC_TOPIC, transform_message_type,
)
from push_ros.transforms.messages import from_transform_message, to_transform_message
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]
SCENARIO = read_scenario(find_scenario('task_approach'))
OBJECT, ROBOT = SCENARIO.start.object.pose, SCENARIO.robot_start
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
GOAL_IN_MAP = Pose(3.0, 1.0, 0.5)
PERIOD = 0.05
FREE = OccupancyMap(0.1, Pose(-4.0, -4.0, 0.0), np.zeros((80, 80), dtype=bool))


class Frames:
    """A bench, and somebody who publishes transforms there."""

    def __init__(self, b):
        self.b, self.now = b, 100.0
        b.subscribe('diagnostics')
        kind = transform_message_type()
        self._publishers = {
            is_static: b.node.create_publisher(kind, topic, quality)
            for is_static, topic, quality in ((False, DYNAMIC_TOPIC, DYNAMIC_QOS),
                                              (True, STATIC_TOPIC, STATIC_QOS))}

    def publish(self, parent, children, is_static=False):
        """Publish transforms of one stamp, from a dict of frames."""
        self._publishers[is_static].publish(transform_message_type()(transforms=[
            to_transform_message(value, to_stamp(self.now), parent, name)
            for name, value in children.items()]))

    def texts(self):
        """Texts that were reported."""
        return [status.message for message in self.b.received['diagnostics']
                for status in message.status]


def upright(pose):
    """Make a transform in the plane."""
    return RigidTransform.from_angles((pose.x, pose.y, 0.0), (0.0, 0.0, pose.theta))


def posed(frame, time, pose):
    """Make a pose in a frame."""
    message = PoseStamped(pose=to_pose_message(pose))
    message.header.frame_id, message.header.stamp = frame, to_stamp(time)
    return message


def requests(b):
    """Read the requests that have come."""
    return [from_request_message(message, 'odom')
            for message in b.received['push_request']]


def test_a_task_in_the_map_with_a_camera_follows_what_drifts(tmp_path):
    """
    The first request has object and goal where they are in the world.

    A later one has the goal where localization has found it to be since. A map in its frame is
    taken as well, and whoever comes late is shown the goal.
    """
    parameters = {**PHYSICS, 'use_sim_time': True, 'task': True,
                  'object_pose_with_covariance': True}
    with available_tf2_msgs(), bench(tmp_path, CONTROLLER, 'push_control.controller_node',
                                     parameters) as b:
        frames = Frames(b)
        b.subscribe('push_request')
        localized = Pose(1.0, 0.5, 0.2)
        camera = Pose(2.0, -1.0, math.pi / 2)
        stated = PoseCovariance(1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6)
        in_camera = camera.inverse() @ OBJECT

        def measure():
            for _ in range(5):
                measure_once()

        def measure_once():
            frames.now += PERIOD
            b.clock(frames.now)
            frames.publish('map', {'odom': upright(localized)})
            frames.publish('odom', {'base_link': upright(ROBOT)})
            frames.publish('base_link', {'camera': upright(ROBOT.inverse() @ camera)},
                           is_static=True)
            b.publish('odom', to_odometry_message(Odometry(frames.now, ROBOT, STOP), 'odom',
                                                  'base_link'))
            b.publish('object_pose', to_object_pose_message(
                ObjectPose(frames.now, in_camera, stated), 'camera', with_covariance=True))

        b.wait_until(frames.texts)
        b.publish('goal_pose', posed('map', frames.now, GOAL_IN_MAP))
        b.publish('map', to_map_message(FREE, to_stamp(0.0), 'map'))
        b.repeat_until(measure, lambda: requests(b))
        first = requests(b)[0]
        # As estimated with the robot, to a hundredth of the deviation that the camera states.
        assert first.object_pose == pytest.approx(OBJECT, abs=1e-5)
        assert first.robot_pose == pytest.approx(ROBOT, abs=0.02)
        assert first.goal == pytest.approx(localized.inverse() @ GOAL_IN_MAP)
        b.wait_until(lambda: 'has a map of 80 times 80 cells' in frames.texts())

        # A goal that is refused, and a stop and a start, leave it to follow its frame.
        b.publish('goal_pose', posed('odom', frames.now, Pose(math.nan, 0.0, 0.0)))
        b.wait_until(lambda: any(text.startswith('goal_pose: ') for text in frames.texts()))
        for service in ('controller/stop', 'controller/start'):
            assert b.call(service).success
        localized = Pose(1.1, 0.4, 0.15)
        b.publish('push_plan', no_plan_message(
            PlanFailure.BLOCKED, b.received['push_request'][0].header.stamp, 'odom'))
        b.repeat_until(measure, lambda: len(requests(b)) > 1)
        # The correction comes within a moment, which a request may precede.
        expected = localized.inverse() @ GOAL_IN_MAP

        def is_followed():
            newest = b.received['push_request'][-1]
            goal = requests(b)[-1].goal
            if goal == pytest.approx(expected, abs=1e-6):
                return True
            b.publish('push_plan', no_plan_message(PlanFailure.BLOCKED, newest.header.stamp,
                                                   'odom'))
            return False
        b.repeat_until(measure, is_followed)

        # Whoever comes late sees the ghost at the goal; the robot stands, and is alone.
        for topic in ('plan_markers', 'markers', 'footprint'):
            b.subscribe(topic)
        transforms = []
        b.node.create_subscription(transform_message_type(), DYNAMIC_TOPIC, transforms.append,
                                   DYNAMIC_QOS)

        def object_frames():
            return [stamped for message in transforms for stamped in message.transforms
                    if stamped.child_frame_id == 'object']
        b.repeat_until(measure, lambda: all(b.received[topic] for topic in (
            'plan_markers', 'markers', 'footprint')) and object_frames())
        ghost = next(marker for message in b.received['plan_markers']
                     for marker in message.markers if marker.ns == 'goal/body')
        assert from_pose_message(ghost.pose, '') == pytest.approx(expected, abs=1e-6)
        drawn = {marker.ns: marker for marker in b.received['markers'][-1].markers}
        for name in ('body', 'ellipse', 'friction_center', 'text'):
            assert drawn[f'controller/{name}'].header.frame_id == 'odom'
        found = from_transform_message(object_frames()[-1])
        assert found.planar == pytest.approx(OBJECT, abs=1e-3)
        footprint = b.received['footprint'][-1]
        assert footprint.header.frame_id == 'base_link'
        assert max(math.hypot(point.x, point.y) for point in footprint.polygon.points) < 0.18

        b.repeat_until(
            lambda: b.publish('object_pose', to_object_pose_message(
                ObjectPose(frames.now, OBJECT, stated), 'nowhere', with_covariance=True)),
            lambda: any("object_pose: got frame 'nowhere', expected 'odom' or a frame with a "
                        'transform to it' in text and 'known: base_link -> camera' in text
                        for text in frames.texts()))


def test_a_camera_on_the_robot_needs_no_transform_of_odometry(tmp_path):
    """A task begins, its object placed by the odometry that the controller has anyway."""
    parameters = {**PHYSICS, 'use_sim_time': True, 'task': True}
    with available_tf2_msgs(), bench(tmp_path, CONTROLLER, 'push_control.controller_node',
                                     parameters) as b:
        frames = Frames(b)
        b.subscribe('push_request')
        mount = Pose(0.1, 0.0, 0.2)
        in_camera = mount.inverse() @ ROBOT.inverse() @ OBJECT

        def measure():
            for _ in range(5):
                frames.now += PERIOD
                b.clock(frames.now)
                frames.publish('base_link', {'camera': upright(mount)}, is_static=True)
                b.publish('object_pose', to_object_pose_message(
                    ObjectPose(frames.now, in_camera), 'camera'))
                b.publish('odom', to_odometry_message(Odometry(frames.now, ROBOT, STOP), 'odom',
                                                      'base_link'))
        b.wait_until(frames.texts)
        b.publish('goal_pose', posed('odom', frames.now, GOAL_IN_MAP))
        b.repeat_until(measure, lambda: requests(b))
        assert requests(b)[0].object_pose == pytest.approx(OBJECT, abs=1e-3)


def test_a_planner_takes_maps_and_object_poses_in_their_frames(tmp_path):
    """It has the map, and plans from the object pose that a camera has measured."""
    parameters = {**PHYSICS, 'use_sim_time': True, 'planner.site': 'best'}
    with available_tf2_msgs(), bench(tmp_path, PLANNER, 'push_planner.planner_node',
                                     parameters) as b:
        frames = Frames(b)
        b.subscribe('push_plan')
        b.wait_until(frames.texts)
        b.publish('map', to_map_message(FREE, to_stamp(0.0), 'map'))
        b.repeat_until(lambda: frames.publish('map', {'odom': upright(Pose(1.0, 0.5, 0.2))}),
                       lambda: 'has a map of 80 times 80 cells' in frames.texts())
        camera = Pose(2.0, -1.0, math.pi / 2)
        request = PlanRequest(OBJECT, ROBOT, OBJECT @ Pose(1.0, 0.0, 0.0), SCENARIO.object,
                              kind=RequestKind.STEERED_PUSH)
        b.publish('push_request', to_request_message(request, to_stamp(frames.now), 'odom'))

        def measure():
            frames.publish('odom', {'camera': upright(camera)})
            b.publish('odom', to_odometry_message(Odometry(frames.now, ROBOT, STOP), 'odom',
                                                  'base_link'))
            b.publish('object_pose', to_object_pose_message(
                ObjectPose(frames.now, camera.inverse() @ OBJECT), 'camera'))
        b.repeat_until(measure, lambda: b.received['push_plan'])
        plan = from_plan_message(b.received['push_plan'][0], 'odom')
        assert Pose(*plan.object_poses[0].tolist()) == pytest.approx(OBJECT, abs=1e-6)


# A tag on top of the object and one on its front, seen by a camera that looks down from 2 m.
TAGS = {'top': (0.1, -0.05, 0.3, 0.0, 0.0, 0.4),
        'front': (0.2, 0.0, 0.15, math.pi / 2, 0.0, math.pi / 2)}
CAMERA = RigidTransform.from_angles((0.5, 0.0, 2.0), (math.pi, 0.0, 0.0))


def test_a_tracker_turns_tags_into_object_poses(tmp_path):
    """At the stamp of the image, with a covariance, and without a tag that is misread."""
    names = ('frame', 'x', 'y', 'z', 'roll', 'pitch', 'yaw')
    columns = zip(*((frame, *place) for frame, place in TAGS.items()))
    parameters = {f'tracker.tags.{name}': list(column) for name, column in zip(names, columns)}
    with available_tf2_msgs(), bench(tmp_path, TRACKER, 'push_tracker.tracker_node',
                                     parameters) as b:
        frames = Frames(b)
        b.subscribe('object_pose', PoseWithCovarianceStamped)
        robot, pose = Pose(1.0, 2.0, 0.3), Pose(1.7, 2.2, -1.0)
        mounted = {frame: RigidTransform.from_angles(place[:3], place[3:])
                   for frame, place in TAGS.items()}

        def see(misread=()):
            frames.now += PERIOD
            in_camera = (upright(robot) @ CAMERA).inverse() @ upright(pose)
            frames.publish('camera', {
                frame: in_camera @ tag if frame not in misread else RigidTransform(z=1.0)
                for frame, tag in mounted.items()})
            # Odometry comes after the image.
            frames.publish('base_link', {'camera': CAMERA}, is_static=True)
            frames.publish('odom', {'base_link': upright(robot)})

        b.wait_until(frames.texts)
        poses = b.received['object_pose']
        b.repeat_until(see, lambda: poses)
        found = from_object_pose_message(poses[-1], 'odom')
        assert found.pose == pytest.approx(pose)
        assert found.time == pytest.approx(frames.now, abs=10 * PERIOD)
        assert 0.0 < found.covariance.position_deviation < 0.02
        count = len(poses)
        b.repeat_until(lambda: see(misread=('front',)), lambda: len(poses) > count + 2)
        assert from_object_pose_message(poses[-1], 'odom').pose == pytest.approx(pose)
        # The same tag alone is no pose.
        b.repeat_until(lambda: see(misread=('front', 'top')),
                       lambda: 'sees outliers only' in frames.texts())


def test_a_tracker_on_the_robot_needs_no_transform_of_odometry(tmp_path):
    """With the base frame for its world, the poses of a camera there are relative to the robot."""
    names = ('frame', 'x', 'y', 'z', 'roll', 'pitch', 'yaw')
    parameters = {f'tracker.tags.{name}': [value]
                  for name, value in zip(names, ('top', *TAGS['top']))}
    with available_tf2_msgs(), bench(tmp_path, TRACKER, 'push_tracker.tracker_node',
                                     {**parameters, 'world_frame': 'base_link'}) as b:
        frames = Frames(b)
        b.subscribe('object_pose', PoseWithCovarianceStamped)
        relative, place = Pose(0.7, 0.2, -1.0), TAGS['top']

        def see():
            frames.now += PERIOD
            frames.publish('camera', {'top': CAMERA.inverse() @ upright(relative)
                                      @ RigidTransform.from_angles(place[:3], place[3:])})
            frames.publish('base_link', {'camera': CAMERA}, is_static=True)
        b.repeat_until(see, lambda: b.received['object_pose'])
        found = from_object_pose_message(b.received['object_pose'][-1], 'base_link')
        assert found.pose == pytest.approx(relative)
