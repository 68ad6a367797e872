"""Report of the benchmark of tasks, from its template."""

from pathlib import Path
from typing import Sequence

from benchmarks.controller.tables import Job, Pair, Record
from benchmarks.report_template import fill_template, updated_page
from benchmarks.tasks.aims import aim_table
from benchmarks.tasks.base_tables import base_table, weight_table
from benchmarks.tasks.bases import LEARNED, treatment
from benchmarks.tasks.cases import (
    ANY_HEADING, BASE_PARTS, BASES, DISTURBED, EYES_PARTS, FAR_ROBOTS, IN_MAPS, LIDAR_PARTS, OPEN,
    OWN_EYES, PARTS, SPATIAL_BASES, SPATIAL_EYES, STRICT, WALLS, WHEELS,
)
from benchmarks.tasks.eyes_tables import eyes_table
from benchmarks.tasks.groups import (
    Group, grouped_parts, kind, variety, with_informed_times,
)
from benchmarks.tasks.public_table import public_tables
from benchmarks.tasks.tables import (
    collision_table, correction_table, effort_table, failure_table, recovery_table, state_table,
    success_table, wall_table,
)

TEXT = Path(__file__).with_name('tasks.md.in')
NOT_MEASURED = 'Not measured in this run.'
# What is made of several parts.
SUMS = 'COUNTS', 'AIMS', 'STATES', 'VARIED', 'FAILURES', 'RECOVERIES'
# Variations of the tasks on open floor.
VARIED = tuple(part for part in PARTS
               if part not in (OPEN, IN_MAPS, DISTURBED, WALLS, *LIDAR_PARTS, *BASE_PARTS,
                               *EYES_PARTS))


def text(jobs: Sequence[Job], records: Sequence[Record], page: str = '') -> str:
    """
    Fill the template.

    What sums parts up is replaced only where tasks on open floor are among them.

    :param jobs: keyword arguments of ``benchmarks.tasks.cases.draw``.
    :param records: what ``benchmarks.tasks.run.run`` returned for them, those on open floor with
        what ``benchmarks.tasks.reference.refer`` returned.
    :param page: the page until now, of which parts that are not measured are kept.
    """
    all_pairs = list(zip(jobs, records))
    pairs = with_informed_times([pair for pair in all_pairs if treatment(pair[0]) == LEARNED])
    everything = grouped_parts(pairs, PARTS)
    kinds = grouped_parts(pairs, (OPEN,), kind)
    mapped = grouped_parts(pairs, (IN_MAPS,), variety)
    disturbed = (grouped_parts(pairs, (DISTURBED,), variety)
                 + grouped_parts(pairs, (DISTURBED,), _state_when_moved)[1:])
    new = fill_template(
        TEXT, COUNTS=_counts(everything), AIMS=aim_table(pairs),
        OPEN=success_table(kinds) if kinds else NOT_MEASURED,
        EFFORT=effort_table(kinds) if kinds else NOT_MEASURED,
        CORRECTIONS=correction_table(kinds) if kinds else NOT_MEASURED,
        STATES=state_table(everything), VARIED=_varied(pairs),
        MAPS=success_table(mapped) if mapped else NOT_MEASURED,
        CLEARANCES=collision_table(mapped) if mapped else NOT_MEASURED,
        DISTURBED=success_table(disturbed) if disturbed else NOT_MEASURED,
        BASES=_bases(all_pairs, BASES), SPATIALBASES=_bases(all_pairs, SPATIAL_BASES),
        FARROBOTS=_far_robots(all_pairs), PUBLIC=public_tables(all_pairs) or NOT_MEASURED,
        WALLS=_at_walls(all_pairs),
        EYES=_eyes(all_pairs, OWN_EYES), SPATIALEYES=_eyes(all_pairs, SPATIAL_EYES),
        FAILURES=failure_table(pairs), RECOVERIES=recovery_table(pairs))
    return updated_page(TEXT, new, page, lambda name, value: (
        value == NOT_MEASURED or name in SUMS and not kinds))


def _counts(groups: Sequence[Group]) -> str:
    return ', '.join({group.part: f'{len(group.tasks)} {group.part}' for group in groups}.values())


def _bases(pairs: Sequence[Pair], part: str) -> str:
    if not any(job['part'] == part for job, _ in pairs):
        return NOT_MEASURED
    return f'{base_table(pairs, part)}\n\n{weight_table(pairs, part)}'


def _far_robots(pairs: Sequence[Pair]) -> str:
    groups = grouped_parts(pairs, (FAR_ROBOTS,), variety)[1:]
    if not groups:
        return NOT_MEASURED
    return f'{success_table(groups)}\n\n{collision_table(groups)}'


def _at_walls(pairs: Sequence[Pair]) -> str:
    stated, free = ([pair for pair in pairs if treatment(pair[0]) == base]
                    for base in (LEARNED, ANY_HEADING))
    groups = grouped_parts(stated, (WALLS,), variety) + grouped_parts(stated, (WALLS,), kind)[1:]
    if not groups:
        return NOT_MEASURED
    groups += [group._replace(name=f'{group.name}, {ANY_HEADING}')
               for group in grouped_parts(free, (WALLS,), kind)[1:]]
    return f'{success_table(groups)}\n\n{wall_table(groups)}'


def _eyes(pairs: Sequence[Pair], part: str) -> str:
    if not any(job['part'] == part for job, _ in pairs):
        return NOT_MEASURED
    return eyes_table(pairs, part)


def _varied(pairs: Sequence[Pair]) -> str:
    groups = grouped_parts(pairs, VARIED)
    for part in (WHEELS, STRICT):
        groups += grouped_parts(pairs, (part,), variety)[1:]
    return success_table(groups, with_part=True) if groups else NOT_MEASURED


def _state_when_moved(_: Job, record: Record) -> str:
    state = record.get('moved_in', '')
    return f'while it was in: {state}' if state else 'after the end'
