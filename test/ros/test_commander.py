"""The commander over DDS: with planner, controller and simulator, as a program uses it."""

from collections.abc import Iterator
import contextlib
import math
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

from helpers.architecture import ROOT
from helpers.build_interfaces import available
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_ros.conversions.measurements import from_object_pose_message, from_odometry_message
from push_ros.topics import CONTROLLER, PLANNER, SIM, TOPICS
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain, private_environment
from push_scenario.dds.processes import NodeProcesses
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from py_trees.common import Status
from py_trees.composites import Selector, Sequence
import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
import yaml

if TYPE_CHECKING:
    from push_ros.commander import PushCommander

# Context of rclpy, the processes of the nodes, and their parameter files.
Nodes = tuple[Context, NodeProcesses, dict[str, Path]]
pytestmark = [pytest.mark.dds, pytest.mark.slow]

MODULES = {PLANNER: 'push_planner.planner_node', CONTROLLER: 'push_control.controller_node',
           SIM: 'push_sim_node.sim_node'}
SCENARIO = read_scenario(find_scenario('task_tap'))
# Of the simulator without a limit of time, which begins at once.
ENDLESS = {'time_limit': 0.0, 'autostart': True}
POLL_PAUSE = 2e-3
# Of a task that is done the newest measured pose of the object may be off by noise besides.
MAX_MEASURED_ERROR = (SCENARIO.task.supervision.position_tolerance
                      + 4.0 * SCENARIO.sensors.pose_noise)
# The first is so far that a push is still under way when a program has noticed that it began.
FAR, NEAR = Pose(2.0, 0.0, 0.0), Pose(0.3, 0.0, 0.0)


@pytest.fixture(scope='module')
def context(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Nodes]:
    """Start all nodes."""
    folder = tmp_path_factory.mktemp('commander')
    paths = write_parameter_files(folder, SCENARIO, SCENARIO.control, folder / 'tape.csv',
                                  real_time=False, stamped=True)
    for name, changes in ((SIM, ENDLESS), (CONTROLLER, {'wait_for_start': False})):
        values = yaml.safe_load(paths[name].read_text())
        values[name]['ros__parameters'].update(changes)
        paths[name].write_text(yaml.safe_dump(values))
    context = rclpy.Context()
    with available(ROOT / 'push_control_msgs'), private_domain() as domain, \
            NodeProcesses(domain, folder) as processes, contextlib.ExitStack() as stack:
        rclpy.init(args=[], context=context, domain_id=domain)
        stack.callback(rclpy.shutdown, context=context)
        for name, module in MODULES.items():
            processes.start(name, module, paths[name])
        yield context, processes, paths


@pytest.fixture
def commander(context):
    """Make a commander for the controller."""
    from push_ros.commander import PushCommander
    with PushCommander(context=context[0]) as commander:
        assert commander.wait_until_ready()
        yield commander


def gap(context):
    """Measure how far the robot stands off the object, once both are at rest."""
    messages = {'odom': [], 'object_pose': []}
    node = rclpy.create_node('witness', context=context)
    for topic, received in messages.items():
        node.create_subscription(TOPICS[topic].type, topic, received.append,
                                 TOPICS[topic].publish_qos)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    while not all(messages.values()):
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    node.destroy_node()
    odometry = from_odometry_message(messages['odom'][-1], 'odom')
    measured = from_object_pose_message(messages['object_pose'][-1], 'odom')
    return find_contact(SCENARIO.object, measured.pose, odometry.pose[:2],
                        SCENARIO.robot.radius).gap


def watch(commander, processes, reaction=None):
    """Follow a goal to its end; return the result and the states that were seen."""
    states = []
    # By single messages, as simulated time runs fast.
    while not commander.is_done(timeout=0.0):
        time.sleep(POLL_PAUSE)
        processes.check()
        feedback = commander.feedback()
        if feedback is not None:
            states.append(feedback.state)
            if reaction is not None:
                reaction(feedback)
    return commander.result(), states


def test_a_cancelled_robot_backs_off_and_the_next_goal_is_reached(context, commander):
    """Cancelled in a push, the robot retreats first; then it brings the object to its goal."""
    from push_control_msgs.msg import PushStatus
    from push_ros.commander import PushOutcome

    def cancel_while_pushing(feedback):
        if feedback.state == PushStatus.PUSHING:
            assert 0.0 < feedback.chance <= 1.0
            assert 0.0 < feedback.estimated_time_remaining < feedback.expected_time_p95
            commander.cancel()

    assert commander.push_to(FAR)
    result, _ = watch(commander, context[1], cancel_while_pushing)
    assert (result.outcome, result.error_code) == (PushOutcome.CANCELLED, 0)
    assert result.pushes == 1 and 0.0 < result.position_error < 2.1
    assert gap(context[0]) > 0.05

    assert commander.push_to(NEAR)
    result, states = watch(commander, context[1])
    assert (result.outcome, result.error_code, result.error_msg) == (PushOutcome.SUCCEEDED, 0, '')
    assert result.position_error < 0.02 and abs(result.heading_error) < 0.04
    assert result.pushes >= 1 and result.duration > 0.0
    assert PushStatus.PUSHING in states
    assert result.codes == () and math.isnan(result.position_deviation)


# What stands for Nav2's own commander, whose servers are not here: it drives nowhere, at once.
NAVIGATOR = """
import enum

TaskResult = enum.Enum('TaskResult', 'SUCCEEDED FAILED')


class BasicNavigator:
    def goToPose(self, pose):
        print('drives to', pose.header.frame_id, pose.pose.position.x)

    def backup(self, backup_dist, backup_speed):
        print('backs up by', backup_dist)

    def isTaskComplete(self):
        return True

    def getResult(self):
        return TaskResult.SUCCEEDED
"""


def run_example(name, context, *folders):
    """Run an example beside the nodes; return what it prints."""
    done = subprocess.run(
        [sys.executable, str(ROOT / 'examples' / name)], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
        env={**private_environment(context[1].domain), 'PYTHONPATH': os.pathsep.join(
            [*map(str, folders), str(ROOT), os.environ['PYTHONPATH']])})
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_the_example_runs(context, commander):
    """The object is at its goal already, or nearly so; the example ends with the result."""
    assert 'SUCCEEDED' in run_example('05_commander.py', context)


def test_the_mission_runs(context, commander, tmp_path):
    """It drives to the object, pushes, and backs up, one after the other."""
    package = tmp_path / 'nav2_simple_commander'
    package.mkdir()
    package.joinpath('robot_navigator.py').write_text(NAVIGATOR)
    # The nodes of this test have no tf from the map to odometry.
    example = (ROOT / 'examples' / '06_mission.py').read_text().replace("'map'", "'odom'")
    tmp_path.joinpath('mission.py').write_text(example)
    printed = run_example(tmp_path / 'mission.py', context, tmp_path)
    steps = [printed.index(text)
             for text in ('drives to odom -0.8', 'SUCCEEDED', 'backs up by 0.3')]
    assert steps == sorted(steps)


def tick_to_the_end(root, nodes, reaction=None):
    """Tick a tree until it has ended, and return its status."""
    while True:
        root.tick_once()
        if root.status is not Status.RUNNING:
            return root.status
        time.sleep(POLL_PAUSE)
        nodes.check()
        if reaction is not None and reaction():
            root.stop(Status.INVALID)
            return root.status


def test_a_tree_pushes_and_chooses_by_the_code(context, commander):
    """A goal that is none fails with its code, by which the tree goes on to another one."""
    from push_control_msgs.action import PushObject as Action
    from push_ros.behavior_tree import PushFailedWith, PushObject
    impossible = PushObject('nowhere', commander, Pose(math.nan, 0.0, 0.0))
    possible, other = (PushObject(name, commander, NEAR) for name in ('near', 'other'))
    root = Selector('anywhere', memory=True, children=[
        impossible,
        Sequence('other codes', memory=True, children=[
            PushFailedWith('no plan', impossible, Action.Result.NO_VALID_PLAN), other]),
        Sequence('no goal', memory=True, children=[
            PushFailedWith('no goal', impossible, Action.Result.INVALID_GOAL), possible])])
    assert tick_to_the_end(root, context[1]) is Status.SUCCESS
    assert impossible.result.error_code == Action.Result.INVALID_GOAL
    assert other.result is None
    assert possible.result.position_error < MAX_MEASURED_ERROR


def test_a_tree_that_turns_away_cancels_the_push(context, commander):
    from push_ros.behavior_tree import PushObject
    from push_ros.commander import PushOutcome
    push = PushObject('far', commander, FAR)
    status = tick_to_the_end(push, context[1],
                             lambda: commander.feedback() and commander.feedback().push_number)
    assert status is Status.INVALID
    result, _ = watch(commander, context[1])
    assert result.outcome is PushOutcome.CANCELLED


def test_a_controller_that_is_killed_and_started_again_has_lost_its_goal(
        context: Nodes, commander: 'PushCommander') -> None:
    """A new one serves the action, and knows nothing of the goal."""
    from push_ros.commander import PushOutcome
    assert commander.push_to(FAR)
    processes = context[1]
    processes.send(CONTROLLER, signal.SIGKILL)
    os.waitid(os.P_PID, processes.pid(CONTROLLER), os.WEXITED | os.WNOWAIT)
    processes.start(CONTROLLER, MODULES[CONTROLLER], context[2][CONTROLLER])
    result, _ = watch(commander, processes)
    assert result.outcome is PushOutcome.LOST
    assert commander.wait_until_ready()


def test_a_controller_that_ends_is_noticed(context, commander):
    """No program waits for ever for a node that is gone."""
    from push_ros.commander import PushOutcome
    assert commander.push_to(FAR)
    while commander.feedback() is None:
        assert not commander.is_done()
    context[1].stop(CONTROLLER)
    result, _ = watch(commander, context[1])
    assert result.outcome in (PushOutcome.LOST, PushOutcome.ABORTED)
