"""Tasks over Fast DDS: controller and planner alone, with time in the hands of the test."""

import math
from pathlib import Path
import time
from typing import Any, Callable

from geometry_msgs.msg import PoseStamped, TwistStamped
from helpers.node_bench import bench, TIMEOUT
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
import numpy as np
from push_control.perception.object_knowledge import object_key, ObjectKnowledge
from push_control.ros.base_memory import BaseMemory
from push_control.ros.commands import STOP_COMMANDS
from push_control.ros.objects.knowledge import KnowledgeFile
from push_model.base_knowledge import BaseKnowledge
from push_model.contact import find_contact
from push_model.files.data import config_file
from push_model.files.flat_values import to_parameter_values
from push_model.files.parameter_files import read_object
from push_model.friction import friction_center
from push_model.geometry import distance, Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectPose, Odometry, STOP
from push_model.trajectory import PushStyle
from push_navigation.occupancy_map import OccupancyMap
from push_planner.task_plan import TaskPlan
from push_planner.task_planner import plan_for_request
from push_ros.conversions.map import to_map_message
from push_ros.conversions.measurements import (
    from_object_pose_message, to_object_pose_message, to_odometry_message,
)
from push_ros.conversions.plan import (
    from_plan_message, no_plan_message, plan_failure, to_plan_message)
from push_ros.conversions.plan_request import from_request_message, to_request_message
from push_ros.conversions.primitives import nanoseconds, seconds, to_pose_message, to_stamp
from push_ros.diagnostics import ERROR
from push_ros.topics import CONTROLLER, PLANNER
from push_scenario.definition.catalogue import find_scenario
from push_scenario.definition.loader import read_scenario
import pytest
from std_srvs.srv import Trigger

pytestmark = [pytest.mark.dds, pytest.mark.slow]

SCENARIO = read_scenario(find_scenario('task_approach'))
DRIVE = SCENARIO.task.drive
OBJECT, ROBOT, GOAL = SCENARIO.start.object.pose, SCENARIO.robot_start, SCENARIO.goal.pose
PHYSICS = {**to_parameter_values(SCENARIO.object, 'object.'),
           **to_parameter_values(SCENARIO.robot, 'robot.')}
TASK = {**PHYSICS, 'use_sim_time': True, 'task': True}
ZERO = (0.0, 0.0, 0.0)
# Takes a request and returns its plan.
Planned = Callable[[Any], TaskPlan]
PERIOD = 0.05
# Wall time after which simulated time goes on where nothing is answered [s].
MAX_STEP = 0.02


def statuses(b, name):
    """List what a node has reported."""
    return [status for message in b.received['diagnostics'] for status in message.status
            if status.name == name]


def texts(b, name):
    """Texts of it."""
    return [status.message for status in statuses(b, name)]


def errors(b, name):
    """Texts of the errors among it."""
    return [status.message for status in statuses(b, name) if status.level == ERROR]


def goal(pose, time=0.0, frame='odom'):
    """Make a goal."""
    message = PoseStamped(pose=to_pose_message(pose))
    message.header.frame_id, message.header.stamp = frame, to_stamp(time)
    return message


def floor(occupied, frame='odom'):
    """Make a map of 8 m x 8 m about the origin."""
    return to_map_message(OccupancyMap(0.1, Pose(-4.0, -4.0, 0.0), occupied), to_stamp(0.0), frame)


FREE = np.zeros((80, 80), dtype=bool)


@pytest.fixture(scope='module')
def planned():
    """Plan the first push from the start, as the planner would."""
    def plan(request):
        wanted = from_request_message(request, 'odom')
        return plan_for_request(wanted, SCENARIO.robot, SCENARIO.planner, DRIVE)
    return plan


class Stand:
    """A controller at a task, before a robot and an object that do not move."""

    def __init__(self, b):
        self.b, self.now = b, 0.0
        b.is_lockstep = False
        for topic in ('cmd_vel', 'diagnostics', 'push_request', 'markers'):
            b.subscribe(topic)
        b.wait_until(lambda: b.received['diagnostics'])
        b.clock(0.0)
        # Best effort may fail at first.
        b.repeat_until(self._publish, lambda: b.call('controller/start').message
                       == 'has received no goal_pose yet')
        b.wait_for_silence('cmd_vel')

    @property
    def requests(self):
        """Requests that have come."""
        return self.b.received['push_request']

    def measure(self, duration):
        """Let time pass; return the commands, one for each measurement."""
        commands = []
        for _ in range(round(duration / PERIOD)):
            self.now += PERIOD
            commands += [self.b.object_pose(self.now, OBJECT), self.b.odometry(self.now, ROBOT)]
        return commands

    def measure_unanswered(self, duration):
        """Let time pass for a robot that is not driven; return the commands that come."""
        commands = self.b.received['cmd_vel']
        commands.clear()
        for _ in range(round(duration / PERIOD)):
            self.now += PERIOD
            self._publish()
            self.b.spin(0.005)
        self.b.spin(0.1)
        return [twist_of(command) for command in commands]

    def measure_until(self, condition):
        """Let time pass until a condition holds; return the commands that have come."""
        commands = self.b.received['cmd_vel']
        commands.clear()
        end = time.monotonic() + TIMEOUT
        while not condition():
            self.b.processes.check()
            assert time.monotonic() < end
            self.now += PERIOD
            count = len(commands)
            self._publish()
            # A node that drives the robot answers both, and time waits for it.
            pause = time.monotonic() + MAX_STEP
            while len(commands) < count + 2 and time.monotonic() < pause and not condition():
                self.b.spin(2e-3)
        return [twist_of(command) for command in commands]

    def measure_until_silent(self):
        """Let time pass until no more commands come; return the last that have come."""
        end, last = time.monotonic() + TIMEOUT, []
        while commands := self.measure_unanswered(1.0):
            assert time.monotonic() < end
            last = (last + commands)[-STOP_COMMANDS:]
        return last

    def _publish(self):
        """Publish what is measured now."""
        self.b.publish('object_pose', to_object_pose_message(
            ObjectPose(self.now, OBJECT), 'odom'))
        self.b.publish('odom', to_odometry_message(
            Odometry(self.now, ROBOT, STOP), 'odom', 'base_link'))

    def wait_for_request(self, count):
        """Let time pass until so many requests have come; the robot must stand."""
        assert set(self.measure_until(lambda: len(self.requests) >= count)) <= {ZERO}
        return self.requests[count - 1]

    def answer(self, chain, request, frame='odom'):
        """Send a plan for a request."""
        self.b.publish('push_plan', to_plan_message(chain.trajectory, request.header.stamp,
                                                    frame))

    def says(self, text):
        """Wait until it has said something."""
        return self.b.wait_until(lambda: any(text in one for one in texts(self.b, CONTROLLER)))


def twist_of(command):
    """Velocity that is commanded."""
    return command.twist.linear.x, command.twist.linear.y, command.twist.angular.z


@pytest.fixture(scope='module')
def stand(tmp_path_factory):
    """Start a controller for several tests, which follow upon each other."""
    with bench(tmp_path_factory.mktemp('task'), CONTROLLER, 'push_control.controller_node',
               {**TASK, 'wait_for_start': True}) as b:
        yield Stand(b)


def test_why_a_goal_was_refused_stays_until_there_is_one(stand):
    """It is the reason of the state, not only a message beside it."""
    stand.b.publish('goal_pose', goal(Pose(math.nan, 0.0, 0.0)))
    stand.says('task: idle, goal_pose: got')
    stand.b.received['diagnostics'].clear()
    stand.measure_unanswered(1.2)
    stand.says('task: idle, goal_pose: got')
    assert not any(text == 'task: idle' for text in texts(stand.b, CONTROLLER))


def test_nothing_begins_without_goal_and_start(stand):
    """A goal alone does not move the robot, and leaves it to others; a pause makes no sense."""
    stand.b.publish('goal_pose', goal(GOAL))
    assert stand.measure_unanswered(1.0) == []
    assert stand.requests == []
    for service in ('pause', 'resume'):
        refused = stand.b.call(f'controller/{service}')
        assert not refused.success and 'idle' in refused.message
    stand.b.wait_until(lambda: stand.b.call('controller/start').success)


def test_a_request_says_what_is_wanted(stand):
    """Object and robot as measured, the goal as given, the object as believed."""
    began = stand.now
    request = stand.wait_for_request(1)
    wanted = from_request_message(request, 'odom')
    assert distance(wanted.object_pose, OBJECT) < 1e-9 and wanted.cone_fraction == 1.0
    assert distance(wanted.robot_pose, ROBOT) < 1e-9
    assert wanted.goal == pytest.approx(GOAL)
    assert began < seconds(request.header.stamp) <= stand.now


def last_commands(stand):
    """Return the last commands that have come, as many as zeros follow the last of a task."""
    return [twist_of(command) for command in stand.b.received['cmd_vel'][-STOP_COMMANDS:]]


@pytest.mark.parametrize('topic, message, text', [
    ('goal_pose', goal(GOAL, frame='camera'), "goal_pose: got frame 'camera', expected 'odom'"),
    ('goal_pose', goal((math.nan, 0.0, 0.0)), 'goal_pose: got the position (nan, 0), expected'),
    ('map', floor(FREE, 'world'), "map: got frame 'world', expected 'odom'")],
    ids=['frame', 'nan', 'map'])
def test_a_bad_goal_or_map_is_told_and_changes_nothing(stand, topic, message, text):
    """With the field, what came and what was expected."""
    stand.b.publish(topic, message)
    stand.b.wait_until(lambda: any(text in error for error in errors(stand.b, CONTROLLER)))
    stand.measure(0.2)
    # There are several where odometry has paused on the wall.
    assert {from_request_message(request, 'odom').goal for request in stand.requests} == {
        from_request_message(stand.requests[0], 'odom').goal}


def test_bytes_that_are_no_message_are_refused(stand):
    """The task goes on: nothing is forgotten."""
    stand.b.repeat_until(
        lambda: stand.b.publish_bytes('odom', b'\0\1\0\0' + 40 * b'\xff'),
        lambda: any('odom: got a message that cannot be read' in error
                    for error in errors(stand.b, CONTROLLER)))
    stand.measure(0.2)
    assert not any('internal error' in error for error in errors(stand.b, CONTROLLER))


def test_a_map_is_taken(stand):
    """The node says so; until then the one that was refused has held the robot."""
    stand.says("task: plan, map: got frame 'world'")
    stand.b.publish('map', floor(FREE))
    stand.says('has a map of 80 times 80 cells')
    stand.b.received['diagnostics'].clear()
    stand.measure(0.2)
    stand.b.wait_until(lambda: any(text.startswith('task: plan') and 'map' not in text
                                   for text in texts(stand.b, CONTROLLER)))


def test_only_the_answer_to_the_request_counts(stand, planned):
    """An earlier plan is overlooked; no plan, or one that is refused, is asked for again."""
    chain = planned(stand.requests[0])
    older = to_plan_message(chain.trajectory, to_stamp(1e-3), 'odom')
    stand.b.publish('push_plan', older)
    stand.says('push_plan: a plan is not driven, as this node has not requested it')
    # It would take seconds to read this one.
    older.points = list(older.points)[:1] * 5000
    stand.b.publish('push_plan', older)
    stand.b.wait_until(lambda: any('push_plan: got a message of ' in text
                                   for text in errors(stand.b, CONTROLLER)))
    assert set(stand.measure(0.2)) == {ZERO}
    refused = []

    def refuse():
        # Where odometry has paused on the wall, the request was sent again: that one counts.
        if stand.requests[-1] not in refused:
            refused.append(stand.requests[-1])
            stand.b.publish('push_plan', no_plan_message(
                PlanFailure.BLOCKED, refused[-1].header.stamp, 'odom'))
        stand.measure(0.1)
    stand.b.repeat_until(refuse, lambda: any(
        f'no plan: {PlanFailure.BLOCKED.value}' in text for text in texts(stand.b, CONTROLLER)))
    second = stand.wait_for_request(len(stand.requests) + 1)
    assert nanoseconds(second.header.stamp) > nanoseconds(refused[-1].header.stamp)
    count = len(stand.requests)
    stand.answer(chain, second, 'camera')
    stand.wait_for_request(count + 1)
    stand.says("push_plan: got frame 'camera', expected 'odom'")


def test_a_plan_sets_the_robot_out_and_a_pause_stops_it(stand, planned):
    """It goes on when it is told to, with a plan from there."""
    request = stand.requests[-1]
    stand.answer(planned(request), request)
    stand.b.repeat_until(lambda: stand.measure(0.1), lambda: 'task: approach' in texts(
        stand.b, CONTROLLER))
    assert any(command != ZERO for command in stand.measure(0.5))
    assert stand.b.call('controller/pause').success
    stand.b.wait_until(lambda: last_commands(stand) == [ZERO] * STOP_COMMANDS)
    assert set(stand.measure_until_silent()) <= {ZERO}
    stand.says('task: paused')
    assert not stand.b.call('controller/pause').success
    count = len(stand.requests)
    assert stand.b.call('controller/resume').success
    stand.wait_for_request(count + 1)
    stand.says('task: plan, resumed')


def test_a_goal_holds_at_once_whatever_its_stamp(stand):
    """The clock of the computer with RViz may be ahead, behind, or elsewhere; the log says so."""
    for number, stamp in enumerate((stand.now + 1e3, 1.7e9, 0.0), 1):
        began, other = stand.now, Pose(-1.0, 0.1 * number, 0.0)
        stand.b.publish('goal_pose', goal(other, stamp))
        stand.measure_until(lambda: from_request_message(
            stand.requests[-1], 'odom').goal == pytest.approx(other))
        assert seconds(stand.requests[-1].header.stamp) < began + 500.0


def test_stopped_it_stands_until_it_is_started_anew(stand):
    """The goal is kept."""
    assert stand.b.call('controller/stop').success
    stand.says('task: idle, stopped by controller/stop: call controller/start')
    assert set(stand.measure_until_silent()) <= {ZERO}
    count = len(stand.requests)
    assert stand.measure_unanswered(1.0) == [] and len(stand.requests) == count
    assert stand.b.call('controller/start').success
    stand.wait_for_request(count + 1)


def test_a_base_that_stands_for_seconds_waits_for_resume(stand, planned):
    """With zeros, however long it takes, and says so; then another plan is requested."""
    answered = len(stand.requests) - 1

    def is_waiting():
        nonlocal answered
        if len(stand.requests) > answered:
            request = stand.requests[-1]
            answered = len(stand.requests)
            stand.answer(planned(request), request)
        return any('call controller/resume or send another goal' in text
                   for text in texts(stand.b, CONTROLLER))
    assert any(command != ZERO for command in stand.measure_until(is_waiting))
    assert set(stand.measure(2.0)) == {ZERO}
    count = len(stand.requests)
    assert set(stand.measure(12.0)) == {ZERO} and len(stand.requests) == count
    assert stand.b.call('controller/resume').message == 'resumed'
    stand.wait_for_request(count + 1)


def test_somebody_else_who_drives_the_base_stops_the_robot(stand, planned):
    """And is named; a publisher that is silent is only warned of."""
    other = TwistStamped()
    stand.b.publish('cmd_vel', other)
    # Simulated time stands still until the controller listens beside this bench.
    stand.b.wait_until(lambda: stand.b.node.count_subscribers('cmd_vel') > 1)
    request = stand.requests[-1]
    stand.answer(planned(request), request)
    count = len(texts(stand.b, CONTROLLER))
    stand.b.repeat_until(lambda: stand.measure(0.1), lambda: 'task: approach' in texts(
        stand.b, CONTROLLER)[count:])
    assert any(command != ZERO for command in stand.measure(0.1))
    other.twist.angular.z = 0.2

    def drive():
        stand.b.publish('cmd_vel', other)
        stand.measure(0.1)
    stand.b.repeat_until(drive, lambda: any(
        'somebody else commands the base: cmd_vel is published by /' in text
        for text in texts(stand.b, CONTROLLER)[count:]), period=0.02)


def test_its_state_is_in_the_markers(stand):
    """As text, beside object and robot."""
    stand.b.wait_until(lambda: any(marker.text for message in stand.b.received['markers']
                                   for marker in message.markers))


def test_in_lockstep_measurements_wait_for_the_plan(tmp_path, planned):
    """
    In lockstep none is answered before, and each once afterwards: the robot stands.

    A goal holds from the time of its stamp on, and not before.
    """
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node',
               {**TASK, 'lockstep': True,
                'supervision.min_averaging_time': 0.5}) as b:
        stand = Stand(b)
        b.publish('goal_pose', goal(GOAL, 1.0))
        b.wait_until_handled('goal_pose', 'controller/resume')
        stand.measure(0.95)
        assert stand.requests == []
        stand.now = 1.0
        commands = b.received['cmd_vel']
        commands.clear()
        for _ in range(3):
            b.publish('object_pose', to_object_pose_message(ObjectPose(stand.now, OBJECT), 'odom'))
            b.spin(0.1)
        b.wait_until(lambda: stand.requests)
        assert commands == []
        stand.answer(planned(stand.requests[0]), stand.requests[0])
        b.wait_until(lambda: len(commands) == 3)
        assert {nanoseconds(command.header.stamp) for command in commands} == {
            round(1e9 * stand.now)}
        assert {command.twist.linear.x for command in commands} == {0.0}
        b.odometry(stand.now, ROBOT)
        assert any(command != ZERO for command in stand.measure(0.5))


def test_a_plan_that_comes_after_its_time_is_taken(tmp_path: Path, planned: Planned) -> None:
    """The request is repeated, and the first one still asks for the same; a refusal is not."""
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node',
               {**TASK, 'supervision.plan_timeout': 0.2,
                'supervision.max_attempts': 100}) as b:
        stand = Stand(b)
        b.publish('goal_pose', goal(GOAL))
        first = stand.wait_for_request(1)
        stand.wait_for_request(3)
        stand.says('task: plan, no plan within 0.2 s')
        b.publish('push_plan', no_plan_message(PlanFailure.BLOCKED, first.header.stamp, 'odom'))
        stand.wait_for_request(len(stand.requests) + 1)
        assert not any('no plan: ' in text for text in texts(b, CONTROLLER))
        stand.answer(planned(first), first)
        stand.measure_until(lambda: 'task: approach' in texts(b, CONTROLLER))


def test_what_was_learned_before_is_in_the_request(tmp_path):
    """A node that was started again asks for plans for the object that it knows."""
    path = tmp_path / 'known.yaml'
    known = ObjectKnowledge((0.02, -0.01), 0.001, 0.25, 0.01)
    KnowledgeFile(path).write(object_key(SCENARIO.object), time.time(), known)
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node',
               {**TASK, 'knowledge_file': str(path)}) as b:
        stand = Stand(b)
        b.publish('goal_pose', goal(GOAL))
        obj = from_request_message(stand.wait_for_request(1), 'odom').obj
    assert friction_center(obj) == pytest.approx(known.friction_center, abs=1e-3)
    assert obj.contact_friction_coefficient == pytest.approx(0.25, abs=1e-3)
    assert KnowledgeFile(path).read(object_key(SCENARIO.object))[1] == known


def test_a_damaged_file_of_the_base_is_a_warning_and_replaced(tmp_path):
    """The node starts, says so, and keeps what is known once the robot stands."""
    path = tmp_path / 'base.yaml'
    path.write_text('- 1')
    with bench(tmp_path, CONTROLLER, 'push_control.controller_node',
               {**TASK, 'base_file': str(path)}) as b:
        stand = Stand(b)
        stand.measure_until(lambda: any(text.startswith('base_file: ')
                                        for text in texts(b, CONTROLLER)))
        stand.measure_until(lambda: path.read_text() != '- 1')
    assert BaseMemory(path, SCENARIO.robot).recall() == (
        BaseKnowledge.stated(SCENARIO.robot), '')


@pytest.fixture(scope='module')
def planner(tmp_path_factory):
    """Start a planner of tasks."""
    parameters = {**PHYSICS, 'map.footprint_clearing_enabled': True}
    with bench(tmp_path_factory.mktemp('chain'), PLANNER, 'push_planner.planner_node',
               parameters) as b:
        for topic in ('push_plan', 'planned_path', 'planning_markers', 'diagnostics'):
            b.subscribe(topic)
        b.wait_until(lambda: b.received['diagnostics'])
        yield b


def request(time=1.0, pose=GOAL):
    """Make a request from the start."""
    return to_request_message(PlanRequest(OBJECT, ROBOT, pose, SCENARIO.object), to_stamp(time),
                              'odom')


def set_field(message, name, value):
    """Change one number of a request."""
    message.points[0].positions[list(message.joint_names).index(name)] = value


def answered(b, message):
    """Send a request and return the answer to it."""
    for heard in ('push_plan', 'planned_path', 'planning_markers'):
        b.received[heard].clear()
    b.publish('push_request', message)

    def answers():
        # A planner that was activated answers the last request again, too.
        return [answer for answer in b.received['push_plan']
                if answer.header.stamp == message.header.stamp]
    b.wait_until(answers)
    return answers()[0]


def drawn_texts(b):
    """List the texts in pictures of plans and refusals."""
    return [marker.text for drawn in b.received['planning_markers'] for marker in drawn.markers]


def test_a_request_is_answered_with_the_next_push(planner):
    """The plan is that of the planner in process, and the path is that of the object."""
    aside = OBJECT @ Pose(-1.0, 0.0, 1.0)
    message = request(1.5, aside)
    got = from_plan_message(answered(planner, message), 'odom')
    plan = plan_for_request(from_request_message(message, 'odom'), SCENARIO.robot,
                            SCENARIO.planner, DRIVE)
    assert got.style is PushStyle.STRAIGHT
    assert np.abs(got.object_poses - plan.trajectory.object_poses).max() < 1e-6
    planner.wait_until(lambda: planner.received['planned_path'])
    poses = [from_object_pose_message(pose, 'odom').pose
             for pose in planner.received['planned_path'][0].poses]
    assert distance(poses[0], OBJECT) < 1e-6
    assert distance(poses[-1], plan.trajectory.object_poses[-1]) < 1e-6
    assert max(distance(*pair) for pair in zip(poses, poses[1:])) < 0.1
    planner.wait_until(lambda: any('has planned 1 push of expected' in text
                                   for text in texts(planner, PLANNER)))
    planner.wait_until(lambda: '1' in drawn_texts(planner))


def test_another_object_is_pushed_where_the_request_brings_it(planner, tmp_path_factory):
    """
    Whatever the parameters of the planner: the robot touches the larger object further out.

    Those that have no effect then are named in the log, once.
    """
    carton = read_object(config_file('objects/carton.yaml'))
    for number, (obj, other) in enumerate(((SCENARIO.object, carton), (carton, SCENARIO.object))):
        answer = answered(planner, to_request_message(PlanRequest(
            Pose(0.0, 0.0, 0.0), Pose(-1.5, 0.0, 0.0), Pose(0.6, 0.0, 0.0), obj),
            to_stamp(1.7 + number), 'odom'))
        start = from_plan_message(answer, 'odom').robot_poses[0]
        gaps = [find_contact(one, Pose(0.0, 0.0, 0.0), start[:2], SCENARIO.robot.radius).gap
                for one in (obj, other)]
        assert abs(gaps[0]) < 1e-3 and abs(gaps[1]) > 0.02
    log = tmp_path_factory.getbasetemp() / 'chain0' / f'{PLANNER}.log'
    notes = [line for line in log.read_text().splitlines()
             if 'without effect, as the request brings another object' in line]
    assert len(notes) == 1 and 'object.mass' in notes[0] and 'object.outline' in notes[0]


@pytest.mark.parametrize('spoil, text', [
    (lambda m: m.points.pop(), 'push_request: got 0 points, expected 1'),
    (lambda m: set_field(m, 'object.x', math.nan), 'push_request: object.x: got nan, expected'),
    (lambda m: setattr(m.header, 'frame_id', 'map'), "push_request: got frame 'map', expected"),
    (lambda m: (set_field(m, 'robot.x', OBJECT.x), set_field(m, 'robot.y', OBJECT.y)),
     'the robot reaches no contact site')],
    ids=['count', 'nan', 'frame', 'blocked'])
def test_a_request_without_a_plan_is_answered_all_the_same(planner, spoil, text):
    """With a code; the reason is an error on diagnostics."""
    message = request(2.0)
    spoil(message)
    assert plan_failure(answered(planner, message)) is not None
    planner.wait_until(lambda: any(text in error for error in errors(planner, PLANNER)))


def test_another_plan_needs_measurements(planner):
    """To the goal of the last request, from where object and robot are by now: it listens then."""
    answered(planner, request(2.5))
    planner.received['push_plan'].clear()
    refused = planner.call('planner/replan')
    assert not refused.success and 'odom and no object_pose' in refused.message
    assert planner.received['push_plan'] == []
    shift = Pose(0.1, 0.2, 0.0)

    def measure():
        planner.publish('object_pose', to_object_pose_message(
            ObjectPose(2.6, shift @ OBJECT), 'odom'))
        planner.publish('odom', to_odometry_message(Odometry(2.6, shift @ ROBOT, STOP), 'odom',
                                                    'base_link'))
    planner.repeat_until(measure, lambda: planner.call('planner/replan').success)
    planner.wait_until(lambda: planner.received['push_plan'])
    plan = from_plan_message(planner.received['push_plan'][-1], 'odom')
    assert distance(plan.object_poses[0], shift @ OBJECT) < 1e-6


def test_other_services_are_answered_while_a_plan_waits_for_measurements(planner):
    """Nothing measures any more: what is called second is answered first."""
    replan = planner.client(Trigger, 'planner/replan')
    state = planner.client(GetState, f'{PLANNER}/get_state')

    def change_state(transition: int) -> None:
        planner.request(ChangeState, f'{PLANNER}/change_state', ChangeState.Request(
            transition=Transition(id=transition)))

    def listeners() -> int:
        return planner.node.count_subscribers('odom')

    def is_overtaken() -> bool:
        # The planner forgets what it has measured. Active, it clears its map of the robot.
        change_state(Transition.TRANSITION_DEACTIVATE)
        planner.wait_until(lambda: listeners() == 0)
        change_state(Transition.TRANSITION_ACTIVATE)
        answered(planner, request(2.7))
        planner.wait_until(lambda: listeners() == 1)
        first = replan.call_async(Trigger.Request())
        planner.wait_until(lambda: listeners() == 2 or first.done())
        second = state.call_async(GetState.Request())
        planner.wait_until(second.done)
        is_waiting = not first.done()
        planner.wait_until(first.done)
        assert not first.result().success
        return is_waiting
    # On a busy machine the second may come when the first has waited for long enough.
    planner.wait_until(is_overtaken)


def test_a_map_is_kept_to(planner):
    """
    After a bad one there is no plan until a better one comes; nor where the goal is walled in.

    The object itself is no obstacle in a map that shows it as one.
    """
    planner.publish('map', floor(FREE, 'camera'))
    planner.wait_until(lambda: any("map: got frame 'camera', expected 'odom'" in error
                                   for error in errors(planner, PLANNER)))
    assert plan_failure(answered(planner, request(3.0))) is PlanFailure.UNUSABLE_MAP
    shown = FREE.copy()
    shown[38:42, 38:42] = True
    planner.received['diagnostics'].clear()
    planner.publish('map', floor(shown))
    planner.wait_until(lambda: 'has a map of 80 times 80 cells' in texts(planner, PLANNER))
    assert plan_failure(answered(planner, request(3.5))) is None
    wall = FREE.copy()
    wall[:, 50:52] = True
    planner.received['diagnostics'].clear()
    planner.publish('map', floor(wall))
    planner.wait_until(lambda: 'has a map of 80 times 80 cells' in texts(planner, PLANNER))
    assert plan_failure(answered(planner, request(4.0))) is PlanFailure.BLOCKED
    planner.wait_until(lambda: any('the floor is too narrow for the object' in error
                                   for error in errors(planner, PLANNER)))
    planner.wait_until(lambda: any(text.endswith(' m needed') for text in drawn_texts(planner)))
