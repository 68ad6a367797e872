"""Topics and services of the nodes: the one list from which nodes and documentation are made."""

from typing import Any, NamedTuple

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import (
    PolygonStamped, PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped, WrenchStamped,
)
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from push_ros import qos
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, LaserScan
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import MarkerArray

PLANNER = 'push_planner'
CONTROLLER = 'push_controller'
SIM = 'push_sim'
TRACKER = 'push_tracker'
TIDY = 'push_tidy'
MOCAP = 'mocap_odometry'
TAG_DETECTOR = 'tag_detector'


# Longest message whose parts are read one by one [bytes]; chosen: a plan of 40 m with the default
# spacing of samples, which is read in 0.3 s.
MAX_LIST = 1_000_000


class Topic(NamedTuple):
    """
    A topic.

    :param type: message type.
    :param publishers: names of the nodes that publish it.
    :param subscribers: names of the nodes that subscribe to it.
    :param publish_qos: quality of service that is offered.
    :param subscribe_qos: quality of service that is asked for.
    :param description: what it carries.
    :param is_global: whether all robots share it, whatever the namespace of the node.
    :param largest_size: length of a message [bytes] above which nodes read no more than its
        header; None where all are read, as they are read quickly.
    :param is_optional: whether nodes have it only where their settings ask for it.
    """

    type: type[Any]
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]
    publish_qos: QoSProfile
    subscribe_qos: QoSProfile
    description: str
    is_global: bool = False
    largest_size: int | None = None
    is_optional: bool = False

    def message_type(self, stamped: bool = True, *, with_covariance: bool = False) -> 'type[Any]':
        """
        Return the type of the messages.

        :param stamped: value of ``enable_stamped_cmd_vel``; commands have two types.
        :param with_covariance: value of ``object_pose_with_covariance``; poses have two types.
        """
        if self.type is TwistStamped and not stamped:
            return Twist
        if self.type is PoseStamped and with_covariance:
            return PoseWithCovarianceStamped
        return self.type


class Service(NamedTuple):
    """
    A service.

    :param type: service type.
    :param node: name of the node that offers it.
    :param description: what it does.
    """

    type: type[Any]
    node: str
    description: str


def topic_of_object(topic: str, object_name: str) -> str:
    """
    Name the topic of one of several objects.

    :param topic: its name in the list.
    :param object_name: of the object; empty where there is but one.
    """
    return f'objects/{object_name}/{topic}' if object_name else topic


def interface_name(kind: type) -> str:
    """
    Name a message or service type as ``ros2 interface`` does.

    :param kind: the class.
    """
    package, folder = kind.__module__.split('.')[:2]
    return f'{package}/{folder}/{kind.__name__}'


TOPICS = {
    'odom': Topic(Odometry, (SIM, MOCAP), (PLANNER, CONTROLLER, TIDY), qos.MEASUREMENT, qos.SENSOR,
                  'robot pose in the world frame, velocity in robot axes'),
    'object_pose': Topic(PoseStamped, (SIM, TRACKER, TAG_DETECTOR),
                         (PLANNER, CONTROLLER, TIDY),
                         qos.MEASUREMENT, qos.SENSOR,
                         'measured object pose; PoseWithCovarianceStamped with '
                         'object_pose_with_covariance; of several objects '
                         'objects/NAME/object_pose each'),
    'scan': Topic(LaserScan, (SIM,), (CONTROLLER,), qos.MEASUREMENT, qos.SENSOR,
                  "scan of the robot's lidar, with place.source scan", is_optional=True),
    'image_raw': Topic(Image, (SIM,), (TAG_DETECTOR,), qos.IMAGE, qos.NEWEST,
                       'image (rgb8) of the simulator mujoco_sim, or mono8, rgb8 or bgr8 of a '
                       'camera', is_optional=True),
    'image_raw/compressed': Topic(CompressedImage, (), (TAG_DETECTOR,), qos.IMAGE, qos.NEWEST,
                                  'the same as JPEG or PNG, with compressed', is_optional=True),
    'camera_info': Topic(CameraInfo, (SIM,), (TAG_DETECTOR,), qos.IMAGE, qos.SENSOR,
                         'intrinsics of its camera, with each image', is_optional=True),
    'bumper': Topic(Bool, (SIM,), (CONTROLLER,), qos.EVENT, qos.SENSOR,
                    "whether the switch of the robot's bumper is closed", is_optional=True),
    'place': Topic(PoseWithCovarianceStamped, (), (CONTROLLER,), qos.MEASUREMENT, qos.SENSOR,
                   'place of the robot in the map, as of AMCL or slam_toolbox, with place.source '
                   'place', is_optional=True),
    'robot_pose': Topic(PoseStamped, (), (MOCAP,), qos.MEASUREMENT, qos.SENSOR,
                        'pose of the rigid body on the robot, as motion capture has it'),
    'goal_pose': Topic(PoseStamped, (), (CONTROLLER,), qos.EVENT, qos.EVENT,
                       "goal pose of the object; RViz's 2D Goal Pose"),
    'room_map': Topic(OccupancyGrid, (), (TIDY,), qos.LATCHED, qos.LATCHED,
                      'free floor of a room without its objects'),
    'map': Topic(OccupancyGrid, (TIDY,), (PLANNER, CONTROLLER), qos.LATCHED, qos.LATCHED,
                 'free floor of a task; everything outside is an obstacle'),
    'push_request': Topic(
        JointTrajectory, (CONTROLLER,), (PLANNER,), qos.LATCHED, qos.LATCHED,
        'request for a plan, as push_ros/conversions/plan_request.py writes it',
        largest_size=MAX_LIST),
    'push_plan': Topic(
        JointTrajectory, (PLANNER,), (CONTROLLER,), qos.LATCHED, qos.LATCHED,
        'plan of one push, or why there is none; at most 1 MB', largest_size=MAX_LIST),
    'planned_path': Topic(Path, (PLANNER,), (), qos.LATCHED, qos.LATCHED,
                          'planned path of the object, in a map through all remaining pushes'),
    'cmd_vel': Topic(TwistStamped, (CONTROLLER,), (SIM,), qos.COMMAND, qos.LATEST_COMMAND,
                     'velocity in robot axes; Twist without enable_stamped_cmd_vel'),
    'contact_wrench': Topic(WrenchStamped, (SIM,), (), qos.MEASUREMENT, qos.SENSOR,
                            'true force of the robot on the object, axes of the object frame'),
    'clock': Topic(Clock, (SIM,), (), qos.CLOCK, qos.CLOCK,
                   'simulated time, on /clock',
                   is_global=True),
    'initialpose': Topic(PoseWithCovarianceStamped, (), (SIM,), qos.EVENT, qos.EVENT,
                         "object pose to start over from; RViz's 2D Pose Estimate"),
    'markers': Topic(MarkerArray, (CONTROLLER, SIM), (), qos.EVENT, qos.EVENT,
                     'object, robot, contact, friction cone, plan'),
    'plan_markers': Topic(MarkerArray, (CONTROLLER,), (), qos.LATCHED, qos.LATCHED,
                          'the plan, and the object at its goal'),
    'planning_markers': Topic(MarkerArray, (PLANNER,), (), qos.LATCHED, qos.LATCHED,
                              'planned pushes as numbered ghosts of the object, or what stands '
                              'against a plan'),
    'footprint': Topic(PolygonStamped, (CONTROLLER,), (), qos.EVENT, qos.EVENT,
                       'outline of the robot, and of an object that it pushes'),
    'diagnostics': Topic(DiagnosticArray,
                         (PLANNER, CONTROLLER, SIM, TRACKER, MOCAP, TIDY, TAG_DETECTOR), (),
                         qos.STATUS, qos.STATUS,
                         'state of each node, and why it stops, on /diagnostics',
                         is_global=True),
}

SERVICES = {
    'planner/replan': Service(Trigger, PLANNER,
                              'plan again to the last goal, from the present motion; followed '
                              'with accept_unrequested_plans'),
    'controller/start': Service(Trigger, CONTROLLER,
                                'lift a stop; follow the plan, or start the task'),
    'controller/stop': Service(Trigger, CONTROLLER, 'stop the robot, and refuse goals until '
                               'controller/start'),
    'controller/pause': Service(Trigger, CONTROLLER, 'in a task: stand until controller/resume'),
    'controller/resume': Service(Trigger, CONTROLLER,
                                 'continue the task, or after a stop of the base'),
    'sim/start': Service(Trigger, SIM, 'let simulated time run'),
    'sim/reset': Service(Trigger, SIM, 'return to the start and hold time'),
}
