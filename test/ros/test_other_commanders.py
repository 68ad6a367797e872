"""Two controllers with the same base: the later one gives way, and neither fights the other."""

import contextlib
import time

from helpers.node_bench import REACTION_TIMEOUT
from push_control.controller_node import ControllerNode
from push_control.ros.commands import STOP_COMMANDS
from push_control.steered.status import Phase
from push_model.events import codes
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_planner.problem import problem_from_placement
from push_planner.steered.planner import plan_push
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.primitives import exact_stamp, NANOSECONDS
from push_ros.topics import CONTROLLER
from push_safety.status import SafetyReason
from push_scenario.dds.private_network import private_domain
from push_scenario.definition.loader import load_scenario
import pytest
import rclpy
import yaml

pytestmark = pytest.mark.dds

SCENARIO = load_scenario('straight_push')
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PERIOD = 0.02
# Wall time in which the nodes must meet [s]; no measure of speed.
TIMEOUT = 300.0


class Stage:
    """Two controllers, and the robot and the object that they share."""

    def __init__(self, first, second):
        self.nodes = first, second
        self.sent = {node: [] for node in self.nodes}
        for node in self.nodes:
            publish = node.controller._commands._publish

            def record(twist, stamp, node=node, publish=publish):
                self.sent[node].append(twist)
                publish(twist, stamp)
            node.controller._commands._publish = record
        self.time, self.pose, self.twist = 100.0, ROBOT, STOP

    def step(self, obeyed=None):
        """Measure once; the robot moves as one of the controllers commands, or not at all."""
        self.time += PERIOD
        for node in self.nodes:
            node.controller.on_odometry(to_odometry_message(
                Odometry(self.time, self.pose, self.twist), 'odom', 'base_link'))
            node.controller.on_object_pose(to_object_pose_message(
                ObjectPose(self.time, OBJECT), 'odom'))
        sent = self.sent.get(obeyed)
        command = sent[-1] if sent else STOP
        self.twist = Twist(*(a + 0.2 * (b - a) for a, b in zip(self.twist, command)))
        self.pose = self.pose @ Pose(*(PERIOD * value for value in self.twist))

    def plan(self, node):
        """Give one of them a plan from here."""
        problem = problem_from_placement(SCENARIO.object, SCENARIO.robot, OBJECT, ROBOT, GOAL,
                                         SCENARIO.planner)
        node.controller.on_plan(to_plan_message(
            plan_push(problem).trajectory, exact_stamp(round(self.time * NANOSECONDS)), 'odom'))

    def wait_until(self, condition, obeyed=None, timeout=REACTION_TIMEOUT):
        """Measure until something holds, in time for messages to come through."""
        end = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < end, [node.controller.pursuit.progress
                                            for node in self.nodes]
            self.step(obeyed)
            time.sleep(0.01)


@pytest.fixture
def stage(tmp_path):
    """Make both controllers, active, and let them meet."""
    path = tmp_path / 'controller.yaml'
    path.write_text(yaml.safe_dump({CONTROLLER: {'ros__parameters': {
        **to_parameter_values(SCENARIO.object, 'object.'),
        **to_parameter_values(SCENARIO.robot, 'robot.'), 'accept_unrequested_plans': True}}}))
    with private_domain() as domain, contextlib.ExitStack() as stack:
        rclpy.init(args=['--ros-args', '--params-file', str(path)], domain_id=domain)
        stack.callback(rclpy.shutdown)
        nodes = [ControllerNode() for _ in range(2)]
        for node in nodes:
            stack.callback(node.destroy_node)
            node.start()
            stack.callback(node.close)
        made = Stage(*nodes)

        def have_met():
            for node in nodes:
                node.controller._others._look()
            return all(node.controller._others.names == f'/{CONTROLLER}' for node in nodes)
        made.step()
        made.wait_until(have_met, timeout=TIMEOUT)
        yield made


def names_controller(node):
    """Tell whether a node says that another controller commands the base, too."""
    cause = node.controller.pursuit.progress.cause
    return (SafetyReason.COMMANDED_BY_OTHERS in codes(cause)
            and f'/{CONTROLLER}' in str(cause))


def test_the_later_one_yields_and_names_the_first(stage):
    """It sends nothing at all until the first has ended; who commands in spite stops both."""
    first, second = stage.nodes
    stage.plan(first)
    stage.wait_until(lambda: len(stage.sent[first]) > 20, first)
    stage.plan(second)
    stage.wait_until(
        lambda: names_controller(second), first)
    count = len(stage.sent[first])
    stage.wait_until(lambda: len(stage.sent[first]) > count + 10, first)
    assert not stage.sent[second]
    assert first.controller.pursuit._supervisor.status.push.phase is Phase.PUSHING

    # It does not, as it does not know of the first.
    second.controller._gate.yields = False
    second.controller._gate._was_commanding = True
    second.controller._commands._publish(Twist(0.2, 0.0, 0.0), second.now())
    stage.wait_until(lambda: names_controller(first))
    assert stage.sent[first][-1] == STOP
    # Both have been named; once nobody drives one of them goes on.
    first.controller.stop()
    stage.wait_until(lambda: any(twist != STOP for twist in stage.sent[second][1:]))


def test_a_robot_that_is_driven_gets_zeros_at_a_stop_and_all_of_them_at_the_end(
        stage: Stage) -> None:
    """At once, without another measurement: a base that resends its last command would go on."""
    node = stage.nodes[0]
    sent, commands = stage.sent[node], node.controller._commands
    stage.plan(node)
    stage.wait_until(lambda: sent and sent[-1] != STOP, node)
    count = len(sent)
    node.controller.stop()
    assert sent[count:] == [STOP]
    node.trigger_deactivate()
    assert sent[count:] == STOP_COMMANDS * [STOP]
    assert commands.is_silent and not node.is_active
