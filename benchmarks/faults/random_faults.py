"""
Random faults: one to three at a time, of any length, in any scenario, random task or single push.

A run is drawn from the seed of all and its own number alone, so that each can be repeated by
itself. Faults are those that are done between the simulation and the robot in one process. Tasks
are on open floor, in maps, at walls and with bases that do not do what they are told.
"""

from collections.abc import Collection, Sequence
from concurrent import futures
import dataclasses
import math
import multiprocessing
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.controller.cases import KINDS as PUSH_KINDS, scenario as draw_push, STRESSES
from benchmarks.faults.expectations import expectation_of
from benchmarks.faults.injection import Fault, IN_PROCESS, Injection, Input, Word, words_of
from benchmarks.faults.row import append_line, Ending, read_lines, violation_text
from benchmarks.faults.simulated import map_of, Record, Simulated, simulated_record
from benchmarks.faults.verdict import ending_violations, offset_of, Violation
from benchmarks.tasks.bases import BAD_BASES
from benchmarks.tasks.cases import BASES, draw as draw_task, IN_MAPS, KINDS, OPEN, WALLS
from benchmarks.tasks.varieties import STRIDE
import numpy as np
from push_control.events import TaskEvent
from push_planner.problem import PlanningFailed
from push_scenario.definition.catalogue import scenario_names
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.scenario import Scenario
from tqdm import tqdm

# Scenarios in which nothing is driven, and one whose plans in a large map take longest.
OMITTED = 'unreachable_goal', 'task_flat', 'task_spinning_wheels'
# Where random tasks are, beside single pushes; each as often as a scenario of the catalogue.
SINGLE = 'single push'
CATALOGUE = 'catalogue'
SORTS = CATALOGUE, SINGLE, OPEN, IN_MAPS, WALLS, BASES
# Faults of a run, at most; their lengths, evenly in logarithms [s]; when they begin [s], before
# most scenarios and pushes, or most random tasks, end.
MAX_FAULTS = 3
SHORTEST, LONGEST = 0.1, 5.0
LATEST, LATEST_IN_TASK = 15.0, 45.0
# Simulated time after the last fault in which a run has to end [s]; chosen: more than twice what
# the longest of 650 runs took, a task whose camera was at the limit of age at every other pose
# (24 pushes). Attempts without progress end a task sooner.
TIME_AFTER = 1000.0
# By how much farther the object may get from its goal than it was when the first fault began [m];
# chosen: tasks begin with pushes away from the goal, and pushes that go round take theirs so far.
MAX_RECESSION = 1.0
# Codes that say only that a task is given up, and that another reason follows.
GIVEN_UP = frozenset(map(str, (
    TaskEvent.ABORTED, TaskEvent.ABORTED_AFTER, TaskEvent.ABORTED_INCONSISTENT)))
# Seeds of random tasks. With bases each task comes once with each base, in ``STRIDE`` seeds.
TASK_SEEDS = 1000


class RandomCase(NamedTuple):
    """
    A run.

    :param seed: of all runs.
    :param number: of this one, from 0.
    :param task: name of a scenario; of a random task its sort, kind and seed, with colons between.
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
    sort = SORTS[rng.integers(len(SORTS))]
    task = _draw_task_name(sort, rng)
    latest = LATEST if sort in (CATALOGUE, SINGLE) else LATEST_IN_TASK
    faults: list[Fault] = []
    for _ in range(rng.integers(1, MAX_FAULTS + 1)):
        kind = IN_PROCESS[rng.integers(len(IN_PROCESS))]
        words = words_of(kind)
        start = round(float(rng.uniform(0.1, latest)), 2)
        length = math.exp(rng.uniform(math.log(SHORTEST), math.log(LONGEST)))
        faults.append(Fault(kind, words[rng.integers(len(words))], start,
                            round(start + length, 2)))
    return RandomCase(seed, number, task, tuple(sorted(faults, key=lambda fault: fault.start)))


def _draw_task_name(sort: str, rng: np.random.Generator) -> str:
    if sort == CATALOGUE:
        names = [name for name in scenario_names() if name not in OMITTED]
        return names[rng.integers(len(names))]
    kinds = tuple(PUSH_KINDS) if sort == SINGLE else KINDS[sort]
    kind, seed = kinds[rng.integers(len(kinds))], int(rng.integers(TASK_SEEDS))
    if sort == BASES:
        seed = STRIDE * seed + int(rng.integers(len(BAD_BASES)))
    return f'{sort}:{kind}:{seed}'


def run_random(case: RandomCase) -> RandomRow:
    """
    Simulate a run.

    :param case: the ``RandomCase``.
    """
    scenario = _scenario(case.task)
    injections = [Injection(fault, case.number + i, map_of(scenario))
                  for i, fault in enumerate(case.faults)]
    end = max(fault.end for fault in case.faults)
    simulated = simulated_record(scenario, injections, end + TIME_AFTER)
    recession = _recession(simulated.record, case.faults[0].start)
    reasons = frozenset[str]().union(*(expectation_of(fault).reasons for fault in case.faults))
    violations = ending_violations(simulated, reasons, None)
    if Violation.WRONG_REASON in violations and _ends_so_anyway(scenario, simulated):
        violations.remove(Violation.WRONG_REASON)
    if simulated.ending is not Ending.DONE and _counts_recession(scenario, case.faults):
        limit = MAX_RECESSION + max(map(offset_of, case.faults))
        violations += [Violation.OBJECT_MOVED] if recession > limit else []
    return RandomRow(case, simulated.ending, simulated.reason,
                     tuple(violation.name for violation in violations), recession)


def _ends_so_anyway(scenario: Scenario, simulated: Simulated) -> bool:
    """Tell whether a task ends for one of the same reasons without any fault, too."""
    harmless = Injection(Fault(Input.COMMAND, Word.OFF, math.inf, math.inf))
    without = simulated_record(scenario, [harmless], TIME_AFTER)
    return without.ending is not Ending.DONE and share_reason(without.codes, simulated.codes)


def share_reason(codes: Collection[str], others: Collection[str]) -> bool:
    """
    Tell whether two runs end for one of the same reasons; that both are given up is none.

    :param codes: names of the codes of one.
    :param others: names of the codes of the other.
    """
    return not (set(codes) & set(others)) <= GIVEN_UP


def _scenario(task: str) -> Scenario:
    sort, _, drawn = task.partition(':')
    kind, _, seed = drawn.partition(':')
    if not drawn:
        scenario = load_scenario(task)
    elif sort == SINGLE:
        scenario = _single_push(kind, int(seed))
    else:
        scenario = draw_task(sort, kind, int(seed)).scenario
    return dataclasses.replace(scenario, name=task)


def _single_push(kind: str, seed: int) -> Scenario:
    """Draw a single push; from the next seed where no contact leads to the goal."""
    try:
        return draw_push(kind, seed, STRESSES[seed % len(STRESSES)])[0]
    except PlanningFailed:
        return _single_push(kind, seed + TASK_SEEDS)


def _recession(record: Record, start: float) -> float:
    goal = record.scenario.final_goal
    poses = np.array(record.tape.poses('object'))[record.tape['time'] >= start]
    distances = np.hypot(poses[:, 0] - goal.x, poses[:, 1] - goal.y)
    return float(distances.max() - distances[0]) if len(distances) else 0.0


def _counts_recession(scenario: Scenario, faults: Sequence[Fault]) -> bool:
    """Whether nobody else moves the object, and the base does what it is commanded to do."""
    return (not scenario.simulation.object_displacements
            and all(fault.input not in (Input.COMMAND, Input.BASE) for fault in faults))


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
