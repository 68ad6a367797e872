"""
Errors of poses from images, and how tasks from pixels to wheels end: ``docs/reports/pixels.md``.

``python -m benchmarks.pixels [--count 4] [--images 100] [--records FILE]`` runs so many tasks for
each view. With a file for records each end is written there, and what it has is not run again.
"""

import argparse
from concurrent import futures
import json
import multiprocessing
from pathlib import Path
import statistics
import sys
from typing import Any, Sequence

from benchmarks.pixels.cases import (
    Ending, Kind, kind_of, KINDS, run_task, TOLERANCES, View, VIEWS)
from benchmarks.pixels.tag_errors import table
from benchmarks.report_template import fill_template
from push_scenario.simulation.result import Outcome
from tqdm import tqdm

TEMPLATE, REPORT = Path(__file__).with_name('pixels.md.in'), Path('docs/reports/pixels.md')
HEADER = ('| camera | task | tolerance | within it, truly | done, but not within '
          '| distance to the goal: median, greatest | time, median |\n'
          '| --- | --- | --- | --- | --- | --- | --- |')
KIND_NAMES = {Kind('box_04', 'floor'): 'box', Kind('carton', 'floor'): 'carton',
              Kind('box_04', 'door'): 'box, through a door',
              Kind('carton', 'door'): 'carton, through a door'}
DESCRIPTIONS: dict[View, str] = {
    'robot': 'on the robot; its place by ticks and a gyro, in rooms by a lidar too',
    'located_robot': 'on the robot; its place known to 1 mm and 0.1 degrees',
    'room': 'in the room, 1.6 m above the floor'}


def rows(endings: Sequence[Ending]) -> list[str]:
    """
    Write a row for the tasks of each view and kind that were run.

    :param endings: of tasks.
    """
    groups: dict[tuple[View, Kind], list[Ending]] = {
        (view, kind): [ending for ending in endings
                       if ending.view == view and kind_of(ending.seed) == kind]
        for view in VIEWS for kind in KINDS}
    return [_row(view, kind, group) for (view, kind), group in groups.items() if group]


def _row(view: View, kind: Kind, endings: Sequence[Ending]) -> str:
    tolerance, count = TOLERANCES[view], len(endings)
    within = sum(ending.is_within for ending in endings)
    done = [ending for ending in endings if ending.outcome is Outcome.DONE]
    wrong = sum(not ending.is_within for ending in done)
    errors = sorted(1e3 * ending.position_error for ending in endings)
    time = statistics.median(ending.time for ending in endings)
    return (f'| {DESCRIPTIONS[view]} | {KIND_NAMES[kind]} | {1e3 * tolerance.position:.0f} mm | '
            f'{within} of {count} | {wrong} | {statistics.median(errors):.1f}, '
            f'{errors[-1]:.1f} mm | {time:.0f} s |')


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


def run_tasks(count: int, records: Path | None, workers: int) -> list[Ending]:
    """
    Run the tasks of all views that are not recorded yet.

    :param count: of tasks for each view.
    :param records: as of ``read_records``.
    :param workers: processes.
    :return: all ends, those of before among them.
    """
    endings = read_records(records)
    known = {(ending.view, ending.seed) for ending in endings}
    missing: list[tuple[View, int]] = [
        (view, seed) for seed in range(count) for view in VIEWS if (view, seed) not in known]
    if not missing:
        return endings
    with futures.ProcessPoolExecutor(workers, multiprocessing.get_context('spawn')) as pool:
        running = [pool.submit(run_task, view, seed) for view, seed in missing]
        for future in tqdm(futures.as_completed(running), total=len(running)):
            endings.append(future.result())
            if records is not None:
                _record(endings[-1], records)
    return endings


def _record(ending: Ending, records: Path) -> None:
    with records.open('a', encoding='utf-8') as file:
        line = json.dumps({**ending._asdict(), 'outcome': ending.outcome.name})
        file.write(line + '\n')


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the benchmark.

    :param arguments: words behind the command's name; None for those of the process.
    """
    parser = argparse.ArgumentParser(prog='benchmarks.pixels')
    parser.add_argument('--count', type=int, default=4, help='tasks for each view (default: 4)')
    parser.add_argument('--images', type=int, default=100,
                        help='of tags at each distance (default: 100)')
    parser.add_argument('--workers', type=int, default=2, help='processes (default: 2)')
    parser.add_argument('--records', type=Path, help='file of the ends of tasks')
    options = parser.parse_args(arguments)
    endings = run_tasks(options.count, options.records, options.workers)
    page = fill_template(TEMPLATE, IMAGES=options.images, TAGS=table(options.images),
                         TASKS='\n'.join((HEADER, *rows(endings))))
    REPORT.write_text(page, encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
