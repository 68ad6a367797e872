"""
Campaign of faults: each word for each input, at random moments of tasks and of a single push.

Measurements and commands are spoilt between the simulation and the robot in one process: past the
conversion of messages, the nodes run the same code on them. Goals, maps, plans and stamps are
spoilt on their way to the controller's node, over DDS in lockstep. Processes are struck while all
three nodes run on the clock of the wall; and in lockstep they do many tasks in a row.
"""

import argparse
from collections.abc import Sequence
from concurrent import futures
import dataclasses
import math
import multiprocessing
from pathlib import Path
import time
from typing import NamedTuple

from benchmarks.faults.effect import effect_time
from benchmarks.faults.injection import (
    Fault, Injection, Input, OFFSET, OTHER_OBJECT, SentCommand, SIMULATED, Word, words_of,
)
from benchmarks.faults.node_rig import final_reason, run_node
from benchmarks.faults.process_rig import (
    append_process_row, process_faults, process_rig, read_process_rows,
)
from benchmarks.faults.report import Findings, stop_table, table, write_report
from benchmarks.faults.row import append_row, Ending, read_rows, Row
from benchmarks.faults.soak import read_tasks, run_soak, soak_table, write_tasks
import numpy as np
from push_control.push.controller import Controller
from push_control.task.supervisor import Supervisor
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.signals import STOP
from push_model.trajectory import PushTrajectory
from push_scenario.batch.workers import available_cores
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.scenario import Scenario
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from push_sim_node.simulation import Simulation
from push_sim_node.tape import Tape

REPORT = Path(__file__).parents[2] / 'docs' / 'control' / 'faults.md'
FOLDER = Path('out') / 'faults'
ROWS, PROCESS_ROWS, SOAK_TASKS = 'runs.jsonl', 'processes.jsonl', 'soak.json'
# Moments at which faults begin, at random between these [s]: in all states of a task or of a push.
MOMENTS = {'task_tap': (0.2, 3.5), 'task_demo': (1.0, 21.0), 'curved_push': (1.0, 14.0)}
# Faults of plans begin at first or second one [s].
LATEST_PLAN = 1.5
# The scenario of faults that are done to the controller's node.
NODE_SCENARIO = 'task_tap'
# How long a fault lasts [s]: for a while, after which the input is ok again, or to the end.
DURATIONS = 2.0, math.inf
# Simulated time after the fault in which a run has to end [s]; chosen: longer than all time limits
# of the supervisor, and than some dozens of attempts.
TIME_AFTER = 300.0
# The same where the controller's node is over DDS; chosen: some attempts, and time-outs of plans.
NODE_TIME_AFTER = 60.0
# Planning time of tasks [s]; chosen: the usual one with primitives.
PLANNING_TIME = 0.1
# What counts as where the controller says that the object is, over its tolerances; chosen: a
# measured pose errs, too.
TRUE_RATIO = 1.5
# Commands at the end of a run that must be zero [s]; chosen.
FINAL_TIME = 1.0
# Time after a fault of commands in which the object counts as displaced by it [s]; chosen.
DISPLACING_TIME = 1.0
# Distance of the object from everything that was planned for it up to which a fault has not
# displaced it [m]; chosen: twice what single pushes deviate by without a fault.
MAX_DEVIATION = 0.2


class Case(NamedTuple):
    """A run of the campaign: a scenario, and the fault that is done to it."""

    scenario: str
    fault: Fault


class _Record(NamedTuple):
    """What happened in a run: tape, plans, and commands as they were sent."""

    scenario: Scenario
    tape: Tape
    plans: Sequence[PushTrajectory]
    sent: Sequence[SentCommand]


def draw(scenarios: Sequence[str], seed: int, count: int) -> list[Case]:
    """
    Draw faults: ``count`` for every scenario, input, word and duration.

    :param scenarios: names, of ``MOMENTS``.
    :param seed: of the moments.
    :param count: of moments.
    """
    rng = np.random.default_rng(seed)
    inputs = [*((scenario, kind) for scenario in scenarios for kind in SIMULATED),
              *((NODE_SCENARIO, kind) for kind in Input
                if kind not in SIMULATED and NODE_SCENARIO in scenarios)]
    return [Case(scenario, Fault(kind, word, start, start + duration))
            for scenario, kind in inputs for word in words_of(kind) for duration in DURATIONS
            for start in _moments(scenario, kind, word, rng, count)]


def _moments(scenario: str, kind: Input, word: Word, rng: np.random.Generator,
             count: int) -> list[float]:
    """Draw moments [s]; a goal or a map that does not come is missing from the beginning."""
    if word is Word.OFF and kind in (Input.GOAL, Input.MAP):
        return [0.0] * count
    latest = LATEST_PLAN if kind is Input.PLAN else MOMENTS[scenario][1]
    return rng.uniform(MOMENTS[scenario][0], latest, count).round(2).tolist()


def run(case: Case, time_after: float = TIME_AFTER) -> Row:
    """
    Simulate a scenario with a fault.

    :param case: the ``Case``.
    :param time_after: simulated time after the fault in which the run has to end [s].
    """
    if case.fault.input not in SIMULATED:
        return _run_node(case, time_after)
    scenario, fault = load_scenario(case.scenario), case.fault
    until = fault.end if fault.is_temporary else fault.start
    injection, reasons = Injection(fault), ['']

    def intervene(simulation: Simulation, controller: Controller | Supervisor) -> None:
        injection(simulation, controller)
        reasons[0] = controller.status.reason
    result = simulate(dataclasses.replace(scenario, time_limit=until + time_after),
                      intervene=intervene, planning_time=PLANNING_TIME)
    has_ended = result.outcome is not Outcome.TIME_LIMIT
    ending = Ending(result.outcome.value) if has_ended else Ending.WAITS
    reason = result.reason if has_ended else reasons[0]
    if result.tape is None:
        raise ValueError(f'{case.scenario}: {result.reason}')
    plans = [plan.trajectory for plan in result.sequence_plans]
    return _evaluate(case, ending, reason, _Record(
        scenario, result.tape, plans if result.plan is None else [result.plan], injection.sent))


def _run_node(case: Case, time_after: float) -> Row:
    """Do a task with the controller's node."""
    scenario, fault = load_scenario(case.scenario), case.fault
    until = fault.end if fault.is_temporary else fault.start
    done = run_node(scenario, fault, until + min(time_after, NODE_TIME_AFTER))
    last = done.reports[-1].text
    ending = next((ending for ending in (Ending.DONE, Ending.FAILED)
                   if last.startswith(f'task: {ending.value}')), Ending.WAITS)
    reason = '' if ending is Ending.DONE else final_reason(done.reports)
    return _evaluate(case, ending, reason, _Record(scenario, done.simulation.tape, done.plans,
                                                   done.sent))


def _evaluate(case: Case, ending: Ending, reason: str, record: _Record) -> Row:
    """Judge a run."""
    fault = case.fault
    start = fault.start
    if fault.input is Input.COMMAND:
        start = effect_time(record.scenario.true_robot, fault, record.tape, record.sent)
    stop_time = _stop_time(record.sent, start, fault)
    deviation = _deviation(record, fault)
    is_explained = _is_truly_done(record, fault) if ending is Ending.DONE else bool(reason)
    if ending is Ending.WAITS and fault.input is not Input.GOAL:
        # A robot whose goal changes all the time drives to the newest one.
        final = [sent.twist for sent in record.sent
                 if sent.time > record.sent[-1].time - FINAL_TIME]
        is_explained = is_explained and all(twist == STOP for twist in final)
    if fault.input is not Input.COMMAND:
        is_explained = is_explained and deviation <= _deviation_limit(fault)
    return Row(case.scenario, fault, ending, reason, is_explained, stop_time - start,
               _driven(record.tape, start, stop_time), deviation)


def _deviation_limit(fault: Fault) -> float:
    """Limit the deviation [m]: a tracker that is off has what is planned beside the object."""
    if fault.input is not Input.POSE:
        return MAX_DEVIATION
    offset = {Word.WRONG: OFFSET, Word.OF_ANOTHER_OBJECT: OTHER_OBJECT}.get(fault.word)
    return MAX_DEVIATION + (0.0 if offset is None else math.hypot(offset.x, offset.y))


def _is_off(fault: Fault) -> bool:
    return fault.input is Input.POSE and fault.word is Word.WRONG


def _stop_time(commands: Sequence[SentCommand], start: float, fault: Fault) -> float:
    """Find when the robot first commands zero from a time on, during a fault; nan: never [s]."""
    return next((sent.time for sent in commands
                 if start <= sent.time < fault.end and sent.twist == STOP), math.nan)


def _is_truly_done(record: _Record, fault: Fault) -> bool:
    scenario = record.scenario
    settings = scenario.control if scenario.task is None else scenario.task.supervision
    object_pose, goal = Pose(*record.tape.poses('object')[-1]), scenario.goal.pose
    if _is_off(fault) and not fault.is_temporary:
        # What a tracker shows that is off for good is all that can be known.
        object_pose = Pose(object_pose.x + OFFSET.x, object_pose.y, object_pose.theta
                           + OFFSET.theta)
    return bool(
        distance(object_pose, goal) <= TRUE_RATIO * settings.position_tolerance
        and abs(wrap_angle(object_pose[2] - goal.theta)) <= (
            TRUE_RATIO * settings.heading_tolerance))


def _driven(tape: Tape, start: float, end: float) -> float:
    """Sum up what the robot drives between two times; nan where one is [m]."""
    times, poses = tape['time'], np.array(tape.poses('robot'))
    within = poses[(times >= start) & (times <= end)]
    return math.nan if math.isnan(end) else _length(within)


def _length(poses: FloatArray) -> float:
    return float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())


def _deviation(record: _Record, fault: Fault) -> float:
    """Find how far the object is from all that was planned for it, after a fault begins [m]."""
    poses = np.array(record.tape.poses('object'))[:, :2]
    planned = np.concatenate([poses[:1], *(plan.object_poses[:, :2] for plan in record.plans)])
    # What a fault of commands has done to the object is corrected on other paths.
    end = fault.end + DISPLACING_TIME if fault.input is Input.COMMAND else math.inf
    times = record.tape['time']
    after = poses[(times >= fault.start) & (times <= end)]
    gaps = [np.hypot(*(planned - place).T).min() for place in after[::5]]
    return float(max(gaps, default=0.0))


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the campaign and write the report.

    :param arguments: command line; None for that of the process.
    :return: exit status: 1 where a run has ended unexplained, or a task of the soak undone.
    """
    options = _parser().parse_args(arguments)
    if not options.resume:
        for name in (SOAK_TASKS,) if options.only_soak else (ROWS, PROCESS_ROWS, SOAK_TASKS):
            (options.folder / name).unlink(missing_ok=True)
    scenarios = options.scenario or list(MOMENTS)
    if options.only:
        cases = [case for case in draw(scenarios, options.seed, options.count)
                 if f'{case.fault.input.value} {case.fault.word.value}'.startswith(options.only)]
        _run_cases(cases, options.folder / ROWS, options.jobs)
        rows = read_rows(options.folder / ROWS)
        print('\n\n'.join([stop_table(rows), table(rows)]))
        return int(any(not row.is_explained for row in rows))
    if not options.only_soak:
        _run_cases(draw(scenarios, options.seed, options.count), options.folder / ROWS,
                   options.jobs)
        _run_process_faults(options.folder / PROCESS_ROWS)
    soak = read_tasks(options.folder / SOAK_TASKS)
    if len(soak) < options.soak:
        soak = run_soak(options.soak, options.seed)
        write_tasks(options.folder / SOAK_TASKS, soak)
    if options.only_soak:
        print(soak_table(soak))
        return int(not all(task.is_done for task in soak))
    chosen = ' '.join([f'--count {options.count} --seed {options.seed} --soak {options.soak}',
                       *(f'--scenario {name}' for name in options.scenario or ())])
    drawn = set(draw(scenarios, options.seed, options.count))
    rows = [row for row in read_rows(options.folder / ROWS)
            if Case(row.scenario, row.fault) in drawn]
    processes = read_process_rows(options.folder / PROCESS_ROWS)
    write_report(options.report, Findings(rows, processes, soak), chosen)
    return int(any(not row.is_explained for row in [*rows, *processes])
               or not all(task.is_done for task in soak))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--count', type=int, default=3, help='moments per case')
    parser.add_argument('--scenario', action='append', choices=list(MOMENTS),
                        help='again for more; all by default')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--soak', type=int, default=100, help='tasks in a row in one set of nodes')
    parser.add_argument('--only-soak', action='store_true', help='leave out the rest')
    parser.add_argument('--only', default='', metavar='FAULT',
                        help='faults that begin so, as "command" or "pose stuck": print what '
                        'they do, and write no report')
    parser.add_argument('--jobs', type=int, default=available_cores(),
                        help='processes that run side by side, where no time on the wall counts')
    parser.add_argument('--folder', type=Path, default=FOLDER, help='for what was found so far')
    parser.add_argument('--resume', action='store_true',
                        help='go on where a campaign was ended, instead of beginning anew')
    parser.add_argument('--report', type=Path, default=REPORT)
    return parser


def _run_cases(cases: Sequence[Case], path: Path, jobs: int) -> None:
    """Run the cases that are not in a file yet."""
    known = {Case(row.scenario, row.fault) for row in read_rows(path)}
    left = [case for case in cases if case not in known]
    progress = _Progress(len(left))
    with futures.ProcessPoolExecutor(jobs, multiprocessing.get_context('spawn')) as pool:
        for done in futures.as_completed([pool.submit(run, case) for case in left]):
            row = done.result()
            append_row(path, row)
            progress.show(row)


def _run_process_faults(path: Path) -> None:
    """Likewise; one after the other, as time on the wall counts."""
    known = {row.fault for row in read_process_rows(path)}
    left = [fault for fault in process_faults() if fault not in known]
    if not left:
        return
    progress = _Progress(len(left))
    with process_rig() as rig:
        for fault in left:
            row = rig.run(fault)
            append_process_row(path, row)
            progress.show(row)


class _Progress:
    """Prints what was found, and how long the rest will take."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._done = 0
        self._began = time.monotonic()

    def show(self, row: object) -> None:
        """Print a line."""
        self._done += 1
        left = (time.monotonic() - self._began) * (self._count / self._done - 1.0)
        print(f'{self._done} of {self._count}, {left / 60.0:.0f} min left: {row}', flush=True)
