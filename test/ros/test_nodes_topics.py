"""What a node waits for is named within two seconds: each node alone, over Fast DDS."""

from pathlib import Path
from types import SimpleNamespace

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TwistStamped
from helpers.architecture import ROOT
from helpers.build_interfaces import available
from helpers.node_bench import bench, REACTION_TIMEOUT
from nav_msgs.msg import OccupancyGrid, Odometry
from push_model.files.flat_values import to_parameter_values
from push_model.signals import ObjectPose, Odometry as MeasuredOdometry, STOP
from push_ros import topic_watch
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.primitives import to_pose_message
from push_ros.diagnostics import ERROR, OK, status_values, WARN
from push_ros.node import PushNode
from push_ros.qos import LATCHED
from push_ros.topic_watch import REPORT_TIME, TopicWatch
from push_ros.topics import CONTROLLER
from push_scenario.dds.private_network import private_domain
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

pytestmark = [pytest.mark.dds, pytest.mark.slow]

SCENARIO = read_scenario(find_scenario('straight_push'))
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
MODULE = 'push_control.controller_node'
INPUTS = f'{CONTROLLER}: inputs'
RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
# By when the node has to say so [s].
NAMED_WITHIN = 2.0
PERIOD = 0.05


class Robot:
    """A robot and an object that stand, of which some topics are as they should not be."""

    def __init__(self, b, odom='odom', object_pose='object_pose'):
        self.b = b
        b.subscribe('diagnostics')
        b.subscribe('push_request')
        self.measure_on(odom, object_pose)
        b.node.create_timer(PERIOD, self._measure)
        # A node that was never started before compiles for a minute.
        b.wait_until(lambda: any('waits for a goal' in status.message
                                 for status in self.statuses(CONTROLLER)))

    def measure_on(self, odom, object_pose):
        """Publish measurements on these topics from now on."""
        self._publishers = [self.b.node.create_publisher(Odometry, odom, 10),
                            self.b.node.create_publisher(PoseStamped, object_pose, 10)]

    def _measure(self):
        now = 1e-9 * self.b.node.get_clock().now().nanoseconds
        odometry, pose = self._publishers
        odometry.publish(to_odometry_message(MeasuredOdometry(now, ROBOT, STOP), 'odom',
                                             'base_link'))
        pose.publish(to_object_pose_message(ObjectPose(now, OBJECT), 'odom'))

    def statuses(self, name):
        """List what the node has reported under a name."""
        return [status for message in self.b.received['diagnostics']
                for status in message.status if status.name == name]

    def wait_for_inputs(self, *words):
        """Wait until the inputs are a warning with some words; return the values of the first."""
        def naming():
            return [status for status in self.statuses(INPUTS) if status.level == WARN
                    and all(word in status.message for word in words)]
        self.b.wait_until(naming, REACTION_TIMEOUT)
        return status_values(naming()[0])

    def give_goal(self):
        """Give the goal."""
        goal = PoseStamped(pose=to_pose_message(GOAL))
        goal.header.frame_id = 'odom'
        self.b.publish('goal_pose', goal)


def controller(folder, **parameters):
    """Start a controller."""
    return bench(folder, CONTROLLER, MODULE, {**PHYSICS, **parameters})


def test_a_setting_without_effect_is_named_once_in_the_log(tmp_path):
    """Of another law than the chosen one; settings that count are not named."""
    settings = {'control.horizon_steps': 30, 'control.lateral_gain': 15.0}
    with controller(tmp_path, task=False, **settings) as b:
        b.subscribe('diagnostics')
        b.wait_until(lambda: any('waits for a goal' in status.message
                                 for message in b.received['diagnostics']
                                 for status in message.status))
    log = (tmp_path / f'{CONTROLLER}.log').read_text()
    assert log.count('set without effect') == 1
    assert 'control.horizon_steps: set without effect, as control.control_law is feedback' in log


def test_a_wait_is_named_in_time_and_not_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the first look after a second, on a clock that is played here."""
    times = [topic_watch.PERIOD * look for look in range(20)]
    named: list[float] = []
    with private_domain() as domain:
        rclpy.init(args=[], domain_id=domain)
        try:
            node = PushNode('waits', ())
            node.subscribe('odom', print)
            watch = TopicWatch(node, lambda: ['odom'])
            for now in times:
                monkeypatch.setattr(topic_watch, 'time', SimpleNamespace(monotonic=lambda: now))
                watch.check()
                if watch.text == 'waits for odom':
                    named.append(now)
            node.destroy_node()
        finally:
            rclpy.shutdown()
    assert named == [now for now in times if now >= REPORT_TIME] and named[0] < NAMED_WITHIN


@pytest.mark.parametrize('topic, task', [('odom', False), ('object_pose', True)])
def test_a_misspelt_topic_and_an_absent_planner_are_named(tmp_path: Path, topic: str,
                                                          task: bool) -> None:
    """
    Since when, and that nobody publishes it; with the next message that is over.

    What may be meant is named. A planner is missed from a second after the request on.
    """
    with controller(tmp_path, task=task) as b:
        robot = Robot(b, **{topic: f'{topic}s'})
        values = robot.wait_for_inputs(f'waits for /{topic}: 0 publishers', f'/{topic}s would')
        assert float(values[f'{topic}.since']) >= REPORT_TIME
        assert values[f'{topic}.publishers'] == '0'
        robot.measure_on('odom', 'object_pose')
        b.wait_until(lambda: robot.statuses(INPUTS)[-1].level == OK)
        robot.give_goal()
        b.wait_until(lambda: b.received['push_request'])
        values = robot.wait_for_inputs('waits for /push_plan: 0 publishers')
        assert float(values['push_plan.since']) >= REPORT_TIME
    log = (tmp_path / f'{CONTROLLER}.log').read_text()
    assert log.count(f'waits for /{topic}: 0 publishers; /{topic}s would have') == 1


UNREACHABLE = [
    ('odom', TwistStamped, 10,
     ('1 publisher: /bench publishes geometry_msgs/msg/TwistStamped, expected nav_msgs',)),
    ('object_pose', PoseWithCovarianceStamped, 10,
     ('publishes geometry_msgs/msg/PoseWithCovarianceStamped, expected geometry_msgs/msg/Pose',)),
    ('goal_pose', PoseStamped, QoSProfile(depth=10, reliability=BEST_EFFORT),
     ('/goal_pose: 1 publisher: /bench offers', 'Best effort publisher and reliable')),
    ('map', OccupancyGrid, QoSProfile(depth=1, reliability=RELIABLE,
                                      durability=DurabilityPolicy.VOLATILE),
     ('/map: 1 publisher: /bench offers', 'olatile publisher and transient local'))]


def test_publishers_that_cannot_reach_the_node_are_named(tmp_path):
    """Each with its type or quality of service, and what is expected."""
    with controller(tmp_path, task=True) as b:
        robot = Robot(b, 'not_odom', 'not_object_pose')
        for topic, kind, qos, _ in UNREACHABLE:
            b.node.create_publisher(kind, topic, qos)
        for topic, _, _, words in UNREACHABLE:
            values = robot.wait_for_inputs(*words)
            assert values[f'{topic}.publishers'] == '1'


def test_a_task_that_needs_a_map_stands_and_names_it(tmp_path):
    """No plan is requested meanwhile."""
    with controller(tmp_path, task=True, map_required=True) as b:
        robot = Robot(b)
        robot.give_goal()
        assert robot.wait_for_inputs('waits for /map: 0 publishers')['map.publishers'] == '0'
        b.wait_until(lambda: any('no map has come' in status.message
                                 for status in robot.statuses(CONTROLLER)))
        assert not b.received['push_request']


def test_a_single_push_ends_where_the_planner_does_not_answer(tmp_path):
    """After ``plan_timeout``, with the reason; another goal is requested."""
    with controller(tmp_path, **{'supervision.plan_timeout': 2.0}) as b:
        robot = Robot(b)
        log = tmp_path / f'{CONTROLLER}.log'
        reason = 'no plan within 2 s: the subscriber of /push_request does not answer'
        for count in (1, 2):
            robot.give_goal()
            b.wait_until(lambda: log.read_text().count(reason) >= count)
            b.wait_until(lambda: len(b.received['push_request']) >= count)
            b.received['diagnostics'].clear()
            b.wait_until(lambda: any(
                status.level == ERROR for status in robot.statuses(CONTROLLER)))


@pytest.mark.parametrize('task', [False, True])
def test_a_status_comes_from_activation_on(tmp_path, task):
    """Without any measurement, and it says what the node waits for."""
    with available(ROOT / 'push_control_msgs'), controller(tmp_path, task=task) as b:
        from push_control_msgs.msg import PushStatus
        statuses = []
        b.node.create_subscription(PushStatus, 'push_status', statuses.append, LATCHED)
        b.wait_until(lambda: statuses and 'waits for odom and object_pose' in statuses[-1].text)
        assert statuses[-1].state == PushStatus.IDLE
