"""Single nodes over Fast DDS, with time in the hands of the test."""

import contextlib
import dataclasses
import math
import signal
import subprocess
import sys

from geometry_msgs.msg import PoseStamped, Twist as TwistMessage
from helpers.node_bench import bench, REACTION_TIMEOUT
from push_model.files.data import config_file
from push_model.files.flat_values import to_parameter_values
from push_model.geometry import distance, Pose
from push_model.plan_request import PlanFailure, PlanRequest, RequestKind
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_planner.problem import problem_from_placement
from push_planner.steered.planner import plan_push
from push_ros.conversions.measurements import (
    from_object_pose_message, to_object_pose_message, to_odometry_message,
)
from push_ros.conversions.plan import from_plan_message, plan_failure, to_plan_message
from push_ros.conversions.plan_request import to_request_message
from push_ros.conversions.primitives import check_frame, nanoseconds, to_pose_message, to_stamp
from push_ros.diagnostics import ERROR, status_values, WARN
from push_ros.push_interfaces import STATUS
from push_ros.security_policy import permissions_of, POSES_OF_OBJECTS
from push_ros.topics import CONTROLLER, PLANNER, SERVICES, SIM, TOPICS
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
from push_scenario.simulation.loop import make_simulation
from push_sim_node.sensors import SensorSettings
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]

MODULES = {PLANNER: 'push_planner.planner_node', CONTROLLER: 'push_control.controller_node',
           SIM: 'push_sim_node.sim_node'}
SCENARIO = read_scenario(find_scenario('straight_push'))
OBJECT, ROBOT = SCENARIO.start.object.pose, SCENARIO.robot_start
GOAL = SCENARIO.goal.pose
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
AWAY = {'robot_start': [-2.0, 0.0, 0.0]}
ZERO = (0.0, 0.0, 0.0)
LATE = SensorSettings(pose_noise=2e-3, pose_heading_noise=5e-3, pose_latency=0.08)
STOP_TIME = 0.3
# Time between two tests of one controller [s]: no step of odometry, and no clock that has jumped.
GAP = 0.7
PERIOD = 0.02


@pytest.fixture(scope='module')
def trajectory():
    """Plan the straight push."""
    return plan_push(problem_from_placement(SCENARIO.object, SCENARIO.robot, OBJECT, ROBOT, GOAL,
                                            SCENARIO.planner)).trajectory


@pytest.fixture(scope='module')
def lasting(tmp_path_factory):
    """Start a controller on simulated time for several tests."""
    with running_controller(tmp_path_factory.mktemp('controller')) as b:
        yield b


@pytest.fixture
def controller(lasting, trajectory):
    """Give the controller a plan, and let it begin to push; each test has a time of its own."""
    lasting.base = lasting.latest + GAP
    return begin(lasting, trajectory)


@contextlib.contextmanager
def running_controller(folder):
    """Start a controller on simulated time that follows whatever plan it gets, at once."""
    parameters = {**PHYSICS, 'use_sim_time': True, 'lockstep': True,
                  'accept_unrequested_plans': True,
                  'control.resume_after_stop': 'automatic'}
    with bench(folder, CONTROLLER, MODULES[CONTROLLER], parameters) as b:
        b.subscribe('cmd_vel')
        b.subscribe('diagnostics')
        b.wait_until(lambda: b.received['diagnostics'])
        yield b


def begin(b, trajectory):
    """Hand over the plan, and see the first 0.2 s of the push."""
    b.received['diagnostics'].clear()
    b.clock(0.0)
    hand_over(b, trajectory, 0.0)
    b.wait_until(lambda: 'task: push' in last_text(b))
    b.connect(OBJECT, ROBOT)
    for i in range(10):
        command = b.odometry(i * PERIOD, ROBOT)
        if i % 2:
            b.object_pose(i * PERIOD, OBJECT)
    assert command[0] > 0.0
    for messages in b.received.values():
        messages.clear()
    return b


def hand_over(b, trajectory, time):
    """Hand over a plan that is made at some time, and wait until the controller has taken it."""
    b.publish('push_plan', to_plan_message(trajectory, to_stamp(b.base + time), 'odom'))
    b.wait_until_handled('push_plan', 'controller/resume')


def last_text(b, name=None):
    """Text of the last diagnostics, of one node or of any; not of the topics it waits for."""
    found = [status.message for message in b.received['diagnostics'] for status in message.status
             if name == status.name or name is None and not status.name.endswith(': inputs')]
    return found[-1] if found else ''


def errors(b):
    """Texts of all errors that were reported."""
    return [status.message for message in b.received['diagnostics'] for status in message.status
            if status.level == ERROR]


def test_every_measurement_gets_one_command(controller):
    """Stamped with it, in the robot's frame; a measurement that comes again, the same command."""
    first = controller.odometry(0.22, ROBOT)
    assert controller.odometry(0.22, ROBOT) == first != ZERO
    assert controller.object_pose(0.22, OBJECT)[0] > 0.0
    controller.spin(0.2)
    assert len(controller.received['cmd_vel']) == 3
    assert {m.header.frame_id for m in controller.received['cmd_vel']} == {'base_link'}


def test_a_stale_pose_stops_the_robot(controller):
    """Odometry goes on, poses do not."""
    stopped = first_stop(controller, lambda now: None)
    assert 0.1 < stopped - 0.18 <= STOP_TIME
    controller.wait_until(lambda: any('pose' in text for text in texts(controller)))


@pytest.mark.parametrize('pose, frame, text', [
    ((math.nan, 0.0, 0.0), 'odom', 'object_pose: got the position'),
    ((0.0, 0.0, math.nan), 'odom', 'object_pose: got the quaternion'),
    ((*OBJECT,), 'camera', "object_pose: got frame 'camera', expected 'odom'")],
    ids=['nan', 'quaternion', 'frame'])
def test_an_unusable_pose_stops_the_robot(controller, pose, frame, text):
    """It is answered with zero itself, and odometry too once the last good pose is stale."""
    def spoil(now):
        assert controller.object_pose(now, pose, frame) == ZERO

    assert first_stop(controller, spoil) - 0.18 <= STOP_TIME
    controller.wait_until(lambda: any(text in error for error in errors(controller)))


def test_unusable_odometry_stops_the_robot(tmp_path, trajectory) -> None:
    """At once, and at the next odometry; once more within two seconds, for longer."""
    with running_controller(tmp_path) as b:
        begin(b, trajectory)
        assert b.odometry(0.2, (math.nan, 0.0, 0.0)) == ZERO
        assert b.odometry(0.22, ROBOT) == ZERO
        assert b.odometry(0.24, ROBOT)[0] > 0.0
        assert b.odometry(0.26, ROBOT, 'map') == ZERO
        b.wait_until(lambda: any("odom: got frame 'map', expected 'odom'" in error
                                 for error in errors(b)))
        b.object_pose(0.28, OBJECT)
        assert [b.odometry(0.28 + i * PERIOD, ROBOT) for i in range(5)] == [ZERO] * 5


def first_stop(b, spoil):
    """Go on with odometry, and something else for poses; time of the first lasting stop."""
    stopped = None
    for i in range(10, 30):
        now = i * PERIOD
        if b.odometry(now, ROBOT) == ZERO:
            stopped = now if stopped is None else stopped
        else:
            stopped = None
        if i % 2:
            spoil(now)
    assert stopped is not None
    return stopped


def texts(b):
    """All texts that were reported."""
    return [status.message for message in b.received['diagnostics'] for status in message.status]


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_the_robot_stops_when_the_controller_is_shut_down(tmp_path, trajectory, number):
    """The zero command goes out before the node does, and the exit status is 0."""
    with running_controller(tmp_path) as b:
        begin(b, trajectory)
        b.processes.send(CONTROLLER, number)
        b.processes.stop(CONTROLLER)
        b.wait_until(lambda: b.received['cmd_vel'], REACTION_TIMEOUT)
        command = b.received['cmd_vel'][0].twist
        assert (command.linear.x, command.linear.y, command.angular.z) == ZERO


def test_stop_and_start(controller):
    """Stopped, it answers zero; started, it pushes."""
    assert controller.call('controller/stop').success
    assert controller.odometry(0.2, ROBOT) == ZERO
    assert controller.call('controller/start').success
    assert controller.odometry(0.22, ROBOT)[0] > 0.0


def test_a_plan_that_is_refused_stops_the_push(controller, trajectory):
    """In another frame it is no plan of ours."""
    controller.publish('push_plan', to_plan_message(trajectory, to_stamp(0.1), 'map'))
    controller.wait_until(lambda: any("push_plan: got frame 'map'" in error
                                      for error in errors(controller)))
    assert controller.odometry(0.2, ROBOT) == ZERO


def test_a_plan_from_another_site_stops_the_push(controller):
    """The robot does not set out blindly: it is told where to stand."""
    opposite = Pose(-ROBOT.x, -ROBOT.y, ROBOT.theta + math.pi)
    elsewhere = plan_push(problem_from_placement(SCENARIO.object, SCENARIO.robot, OBJECT, opposite,
                                                 Pose(-1.0, 0.0, OBJECT.theta), SCENARIO.planner))
    hand_over(controller, elsewhere.trajectory, 0.1)
    assert controller.odometry(0.2, ROBOT) == controller.object_pose(0.22, OBJECT) == ZERO
    controller.wait_until(lambda: any(f'it must stand at {opposite.x:.3f} m, ' in error
                                      for error in errors(controller)))


def test_a_plan_older_than_the_node_waits_for_a_start(controller, trajectory):
    """It was latched for somebody else."""
    controller.publish('push_plan', to_plan_message(trajectory, to_stamp(0.5), 'odom'))
    controller.wait_until(lambda: any('task: idle' in text for text in texts(controller)))
    assert controller.odometry(0.2, ROBOT) == ZERO
    controller.wait_until(lambda: any('the plan is older than this node' in text
                                      for text in texts(controller)))
    assert controller.call('controller/start').success
    assert controller.odometry(0.22, ROBOT)[0] > 0.0


def test_time_that_goes_back_ends_the_push(controller):
    """One wrong stamp is refused; a simulator that was put back to the start needs a new plan."""
    for i in range(10, 75):
        controller.odometry(i * PERIOD, ROBOT)
    assert controller.odometry(0.0, ROBOT) == controller.object_pose(0.0, OBJECT) == ZERO
    controller.wait_until(lambda: any('odom: got a stamp that is 1.48 s behind' in error
                                      for error in errors(controller)))
    assert not any('time went back' in text for text in texts(controller))
    controller.base = controller.latest = 0.0
    for i in range(3):
        assert controller.odometry(i * PERIOD, ROBOT) == ZERO
    controller.wait_until(lambda: any('time went back' in text for text in texts(controller)))
    controller.wait_until(lambda: 'task: idle, time went back' in last_text(controller))


def test_commands_without_stamp_and_a_start_by_hand(tmp_path, trajectory):
    """Twist for robots that want it; nothing moves before controller/start."""
    parameters = {**PHYSICS, 'enable_stamped_cmd_vel': False, 'wait_for_start': True,
                  'lockstep': True, 'accept_unrequested_plans': True}
    with bench(tmp_path, CONTROLLER, MODULES[CONTROLLER], parameters) as b:
        b.subscribe('cmd_vel', TwistMessage)
        refused = b.call('controller/start')
        assert not refused.success and 'push_plan' in refused.message
        b.publish('push_plan', to_plan_message(trajectory, to_stamp(0.0), 'odom'))
        b.connect(OBJECT, ROBOT)
        assert b.odometry(0.0, ROBOT) == ZERO
        b.wait_until(lambda: b.call('controller/start').success)
        # Commands without a stamp may be late answers to what was offered first.
        b.wait_until(lambda: b.odometry(0.02, ROBOT)[0] > 0.0)


@pytest.fixture(scope='module')
def planner(tmp_path_factory):
    """Start a planner that has not measured anything yet."""
    folder = tmp_path_factory.mktemp('planner')
    with bench(folder, PLANNER, MODULES[PLANNER], PHYSICS) as b:
        for topic in ('push_plan', 'planned_path', 'diagnostics'):
            b.subscribe(topic)
        b.wait_until(lambda: b.received['diagnostics'])
        yield b


def goal(pose, frame='odom'):
    """Make a goal."""
    message = PoseStamped(pose=to_pose_message(pose))
    message.header.frame_id = frame
    return message


def request(pose, time=1.0, kind=RequestKind.STEERED_PUSH):
    """Make a request for a plan to a goal."""
    wanted = PlanRequest(OBJECT, ROBOT, pose, SCENARIO.object, kind=kind)
    return to_request_message(wanted, to_stamp(time), 'odom')


def measure(b):
    """Publish what is measured at 1.5 s."""
    b.publish('object_pose', to_object_pose_message(ObjectPose(1.4, OBJECT), 'odom'))
    b.publish('odom', to_odometry_message(Odometry(1.5, ROBOT, STOP), 'odom', 'base_link'))


def test_the_planner_answers_a_request(planner, trajectory):
    """It waits for measurements; the plan has the stamp of the request, and is the planner's."""
    planner.publish('push_request', request(GOAL, 1.25))
    planner.wait_until(lambda: 'waits for odom and object_pose' in last_text(planner))
    planner.repeat_until(
        lambda: measure(planner),
        lambda: planner.received['push_plan'] and planner.received['planned_path'])
    message = planner.received['push_plan'][0]
    assert nanoseconds(message.header.stamp) == 1_250_000_000
    check_frame(message.header.frame_id, 'odom', 'push_plan')
    got = from_plan_message(message, 'odom')
    assert got.duration == pytest.approx(trajectory.duration, abs=1e-6)
    assert distance(got.object_poses[-1], GOAL) < 5e-3


def test_where_there_is_no_plan_the_answer_says_why(planner):
    """With the code of the reason, which is an error on diagnostics as well."""
    plans, known = len(planner.received['push_plan']), len(errors(planner))
    planner.publish('push_request', request(Pose(1000.0, 0.0, 0.0), 1.5))
    planner.repeat_until(lambda: measure(planner), lambda: any(
        'at most 20 m is accepted' in error for error in errors(planner)[known:]))
    planner.wait_until(lambda: len(planner.received['push_plan']) > plans)
    answer = planner.received['push_plan'][-1]
    assert plan_failure(answer) is PlanFailure.PATH_TOO_LONG
    assert nanoseconds(answer.header.stamp) == 1_500_000_000


def push_on(b, shift):
    """Publish the box and the robot, pushing slowly a little aside, moved by a pose."""
    pose = shift @ ROBOT
    b.publish('object_pose', to_object_pose_message(ObjectPose(2.0, shift @ OBJECT), 'odom'))
    b.publish('odom', to_odometry_message(Odometry(2.0, pose, Twist(0.07, 0.0, 0.04)), 'odom',
                                          'base_link'))


def planned_under_way(b, shift, ask):
    """
    Ask for a plan in a push that is under way, and check where it begins; return it.

    A planner that stands still for a moment loses measurements, which are best effort: then it is
    shown them again.
    """
    for _ in range(5):
        for _ in range(5):
            push_on(b, shift)
            b.spin(0.1)
        got = from_plan_message(ask(), 'odom')
        errors_at_start = (distance(got.object_poses[0], shift @ OBJECT),
                           distance(got.robot_poses[0], shift @ ROBOT))
        if max(errors_at_start) < 1e-6:
            return got
    raise AssertionError(errors_at_start)


def test_a_goal_in_the_middle_of_a_push_is_planned_from_there(planner):
    """From the present poses and motion; the path ends at the new goal."""
    shift, wanted = Pose(0.6, 0.1, 0.2), Pose(2.6, 0.7, -0.4)

    def ask():
        for topic in ('push_plan', 'planned_path'):
            planner.received[topic].clear()
        planner.publish('push_request', request(wanted, 2.0))
        planner.wait_until(lambda: (planner.received['push_plan']
                                    and planner.received['planned_path']))
        return planner.received['push_plan'][0]
    got = planned_under_way(planner, shift, ask)
    speed = math.hypot(0.07, 0.04 * SCENARIO.robot.radius)
    assert math.hypot(*got.contact_twists[0, :2]) == pytest.approx(speed, rel=1e-3)
    assert got.robot_twists[0, 2] == pytest.approx(0.04, abs=1e-3)
    path = planner.received['planned_path'][0]
    ends = [from_object_pose_message(path.poses[k], 'odom').pose for k in (0, -1)]
    assert distance(ends[0], shift @ OBJECT) < 1e-6
    assert distance(ends[1], wanted) < 2e-3 and abs(ends[1].theta - wanted.theta) < 2e-3


def test_a_push_is_planned_again_when_asked(planner):
    """To the last goal, from where it has come to."""
    wanted, shift = Pose(2.6, 0.7, -0.4), Pose(0.9, 0.15, 0.2)
    planner.received['push_plan'].clear()
    planner.publish('push_request', request(wanted))
    planner.repeat_until(lambda: measure(planner), lambda: planner.received['push_plan'])

    def ask():
        count = len(planner.received['push_plan'])
        answer = planner.call('planner/replan')
        assert answer.success and answer.message.startswith('has planned a push of ')
        planner.wait_until(lambda: len(planner.received['push_plan']) > count)
        return planner.received['push_plan'][-1]
    got = planned_under_way(planner, shift, ask)
    assert distance(got.object_poses[-1], wanted) < 2e-3


def test_one_planner_answers_requests_of_both_kinds(tmp_path):
    """Whatever was asked for before, and while it compiles what tasks need."""
    with bench(tmp_path, PLANNER, MODULES[PLANNER], PHYSICS) as b:
        b.subscribe('push_plan')
        kinds = [RequestKind.STEERED_PUSH, RequestKind.TASK_PUSH, RequestKind.STEERED_PUSH]
        for number, kind in enumerate(kinds, start=1):
            b.publish('push_request', request(GOAL, float(number), kind))
            b.repeat_until(lambda: measure(b), lambda: len(b.received['push_plan']) == number)
            plan = from_plan_message(b.received['push_plan'][-1], 'odom')
            assert plan.style.is_straight is (kind is RequestKind.TASK_PUSH)


def test_the_planner_says_where_the_robot_must_stand(tmp_path):
    """With site auto; before a goal there is nothing to plan again."""
    parameters = {**PHYSICS, 'robot.drive': 'holonomic', 'planner.site': 'best'}
    with bench(tmp_path, PLANNER, MODULES[PLANNER], parameters) as b:
        for topic in ('push_plan', 'diagnostics'):
            b.subscribe(topic)
        refused = b.call('planner/replan')
        assert not refused.success and refused.message == 'has received no request yet'

        def reports():
            return [message.status[0] for message in b.received['diagnostics']
                    if 'has planned' in message.status[0].message]

        b.publish('push_request', request(OBJECT @ Pose(0.0, 1.0, 0.0)))
        b.repeat_until(lambda: measure(b), lambda: b.received['push_plan'])
        b.wait_until(reports)
        status = reports()[-1]
        begin = from_plan_message(b.received['push_plan'][0], 'odom').robot_poses[0]
        assert status.level == WARN
        assert f'for a robot at {begin[0]:.3f} m, {begin[1]:.3f} m' in status.message
        assert distance(begin, OBJECT @ Pose(0.0, -0.37, 0.0)) < 1e-6
        values = status_values(status)
        assert values['site 1'].startswith('face 0 from') and 'site 9' in values


def test_a_new_goal_in_the_middle_of_a_push_does_not_stop_the_robot(tmp_path):
    """Planner and controller over DDS, the plant here: the push goes on to the new goal."""
    scenario = dataclasses.replace(SCENARIO, sensors=LATE)
    plant, wanted = make_simulation(scenario), Pose(2.4, 0.5, -0.5)
    parameters = {**PHYSICS, 'lockstep': True}
    with bench(tmp_path, CONTROLLER, MODULES[CONTROLLER], parameters) as b:
        b.start(PLANNER, MODULES[PLANNER], PHYSICS)
        for topic in ('cmd_vel', 'push_plan', 'planned_path', 'diagnostics'):
            b.subscribe(topic)
        b.wait_until(lambda: last_text(b, PLANNER) and last_text(b, CONTROLLER))
        b.connect(OBJECT, ROBOT)
        b.publish('goal_pose', goal(GOAL))
        b.repeat_until(lambda: (b.object_pose(0.0, OBJECT), b.odometry(0.0, ROBOT)),
                       lambda: b.received['push_plan'])
        assert drive(b, plant, 3.0)[-1] > 0.12
        b.publish('goal_pose', goal(wanted))
        # Time waits for a planner that takes longer.
        speeds = drive(b, plant, 4.0, lambda: len(b.received['push_plan']) == 2, pause=PERIOD)
        b.wait_until(lambda: len(b.received['push_plan']) == len(b.received['planned_path']) == 2)
        assert min(speeds + drive(b, plant, plant.time + 1.5)) > 0.1
        end = b.received['planned_path'][-1].poses[-1]
        assert distance(from_object_pose_message(end, 'odom').pose, wanted) < 2e-3
        start = from_plan_message(b.received['push_plan'][-1], 'odom').object_poses[0]
        assert 0.2 < distance(start, OBJECT) < distance(plant.truth.object_pose, OBJECT)
        drive(b, plant, 60.0, lambda: 'task: done' in last_text(b, CONTROLLER))
        assert distance(plant.truth.object_pose, wanted) < 0.02


def drive(b, plant, end, done=lambda: False, pause=0.0):
    """Let the plant run in lockstep with the controller; return the commanded speeds."""
    speeds = []
    while plant.time < end and not done():
        measured = plant.next_measurement()
        if isinstance(measured, Odometry):
            command = b.odometry(measured.time, measured.pose, twist=measured.twist)
            speeds.append(command[0])
            b.spin(pause)
        else:
            command = b.object_pose(measured.time, measured.pose)
        plant.command(Twist(*command))
    return speeds


def test_planner_and_controller_have_the_topics_and_services_of_the_list(planner, lasting):
    """What else they have is rclpy's own, or of the action."""
    for name, b in ((PLANNER, planner), (CONTROLLER, lasting)):
        wait_for_the_list(b, name, optional={'bumper'})


def test_a_simulator_has_the_topics_and_services_of_the_list(tmp_path):
    """It owns time here, and has a lidar and a bumper."""
    with bench(tmp_path, SIM, MODULES[SIM], {**PHYSICS, **AWAY, 'publish_clock': True,
                                             'sensors.lidar.rate': 10.0,
                                             'sensors.bumper_force': 2.0}) as b:
        wait_for_the_list(b, SIM, optional={'scan', 'bumper'})


def wait_for_the_list(b, name, *, optional=frozenset()):
    """Wait until a node has all of the list, of what is optional that alone, and nothing else."""
    b.wait_until(lambda: (name, '/') in b.node.get_node_names_and_namespaces())
    # The last two where push_control_msgs is installed, as on a machine with ROS 2.
    own = ('/rosout', '/parameter_events', '/tf', '/push_status', '/push_object/')
    listed = {topic: entry for topic, entry in TOPICS.items()
              if topic in optional or not entry.is_optional}
    published = {topic for topic, entry in listed.items() if name in entry.publishers}
    subscribed = {topic for topic, entry in listed.items() if name in entry.subscribers}
    served = {service for service, (_, node, _) in SERVICES.items() if node == name}

    def graph(list_names):
        return {topic.lstrip('/'): kinds for topic, kinds in list_names(name, '/')
                if not topic.startswith((*own, f'/{name}/'))}

    b.wait_until(lambda: set(graph(b.node.get_service_names_and_types_by_node)) == served)
    b.wait_until(lambda: set(graph(b.node.get_publisher_names_and_types_by_node)) == published)
    # Simulated time comes on the clock.
    b.wait_until(lambda: set(graph(b.node.get_subscriber_names_and_types_by_node)) - {'clock'}
                 == subscribed)
    check_policy(b.node, name)


def check_policy(observer, name):
    """Compare what a node opens with its policy; some depends on settings and installation."""
    allowed = permissions_of(name)
    depends = {'/clock', '/tf', '/tf_static', f'/{STATUS}', '/cmd_vel', f'/{POSES_OF_OBJECTS}',
               *(f'/{topic}' for topic, entry in TOPICS.items() if entry.is_optional)}
    for names, list_names in (
            (allowed.publish, observer.get_publisher_names_and_types_by_node),
            (allowed.subscribe, observer.get_subscriber_names_and_types_by_node),
            (allowed.reply, observer.get_service_names_and_types_by_node)):
        absolute = {each if each.startswith('/') else f'/{each}'.replace('/~', f'/{name}')
                    for each in names}
        opened = {topic for topic, _ in list_names(name, '/') if '/_action/' not in topic}
        assert opened <= absolute and absolute - opened <= depends


@pytest.mark.parametrize('name, change, text', [
    (PLANNER, 'object.mass:=-1.0',
     'object.mass: got -1.0, expected a finite number from 0.005 to 1000 [kg]'),
    (CONTROLLER, 'object.color:=1', 'object.color: got a parameter that'),
    (SIM, 'object.color:=1', 'object.color: got a parameter that')])
def test_a_bad_parameter_keeps_a_node_from_starting(name, change, text):
    """Exit status 2, and the reason."""
    done = subprocess.run(
        [sys.executable, '-m', MODULES[name], '--ros-args', '--params-file',
         str(config_file('push.yaml')), '-p', change], capture_output=True, text=True)
    assert done.returncode == 2
    assert f'refused to start: {text}' in done.stderr
