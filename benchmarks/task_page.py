"""Page of the benchmark of tasks: its tables, and failures to be replayed in a browser."""

from collections import Counter
import dataclasses
import functools
from pathlib import Path
from typing import cast, Sequence

from benchmarks.controller.tables import Job, Pair, Record, TO_DEGREES
from benchmarks.tasks.cases import PARTS
from benchmarks.tasks.groups import faults_of, side_by_side
from benchmarks.tasks.report import methods_of
from benchmarks.tasks.run import disturbed, drawn
from benchmarks.tasks.tables import success_table
from push_control.push.controller import Controller
from push_control.task.supervisor import Supervisor
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import RunResult
from push_sim_node.simulation import Simulation
from push_view import BeliefRecorder, ReportTable, write_batch_report

# Failures that are simulated once more; chosen: some minutes on one core.
MAX_REPLAYS = 12
HEAD = ('task', 'method', 'what', 'position error [mm]', 'heading error [deg]', 'time [s]',
        'pushes')


def write_page(path: Path, jobs: Sequence[Job], records: Sequence[Record]) -> str:
    """
    Write the page.

    :param path: of the HTML file.
    :param jobs: dicts of ``part``, ``kind``, ``seed`` and ``method``.
    :param records: what ``benchmarks.tasks.run.run`` returned for them.
    :return: one line that says so.
    """
    pairs = list(zip(jobs, records))
    groups = side_by_side(pairs, PARTS, methods_of(pairs))
    failures = failure_lines(pairs)
    runs = [(line, job) for line, (job, record, _) in enumerate(failures, 1)
            if record['outcome'] != 'error']
    replays = {line: functools.partial(replay, job) for line, job in runs[:MAX_REPLAYS]}
    lines = [HEAD, *(_cells(job, record, fault) for job, record, fault in failures)]
    write_batch_report(
        [ReportTable('Success', markdown_lines(success_table(groups, with_part=True))),
         ReportTable(f'{len(failures)} faults in {len(pairs)} tasks', lines, replays)],
        path, 'benchmark of tasks')
    return f'written: {path}; failures to be replayed in it: {len(replays)}'


def failure_lines(pairs: Sequence[Pair]) -> list[tuple[Job, Record, str]]:
    """
    List what failed: first one of each class, then the others.

    :param pairs: (job, record) of all tasks.
    :return: (job, record, fault) of each failure.
    """
    seen: Counter[str] = Counter()
    found: list[tuple[int, tuple[Job, Record, str]]] = []
    for job, record in pairs:
        faults = faults_of(job, record)
        if faults:
            found.append((seen[faults[0]], (job, record, '; '.join(faults))))
            seen[faults[0]] += 1
    return [failure for _, failure in sorted(found, key=lambda item: item[0])]


def markdown_lines(text: str) -> list[list[str]]:
    """
    Split a Markdown table into its cells.

    :param text: as ``benchmarks.controller.tables.table`` writes it.
    """
    lines = [[cell.strip() for cell in line.strip('|').split(' | ')]
             for line in text.splitlines()]
    return [line for line in lines if set(line) != {'---'}]


def replay(job: Job) -> tuple[RunResult, BeliefRecorder]:
    """
    Simulate a task once more.

    :param job: dict of ``part``, ``kind``, ``seed`` and ``method``.
    :return: the ``RunResult``, and what the robot believed.
    """
    case = drawn(job)
    beliefs = BeliefRecorder(case.scenario.object)

    def intervene(simulation: Simulation, supervisor: Controller | Supervisor) -> None:
        if case.intervention is not None:
            case.intervention(simulation, cast(Supervisor, supervisor))
        beliefs(simulation, supervisor)

    result = simulate(case.scenario, intervene=intervene)
    return dataclasses.replace(result, scenario=disturbed(case)), beliefs


def _cells(job: Job, record: Record, fault: str) -> tuple[str, ...]:
    figures = ((1e3, 'position_error', '.1f'), (TO_DEGREES, 'heading_error', '.2f'),
               (1.0, 'duration', '.0f'), (1, 'pushes', 'd'))
    return (f'{job["part"]}, {job["kind"]}, seed {job["seed"]}', job['method'], fault,
            *(format(factor * record[name], form) if name in record else ''
              for factor, name, form in figures))
