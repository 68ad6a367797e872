"""Figure of the errors at the goal over what the plan did not know."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from studies.chapter3.errors.mismatched_push import ROBOTS, SENSING_POINT, worst
from studies.framework import plot_style
from studies.framework.parameters import Values
from studies.framework.study import Table

PERCENT = 100.0
MILLIMETRES = 1000.0
MARKERS = ('o', 's', '^', 'D')
LABEL = 'position error at the goal [mm]'


def draw(figure: Figure, table: Table, kind: str, label: str, values: Values) -> None:
    """
    Draw the errors of the sensing point at all speeds, and of all robots at one.

    :param figure: matplotlib figure.
    :param table: of ``mismatched_push.error_table``.
    :param kind: of the errors that are drawn.
    :param label: of the abscissa.
    :param values: with the parameters ``mismatched_push.PARAMETERS``.
    """
    left, right = figure.subplots(1, 2)
    for index, speed in enumerate(values.speeds):
        _draw_curve(left, _select(table, kind, SENSING_POINT, speed), index, f'{speed:g} m/s')
    left.set_ylim(bottom=0.0)
    left.set_title('point that senses the contact normal', loc='left')
    right.set_yscale('log')
    for index, robot in enumerate(ROBOTS):
        _draw_curve(right, _select(table, kind, robot, values.open_loop_speed), index, robot)
    right.axhline(MILLIMETRES * worst(table, [0.0]), color=plot_style.GREY, linewidth=0.8,
                  zorder=1, label='without mismatch, at most')
    right.set_title(f'all robots at {values.open_loop_speed:g} m/s', loc='left')
    for axes in (left, right):
        axes.set_xlabel(label)
        axes.set_ylabel(LABEL)
        axes.set_xlim(1.05 * PERCENT * min(values.errors), 1.05 * PERCENT * max(values.errors))
    # The upper part is for the legends.
    left.set_ylim(top=1.3 * left.get_ylim()[1])
    left.legend(loc='upper center', ncols=3, handlelength=2.8, columnspacing=1.0)
    low, high = right.get_ylim()
    right.set_ylim(low, high * math.sqrt(high / low))
    right.legend(loc='upper center', ncols=1, handlelength=2.8, columnspacing=1.0)


def page_table(table: Table, values: Values) -> Table:
    """
    Write position and heading errors at the goal as a table for a page.

    :param table: of ``mismatched_push.error_table``, of one kind of errors.
    :param values: with the parameters ``mismatched_push.PARAMETERS``.
    :return: columns of texts, rows for the smallest and the largest errors.
    """
    kind = table['kind'][0]
    columns = [(SENSING_POINT, speed) for speed in values.speeds]
    columns += [(robot, values.open_loop_speed) for robot in ROBOTS[1:]]
    sizes = {abs(error) for error in values.errors}
    shown = min(sizes), max(sizes)
    result: Table = {'error': [f'{error:+.0%}' for error in sorted(values.errors)
                               if abs(error) in shown]}
    for robot, speed in columns:
        rows = _select(table, kind, robot, speed)
        cells = zip(rows['error'], rows['position_error_m'], rows['heading_error_rad'],
                    rows['friction_usage'])
        result[f'{robot}, {speed:g} m/s'] = [_cell(*cell) for error, *cell in cells
                                             if abs(error) in shown]
    return result


def _cell(position_error: float, heading_error: float, friction_usage: float) -> str:
    """Write both errors, and mark where the contact would slide."""
    mark = '*' if friction_usage > 1.0 else ''
    return f'{MILLIMETRES * position_error:.1f} mm, {math.degrees(heading_error):.2f}°{mark}'


def _select(table: Table, kind: str, robot: str, speed: float) -> Table:
    rows = (table['kind'] == kind) & (table['robot'] == robot) & (table['speed_m_s'] == speed)
    return {name: column[rows] for name, column in table.items()}


def _draw_curve(axes: Axes, table: Table, index: int, label: str) -> None:
    """Draw the errors of which the contact holds; the label says where it slides."""
    errors, holds = table['error'], table['friction_usage'] <= 1.0
    if not holds.all():
        label += ', while it does not slide' if holds.sum() > 1 else ': slides'
    if axes.get_yscale() == 'log':
        holds = holds & (errors != 0.0)
    size = np.where(holds, MILLIMETRES * table['position_error_m'], np.nan)
    axes.plot(PERCENT * errors, size, marker=MARKERS[index], markersize=6.5 - 1.5 * index,
              label=label, **plot_style.series(index))
