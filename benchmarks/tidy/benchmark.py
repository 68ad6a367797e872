"""
Rooms with several objects, beside an order that takes the nearest object first.

``orders`` plans orders alone, ``rooms`` and ``doors`` simulate all pushes. Rows are kept in a
folder, so that a run that was interrupted goes on where it stopped.
"""

import argparse
from collections.abc import Sequence
import dataclasses
from pathlib import Path
import sys
import time

from benchmarks.tidy.doors import draw_door
from benchmarks.tidy.report import BLOCKED, order_table, REPORT, room_table, write_part
from benchmarks.tidy.rooms import draw_room, SIDES
import numpy as np
from push_model.geometry import distance
from push_planner.rearrangement.order import MAX_WORK, plan_order
from push_planner.rearrangement.problem import Move, OrderPlan, Rearrangement
from push_scenario.evaluation.result_row import Row
from push_scenario.parallel import ERROR, progress_bar, run_many
from push_scenario.tidying.room import Room
from push_scenario.tidying.tidy import tidy
from push_tidy.tidy_supervisor import OrderPlanner


@dataclasses.dataclass(frozen=True)
class Job:
    """
    One room.

    :param count: of objects; ``BLOCKED`` for two rooms with a blocked door.
    :param index: of the room.
    :param order: ``searched`` or ``nearest``.
    """

    count: int
    index: int
    order: str = 'searched'

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

ORDERS: dict[str, OrderPlanner] = {'searched': plan_order, 'nearest': nearest_first}


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
    """Put a room in order."""
    result = tidy(job.draw(), find_order=ORDERS[job.order])
    return {**dataclasses.asdict(job), 'objects': len(result.poses),
            'placed': sum(map(result.is_placed, result.poses)),
            'moves': len(result.moves), 'touches': result.touches,
            'deep_touches': sum(gap < -DEEP for gap in result.touch_gaps),
            'duration': result.duration,
            'failed_moves': sum(item.run.outcome.value != 'done' for item in result.moves),
            'reasons': '; '.join(f'{name}: {report}'
                                 for name, report in result.failures.items())}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark; see ``--help``."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.tidy', description=__doc__)
    parser.add_argument('part', choices=('orders', 'rooms', 'doors'), help='what to measure')
    parser.add_argument('--rooms', type=int, default=25, help='rooms of each size (default: 25)')
    parser.add_argument('--sizes', type=int, nargs='+', choices=tuple(SIDES), default=list(SIDES))
    parser.add_argument('--order', choices=tuple(ORDERS), action='append',
                        help='order of the objects; repeat it to compare (default: both)')
    parser.add_argument('--out', type=Path, default=Path('out/tidy'), help='folder of the rows')
    parser.add_argument('--workers', type=int, help='processes (default: one per core)')
    parser.add_argument('--report', action='store_true', help=f'write the table to {REPORT}')
    options = parser.parse_args(arguments)
    is_simulated = options.part != 'orders'
    orders = options.order or list(ORDERS) if is_simulated else ['searched']
    jobs = [Job(count, index, order) for index in range(options.rooms)
            for count in ([BLOCKED] if options.part == 'doors' else options.sizes)
            for order in orders]
    function = room_row if is_simulated else order_row
    rows = run_many(function, jobs, folder=options.out / options.part, workers=options.workers,
                    block=1, progress=progress_bar(options.part))
    errors = [row for row in rows if ERROR in row]
    for row in errors:
        print(row[ERROR], file=sys.stderr)
    measured = [row for row in rows if ERROR not in row]
    table = room_table(measured, list(ORDERS)) if is_simulated else order_table(measured)
    print(table)
    if options.report:
        words = sys.argv[1:] if arguments is None else arguments
        write_part(options.part, ' '.join(word for word in words if word != '--report'), table)
    return int(bool(errors))
