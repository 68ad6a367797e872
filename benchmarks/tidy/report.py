"""Tables of the benchmark, and the page with them."""

from collections.abc import Sequence
from pathlib import Path

from benchmarks.report_template import fill_template, updated_page
from benchmarks.tidy.rooms import SIDES
import numpy as np
from push_scenario.evaluation.result_row import Row

# In place of a number of objects.
BLOCKED = 0
# Orders: that of the search, the nearest object first, and each object with no other in the room.
SEARCHED, NEAREST, ALONE = 'searched', 'nearest', 'alone'
REPORT = Path('docs/reports/tidy.md')
TEMPLATE = Path(__file__).with_name('tidy.md.in')
NOT_MEASURED = 'not measured'


def order_table(rows: Sequence[Row]) -> str:
    """Write the table of orders."""
    lines = ['| objects | rooms | all in the order | temporary places | first answer, '
             'CPU, median / most | best: time over that of the first, median |',
             '| --- | --- | --- | --- | --- | --- |']
    for count in SIDES:
        of_count = [row for row in rows if row.get('count') == count]
        if of_count:
            cpu = [row['first_cpu'] for row in of_count]
            ratio = np.median([row['best_time'] / row['first_time'] for row in of_count
                               if row['first_time'] > 0.0])
            lines.append(
                f'| {count} | {len(of_count)} | {sum(not row["refused"] for row in of_count)} | '
                f'{sum(row["temporary"] for row in of_count)} | {np.median(cpu):.2f} / '
                f'{max(cpu):.2f} s | {ratio:.2f} |')
    return '\n'.join(lines)


def room_table(rows: Sequence[Row], orders: Sequence[str]) -> str:
    """
    Write the table of rooms, and below it why objects are not at their goals.

    :param orders: how objects may be ordered.
    """
    compared = [order for order in (NEAREST, ALONE) if any(row['order'] == order for row in rows)]
    lines = ['| objects, order | rooms in order | objects | touches, beyond 5 mm | moves | '
             'time, median |' + ''.join(f' over {order} |' for order in compared),
             '| --- | --- | --- | --- | --- | --- |' + ' --- |' * len(compared)]
    for count, order in ((count, order) for count in (*SIDES, BLOCKED) for order in orders):
        some = [row for row in rows if (row.get('count'), row.get('order')) == (count, order)]
        if some:
            lines.append(
                f'| {count or "blocked door"}, {order} | '
                f'{sum(row["placed"] == row["objects"] for row in some)} of '
                f'{len(some)} | {sum(row["placed"] for row in some)} of '
                f'{sum(row["objects"] for row in some)} | '
                f'{sum(row["touches"] for row in some)}, '
                f'{sum(row["deep_touches"] for row in some)} | '
                f'{sum(row["moves"] for row in some)} | '
                f'{np.median([row["duration"] for row in some]):.0f} s |'
                + ''.join(f' {_time_over(order, some, rows)} |' for order in compared))
    reasons = [f'* {_kind(row)} {row["index"]}, {row["order"]}: {row["reasons"]}.'
               for row in rows if row['placed'] < row['objects']]
    return '\n'.join([*lines, *([''] if reasons else []), *reasons])


def _time_over(order: str, some: Sequence[Row], rows: Sequence[Row]) -> str:
    """Compare times with those of another order, in rooms that both put in order: the median."""
    times = {(row.get('count'), row.get('index')): row['duration'] for row in rows
             if row.get('order') == order and row['placed'] == row['objects']}
    ratios = [row['duration'] / times[row['count'], row['index']] for row in some
              if row['placed'] == row['objects'] and (row['count'], row['index']) in times]
    return f'{np.median(ratios):.2f} ({len(ratios)})' if ratios else '-'


def _kind(row: Row) -> str:
    return f'room of {row["count"]} objects,' if row['count'] != BLOCKED else 'blocked door'


def write_part(part: str, options: str, table: str) -> None:
    """
    Write a table to the report; other tables stay.

    :param part: which was measured.
    :param options: of the command.
    """
    measured = {part: table, f'{part} options': options}

    def value_of(name: str) -> str:
        return measured.get(name, NOT_MEASURED)
    page = fill_template(
        TEMPLATE, ORDERS=value_of('orders'), ORDERSOPTIONS=value_of('orders options'),
        ROOMS=value_of('rooms'), ROOMSOPTIONS=value_of('rooms options'),
        COMPARED=value_of('compare'), COMPAREDOPTIONS=value_of('compare options'),
        FLAT=value_of('flat'), FLATOPTIONS=value_of('flat options'),
        DOORS=value_of('doors'), DOORSOPTIONS=value_of('doors options'))
    previous = REPORT.read_text(encoding='utf-8') if REPORT.is_file() else ''
    REPORT.write_text(updated_page(TEMPLATE, page, previous,
                                   lambda _, value: value == NOT_MEASURED), encoding='utf-8')
