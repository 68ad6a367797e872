"""Run studies: compute what is not there yet, draw it, write its files."""

from concurrent.futures import Executor
from pathlib import Path
import shutil
from typing import Any, Callable, NamedTuple, Sequence

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from push_scenario.parallel import ERROR, run_many
from studies.framework import plot_style
from studies.framework.files import stamp_of, StudyFiles
from studies.framework.parameters import ChosenValues, Overrides, Values
from studies.framework.study import Finding, Outcome, Record, SHORT_JOB, Study, Table

# Measured: how long other processes take to start; fewer jobs are done by then [s].
START_TIME = 1.0


class StudyResult(NamedTuple):
    """
    A finished study.

    :param study: which.
    :param title: for the values that it was computed with.
    :param findings: name -> ``Finding``.
    :param files: where its files are.
    :param is_cached: whether it had been computed before, with the same parameters and source.
    :param page_table: of the ``Outcome``.
    """

    study: Study
    title: str
    findings: dict[str, Finding]
    files: StudyFiles
    is_cached: bool
    page_table: Table = {}


class StudyRunner:
    """
    Runs studies into a folder.

    :param folder: where files go; made if need be.
    :param chosen: values that captions leave open, as of ``read_chosen_values``.
    :param overrides: parameter name -> value that counts before all others.
    :param workers: number of processes, or of the executor's workers; None for one per core.
    :param executor: see ``run_many``; None for processes.
    :param on_progress: called with (finished jobs, all jobs) while a study runs many jobs.
    """

    def __init__(self, folder: Path, chosen: ChosenValues, overrides: Overrides | None = None, *,
                 workers: int | None = None, executor: Executor | None = None,
                 on_progress: Callable[[int, int], None] | None = None) -> None:
        self._folder = folder
        self._chosen = chosen
        self._overrides = overrides or {}
        self._workers = workers
        self._executor = executor
        self._on_progress = on_progress

    def find(self, study: Study) -> StudyResult | None:
        """
        Find what a study found before, with the same parameters and source.

        :param study: which.
        :return: its result; None where its files are not there.
        :raises ValueError: where a parameter does not fit.
        """
        values = study.values(self._chosen, self._overrides)
        files = StudyFiles(study, self._folder)
        stored = files.read(stamp_of(study, values))
        if stored is None:
            return None
        return StudyResult(study, study.title_of(values), stored.findings, files, True,
                           stored.page_table)

    def run(self, study: Study) -> StudyResult:
        """
        Run one study, unless its files are there for the same parameters and source.

        Jobs that were interrupted go on where they were.

        :param study: which.
        :return: its result.
        :raises ValueError: where a parameter does not fit.
        :raises RuntimeError: where one of its jobs fails.
        """
        result = self.find(study)
        if result is not None:
            return result
        values = study.values(self._chosen, self._overrides)
        stamp = stamp_of(study, values)
        files = StudyFiles(study, self._folder)
        self._folder.mkdir(parents=True, exist_ok=True)

        def run_jobs(function: Callable[[Any], Record], jobs: Sequence[Any], /, *,
                     job_time: float = SHORT_JOB) -> Sequence[Record]:
            is_short = len(jobs) * job_time < START_TIME
            return self._run_jobs(function, jobs, files.unfinished, is_short)

        outcome = study.compute(values, run_jobs)
        save_figure(study, outcome, values, files)
        files.write(stamp, outcome)
        _remove(files.unfinished)
        return StudyResult(study, study.title_of(values), outcome.findings, files, False,
                           outcome.page_table)

    def _run_jobs(self, function: Callable[[Any], Record], jobs: Sequence[Any], folder: Path,
                  is_short: bool) -> Sequence[Record]:
        workers = 1 if self._executor is None and is_short else self._workers
        records = run_many(function, jobs, folder=folder, workers=workers,
                           executor=self._executor, progress=self._on_progress)
        for index, record in enumerate(records):
            if ERROR in record:
                raise RuntimeError(f'job {index}, {jobs[index]}: {record[ERROR]}')
        return records


def draw_figure(study: Study, outcome: Outcome, values: Values) -> Figure:
    """
    Draw a study; to be called within ``plot_style.applied``.

    :param study: which.
    :param outcome: what it computed.
    :param values: of its parameters.
    :return: figure with an Agg canvas.
    """
    figure = Figure(figsize=study.size, layout='constrained')
    FigureCanvasAgg(figure)
    study.draw(figure, outcome, values)
    plot_style.annotate(figure, study, values)
    return figure


def save_figure(study: Study, outcome: Outcome, values: Values, files: StudyFiles) -> None:
    """
    Draw a study and save the figure as PNG and SVG.

    :param study: which.
    :param outcome: what it computed.
    :param values: of its parameters.
    :param files: where it goes.
    """
    with plot_style.applied():
        figure = draw_figure(study, outcome, values)
        # Without date and software, so that the same study gives the same bytes.
        figure.savefig(files.svg, metadata={'Date': None})
        figure.savefig(files.png, dpi=plot_style.DPI, metadata={'Software': None})


def _remove(folder: Path) -> None:
    """Remove the rows of a finished study, and the folder above if nothing else is in it."""
    if folder.exists():
        shutil.rmtree(folder)
        if not any(folder.parent.iterdir()):
            folder.parent.rmdir()
