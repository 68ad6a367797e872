"""Report of the benchmark of tasks, from its template."""

from pathlib import Path
from typing import Sequence

from benchmarks.controller.tables import Job, Pair, Record
from benchmarks.report_template import fill_template
from benchmarks.tasks.aims import aim_table
from benchmarks.tasks.cases import DISTURBED, IN_MAPS, METHODS, OPEN, PARTS, STRICT, WHEELS
from benchmarks.tasks.groups import (
    Group, kind, side_by_side, variety, with_informed_times,
)
from benchmarks.tasks.tables import (
    collision_table, correction_table, effort_table, failure_table, recovery_table, state_table,
    success_table,
)

TEXT = Path(__file__).with_name('tasks.md.in')
NOT_MEASURED = 'Not measured in this run.'
# Variations of the tasks on open floor.
VARIED = tuple(part for part in PARTS if part not in (OPEN, IN_MAPS, DISTURBED))


def methods_of(pairs: Sequence[Pair]) -> list[str]:
    """
    List the methods that were measured.

    :param pairs: (job, record) of all tasks.
    """
    used = {job['method'] for job, _ in pairs}
    return [method for method in METHODS if method in used]


def text(jobs: Sequence[Job], records: Sequence[Record]) -> str:
    """
    Fill the template.

    :param jobs: dicts of ``part``, ``kind``, ``seed`` and ``method``.
    :param records: what ``benchmarks.tasks.run.run`` returned for them, those on open floor with
        what ``benchmarks.tasks.reference.refer`` returned.
    """
    pairs = with_informed_times(list(zip(jobs, records)))
    methods = methods_of(pairs)
    everything = side_by_side(pairs, PARTS, methods)
    kinds = side_by_side(pairs, (OPEN,), methods, kind)
    mapped = side_by_side(pairs, (IN_MAPS,), methods, variety)
    disturbed = (side_by_side(pairs, (DISTURBED,), methods, variety)
                 + side_by_side(pairs, (DISTURBED,), methods, _state_when_moved)[len(methods):])
    return fill_template(
        TEXT, COUNTS=_counts(everything), AIMS=aim_table(pairs, methods),
        OPEN=success_table(kinds) if kinds else NOT_MEASURED,
        EFFORT=effort_table(kinds) if kinds else NOT_MEASURED,
        CORRECTIONS=correction_table(kinds) if kinds else NOT_MEASURED,
        STATES=state_table(everything), VARIED=_varied(pairs, methods),
        MAPS=success_table(mapped) if mapped else NOT_MEASURED,
        CLEARANCES=collision_table(mapped) if mapped else NOT_MEASURED,
        DISTURBED=success_table(disturbed) if disturbed else NOT_MEASURED,
        FAILURES=failure_table(pairs), RECOVERIES=recovery_table(pairs, methods))


def _counts(groups: Sequence[Group]) -> str:
    return ', '.join({group.part: f'{len(group.tasks)} {group.part}' for group in groups}.values())


def _varied(pairs: Sequence[Pair], methods: Sequence[str]) -> str:
    groups = side_by_side(pairs, VARIED, methods)
    for part in (WHEELS, STRICT):
        groups += side_by_side(pairs, (part,), methods, variety)[len(methods):]
    return success_table(groups, with_part=True) if groups else NOT_MEASURED


def _state_when_moved(_: Job, record: Record) -> str:
    state = record.get('moved_in', '')
    return f'while it was in: {state}' if state else 'after the end'
