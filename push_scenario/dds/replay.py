"""Replay a scenario over DDS: three nodes in three processes, and this one that looks on."""

import contextlib
from pathlib import Path
import shutil
import time

from push_ros.node_settings import Frames
from push_ros.topics import CONTROLLER, PLANNER, SIM
from push_scenario.dds.parameter_files import write_parameter_files
from push_scenario.dds.processes import NodeProcesses, private_domain
from push_scenario.dds.recorder import BagWriter
from push_scenario.dds.replay_client import ReplayClient, ReplayFailed
from push_scenario.dds.result import DdsResult, push_result, task_result
from push_scenario.dds.run_monitor import RunMonitor, TaskWatcher
from push_scenario.simulation.loop import control_settings, SETTLE_TIME

MODULES = {SIM: 'push_sim_node.sim_node', PLANNER: 'push_planner.planner_node',
           CONTROLLER: 'push_control.controller_node'}
START_TIMEOUT, PLAN_TIMEOUT, SERVICE_TIMEOUT, STALL_TIMEOUT = 90.0, 60.0, 10.0, 15.0


def run_over_dds(scenario, control_law=None, out_dir='out', real_time=False, record=True,
                 progress=None, stamped=True, on_start=None):
    """
    Replay a scenario: in lockstep equal scenarios give equal tapes, to the last bit.

    :param scenario: the ``Scenario``.
    :param control_law: ``feedback`` or ``open_loop``; None for what the scenario says.
    :param out_dir: where the recording, and the nodes' parameters and output go.
    :param real_time: keep to the wall clock instead of going in lockstep.
    :param record: write a rosbag2 MCAP recording.
    :param progress: called with a ``closed_loop.Progress``; None for nobody.
    :param stamped: whether commands are ``TwistStamped``, else ``Twist``.
    :param on_start: called with the ``NodeProcesses`` when time begins to run; None for nobody.
    :return: the ``DdsResult``, or the ``DdsTaskResult`` of a task.
    :raises RuntimeError: where a node dies or hangs, naming it; no process is left in any case.
    """
    settings = control_settings(scenario, control_law)
    law = settings.control_law
    folder = Path(out_dir) / f'{scenario.name}_{law}_nodes'
    folder.mkdir(parents=True, exist_ok=True)
    tape_path = folder / 'tape.csv'
    for stale in (tape_path, tape_path.with_suffix('.json')):
        stale.unlink(missing_ok=True)
    files = write_parameter_files(folder, scenario, settings, tape_path, real_time, stamped)
    watcher = (RunMonitor(scenario.goal.pose, progress) if scenario.task is None else
               TaskWatcher(scenario.task, scenario.final_goal, progress))
    bag = Path(out_dir) / f'{scenario.name}_{law}_bag' if record else None
    refusal = _carry_out(scenario, files, watcher, folder, bag, stamped, on_start)
    if refusal:
        return DdsResult(scenario, law, 'refused', refusal, bag=bag)
    make = push_result if scenario.task is None else task_result
    return make(scenario, law, watcher, tape_path, bag)


def _carry_out(scenario, files, watcher, folder, bag, stamped, on_start):
    """Run the nodes until all is over; return why the goal was refused, if it was."""
    with contextlib.ExitStack() as stack:
        nodes = stack.enter_context(NodeProcesses(stack.enter_context(private_domain()), folder))
        session = ReplayClient(nodes.domain, stamped, watcher.note, nodes.check)
        stack.callback(session.close)
        if bag is not None:
            _replace(bag)
            writer = BagWriter(bag, session.types)
            stack.callback(writer.close)
            watcher.write = writer.write
        for node, path in files.items():
            nodes.start(node, MODULES[node], path)
        refusal = (_plan if scenario.task is None else _set)(scenario, session, watcher)
        if not refusal:
            _push(scenario, session, watcher, on_start and (lambda: on_start(nodes)))
        nodes.stop_all()
        session.drain()
    return refusal


def _plan(scenario, session, watcher):
    """Return why there is no plan; an empty text where there is one."""
    _wait_for_nodes(session, watcher)
    session.send_goal(scenario.goal.pose, Frames().world_frame)
    session.wait_for(lambda: watcher.plan or watcher.errors.get(PLANNER), PLAN_TIMEOUT, 'a plan')
    return '' if watcher.plan else watcher.errors[PLANNER]


def _set(scenario, session, watcher):
    """Set the task, whatever comes of it."""
    _wait_for_nodes(session, watcher)
    task, frame = scenario.task, Frames().world_frame
    if task.occupancy_map is not None:
        session.send_map(task.occupancy_map, frame)
        session.wait_for(lambda: watcher.maps == {PLANNER, CONTROLLER}, SERVICE_TIMEOUT,
                         'the nodes to take the map')
    # The first goal last: whoever has it has the others too.
    for later in task.goals:
        session.send_goal(later.goal.pose, frame, later.time)
    session.send_goal(scenario.goal.pose, frame)
    return ''


def _wait_for_nodes(session, watcher):
    session.wait_for(lambda: session.is_connected() and watcher.heard == set(MODULES),
                     START_TIMEOUT, 'the nodes to start')


def _push(scenario, session, watcher, on_start):
    session.call('controller/start', SERVICE_TIMEOUT)
    session.call('sim/start', SERVICE_TIMEOUT)
    if on_start:
        on_start()
    moved = time.monotonic()
    before, patience = watcher.time, STALL_TIMEOUT if scenario.task is None else PLAN_TIMEOUT
    until = scenario.time_limit + SETTLE_TIME
    # The clock may tell a time before the tape has its row.
    while watcher.time <= until:
        session.pump()
        if watcher.errors.get(SIM):
            raise ReplayFailed(f'{SIM}: {watcher.errors[SIM]}')
        if watcher.time > before:
            before, moved = watcher.time, time.monotonic()
        elif time.monotonic() - moved > patience:
            raise ReplayFailed(f'simulated time has stood still for {patience:g} s at '
                               f'{before:g} s')
        if watcher.end_time is not None:
            until = min(watcher.end_time, scenario.time_limit) + SETTLE_TIME


def _replace(bag):
    if (bag / 'metadata.yaml').is_file() or (bag.is_dir() and not any(bag.iterdir())):
        shutil.rmtree(bag)
    elif bag.exists():
        raise ReplayFailed(f'{bag}: got something that is no recording, expected a recording '
                           'that may be overwritten, or nothing')
