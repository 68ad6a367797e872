"""
Playback of a recording: the same measurements and plans give the same commands, to the byte.

A recording of a replay in lockstep holds everything that the controller was given. Its
measurements go once more through safety layer and supervisor, in the order in which the
simulator delivers them, and plans come when they came; what is commanded is compared with what was
recorded. Where they differ the controller has changed, or depends on something that it should not:
time on the wall, the order of other messages, the machine.
"""

from collections import Counter, defaultdict, deque
from collections.abc import Mapping, Sequence
from pathlib import Path
import struct
from typing import Any, NamedTuple

from push_control.ros.measurements import LatestMeasurements
from push_control.supervision_settings import SupervisionSettings
from push_control.task.single_push import SinglePushBehaviors
from push_control.task.supervisor import Supervisor
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.settings import DriveSettings
from push_ros.conversions.measurements import (
    from_object_pose_message, from_odometry_message, from_relative_pose_message,
)
from push_ros.conversions.plan import from_plan_message, plan_failure
from push_ros.conversions.primitives import NANOSECONDS, nanoseconds
from push_ros.node_settings import Frames
from push_ros.topics import TOPICS
from push_scenario.definition.scenario import Scenario
from push_scenario.recordings.bag import open_bag
from push_scenario.simulation.loop import make_safety_layer
from rclpy.serialization import deserialize_message

# Length of the end of a recording, of which not every message is in it, as it ends while the nodes
# do [ns]; chosen, within the time in which the robot stands.
RAGGED_END = NANOSECONDS
TWIST = struct.Struct('<3d')
READ_TOPICS = 'object_pose', 'odom', 'push_plan', 'cmd_vel'


class Difference(NamedTuple):
    """
    A command that is not as recorded.

    :param time: of the measurement that it answers [s].
    """

    time: float
    recorded: Twist
    computed: Twist


class Playback(NamedTuple):
    """
    Result of a playback.

    :param commands: number of commands that were compared.
    :param differences: each ``Difference``, in order.
    """

    commands: int
    differences: tuple[Difference, ...]


class _Arrival(NamedTuple):
    """
    Arrival of a measurement [ns], its order in those that came together, its stamp [ns], itself.

    Poses in the world come before odometry, those relative to the robot after it.
    """

    time: int
    order: int
    stamp: int
    measured: Odometry | ObjectPose


class StampedMessage(NamedTuple):
    """
    A recorded message.

    :param stamp: of it [ns].
    :param value: the ROS message.
    """

    stamp: int
    value: Any


def play_back(scenario: Scenario, bag: Path) -> Playback:
    """
    Play a recording to the controller of a scenario.

    :param scenario: the ``Scenario`` that was recorded, without a map.
    :param bag: folder of the recording, made in lockstep.
    :raises ValueError: where the folder is no recording of such a run, or lacks measurements.
    :raises RuntimeError: where rosbags is not installed.
    """
    messages = read_messages(bag)
    arrivals = _arrivals(messages, scenario.sensors.pose_latency)
    answers: dict[int, deque[Twist]] = defaultdict(deque)
    for message in messages['cmd_vel']:
        twist = message.value.twist
        answers[message.stamp].append(Twist(twist.linear.x, twist.linear.y, twist.angular.z))
    if not answers or not arrivals:
        raise ValueError(f'{bag}: got {len(answers)} times of commands and {len(arrivals)} '
                         'measurements, expected a recording in lockstep')
    _check_complete(bag, arrivals, answers)
    counts = Counter(arrival[:3] for arrival in arrivals)
    repeated = {stamp for (_, _, stamp), count in counts.items() if count > 1}
    robot = _Robot(scenario, messages['push_plan'])
    differences: list[Difference] = []
    count = 0
    for arrival in arrivals:
        computed = robot.answer(arrival.measured)
        # What is not answered for a while comes again, as at time 0, which is held, and while
        # something is planned: then it is open which measurement of that stamp a command answers.
        if arrival.stamp in repeated or not answers[arrival.stamp]:
            continue
        count += 1
        recorded = answers[arrival.stamp].popleft()
        # Numbers alone: what pads a message between them is anything.
        if TWIST.pack(*computed) != TWIST.pack(*recorded):
            differences.append(Difference(arrival.measured.time, recorded, computed))
    return Playback(count, tuple(differences))


def _check_complete(bag: Path, arrivals: Sequence[_Arrival],
                    answers: Mapping[int, deque[Twist]]) -> None:
    """Refuse a recording that has lost measurements: each command answers one."""
    measured = Counter(arrival.stamp for arrival in arrivals)
    # What is held at time 0 is answered again and again.
    end = max(answers) - RAGGED_END
    lost = [stamp for stamp, commands in answers.items()
            if 0 < stamp < end and len(commands) > measured[stamp]]
    if lost:
        raise ValueError(f'{bag}: got {len(lost)} commands whose measurements are missing, the '
                         f'first at {min(lost) / NANOSECONDS:g} s, expected a complete recording')


def _arrivals(messages: Mapping[str, Sequence[StampedMessage]],
              pose_latency: float) -> list[_Arrival]:
    """List the measurements in the order in which the simulator delivers them."""
    latency = round(pose_latency * NANOSECONDS)
    arrivals = [_Arrival(message.stamp, 1, message.stamp,
                         from_odometry_message(message.value, Frames().world_frame))
                for message in messages['odom']]
    for stamp, value in messages['object_pose']:
        is_relative = value.header.frame_id == Frames().base_frame
        measured = (from_relative_pose_message(value, Frames().base_frame) if is_relative
                    else from_object_pose_message(value, Frames().world_frame))
        arrivals.append(_Arrival(stamp + (latency if stamp else 0), 2 if is_relative else 0,
                                 stamp, measured))
    return sorted(arrivals, key=lambda arrival: arrival[:3])


class _Robot:
    """Safety layer and controller, as in the controller's node."""

    def __init__(self, scenario: Scenario, plans: Sequence[StampedMessage]) -> None:
        self._safety = make_safety_layer(scenario)
        self._plans = {message.stamp: message.value for message in plans}
        self._latest = LatestMeasurements()
        task = scenario.task
        self._later_goals = sorted(() if task is None else task.goals,
                                   key=lambda later: later.time)
        if task is None:
            self._supervisor = Supervisor(
                scenario.object, scenario.robot, scenario.control, DriveSettings(),
                SupervisionSettings(), factory=SinglePushBehaviors)
            self._supervisor.drive(self._first_plan())
        else:
            self._supervisor = Supervisor(scenario.object, scenario.robot, scenario.control,
                                          task.drive, task.supervision)
            self._supervisor.set_goal(scenario.goal.pose)

    def answer(self, measured: Odometry | ObjectPose) -> Twist:
        """Answer a measurement."""
        dt = self._latest.add(measured)
        while self._later_goals and self._later_goals[0].time <= self._latest.time:
            self._supervisor.set_goal(self._later_goals.pop(0).goal.pose)
        observation = self._latest.observation
        if observation is None or observation.object_pose is None:
            return STOP
        return self._step(observation, dt)

    def _step(self, observation: Observation, dt: float) -> Twist:
        supervisor = self._supervisor
        command = self._safety.guard(observation, supervisor,
                                     lambda checked: supervisor.step(checked, dt),
                                     is_commanding=not supervisor.state.is_standing)
        if not supervisor.awaits_plan:
            return command
        # The measurement waits for the plan, while the robot stands.
        self._take_plan(round(observation.time * NANOSECONDS))
        return STOP

    def _take_plan(self, stamp: int) -> None:
        message = self._plans.get(stamp)
        if message is None:
            return
        failure = plan_failure(message)
        if failure is None:
            self._supervisor.set_plan(from_plan_message(message, Frames().world_frame))
        else:
            self._supervisor.on_planning_failed(
                failure, f'{failure.value} (details in the diagnostics of the planner)')

    def _first_plan(self) -> PushTrajectory:
        if not self._plans:
            raise ValueError('push_plan: got none, expected the plan of a single push')
        return from_plan_message(self._plans[min(self._plans)], Frames().world_frame)


def read_messages(bag: Path) -> dict[str, list[StampedMessage]]:
    """
    Read the topics that matter.

    :param bag: folder of the recording.
    :return: messages by topic, in order.
    :raises ValueError: where the folder is no recording.
    :raises RuntimeError: where rosbags is not installed.
    """
    messages: dict[str, list[StampedMessage]] = {topic: [] for topic in READ_TOPICS}
    with open_bag(bag) as reader:
        for connection, _, data in reader.messages():
            topic = connection.topic.strip('/')
            if topic in messages:
                value = deserialize_message(bytes(data), TOPICS[topic].message_type())
                messages[topic].append(StampedMessage(nanoseconds(value.header.stamp), value))
    return messages
