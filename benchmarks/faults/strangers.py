"""
Cases of strangers: what others publish, call and send beside three nodes that do tasks.

The nodes run in simulated time, which goes as fast as the clock of the wall. After each case
another task has to be done.
"""

from collections.abc import Callable, Generator
import contextlib
import itertools
import math
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import Any, NamedTuple

from benchmarks.faults.expectations import Notice
from benchmarks.faults.observation import Observation, traceback_in
from benchmarks.faults.process_rig import (
    change_parameters, process_rig, ProcessRig,
)
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import OccupancyGrid
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_model.signals import STOP
from push_ros import qos
from push_ros.conversions.primitives import from_twist_message, to_pose_message, to_stamp
from push_ros.node_settings import Frames
from push_ros.push_interfaces import ACTION, import_push_interfaces
from push_ros.topics import CONTROLLER, TOPICS
from push_safety.status import SafetyReason
from push_scenario.dds.private_network import private_environment
from push_scenario.dds.replay import MODULES
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
import rclpy
from rclpy.action.client import ActionClient
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future
from rosgraph_msgs.msg import Clock

# Limit of what is waited for [s]; chosen: far above what it takes on a busy machine.
TIMEOUT = 120.0
# Longest time between two commands [s]: less than the time-out of usual bases.
MAX_COMMAND_GAP = 0.5
# Longest time for which the robot may move without a new command [s]; chosen: the time-out of the
# base, 0.5 s here, and as long to brake.
MAX_UNATTENDED = 1.0
# The map of whoever has mistaken the unit of its resolution [bytes].
HUGE_MAP = 400_000_000
# How long and how often strangers publish [s], and by how much poses are tilted [rad] and a clock
# is set [s].
DURATION, PERIOD = 2.0, 0.02
TILT, CLOCK_STEP = 0.5, 3600.0
# Callbacks of the stranger at a time, as many as come in one period.
CALLBACKS = 8
# Goals of a storm, and time from one to the next [s]: 100 in a second.
STORM_SIZE, STORM_PERIOD = 300, 0.01
# Longest wait for the answers to all of them [s].
STORM_TIMEOUT = 30.0
# Name of the second controller among the processes, and the frame by which its commands are known.
SECOND, SECOND_FRAME = 'second_controller', 'second_base'
# How long two controllers are watched, and time between commands of two who drive at once [s].
WATCHED_TIME, SHARED_TIME = 12.0, 0.5
HUGE = 2 ** 63 - 1


class _Driver(NamedTuple):
    """Who has commanded a motion, by the frame of the command, and when [s]."""

    time: float
    frame: str


class StrangerRig:
    """Three nodes which do tasks, and a node beside them."""

    def __init__(self, rig: ProcessRig) -> None:
        """
        Make a node beside the others.

        :param rig: the ``ProcessRig``.
        """
        self.rig = rig
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=rig.nodes.domain)
        self.node = rclpy.create_node('stranger', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._publishers: dict[str, Any] = {}
        # How much of each log belongs to cases before [bytes].
        self._log_starts: dict[Path, int] = {}

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def publish(self, topic: str, message: Any) -> None:
        """
        Publish a message, the first one of a topic as soon as somebody listens.

        :param topic: its name.
        :param message: of any type.
        """
        self.advertise(topic, type(message))
        self._publishers[topic].publish(message)

    def advertise(self, topic: str, kind: type[Any]) -> None:
        """
        Wait until somebody listens to a topic.

        :param topic: its name.
        :param kind: of its messages.
        """
        if topic not in self._publishers:
            qos = TOPICS[topic].publish_qos if topic in TOPICS else 10
            self._publishers[topic] = self.node.create_publisher(kind, topic, qos)
            self.wait(lambda: self._publishers[topic].get_subscription_count() > 0)

    def spin(self, duration: float = 0.0) -> None:
        """
        Take in what comes, for a while.

        :param duration: [s].
        """
        end = time.monotonic() + duration
        while True:
            for _ in range(CALLBACKS):
                self._executor.spin_once(timeout_sec=0.0)
            self.rig.pump(0.0 if duration == 0.0 else PERIOD)
            if time.monotonic() >= end:
                return

    def wait(self, condition: Callable[[], bool], timeout: float = TIMEOUT) -> bool:
        """
        Take in what comes until a condition holds.

        :param condition: takes nothing.
        :param timeout: [s].
        :return: whether it holds.
        """
        end = time.monotonic() + timeout
        while not condition() and time.monotonic() < end:
            self.spin(PERIOD)
        return condition()

    def call(self, future: Future) -> Any:
        """Wait for an answer; None where none comes."""
        return future.result() if self.wait(future.done) else None

    def repeat(self, topic: str, make: Callable[[], Any]) -> None:
        """Publish for a while."""
        for _ in range(round(DURATION / PERIOD)):
            self.publish(topic, make())
            self.spin(PERIOD)

    def moving(self) -> None:
        """Wait until the robot drives in a task, and watch from now on."""
        self.rig.await_nodes()
        self.rig.reach(TaskState.APPROACH)
        self.rig.monitor.watch()

    def finish(self, seen: str, faults: list[str]) -> Observation:
        """Let another task be done, and look for tracebacks."""
        monitor = self.rig.monitor
        self.rig.await_nodes()
        self.rig.set_goal()
        since = time.monotonic()
        if not self.wait(lambda: monitor.state is TaskState.DONE and monitor.changed_at > since):
            faults.append(f'the next task is not done: {monitor.state.value}, {monitor.reason}')
        return Observation(seen, (*faults, *self.tracebacks()))

    def tracebacks(self) -> list[str]:
        """Quote the tracebacks that any node has written since this was last asked."""
        quotations: list[str] = []
        for log in sorted(self.rig.folder.glob('*.log')):
            content = log.read_bytes()
            new = content[self._log_starts.get(log, 0):]
            self._log_starts[log] = len(content)
            quotations += traceback_in(new.decode(errors='replace'))
        return quotations

    def start_again(self, name: str) -> None:
        """
        Start a node that has ended; its log begins anew.

        :param name: of the node.
        """
        self._log_starts.pop(self.rig.folder / f'{name}.log', None)
        self.rig.start(name)

    def gap_faults(self) -> list[str]:
        """List a fault where the controller did not command the robot for too long."""
        gap = self.rig.monitor.command_gap
        return [f'no command for {gap:.2f} s'] if gap > MAX_COMMAND_GAP else []

    def names(self, code: object) -> list[str]:
        """List a fault where the controller has not told a code."""
        is_seen = str(code) in self.rig.monitor.seen
        return [] if is_seen else [f'{code} is not told; {sorted(self.rig.monitor.seen)}']


@contextlib.contextmanager
def stranger_rig() -> Generator[StrangerRig, None, None]:
    """
    Start three nodes, and a node beside them.

    :raises NodeDied: where one of them does not end well.
    """
    with process_rig() as rig:
        stranger = StrangerRig(rig)
        try:
            rig.await_nodes()
            yield stranger
        finally:
            stranger.close()


def _huge_map(stranger: StrangerRig) -> Observation:
    """Publish a map of 400 MB, in a process of its own."""
    stranger.moving()
    monitor = stranger.rig.monitor
    process = subprocess.Popen([sys.executable, '-m', 'benchmarks.faults.huge_map',
                                str(HUGE_MAP)], env=private_environment(stranger.rig.nodes.domain))
    stranger.wait(lambda: process.poll() is not None)
    process.kill()
    stranger.wait(lambda: str(Notice.MAP_REFUSED) in monitor.seen)
    gap, unattended = monitor.command_gap, monitor.unattended
    faults = stranger.names(Notice.MAP_REFUSED)
    if unattended > MAX_UNATTENDED:
        faults.append(f'the robot drives for {unattended:.2f} s without a command')
    message = OccupancyGrid()
    message.header.frame_id = Frames().world_frame
    message.info.resolution, message.info.width, message.info.height = 0.1, 100, 100
    message.info.origin = to_pose_message(Pose(-5.0, -5.0, 0.0))
    message.data = [0] * 10_000
    stranger.publish('map', message)
    return stranger.finish(f'{monitor.error or "not refused"}; longest gap of commands '
                           f'{gap:.2f} s, at most {unattended:.2f} s of it driven', faults)


def _tilted_poses(stranger: StrangerRig) -> Observation:
    stranger.advertise('object_pose', PoseStamped)
    stranger.moving()
    message = PoseStamped(pose=to_pose_message(Pose(0.0, 0.0, 0.0)))
    message.header.frame_id = Frames().world_frame
    message.pose.orientation.x = math.sin(0.5 * TILT)
    message.pose.orientation.w = math.cos(0.5 * TILT)
    stranger.repeat('object_pose', lambda: message)
    faults = stranger.names(Notice.POSE_REFUSED)
    if math.isnan(stranger.rig.monitor.stood_at):
        faults.append('the robot does not stop')
    return stranger.finish(stranger.rig.monitor.error, faults)


def _second_controller(stranger: StrangerRig) -> Observation:
    """Let a second controller get the same goal: one of them drives, the other says who does."""
    rig = stranger.rig
    rig.await_nodes()
    file = rig.files[CONTROLLER].with_name(f'{SECOND}.yaml')
    file.write_bytes(rig.files[CONTROLLER].read_bytes())
    change_parameters(file, base_frame=SECOND_FRAME)
    rig.nodes.start(SECOND, MODULES[CONTROLLER], file)
    count = stranger.node.count_subscribers('goal_pose')
    stranger.wait(lambda: stranger.node.count_subscribers('goal_pose') > count)
    drivers: list[_Driver] = []

    def on_command(message: TwistStamped) -> None:
        if from_twist_message(message.twist) != STOP:
            drivers.append(_Driver(time.monotonic(), message.header.frame_id))
    subscription = stranger.node.create_subscription(TwistStamped, 'cmd_vel', on_command,
                                                     CALLBACKS)
    rig.monitor.watch()
    rig.set_goal()
    stranger.spin(WATCHED_TIME)
    stranger.node.destroy_subscription(subscription)
    faults = stranger.names(SafetyReason.COMMANDED_BY_OTHERS)
    if not drivers:
        faults.append('nobody drives')
    shared = sum(after.frame != before.frame and after.time - before.time < SHARED_TIME
                 for before, after in itertools.pairwise(drivers))
    if shared:
        faults.append(f'both drive at once, {shared} times')
    rig.nodes.stop(SECOND)
    return stranger.finish('one drives, the other says who does, and sends nothing', faults)


def _clock_steps(stranger: StrangerRig) -> Observation:
    """Let a second clock be an hour ahead for a while."""
    stranger.advertise('/clock', Clock)
    stranger.moving()
    rig, start = stranger.rig, time.monotonic()
    stranger.repeat('/clock', lambda: Clock(clock=to_stamp(
        CLOCK_STEP + time.monotonic() - start)))
    seen = ', '.join(sorted(rig.monitor.seen)) or 'nothing is told'
    return stranger.finish(f'{seen}; longest gap of commands {rig.monitor.command_gap:.2f} s',
                           stranger.gap_faults())


def _goals_at_shutdown(stranger: StrangerRig) -> Observation:
    """Publish goals while the controller ends."""
    goal = PoseStamped(pose=to_pose_message(Pose(0.02, 0.0, 0.0)))
    goal.header.frame_id = Frames().world_frame
    stranger.advertise('goal_pose', PoseStamped)
    stranger.moving()
    since = time.monotonic()
    stranger.publish('goal_pose', goal)
    stranger.rig.nodes.send(CONTROLLER, signal.SIGINT)
    while time.monotonic() < since + 1.0:
        stranger.publish('goal_pose', goal)
        stranger.spin(PERIOD)
    return _restarted(stranger, since)


def _user_signal(stranger: StrangerRig) -> Observation:
    """Send a signal that nobody expects in the middle of a task."""
    stranger.moving()
    since = time.monotonic()
    stranger.rig.nodes.send(CONTROLLER, signal.SIGUSR1)
    return _restarted(stranger, since)


def _restarted(stranger: StrangerRig, since: float) -> Observation:
    """
    Wait until the robot stands and the controller has ended, and start it again.

    :param stranger: the ``StrangerRig``.
    :param since: when the controller was asked to end [s].
    """
    rig, faults = stranger.rig, list[str]()
    if not stranger.wait(lambda: not math.isnan(rig.monitor.stood_at), 5.0):
        faults.append('the robot drives')
    elapsed = rig.monitor.stood_at - since
    rig.nodes.stop(CONTROLLER)
    faults += stranger.tracebacks()
    rig.monitor.nodes.discard(CONTROLLER)
    rig.monitor.state = TaskState.IDLE
    stranger.start_again(CONTROLLER)
    return stranger.finish(f'ends well; the robot stands after {elapsed:.2f} s', faults)


def _huge_parameters(stranger: StrangerRig) -> Observation:
    """Set parameters to numbers that no setting can have."""
    stranger.moving()
    client = stranger.node.create_client(SetParameters, f'{CONTROLLER}/set_parameters')
    stranger.wait(client.service_is_ready)
    values = [ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=HUGE),
              *(ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)
                for value in (math.nan, math.inf, 1e308))]
    names = 'control.pose_gate', 'control.pose_timeout', 'supervision.position_tolerance'
    parameters = [Parameter(name=name, value=value) for name in names for value in values]
    faults, refusals = list[str](), list[str]()
    for parameter in parameters:
        answer = stranger.call(client.call_async(SetParameters.Request(parameters=[parameter])))
        if answer is None:
            faults.append(f'{parameter.name}: no answer')
        elif answer.results[0].successful:
            faults.append(f'{parameter.name}: accepts {parameter.value.integer_value or ""}'
                          f'{parameter.value.double_value or ""}')
        else:
            refusals.append(answer.results[0].reason)
    return stranger.finish('; as: '.join([f'{len(refusals)} of {len(parameters)} values refused',
                                          *refusals[:1]]), faults)


def _action_storm(stranger: StrangerRig) -> Observation:
    """Send 100 goals a second by the action, and cancel each at once."""
    interfaces = import_push_interfaces()
    if interfaces is None:
        return Observation('not run: push_control_msgs is not installed')
    stranger.moving()
    # As deep as the server's, lest answers are lost that have come.
    client = ActionClient(stranger.node, interfaces.action, ACTION,
                          goal_service_qos_profile=qos.REQUEST,
                          result_service_qos_profile=qos.REQUEST,
                          cancel_service_qos_profile=qos.REQUEST)
    stranger.wait(client.server_is_ready)
    goal = interfaces.action.Goal()
    goal.goal_pose.header.frame_id = Frames().world_frame
    goal.goal_pose.pose = to_pose_message(Pose(0.02, 0.0, 0.0))
    results: list[Future] = []

    def cancel(answer: Future) -> None:
        handle: Any = answer.result()
        if handle.accepted:
            results.append(handle.get_result_async())
            handle.cancel_goal_async()
    answers: list[Future] = []
    for _ in range(STORM_SIZE):
        answers.append(client.send_goal_async(goal))
        answers[-1].add_done_callback(cancel)
        stranger.spin(STORM_PERIOD)
    stranger.wait(lambda: all(future.done() for future in (*answers, *results)), STORM_TIMEOUT)
    unanswered = sum(not answer.done() for answer in answers)
    missing = sum(not result.done() for result in results)
    client.destroy()
    faults = [text for text, is_so in (
        (f'{unanswered} requests without an answer', unanswered),
        (f'{missing} accepted goals without a result', missing)) if is_so]
    return stranger.finish(f'{STORM_SIZE - unanswered} of {STORM_SIZE} requests were answered, '
                           f'{len(results)} goals were accepted; longest gap of commands '
                           f'{stranger.rig.monitor.command_gap:.2f} s', faults)


STRANGER_CASES: dict[str, Callable[[StrangerRig], Observation]] = {
    'strangers: tilted object poses': _tilted_poses,
    'strangers: a second clock, an hour ahead': _clock_steps,
    'strangers: huge numbers for parameters': _huge_parameters,
    'strangers: a second controller': _second_controller,
    'strangers: 100 goals a second, cancelled at once': _action_storm,
    'strangers: a map of 400 MB': _huge_map,
    'signals: SIGUSR1 in a task': _user_signal,
    'signals: goals while the controller ends': _goals_at_shutdown,
}
