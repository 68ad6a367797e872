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
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory
from visualization_msgs.msg import MarkerArray

PLANNER = 'push_planner'
CONTROLLER = 'push_controller'
SIM = 'push_sim'
TRACKER = 'push_tracker'


# Longest message whose parts are read one by one [bytes]; chosen: a plan of 40 m with the default
# spacing of samples, which is read in 0.3 s.
LARGEST_LIST = 1_000_000


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
    """

    type: type[Any]
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]
    publish_qos: QoSProfile
    subscribe_qos: QoSProfile
    description: str
    is_global: bool = False
    largest_size: int | None = None

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


def interface_name(kind: type) -> str:
    """
    Name a message or service type as ``ros2 interface`` does.

    :param kind: the class.
    """
    package, folder = kind.__module__.split('.')[:2]
    return f'{package}/{folder}/{kind.__name__}'


TOPICS = {
    'odom': Topic(Odometry, (SIM,), (PLANNER, CONTROLLER), qos.MEASUREMENT, qos.SENSOR,
                  'robot pose in the world frame with its covariance where that is stated, '
                  'velocity in its own axes'),
    'object_pose': Topic(PoseStamped, (SIM, TRACKER), (PLANNER, CONTROLLER), qos.MEASUREMENT,
                         qos.SENSOR,
                         'measured object pose in the world frame, or in one with a transform to '
                         'it; PoseWithCovarianceStamped where object_pose_with_covariance is '
                         'true'),
    'goal_pose': Topic(PoseStamped, (), (CONTROLLER,), qos.EVENT, qos.EVENT,
                       "goal pose of the object; RViz's 2D Goal Pose"),
    'map': Topic(OccupancyGrid, (), (PLANNER, CONTROLLER), qos.LATCHED, qos.LATCHED,
                 'free floor for object and robot in a task; map.* says which cells are '
                 'obstacles, everything outside is one; latched'),
    'push_request': Topic(
        JointTrajectory, (CONTROLLER,), (PLANNER,), qos.LATCHED, qos.LATCHED,
        'request for a plan, one point whose joint names say what each number is: x, y '
        'and heading of object, robot and goal (object.x to goal.heading), the parameters of the '
        'object as they are called in ROS, with friction as identified (object.mass, '
        'object.outline.0 and so on), the fraction of the friction cone that the plan should use '
        '(cone_fraction), the tolerances of the goal (position_tolerance, heading_tolerance), and '
        "standard deviations of what is known: robot_deviation of the robot's place, "
        'center_deviation of the centre of friction, contact_friction_deviation, and '
        'odometry_slope and odometry_drift, by which the first grows per distance; latched',
        largest_size=LARGEST_LIST),
    'push_plan': Topic(
        MultiDOFJointTrajectory, (PLANNER,), (CONTROLLER,), qos.LATCHED, qos.LATCHED,
        'plan: joints object, contact and robot over time; the second is called free_contact '
        'where the push is not steered, so that the contact may roll and slide; the answer to a '
        'request has its stamp; where there is no plan it has no points, and the code of the '
        'reason for its only joint name; at most 1 MB; latched', largest_size=LARGEST_LIST),
    'planned_path': Topic(Path, (PLANNER,), (), qos.LATCHED, qos.LATCHED,
                          'path of the object in the plan, through all pushes of a sequence, '
                          'for viewers; latched'),
    'cmd_vel': Topic(TwistStamped, (CONTROLLER,), (SIM,), qos.COMMAND, qos.LATEST_COMMAND,
                     'velocity command in the axes of the robot, while the controller drives it: '
                     'then some zeros, then nothing; in lockstep one for each measurement, with '
                     'its stamp; Twist where enable_stamped_cmd_vel is false'),
    'contact_wrench': Topic(WrenchStamped, (SIM,), (), qos.MEASUREMENT, qos.SENSOR,
                            'true force of the robot on the object, axes of the object frame'),
    'clock': Topic(Clock, (SIM,), (), qos.CLOCK, qos.CLOCK,
                   'simulated time, where the simulator owns it; on /clock in every namespace',
                   is_global=True),
    'initialpose': Topic(PoseWithCovarianceStamped, (), (SIM,), qos.EVENT, qos.EVENT,
                         "puts the object there and starts over; RViz's 2D Pose Estimate"),
    'markers': Topic(MarkerArray, (CONTROLLER, SIM), (), qos.EVENT, qos.EVENT,
                     'object, robot, supports, contact, friction cone, plan, for RViz, Foxglove'),
    'plan_markers': Topic(MarkerArray, (CONTROLLER,), (), qos.LATCHED, qos.LATCHED,
                          'the plan, and a ghost of the object at its goal; latched, so that a '
                          'display that is started later draws them too'),
    'footprint': Topic(PolygonStamped, (CONTROLLER,), (), qos.EVENT, qos.EVENT,
                       'outline of all that moves with the robot, in its frame: of the robot, and '
                       'while it pushes of the object too, for collision monitors'),
    'diagnostics': Topic(DiagnosticArray, (PLANNER, CONTROLLER, SIM, TRACKER), (), qos.STATUS,
                         qos.STATUS,
                         'what each node does, and why not; on /diagnostics in every namespace',
                         is_global=True),
}

SERVICES = {
    'planner/replan': Service(Trigger, PLANNER,
                              'plan again to the last goal, from the present motion'),
    'controller/start': Service(Trigger, CONTROLLER,
                                'follow the plan, or start the task, from now on'),
    'controller/stop': Service(Trigger, CONTROLLER, 'stop the robot, until controller/start'),
    'controller/pause': Service(Trigger, CONTROLLER, 'in a task: stand until controller/resume'),
    'controller/resume': Service(Trigger, CONTROLLER, 'go on with the task'),
    'sim/start': Service(Trigger, SIM, 'let simulated time run'),
    'sim/reset': Service(Trigger, SIM, 'put everything back to the start and hold time there'),
}
