"""
Random faults: one to three at a time, of any length, in any scenario and in random tasks.

A run is drawn from the seed of all and its own number alone, so that each can be repeated by
itself. Faults are those that are done between the simulation and the robot in one process.
"""

from collections.abc import Sequence
from concurrent import futures
import dataclasses
import math
import multiprocessing
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.faults.expectations import expectation_of
from benchmarks.faults.injection import Fault, Injection, Input, SIMULATED, Word, words_of
from benchmarks.faults.row import append_line, Ending, read_lines, violation_text
from benchmarks.faults.simulated import Record, simulated_record
from benchmarks.faults.verdict import ending_violations, offset_of, Violation
from benchmarks.tasks.cases import draw as draw_task, KINDS, OPEN
import numpy as np
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.scenario import Scenario
from tqdm import tqdm

# Scenarios in which nothing is driven, and one whose plans in a large map take longest.
OMITTED = 'unreachable_goal', 'task_flat', 'task_spinning_wheels'
# Part of the runs that are random tasks; chosen.
TASK_RATIO = 0.4
# Faults of a run, at most; their lengths, evenly in logarithms [s]; when they begin [s], before
# most scenarios end.
MAX_FAULTS = 3
SHORTEST, LONGEST = 0.1, 5.0
LATEST = 15.0
# Simulated time after the last fault in which a run has to end [s]; chosen: more than twice what
# the longest of 650 runs took, a task whose camera was at the limit of age at every other pose
# (24 pushes). Attempts without progress end a task sooner.
TIME_AFTER = 1000.0
# By how much farther the object may get from its goal than it was when the first fault began [m];
# chosen: tasks begin with pushes away from the goal, and pushes that go round take theirs so far.
MAX_RECESSION = 1.0
# Seeds of random tasks.
TASK_SEEDS = 1000


class RandomCase(NamedTuple):
    """
    A run.

    :param seed: of all runs.
    :param number: of this one, from 0.
    :param task: name of a scenario; of a random task its kind and seed, with a colon between.
    :param faults: each ``Fault``, in the order in which they begin.
    """

    seed: int
    number: int
    task: str
    faults: tuple[Fault, ...]

    @property
    def command(self) -> str:
        """Command line that repeats it."""
        return f'python -m benchmarks.faults --seed {self.seed} --run {self.number}'

    def __str__(self) -> str:
        """Write one line."""
        return f'{self.task}; ' + '; '.join(str(fault) for fault in self.faults)


class RandomRow(NamedTuple):
    """
    How a run ended.

    :param case: the ``RandomCase``.
    :param ending: the ``Ending``.
    :param reason: as reported, one sentence.
    :param violations: names of each ``Violation``; empty where the run ended as it should.
    :param recession: by how much farther the object got from its goal than it was when the first
        fault began [m].
    """

    case: RandomCase
    ending: Ending
    reason: str
    violations: tuple[str, ...]
    recession: float

    @property
    def is_ok(self) -> bool:
        """Whether the run ended as it should."""
        return not self.violations

    def __str__(self) -> str:
        """Write one line."""
        return (f'{self.case}: {self.ending.value}' + (f', {self.reason}' if self.reason else '')
                + f' (object up to {self.recession:.2f} m farther from its goal)'
                + violation_text(self.violations)
                + ('' if self.is_ok else f': {self.case.command}'))


def draw_case(seed: int, number: int) -> RandomCase:
    """
    Draw a run.

    :param seed: of all runs.
    :param number: of this one.
    """
    rng = np.random.default_rng([seed, number])
    names = [name for name in scenario_names() if name not in OMITTED]
    task = names[rng.integers(len(names))]
    if rng.uniform() < TASK_RATIO:
        kinds = KINDS[OPEN]
        task = f'{kinds[rng.integers(len(kinds))]}:{rng.integers(TASK_SEEDS)}'
    faults: list[Fault] = []
    for _ in range(rng.integers(1, MAX_FAULTS + 1)):
        kind = SIMULATED[rng.integers(len(SIMULATED))]
        words = words_of(kind)
        start = round(float(rng.uniform(0.1, LATEST)), 2)
        length = math.exp(rng.uniform(math.log(SHORTEST), math.log(LONGEST)))
        faults.append(Fault(kind, words[rng.integers(len(words))], start,
                            round(start + length, 2)))
    return RandomCase(seed, number, task, tuple(sorted(faults, key=lambda fault: fault.start)))


def run_random(case: RandomCase) -> RandomRow:
    """
    Simulate a run.

    :param case: the ``RandomCase``.
    """
    scenario = _scenario(case.task)
    injections = [Injection(fault, seed=case.number + i) for i, fault in enumerate(case.faults)]
    end = max(fault.end for fault in case.faults)
    simulated = simulated_record(scenario, injections, end + TIME_AFTER)
    recession = _recession(simulated.record, case.faults[0].start)
    reasons = frozenset[str]().union(*(expectation_of(fault).reasons for fault in case.faults))
    violations = ending_violations(simulated, reasons, None)
    if simulated.ending is not Ending.DONE and _counts_recession(scenario, case.faults):
        limit = MAX_RECESSION + max(map(offset_of, case.faults))
        violations += [Violation.OBJECT_MOVED] if recession > limit else []
    return RandomRow(case, simulated.ending, simulated.reason,
                     tuple(violation.name for violation in violations), recession)


def _scenario(task: str) -> Scenario:
    kind, _, seed = task.partition(':')
    scenario = draw_task(OPEN, kind, int(seed)).scenario if seed else load_scenario(task)
    return dataclasses.replace(scenario, name=task)


def _recession(record: Record, start: float) -> float:
    goal = record.scenario.final_goal
    poses = np.array(record.tape.poses('object'))[record.tape['time'] >= start]
    distances = np.hypot(poses[:, 0] - goal.x, poses[:, 1] - goal.y)
    return float(distances.max() - distances[0]) if len(distances) else 0.0


def _counts_recession(scenario: Scenario, faults: Sequence[Fault]) -> bool:
    """Whether nobody else moves the object, and the base does what it is commanded to do."""
    return (not scenario.simulation.object_displacements
            and all(fault.input is not Input.COMMAND for fault in faults))


def run_many(seed: int, count: int, path: Path, jobs: int) -> list[RandomRow]:
    """
    Simulate the runs that are not in a file yet, and print those that are not as expected.

    What was done before an interruption is kept.

    :param seed: of all runs.
    :param count: of runs.
    :param path: of the file.
    :param jobs: processes that run side by side.
    :return: ``RandomRow`` of all runs, in order.
    """
    cases = [draw_case(seed, number) for number in range(count)]
    known = {row.case: row for row in read_random_rows(path)}
    remaining = [case for case in cases if case not in known]
    pool = futures.ProcessPoolExecutor(jobs, multiprocessing.get_context('spawn'))
    try:
        for future in tqdm([pool.submit(run_random, case) for case in remaining],
                           'random faults'):
            row = future.result()
            append_random_row(path, row)
            known[row.case] = row
            if not row.is_ok:
                print(row, flush=True)
    finally:
        pool.shutdown(cancel_futures=True)
    return [known[case] for case in cases]


def summary(rows: Sequence[RandomRow]) -> str:
    """
    Count how runs ended.

    :param rows: each ``RandomRow``.
    """
    counts = {ending: sum(row.ending is ending for row in rows) for ending in Ending}
    failing = sum(not row.is_ok for row in rows)
    return (f'{len(rows)} runs with random faults: '
            + ', '.join(f'{count} {ending.value}' for ending, count in counts.items())
            + f'; {failing} not as they should')


def append_random_row(path: Path, row: RandomRow) -> None:
    """
    Add a run to a file.

    :param path: of the file, one run a line.
    :param row: the ``RandomRow``.
    """
    case = row.case
    append_line(path, {
        'seed': case.seed, 'number': case.number, 'task': case.task,
        'faults': [[fault.input.value, fault.word.value, fault.start, fault.end]
                   for fault in case.faults],
        'ending': row.ending.value, 'reason': row.reason, 'violations': row.violations,
        'recession': row.recession})


def read_random_rows(path: Path) -> list[RandomRow]:
    """
    Read the runs of a file.

    :param path: of the file; where it is not there, there are none.
    """
    return [_row(values) for values in read_lines(path)]


def _row(values: dict[str, Any]) -> RandomRow:
    faults = tuple(Fault(Input(kind), Word(word), start, end)
                   for kind, word, start, end in values['faults'])
    case = RandomCase(values['seed'], values['number'], values['task'], faults)
    return RandomRow(case, Ending(values['ending']), values['reason'], tuple(values['violations']),
                     values['recession'])
