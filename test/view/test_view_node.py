"""The page of a robot: what its topics carry is shown, and commands reach it where allowed."""

import json
import math
import re

from geometry_msgs.msg import Vector3, Wrench, WrenchStamped
from helpers.extras import import_extra
from helpers.node_bench import bench
from helpers.page_reader import is_refused, PageReader
from push_control.perception.view import View
from push_control.task.status import TaskState
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_scenario.definition.loader import load_scenario
from push_view.live.robot_record import RobotRecorder, ROW_PERIOD
from push_view.server.message_log import MessageLog
from push_view.view_node import base_knowledge
import pytest
from std_srvs.srv import Trigger

SCENARIO = load_scenario('straight_push')
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}


@pytest.mark.dds
@pytest.mark.slow
@pytest.mark.parametrize('can_control', [True, False])
def test_a_robot_is_shown_and_commanded_where_that_is_allowed(tmp_path, can_control):
    """Rows of what is measured; a goal and a stop reach the controller, or are refused."""
    import_extra('aiohttp', 'play')
    # What is read only here is served to others, who need the token.
    parameters = {**PHYSICS, 'port': 0, 'control': can_control,
                  'host': '' if can_control else '127.0.0.1'}
    with bench(tmp_path, 'push_view', 'push_view.view_node', parameters) as b:
        stops = []

        def stop(_, answer):
            stops.append(answer)
            answer.message = 'stopped'
            return answer

        b.node.create_service(Trigger, 'controller/stop', stop)
        for topic in ('diagnostics', 'goal_pose'):
            b.subscribe(topic)
        b.wait_until(lambda: b.received['diagnostics'])
        text = b.received['diagnostics'][0].status[0].message
        url = re.search(r'http\S+', text)[0]
        assert is_refused(url, Origin='http://elsewhere.example')
        assert 'token=' in url and is_refused(url.partition('?')[0])
        page = PageReader(url)
        number = [0]

        def measure():
            number[0] += 1
            b.publish('object_pose', to_object_pose_message(
                ObjectPose(0.1 * number[0], Pose(0.5, 0.1, 0.2)), 'odom'))
            b.publish('contact_wrench', WrenchStamped(wrench=Wrench(force=Vector3(x=8.0, y=-2.0))))
            b.publish('odom', to_odometry_message(
                Odometry(0.1 * number[0], Pose(-0.4, 0.0, 0.0), Twist(0.1, 0.0, 0.0)), 'odom',
                'base_link'))

        def row_with_force():
            return [row for message in page.of_kind('rows') for row in message['rows']
                    if row[1] is not None and row[10] is not None]

        b.repeat_until(measure, row_with_force)
        assert row_with_force()[-1][1:7] == [0.5, 0.1, 0.2, -0.4, 0.0, 0.0]
        assert math.hypot(*row_with_force()[-1][10:12]) == pytest.approx(math.hypot(8.0, 2.0))
        b.repeat_until(
            lambda: b.publish('object_pose', to_object_pose_message(
                ObjectPose(1e3, Pose(0.0, 0.0, 0.0)), 'nowhere')),
            lambda: any("object_pose: got frame 'nowhere'" in status.message
                        for message in b.received['diagnostics'] for status in message.status))
        controls = page.of_kind('controls')[-1]
        assert controls['tools'] == (['goal'] if can_control else [])
        command = {'type': 'goal', 'pose': [1.0, 0.5, 0.25]}
        if not can_control:
            page.send(**command)
            b.wait_until(lambda: page.of_kind('refused'))
            assert 'read only' in page.of_kind('refused')[0]['text']
            assert not b.received['goal_pose']
            return
        b.repeat_until(lambda: page.send(**command), lambda: b.received['goal_pose'])
        assert b.received['goal_pose'][0].pose.position.x == 1.0
        b.repeat_until(lambda: page.send(type='call', name='stop'), lambda: stops)
        b.wait_until(lambda: page.of_kind('notice')[-1:] == [{'type': 'notice',
                                                              'text': 'stopped'}])
        page.send(type='displace', pose=[0.0, 0.0, 0.0])
        b.wait_until(lambda: any('simulation only' in refusal['text']
                                 for refusal in page.of_kind('refused')))
        b.wait_until(lambda: page.of_kind('goal'))


def shown(log, kind):
    """List the messages of a kind in a log."""
    return [message for message in map(json.loads, log.since(0)[0]) if message['type'] == kind]


def test_a_force_is_shown_in_the_contact_while_it_is_new():
    """Along normal and tangent, whatever the heading of the object; then it is not known."""
    log = MessageLog()
    record = RobotRecorder(log, 'robot', SCENARIO.object, SCENARIO.robot)
    reach = max(x for x, _ in SCENARIO.object.outline)
    heading = Pose(1.0, 0.5, math.pi / 2)
    record.on_object_pose(ObjectPose(0.0, heading))
    robot = heading @ Pose(-reach - SCENARIO.robot.radius - 0.01, 0.0, 0.0)
    record.on_odometry(Odometry(0.0, robot, Twist(0.0, 0.0, 0.0)))
    record.on_contact_force((8.0, -2.0))
    for time in (0.1, 1.0):
        record.on_odometry(Odometry(time, robot, Twist(0.0, 0.0, 0.0)))
    values = [dict(zip(shown(log, 'scene')[0]['columns'], row))
              for message in shown(log, 'rows') for row in message['rows']]
    assert [(row['force_n'], row['force_t']) for row in values] == [
        (None, None), (8.0, -2.0), (None, None)]
    contact = heading.transform((-reach, 0.0))
    assert (values[1]['contact_x'], values[1]['contact_y']) == pytest.approx(contact, abs=1e-5)
    assert (values[1]['normal'], values[1]['gap']) == pytest.approx((math.pi / 2, 0.01), abs=1e-5)


def test_what_was_given_in_a_frame_that_drifts_is_moved():
    """Goal and map; before there is any nothing happens."""
    log = MessageLog()
    record = RobotRecorder(log, 'robot', SCENARIO.object, SCENARIO.robot)
    correction = Pose(0.1, -0.2, 0.0)
    record.move_goal(correction)
    record.move_map(correction)
    assert not shown(log, 'goal') and not shown(log, 'map')
    record.on_goal(Pose(1.0, 0.0, 0.5))
    record.on_map(OccupancyMap(0.1, Pose(-1.0, -1.0, 0.0), [[True, False]]))
    record.move_goal(correction)
    record.move_map(correction)
    assert shown(log, 'goal')[-1]['pose'] == pytest.approx([1.1, -0.2, 0.5])
    assert shown(log, 'map')[-1]['origin'] == pytest.approx([-0.9, -1.2, 0.0])


def test_what_the_controller_reports_of_its_base_is_shown_once():
    """Again where it changes; what is no number is not shown."""
    log = MessageLog()
    record = RobotRecorder(log, 'robot', SCENARIO.object, SCENARIO.robot)
    values = {'dead_time': '0.24', 'min_speed': '0.051', 'pulse': '0.12', 'state': 'push'}
    for known in (values, values, {**values, 'dead_time': '0.3'}):
        record.on_base(base_knowledge(known))
    assert [message['dead_time'] for message in shown(log, 'base')] == [0.24, 0.3]
    assert shown(log, 'base')[-1].items() >= {'min_speed': 0.051, 'min_yaw_rate': 0.0,
                                              'pulse': 0.12, 'first_gain': 1.0}.items()
    assert base_knowledge({'state': 'push'}) is None
    assert base_knowledge({'dead_time': 'unknown'}) is None


def test_from_where_the_object_is_seen_is_shown_once() -> None:
    """As a camera whose nearest distance is a gap; what it does not see is an outline."""
    log = MessageLog()
    record = RobotRecorder(log, 'robot', SCENARIO.object, SCENARIO.robot)
    record.on_object_pose(ObjectPose(0.0, Pose(0.6, 0.0, 0.0)))
    at_rest = Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0, 0.0)
    record.on_odometry(Odometry(2.0, *at_rest))
    for _ in range(2):
        record.on_view(View(0.6, 0.18))
    record.on_odometry(Odometry(3.0, *at_rest))
    record.on_object_pose(ObjectPose(3.9, Pose(0.6, 0.0, 0.0)))
    record.on_odometry(Odometry(4.0, *at_rest))
    (camera,) = shown(log, 'camera')
    assert camera['camera']['nearest'] == pytest.approx(SCENARIO.robot.radius + 0.18)
    assert (camera['camera']['half_angle'], camera['camera']['place']) == (0.6, 'robot')
    assert [row[-1] for message in shown(log, 'rows') for row in message['rows']] == [1, 0, 1]


def test_time_begins_with_the_first_measurement_and_again_when_it_goes_back():
    """The goal still holds then; rows come no faster than a screen needs them."""
    log = MessageLog()
    record = RobotRecorder(log, 'robot', SCENARIO.object, SCENARIO.robot)
    record.on_goal(Pose(1.0, 0.0, 0.0))
    for number in range(101):
        record.on_odometry(Odometry(1e9 + 0.01 * number, Pose(0.01 * number, 0.0, 0.0),
                                    Twist(1.0, 0.0, 0.0)))
    rows = [row for message in shown(log, 'rows') for row in message['rows']]
    assert rows[0][0] == 0.0 and rows[0][1] is None
    assert 0.8 / ROW_PERIOD <= len(rows) <= 1.0 / ROW_PERIOD + 1.0
    record.on_state(TaskState.PUSH, '')
    record.on_state(TaskState.PUSH, '')
    assert len(shown(log, 'state')) == 1
    record.on_object_pose(ObjectPose(5.0, Pose(0.3, 0.2, 0.1)))
    record.on_odometry(Odometry(5.0, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0, 0.0)))
    (row,), = [message['rows'] for message in shown(log, 'rows')]
    assert row[:4] == [0.0, 0.3, 0.2, 0.1]
    assert len(shown(log, 'scene')) == len(shown(log, 'goal')) == 1
    assert not shown(log, 'state')
