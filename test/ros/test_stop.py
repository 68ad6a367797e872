"""Stop and start of single pushes over Fast DDS: a stop holds, and no goal is lost silently."""

from collections.abc import Iterator
from typing import Any

from action_msgs.msg import GoalStatus
from helpers.architecture import ROOT
from helpers.build_interfaces import available
from helpers.node_bench import bench, REACTION_TIMEOUT
from helpers.single_push_bench import GOAL, PHYSICS, plan, SinglePushBench, ZERO
from push_ros.conversions.primitives import to_pose_message
from push_ros.diagnostics import ERROR, WARN
from push_ros.topics import CONTROLLER
import pytest
from rclpy.action import ActionClient

pytestmark = [pytest.mark.dds, pytest.mark.slow]

STOPPED = 'stopped by controller/stop: call controller/start'
LIFTED = 'the stop is lifted; waits for a goal'


@pytest.fixture(scope='module')
def lasting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SinglePushBench]:
    """Start a controller with the action."""
    with available(ROOT / 'push_control_msgs'), bench(
            tmp_path_factory.mktemp('stop'), CONTROLLER, 'push_control.controller_node',
            {**PHYSICS, 'use_sim_time': True, 'lockstep': True}) as b:
        yield SinglePushBench(b)


@pytest.fixture
def controller(lasting: SinglePushBench) -> SinglePushBench:
    """Give the controller no goal."""
    lasting.put_back()
    return lasting


class Client:
    """A client of the action."""

    def __init__(self, controller: SinglePushBench) -> None:
        from push_control_msgs.action import PushObject
        self.controller = controller
        self.codes = PushObject.Result
        self._kind = PushObject
        self._client = ActionClient(controller.b.node, PushObject, 'push_object')
        controller.b.wait_until(self._client.server_is_ready)

    def send(self) -> Any:
        """Send a goal; return the future of its result."""
        goal = self._kind.Goal()
        goal.goal_pose.header.frame_id = 'odom'
        goal.goal_pose.pose = to_pose_message(GOAL)
        sent = self._client.send_goal_async(goal)
        self.controller.b.wait_until(sent.done)
        assert sent.result().accepted
        return sent.result().get_result_async()


def test_a_stop_holds_until_a_start(controller: SinglePushBench) -> None:
    """Goals are refused at once with the reason, on both ways; after the start one is reached."""
    controller.measure()
    client = Client(controller)
    assert controller.b.call('controller/stop').success
    controller.measure()
    controller.wait_for(STOPPED, WARN)
    controller.send_goal()
    controller.wait_for(f'goal_pose: no goal is taken: {STOPPED}', ERROR)
    # No measurement comes: it does not wait for one.
    result = client.send()
    controller.b.wait_until(result.done)
    assert result.result().status == GoalStatus.STATUS_ABORTED
    assert result.result().result.error_code == client.codes.STOPPED
    assert STOPPED in result.result().result.error_msg
    count = len(controller.b.received['push_request'])
    assert controller.measure(30) == {ZERO}
    assert len(controller.b.received['push_request']) == count
    started = controller.b.call('controller/start')
    assert (started.success, started.message) == (True, LIFTED)
    assert controller.measure() == {ZERO}
    requests = controller.b.received['push_request']
    result = client.send()
    controller.b.repeat_until(controller.measure, lambda: len(requests) > count, period=0.0)
    controller.send(plan(), requests[-1].header.stamp)
    controller.b.repeat_until(controller.measure, result.done, period=0.0)
    assert result.result().status == GoalStatus.STATUS_SUCCEEDED


def test_a_push_that_is_stopped_ends_and_goes_on_with_the_start(
        controller: SinglePushBench) -> None:
    """Its client learns who has stopped it; the robot stands until then."""
    client = Client(controller)
    requests = controller.b.received['push_request']
    count = len(requests)
    result = client.send()
    controller.b.repeat_until(controller.measure, lambda: len(requests) > count, period=0.0)
    controller.send(plan(), requests[-1].header.stamp)
    controller.drive()
    assert controller.b.call('controller/stop').success
    controller.b.wait_until(result.done, REACTION_TIMEOUT)
    assert result.result().status == GoalStatus.STATUS_ABORTED
    assert result.result().result.error_code == client.codes.INTERRUPTED
    assert result.result().result.error_msg == STOPPED
    controller.measure()
    assert controller.measure(30) == {ZERO}
    started = controller.b.call('controller/start')
    assert started.success and started.message.endswith('goes on to the goal of before')
    controller.drive()


def test_a_stop_before_the_plan_forgets_the_goal(controller: SinglePushBench) -> None:
    """A plan that comes for it later is not driven, neither before the start nor after."""
    request = controller.request()
    assert controller.b.call('controller/stop').success
    for message in ('', LIFTED):
        controller.send(plan(), request.header.stamp)
        controller.wait_for('its request has been answered, or given up', WARN)
        assert controller.measure() == {ZERO}
        assert not message or controller.b.call('controller/start').message == message
    controller.send(plan(), request.header.stamp)
    controller.wait_for('its request has been answered, or given up', WARN)
    assert controller.measure(30) == {ZERO}
