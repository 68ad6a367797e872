"""
Campaign of faults: each word for each input, at random moments of tasks and of a single push.

Measurements and commands are spoilt between the simulation and the robot in one process: past the
conversion of messages, the nodes run the same code on them. Goals, maps, plans and stamps are
spoilt on their way to the controller's node, over DDS in lockstep. Processes are struck while the
simulated time of all three nodes goes as fast as the clock of the wall; and in lockstep they do
many tasks in a row.
"""

import argparse
from collections.abc import Sequence
from concurrent import futures
import math
import multiprocessing
from pathlib import Path
import time
from typing import NamedTuple

from benchmarks.faults.injection import (
    Fault, IN_PROCESS, Injection, Input, SIMULATED, Word, words_of,
)
from benchmarks.faults.node_rig import final_report, Report, run_node
from benchmarks.faults.process_rig import (
    append_process_row, process_faults, process_rig, read_process_rows,
)
from benchmarks.faults.random_faults import draw_case, run_many, run_random, summary
from benchmarks.faults.report import Findings, stop_table, table, write_report
from benchmarks.faults.row import append_row, Ending, read_rows, Row
from benchmarks.faults.simulated import map_of, Record, Simulated, simulated_record
from benchmarks.faults.soak import read_tasks, run_soak, soak_table
from benchmarks.faults.surroundings import (
    read_surroundings, run_surroundings, surroundings_table,
)
from benchmarks.faults.verdict import evaluate
import numpy as np
from push_scenario.definition.loader import load_scenario
from push_scenario.parallel import available_cores

REPORT = Path(__file__).parents[2] / 'docs' / 'reports' / 'faults.md'
FOLDER = Path('out') / 'faults'
ROWS, PROCESS_ROWS, SOAK_TASKS = 'runs.jsonl', 'processes.jsonl', 'soak.jsonl'
SURROUNDINGS, RANDOM_ROWS = 'surroundings.jsonl', 'random.jsonl'
# Moments at which faults begin, at random between these [s]: in all states of a task or of a push.
MOMENTS = {'task_tap': (0.2, 3.5), 'task_demo': (1.0, 21.0), 'task_map': (1.0, 36.0),
           'curved_push': (1.0, 14.0)}
# Scenario of a robot with a lidar that is lifted, and when [s].
LIDAR_SCENARIO, LIDAR_MOMENTS = 'task_lidar', (1.0, 40.0)
SCENARIOS = *MOMENTS, LIDAR_SCENARIO
# Faults of plans begin at first or second one [s].
LATEST_PLAN = 1.5
# Exit status of a program that Ctrl-C has ended, as shells have it.
INTERRUPTED = 130
# The scenario of faults that are done to the controller's node.
NODE_SCENARIO = 'task_tap'
# How long a fault lasts [s]: for a while, after which the input is ok again, or to the end.
DURATIONS = 2.0, math.inf
# Simulated time after the fault in which a run has to end [s]; chosen: longer than all time limits
# of the supervisor, and than some dozens of attempts.
TIME_AFTER = 300.0
# The same where the controller's node is over DDS; chosen: some attempts, and time-outs of plans.
NODE_TIME_AFTER = 60.0


class Case(NamedTuple):
    """A run of the campaign: a scenario, and the fault that is done to it."""

    scenario: str
    fault: Fault


def draw(scenarios: Sequence[str], seed: int, count: int) -> list[Case]:
    """
    Draw faults: ``count`` for every scenario, input, word and duration.

    A robot that is lifted is elsewhere for good. That is all that happens to one with a lidar,
    which finds it.

    :param scenarios: names, of ``SCENARIOS``.
    :param seed: of the moments.
    :param count: of moments.
    """
    rng = np.random.default_rng(seed)
    without_lidar = [scenario for scenario in scenarios if scenario != LIDAR_SCENARIO]
    inputs = [*((scenario, kind) for scenario in without_lidar for kind in SIMULATED),
              *((NODE_SCENARIO, kind) for kind in Input
                if kind not in IN_PROCESS and NODE_SCENARIO in scenarios),
              *((scenario, Input.BASE) for scenario in without_lidar)]
    cases = [Case(scenario, Fault(kind, word, start, start + duration))
             for scenario, kind in inputs for word in words_of(kind) for duration in DURATIONS
             for start in _moments(scenario, kind, word, rng, count)]
    with_lidar = [Case(LIDAR_SCENARIO, Fault(Input.ODOMETRY, Word.LIFTED, start, math.inf))
                  for start in rng.uniform(*LIDAR_MOMENTS, count).round(2).tolist()
                  if LIDAR_SCENARIO in scenarios]
    return [case for case in [*cases, *with_lidar] if not (
        case.fault.is_temporary and case.fault.word is Word.LIFTED)]


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
    if case.fault.input not in IN_PROCESS:
        return _run_node(case, time_after)
    fault = case.fault
    until = fault.end if fault.is_temporary else fault.start
    scenario = load_scenario(case.scenario)
    injection = Injection(fault, occupancy_map=map_of(scenario))
    simulated = simulated_record(scenario, [injection], until + time_after)
    return _evaluate(case, simulated)


def _run_node(case: Case, time_after: float) -> Row:
    """Do a task with the controller's node."""
    scenario, fault = load_scenario(case.scenario), case.fault
    until = fault.end if fault.is_temporary else fault.start
    done = run_node(scenario, fault, until + min(time_after, NODE_TIME_AFTER))
    ending = done.ending
    reason = Report('') if ending is Ending.DONE else final_report(done.reports)
    record = Record(scenario, done.simulation.tape, done.plans, done.sent, done.end_time)
    return _evaluate(case, Simulated(record, ending, reason.text, reason.codes))


def _evaluate(case: Case, simulated: Simulated) -> Row:
    """Evaluate a run."""
    verdict = evaluate(case.fault, simulated)
    return Row(case.scenario, case.fault, simulated.ending, simulated.reason, simulated.codes,
               tuple(violation.name for violation in verdict.violations),
               *verdict.stop, verdict.deviation)


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the campaign and write the report.

    :param arguments: command line; None for that of the process.
    :return: exit status: 1 where a run has not ended as it should, or a task of the soak undone.
    """
    options = _parser().parse_args(arguments)
    try:
        return _run(options)
    except KeyboardInterrupt:
        print('\ninterrupted; what was measured is kept: --resume goes on')
        return INTERRUPTED


def _run(options: argparse.Namespace) -> int:
    if options.run is not None or options.random:
        return _run_random(options)
    if options.only_surroundings is not None:
        path = options.folder / SURROUNDINGS
        path.unlink(missing_ok=True)
        run_surroundings(path, options.only_surroundings)
        surroundings = read_surroundings(path)
        print(surroundings_table(surroundings))
        return int(any(not row.is_ok for row in surroundings))
    if not options.resume:
        for name in (SOAK_TASKS,) if options.only_soak else (
                ROWS, PROCESS_ROWS, SURROUNDINGS, SOAK_TASKS):
            (options.folder / name).unlink(missing_ok=True)
    scenarios = options.scenario or SCENARIOS
    if options.only:
        cases = [case for case in draw(scenarios, options.seed, options.count)
                 if f'{case.fault.input.value} {case.fault.word.value}'.startswith(options.only)]
        _run_cases(cases, options.folder / ROWS, options.jobs)
        rows = read_rows(options.folder / ROWS)
        print('\n\n'.join([stop_table(rows), table(rows)]))
        return int(any(not row.is_ok for row in rows))
    if not options.only_soak:
        _run_cases(draw(scenarios, options.seed, options.count), options.folder / ROWS,
                   options.jobs)
        _run_process_faults(options.folder / PROCESS_ROWS)
        run_surroundings(options.folder / SURROUNDINGS)
    run_soak(options.soak, options.folder / SOAK_TASKS, options.seed)
    soak = read_tasks(options.folder / SOAK_TASKS)
    if options.only_soak:
        print(soak_table(soak))
        return int(not all(task.is_done for task in soak))
    chosen = ' '.join([f'--count {options.count} --seed {options.seed} --soak {options.soak}',
                       *(f'--scenario {name}' for name in options.scenario or ())])
    drawn = set(draw(scenarios, options.seed, options.count))
    rows = [row for row in read_rows(options.folder / ROWS)
            if Case(row.scenario, row.fault) in drawn]
    processes = read_process_rows(options.folder / PROCESS_ROWS)
    surroundings = read_surroundings(options.folder / SURROUNDINGS)
    write_report(options.report, Findings(rows, processes, surroundings, soak), chosen)
    return int(any(not row.is_ok for row in [*rows, *processes, *surroundings])
               or not all(task.is_done for task in soak))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--count', type=int, default=1,
                        help='moments per case; another seed draws others')
    parser.add_argument('--scenario', action='append', choices=SCENARIOS,
                        help='again for more; all by default')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--soak', type=int, default=100, help='tasks in a row in one set of nodes')
    parser.add_argument('--only-soak', action='store_true', help='leave out the rest')
    parser.add_argument('--only', default='', metavar='FAULT',
                        help='faults that begin so, as "command" or "pose stuck": print what '
                        'they do, and write no report')
    parser.add_argument('--only-surroundings', nargs='?', const='', metavar='CASE',
                        help='files, clocks and strangers alone, or those that begin so')
    parser.add_argument('--random', type=int, default=0, metavar='COUNT',
                        help='runs with random faults in random scenarios, in place of the rest')
    parser.add_argument('--run', type=int, metavar='NUMBER',
                        help='of those runs only this one, again')
    parser.add_argument('--jobs', type=int, default=available_cores(),
                        help='processes that run side by side, where no time on the wall counts')
    parser.add_argument('--folder', type=Path, default=FOLDER, help='for what was found so far')
    parser.add_argument('--resume', action='store_true',
                        help='go on where a campaign was ended, instead of beginning anew')
    parser.add_argument('--report', type=Path, default=REPORT)
    return parser


def _run_random(options: argparse.Namespace) -> int:
    """Do runs with random faults, or one of them again."""
    if options.run is not None:
        row = run_random(draw_case(options.seed, options.run))
        print(row)
        return int(not row.is_ok)
    path = options.folder / RANDOM_ROWS
    if not options.resume:
        path.unlink(missing_ok=True)
    rows = run_many(options.seed, options.random, path, options.jobs)
    print(summary(rows))
    return int(not all(row.is_ok for row in rows))


def _run_cases(cases: Sequence[Case], path: Path, jobs: int) -> None:
    """Run the cases that are not in a file yet."""
    known = {Case(row.scenario, row.fault) for row in read_rows(path)}
    remaining = [case for case in cases if case not in known]
    progress = _Progress(len(remaining))
    with futures.ProcessPoolExecutor(jobs, multiprocessing.get_context('spawn')) as pool:
        for done in futures.as_completed([pool.submit(run, case) for case in remaining]):
            row = done.result()
            append_row(path, row)
            progress.show(row)


def _run_process_faults(path: Path) -> None:
    """Likewise; one after the other, as time on the wall counts."""
    known = {row.fault for row in read_process_rows(path)}
    remaining = [fault for fault in process_faults() if fault not in known]
    if not remaining:
        return
    progress = _Progress(len(remaining))
    with process_rig() as rig:
        for fault in remaining:
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
        remaining_time = (time.monotonic() - self._began) * (self._count / self._done - 1.0)
        minutes = remaining_time / 60.0
        print(f'{self._done} of {self._count}, {minutes:.0f} min left: {row}', flush=True)
