"""
Errors of poses from images, and how tasks from pixels to wheels end: ``docs/reports/pixels.md``.

``python -m benchmarks.pixels [--count 5] [--images 25] [--records FILE]`` runs so many tasks for
each view. With a file for records each end is written there, and what it has is not run again.
"""

import argparse
import json
from pathlib import Path
import statistics
import sys
from typing import Any, Sequence

from benchmarks.pixels.cases import Ending, run_task, TOLERANCES, View, VIEWS
from benchmarks.pixels.tag_errors import table
from benchmarks.report_template import fill_template
from push_scenario.simulation.result import Outcome
from tqdm import tqdm

TEMPLATE, REPORT = Path(__file__).with_name('pixels.md.in'), Path('docs/reports/pixels.md')
HEADER = ('| camera | tolerance | within it, truly | done, but not within | distance to the goal: '
          'median, greatest | time, median |\n| --- | --- | --- | --- | --- | --- |')
DESCRIPTIONS: dict[View, str] = {
    'robot': 'on the robot; its place by the ticks of its wheels and a gyro',
    'located_robot': 'on the robot; its place known to 1 mm and 0.1 degrees',
    'room': 'in the room, 1.6 m above the floor'}


def row(view: View, endings: Sequence[Ending]) -> str:
    """
    Write the row of a view.

    :param view: one of ``VIEWS``.
    :param endings: of its tasks, at least one.
    """
    tolerance, count = TOLERANCES[view], len(endings)
    within = sum(ending.is_within for ending in endings)
    done = [ending for ending in endings if ending.outcome is Outcome.DONE]
    wrong = sum(not ending.is_within for ending in done)
    errors = sorted(1e3 * ending.position_error for ending in endings)
    return (f'| {DESCRIPTIONS[view]} | {1e3 * tolerance.position:.0f} mm | {within} of {count} | '
            f'{wrong} | {statistics.median(errors):.1f}, {errors[-1]:.1f} mm | '
            f'{statistics.median(ending.time for ending in endings):.0f} s |')


def read_records(path: Path | None) -> list[Ending]:
    """
    Read the ends of earlier tasks.

    :param path: of the file, one end a line; None, or of none yet, for none.
    """
    if path is None or not path.exists():
        return []
    endings: list[Ending] = []
    for line in path.read_text(encoding='utf-8').splitlines():
        record: dict[str, Any] = json.loads(line)
        record['outcome'] = Outcome[record['outcome']]
        endings.append(Ending(**record))
    return endings


def run_tasks(count: int, records: Path | None) -> list[Ending]:
    """
    Run the tasks of all views that are not recorded yet.

    :param count: of tasks for each view.
    :param records: as of ``read_records``.
    :return: all ends, those of before among them.
    """
    endings = read_records(records)
    known = {(ending.view, ending.seed) for ending in endings}
    missing: list[tuple[View, int]] = [(view, seed) for seed in range(count) for view in VIEWS
                                       if (view, seed) not in known]
    for view, seed in tqdm(missing):
        ending = run_task(view, seed)
        endings.append(ending)
        if records is not None:
            with records.open('a', encoding='utf-8') as file:
                line = json.dumps({**ending._asdict(), 'outcome': ending.outcome.name})
                file.write(line + '\n')
    return endings


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the benchmark.

    :param arguments: words behind the command's name; None for those of the process.
    """
    parser = argparse.ArgumentParser(prog='benchmarks.pixels')
    parser.add_argument('--count', type=int, default=5, help='tasks for each view (default: 5)')
    parser.add_argument('--images', type=int, default=25, help='of tags at each distance')
    parser.add_argument('--records', type=Path, help='file of the ends of tasks')
    options = parser.parse_args(arguments)
    endings = run_tasks(options.count, options.records)
    of_views = {view: [ending for ending in endings if ending.view == view] for view in VIEWS}
    rows = [row(view, of_views[view]) for view in VIEWS if of_views[view]]
    page = fill_template(TEMPLATE, IMAGES=options.images, TAGS=table(options.images),
                         TASKS='\n'.join((HEADER, *rows)))
    REPORT.write_text(page, encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
