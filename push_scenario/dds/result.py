"""Result of a run over DDS, from what the nodes reported and the simulator's tape."""

import json
import math
from pathlib import Path

import numpy as np
from push_scenario.dds.run_monitor import RunEnd, RunMonitor
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.history import single_push_history
from push_scenario.simulation.loop import REST_SPEED, REST_YAW_RATE, SETTLE_TIME
from push_scenario.simulation.result import Outcome, RunResult, WallClockTiming
from push_sim_node.tape import read_tape, Tape


def collect_result(scenario: Scenario, control_law: str, monitor: RunMonitor, tape_path: Path,
                   bag: Path | None) -> RunResult:
    """
    Make the result of a run, once the nodes have ended.

    :param control_law: the control law.
    :param tape_path: where the simulator has written its tape.
    :param bag: folder of the recording, or None.
    """
    end = monitor.end
    if end is None or end.time > scenario.time_limit:
        limit = scenario.time_limit
        end = RunEnd(Outcome.TIME_LIMIT, f'not done after {limit:g} s', limit)
    tape, timing = _until_rest(read_tape(tape_path), end.time), _read_timing(tape_path)
    if scenario.task is None:
        return RunResult(scenario, control_law, end.outcome, end.reason, tape, end.time,
                         single_push_history(*end), plan=monitor.plan, timing=timing, bag=bag,
                         codes=end.codes)
    task = monitor.task
    return RunResult(scenario, control_law, end.outcome, end.reason, tape, end.time,
                     task.history.changes, task.history.recoveries, task.status,
                     timing=timing, bag=bag, codes=end.codes)


def _read_timing(tape_path: Path) -> WallClockTiming:
    timing = json.loads(tape_path.with_suffix('.json').read_text(encoding='utf-8'))
    latencies = timing['latencies'] or [math.nan]
    return WallClockTiming(float(np.median(latencies)), float(np.quantile(latencies, 0.99)),
                           timing['simulated_time'] / timing['wall_time'])


def _until_rest(tape: Tape, end: float) -> Tape:
    """Cut the tape off where both bodies rest: the rest depends on when the nodes stopped."""
    at_rest = np.ones(len(tape), bool)
    for body in ('object', 'robot'):
        speed = np.hypot(tape[f'{body}_v_x'], tape[f'{body}_v_y'])
        at_rest &= (speed < REST_SPEED) & (np.abs(tape[f'{body}_omega']) < REST_YAW_RATE)
    first = int(np.searchsorted(tape['time'], end, side='right')) + 1
    last = int(np.searchsorted(tape['time'], end + SETTLE_TIME, side='right'))
    rest_rows = np.flatnonzero(at_rest[first:last])
    if len(rest_rows):
        last = first + int(rest_rows[0]) + 1
    return Tape(tape.columns, tape.rows[:last])
