"""
Rooms with several objects, beside an order that takes the nearest object first.

``orders`` plans orders alone, ``rooms`` and ``doors`` simulate all pushes, ``compare`` rooms in
other orders, too, ``flat`` objects that get goals one after the other. Rows are kept in a
folder, so that a run that was interrupted goes on where it stopped. ``--stored`` tables what is
there, of parts that were run one by one.
"""

import argparse
from collections.abc import Sequence
import dataclasses
from pathlib import Path
import sys
import time

from benchmarks.tidy.doors import draw_door
from benchmarks.tidy.flat import flat_table, run_flat
from benchmarks.tidy.report import (
    ALONE, BLOCKED, NEAREST, order_table, REPORT, room_table, SEARCHED, write_part)
from benchmarks.tidy.rooms import draw_room, SIDES
import numpy as np
from push_model.geometry import distance
from push_planner.rearrangement.order import MAX_WORK, plan_order
from push_planner.rearrangement.problem import Move, OrderPlan, Rearrangement
from push_scenario.evaluation.result_row import Row
from push_scenario.parallel import ERROR, progress_bar, run_many, stored_jobs
from push_scenario.simulation.result import Outcome
from push_scenario.tidying.room import Room
from push_scenario.tidying.tidy import tidy
from push_tidy.tidy_supervisor import OrderPlanner


@dataclasses.dataclass(frozen=True)
class Job:
    """
    One room.

    :param count: of objects; ``BLOCKED`` for two rooms with a blocked door.
    :param index: of the room.
    :param order: ``searched``, ``nearest`` or ``alone``.
    """

    count: int
    index: int
    order: str = SEARCHED

    def draw(self) -> Room:
        """Draw the room."""
        return draw_door(self.index) if self.count == BLOCKED else draw_room(self.count,
                                                                             self.index)


def nearest_first(problem: Rearrangement) -> OrderPlan:
    """Take the object that is nearest to the robot, whatever stands in its way."""
    remaining = [item for item in problem.objects if not item.is_at_goal and item.goal is not None
                 and (item.name, item.goal) not in problem.refused_moves]
    moves: list[Move] = []
    if remaining:
        item = min(remaining, key=lambda item: distance(item.pose, problem.robot_pose))
        moves = [Move(item.name, item.pose, item.goal or item.pose, False, 0.0,
                      np.array([item.pose[:2]]))]
    return OrderPlan(tuple(moves), {}, 0.0, True, 0)


# Distance by which what was touched moved, beyond which touches are counted besides [m].
DEEP = 5e-3

ORDERS: dict[str, OrderPlanner] = {SEARCHED: plan_order, NEAREST: nearest_first,
                                   ALONE: plan_order}
# Parts, and the folders of their rows.
FOLDERS = {'orders': 'orders', 'rooms': 'rooms', 'compare': 'rooms', 'doors': 'doors'}


def order_row(job: Job) -> Row:
    """Plan the first order of a room, and the best within the budget."""
    row: Row = dataclasses.asdict(job)

    def plan(problem: Rearrangement) -> OrderPlan:
        for name, budget in (('first', 0), ('best', MAX_WORK)):
            start = time.process_time()
            result = plan_order(problem, budget)
            row[f'{name}_cpu'] = time.process_time() - start
            row[f'{name}_time'] = result.time
            row['refused'] = len(result.refusals)
            row['temporary'] = sum(move.is_temporary for move in result.moves)
        return OrderPlan((), {}, 0.0, True, 0)

    tidy(job.draw(), find_order=plan)
    return row


def room_row(job: Job) -> Row:
    """Put a room in order; ``alone`` each object by itself, from where all start."""
    room = job.draw()
    rooms = [room] if job.order != ALONE else [
        dataclasses.replace(room, scenarios={name: scenario})
        for name, scenario in room.scenarios.items()]
    results = [tidy(item, find_order=ORDERS[job.order]) for item in rooms]
    moves = [move for result in results for move in result.moves]
    return {**dataclasses.asdict(job), 'objects': len(room.scenarios),
            'placed': sum(result.is_placed(name) for result in results for name in result.poses),
            'moves': len(moves), 'touches': sum(result.touches for result in results),
            'deep_touches': sum(gap < -DEEP for result in results for gap in result.touch_gaps),
            'duration': sum(result.duration for result in results),
            'failed_moves': sum(move.run.outcome is not Outcome.DONE for move in moves),
            'reasons': '; '.join(f'{name}: {report}' for result in results
                                 for name, report in result.failures.items())}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; see ``--help``."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.tidy', description=__doc__)
    parser.add_argument('part', choices=(*FOLDERS, 'flat'), help='what to measure')
    parser.add_argument('--rooms', type=int, default=25, help='rooms of each size (default: 25)')
    parser.add_argument('--sizes', type=int, nargs='+', choices=tuple(SIDES), default=list(SIDES))
    parser.add_argument('--order', choices=tuple(ORDERS), action='append',
                        help='order of the objects; repeat it for more (default: searched; '
                        'of compare: all)')
    parser.add_argument('--objects', type=int, default=200,
                        help='goals in the flat (default: 200)')
    parser.add_argument('--seed', type=int, default=0, help='of the flat (default: 0)')
    parser.add_argument('--out', type=Path, default=Path('out/tidy'), help='folder of the rows')
    parser.add_argument('--workers', type=int, help='processes (default: one per core)')
    parser.add_argument('--stored', action='store_true',
                        help='run nothing: table the rows that are in the folder')
    parser.add_argument('--report', action='store_true', help=f'write the table to {REPORT}')
    options = parser.parse_args(arguments)
    table, errors = flat_part(options) if options.part == 'flat' else rooms_part(options)
    for error in errors:
        print(error, file=sys.stderr)
    print(table)
    if options.report:
        words = sys.argv[1:] if arguments is None else arguments
        write_part(options.part, ' '.join(word for word in words
                                          if word not in ('--report', '--stored')), table)
    return int(bool(errors))


def flat_part(options: argparse.Namespace) -> tuple[str, list[str]]:
    """Run the flat; return its table, and no errors."""
    count = 0 if options.stored else options.objects
    rows = run_flat(options.seed, count, options.out / 'flat', progress_bar('flat'))
    return flat_table(rows), []


def rooms_part(options: argparse.Namespace) -> tuple[str, list[str]]:
    """Run a part that has many rooms; return its table, and errors."""
    is_simulated = options.part != 'orders'
    orders = options.order or (list(ORDERS) if options.part == 'compare' else [SEARCHED])
    jobs = [Job(count, index, order) for index in range(options.rooms)
            for count in ([BLOCKED] if options.part == 'doors' else options.sizes)
            for order in orders]
    function = room_row if is_simulated else order_row
    folder = options.out / FOLDERS[options.part]
    if options.stored:
        jobs = stored_jobs(function, jobs, folder)
    rows = run_many(function, jobs, folder=folder, workers=options.workers,
                    block=1, progress=progress_bar(options.part))
    measured = [row for row in rows if ERROR not in row]
    table = room_table(measured, list(ORDERS)) if is_simulated else order_table(measured)
    return table, [row[ERROR] for row in rows if ERROR in row]
