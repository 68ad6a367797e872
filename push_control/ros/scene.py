"""What displays, costmaps and collision monitors are shown of a push: markers, footprint, tf."""

from typing import Any, Callable, NamedTuple

from builtin_interfaces.msg import Time
from push_control.ros.parameters import ControllerParameters
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.rigid_transform import RigidTransform
from push_model.signals import ObjectEstimate
from push_model.trajectory import PushTrajectory
from push_ros.conversions.footprint import (
    pushing_footprint, robot_footprint, to_footprint_message,
)
from push_ros.conversions.markers import (
    BELIEVED, erased, estimate_markers, goal_markers, MarkerHeader, plan_markers,
    scene_markers, text_markers,
)
from push_ros.conversions.primitives import to_stamp
from push_ros.node import PushNode, RateLimiter
from push_ros.transforms.listener import (
    DYNAMIC_QOS, DYNAMIC_TOPIC, transform_message_type,
)
from push_ros.transforms.messages import to_transform_message
from rclpy.publisher import Publisher
from visualization_msgs.msg import MarkerArray

# Rates in measured time [Hz]; chosen: enough to follow a push by eye, for costmaps that are
# updated as often, and for transforms between which tf interpolates.
MARKER_RATE = 2.0
FOOTPRINT_RATE = 5.0
TRANSFORM_RATE = 20.0


class EstimatedScene(NamedTuple):
    """
    Robot and object as estimated.

    :param robot_pose: ``Pose`` of the robot in the world.
    :param is_pushing: whether the robot pushes, so that the object moves with it.
    :param text: what the robot does, or empty.
    """

    robot_pose: Pose
    estimate: ObjectEstimate
    is_pushing: bool
    text: str = ''


class _Output(NamedTuple):
    """Output that is published now and then, its period and topic."""

    publish: Callable[[EstimatedScene, Time], None]
    limiter: RateLimiter
    publisher: Publisher


class ScenePublisher:
    """Publishes markers of scene, plan and goal, the footprint, and the frame of the object."""

    def __init__(self, node: PushNode, parameters: ControllerParameters) -> None:
        """Start with nothing to show."""
        self._node = node
        self._object = parameters.object
        self._robot = parameters.robot
        self._frames = parameters.frames
        self._goal: Pose | None = None
        self._plan: PushTrajectory | None = None
        self._markers = node.publisher('markers')
        self._plan_markers = node.publisher('plan_markers')
        self._footprint = node.publisher('footprint')
        self._outputs: list[_Output] = [
            _Output(self._draw, RateLimiter(MARKER_RATE), self._markers),
            _Output(self._publish_footprint, RateLimiter(FOOTPRINT_RATE), self._footprint)]
        self._transform_type = transform_message_type() if parameters.options.publish_tf else None
        self._transforms: Publisher | None = None
        if self._transform_type is not None:
            self._transforms = node.create_publisher(self._transform_type, DYNAMIC_TOPIC,
                                                     DYNAMIC_QOS)
            self._outputs.append(_Output(self._publish_transform, RateLimiter(TRANSFORM_RATE),
                                         self._transforms))

    def destroy(self) -> None:
        """Publish no more transforms; the other topics stay with the node."""
        if self._transforms is not None:
            self._node.destroy_publisher(self._transforms)

    def set_object(self, obj: PushedObject) -> None:
        """Show another object, with no goal yet."""
        self._object = obj
        self.show_goal(None, self._node.now())

    def show_goal(self, goal: Pose | None, stamp: Time) -> None:
        """
        Draw the goal, and erase the plan to a former one.

        :param goal: ``Pose``, or None for no goal.
        """
        self._goal, self._plan = goal, None
        self._draw_plan(stamp)

    def move_goal(self, goal: Pose, stamp: Time) -> None:
        """Draw the goal elsewhere."""
        self._goal = goal
        self._draw_plan(stamp)

    def show_plan(self, plan: PushTrajectory, stamp: Time) -> None:
        """Draw a plan, and the goal."""
        self._plan = plan
        self._draw_plan(stamp)

    def publish(self, time: float, make_scene: Callable[[], EstimatedScene | None]) -> None:
        """
        Publish what is due, for those who listen.

        :param time: of the newest measurement [s].
        :param make_scene: makes the ``EstimatedScene`` of that time, or None where there is
            nothing to show.
        """
        due = [publish for publish, limiter, publisher in self._outputs
               if limiter.due(time) and publisher.get_subscription_count()]
        scene = make_scene() if due else None
        if scene is not None:
            stamp = to_stamp(time)
            for publish in due:
                publish(scene, stamp)

    def _publish_transform(self, scene: EstimatedScene, stamp: Time) -> None:
        assert self._transform_type is not None and self._transforms is not None
        pose = scene.estimate.pose
        transform = RigidTransform.from_angles((pose.x, pose.y, 0.0), (0.0, 0.0, pose.theta))
        self._transforms.publish(self._transform_type(transforms=[to_transform_message(
            transform, stamp, self._frames.world_frame, self._frames.object_frame)]))

    def _publish_footprint(self, scene: EstimatedScene, stamp: Time) -> None:
        vertices = robot_footprint(self._robot)
        if scene.is_pushing:
            vertices = pushing_footprint(self._robot, self._object, scene.robot_pose,
                                         scene.estimate.pose)
        self._footprint.publish(to_footprint_message(vertices, stamp, self._frames.base_frame))

    def _draw(self, scene: EstimatedScene, stamp: Time) -> None:
        header = self._header('controller', stamp)
        drawn = [scene_markers(header, self._object, self._robot, scene.estimate.pose,
                               scene.robot_pose, color=BELIEVED),
                 estimate_markers(header, self._object, scene.estimate)]
        if scene.text:
            drawn.append(text_markers(header, scene.robot_pose, scene.text))
        self._markers.publish(_joined(drawn))

    def _draw_plan(self, stamp: Time) -> None:
        header = self._header('plan', stamp)
        # The topic keeps one message for displays that come later: it erases and draws all.
        drawn = [erased(header)]
        if self._goal is not None:
            drawn.append(goal_markers(header._replace(namespace='goal'), self._object, self._goal))
        if self._plan is not None:
            drawn.append(plan_markers(header, self._plan))
        self._plan_markers.publish(_joined(drawn))

    def _header(self, namespace: str, stamp: Time) -> MarkerHeader:
        return MarkerHeader(stamp, self._frames.world_frame, namespace)


def _joined(arrays: list[Any]) -> MarkerArray:
    return MarkerArray(markers=[marker for array in arrays for marker in array.markers])
