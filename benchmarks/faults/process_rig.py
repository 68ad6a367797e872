"""
Faults of processes: a node that is killed, suspended or started again, in each state of a task.

Simulator, planner and controller run over DDS, and do one task after the other. Simulated time
goes as fast as the clock of the wall. In a state of the task one of them is struck; what is left
of them has to stand or to go on by itself, and to say so. A controller that was lost has forgotten
its goal, and a simulator that was lost its world: then somebody has to set the next goal.
"""

from collections.abc import Callable, Generator, Sequence
import contextlib
import enum
import math
from pathlib import Path
import signal
import tempfile
import time
from typing import NamedTuple

from benchmarks.faults.expectations import Notice, notices
from benchmarks.faults.row import append_line, Ending, read_lines, violation_text
from benchmarks.faults.verdict import BRAKING_TIME, Violation
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
import numpy as np
from push_control.events import TaskEvent
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_ros.conversions.primitives import from_twist_message
from push_ros.diagnostics import ERROR, status_values
from push_ros.node_settings import Frames
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_safety.status import SafetyReason
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeProcesses
from push_scenario.dds.replay import MODULES
from push_scenario.dds.replay_client import ReplayClient, ReplayFailed
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.start import place_robot
from rclpy.serialization import deserialize_message
import yaml

SCENARIO = 'task_tap'
# Goals are drawn around the origin, up to these distances [m, m, rad]; chosen: a tap or two each.
GOAL_RANGE = 0.03, 0.03, 0.1
# How long a process is suspended, and after which it is started again [s].
SUSPENSION, RESTART_TIME = 3.0, 1.0
# Time after the fault in which the task has to end, or the robot to stand and say why [s]; chosen:
# above the time limit of a plan, and a task besides.
OBSERVATION_TIME = 45.0
# How long nothing happens where the robot waits [s]; chosen: longer than the time-out of a plan.
WAITING_TIME = 24.0
# Limits on the wall [s]; chosen: far above what nodes take on a busy machine.
START_TIMEOUT, STATE_TIMEOUT = 180.0, 120.0
# Speeds below which the robot stands [m/s], [rad/s]; chosen: above the noise of odometry.
STANDING_SPEED, STANDING_YAW_RATE = 0.02, 0.1
# States in which every measurement is answered by a command.
MOVING = TaskState.APPROACH, TaskState.PUSH, TaskState.RETREAT


class Strike(enum.Enum):
    """What happens to a process."""

    # At once, without a last command; it is started again after ``RESTART_TIME``.
    KILLED = 'killed'
    # It stands still for ``SUSPENSION``, and goes on.
    SUSPENDED = 'suspended for 3 s'
    # It is asked to end, and started again.
    RESTARTED = 'started again'


class ProcessFault(NamedTuple):
    """
    What happens to whom.

    :param node: its name.
    :param strike: the ``Strike``.
    :param state: the ``TaskState`` in which it happens.
    """

    node: str
    strike: Strike
    state: TaskState

    def __str__(self) -> str:
        """Name the fault."""
        return f'{self.node} {self.strike.value}, in {self.state.value}'


class ProcessRow(NamedTuple):
    """
    How a task with such a fault ended.

    :param fault: the ``ProcessFault``.
    :param ending: the ``Ending``.
    :param reason: as reported, one sentence.
    :param codes: names of the codes of the reason.
    :param violations: names of each ``Violation``; empty where it ended as it should.
    :param stop_time: time on the wall after which the robot first stands [s]; nan where it never
        does, or cannot be seen.
    """

    fault: ProcessFault
    ending: Ending
    reason: str
    codes: tuple[str, ...]
    violations: tuple[str, ...]
    stop_time: float

    @property
    def is_ok(self) -> bool:
        """Whether the run ended as it should."""
        return not self.violations

    def __str__(self) -> str:
        """Write one line."""
        return (f'{self.fault}: {self.ending.value}' + (f', {self.reason}' if self.reason else '')
                + f' (stands after {self.stop_time:.2f} s)'
                + violation_text(self.violations))


def process_faults() -> list[ProcessFault]:
    """List all faults: a planner matters while it plans, the others while the robot moves."""
    return [ProcessFault(node, strike, state) for node in (PLANNER, CONTROLLER, SIM)
            for strike in Strike
            for state in (TaskState.PLAN, TaskState.APPROACH, TaskState.PUSH)
            if node is not SIM or state is not TaskState.PLAN]


# Codes that name what has happened where a task is not done after it.
LOST_GOAL = frozenset({str(Notice.NO_GOAL)})
REASONS = {
    PLANNER: frozenset(map(str, (TaskEvent.NOBODY_PLANS, TaskEvent.PLANNER_SILENT))),
    CONTROLLER: LOST_GOAL,
    SIM: frozenset(map(str, (TaskEvent.TIME_WENT_BACK, Notice.TIME_WENT_BACK,
                             Notice.NO_ODOMETRY, SafetyReason.ODOMETRY_WAS_MISSING)))}


def process_violations(fault: ProcessFault, ending: Ending, codes: Sequence[str],
                       stands: bool) -> tuple[str, ...]:
    """
    Check how a task with a fault has ended.

    :param codes: names of the codes of the reason.
    :param stands: whether the robot stands in the end.
    :return: names of each ``Violation``.
    """
    names_fault = not REASONS[fault.node].isdisjoint(codes)
    return tuple(violation.name for violation, is_so in (
        (Violation.STILL_DRIVES, not stands),
        (Violation.WRONG_REASON, ending is not Ending.DONE and not names_fault)) if is_so)


class TaskMonitor:
    """What the nodes have reported: state of the task, errors, and how the robot moves."""

    def __init__(self) -> None:
        self.nodes: set[str] = set()
        self.state = TaskState.IDLE
        self.reason = self.error = ''
        self.codes: tuple[str, ...] = ()
        self.changed_at = self.odometry_at = -math.inf
        self.stands = True
        # When it first stood since it was watched; nan before.
        self.stood_at = math.nan
        # What the controller has reported since then, by code.
        self.seen: set[str] = set()
        self._command_gap = 0.0
        self._commanded_at = math.nan
        # Longest time for which the robot has moved without a new command [s].
        self.unattended = 0.0

    def watch(self) -> None:
        """Note when the robot stands from now on, and what is reported."""
        self.stood_at, self.error = math.nan, ''
        self.changed_at = time.monotonic()
        self.seen = set()
        self._command_gap, self._commanded_at = 0.0, math.nan
        self.unattended = 0.0

    @property
    def command_gap(self) -> float:
        """Longest time between two commands, or after the last, while the robot moves [s]."""
        if self.state not in MOVING or math.isnan(self._commanded_at):
            return self._command_gap
        return max(self._command_gap, time.monotonic() - self._commanded_at)

    def has_reached(self, state: TaskState) -> bool:
        """
        Tell whether a task is in a state, and the robot drives if it moves in that.

        :param state: the ``TaskState``.
        """
        return self.state is state and not (state in MOVING and self.stands)

    def on_message(self, topic: str, data: bytes) -> None:
        """Take in a message."""
        if topic == 'odom':
            twist = from_twist_message(deserialize_message(data, Odometry).twist.twist)
            self.odometry_at = time.monotonic()
            self.stands = (math.hypot(twist.v_x, twist.v_y) < STANDING_SPEED
                           and abs(twist.omega) < STANDING_YAW_RATE)
            if not (self.stands or math.isnan(self._commanded_at)):
                self.unattended = max(self.unattended, self.odometry_at - self._commanded_at)
            if self.stands and math.isnan(self.stood_at):
                self.stood_at = self.odometry_at
        elif topic == 'cmd_vel':
            self._on_command()
        elif topic == 'diagnostics':
            for status in deserialize_message(data, DiagnosticArray).status:
                self.nodes.add(status.name)
                if status.level == ERROR:
                    self.error = f'{status.name}: {status.message}'
                values = status_values(status)
                self.seen.update(values.get('codes', '').split(), notices(status.message))
                if status.name == CONTROLLER and 'state' in values:
                    self._on_state(TaskState(values['state']), values['reason'])
                    self.codes = tuple(values.get('codes', '').split())
                elif status.name == CONTROLLER:
                    self.reason, self.codes = status.message, notices(status.message)

    def _on_command(self) -> None:
        self._command_gap = self.command_gap
        self._commanded_at = time.monotonic()

    def _on_state(self, state: TaskState, reason: str) -> None:
        if state is not self.state:
            self._command_gap, self._commanded_at = self.command_gap, math.nan
        if (state, reason) != (self.state, self.reason):
            self.state = state
            self.reason = reason
            self.changed_at = time.monotonic()


class ProcessRig:
    """Three nodes, which do tasks and are struck."""

    def __init__(self, nodes: NodeProcesses, files: dict[str, Path], seed: int) -> None:
        """
        Start the nodes.

        :param nodes: the ``NodeProcesses``.
        :param files: path of the parameters of each node.
        :param seed: of the goals.
        """
        self.nodes = nodes
        self.files = files
        self.folder = files[CONTROLLER].parent
        self._rng = np.random.default_rng(seed)
        self.monitor = TaskMonitor()
        self._client = ReplayClient(nodes.domain, True, self.monitor.on_message, lambda: None,
                                    topics=('odom', 'cmd_vel', 'diagnostics'))
        for name in files:
            self.start(name)

    def close(self) -> None:
        """
        End all nodes.

        :raises NodeDied: where one does not end well.
        """
        try:
            self.nodes.stop_all()
        finally:
            self._client.close()

    def run(self, fault: ProcessFault) -> ProcessRow:
        """
        Do a task with a fault.

        :param fault: the ``ProcessFault``.
        """
        monitor = self.monitor
        self.await_nodes()
        self.reach(fault.state)
        monitor.watch()
        struck_at = time.monotonic()
        self._strike(fault)
        while not self._has_ended(struck_at):
            self._client.pump()
        self._await_rest()
        ending = {TaskState.DONE: Ending.DONE, TaskState.FAILED: Ending.FAILED}.get(
            monitor.state, Ending.WAITS)
        reason, codes = monitor.reason or monitor.error, monitor.codes
        if ending is Ending.WAITS and monitor.state is TaskState.IDLE and not reason:
            reason, codes = Notice.NO_GOAL.value, (str(Notice.NO_GOAL),)
        if ending is Ending.DONE:
            reason, codes = '', ()
        return ProcessRow(fault, ending, reason, codes,
                          process_violations(fault, ending, codes, monitor.stands),
                          monitor.stood_at - struck_at)

    def await_nodes(self) -> None:
        """Wait until all nodes are there, and the robot is measured."""
        monitor = self.monitor
        self._wait(lambda: monitor.nodes >= MODULES.keys() and not self._client.missing()
                   and time.monotonic() - monitor.odometry_at < 1.0, START_TIMEOUT)

    def reach(self, state: TaskState) -> None:
        """
        Set goals until a task is in a state, and the robot drives if it moves in that.

        :param state: the ``TaskState``.
        """
        monitor = self.monitor
        self.set_goal()
        end = time.monotonic() + STATE_TIMEOUT
        while not monitor.has_reached(state):
            if time.monotonic() > end:
                raise ReplayFailed(f'timed out after {STATE_TIMEOUT:g} s waiting for the state '
                                   f'{state.value}; it is {monitor.state.value}, {monitor.reason}')
            if monitor.state.is_standing and time.monotonic() - monitor.changed_at > 1.0:
                self.set_goal()
            self._client.pump()

    def set_goal(self) -> None:
        """Set a goal near the object."""
        goal = (self._rng.uniform(-1.0, 1.0, 3) * GOAL_RANGE).tolist()
        self.monitor.changed_at = time.monotonic()
        self._client.send_goal(Pose(*goal), Frames().world_frame)

    def _strike(self, fault: ProcessFault) -> None:
        name = fault.node
        if fault.strike is Strike.SUSPENDED:
            self.nodes.send(name, signal.SIGSTOP)
            self.pump(SUSPENSION)
            self.nodes.send(name, signal.SIGCONT)
            return
        if fault.strike is Strike.KILLED:
            self.nodes.send(name, signal.SIGKILL)
            self.pump(RESTART_TIME)
        else:
            self.nodes.stop(name)
        self.monitor.nodes.discard(name)
        self.start(name)
        if name == CONTROLLER:
            # Whatever it did is over.
            self.monitor.state, self.monitor.reason = TaskState.IDLE, ''

    def start(self, name: str) -> None:
        """
        Start a node.

        :param name: of the node.
        """
        self.nodes.start(name, MODULES[name], self.files[name])

    def _has_ended(self, struck_at: float) -> bool:
        monitor, now = self.monitor, time.monotonic()
        if monitor.state.is_final and monitor.changed_at > struck_at:
            return True
        is_quiet = monitor.stands and now - monitor.changed_at > WAITING_TIME
        is_up = monitor.nodes >= MODULES.keys() and now - monitor.odometry_at < 1.0
        return is_up and is_quiet or now - struck_at > OBSERVATION_TIME

    def _await_rest(self) -> None:
        """Let a robot brake whose task has ended, as slowly as a weak base does."""
        end = time.monotonic() + BRAKING_TIME
        while not self.monitor.stands and time.monotonic() < end:
            self._client.pump()

    def pump(self, duration: float) -> None:
        """
        Take in messages for a while.

        :param duration: [s].
        """
        end = time.monotonic() + duration
        while time.monotonic() < end:
            self._client.pump()

    def _wait(self, condition: Callable[[], bool], timeout: float) -> None:
        self._client.wait_for(lambda: [] if condition() else ['the nodes'], timeout)


@contextlib.contextmanager
def process_rig(seed: int = 1) -> Generator[ProcessRig, None, None]:
    """
    Start three nodes on a domain of their own.

    :param seed: of the goals.
    :raises NodeDied: where one of them does not end well.
    """
    scenario = place_robot(load_scenario(SCENARIO))
    with private_domain() as domain, tempfile.TemporaryDirectory() as folder, \
            NodeProcesses(domain, folder) as nodes:
        files = write_parameter_files(Path(folder), scenario, scenario.control, Path(),
                                      real_time=True, stamped=True)
        change_parameters(files[SIM], tape_path='', time_limit=0.0, autostart=True)
        change_parameters(files[CONTROLLER], wait_for_start=False)
        rig = ProcessRig(nodes, files, seed)
        yield rig
        rig.close()


def change_parameters(path: Path, **values: object) -> None:
    """
    Change parameters in the file of one node.

    :param path: of the file.
    :param values: by name.
    """
    parameters = yaml.safe_load(path.read_text(encoding='utf-8'))
    for node in parameters.values():
        node['ros__parameters'].update(values)
    path.write_text(yaml.safe_dump(parameters), encoding='utf-8')


def append_process_row(path: Path, row: ProcessRow) -> None:
    """
    Add a run to a file.

    :param path: of the file, one run a line.
    :param row: the ``ProcessRow``.
    """
    fault = row.fault
    append_line(path, {**row._asdict(), 'ending': row.ending.value,
                       'fault': [fault.node, fault.strike.value, fault.state.value]})


def read_process_rows(path: Path) -> list[ProcessRow]:
    """
    Read the runs of a file.

    :param path: of the file; where it is not there, there are none.
    """
    rows: list[ProcessRow] = []
    for values in read_lines(path):
        node, strike, state = values['fault']
        values.update(fault=ProcessFault(node, Strike(strike), TaskState(state)),
                      ending=Ending(values['ending']), codes=tuple(values['codes']),
                      violations=tuple(values['violations']))
        rows.append(ProcessRow(**values))
    return rows
