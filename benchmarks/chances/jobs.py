"""Jobs of the benchmark of stated chances: to fit on, and to check with."""

from benchmarks.controller.cases import KINDS as PUSH_KINDS
from benchmarks.controller.cases import STRESSES
from benchmarks.controller.tables import Job
from benchmarks.tasks.cases import jobs

# Seeds from here on are those of no other benchmark, so that nothing was chosen by them.
FIRST_SEED = 20_000


def task_jobs(part: str, count: int) -> list[Job]:
    """
    List tasks; the first ones do not depend on how many there are.

    :param part: of ``PARTS`` of ``benchmarks.tasks.cases``.
    """
    return [{**job, 'seed': FIRST_SEED + job['seed']} for job in jobs(part, count)]


def push_jobs(count: int, *, is_spatial: bool) -> list[Job]:
    """
    List steered pushes; the first ones do not depend on how many there are.

    :param is_spatial: whether the foreign engine moves them.
    """
    kinds = [kind for kind in PUSH_KINDS if not (is_spatial and kind.startswith('table'))]
    return [{'kind': kinds[index % len(kinds)], 'seed': FIRST_SEED + index // len(kinds),
             'stress': STRESSES[0], 'is_spatial': is_spatial} for index in range(count)]
