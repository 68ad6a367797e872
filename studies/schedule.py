"""Many studies at once: whole studies in several processes, the longest first."""

import dataclasses
from pathlib import Path
from typing import Callable, NamedTuple, Sequence

from push_scenario.parallel import available_cores, run_many
from studies import catalogue
from studies.framework.parameters import Overrides, read_chosen_values
from studies.framework.runner import StudyRunner
from studies.framework.study import Record, Study

# Measured: what most studies take on one core, and below which processes do not pay, as each
# takes a few seconds to start [s].
SHORT_TIME = 1.0
MIN_TIME = 15.0


class StudyJob(NamedTuple):
    """
    Studies that share simulations, so that one process runs them one after the other.

    :param figures: their numbers.
    :param time: what they take on one core, roughly; it decides about the order only [s].
    """

    figures: tuple[str, ...]
    time: float


# Measured; all that is not listed takes about SHORT_TIME.
LONG_JOBS = (
    StudyJob(('4.5', '4.6', '4.7'), 85.0), StudyJob(('4.8', '4.9', '4.10', '4.11'), 70.0),
    StudyJob(('4.12', '4.13', '4.14', '4.15'), 70.0), StudyJob(('disturbed-objects',), 30.0),
    StudyJob(('P.8',), 14.0), StudyJob(('2.28',), 7.0), StudyJob(('2.29',), 7.0),
    StudyJob(('four-goals',), 5.0), StudyJob(('2.8',), 5.0), StudyJob(('4.1', '4.3'), 4.0),
    StudyJob(('4.2', '4.4'), 4.0), StudyJob(('P.6', 'P.9', 'P.7'), 6.0), StudyJob(('P.10',), 4.0),
    StudyJob(('T3.2', 'T3.3', 'T3.4', 'T3.5', 'T3.6', 'T3.7'), 12.0),
    StudyJob(('2.21',), 3.0), StudyJob(('2.23',), 3.0), StudyJob(('2.24',), 3.0),
    StudyJob(('P.5',), 3.0), StudyJob(('3.9', '3.10', '3.11'), 3.0))


@dataclasses.dataclass(frozen=True)
class RunStudies:
    """
    Runs the studies of a job into a folder; see ``run_many``.

    :param folder: where their files go.
    :param overrides: of a ``StudyRunner``.
    """

    folder: str
    overrides: Overrides

    def __call__(self, job: Sequence[str]) -> Record:
        """
        Run some studies one after the other.

        :param job: their numbers.
        :return: nothing but their number: their files hold the rest.
        """
        runner = StudyRunner(Path(self.folder), read_chosen_values(), self.overrides, workers=1)
        for study in catalogue.select(job):
            runner.run(study)
        return {'studies': len(job)}


def study_jobs(studies: Sequence[Study]) -> list[StudyJob]:
    """
    Divide studies into jobs.

    :param studies: of the catalogue.
    :return: jobs, the longest first.
    """
    figures = {study.figure for study in studies}
    jobs = [StudyJob(tuple(figure for figure in job.figures if figure in figures), job.time)
            for job in LONG_JOBS]
    listed = {figure for job in jobs for figure in job.figures}
    jobs = [job for job in jobs if job.figures]
    jobs += [StudyJob((study.figure,), SHORT_TIME) for study in studies
             if study.figure not in listed]
    return sorted(jobs, key=lambda job: -job.time)


def run_in_processes(studies: Sequence[Study], folder: Path, overrides: Overrides,
                     workers: int | None, on_progress: Callable[[float], None]) -> None:
    """
    Run studies in processes of their own, as far as that is faster.

    Left out are those that take longer than their share of all: their own jobs use all
    processes. What fails is left out as well; a ``StudyRunner`` finds out why.

    :param studies: not yet done; those that are not in the catalogue are left out.
    :param folder: where files go.
    :param overrides: of a ``StudyRunner``.
    :param workers: number of processes; None for one per core.
    :param on_progress: called with the number of finished studies, roughly.
    """
    count = workers or available_cores()
    jobs = study_jobs([study for study in studies if study in catalogue.studies()])
    total = sum(job.time for job in jobs)
    jobs = [job for job in jobs if job.time <= total / count]
    if count == 1 or sum(job.time for job in jobs) < MIN_TIME:
        return
    figures = sum(len(job.figures) for job in jobs)
    run_many(RunStudies(str(folder), overrides), [list(job.figures) for job in jobs],
             workers=count, block=1,
             progress=lambda finished, all_jobs: on_progress(figures * finished / all_jobs))
