"""
What the nodes cost: time to start, CPU while idle and while they do a task, memory, latency.

Simulator, planner and controller run as processes of their own on the clock of the wall, with the
parameters of ``config/push.yaml``. Prints a Markdown table, and what a reference loop took
meanwhile: on a machine that is slower by some factor it is slower by the same.
"""

import argparse
import contextlib
import os
from pathlib import Path
import tempfile
import time
from typing import Any, Callable, Generator, NamedTuple

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
import numpy as np
from push_model.files.data import config_file
from push_model.geometry import Pose
from push_ros.conversions.primitives import to_pose_message
from push_ros.topics import CONTROLLER, PLANNER, SIM, TOPICS
from push_scenario.dds.launch_parameters import (
    CONTROLLER_SECTION, launch_parameters, SIM_SECTION, write_parameters,
)
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeProcesses
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

DESCRIPTION = 'What the nodes cost: time to start, CPU, memory, latency from pose to command.'
MODULES = {SIM: 'push_sim_node.sim_node', PLANNER: 'push_planner.planner_node',
           CONTROLLER: 'push_control.controller_node'}
# Goal of the task in the frame of odometry [m, m, rad], chosen: that of the demo.
GOAL = Pose(0.6, 0.6, np.pi / 2)
# Time over which idle nodes are measured, and until nodes count as settled [s]; chosen.
IDLE_TIME = 20.0
SETTLING_TIME = 5.0
# Time after which a node or a task is given up [s].
TIMEOUT = 300.0
# What nodes say on diagnostics once they are ready, and when the task is over.
READY = {SIM: 'runs', PLANNER: 'waits for a request', CONTROLLER: 'task: idle'}
# Additions of the reference loop, chosen: some tenths of a second.
LOOP_COUNT = 5_000_000


class Start(NamedTuple):
    """
    The start of a node.

    :param first_message: time until its first message [s].
    :param ready: time until it is ready for a goal [s].
    :param cpu: CPU time of the process by then [s].
    """

    first_message: float
    ready: float
    cpu: float


class Observer:
    """
    A node that sees when messages arrive.

    ``texts``: last text on diagnostics by node. ``arrivals``: times of arrival by topic,
    monotonic [s].
    """

    def __init__(self, node: Node, executor: SingleThreadedExecutor) -> None:
        self.texts: dict[str, str] = {}
        self.arrivals: dict[str, list[float]] = {'object_pose': [], 'cmd_vel': []}
        self._node = node
        self._executor = executor
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 50)
        for name, times in self.arrivals.items():
            node.create_subscription(
                TOPICS[name].message_type(), name,
                lambda _, times=times: times.append(time.monotonic()), 50)
        self._goals = node.create_publisher(PoseStamped, 'goal_pose', 1)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.texts[status.name] = status.message

    def give_goal(self) -> None:
        """Publish the goal, once the controller is there."""
        self.spin_until(lambda: self._goals.get_subscription_count() > 0)
        message = PoseStamped()
        message.header.frame_id = 'odom'
        message.pose = to_pose_message(GOAL)
        self._goals.publish(message)

    def spin_until(self, condition: Callable[[], bool], duration: float = TIMEOUT) -> bool:
        """Handle what arrives until a condition holds; tell whether it did in time."""
        end = time.monotonic() + duration
        while not condition():
            if time.monotonic() > end:
                return False
            self._executor.spin_once(timeout_sec=0.1)
        return True


@contextlib.contextmanager
def observer(domain: int) -> Generator[Observer, None, None]:
    """Join the domain of the nodes."""
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain)
    node = rclpy.create_node('benchmark', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    yield Observer(node, executor)
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown(context=context)


def cpu_time(pid: int) -> float:
    """Read the CPU time that a process has taken [s], as Linux counts it."""
    # Behind the name of the program in parentheses, which may contain anything.
    fields = Path(f'/proc/{pid}/stat').read_text(encoding='ascii').rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def resident_memory(pid: int) -> float:
    """Read the resident memory of a process [B], as Linux counts it."""
    pages = int(Path(f'/proc/{pid}/statm').read_text(encoding='ascii').split()[1])
    return pages * os.sysconf('SC_PAGE_SIZE')


def reference_loop() -> float:
    """Measure the CPU time of a million additions [s]."""
    began = time.process_time()
    total = 0
    for index in range(LOOP_COUNT):
        total += index
    return (time.process_time() - began) / LOOP_COUNT * 1e6


def start(processes: NodeProcesses, seen: Observer, name: str, parameters: Path) -> Start:
    """
    Start a node and wait until it is ready.

    :raises RuntimeError: where it does not become ready.
    """
    began = time.monotonic()
    processes.start(name, MODULES[name], parameters)
    is_ready = seen.spin_until(lambda: name in seen.texts)
    first_message = time.monotonic() - began
    if not is_ready or not seen.spin_until(lambda: seen.texts[name].startswith(READY[name])):
        raise RuntimeError(f'{name}: got {seen.texts.get(name)!r}, expected {READY[name]!r}')
    return Start(first_message, time.monotonic() - began, cpu_time(processes.pid(name)))


def shares(processes: NodeProcesses, seen: Observer, condition: Callable[[], bool],
           duration: float) -> dict[str, float]:
    """
    Measure the share of one core that each node takes until a condition holds.

    :return: share by node.
    """
    before = {name: cpu_time(processes.pid(name)) for name in processes.names}
    began = time.monotonic()
    seen.spin_until(condition, duration)
    passed = time.monotonic() - began
    return {name: (cpu_time(processes.pid(name)) - before[name]) / passed for name in before}


def latencies(poses: list[float], commands: list[float]) -> list[float]:
    """
    Pair each object pose with the first command behind it, before the next pose [s].

    :param poses: times of arrival.
    :param commands: likewise.
    """
    index = np.searchsorted(commands, poses)
    following = [*poses[1:], float('inf')]
    return [commands[i] - pose for i, pose, end in zip(index, poses, following)
            if i < len(commands) and commands[i] < end]


def measure(folder: Path) -> dict[str, Any]:
    """Start the nodes one after another, leave them idle, and give them the task."""
    sections = launch_parameters(config_file('push.yaml'))
    sections[SIM_SECTION]['autostart'] = True
    sections.setdefault(CONTROLLER_SECTION, {})['task'] = True
    parameters = Path(write_parameters(sections, folder))
    with private_domain() as domain, NodeProcesses(domain, folder) as processes, \
            observer(domain) as seen:
        starts = {name: start(processes, seen, name, parameters) for name in MODULES}
        seen.spin_until(lambda: False, SETTLING_TIME)
        idle = shares(processes, seen, lambda: False, IDLE_TIME)
        for times in seen.arrivals.values():
            times.clear()
        seen.give_goal()
        began = time.monotonic()
        working = shares(processes, seen, lambda: seen.texts[CONTROLLER].startswith(
            ('task: done', 'task: failed')), TIMEOUT)
        outcome, duration = seen.texts[CONTROLLER], time.monotonic() - began
        memory = {name: resident_memory(processes.pid(name)) for name in processes.names}
        processes.stop_all()
    times = latencies(seen.arrivals['object_pose'], seen.arrivals['cmd_vel'])
    return {'starts': starts, 'idle': idle, 'working': working, 'memory': memory,
            'outcome': outcome, 'duration': duration, 'latencies': times}


def report(measured: dict[str, Any], loops: list[float]) -> str:
    """Format what was measured as Markdown."""
    rows = ['| node | first message | ready for a goal | CPU by then | CPU idle | CPU in a task '
            '| memory |',
            '| --- | --- | --- | --- | --- | --- | --- |']
    rows += [f'| `{name}` | {times.first_message:.1f} s | {times.ready:.1f} s | {times.cpu:.1f} s '
             f'| {measured["idle"][name]:.1%} | {measured["working"][name]:.1%} '
             f'| {measured["memory"][name] / 1e6:.0f} MB |'
             for name, times in measured['starts'].items()]
    median, worst = np.percentile(measured['latencies'], (50, 99)) * 1e3
    return '\n'.join([
        *rows, '',
        f'{measured["outcome"]} after {measured["duration"]:.1f} s; pose to command, seen by '
        f'another node: median {median:.1f} ms, 99 of 100 {worst:.1f} ms '
        f'({len(measured["latencies"])} poses).',
        f'Reference loop: {1e3 * min(loops):.1f} to {1e3 * max(loops):.1f} ms of CPU per million '
        'additions; 1-minute load before and after: ' + ', '.join(measured['loads']) + '.'])


def main() -> None:
    """Measure and print."""
    argparse.ArgumentParser(description=DESCRIPTION).parse_args()
    loads = [f'{os.getloadavg()[0]:.1f}']
    loops = [reference_loop()]
    with tempfile.TemporaryDirectory() as folder:
        measured = measure(Path(folder))
    loops.append(reference_loop())
    measured['loads'] = [*loads, f'{os.getloadavg()[0]:.1f}']
    print(report(measured, loops))


if __name__ == '__main__':
    main()
