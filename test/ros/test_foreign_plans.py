"""Plans that nobody has asked for, or that do not fit, over Fast DDS: none moves the robot."""

from collections.abc import Callable, Iterator
import dataclasses
import math
from typing import Any

from geometry_msgs.msg import PoseStamped
from helpers.node_bench import Bench, bench
from helpers.single_push_bench import (
    GOAL, OBJECT, PERIOD, PHYSICS, plan, ROBOT, SCENARIO, SinglePushBench, ZERO,
)
import numpy as np
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_model.signals import ObjectPose, Odometry, STOP
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_planner.task_planner import plan_for_request
from push_ros.conversions.map import to_map_message
from push_ros.conversions.measurements import to_object_pose_message, to_odometry_message
from push_ros.conversions.plan import to_plan_message
from push_ros.conversions.plan_request import from_request_message
from push_ros.conversions.primitives import (
    exact_stamp, nanoseconds, to_pose_message, to_stamp,
)
from push_ros.diagnostics import ERROR, WARN
from push_ros.qos import LATCHED
from push_ros.topics import CONTROLLER
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest
from trajectory_msgs.msg import JointTrajectory

pytestmark = [pytest.mark.dds, pytest.mark.slow]

TASK = read_scenario(find_scenario('task_approach'))
UNREQUESTED = 'push_plan: a plan is not driven, as this node has not requested it'
ANSWERED = 'push_plan: a plan is not driven, as its request has been answered, or given up'
FREE = np.zeros((120, 120), dtype=bool)


@pytest.fixture(scope='module')
def valid() -> PushTrajectory:
    """Plan the push that is asked for."""
    return plan()


@pytest.fixture(scope='module')
def lasting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SinglePushBench]:
    """Start a controller with settings of their own defaults."""
    with bench(tmp_path_factory.mktemp('plans'), CONTROLLER, 'push_control.controller_node',
               {**PHYSICS, 'use_sim_time': True, 'lockstep': True}) as b:
        made = SinglePushBench(b)
        made.introduce()
        yield made


@pytest.fixture
def controller(lasting: SinglePushBench) -> SinglePushBench:
    """Give the controller no goal."""
    lasting.put_back()
    return lasting


def test_a_plan_without_any_goal_is_not_driven(controller: SinglePushBench,
                                               valid: PushTrajectory) -> None:
    """Its sender is named, and nothing moves."""
    controller.measure()
    controller.send(valid, to_stamp(controller.now))
    assert controller.wait_for(UNREQUESTED, WARN).endswith(controller.sender)
    assert controller.measure() == {ZERO}


def test_a_plan_with_the_stamp_of_another_request_is_not_driven(
        controller: SinglePushBench, valid: PushTrajectory) -> None:
    """The goal goes on waiting: the answer to its request is driven."""
    stamp = nanoseconds(controller.request().header.stamp)
    for other in (stamp - 1, stamp + 1):
        controller.send(valid, exact_stamp(other))
        controller.wait_for(UNREQUESTED, WARN)
        assert controller.measure() == {ZERO}
    controller.send(valid, exact_stamp(stamp))
    controller.drive()


def faster(trajectory: PushTrajectory) -> PushTrajectory:
    """Drive the same path ten times as fast."""
    twists = {name: 10.0 * getattr(trajectory, name)
              for name in ('object_twists', 'contact_twists', 'robot_twists')}
    return dataclasses.replace(trajectory, times=0.1 * trajectory.times, **twists)


def stated_faster(trajectory: PushTrajectory) -> PushTrajectory:
    """State velocities that the poses do not have."""
    return dataclasses.replace(trajectory, robot_twists=50.0 * trajectory.robot_twists)


def larger_object() -> Any:
    """Make an object of the same form, half as large again."""
    obj = SCENARIO.object
    return dataclasses.replace(obj, outline=tuple((1.5 * x, 1.5 * y) for x, y in obj.outline))


def plan_for_larger_object(_: PushTrajectory) -> PushTrajectory:
    """Plan for an object with whose outline the robot stands further away."""
    direction = math.atan2(GOAL.y - OBJECT.y, GOAL.x - OBJECT.x)
    reach = math.hypot(*SCENARIO.object.outline[0])
    robot = Pose(ROBOT.x - 0.5 * reach * math.cos(direction),
                 ROBOT.y - 0.5 * reach * math.sin(direction), ROBOT.theta)
    return plan(obj=larger_object(), robot=robot)


ATTACKS: dict[str, tuple[Callable[[PushTrajectory], PushTrajectory], str]] = {
    'object': (plan_for_larger_object, 'the plan is for another object or robot: got a gap of'),
    'start': (lambda _: plan(Pose(0.6, 0.0, 0.0)), 'the plan starts where the object is not'),
    'end': (lambda _: plan(goal=Pose(1.5, *GOAL[1:])), 'the plan ends beside the goal: got'),
    'speed': (faster, 'the plan is beyond the robot: got 1.5 m/s, expected at most 0.3 m/s'),
    'stated speed': (stated_faster, 'the plan is beyond the robot: got 7.5 m/s')}


@pytest.mark.parametrize('name', ATTACKS)
def test_an_answer_that_does_not_fit_its_request_is_not_driven(
        controller: SinglePushBench, valid: PushTrajectory, name: str) -> None:
    """Though it has the stamp of the request; the goal has no plan then, and the robot stands."""
    spoil, text = ATTACKS[name]
    controller.send(spoil(valid), controller.request().header.stamp)
    assert controller.wait_for(text, ERROR).endswith(f'{controller.sender}; stopped')
    assert controller.measure() == {ZERO}


def not_a_number(message: JointTrajectory) -> None:
    """Spoil a number in the middle."""
    message.points[3].positions[list(message.joint_names).index('robot.x')] = math.nan


def endless(message: JointTrajectory) -> None:
    """Spoil a velocity."""
    message.points[3].velocities[list(message.joint_names).index('object.x')] = math.inf


def back_in_time(message: JointTrajectory) -> None:
    """Let a sample be before the last."""
    message.points[4].time_from_start = message.points[1].time_from_start


@pytest.mark.parametrize('spoil, text', [
    (not_a_number, 'robot.x: got nan'), (endless, 'object.x: got inf'),
    (back_in_time, 'increasing times')])
def test_an_answer_that_is_none_is_not_driven(
        controller: SinglePushBench, valid: PushTrajectory,
        spoil: Callable[[JointTrajectory], None], text: str) -> None:
    """Numbers that are none are refused with their field."""
    message = to_plan_message(valid, controller.request().header.stamp, 'odom')
    spoil(message)
    controller.b.publish('push_plan', message)
    assert controller.wait_for(text, ERROR).endswith(f'{controller.sender}; stopped')
    assert controller.measure() == {ZERO}


def test_an_answer_through_a_wall_of_the_map_is_not_driven(
        controller: SinglePushBench, valid: PushTrajectory) -> None:
    """Whatever the planner has looked at; without the wall the same plan is driven."""
    wall = FREE.copy()
    middle = Pose(0.5 * (OBJECT.x + GOAL.x), 0.5 * (OBJECT.y + GOAL.y), 0.0)
    column = round((middle.x + 3.0) / 0.05)
    wall[:, column:column + 2] = True
    for occupied, text, level in ((wall, 'the plan leads the object into an obstacle', ERROR),
                                  (FREE, 'task: push', b'\0')):
        controller.b.publish('map', to_map_message(
            OccupancyMap(0.05, Pose(-3.0, -3.0, 0.0), occupied), to_stamp(0.0), 'odom'))
        # Maps are read in the background, requests with the measurements: a service comes later.
        controller.b.wait_until_handled('map', 'controller/pause')
        controller.send(valid, controller.request().header.stamp)
        controller.wait_for(text, level)
        assert (controller.measure() == {ZERO}) == (level == ERROR)


def test_nobody_else_disturbs_a_push(controller: SinglePushBench, valid: PushTrajectory) -> None:
    """Neither a valid plan of another node nor one that is replayed; both are reported."""
    request = controller.request()
    controller.send(valid, request.header.stamp)
    controller.drive()
    controller.b.received['diagnostics'].clear()
    other = controller.b.node_beside('stranger')
    publisher = other.create_publisher(JointTrajectory, 'push_plan', LATCHED)
    controller.b.wait_until(publisher.get_subscription_count)
    for trajectory, stamp, text in (
            (valid, to_stamp(controller.now), UNREQUESTED),
            (plan(goal=Pose(1.5, *GOAL[1:])), request.header.stamp, ANSWERED)):
        message = to_plan_message(trajectory, stamp, 'odom')
        # A plan may come before the name of its sender is known.
        senders = f'{text}; {controller.sender} and /stranger'
        controller.b.repeat_until(lambda: publisher.publish(message),
                                  lambda: controller.reports(senders, WARN))
        controller.b.received['diagnostics'].clear()
        assert ZERO not in controller.measure()
    other.destroy_publisher(publisher)
    controller.put_back()
    stale = request.header.stamp
    fresh = controller.request()
    controller.send(valid, stale)
    controller.wait_for(ANSWERED, WARN)
    assert controller.measure() == {ZERO} and fresh.header.stamp != stale


def test_unrequested_plans_are_driven_where_that_is_allowed(
        tmp_path_factory: pytest.TempPathFactory, valid: PushTrajectory) -> None:
    """A program that plans by itself; what does not start at the object is refused anyway."""
    with bench(tmp_path_factory.mktemp('own'), CONTROLLER, 'push_control.controller_node',
               {**PHYSICS, 'use_sim_time': True, 'lockstep': True,
                'accept_unrequested_plans': True}) as b:
        controller = SinglePushBench(b)
        controller.measure()
        controller.send(plan(Pose(0.6, 0.0, 0.0)), to_stamp(controller.now))
        controller.wait_for('the plan starts where the object is not', ERROR)
        assert controller.measure() == {ZERO}
        controller.send(valid, to_stamp(controller.now))
        controller.drive()


def test_a_task_drives_only_answers_that_fit(tmp_path_factory: pytest.TempPathFactory) -> None:
    """What is wrong is named with its sender, and another plan is requested."""
    start, place = TASK.start.object.pose, TASK.robot_start
    with bench(tmp_path_factory.mktemp('task'), CONTROLLER, 'push_control.controller_node',
               {**to_parameter_values(TASK.object, 'object.'),
                **to_parameter_values(TASK.robot, 'robot.'), 'use_sim_time': True, 'task': True,
                'lockstep': True}) as b:
        for topic in ('cmd_vel', 'diagnostics', 'push_request'):
            b.subscribe(topic)
        task = TaskBench(b, start, place)
        requested: PlanRequest = from_request_message(task.requests[-1], 'odom')
        trajectory = plan_for_request(requested, TASK.robot, TASK.planner,
                                      TASK.task.drive).trajectory
        task.send(trajectory, to_stamp(1e-3))
        task.wait_for(UNREQUESTED, WARN)
        assert len(task.requests) == 1
        moved = dataclasses.replace(trajectory, **{
            f'{joint}_poses': getattr(trajectory, f'{joint}_poses') + (0.3, 0.0, 0.0)
            for joint in ('object', 'contact', 'robot')})
        line = trajectory.straight_line()
        back = line._replace(start=line.start @ Pose(-0.2, 0.0, 0.0))
        apart = dataclasses.replace(trajectory, line=back, robot_poses=back.robot_poses(
            Pose(*trajectory.object_poses[0]), np.linspace(0.0, line.length,
                                                           len(trajectory.times))))
        elsewhere = dataclasses.replace(trajectory, line=line._replace(face=40))
        for spoilt, text in ((moved, 'the plan starts where the object is not'),
                             (apart, 'the plan is for another object or robot'),
                             (faster(trajectory), 'the plan is beyond the robot'),
                             (elsewhere, 'got a push at face 40, expected one from 0 to')):
            count = len(task.requests)
            task.send(spoilt, task.requests[-1].header.stamp)
            assert task.wait_for(text, ERROR).endswith(f'{task.sender}; stopped')
            task.measure_until(lambda: len(task.requests) > count)
        assert all(command.twist.linear.x == 0.0 for command in b.received['cmd_vel'])


class TaskBench:
    """A controller at a task that has requested its first plan."""

    def __init__(self, b: Bench, start: Pose, place: Pose) -> None:
        self.b, self.start, self.place, self.now = b, start, place, 0.0
        self.requests = b.received['push_request']
        b.wait_until(lambda: b.received['diagnostics'])
        b.clock(0.0)
        b.connect(start, place)
        self.introduce()
        message = PoseStamped(pose=to_pose_message(TASK.goal.pose))
        message.header.frame_id = 'odom'
        b.publish('goal_pose', message)
        self.measure_until(lambda: self.requests)

    def measure_until(self, condition: Callable[[], Any]) -> None:
        """Measure until something holds; what waits for a plan is not answered before it."""
        def measure() -> None:
            self.now += PERIOD
            self.b.clock(self.now)
            for topic, message in self._measurements():
                self.b.publish(topic, message)
        self.b.repeat_until(measure, condition, period=0.01)

    def _measurements(self) -> list[tuple[str, Any]]:
        return [('object_pose', to_object_pose_message(ObjectPose(self.now, self.start), 'odom')),
                ('odom', to_odometry_message(Odometry(self.now, self.place, STOP), 'odom',
                                             'base_link'))]

    sender, introduce, send = (
        SinglePushBench.sender, SinglePushBench.introduce, SinglePushBench.send)
    reports, wait_for = SinglePushBench.reports, SinglePushBench.wait_for
