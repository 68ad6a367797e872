"""Tasks that come once with each of several varieties, as with each base or with all eyes."""

from collections.abc import Sequence

from benchmarks.controller.tables import Job

# Seeds of these tasks are the number of the task times this, and the index of the variety: chosen,
# more than there are varieties, so that tasks stay the same if some are appended.
STRIDE = 100


def varied_jobs(part: str, count: int, kinds: Sequence[str], varieties: int) -> list[Job]:
    """
    List the tasks of a part, one variety after the other; all varieties get the same tasks.

    :param part: of these tasks.
    :param count: number of tasks.
    :param kinds: objects and drives.
    :param varieties: number of them.
    :return: keyword arguments of ``benchmarks.tasks.cases.draw``.
    """
    tasks: list[Job] = []
    for index in range(count):
        number, variety = divmod(index, varieties)
        tasks.append({'part': part, 'kind': kinds[number % len(kinds)],
                      'seed': STRIDE * (number // len(kinds)) + variety})
    return tasks


def task_key(job: Job) -> tuple[str, str, int]:
    """
    Identify the task of a job, whatever its variety: part, kind, and seed for the first of them.

    :param job: of ``varied_jobs``, or what it is compared with.
    """
    return job['part'], job['kind'], job['seed'] - job['seed'] % STRIDE
