"""A single push under way: the controller's node, with a robot that is played here."""

import math

from nav_msgs.msg import Odometry as OdometryMessage
from push_control.controller_node import ControllerNode
from push_control.goal import GoalOutcome, PushGoal, PushState
from push_control.push.status import Phase
from push_control.ros.single_push import SinglePushMode
from push_model.contact import find_contact
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.signals import ObjectPose, Odometry, STOP
from push_planner.problem import problem_from_placement
from push_planner.single_push.planner import plan_push
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.primitives import exact_stamp
from push_ros.topics import CONTROLLER
from push_scenario.dds.processes import private_domain
from push_scenario.definition.loader import load_scenario
import pytest
import rclpy
import yaml

pytestmark = pytest.mark.dds

SCENARIO = load_scenario('straight_push')
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PERIOD = 0.02


@pytest.fixture
def node(tmp_path, monkeypatch):
    """Make the controller, active."""
    path = tmp_path / 'controller.yaml'
    path.write_text(yaml.safe_dump({CONTROLLER: {'ros__parameters': {
        **to_parameter_values(SCENARIO.object, 'object.'),
        **to_parameter_values(SCENARIO.robot, 'robot.')}}}))
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
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


def test_the_robot_backs_off_before_the_goal_has_ended(node, monkeypatch):
    """As far as the parameter says, straight off the object, and stands."""
    mode, pose, speeds = node.goals._mode, ROBOT, []
    plan = plan_push(problem_from_placement(SCENARIO.object, SCENARIO.robot, OBJECT, ROBOT, GOAL,
                                            SCENARIO.planner))
    handle = node.goals.start(PushGoal(GOAL))
    monkeypatch.setattr(node._commands, 'answer', lambda twist, *_, **__: speeds.append(twist))
    cancelled_at = None
    for k in range(500):
        time = 100.0 + k * PERIOD
        node._on_odometry(to_odometry_message(
            Odometry(time, pose, speeds[-1] if speeds else STOP), 'odom',
            'base_link'))
        node._on_object_pose(to_object_pose_message(ObjectPose(time, OBJECT), 'odom'))
        if k == 1:
            node._on_plan(to_plan_message(
                plan.trajectory, exact_stamp(mode._requester._stamp), 'odom'))
        if mode.progress.state is PushState.PUSHING and k > 5 and cancelled_at is None:
            assert mode._controller.status.phase is Phase.PUSHING
            cancelled_at = pose
            node.goals.cancel()
            assert mode.progress.state is PushState.RETREATING and handle.outcome is None
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
    """As of one that was started meanwhile; a plan that somebody else asked for is set."""
    mode, shift = node.goals._mode, Pose(0.6, 0.0, 0.3)
    assert isinstance(mode, SinglePushMode)
    plan, other = (plan_push(problem_from_placement(
        SCENARIO.object, SCENARIO.robot, place @ OBJECT, place @ ROBOT, place @ GOAL,
        SCENARIO.planner)).trajectory for place in (Pose(0.0, 0.0, 0.0), shift))
    node.goals.start(PushGoal(GOAL))

    def measure(time: float) -> None:
        node._on_odometry(to_odometry_message(Odometry(time, ROBOT, STOP), 'odom', 'base_link'))
        node._on_object_pose(to_object_pose_message(ObjectPose(time, OBJECT), 'odom'))

    measure(100.0)
    measure(100.0 + PERIOD)
    stamp = mode._requester._stamp
    node._on_plan(to_plan_message(plan, exact_stamp(stamp), 'odom'))
    measure(100.0 + 2.0 * PERIOD)
    assert mode.progress.state is PushState.PUSHING
    node._on_plan(to_plan_message(other, exact_stamp(stamp), 'odom'))
    measure(100.0 + 3.0 * PERIOD)
    assert mode.progress.state is PushState.PUSHING
    node._on_plan(to_plan_message(other, exact_stamp(stamp + 1), 'odom'))
    measure(100.0 + 4.0 * PERIOD)
    assert mode.progress.state is PushState.FAILED
    assert 'the object is not where the plan starts' in mode.progress.reason


def test_two_publishers_of_odometry_are_named_where_their_stamps_differ(
        node: ControllerNode, monkeypatch: pytest.MonkeyPatch) -> None:
    """As two simulators in one domain: the robot stands, and the operator is told why."""
    reports: list[str] = []
    monkeypatch.setattr(node.reporter, 'report', lambda level, text, *_: reports.append(text))
    simulators = [rclpy.create_node(name) for name in ('sim_b', 'sim_a')]
    for simulator in simulators:
        simulator.create_publisher(OdometryMessage, 'odom', 1)
    while len(node.publishers_of('odom')) < len(simulators):
        rclpy.spin_once(simulators[0], timeout_sec=0.02)
    for time in (100.0, 50.0):
        node._on_odometry(to_odometry_message(Odometry(time, ROBOT, STOP), 'odom', 'base_link'))
    assert reports[-1] == (
        'odom: got a stamp that is 50.00 s behind the last odometry, expected one of the same '
        'clock; odom is published by /sim_a and /sim_b, expected one of them; stopped')
    for simulator in simulators:
        simulator.destroy_node()
