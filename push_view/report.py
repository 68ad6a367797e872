"""Report of runs: one HTML file that holds the page and the tapes, and needs nothing else."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from push_control.law_names import law_title
from push_scenario.evaluation.report import report_table
from push_scenario.simulation.result import RunResult
from push_view.belief import BeliefRecorder
from push_view.page_file import page_html
from push_view.recording import recording


def write_report(results: Sequence[RunResult], path: str | PathLike[str],
                 beliefs: Sequence[BeliefRecorder | None] = ()) -> None:
    """
    Write runs of one scenario to one HTML file, to be opened from disk.

    :param results: the ``RunResult`` of each run, one or more.
    :param path: of the file.
    :param beliefs: what the robot believed in each run, where that was recorded.
    """
    recorded = [*beliefs, *[None] * (len(results) - len(beliefs))]
    runs = [{'name': law_title(result.control_law), 'messages': recording(result, belief)}
            for result, belief in zip(results, recorded)]
    document = {'runs': runs, 'table': report_table(results)}
    title = results[0].scenario.name.replace('_', ' ')
    Path(path).write_text(page_html(title, document), encoding='utf-8')
