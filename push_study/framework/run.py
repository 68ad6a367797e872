"""Run studies: compute what is not there yet, draw it, keep it."""

from typing import Any, NamedTuple

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from push_scenario.batch.batch import run_batch
from push_study.framework import paper
from push_study.framework.store import stamp_of, StudyFiles
from push_study.framework.values import values_of

FEW = 200


class Done(NamedTuple):
    """
    A finished study.

    :param study: the ``Study``.
    :param findings: dict of names to ``Finding``.
    :param files: its ``StudyFiles``.
    :param kept: whether it was there already.
    """

    study: Any
    findings: dict
    files: Any
    kept: bool


class Runner:
    """
    Runs studies into a folder.

    :param folder: where files go, a path; made if need be.
    :param table: values that captions leave open, of ``values.read_table``.
    :param overrides: dict of parameter names to values that come first.
    :param workers: number of processes; None for one per core.
    :param scheduler: address of a Dask cluster to run on instead, or None.
    :param progress: called with (jobs done, all jobs) while a study runs a batch.
    """

    def __init__(self, folder, table, overrides=None, workers=None, scheduler=None, progress=None):
        self._folder, self._table, self._overrides = folder, table, overrides or {}
        self._workers, self._scheduler, self._progress = workers, scheduler, progress

    def __call__(self, study):
        """
        Run one study, unless its files are there for the same parameters and source.

        Records of a batch that was interrupted are taken up again.

        :param study: the ``Study``.
        :return: ``Done``.
        :raises ValueError: where a parameter does not fit.
        """
        values = values_of(study, self._table, self._overrides)
        stamp, files = stamp_of(study, values), StudyFiles(study, self._folder)
        findings = files.findings(stamp)
        if findings is not None:
            return Done(study, findings, files, True)
        self._folder.mkdir(parents=True, exist_ok=True)
        batches = []

        def batch(function, jobs):
            batches.append(files.jobs(stamp, len(batches)))
            return self._batch(function, jobs, batches[-1])

        outcome = study.compute(values, batch)
        save_picture(study, outcome, values, files)
        files.finish(stamp, outcome)
        for path in batches:
            path.unlink()
            path.with_suffix('.csv').unlink()
        if batches and not any(batches[0].parent.iterdir()):
            batches[0].parent.rmdir()
        return Done(study, outcome.findings, files, False)

    def _batch(self, function, jobs, path):
        # A few jobs are done before other processes have started.
        workers = 1 if len(jobs) < FEW else self._workers
        result = run_batch(function, jobs, path, workers=workers, scheduler=self._scheduler,
                           progress=self._progress)
        if result.errors:
            number, error = next(iter(result.errors.items()))
            raise RuntimeError(f'job {number}, {jobs[number]}: {error}')
        return result.records


def run_here(function, jobs):
    """
    Run a batch at once and in memory; what ``compute`` takes where there is no runner.

    :param function: of one job.
    :param jobs: list of jobs.
    :return: list of records.
    """
    return [function(job) for job in jobs]


def save_picture(study, outcome, values, files):
    """
    Draw a study and save the picture.

    :param study: the ``Study``.
    :param outcome: its ``Outcome``.
    :param values: its ``Values``.
    :param files: its ``StudyFiles``.
    """
    with paper.style():
        figure = Figure(figsize=study.size, layout='constrained')
        FigureCanvasAgg(figure)
        study.draw(figure, outcome, values)
        paper.annotate(figure, study, values)
        figure.savefig(files.svg, metadata={'Date': None})
        figure.savefig(files.png, dpi=paper.DPI, metadata={'Software': None})
