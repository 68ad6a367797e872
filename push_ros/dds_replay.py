"""Replay a scenario over DDS: three nodes in three processes, and this one that looks on."""

import contextlib
import dataclasses
import json
import math
from pathlib import Path
import shutil
import time

import numpy as np
from push_ros.domain import private_domain
from push_ros.interfaces import CONTROLLER, PLANNER, SIM
from push_ros.node_files import write_node_files
from push_ros.options import Frames
from push_ros.processes import NodeProcesses
from push_ros.recorder import BagWriter
from push_ros.session import ReplayFailed, Session
from push_ros.watcher import Watcher
from push_scenario.closed_loop import control_settings, REST_SPEED, REST_YAW_RATE, SETTLE_TIME
from push_scenario.result import Result
from push_scenario.tape import Tape

MODULES = {SIM: 'push_sim_node.sim_node', PLANNER: 'push_planner.planner_node',
           CONTROLLER: 'push_control.controller_node'}
START_TIMEOUT, PLAN_TIMEOUT, SERVICE_TIMEOUT, STALL_TIMEOUT = 90.0, 60.0, 10.0, 15.0


@dataclasses.dataclass(frozen=True, eq=False)
class DdsResult(Result):
    """
    A run over DDS: a ``Result``, and how fast it went on the wall.

    :param latency_median: from publishing an object pose to receiving the command that answers
        it, in the simulator's process [s]; nan where nothing moved.
    :param latency_p99: the same, exceeded by one in a hundred [s].
    :param speed_up: simulated over wall time.
    :param bag: folder of the recording; None without one.
    """

    latency_median: float = math.nan
    latency_p99: float = math.nan
    speed_up: float = math.nan
    bag: Path | None = None


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
    :return: the ``DdsResult``.
    :raises RuntimeError: where a node dies or hangs, naming it; no process is left in any case.
    """
    settings = control_settings(scenario, control_law)
    law = settings.control_law
    folder = Path(out_dir) / f'{scenario.name}_{law}_nodes'
    folder.mkdir(parents=True, exist_ok=True)
    tape_path = folder / 'tape.csv'
    for stale in (tape_path, tape_path.with_suffix('.json')):
        stale.unlink(missing_ok=True)
    files = write_node_files(folder, scenario, settings, tape_path, real_time, stamped)
    watcher = Watcher(scenario.goal.pose, progress)
    bag = Path(out_dir) / f'{scenario.name}_{law}_bag' if record else None
    refusal = _carry_out(scenario, files, watcher, folder, bag, stamped, on_start)
    if refusal:
        return DdsResult(scenario, law, 'refused', refusal, bag=bag)
    return _result(scenario, law, watcher, tape_path, bag)


def _carry_out(scenario, files, watcher, folder, bag, stamped, on_start):
    """Run the nodes until all is over; return why the goal was refused, if it was."""
    with contextlib.ExitStack() as stack:
        nodes = stack.enter_context(NodeProcesses(stack.enter_context(private_domain()), folder))
        session = Session(nodes.domain, stamped, watcher.note, nodes.check)
        stack.callback(session.close)
        if bag is not None:
            _replace(bag)
            writer = BagWriter(bag, session.types)
            stack.callback(writer.close)
            watcher.write = writer.write
        for node, path in files.items():
            nodes.start(node, MODULES[node], path)
        refusal = _plan(scenario, session, watcher)
        if not refusal:
            _push(scenario, session, watcher, on_start and (lambda: on_start(nodes)))
        nodes.stop_all()
        session.drain()
    return refusal


def _plan(scenario, session, watcher):
    """Return why there is no plan; an empty text where there is one."""
    session.wait_for(lambda: session.is_connected() and watcher.heard == set(MODULES),
                     START_TIMEOUT, 'the nodes to start')
    session.send_goal(scenario.goal.pose, Frames().world_frame)
    session.wait_for(lambda: watcher.plan or watcher.errors.get(PLANNER), PLAN_TIMEOUT, 'a plan')
    return '' if watcher.plan else watcher.errors[PLANNER]


def _push(scenario, session, watcher, on_start):
    session.call('controller/start', SERVICE_TIMEOUT)
    session.call('sim/start', SERVICE_TIMEOUT)
    if on_start:
        on_start()
    moved = time.monotonic()
    before = watcher.time
    until = scenario.time_limit + SETTLE_TIME
    # The clock may tell a time before the tape has its row.
    while watcher.time <= until:
        session.pump()
        if watcher.errors.get(SIM):
            raise ReplayFailed(f'{SIM}: {watcher.errors[SIM]}')
        if watcher.time > before:
            before, moved = watcher.time, time.monotonic()
        elif time.monotonic() - moved > STALL_TIMEOUT:
            raise ReplayFailed(f'simulated time has stood still for {STALL_TIMEOUT:g} s at '
                               f'{before:g} s')
        if watcher.end_time is not None:
            until = min(watcher.end_time, scenario.time_limit) + SETTLE_TIME


def _result(scenario, law, watcher, tape_path, bag):
    tape = Tape.load(tape_path)
    if watcher.end_time is None or watcher.end_time > scenario.time_limit:
        outcome, end = 'time_limit', scenario.time_limit
        reason = f'not done after {scenario.time_limit:g} s'
    else:
        outcome, reason, end = watcher.phase, watcher.reason, watcher.end_time
    timing = json.loads(tape_path.with_suffix('.json').read_text(encoding='utf-8'))
    latencies = timing['latencies'] or [math.nan]
    return DdsResult(scenario, law, outcome, reason, watcher.plan, _until_rest(tape, end), end,
                     float(np.median(latencies)), float(np.quantile(latencies, 0.99)),
                     timing['simulated_time'] / timing['wall_time'], bag)


def _until_rest(tape, end):
    """Cut off what depends on when the nodes were stopped."""
    at_rest = np.ones(len(tape), bool)
    for body in ('object', 'robot'):
        speed = np.hypot(tape[f'{body}_v_x'], tape[f'{body}_v_y'])
        at_rest &= (speed < REST_SPEED) & (np.abs(tape[f'{body}_omega']) < REST_YAW_RATE)
    first = int(np.searchsorted(tape['time'], end, side='right')) + 1
    last = int(np.searchsorted(tape['time'], end + SETTLE_TIME, side='right'))
    rest = np.flatnonzero(at_rest[first:last])
    return Tape(tape.columns, tape.rows[:first + rest[0] + 1 if len(rest) else last])


def _replace(bag):
    if (bag / 'metadata.yaml').is_file() or (bag.is_dir() and not any(bag.iterdir())):
        shutil.rmtree(bag)
    elif bag.exists():
        raise ReplayFailed(f'{bag}: got something that is no recording, expected a recording '
                           'that may be overwritten, or nothing')
