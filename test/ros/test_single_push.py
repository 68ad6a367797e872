"""A single push under way: the controller's node, with a robot that is played here."""

from collections.abc import Callable
import math

from nav_msgs.msg import Odometry as OdometryMessage
from push_control.controller_node import ControllerNode
from push_control.goal import GoalOutcome, PushGoal, PushState
from push_control.steered.status import Phase
from push_model.contact import find_contact
from push_model.events import codes, PushEvent
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_planner.problem import problem_from_placement
from push_planner.steered.planner import plan_push
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import no_plan_message, to_plan_message
from push_ros.conversions.primitives import exact_stamp
from push_ros.executor import MessageWaiter, take_message
from push_ros.parameters import READ_ONLY
from push_ros.topics import CONTROLLER, TOPICS
from push_safety.status import SafetyReason
from push_scenario.dds.private_network import private_domain
from push_scenario.definition.loader import load_scenario
import pytest
import rclpy
from rclpy.parameter import Parameter
from std_msgs.msg import Bool
import yaml

pytestmark = pytest.mark.dds

SCENARIO = load_scenario('straight_push')
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PERIOD = 0.02


@pytest.fixture
def node(tmp_path):
    """Make the controller, active."""
    path = tmp_path / 'controller.yaml'
    path.write_text(yaml.safe_dump({CONTROLLER: {'ros__parameters': {
        **to_parameter_values(SCENARIO.object, 'object.'),
        **to_parameter_values(SCENARIO.robot, 'robot.')}}}))
    with private_domain() as domain:
        rclpy.init(args=['--ros-args', '--params-file', str(path)], domain_id=domain)
        try:
            node = ControllerNode()
            node.start()
            yield node
            node.close()
            node.destroy_node()
        finally:
            rclpy.shutdown()


def request_stamp(node: ControllerNode) -> int:
    """Return the stamp of the last request for a plan [ns]."""
    return node.controller.pursuit._plans._requester._stamp


def test_the_robot_backs_off_before_the_goal_has_ended(node, monkeypatch):
    """As far as the parameter says, straight off the object, and stands."""
    pursuit, pose, speeds = node.controller.pursuit, ROBOT, []
    plan = plan_push(problem_from_placement(SCENARIO.object, SCENARIO.robot, OBJECT, ROBOT, GOAL,
                                            SCENARIO.planner))
    handle = node.controller.goals.start(PushGoal(GOAL))
    monkeypatch.setattr(node.controller._commands, 'answer',
                        lambda twist, *_, **__: speeds.append(twist))
    cancelled_at = None
    for k in range(500):
        time = 100.0 + k * PERIOD
        node.controller.on_odometry(to_odometry_message(
            Odometry(time, pose, speeds[-1] if speeds else STOP), 'odom',
            'base_link'))
        node.controller.on_object_pose(to_object_pose_message(ObjectPose(time, OBJECT), 'odom'))
        if k == 1:
            node.controller.on_plan(to_plan_message(
                plan.trajectory, exact_stamp(request_stamp(node)), 'odom'))
        if pursuit.progress.state is PushState.PUSHING and k > 5 and cancelled_at is None:
            assert pursuit._supervisor.status.push.phase is Phase.PUSHING
            cancelled_at = pose
            node.controller.goals.cancel()
            assert pursuit.progress.state is PushState.RETREATING and handle.outcome is None
        # The object of this test stays where it is: what the robot moves until then is little.
        pose = pose @ Pose(*(PERIOD * speed for speed in speeds[-1]))
        if handle.outcome is not None:
            break
    assert handle.outcome is GoalOutcome.CANCELLED
    distance = math.dist(pose[:2], cancelled_at[:2])
    assert distance == pytest.approx(node._present_parameters.drive.retreat_distance, abs=0.02)
    gap = find_contact(SCENARIO.object, OBJECT, pose[:2], SCENARIO.robot.radius).gap
    assert gap > 0.9 * distance and speeds[-1][0] == pytest.approx(0.0, abs=0.02)


def test_the_answer_of_another_planner_does_not_disturb_a_push(node: ControllerNode) -> None:
    """As of one that was started meanwhile, or one that somebody else has asked for."""
    pursuit, shift = node.controller.pursuit, Pose(0.6, 0.0, 0.3)
    plan, other = (plan_push(problem_from_placement(
        SCENARIO.object, SCENARIO.robot, place @ OBJECT, place @ ROBOT, place @ GOAL,
        SCENARIO.planner)).trajectory for place in (Pose(0.0, 0.0, 0.0), shift))
    node.controller.goals.start(PushGoal(GOAL))

    def measure(time: float) -> None:
        node.controller.on_odometry(to_odometry_message(
            Odometry(time, ROBOT, STOP), 'odom', 'base_link'))
        node.controller.on_object_pose(to_object_pose_message(ObjectPose(time, OBJECT), 'odom'))

    measure(100.0)
    measure(100.0 + PERIOD)
    stamp = request_stamp(node)
    node.controller.on_plan(to_plan_message(plan, exact_stamp(stamp), 'odom'))
    measure(100.0 + 2.0 * PERIOD)
    assert pursuit.progress.state is PushState.PUSHING
    node.controller.on_plan(to_plan_message(other, exact_stamp(stamp), 'odom'))
    measure(100.0 + 3.0 * PERIOD)
    assert pursuit.progress.state is PushState.PUSHING
    node.controller.on_plan(to_plan_message(other, exact_stamp(stamp + 1), 'odom'))
    measure(100.0 + 4.0 * PERIOD)
    assert pursuit.progress.state is PushState.PUSHING


def test_a_goal_that_needs_no_push_is_reached(node: ControllerNode) -> None:
    """The request states the tolerances of the goal, and the answer ends it."""
    pursuit, near = node.controller.pursuit, OBJECT @ Pose(0.03, 0.0, 0.0)
    handle = node.controller.goals.start(PushGoal(near, position_tolerance=0.04))

    def measure(time: float) -> None:
        node.controller.on_odometry(to_odometry_message(
            Odometry(time, ROBOT, STOP), 'odom', 'base_link'))
        node.controller.on_object_pose(to_object_pose_message(ObjectPose(time, OBJECT), 'odom'))

    measure(100.0)
    measure(100.0 + PERIOD)
    assert pursuit.has_open_request
    heading_tolerance = SCENARIO.control.heading_tolerance
    assert pursuit._supervisor.plan_request.tolerances == (0.04, heading_tolerance)
    node.controller.on_plan(no_plan_message(
        PlanFailure.AT_GOAL, exact_stamp(request_stamp(node)), 'odom'))
    measure(100.0 + 2.0 * PERIOD)
    assert pursuit.progress.state is PushState.REACHED and handle.outcome is GoalOutcome.REACHED
    assert pursuit.progress.position_error == pytest.approx(0.03)
    assert not pursuit.is_commanding


def test_a_plan_is_requested_from_a_pose_that_is_newer_than_the_goal(node: ControllerNode) -> None:
    """
    Somebody may have moved the object just before: the last pose may be of where it was.

    Here it was at its goal, from where the planner would answer that no push is needed.
    """
    pursuit = node.controller.pursuit

    def measure(time: float, pose: Pose, pose_time: float) -> None:
        node.controller.on_odometry(to_odometry_message(
            Odometry(time, ROBOT, STOP), 'odom', 'base_link'))
        node.controller.on_object_pose(to_object_pose_message(
            ObjectPose(pose_time, pose), 'odom'))

    near = OBJECT @ Pose(0.05, 0.0, 0.0)
    measure(100.0, near, 100.0)
    measure(100.0 + PERIOD, near, 100.0 + PERIOD)
    node.controller.goals.start(PushGoal(near))
    # It was measured before the goal came, and comes after it.
    measure(100.0 + 2.0 * PERIOD, near, 100.0 + PERIOD)
    assert not pursuit.has_open_request and pursuit.progress.state is PushState.PLANNING
    measure(100.0 + 3.0 * PERIOD, OBJECT, 100.0 + 3.0 * PERIOD)
    request = pursuit._supervisor.plan_request
    assert request is not None and request.object_pose == pytest.approx(OBJECT)


def test_a_goal_ends_where_no_pose_comes_that_is_newer(node: ControllerNode) -> None:
    """The reason stands there all the time; the tracker may have died."""
    pursuit = node.controller.pursuit
    node.controller.on_object_pose(to_object_pose_message(ObjectPose(100.0, OBJECT), 'odom'))
    handle = None
    for k in range(1500):
        node.controller.on_odometry(to_odometry_message(
            Odometry(100.0 + k * PERIOD, ROBOT, STOP), 'odom', 'base_link'))
        if k == 2:
            handle = node.controller.goals.start(PushGoal(GOAL))
        if k == 500:
            assert pursuit.progress.state is PushState.PLANNING
            assert pursuit.progress.cause.code is PushEvent.OBJECT_POSE_STALE
    assert handle is not None and handle.outcome is GoalOutcome.FAILED
    assert handle.cause.codes == (
        PushEvent.GAVE_UP_WAITING, PushEvent.OBJECT_POSE_STALE) and not pursuit.has_open_request


def test_a_plan_is_requested_while_a_simulation_holds_its_time(node: ControllerNode) -> None:
    """It offers its first measurements again and again, until it is started."""
    pursuit = node.controller.pursuit

    def measure() -> None:
        node.controller.on_object_pose(to_object_pose_message(ObjectPose(100.0, OBJECT), 'odom'))
        node.controller.on_odometry(to_odometry_message(
            Odometry(100.0, ROBOT, STOP), 'odom', 'base_link'))
    measure()
    node.controller.goals.start(PushGoal(GOAL))
    assert not pursuit.has_open_request
    measure()
    assert pursuit.has_open_request


def test_two_publishers_of_odometry_are_named_where_their_stamps_differ(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """As two simulators in one domain: the robot stands, and the operator is told why."""
    reports: list[str] = []
    monkeypatch.setattr(node.reporter, 'report', lambda level, text, *_: reports.append(text))
    simulators = [rclpy.create_node(name) for name in ('sim_b', 'sim_a')]
    for simulator in simulators:
        simulator.create_publisher(OdometryMessage, 'odom', 1)
    while node.publishers_of('odom') != ['/sim_a', '/sim_b']:
        rclpy.spin_once(simulators[0], timeout_sec=0.02)
    for time in (100.0, 50.0):
        node.controller.on_odometry(to_odometry_message(
            Odometry(time, ROBOT, STOP), 'odom', 'base_link'))
    assert reports[-1] == (
        'odom: got a stamp that is 50.00 s behind the last odometry, expected one of the same '
        'clock; odom is published by /sim_a and /sim_b, expected one of them; stopped')
    for simulator in simulators:
        simulator.destroy_node()


class PlayedBase:
    """
    The controller's node in a push, and a base that follows its commands, or does not for a while.

    ``commands``: times since the beginning and what was commanded then.
    """

    def __init__(self, node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
        self.pursuit = node.controller.pursuit
        self.commands: list[tuple[float, Twist]] = []
        self._node = node
        self._time, self._pose, self._twist = 0.0, ROBOT, STOP
        self._object_from_robot = ROBOT.inverse() @ OBJECT
        monkeypatch.setattr(node.controller._commands, 'answer', self._on_command)
        plan = plan_push(problem_from_placement(
            SCENARIO.object, SCENARIO.robot, OBJECT, ROBOT, GOAL, SCENARIO.planner))
        self.handle = node.controller.goals.start(PushGoal(GOAL))
        self.run(2.0 * PERIOD)
        node.controller.on_plan(to_plan_message(
            plan.trajectory, exact_stamp(request_stamp(node)), 'odom'))

    def _on_command(self, twist: Twist, *_: object, **__: object) -> None:
        self.commands.append((self._time, twist))

    def run(self, duration: float, *, is_stopped: bool = False) -> list[Twist]:
        """Let time pass; return the commands."""
        count = len(self.commands)
        for _ in range(round(duration / PERIOD)):
            self._time += PERIOD
            stamp = 100.0 + self._time
            self._node.controller.on_odometry(to_odometry_message(
                Odometry(stamp, self._pose, self._twist), 'odom', 'base_link'))
            self._node.controller.on_object_pose(to_object_pose_message(ObjectPose(
                stamp, self._pose @ self._object_from_robot), 'odom'))
            self._twist = STOP if is_stopped else self.commands[-1][1]
            self._pose = self._pose @ Pose(*(PERIOD * value for value in self._twist))
        return [twist for _, twist in self.commands[count:]]


def tilted_pose(node: ControllerNode) -> None:
    """Let a pose come that stands on its side."""
    message = to_object_pose_message(ObjectPose(100.0, OBJECT), 'odom')
    message.pose.orientation.x, message.pose.orientation.w = math.sin(0.5), math.cos(0.5)
    node.controller.on_object_pose(message)


def cut_odometry(node: ControllerNode) -> None:
    """Let odometry come of which only the beginning has got through."""
    odom = next(each for topic, each in node.topic_subscriptions if topic == 'odom')
    odom.callback(bytes([0, 1, 0, 0, 7]))


@pytest.mark.parametrize('refuse', [tilted_pose, cut_odometry])
def test_the_robot_stands_while_messages_are_refused_beside_good_ones(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch,
        refuse: Callable[[ControllerNode], None]) -> None:
    """One costs a moment; more of them a stop until none has come for a while, with the reason."""
    base = PlayedBase(node, monkeypatch)
    zeros: list[None] = []
    monkeypatch.setattr(node.controller._commands, 'stop', lambda: zeros.append(None))
    assert base.run(2.0)[-1] != STOP
    refuse(node)
    assert (zeros or base.commands[-1][1] == STOP) and base.run(PERIOD)[0] == STOP
    assert base.run(0.5)[-1] != STOP
    for _ in range(50):
        refuse(node)
        assert set(base.run(PERIOD)) == {STOP}
    assert PushEvent.MEASUREMENT_REFUSED in codes(base.pursuit.progress.cause)
    assert set(base.run(0.4)) == {STOP} and base.run(0.5)[-1] != STOP


def stopped_push(node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> PlayedBase:
    """Push, and stop the base for five seconds."""
    base = PlayedBase(node, monkeypatch)
    assert any(twist != STOP for twist in base.run(2.0))
    base.run(5.0, is_stopped=True)
    return base


def test_a_push_waits_for_resume_after_an_emergency_stop(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every measurement is answered with zero until then; the goal stays, and says why."""
    base = stopped_push(node, monkeypatch)
    commands = base.run(3.0)
    assert len(commands) == 300 and set(commands) == {STOP}
    assert base.handle.outcome is None
    assert SafetyReason.BASE_STOOD in codes(base.pursuit.progress.cause)
    assert base.pursuit.resume().success
    assert any(twist != STOP for twist in base.run(0.5))
    assert base.pursuit.progress.state is PushState.PUSHING
    assert base.pursuit.progress.cause is None
    assert not base.pursuit.resume().success


def test_a_push_that_waits_is_cancelled_where_it_stands(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody has said that the robot may move."""
    base = stopped_push(node, monkeypatch)
    node.controller.goals.cancel()
    assert base.handle.outcome is GoalOutcome.CANCELLED
    assert set(base.run(1.0)) == {STOP}


def test_another_goal_lets_a_push_go_on(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the plan that there is, until there is another."""
    base = stopped_push(node, monkeypatch)
    assert set(base.run(1.0)) == {STOP}
    node.controller.goals.start(PushGoal(Pose(0.1, 0.0, 0.0) @ GOAL))
    assert any(twist != STOP for twist in base.run(0.5))


def test_a_push_goes_on_where_there_is_no_plan_to_another_goal(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """That goal has ended, and says so; its predecessor has made room for it before."""
    base = PlayedBase(node, monkeypatch)
    base.run(2.0)
    handle = node.controller.goals.start(PushGoal(Pose(0.1, 0.0, 0.0) @ GOAL))
    assert base.handle.outcome is GoalOutcome.REPLACED
    base.run(2.0 * PERIOD)
    assert base.pursuit.has_open_request
    node.controller.on_plan(no_plan_message(
        PlanFailure.BLOCKED, exact_stamp(request_stamp(node)), 'odom'))
    commands = base.run(0.5)
    assert handle.outcome is GoalOutcome.NO_PLAN
    assert PlanFailure.BLOCKED in handle.cause.codes
    assert STOP not in commands and base.pursuit.is_commanding
    assert not base.pursuit.has_open_request


def test_a_goal_that_waits_for_its_plan_at_the_end_of_a_push_is_not_reached_by_it(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """The plan is requested once more, from where the robot stands then."""
    base = PlayedBase(node, monkeypatch)
    base.run(2.0)
    handle = node.controller.goals.start(PushGoal(Pose(0.1, 0.0, 0.0) @ GOAL))
    base.run(2.0 * PERIOD)
    first = base.pursuit._supervisor.plan_request
    for _ in range(30):
        if base.pursuit.progress.state is not PushState.PUSHING:
            break
        base.run(1.0)
    second = base.pursuit._supervisor.plan_request
    assert base.pursuit.progress.state is PushState.PLANNING and handle.outcome is None
    assert first is not None and second is not None
    assert math.dist(first.object_pose[:2], second.object_pose[:2]) > 0.1


def test_the_robot_goes_on_by_itself_where_that_is_chosen(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """Under way, too."""
    base = PlayedBase(node, monkeypatch)
    base.run(2.0)
    result = node.set_parameters([Parameter('control.resume_after_stop', value='automatic')])
    assert result[0].successful
    base.run(5.0, is_stopped=True)
    assert any(twist != STOP for twist in base.run(3.0))
    refused = node.set_parameters([Parameter('control.resume_after_stop', value='never')])
    assert not refused[0].successful and 'on_request' in refused[0].reason


@pytest.mark.parametrize('name', ['control.pose_bias', 'supervision.odometry_reference',
                                  'robot.radius'])
def test_what_the_controller_is_built_with_is_refused_with_the_reason(
        node: ControllerNode, name: str) -> None:
    """While it runs; other values of what stands beside it are taken."""
    value = node.get_parameter(name).value
    refused = node.set_parameters_atomically([
        Parameter('control.lateral_gain', value=12.0), Parameter(name, value=value)])
    assert not refused.successful
    assert refused.reason == f'{name}: {READ_ONLY}'
    assert node.get_parameter('control.lateral_gain').value != 12.0
    assert node.describe_parameter(name).read_only
    assert node.set_parameters_atomically([
        Parameter('control.lateral_gain', value=12.0)]).successful


def test_a_touch_counts_with_the_odometry_that_was_published_after_it(
        node: ControllerNode) -> None:
    """Both have come when the node gets round to them."""
    base, subscriptions = rclpy.create_node('base'), dict(node.topic_subscriptions)
    odometry = to_odometry_message(Odometry(100.0, ROBOT, STOP), 'odom', 'base_link')
    messages = {'bumper': Bool(data=True), 'odom': odometry}
    publishers = {topic: base.create_publisher(type(message), topic, TOPICS[topic].publish_qos)
                  for topic, message in messages.items()}
    waiter = MessageWaiter(node.context)
    try:
        for topic, publisher in publishers.items():
            # Until publisher and subscription know each other.
            while take_message(subscriptions[topic]) is None:
                publisher.publish(messages[topic])
                waiter.wait([subscriptions[topic]], 0.1)
        for topic, publisher in publishers.items():
            publisher.publish(messages[topic])
            waiter.wait([subscriptions[topic]], 60.0)
        node.poll()
    finally:
        base.destroy_node()
    observation = node.controller._latest.observation
    assert observation is not None and observation.is_bumper_pressed


def test_there_is_a_controller_from_configuring_to_cleaning_up(node: ControllerNode) -> None:
    """And another one after that; parameters are set in between, too."""
    first = node.controller
    node.trigger_deactivate()
    node.trigger_cleanup()
    with pytest.raises(RuntimeError, match='controller: got none'):
        _ = node.controller
    assert node.set_parameters([Parameter('object.mass', value=2.0)])[0].successful
    node.trigger_configure()
    node.trigger_activate()
    assert node.controller is not first and node.controller.goals.is_idle
