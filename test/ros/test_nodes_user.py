"""What a user of ROS 2 does with controller and planner, over Fast DDS and on the wall clock."""

import itertools
import signal
import subprocess
import sys
import time

from geometry_msgs.msg import PoseStamped
from helpers.node_bench import bench, REACTION_TIMEOUT, TIMEOUT
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from push_control.ros.commands import STOP_COMMANDS
from push_model.files.data import config_file
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.plan_request import from_request_message
from push_ros.conversions.primitives import (
    from_pose_message, seconds, to_pose_message, to_stamp,
)
from push_ros.diagnostics import ERROR, OK, status_values
from push_ros.parameters import DYNAMIC, IDLE, READ_ONLY
from push_ros.start import NODES
from push_ros.topics import CONTROLLER, PLANNER
from push_scenario.dds.private_network import private_environment
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest
from rcl_interfaces.msg import Log, Parameter as ParameterMessage
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile

pytestmark = [pytest.mark.dds, pytest.mark.slow]

SCENARIO = read_scenario(find_scenario('straight_push'))
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
ROSOUT = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
NUMBERS = itertools.count()
# Times after its first instructions at which a node is interrupted [s].
DELAYS = (0.0, 0.8, 2.4)
# Where a process says which signals it handles, as a hexadecimal mask.
HANDLED_SIGNALS = 'SigCgt:'


class Setup:
    """Controller and planner, and a robot that stands where the push begins."""

    def __init__(self, b):
        self.b = b
        for topic in ('cmd_vel', 'push_request', 'push_plan', 'diagnostics'):
            b.subscribe(topic)
        self.log = []
        b.node.create_subscription(Log, '/rosout', self.log.append, ROSOUT)
        b.wait_until(lambda: {status.name for status in self.statuses()} >= {CONTROLLER, PLANNER})
        for node in (CONTROLLER, PLANNER):
            # A transition that was made is refused the second time: no answer may be lost.
            b.client(ChangeState, f'{node}/change_state')

    def statuses(self):
        """List what was reported."""
        return [status for message in self.b.received['diagnostics'] for status in message.status]

    def levels(self, text):
        """List the levels of the reports with a text."""
        return [status.level for status in self.statuses() if text in status.message]

    def answers(self):
        """List the plans that answer the last request."""
        return [plan for plan in self.b.received['push_plan']
                for request in self.b.received['push_request'][-1:]
                if plan.header.stamp == request.header.stamp]

    def measure(self):
        """Publish what is measured now, and let the nodes answer."""
        now = time.time()
        self.b.publish('object_pose', to_object_pose_message(ObjectPose(now, OBJECT), 'odom'))
        self.b.publish('odom', to_odometry_message(Odometry(now, ROBOT, STOP), 'odom',
                                                   'base_link'))
        self.b.spin(0.02)

    def measure_until(self, condition):
        """Publish measurements until a condition holds."""
        self.b.repeat_until(self.measure, condition, period=0.0)

    def publish_once(self, message):
        """Publish a goal as ``ros2 topic pub --once`` does: to the first subscriber it meets."""
        publisher = self.b.node.create_publisher(PoseStamped, 'goal_pose', 10)
        self.b.wait_until(publisher.get_subscription_count)
        publisher.publish(message)
        publisher.wait_for_all_acked(Duration(seconds=TIMEOUT))
        self.b.node.destroy_publisher(publisher)

    def change_state(self, node, transition):
        """Trigger a transition; return whether it was done."""
        return self.b.request(ChangeState, f'{node}/change_state', ChangeState.Request(
            transition=Transition(id=transition))).success

    def state(self, node):
        """Return the id of the state of a node."""
        return self.b.request(GetState, f'{node}/get_state', GetState.Request()).current_state.id

    def set_parameter(self, node, name, value):
        """Set a parameter; return whether it was set, and why not."""
        parameter = Parameter(name, value=value)
        result, = self.b.request(SetParameters, f'{node}/set_parameters', SetParameters.Request(
            parameters=[ParameterMessage(name=name, value=parameter.get_parameter_value())])
        ).results
        return result

    def forget(self):
        """Forget what has come so far, and is still on its way."""
        self.b.wait_for_silence('cmd_vel', 'push_request', 'push_plan')
        for messages in self.b.received.values():
            messages.clear()


@pytest.fixture(scope='module')
def setup(tmp_path_factory):
    """Start both nodes; a parameter of somebody else lies in their files."""
    folder = tmp_path_factory.mktemp('user')
    parameters = {**PHYSICS, 'robot_description': '<robot/>'}
    with bench(folder, CONTROLLER, 'push_control.controller_node', parameters) as b:
        b.start(PLANNER, 'push_planner.planner_node', parameters)
        yield Setup(b)


def goal(ahead=0.0):
    """Make a goal whose stamp is ahead of the clock, beside the last: one repeated is no news."""
    message = PoseStamped(pose=to_pose_message(GOAL @ Pose(1e-3 * next(NUMBERS), 0.0, 0.0)))
    message.header.frame_id, message.header.stamp = 'odom', to_stamp(time.time() + ahead)
    return message


def speeds(setup):
    """List the commanded speeds."""
    return [command.twist.linear.x for command in setup.b.received['cmd_vel']]


def push(setup):
    """Let a push begin; the robot of the test does not move, so that it fails after a while."""
    setup.forget()
    setup.publish_once(goal())
    setup.measure_until(lambda: any(speed > 0.0 for speed in speeds(setup)))


def test_a_foreign_parameter_is_a_warning(setup):
    """It may be meant for others; the node names it, and goes on without it."""
    text = 'robot_description: got parameters that this node does not have'
    setup.b.wait_until(lambda: {entry.name for entry in setup.log
                                if entry.msg.startswith(text)} >= {CONTROLLER, PLANNER})


def test_an_idle_controller_is_silent(setup):
    """Measurements come, and nobody wants anything: others may drive the robot."""
    for _ in range(30):
        setup.measure()
    assert setup.b.received['cmd_vel'] == []


def test_a_goal_that_is_published_once_arrives(setup):
    """Although the clock of the publisher is ahead; the plan comes, and the robot pushes."""
    setup.b.wait_until(lambda: setup.b.node.count_subscribers('goal_pose') == 1)
    sent = goal(ahead=1000.0)
    setup.publish_once(sent)
    setup.measure_until(lambda: any(speed > 0.0 for speed in speeds(setup)))
    # Requested again where odometry has paused, or the planner compiles for long.
    for request in setup.b.received['push_request']:
        assert from_request_message(request, 'odom').goal == pytest.approx(
            from_pose_message(sent.pose, 'goal_pose'))
    assert plan_failure(setup.b.received['push_plan'][0]) is None
    setup.b.wait_until(lambda: any('its stamp is ' in entry.msg and 's ahead of' in entry.msg
                                   for entry in setup.log))
    command = setup.b.received['cmd_vel'][-1]
    assert abs(seconds(command.header.stamp) - time.time()) < 500.0


def test_diagnostics_are_for_people_and_programs(setup):
    """Values have units in their names; stamps are fresh, and levels fit."""
    push(setup)

    def driven():
        """List the reports of steps, which know their error; a change of state may come first."""
        return [status for status in setup.statuses() if status.message == 'task: push'
                and float(status_values(status)['push.position_error']) > 0.5]
    setup.measure_until(driven)
    first = driven()[0]
    assert first.level == OK
    assert 'push.position_error [m]' in {item.key for item in first.values}
    assert abs(seconds(setup.b.received['diagnostics'][-1].header.stamp) - time.time()) < 500.0


def test_lost_odometry_stops_the_robot(setup):
    """With some zeros, then silence; odometry that stays away is an error."""
    push(setup)
    setup.b.wait_until(lambda: ERROR in setup.levels('no odometry'), REACTION_TIMEOUT)
    setup.b.wait_until(lambda: speeds(setup)[-STOP_COMMANDS:] == [0.0] * STOP_COMMANDS,
                       REACTION_TIMEOUT)
    setup.b.wait_for_silence('cmd_vel')
    assert speeds(setup)[-STOP_COMMANDS:] == [0.0] * STOP_COMMANDS


def test_dynamic_parameters_may_be_set(setup):
    """Speeds, tolerances and gains may be set, whole numbers too; what a node is made with not."""
    assert setup.set_parameter(CONTROLLER, 'drive.speed', 0.2).successful
    assert setup.set_parameter(CONTROLLER, 'control.lateral_gain', 12).successful
    assert setup.set_parameter(PLANNER, 'planner.pushing_speed', 0.1).successful
    for name, value, reason in (('drive.speed', -1.0, 'drive.speed'),
                                ('control.control_law', 'magic', "got 'magic', expected one of"),
                                ('robot.radius', 0.2, 'read-only'),
                                ('control.pose_noise', 0.01, 'read-only')):
        refused = setup.set_parameter(CONTROLLER, name, value)
        assert not refused.successful and reason in refused.reason
    described = setup.b.request(
        DescribeParameters, f'{CONTROLLER}/describe_parameters',
        DescribeParameters.Request(names=['drive.speed', 'object.mass', 'robot.radius']))
    speed, mass, radius = described.descriptors
    assert DYNAMIC in speed.additional_constraints and not speed.read_only
    assert IDLE in mass.additional_constraints and not mass.read_only
    assert READ_ONLY in radius.additional_constraints and radius.read_only
    setup.forget()
    setup.publish_once(goal())
    setup.measure_until(setup.answers)
    first, second = from_plan_message(setup.answers()[0], 'odom').object_twists[1:3, 0]
    assert 0.05 < second < 0.105 and first < 0.105


def test_an_inactive_controller_stops_the_robot_and_is_silent(setup):
    """Whatever comes; what is impossible is refused, and the node lives on."""
    assert setup.state(CONTROLLER) == State.PRIMARY_STATE_ACTIVE
    push(setup)
    assert setup.change_state(CONTROLLER, Transition.TRANSITION_DEACTIVATE)
    setup.b.wait_until(lambda: speeds(setup)[-STOP_COMMANDS:] == [0.0] * STOP_COMMANDS,
                       REACTION_TIMEOUT)
    setup.forget()
    for _ in range(20):
        setup.measure()
    assert setup.b.received['cmd_vel'] == setup.b.received['push_request'] == []
    refused = setup.b.call('controller/start')
    assert not refused.success and 'inactive' in refused.message
    assert not setup.change_state(CONTROLLER, Transition.TRANSITION_CONFIGURE)
    for transition in (Transition.TRANSITION_CLEANUP, Transition.TRANSITION_CONFIGURE,
                       Transition.TRANSITION_ACTIVATE):
        assert setup.change_state(CONTROLLER, transition)
    push(setup)


def test_an_inactive_planner_plans_nothing(setup):
    """A request that it has missed is answered when it is active again."""
    assert setup.change_state(PLANNER, Transition.TRANSITION_DEACTIVATE)
    setup.forget()
    setup.publish_once(goal())
    setup.measure_until(lambda: setup.b.received['push_request'])
    for _ in range(20):
        setup.measure()
    assert setup.b.received['push_plan'] == []
    assert setup.change_state(PLANNER, Transition.TRANSITION_ACTIVATE)
    setup.measure_until(lambda: setup.b.received['push_plan'])


def test_a_refusal_is_on_rosout_and_in_the_exit_status(setup):
    """A parameter that a group of the node does not have, by its name."""
    environment = private_environment(setup.b.processes.domain)
    command = [sys.executable, '-m', 'push_ros.start', 'controller', '--ros-args', '-r',
               '__node:=mistaken', '--params-file', str(config_file('push.yaml')), '-p',
               'robot.radios:=0.2']

    def is_logged():
        said = [entry.msg for entry in setup.log if entry.name == 'mistaken']
        return (any('refused to start: robot.radios' in text for text in said)
                and any("its section '/**/push_controller' is ignored" in text for text in said))

    def refuse():
        process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
        setup.b.wait_until(lambda: process.poll() is not None)
        assert process.returncode == 2

    # A node waits a moment for readers of its log, which is too short where all cores are busy.
    setup.b.repeat_until(refuse, is_logged, period=1.0)


# The tracker starts only where tf2_msgs is installed; the page has one port.
@pytest.mark.parametrize('name', [name for name in NODES if name not in ('tf_tracker', 'view')])
def test_a_node_that_is_interrupted_ends_well(name):
    """At any time from its start on, while it imports and compiles: status 0, no traceback."""
    command = [sys.executable, '-m', 'push_ros.start', name, '--ros-args', '--params-file',
               str(config_file('push.yaml'))]
    environment = private_environment()
    started = [(delay, subprocess.Popen(command, stderr=subprocess.PIPE, text=True,
                                        env=environment)) for delay in DELAYS]
    for _, process in started:
        while not handles(process.pid, signal.SIGTERM):
            assert process.poll() is None
            time.sleep(0.01)
    start = time.monotonic()
    for number, (delay, process) in zip(itertools.cycle((signal.SIGINT, signal.SIGTERM)), started):
        time.sleep(max(0.0, start + delay - time.monotonic()))
        process.send_signal(number)
    for delay, process in started:
        _, errors = process.communicate(timeout=TIMEOUT)
        assert process.returncode == 0, (delay, errors)
        assert 'Traceback' not in errors and 'Exception' not in errors


def handles(pid, number):
    """Tell whether a process handles a signal by itself."""
    with open(f'/proc/{pid}/status', encoding='ascii') as file:
        mask = next(line.split()[1] for line in file if line.startswith(HANDLED_SIGNALS))
    return bool(int(mask, 16) >> (number - 1) & 1)
