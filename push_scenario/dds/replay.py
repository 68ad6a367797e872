"""Replay of a scenario over DDS: nodes in processes of their own, and this one that watches."""

from collections.abc import Callable, Mapping
import contextlib
from pathlib import Path
import shutil
import time
from typing import Any, NamedTuple

from push_control.law_names import law_file_name
from push_control.steered.laws.own_law import check_own_law
from push_ros.node_settings import Frames
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.private_network import private_domain
from push_scenario.dds.processes import NodeProcesses
from push_scenario.dds.recorder import BagWriter
from push_scenario.dds.replay_client import ReplayClient, ReplayFailed
from push_scenario.dds.result import collect_result
from push_scenario.dds.run_monitor import PROGRESS_TOPIC, READ_TOPICS, RunMonitor
from push_scenario.definition.scenario import Scenario
from push_scenario.definition.task import LaterGoal, Task
from push_scenario.simulation.loop import ProgressCallback, SETTLE_TIME
from push_scenario.simulation.result import Outcome, RunResult
from push_scenario.simulation.start import place_robot

MODULES = {SIM: 'push_sim_node.sim_node', PLANNER: 'push_planner.planner_node',
           CONTROLLER: 'push_control.controller_node'}
# Wall-clock limits [s], each chosen at several times what it takes on a machine with twice as
# many busy processes as cores: they end a replay that hangs, and must not end a slow one.
START_TIMEOUT = 180.0
PLAN_TIMEOUT = 180.0
SERVICE_TIMEOUT = 180.0
STALL_TIMEOUT = 60.0


class NodeStart(NamedTuple):
    """
    A node that takes part in a replay.

    :param module: Python module with its main function.
    :param values: ROS parameters, beside or in place of those of the scenario.
    """

    module: str
    values: Mapping[str, Any] = {}


def run_over_dds(scenario: Scenario, control_law: str | None = None, out_dir: str | Path = 'out',
                 *, real_time: bool = False, record: bool = True,
                 progress: ProgressCallback | None = None, stamped: bool = True,
                 on_start: Callable[[NodeProcesses], None] | None = None,
                 nodes: Mapping[str, NodeStart] = {}) -> RunResult:
    """
    Replay a scenario; in lockstep equal scenarios give equal tapes, to the last bit.

    No other ROS node hears the run, or is heard in it. Afterwards this process can take part in
    no other ROS network.

    :param control_law: as of ``Scenario.with_law``; None for that of the scenario.
    :param out_dir: where the recording, and the nodes' parameters and output go.
    :param real_time: keep to the wall clock instead of going in lockstep.
    :param record: write a rosbag2 MCAP recording.
    :param progress: called with a ``Progress`` whenever simulated time is known.
    :param stamped: whether commands are ``TwistStamped``, else ``Twist``.
    :param on_start: called with the ``NodeProcesses`` when time starts to run.
    :param nodes: by name, those that take part besides, or in place of one of the three.
    :raises ValueError: where there is no such law, or an engine without a simulator in ``nodes``.
    :raises RuntimeError: where a node dies or hangs, naming it; no process is left in any case.
    """
    if control_law is not None:
        scenario = scenario.with_law(control_law)
    check_own_law(scenario.control)
    if scenario.engine != 'own' and SIM not in nodes:
        raise ValueError(f'{scenario.name}: engine: got {scenario.engine!r}, expected own over '
                         'DDS, or a simulator in nodes')
    scenario = place_robot(scenario)
    law = scenario.control.control_law
    run_name = f'{scenario.name}_{law_file_name(law)}'
    folder = Path(out_dir) / f'{run_name}_nodes'
    tape_path = _new_tape(folder)
    bag = Path(out_dir) / f'{run_name}_bag' if record else None
    files = write_parameter_files(folder, scenario, scenario.control, tape_path,
                                  real_time=real_time, stamped=stamped,
                                  more={name: node.values for name, node in nodes.items()})
    modules = MODULES | {name: node.module for name, node in nodes.items()}
    monitor = RunMonitor(scenario, progress)
    topics = READ_TOPICS if progress is None else (*READ_TOPICS, PROGRESS_TOPIC)
    with contextlib.ExitStack() as stack:
        processes = stack.enter_context(
            NodeProcesses(stack.enter_context(private_domain()), folder))
        client = ReplayClient(processes.domain, stamped, monitor.on_message, processes.check,
                              topics=None if record else topics)
        stack.callback(client.close)
        if bag is not None:
            stack.callback(_record(bag, client, monitor).close)
        for node, path in files.items():
            processes.start(node, modules[node], path)
        client.wait_for(lambda: [*client.missing(), *monitor.missing(modules)], START_TIMEOUT)
        refusal = _set_goal(scenario, client, monitor, is_lockstep=not real_time)
        if not refusal:
            _start(client)
            if on_start is not None:
                on_start(processes)
            _watch(scenario, client, monitor, _later_goals(scenario) if real_time else [])
        processes.stop_all()
        client.drain()
    if refusal:
        return RunResult(scenario, law, Outcome.REFUSED, refusal, bag=bag,
                         codes=monitor.error_codes(PLANNER))
    return collect_result(scenario, law, monitor, tape_path, bag)


def _new_tape(folder: Path) -> Path:
    """Make the folder of the nodes, without what a former run has left; return where to write."""
    folder.mkdir(parents=True, exist_ok=True)
    tape_path = folder / 'tape.csv'
    for stale in (tape_path, tape_path.with_suffix('.json')):
        stale.unlink(missing_ok=True)
    return tape_path


def _record(bag: Path, client: ReplayClient, monitor: RunMonitor) -> BagWriter:
    """Let the monitor write what it gets into a new recording."""
    _clear(bag)
    writer = BagWriter(bag, client.types)
    monitor.write = writer.write
    return writer


def _later_goals(scenario: Scenario) -> list[LaterGoal]:
    """List the goals that follow the first, the earliest first."""
    goals = () if scenario.task is None else scenario.task.goals
    return sorted(goals, key=lambda later: later.time)


def _set_goal(scenario: Scenario, client: ReplayClient, monitor: RunMonitor, *,
              is_lockstep: bool) -> str:
    """Set map and goals; return why there is no plan of a single push, an empty text else."""
    frame = Frames().world_frame
    if scenario.task is not None:
        _send_map(scenario.task, client, monitor, frame)
        # The first goal comes last: a node that has it has the later ones too. Only in lockstep
        # do goals hold from the time of their stamps on.
        for later in _later_goals(scenario) if is_lockstep else ():
            client.send_goal(later.goal.pose, frame, later.time)
        client.send_goal(scenario.goal.pose, frame)
        return ''
    client.send_goal(scenario.goal.pose, frame)
    client.wait_for(lambda: ['a plan'] if monitor.plan is None and not monitor.error(PLANNER)
                    else [], PLAN_TIMEOUT)
    return monitor.error(PLANNER) if monitor.plan is None else ''


def _send_map(task: Task, client: ReplayClient, monitor: RunMonitor, frame: str) -> None:
    if task.occupancy_map is None:
        return
    client.send_map(task.occupancy_map, frame)
    # Reading a large map takes a while.
    client.wait_for(lambda: [f'{node} to receive the map' for node in (PLANNER, CONTROLLER)
                             if node not in monitor.nodes_with_map()], PLAN_TIMEOUT)


def _start(client: ReplayClient) -> None:
    client.call('controller/start', SERVICE_TIMEOUT)
    client.call('sim/start', SERVICE_TIMEOUT)


def _watch(scenario: Scenario, client: ReplayClient, monitor: RunMonitor,
           later_goals: list[LaterGoal]) -> None:
    """Set later goals, until the run has ended and everything has had its time to rest."""
    time_before, advanced_at = monitor.time, time.monotonic()
    # In lockstep, simulated time stands still while a task is planned.
    stall_timeout = STALL_TIMEOUT if scenario.task is None else PLAN_TIMEOUT
    until = scenario.time_limit + SETTLE_TIME
    # One step further than the end: the clock may show a time before the tape has its row.
    while monitor.time <= until:
        client.pump()
        while later_goals and later_goals[0].time <= monitor.time:
            client.send_goal(later_goals.pop(0).goal.pose, Frames().world_frame)
        if monitor.error(SIM):
            raise ReplayFailed(f'{SIM}: {monitor.error(SIM)}')
        if monitor.time > time_before:
            time_before, advanced_at = monitor.time, time.monotonic()
        elif time.monotonic() - advanced_at > stall_timeout:
            raise ReplayFailed(f'simulated time has stood still for {stall_timeout:g} s at '
                               f'{time_before:g} s')
        if monitor.end is not None:
            until = min(monitor.end.time, scenario.time_limit) + SETTLE_TIME


def _clear(bag: Path) -> None:
    """Remove a former recording, be it one that was interrupted, and nothing else."""
    if bag.is_dir() and _is_recording({entry.name for entry in bag.iterdir()}, bag):
        shutil.rmtree(bag)
    elif bag.exists():
        raise ReplayFailed(f'{bag}: got something that is no recording, expected a recording '
                           'that may be overwritten, or nothing')


def _is_recording(names: set[str], bag: Path) -> bool:
    # One that was killed has no index; one that was interrupted at its start has no file.
    return 'metadata.yaml' in names or names <= {f'{bag.name}.mcap'}
