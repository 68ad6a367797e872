"""What came of a replay over DDS, and how fast it went on the wall."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
from push_scenario.simulation.loop import REST_SPEED, REST_YAW_RATE, SETTLE_TIME
from push_scenario.simulation.result import Result, TaskResult
from push_sim_node.tape import Tape


@dataclasses.dataclass(frozen=True, eq=False)
class OnTheWall:
    """
    How fast a run over DDS went.

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


@dataclasses.dataclass(frozen=True, eq=False)
class DdsResult(OnTheWall, Result):
    """A push over DDS."""


@dataclasses.dataclass(frozen=True, eq=False)
class DdsTaskResult(OnTheWall, TaskResult):
    """A task over DDS."""


def push_result(scenario, law, watcher, tape_path, bag):
    """
    Make the result of a push, once the nodes have ended.

    :param scenario: the ``Scenario``.
    :param law: the control law.
    :param watcher: the ``RunMonitor``.
    :param tape_path: where the simulator has written its tape.
    :param bag: folder of the recording, or None.
    :return: ``DdsResult``.
    """
    outcome, reason, end = _outcome(scenario, watcher)
    return DdsResult(
        scenario, law, outcome, reason, watcher.plan, _until_rest(Tape.load(tape_path), end), end,
        **_on_the_wall(tape_path, bag))


def task_result(scenario, law, watcher, tape_path, bag):
    """
    Make the result of a task, once the nodes have ended.

    :param scenario: the ``Scenario``.
    :param law: the control law.
    :param watcher: the ``TaskWatcher``.
    :param tape_path: where the simulator has written its tape.
    :param bag: folder of the recording, or None.
    :return: ``DdsTaskResult``.
    """
    outcome, reason, end = _outcome(scenario, watcher)
    return DdsTaskResult(
        scenario, law, outcome, reason, watcher.status, _until_rest(Tape.load(tape_path), end),
        end, watcher.history.changes, watcher.history.recoveries, single=watcher.single,
        **_on_the_wall(tape_path, bag))


def _outcome(scenario, watcher):
    if watcher.end_time is None or watcher.end_time > scenario.time_limit:
        limit = scenario.time_limit
        return 'time_limit', f'not done after {limit:g} s', limit
    return watcher.phase, watcher.reason, watcher.end_time


def _on_the_wall(tape_path, bag):
    timing = json.loads(tape_path.with_suffix('.json').read_text(encoding='utf-8'))
    latencies = timing['latencies'] or [math.nan]
    return {'latency_median': float(np.median(latencies)),
            'latency_p99': float(np.quantile(latencies, 0.99)),
            'speed_up': timing['simulated_time'] / timing['wall_time'], 'bag': bag}


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
