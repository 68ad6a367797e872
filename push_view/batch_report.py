"""Report of many runs: one HTML file with tables, and the runs that failed, to be replayed."""

from collections.abc import Callable, Mapping, Sequence
import dataclasses
import functools
from os import PathLike
from pathlib import Path
from typing import Any

from push_scenario.batch.batch import BatchResult
from push_scenario.batch.chunks import Job, Record
from push_scenario.evaluation.report import report_table
from push_scenario.simulation.result import RunResult
from push_view.belief import BeliefRecorder
from push_view.messages import Message
from push_view.page_file import packed, page_html
from push_view.recording import recording

# Greatest size of the runs in a file [bytes]; chosen: a browser opens it at once, and it can be
# sent by mail. A run of half a minute takes about 150 kB.
MAX_SIZE = 4_000_000

Replay = Callable[[], tuple[RunResult, BeliefRecorder | None]]


@dataclasses.dataclass(frozen=True)
class ReportTable:
    """
    A table of a report.

    :param title: of the table.
    :param lines: of texts, all as long; the first is the head.
    :param replays: what simulates the run of a line once more, by the number of the line.
    """

    title: str
    lines: Sequence[Sequence[str]]
    replays: Mapping[int, Replay] = dataclasses.field(default_factory=dict[int, Replay])


def write_batch_report(tables: Sequence[ReportTable], path: str | PathLike[str], title: str, *,
                       max_size: int = MAX_SIZE) -> int:
    """
    Write tables to one HTML file; lines that have a replay are links to it.

    :param tables: list of ``ReportTable``. Their runs are simulated one after the other.
    :param path: of the file.
    :param title: of the page.
    :param max_size: of all runs together [bytes]; those beyond it are left out, and counted.
    :return: number of runs that were left out.
    """
    runs: list[Message] = []
    shown: list[Message] = []
    size = left_out = 0
    for table in tables:
        links: dict[int, int] = {}
        for line, replay in table.replays.items():
            if size >= max_size:
                left_out += 1
                continue
            run = _run(table.lines[line][0], *replay())
            if size + len(run['packed']) > max_size:
                size = max_size
                left_out += 1
                continue
            size += len(run['packed'])
            links[line] = len(runs)
            runs.append(run)
        shown.append({'title': table.title, 'lines': [list(line) for line in table.lines],
                      'runs': links})
    notes = [] if not left_out else [
        f'{left_out} more runs would make this file greater than {1e-6 * max_size:g} MB.']
    document = {'title': title, 'tables': shown, 'runs': runs, 'notes': notes}
    Path(path).write_text(page_html(title, document), encoding='utf-8')
    return left_out


def batch_table(result: BatchResult, is_failure: Callable[[Record], bool],
                replay: Callable[[Job], tuple[RunResult, BeliefRecorder | None]] | None = None,
                ) -> ReportTable:
    """
    Make a table of the jobs of a batch that failed, or ended with an error.

    :param result: the ``BatchResult``.
    :param is_failure: of a record.
    :param replay: simulates a job once more; None where that is not possible.
    """
    failed = [(number, record) for number, record in enumerate(result.records)
              if record is None or is_failure(record)]
    names = list(dict.fromkeys(name for _, record in failed for name in record or {}))
    lines = [['job', *names, 'error']]
    replays: dict[int, Replay] = {}
    for line, (number, record) in enumerate(failed, 1):
        lines.append([str(number), *(_text((record or {}).get(name, '')) for name in names),
                      result.errors.get(number, '')])
        if replay is not None and record is not None:
            replays[line] = functools.partial(replay, result.jobs[number])
    return ReportTable(f'{len(failed)} of {len(result.jobs)} failed', lines, replays)


def _run(name: str, result: RunResult, beliefs: BeliefRecorder | None) -> Message:
    """Pack what the page shows of a run."""
    return {'name': name, 'packed': packed({
        'messages': recording(result, beliefs, only_shown=True),
        'table': report_table([result])})}


def _text(value: Any) -> str:
    return f'{value:.4g}' if isinstance(value, float) else str(value)
