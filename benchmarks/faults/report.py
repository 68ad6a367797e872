"""Report of a campaign: its runs summed up by input, word and duration."""

from collections import Counter
from collections.abc import Sequence
import math
from pathlib import Path
import re

from benchmarks.faults.injection import Input, Word
from benchmarks.faults.row import Ending, Row

TEMPLATE = Path(__file__).parent / 'faults.md.in'
HEADER = ('fault', 'runs', 'done', 'failed', 'waits', 'unexplained', 'stops after [s]: median',
          'worst', 'drives until then [m], worst', 'object beside its plans [m], worst',
          'most frequent reason')
# Numbers and quantities, by which reasons differ that are the same.
NUMBERS = re.compile(r'\(.*?\)|[-\d.]+')


def write_report(path: Path, rows: Sequence[Row], options: str) -> None:
    """
    Write the report.

    :param path: of the file.
    :param rows: ``Row`` of each run.
    :param options: of the command line that has made them.
    """
    temporary = [row for row in rows if row.fault.is_temporary]
    values = {'RUNS': len(rows), 'OPTIONS': options, 'TABLE': table(rows),
              'UNEXPLAINED': sum(not row.is_explained for row in rows),
              'TEMPORARY': len(temporary),
              'RECOVERED': sum(row.ending is Ending.DONE for row in temporary)}
    text = TEMPLATE.read_text(encoding='utf-8')
    for name, value in values.items():
        text = text.replace(f'@{name}@', str(value))
    path.write_text(text, encoding='utf-8')


def table(rows: Sequence[Row]) -> str:
    """
    Sum up runs by input, word and duration.

    :param rows: ``Row`` of each run.
    :return: Markdown.
    """
    lines = [_markdown(HEADER), _markdown(['---'] * len(HEADER))]
    for kind in Input:
        for word in Word:
            for is_temporary in (True, False):
                found = [row for row in rows if row.fault.input is kind and row.fault.word is word
                         and row.fault.is_temporary is is_temporary]
                if found:
                    duration = '2 s' if is_temporary else 'lasting'
                    lines.append(_line(found, f'{kind.value} {word.value}, {duration}'))
    return '\n'.join(lines)


def _line(rows: Sequence[Row], name: str) -> str:
    endings = Counter(row.ending for row in rows)
    reasons = [row.reason for row in rows if row.reason]
    kinds = Counter(NUMBERS.sub('#', reason) for reason in reasons).most_common(1)
    frequent = next((reason for reason in reasons
                     if NUMBERS.sub('#', reason) == kinds[0][0]), '')
    stops = sorted(row.stop_time for row in rows if not math.isnan(row.stop_time))
    driven = [row.driven for row in rows if not math.isnan(row.driven)]
    return _markdown([
        name, str(len(rows)), *(str(endings[ending]) for ending in Ending),
        str(sum(not row.is_explained for row in rows)),
        f'{stops[len(stops) // 2]:.2f}' if stops else '', f'{stops[-1]:.2f}' if stops else '',
        f'{max(driven):.2f}' if driven else '', f'{max(row.deviation for row in rows):.2f}',
        frequent])


def _markdown(cells: Sequence[str]) -> str:
    return '| ' + ' | '.join(cells) + ' |'
