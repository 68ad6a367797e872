"""
Soak: many tasks in a row in one set of nodes, over DDS in lockstep.

What a node takes must not grow with what it has done: memory, file descriptors, threads, CPU time
and, as in lockstep time waits for answers, time on the wall for a second of simulated time. The
same goals come again and again. Times are divided by that of a fixed computation beside each task,
as other processes slow a machine down.
"""

from collections.abc import Sequence
from pathlib import Path
import tempfile
import time
from typing import NamedTuple

from benchmarks.faults.row import append_line, read_lines
from benchmarks.nodes import cpu_time, resident_memory
from diagnostic_msgs.msg import DiagnosticArray
import numpy as np
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_ros.conversions.primitives import NANOSECONDS
from push_ros.diagnostics import status_values
from push_ros.node_settings import Frames
from push_ros.topics import CONTROLLER, SIM, TOPICS
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeProcesses
from push_scenario.dds.recorder import stamp_of
from push_scenario.dds.replay import MODULES
from push_scenario.dds.replay_client import ReplayClient
from push_scenario.definition.loader import load_scenario
from push_scenario.simulation.start import place_robot
from rclpy.serialization import deserialize_message
from tqdm import tqdm
import yaml

SCENARIO = 'task_tap'
# Goals are drawn around the origin, up to these distances [m, m, rad]; chosen: a tap or two each.
GOAL_RANGE = 0.03, 0.03, 0.1
# How many goals there are, which come in turns; chosen: some cycles in each part.
GOAL_COUNT = 20
# Additions of the fixed computation; chosen: some hundredths of a second.
LOOP_COUNT = 400_000
# Part of the tasks that counts as the beginning and as the end, after the first ones in which
# caches are filled; chosen.
PART = 0.25
WARM_UP = 0.1
# Wall time after which the nodes, or a task, count as hanging [s]; chosen: far above what they
# take on a busy machine.
TIMEOUT = 180.0


class Sample(NamedTuple):
    """
    A node after a task, or what it has taken for it.

    :param memory: resident [MB].
    :param descriptors: number of open files and sockets.
    :param threads: number.
    :param cpu: CPU time for the task [s].
    """

    memory: float
    descriptors: int
    threads: int
    cpu: float


class SoakTask(NamedTuple):
    """
    One task of a soak.

    :param is_done: whether it was done, else it has failed.
    :param reason: why, where it has failed.
    :param duration: simulated [s].
    :param wall_time: [s].
    :param nodes: ``Sample`` by name of the node.
    :param reference: CPU time of the fixed computation after it [s].
    :param first: number of the task with which these nodes began; 0 unless it was interrupted.
    """

    is_done: bool
    reason: str
    duration: float
    wall_time: float
    nodes: dict[str, Sample]
    reference: float
    first: int = 0


class _Monitor:
    """Last state of the task, and simulated time, from the messages of the nodes."""

    def __init__(self) -> None:
        self.nodes: set[str] = set()
        self.time = 0.0
        self.state = TaskState.IDLE
        self.since = 0.0
        self.reason = ''

    def on_message(self, topic: str, data: bytes) -> None:
        """Take in a message."""
        if topic == 'clock':
            stamp = stamp_of(topic, data, TOPICS[topic].type)
            self.time = max(self.time, (stamp or 0) / NANOSECONDS)
        elif topic == 'diagnostics':
            for status in deserialize_message(data, DiagnosticArray).status:
                self.nodes.add(status.name)
                values = status_values(status)
                if status.name == CONTROLLER and 'state' in values:
                    self.state, self.reason = TaskState(values['state']), values['reason']
                    self.since = float(values['since'])


def run_soak(count: int, path: Path, seed: int = 1) -> None:
    """
    Do tasks in a row, as far as they are not in a file yet; each is kept when it is done.

    :param count: of tasks.
    :param path: of the file.
    :param seed: of their goals.
    :raises RuntimeError: where a node dies or hangs.
    """
    first = len(read_lines(path))
    if first >= count:
        return
    scenario = place_robot(load_scenario(SCENARIO))
    goals = np.random.default_rng(seed).uniform(-1.0, 1.0, (GOAL_COUNT, 3)) * GOAL_RANGE
    goals = np.resize(goals, (count, 3))
    monitor = _Monitor()
    with private_domain() as domain, tempfile.TemporaryDirectory() as folder, \
            NodeProcesses(domain, folder) as nodes:
        files = write_parameter_files(Path(folder), scenario, scenario.control, Path(),
                                      real_time=False, stamped=True)
        client = ReplayClient(domain, True, monitor.on_message, nodes.check)
        try:
            _let_time_run(files[SIM])
            for node, parameters in files.items():
                nodes.start(node, MODULES[node], parameters)
            client.wait_for(lambda: [*client.missing(), *sorted(MODULES.keys() - monitor.nodes)],
                            TIMEOUT)
            client.send_goal(Pose(*goals[first].tolist()), Frames().world_frame)
            client.call('controller/start', TIMEOUT)
            client.call('sim/start', TIMEOUT)
            for goal in tqdm(goals[first:].tolist(), desc='soak'):
                task = _do_task(Pose(*goal), client, monitor, nodes)
                append_task(path, task._replace(first=first))
            nodes.stop_all()
        finally:
            client.close()


def _let_time_run(path: Path) -> None:
    """Let the simulator go on without end; nobody reads its tape."""
    parameters = yaml.safe_load(path.read_text(encoding='utf-8'))
    parameters[SIM]['ros__parameters'].update(tape_path='', time_limit=0.0)
    path.write_text(yaml.safe_dump(parameters), encoding='utf-8')


def _do_task(goal: Pose, client: ReplayClient, monitor: _Monitor,
             nodes: NodeProcesses) -> SoakTask:
    """Set a goal, and wait until it is reached or given up."""
    # The end of the task before may be later than the clock, which comes now and then.
    start, began = max(monitor.time, monitor.since), time.monotonic()
    before = {name: cpu_time(nodes.pid(name)) for name in nodes.names}
    client.send_goal(goal, Frames().world_frame)
    end = ['the end of a task']
    client.wait_for(lambda: [] if monitor.state.is_final and monitor.since > start else end,
                    TIMEOUT)
    return SoakTask(
        monitor.state is TaskState.DONE, monitor.reason, monitor.since - start,
        time.monotonic() - began,
        {name: sample(nodes.pid(name), cpu) for name, cpu in before.items()},
        reference_time())


def reference_time() -> float:
    """Measure the CPU time of a fixed computation [s]."""
    start, total = time.process_time(), 0
    for i in range(LOOP_COUNT):
        total += i
    return time.process_time() - start


def sample(pid: int, cpu_before: float) -> Sample:
    """
    Look at a process, as Linux describes it.

    :param pid: of the process.
    :param cpu_before: CPU time that it had taken before [s].
    """
    folder = Path(f'/proc/{pid}')
    return Sample(1e-6 * resident_memory(pid), len(list((folder / 'fd').iterdir())),
                  len(list((folder / 'task').iterdir())), cpu_time(pid) - cpu_before)


def append_task(path: Path, task: SoakTask) -> None:
    """
    Keep a task of a soak.

    :param path: of the file, one task a line.
    :param task: the ``SoakTask``.
    """
    append_line(path, task._asdict())


def read_tasks(path: Path) -> list[SoakTask]:
    """
    Read the tasks of a soak.

    :param path: of the file; where it is not there, there are none.
    """
    tasks: list[SoakTask] = []
    for values in read_lines(path):
        nodes = {name: Sample(*sample) for name, sample in values.pop('nodes').items()}
        tasks.append(SoakTask(**values, nodes=nodes))
    return tasks


def soak_table(tasks: Sequence[SoakTask]) -> str:
    """
    Compare the beginning of a soak with its end.

    :param tasks: each ``SoakTask``.
    :return: Markdown.
    """
    if not tasks:
        return 'Not measured.'
    size = max(1, round(PART * len(tasks)))
    first = round(WARM_UP * len(tasks))
    parts = early, end = tasks[first:first + size], tasks[-size:]
    # Times as they would be if the fixed computation always took as long as at the beginning.
    slowness = [1e3 * _mean_reference(part) / _mean_reference(early) for part in parts]
    lines = ['| | beginning | end | ratio |', '| --- | --- | --- | --- |',
             _row('fixed computation [ms]', *(1e3 * _mean_reference(part) for part in parts)),
             _row('wall time per simulated second, all [ms]', *(
                 1e6 * sum(task.wall_time for task in part) / sum(
                     task.duration for task in part) / slow
                 for part, slow in zip(parts, slowness)))]
    for name in tasks[0].nodes:
        cpu = [1e6 * sum(task.nodes[name].cpu for task in part) / sum(
            task.duration for task in part) / slow for part, slow in zip(parts, slowness)]
        lines += [_row(f'`{name}`: memory [MB]', early[-1].nodes[name].memory,
                       end[-1].nodes[name].memory),
                  _row(f'`{name}`: CPU per simulated second [ms]', *cpu),
                  _row(f'`{name}`: file descriptors', early[-1].nodes[name].descriptors,
                       end[-1].nodes[name].descriptors),
                  _row(f'`{name}`: threads', early[-1].nodes[name].threads,
                       end[-1].nodes[name].threads)]
    done = sum(task.is_done for task in tasks)
    simulated = sum(task.duration for task in tasks)
    starts = len({task.first for task in tasks})
    interrupted = f' Interrupted, the nodes began anew: {starts} sets.' if starts > 1 else ''
    return '\n'.join([f'{len(tasks)} tasks in a row, {simulated:.0f} s simulated: {done} done.'
                      + interrupted, '', *lines])


def _mean_reference(tasks: Sequence[SoakTask]) -> float:
    return sum(task.reference for task in tasks) / len(tasks)


def _row(name: str, early: float, end: float) -> str:
    def text(value: float) -> str:
        return str(value) if isinstance(value, int) else f'{value:.1f}'
    return f'| {name} | {text(early)} | {text(end)} | {end / early:.3f} |'
