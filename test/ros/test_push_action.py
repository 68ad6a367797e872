"""The action push_object over DDS: the controller alone, before an object that does not move."""

import math
import time
from typing import Any

from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PoseStamped
from helpers.architecture import ROOT
from helpers.build_interfaces import available
from helpers.node_bench import bench, REACTION_TIMEOUT, TIMEOUT
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from push_control.events import TaskEvent
from push_model.files.data import config_file
from push_model.files.flat_values import to_parameter_values
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_model.signals import ObjectPose, Odometry, STOP
from push_primitives.store import reference_object
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import no_plan_message
from push_ros.conversions.plan_request import from_request_message
from push_ros.conversions.primitives import seconds, to_pose_message
from push_ros.diagnostics import ERROR, OK, status_values
from push_ros.qos import LATCHED
from push_ros.topics import CONTROLLER
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.parameter import Parameter
from rclpy.task import Future

pytestmark = [pytest.mark.dds, pytest.mark.slow]

SCENARIO = read_scenario(find_scenario('task_approach'))
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PARAMETERS = {**to_parameter_values(SCENARIO.object, 'object.'),
              **to_parameter_values(SCENARIO.robot, 'robot.'), 'use_sim_time': True, 'task': True,
              'object_name': 'box_04', 'base.node': 'base',
              'base.parameters.name': ['reflex', 'safety_override'],
              'base.parameters.expected': ['false', 'backup_only|full'], 'base.timeout': 8.0}
BIN = read_object(config_file('objects/bin.yaml'))
PERIOD = 0.05
STOPPED = 'stopped by controller/stop: call controller/start'


class Client:
    """A client of the action, and the world around the controller; its time is of its own."""

    def __init__(self, b):
        from push_control_msgs.action import PushObject
        from push_control_msgs.msg import PushStatus
        self.b = b
        self.action = PushObject
        # Stamp of the last measurement [s].
        self.now = 0.0
        self.statuses, self.feedback = [], []
        b.subscribe('push_request')
        b.subscribe('diagnostics')
        b.node.create_subscription(PushStatus, 'push_status', self.statuses.append, LATCHED)
        self._client = ActionClient(b.node, PushObject, 'push_object')
        b.wait_until(self._client.server_is_ready)
        self.base = b.node_beside('base')
        self.base.declare_parameter('reflex', False)
        self.base.declare_parameter('safety_override', 'full')

    def measure(self):
        """Let time pass by one measurement each of robot and object."""
        self.let_time_pass()
        self.b.publish('object_pose', to_object_pose_message(ObjectPose(self.now, OBJECT), 'odom'))
        self.b.publish('odom', to_odometry_message(Odometry(self.now, ROBOT, STOP), 'odom',
                                                   'base_link'))
        self.b.spin(0.01)

    def measure_from_robot(self):
        """Let time pass by one measurement, in which a camera on the robot sees the object."""
        self.let_time_pass()
        self.b.publish('object_pose', to_object_pose_message(
            ObjectPose(self.now, ROBOT.inverse() @ OBJECT), 'base_link'))
        self.b.publish('odom', to_odometry_message(Odometry(self.now, ROBOT, STOP), 'odom',
                                                   'base_link'))
        self.b.spin(0.01)

    def let_time_pass(self):
        """Let time pass without a measurement."""
        self.now += PERIOD
        self.b.clock(self.now)

    def measure_until(self, condition, timeout=TIMEOUT):
        """Let time pass until a condition holds."""
        end = time.monotonic() + timeout
        while not condition():
            self.b.processes.check()
            self.measure()
            assert time.monotonic() < end

    def offer(self, pose: Pose | PoseStamped, **fields: Any) -> ClientGoalHandle:
        """Send a goal; return its handle, accepted or not."""
        self.feedback.clear()
        goal = self.action.Goal(goal_pose=stamped(pose), **fields)
        sent = self._client.send_goal_async(
            goal, feedback_callback=lambda message: self.feedback.append(message.feedback))
        self.b.wait_until(sent.done)
        return sent.result()

    def send(self, pose, **fields):
        """Send a goal; return the handle of the accepted goal and the future of its result."""
        handle = self.offer(pose, **fields)
        assert handle.accepted
        return handle, handle.get_result_async()

    def measure_until_planning(self):
        """Let time pass until the robot waits for a plan."""
        self.measure_until(lambda: self.statuses
                           and self.statuses[-1].state == self.statuses[-1].PLANNING)

    def texts(self):
        """List what was reported."""
        return [status.message for message in self.b.received['diagnostics']
                for status in message.status]

    def errors(self):
        """List the errors that were reported."""
        return [status.message for message in self.b.received['diagnostics']
                for status in message.status if status.level == ERROR]

    def set_parameter(self, name, value):
        """Set a parameter of the controller; return whether it was set, and why not."""
        value = Parameter(name, value=value).get_parameter_value()
        return self.b.request(SetParameters, f'{CONTROLLER}/set_parameters', SetParameters.Request(
            parameters=[ParameterMessage(name=name, value=value)])).results[0]

    def result(self, pose, **fields):
        """Send a goal, and wait for its result."""
        _, result = self.send(pose, **fields)
        self.measure_until(result.done)
        return result.result()


def stamped(pose, frame='odom'):
    """Make a pose message, or hand on one that is."""
    if isinstance(pose, PoseStamped):
        return pose
    message = PoseStamped(pose=to_pose_message(pose))
    message.header.frame_id = frame
    return message


@pytest.fixture(scope='module')
def client(tmp_path_factory):
    """Start a controller in a task, for all tests."""
    with available(ROOT / 'push_control_msgs'), bench(
            tmp_path_factory.mktemp('action'), CONTROLLER, 'push_control.controller_node',
            PARAMETERS) as b:
        client = Client(b)
        # Until the controller has met the node of the base.
        while client.result(OBJECT).status != GoalStatus.STATUS_SUCCEEDED:
            b.processes.check()
        yield client


def test_a_goal_where_the_object_is_is_reached(client):
    """It succeeds without a push, with errors within the tolerances, and the status says so."""
    ended = client.result(OBJECT, object_name='box_04')
    assert ended.status == GoalStatus.STATUS_SUCCEEDED
    result = ended.result
    assert (result.error_code, result.error_msg, result.pushes) == (client.action.Result.NONE,
                                                                    '', 0)
    assert result.position_error < 0.01 and abs(result.heading_error) < 0.0175
    assert list(result.codes) == []
    assert math.isnan(result.position_deviation) and math.isnan(result.heading_deviation)
    assert 0.0 <= seconds(result.duration) < client.now
    client.measure_until(lambda: client.statuses[-1].state == client.statuses[-1].REACHED)
    assert client.statuses[-1].header.frame_id == 'odom'
    assert client.statuses[-1].object_name == 'box_04'
    assert math.isnan(client.statuses[-1].position_deviation)


def test_a_goal_that_odometry_alone_knows_says_how_well(client):
    """A camera on the robot: done, without an error, with code and deviations; no warning."""
    client.b.received['diagnostics'].clear()
    _, result = client.send(OBJECT)
    client.b.repeat_until(client.measure_from_robot, result.done, period=0.0)
    client.b.repeat_until(client.measure_from_robot, lambda: (
        client.statuses[-1].state == client.statuses[-1].REACHED), period=0.0)
    ended = result.result()
    assert ended.status == GoalStatus.STATUS_SUCCEEDED
    assert (ended.result.error_code, ended.result.error_msg) == (client.action.Result.NONE, '')
    assert list(ended.result.codes) == [str(TaskEvent.DONE_BY_ODOMETRY)]
    deviations = ended.result.position_deviation, ended.result.heading_deviation
    assert all(0.0 < value < 0.1 for value in deviations)
    status = client.statuses[-1]
    assert list(status.codes) == list(ended.result.codes)
    # They go on to grow while the robot stands, for as long as the messages take.
    assert (status.position_deviation, status.heading_deviation) == (
        pytest.approx(deviations, rel=0.5))
    reports = [status for message in client.b.received['diagnostics']
               for status in message.status if status.message.startswith('task: done')]
    assert reports and all(report.level == OK for report in reports)
    values = status_values(reports[-1])
    assert values['codes'] == str(TaskEvent.DONE_BY_ODOMETRY)
    assert (float(values['position_deviation']), float(values['heading_deviation'])) == (
        pytest.approx(deviations, rel=0.5))


def cancel(client: Client, handle: ClientGoalHandle, result: Future) -> None:
    """Cancel the goal, and wait until it has ended as cancelled."""
    cancelled = handle.cancel_goal_async()
    client.b.wait_until(cancelled.done, REACTION_TIMEOUT)
    assert len(cancelled.result().goals_canceling) == 1
    client.measure_until(result.done, REACTION_TIMEOUT)
    assert result.result().status == GoalStatus.STATUS_CANCELED
    assert result.result().result.error_code == client.action.Result.NONE


def test_feedback_comes_until_a_goal_is_cancelled(client):
    """The robot waits for its plan; the client is told so with the errors, and may cancel."""
    handle, result = client.send(GOAL)
    client.measure_until(lambda: len(client.feedback) > 2 and client.feedback[-1].status.state
                         == client.feedback[-1].status.PLANNING)
    last = client.feedback[-1]
    assert 'planning' in last.status.text
    assert last.status.position_error == pytest.approx(
        math.dist(OBJECT[:2], GOAL[:2]), abs=1e-3)
    assert (last.status.push_number, last.status.pushes_done) == (0, 0)
    cancel(client, handle, result)
    client.measure_until(lambda: client.statuses[-1].state == client.statuses[-1].IDLE)


@pytest.mark.parametrize('measurements', [0, 1, 3, 10])
def test_a_goal_may_be_cancelled_at_any_moment(client: Client, measurements: int) -> None:
    """Before the base was checked or anything measured, too; the next goal is served."""
    handle, result = client.send(GOAL)
    for _ in range(measurements):
        client.measure()
    cancel(client, handle, result)
    assert result.result().result.error_msg
    assert client.result(OBJECT).status == GoalStatus.STATUS_SUCCEEDED


def test_a_client_that_is_gone_leaves_its_goal_to_the_next_one(client: Client) -> None:
    """Nobody is there for the result of the first goal; the second one is pursued."""
    node = client.b.node_beside('short_lived')
    gone = ActionClient(node, client.action, 'push_object')
    client.b.wait_until(gone.server_is_ready)
    sent = gone.send_goal_async(client.action.Goal(goal_pose=stamped(GOAL)))
    client.b.wait_until(sent.done)
    assert sent.result().accepted
    client.measure_until_planning()
    gone.destroy()
    client.b.executor.remove_node(node)
    node.destroy_node()
    ended = client.result(OBJECT)
    assert ended.status == GoalStatus.STATUS_SUCCEEDED and ended.result.pushes == 0
    client.measure_until(lambda: client.statuses[-1].state == client.statuses[-1].REACHED)


@pytest.mark.parametrize('fields, pose, code, text', [
    ({}, Pose(math.nan, 0.0, 0.0), 'INVALID_GOAL', 'expected finite numbers'),
    ({'position_tolerance': -0.1}, GOAL, 'INVALID_GOAL', 'position_tolerance: got -0.1'),
    ({'heading_tolerance': math.nan}, GOAL, 'INVALID_GOAL', 'heading_tolerance: got nan'),
    ({'time_limit': Duration(sec=-1)}, GOAL, 'INVALID_GOAL', 'time_limit: got -1'),
    ({'object_name': 'moon'}, GOAL, 'UNKNOWN_OBJECT',
     "got 'moon', expected one of bin, box_04, carton, coffee_table"),
    ({}, stamped(GOAL, 'nowhere'), 'TF_ERROR', "frame 'nowhere'"),
    ({}, stamped(GOAL, ''), 'TF_ERROR', "got frame '', expected 'odom'"),
], ids=['nan', 'tolerance', 'nan tolerance', 'time limit', 'object', 'frame', 'no frame'])
def test_a_goal_that_cannot_be_used_is_aborted(client, fields, pose, code, text):
    """With code and text; the goal that is pursued stays."""
    _, former = client.send(GOAL)
    ended = client.result(pose, **fields)
    assert ended.status == GoalStatus.STATUS_ABORTED
    assert ended.result.error_code == getattr(client.action.Result, code)
    assert text in ended.result.error_msg
    assert math.isnan(ended.result.position_error) and math.isnan(ended.result.heading_error)
    client.measure()
    assert not former.done()


@pytest.mark.parametrize('name, value, text', [
    ('reflex', True, 'base: reflex: got true, expected false'),
    ('safety_override', 'none', 'safety_override: got none, expected backup_only or full')])
def test_a_base_that_is_not_ready_gets_no_goal(client, name, value, text):
    """Neither from the action nor from the topic; another look is taken for each."""
    client.b.received['diagnostics'].clear()
    assert client.result(OBJECT).status == GoalStatus.STATUS_SUCCEEDED
    former = client.base.get_parameter(name)
    client.base.set_parameters([Parameter(name, value=value)])
    ended = client.result(GOAL)
    assert ended.result.error_code == client.action.Result.ROBOT_NOT_READY
    assert text in ended.result.error_msg
    client.b.publish('goal_pose', stamped(GOAL))
    client.measure_until(lambda: any(text in error for error in client.errors()))
    assert client.statuses[-1].state == client.statuses[-1].REACHED
    client.base.set_parameters([former])


def test_a_base_that_cannot_be_reached_gets_no_goal(client):
    """The controller waits for a while, and says how to do without; then it is there again."""
    client.b.executor.remove_node(client.base)
    _, result = client.send(GOAL)
    client.b.wait_until(result.done)
    ended = result.result()
    assert ended.result.error_code == client.action.Result.ROBOT_NOT_READY
    assert 'base: got none of its parameters within 8 s' in ended.result.error_msg
    client.b.executor.add_node(client.base)
    assert client.result(OBJECT).status == GoalStatus.STATUS_SUCCEEDED


def test_a_goal_may_name_another_object(client):
    """The robot turns to it, and says so; the planner is told what it is, and so back again."""
    requests = client.b.received['push_request']
    _, first = client.send(GOAL)
    client.measure_until_planning()
    refused = client.set_parameter('object_name', 'carton')
    assert not refused.successful and 'while a goal is pursued' in refused.reason
    for name, obj in (('bin', BIN), ('box_04', SCENARIO.object)):
        handle, result = client.send(GOAL, object_name=name)
        client.measure_until(lambda: client.statuses[-1].object_name == name, REACTION_TIMEOUT)
        # A request to the goal before may still be on its way.
        client.measure_until(lambda: reference_object(
            from_request_message(requests[-1], 'odom').obj) == reference_object(obj))
        client.b.wait_until(handle.cancel_goal_async().done, REACTION_TIMEOUT)
        client.measure_until(result.done, REACTION_TIMEOUT)
    assert first.result().result.error_code == client.action.Result.PREEMPTED


def test_the_object_may_be_set_as_a_parameter(client):
    """By its name or its values, which then belong to that name; all or nothing."""
    assert client.set_parameter('object_name', 'bin').successful
    refused = client.set_parameter('object_name', 'moon')
    assert not refused.successful and 'expected one of bin, box_04' in refused.reason
    for value in (1.5, [1.5], ['bin'], True):
        refused = client.set_parameter('object_name', value)
        assert not refused.successful and 'object_name: got ' in refused.reason
    assert not client.set_parameter('object.radius', -1.0).successful
    assert client.set_parameter('object.mass', 5.0).successful
    requests = client.b.received['push_request']
    for name, mass in (('', 5.0), ('box_04', 3.0), ('bin', 5.0), ('box_04', 3.0)):
        handle, result = client.send(GOAL, object_name=name)
        client.measure_until(
            lambda: requests and from_request_message(requests[-1], 'odom').obj.mass == mass)
        client.b.wait_until(handle.cancel_goal_async().done, REACTION_TIMEOUT)
        client.measure_until(result.done, REACTION_TIMEOUT)


def test_a_goal_pose_takes_the_place_of_a_goal_of_the_action(client):
    """Both come in by one entry: a click in RViz preempts a program, and the other way round."""
    _, first = client.send(GOAL)
    _, second = client.send(GOAL)
    client.measure_until(first.done)
    client.measure()
    assert not second.done()
    client.b.publish('goal_pose', stamped(OBJECT))
    client.measure_until(second.done)
    for ended in (first.result(), second.result()):
        assert ended.status == GoalStatus.STATUS_ABORTED
        assert ended.result.error_code == client.action.Result.PREEMPTED
    client.measure_until(lambda: client.statuses[-1].state == client.statuses[-1].REACHED)


def test_a_goal_ends_at_its_time_limit_and_by_the_service(client):
    """Each with a code of its own, and not before."""
    began = client.now
    ended = client.result(GOAL, time_limit=Duration(sec=1))
    assert ended.result.error_code == client.action.Result.TIMEOUT
    assert client.now - began > 1.0 and seconds(ended.result.duration) > 1.0
    _, result = client.send(GOAL)
    client.measure_until_planning()
    client.b.call('controller/stop')
    client.measure_until(result.done)
    assert result.result().status == GoalStatus.STATUS_ABORTED
    assert result.result().result.error_code == client.action.Result.INTERRUPTED
    assert client.b.call('controller/start').message.endswith('goes on to the goal of before')


def test_after_a_stop_goals_are_refused_until_the_start(client):
    """At once, and with the reason, whether they come by the action or the topic."""
    client.result(OBJECT)
    assert client.b.call('controller/stop').success
    client.measure_until(lambda: client.statuses[-1].text == f'idle, {STOPPED}')
    client.measure_until(lambda: any(f'task: idle, {STOPPED}' in text
                                     for text in client.texts()))
    client.b.received['diagnostics'].clear()
    _, result = client.send(OBJECT)
    client.b.wait_until(result.done)
    assert result.result().status == GoalStatus.STATUS_ABORTED
    assert result.result().result.error_code == client.action.Result.STOPPED
    assert result.result().result.error_msg == f'no goal is taken: {STOPPED}'
    client.b.publish('goal_pose', stamped(OBJECT))
    client.measure_until(lambda: f'goal_pose: no goal is taken: {STOPPED}' in client.errors())
    assert client.statuses[-1].state == client.statuses[-1].IDLE
    started = client.b.call('controller/start')
    assert (started.success, started.message) == (True, 'the stop is lifted; waits for a goal')
    assert client.result(OBJECT).status == GoalStatus.STATUS_SUCCEEDED


def test_a_goal_without_a_plan_is_given_up(client):
    """The second refusal from the same place ends it, with the reason of the planner."""
    requests = client.b.received['push_request']
    requests.clear()
    _, result = client.send(GOAL)
    answered = 0

    def refuse():
        nonlocal answered
        client.measure()
        if len(requests) > answered:
            answered = len(requests)
            client.b.publish('push_plan', no_plan_message(
                PlanFailure.NOT_CONVERGED, requests[-1].header.stamp, 'odom'))
    client.b.repeat_until(refuse, result.done, period=0.0)
    ended = result.result()
    assert ended.status == GoalStatus.STATUS_ABORTED
    assert ended.result.error_code == client.action.Result.NO_VALID_PLAN
    assert PlanFailure.NOT_CONVERGED.value in ended.result.error_msg
    assert list(ended.result.codes) == [str(TaskEvent.PLANNING_FAILED_AGAIN),
                                        str(PlanFailure.NOT_CONVERGED)]


def test_a_goal_ends_at_its_time_limit_without_odometry(client):
    """Its client is told why the robot has not moved."""
    began = client.now
    _, result = client.send(GOAL, time_limit=Duration(sec=5))
    client.measure_until_planning()
    client.b.repeat_until(client.let_time_pass, result.done, period=0.02)
    ended = result.result().result
    assert ended.error_code == client.action.Result.TIMEOUT and client.now - began > 4.9
    assert 'no odometry comes' in ended.error_msg


def test_an_inactive_controller_rejects_goals(client: Client) -> None:
    """At once, without a result to wait for; active again it takes them."""
    for transition in (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_ACTIVATE):
        assert client.b.request(ChangeState, f'{CONTROLLER}/change_state', ChangeState.Request(
            transition=Transition(id=transition))).success
        if transition == Transition.TRANSITION_DEACTIVATE:
            assert not client.offer(GOAL).accepted
    assert client.result(OBJECT).status == GoalStatus.STATUS_SUCCEEDED


def test_a_client_is_told_that_the_controller_ends(client):
    """Ctrl-C: the goal is aborted before the node is gone. The last test: it ends the node."""
    _, result = client.send(GOAL)
    client.measure_until(lambda: client.feedback)
    client.b.processes.stop(CONTROLLER)
    client.b.wait_until(result.done)
    assert result.result().status == GoalStatus.STATUS_ABORTED
    assert result.result().result.error_code == client.action.Result.INTERRUPTED
