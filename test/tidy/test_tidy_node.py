"""The action push_objects over DDS: a bin leaves the door through which a box has to come."""

from collections.abc import Iterator, Mapping
import contextlib
from pathlib import Path
import shutil
from typing import Any, NamedTuple

from helpers.architecture import ROOT
from helpers.blocked_door import small_rooms
from helpers.build_interfaces import available
from push_model.events import ObjectFailure
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import distance, Pose
from push_ros.action_commander import PushOutcome
from push_ros.conversions.map import to_map_message
from push_ros.conversions.measurements import from_object_pose_message
from push_ros.tidy_commander import ObjectReport, TidyCommander, TidyFeedback, TidyResult
from push_ros.topics import CONTROLLER, PLANNER, SIM, TIDY, topic_of_object, TOPICS
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeProcesses
from push_scenario.tidying.room import Room
import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
import yaml

pytestmark = [pytest.mark.dds, pytest.mark.slow]

MODULES = {PLANNER: 'push_planner.planner_node', CONTROLLER: 'push_control.controller_node',
           SIM: 'push_sim_node.sim_node', TIDY: 'push_tidy.tidy_node'}
FILES = {'crate': 'box_04', 'box': 'box_04', 'bin': 'bin'}
GOALS = {'box': Pose(0.65, 0.0, 0.0), 'crate': Pose(-1.5, -0.9, 0.0)}
FAR = {'box': Pose(1.2, 0.3, 0.0)}
TOLERANCE = 0.01


class Nodes(NamedTuple):
    """
    The nodes, and a commander beside them.

    :param processes: of the nodes.
    :param context: of rclpy.
    :param commander: of several objects.
    """

    processes: NodeProcesses
    context: Context
    commander: TidyCommander

    def watch(self) -> tuple[TidyResult, list[TidyFeedback]]:
        """Follow the goal to its end; return how it ended, and the feedback in between."""
        seen: list[TidyFeedback] = []
        # By single messages, as simulated time runs fast.
        while not self.commander.is_done(timeout=0.0):
            self.processes.check()
            feedback = self.commander.feedback()
            if feedback is not None and feedback not in seen[-1:]:
                seen.append(feedback)
        result = self.commander.result()
        assert result is not None
        return result, seen


def write_parameters(folder: Path, room: Room) -> dict[str, Path]:
    """Write the parameters of all nodes, and the files of the objects."""
    for name, file in FILES.items():
        shutil.copy(ROOT / 'config' / 'objects' / f'{file}.yaml', folder / f'{name}.yaml')
    scenario, names = room.any_scenario, list(room.scenarios)
    paths = write_parameter_files(folder, scenario, scenario.control, folder / 'tape.csv',
                                  real_time=False, stamped=True)
    starts = [item.start.object.pose for item in room.scenarios.values()]
    common = {'objects.name': names, 'object_folder': str(folder)}
    tidy = {'use_sim_time': True, **to_parameter_values(scenario.robot, 'robot.'), **common}
    paths[TIDY] = folder / f'{TIDY}.yaml'
    paths[TIDY].write_text(yaml.safe_dump({TIDY: {'ros__parameters': tidy}}))
    for name, changes in ((SIM, {
            **common, 'time_limit': 0.0, 'autostart': True, 'tape_path': '',
            **{f'objects.{axis}': [getattr(pose, axis) for pose in starts]
               for axis in Pose._fields}}),
                          (CONTROLLER, {**common, 'wait_for_start': False,
                                        'object_name': names[0]})):
        values = yaml.safe_load(paths[name].read_text())
        values[name]['ros__parameters'].update(changes)
        paths[name].write_text(yaml.safe_dump(values))
    return paths


@pytest.fixture(scope='module')
def nodes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Nodes]:
    """Start all nodes, and publish the map of the room."""
    folder = tmp_path_factory.mktemp('tidy')
    room, context = small_rooms(), Context()
    paths = write_parameters(folder, room)
    with available(ROOT / 'push_control_msgs'), private_domain() as domain, \
            NodeProcesses(domain, folder) as processes, contextlib.ExitStack() as stack:
        rclpy.init(args=[], context=context, domain_id=domain)
        stack.callback(rclpy.shutdown, context=context)
        for name, module in MODULES.items():
            processes.start(name, module, paths[name])
        node = rclpy.create_node('map_server', context=context)
        stack.callback(node.destroy_node)
        maps = node.create_publisher(TOPICS['room_map'].type, 'room_map',
                                     TOPICS['room_map'].publish_qos)
        maps.publish(to_map_message(room.floor_map.occupancy_map, node.get_clock().now().to_msg(),
                                    'odom'))
        commander = stack.enter_context(TidyCommander(context=context))
        while not commander.wait_until_ready(0.1):
            processes.check()
        yield Nodes(processes, context, commander)


def measured(nodes: Nodes, name: str) -> Pose:
    """Return the next measured pose of an object."""
    received: list[Any] = []
    topic, node = TOPICS['object_pose'], rclpy.create_node('witness', context=nodes.context)
    node.create_subscription(topic.type, topic_of_object('object_pose', name), received.append,
                             topic.subscribe_qos)
    executor = SingleThreadedExecutor(context=nodes.context)
    executor.add_node(node)
    while not received:
        executor.spin_once(timeout_sec=0.1)
        nodes.processes.check()
    executor.shutdown()
    node.destroy_node()
    return from_object_pose_message(received[-1], 'odom').pose


def states(objects: Mapping[str, ObjectReport]) -> dict[str, int]:
    """Return the states of objects by name."""
    return {name: report.state for name, report in objects.items()}


def test_what_blocks_a_door_is_moved_first(nodes: Nodes) -> None:
    """The bin leaves, the box comes through, the crate stays; feedback says what and why."""
    from push_control_msgs.msg import ObjectStatus
    assert nodes.commander.tidy(GOALS)
    result, feedback = nodes.watch()
    assert (result.outcome, result.error_code) == (PushOutcome.SUCCEEDED, 0), result
    assert states(result.objects) == {
        'box': ObjectStatus.AT_GOAL, 'crate': ObjectStatus.AT_GOAL,
        'bin': ObjectStatus.WITHOUT_GOAL}
    assert result.moves == 2 and result.objects['box'].position_error < TOLERANCE
    assert distance(measured(nodes, 'box'), GOALS['box']) < TOLERANCE + 0.005
    texts = [item.text for item in feedback]
    first, = {text for text in texts if 'out of the way' in text}
    assert first == 'bin out of the way, as box is next'
    assert texts.index(first) < texts.index('box to its goal')
    moved = [item.object_name for item in feedback if item.object_name]
    assert moved[0] == 'bin' and moved[-1] == 'box'


def test_an_object_that_nobody_knows_is_refused(nodes: Nodes) -> None:
    """Before anything moves."""
    from push_control_msgs.action import PushObjects
    assert nodes.commander.tidy({'sofa': GOALS['box']})
    result, _ = nodes.watch()
    assert result.error_code == PushObjects.Result.UNKNOWN_OBJECT and 'sofa' in result.error_msg
    assert result.outcome is PushOutcome.ABORTED


def test_a_cancelled_goal_leaves_the_objects_where_they_are(nodes: Nodes) -> None:
    """It is cancelled while the robot drives to the box; the code says that it was not moved."""
    from push_control_msgs.action import PushObjects
    assert nodes.commander.tidy(FAR)
    while (feedback := nodes.commander.feedback()) is None or feedback.object_name != 'box':
        assert not nodes.commander.is_done()
        nodes.processes.check()
    nodes.commander.cancel()
    result, _ = nodes.watch()
    assert result.outcome is PushOutcome.CANCELLED
    assert result.error_code == PushObjects.Result.INTERRUPTED
    assert result.objects['box'].codes == (f'ObjectFailure.{ObjectFailure.NOT_MOVED.name}',)
