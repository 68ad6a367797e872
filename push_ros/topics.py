"""Topics and services of the nodes: the one list from which nodes and README are made."""

from typing import NamedTuple

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import (
    PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped, WrenchStamped,
)
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from push_ros import qos
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory
from visualization_msgs.msg import MarkerArray

PLANNER, CONTROLLER, SIM = 'push_planner', 'push_controller', 'push_sim'


class Topic(NamedTuple):
    """
    A topic.

    :param type: message type.
    :param publishers: names of the nodes that publish it.
    :param subscribers: names of the nodes that subscribe to it.
    :param publish_qos: quality of service that is offered.
    :param subscribe_qos: quality of service that is asked for.
    :param description: what it carries.
    """

    type: type
    publishers: tuple
    subscribers: tuple
    publish_qos: object
    subscribe_qos: object
    description: str

    def message_type(self, stamped=True):
        """
        Type of the messages.

        :param stamped: what ``stamped_cmd_vel`` says; only commands have two types.
        """
        return Twist if self.type is TwistStamped and not stamped else self.type


TOPICS = {
    'odom': Topic(Odometry, (SIM,), (PLANNER, CONTROLLER), qos.MEASUREMENT, qos.SENSOR,
                  'robot pose in the world frame, velocity in its own axes'),
    'object_pose': Topic(PoseStamped, (SIM,), (PLANNER, CONTROLLER), qos.MEASUREMENT, qos.SENSOR,
                         'measured object pose in the world frame'),
    'goal_pose': Topic(PoseStamped, (), (PLANNER, CONTROLLER), qos.EVENT, qos.EVENT,
                       "wanted object pose; RViz's 2D Goal Pose"),
    'map': Topic(OccupancyGrid, (), (PLANNER, CONTROLLER), qos.LATCHED, qos.LATCHED,
                 'floor that object and robot keep to in a task; unknown cells and those of 50 or '
                 'more are obstacles, as is all outside; latched'),
    'push_request': Topic(
        JointTrajectory, (CONTROLLER,), (PLANNER,), qos.LATCHED, qos.LATCHED,
        'in a task: request for a plan, one point whose joint names say what each number is: x, y '
        'and heading of object, robot and goal (object.x to goal.heading), the identified centre '
        'of friction in the object frame (friction_center.x, friction_center.y), and the fraction '
        'of the friction cone that the plan should use (cone_fraction); latched'),
    'push_plan': Topic(MultiDOFJointTrajectory, (PLANNER,), (CONTROLLER,), qos.LATCHED,
                       qos.LATCHED, 'plan: joints object, contact and robot over time; the answer '
                       'to a request has its stamp, and no points where there is no plan; '
                       'latched'),
    'planned_path': Topic(Path, (PLANNER,), (), qos.LATCHED, qos.LATCHED,
                          'way of the object in the plan, through all pushes of a chain, for '
                          'viewers; latched'),
    'cmd_vel': Topic(TwistStamped, (CONTROLLER,), (SIM,), qos.COMMAND, qos.LATEST_COMMAND,
                     'velocity command in the axes of the robot, stamped with the measurement '
                     'that it answers; Twist where stamped_cmd_vel is false'),
    'contact_wrench': Topic(WrenchStamped, (SIM,), (), qos.MEASUREMENT, qos.SENSOR,
                            'true force of the robot on the object, axes of the object frame'),
    'clock': Topic(Clock, (SIM,), (), qos.CLOCK, qos.CLOCK,
                   'simulated time, where the simulator owns it'),
    'initialpose': Topic(PoseWithCovarianceStamped, (), (SIM,), qos.EVENT, qos.EVENT,
                         "puts the object there and starts over; RViz's 2D Pose Estimate"),
    'markers': Topic(MarkerArray, (CONTROLLER, SIM), (), qos.EVENT, qos.EVENT,
                     'object, robot, supports, contact, friction cone, plan, for RViz, Foxglove'),
    'diagnostics': Topic(DiagnosticArray, (PLANNER, CONTROLLER, SIM), (), qos.EVENT, qos.EVENT,
                         'what each node does, and why not'),
}

SERVICES = {
    'planner/replan': (Trigger, PLANNER, 'plan anew to the last goal, from the present '
                       'motion'),
    'controller/start': (Trigger, CONTROLLER, 'follow the plan, or begin the task, from now on'),
    'controller/stop': (Trigger, CONTROLLER, 'stop the robot and stay stopped'),
    'controller/pause': (Trigger, CONTROLLER, 'in a task: stand until controller/resume'),
    'controller/resume': (Trigger, CONTROLLER, 'go on with the task'),
    'sim/start': (Trigger, SIM, 'let simulated time run'),
    'sim/reset': (Trigger, SIM, 'put everything back to the start and hold time there'),
}
