"""
Benchmark of plans in maps: first plan of each task, whether there is one, and how long it takes.

Parts: ``passages``, success over the width of a passage; ``flats``; ``growth``, the time over the
cells of the map and over the pushes; ``nooks``, tasks from and to walls, corners and niches;
``public maps``, tasks in the maps of a folder, by robots that know their position and by odometry
alone. With ``--drive`` passages and nooks are driven to the end, too.
"""

import argparse
from collections import Counter
import math
from pathlib import Path
import sys
import time
from typing import Any, NamedTuple, Sequence

from benchmarks.controller.tables import wilson
from benchmarks.map_plans.ideal_push import Escape, find_escape
from benchmarks.map_plans.instances import (
    building, flat, Instance, nook, passage, public,
)
from benchmarks.tasks.nooks import Nook
import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.task_planner import plan_for_request
from push_scenario.simulation.loop import simulate
from push_scenario.simulation.result import Outcome
from tqdm import tqdm

PASSAGES, FLATS, GROWTH, NOOKS, PUBLIC = PARTS = (
    'passages', 'flats', 'growth', 'nooks', 'public maps')
RATIOS = (3.0, 2.5, 2.0, 1.75, 1.5, 1.4, 1.3, 1.2, 1.1)
OBJECTS = ('box_04', 'carton', 'coffee_table')
NOOK_OBJECTS = (*OBJECTS, 'bin')
DRIVES = ('differential', 'holonomic')
# Sides of the maps [cells], rooms that are passed through in those, and the side with which the
# number of rooms is varied.
SIDES = (100, 400, 1000, 2000, 4000)
ROOMS_OF_SIDES = 2
ROOMS = (2, 4, 8)
SIDE_OF_ROOMS = 1000


class Row(NamedTuple):
    """
    Tasks of one kind.

    :param name: what they have in common.
    :param width: of the passage over that of the object, or 0.
    :param found: whether each has a plan.
    :param causes: codes of the refusals of those that have none.
    :param impossible: whether no ideal pushes bring the object away, of each that has no plan and
        was asked for it.
    :param seconds: CPU time of the plan of each [s].
    :param pushes: of those that have one.
    :param done: whether each was driven to its goal; empty where none was driven.
    """

    name: str
    width: float
    found: list[bool]
    causes: list[PlanFailure]
    impossible: list[bool]
    seconds: list[float]
    pushes: list[int]
    done: list[bool]


def measure(name: str, instances: Sequence[Instance], *, width: float = 0.0,
            drives: bool = False, drift: float = 0.0, explains: bool = False) -> Row:
    """
    Plan tasks, and drive them where that is wanted.

    :param name: of the row.
    :param instances: the ``Instance`` of each.
    :param width: of the passage over that of the object.
    :param drives: whether to drive them.
    :param drift: growth of the deviation of the robot per distance, and of its heading
        [m/m, rad/m].
    :param explains: whether to ask of refused tasks if ideal pushes bring the object away.
    """
    row = Row(name, width, [], [], [], [], [], [])
    for instance in instances:
        request = PlanRequest(instance.start, instance.robot_start, instance.goal, instance.obj,
                              odometry_slope=drift, odometry_drift=drift)
        started = time.process_time()
        try:
            plan = plan_for_request(request, instance.robot, PlannerSettings(), DriveSettings(),
                                    instance.occupancy_map)
        except PlanningFailed as failure:
            plan = None
            row.causes.append(failure.code)
        row.seconds.append(time.process_time() - started)
        row.found.append(plan is not None)
        if plan is None and explains:
            row.impossible.append(find_escape(instance) is Escape.IMPOSSIBLE)
        if plan is not None:
            row.pushes.append(1 + (0 if plan.remaining is None else len(plan.remaining.pushes)))
        if drives:
            row.done.append(simulate(instance.scenario).outcome is Outcome.DONE)
    return row


def passages(count: int, ratios: Sequence[float], drives: bool) -> list[Row]:
    """Measure success over the width of passages."""
    kinds = [(name, drive) for name in OBJECTS for drive in DRIVES]
    rows: list[Row] = []
    with tqdm(total=len(kinds) * len(ratios), desc=PASSAGES) as bar:
        for name, drive in kinds:
            # The first plan compiles, and makes the table of the object.
            measure('', [passage(name, drive, max(ratios), count)])
            for ratio in ratios:
                rows.append(measure(f'{name}, {drive}', [
                    passage(name, drive, ratio, seed) for seed in range(count)],
                    width=ratio, drives=drives))
                bar.update()
    return rows


def flats(count: int) -> list[Row]:
    """Measure plans in flats."""
    rows: list[Row] = []
    for name in OBJECTS[:2]:
        for drive in DRIVES:
            measure('', [flat(name, drive, count)])
            rows.append(measure(f'flat: {name}, {drive}', [
                flat(name, drive, seed) for seed in range(count)]))
    return rows


def nooks(count: int, drives: bool) -> list[Row]:
    """Measure tasks from and to walls, corners and niches."""
    rows: list[Row] = []
    with tqdm(total=len(Nook) * len(NOOK_OBJECTS), desc=NOOKS) as bar:
        for name in NOOK_OBJECTS:
            measure('', [nook(Nook.TO_WALL, name, DRIVES[0], count)])
            for kind in Nook:
                rows.append(measure(f'{name}: {kind.value}', [
                    nook(kind, name, DRIVES[0], seed) for seed in range(count)], drives=drives,
                    explains=True))
                bar.update()
    return rows


def public_maps(count: int, folder: str) -> list[Row]:
    """Measure tasks in the maps of a folder, by robots that know their position or drift."""
    rows: list[Row] = []
    drift = SupervisionSettings().odometry_drift
    for name in NOOK_OBJECTS:
        measure('', [nook(Nook.TO_WALL, name, DRIVES[0], count)])
        instances = [public(name, DRIVES[0], seed, folder) for seed in range(count)]
        rows.append(measure(f'{name}, its position known', instances, explains=True))
        rows.append(measure(f'{name}, odometry alone', instances, drift=drift))
    return rows


def growth(count: int) -> list[Row]:
    """Measure the time over cells and over pushes; the first answer in a map apart."""
    cases = [(side, ROOMS_OF_SIDES) for side in SIDES]
    cases += [(SIDE_OF_ROOMS, rooms) for rooms in ROOMS if rooms != ROOMS_OF_SIDES]
    name, drive = OBJECTS[0], DRIVES[0]
    measure('', [building(name, drive, SIDES[0], 1, 0)])
    rows: list[Row] = []
    for side, rooms in tqdm(cases, desc=GROWTH):
        instances = [building(name, drive, side, rooms, seed) for seed in range(count)]
        title = f'{side} x {side} cells, {rooms} rooms'
        rows.append(measure(f'{title}, first plan', instances))
        rows.append(measure(f'{title}, later ones', instances))
    return rows


def table(rows: Sequence[Row]) -> str:
    """Format rows as a Markdown table."""
    lines = ['| tasks | width / object | plan found (95 %) | CPU median / p95 / most [s] | pushes '
             'median, most | driven | refusals | impossible |',
             '| --- | --- | --- | --- | --- | --- | --- | --- |']
    for row in rows:
        count = len(row.found)
        low, high = wilson(sum(row.found), count)
        median, late = np.percentile(row.seconds, (50, 95))
        pushes = f'{np.median(row.pushes):g}, {max(row.pushes)}' if row.pushes else ''
        driven = f'{sum(row.done)} of {count}' if row.done else ''
        impossible = sum(row.impossible) if row.impossible else ''
        causes = ', '.join(f'{number} {cause.name}'
                           for cause, number in Counter(row.causes).most_common())
        lines.append(
            f'| {row.name} | {row.width or ""} | {sum(row.found)} of {count} ({100 * low:.0f} to '
            f'{100 * high:.0f} %) | {median:.3f} / {late:.3f} / {max(row.seconds):.3f} | '
            f'{pushes} | {driven} | {causes} | {impossible} |')
    return '\n'.join(lines) + '\n'


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw the success over the width of passages."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(6.4, 3.8), layout='constrained')
    axes = figure.subplots()
    names = list(dict.fromkeys(row.name for row in rows if row.width))
    for index, name in enumerate(names):
        chosen = [row for row in rows if row.name == name]
        ratios = [row.width for row in chosen]
        shares = [_share(row.found) for row in chosen]
        style: dict[str, Any] = {'color': f'C{index // 2}', 'ls': ('-', '--')[index % 2]}
        axes.plot(ratios, shares, marker='o', ms=4, label=f'{name}: plan', **style)
        if chosen[0].done:
            axes.plot(ratios, [_share(row.done) for row in chosen], marker='x',
                      label=f'{name}: driven', **style)
    axes.set(xlabel='width of the passage / width of the object', ylim=(-3.0, 103.0),
             ylabel=f'tasks with a plan, % of {len(rows[0].found)}')
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=110)


def _share(values: Sequence[bool]) -> float:
    return 100.0 * sum(values) / len(values) if values else math.nan


def main() -> int:
    """Measure, print, and write."""
    parser = argparse.ArgumentParser(description='Benchmark of plans in maps.')
    parser.add_argument('--part', choices=PARTS, action='append', dest='parts',
                        help='only this part; may be given several times')
    parser.add_argument('--count', type=int, default=10, help='tasks of each row')
    parser.add_argument('--ratio', type=float, action='append', dest='ratios',
                        help='only passages of this width over that of the object; may be given '
                        'several times')
    parser.add_argument('--maps', help=f'folder with maps of map_server for {PUBLIC}, which are '
                        'skipped without it')
    parser.add_argument('--drive', action='store_true', help='drive passages and nooks, too')
    parser.add_argument('--out', type=Path, default=Path('out/map_plans'))
    chosen = parser.parse_args()
    if chosen.count < 1:
        parser.error(f'--count: got {chosen.count}, expected at least 1')
    chosen.out.mkdir(parents=True, exist_ok=True)
    for part in chosen.parts or PARTS:
        if part == PUBLIC and not chosen.maps:
            print(f'{part}: skipped, as --maps names no folder', file=sys.stderr)
            continue
        rows = {PASSAGES: lambda: passages(chosen.count, chosen.ratios or RATIOS, chosen.drive),
                FLATS: lambda: flats(chosen.count), GROWTH: lambda: growth(chosen.count),
                NOOKS: lambda: nooks(chosen.count, chosen.drive),
                PUBLIC: lambda: public_maps(chosen.count, chosen.maps)}[part]()
        written = table(rows)
        print(written)
        (chosen.out / f'{part}.md').write_text(written, encoding='utf-8')
        if part == PASSAGES:
            draw(rows, chosen.out / f'{PASSAGES}.png')
    return 0
