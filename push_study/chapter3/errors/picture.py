"""Pictures of the errors at the goal over what the plan did not know."""

import math

import numpy as np
from push_study.chapter3.errors.played_push import FELT, ROBOTS, worst
from push_study.framework import paper

SHARE, MILLI = 100.0, 1000.0
MARKS = ('o', 's', '^')
LABEL = 'position error at the goal [mm]'


def draw(figure, table, kind, label, values):
    """
    Draw the errors of the point at all speeds, and of all robots at one.

    :param figure: matplotlib figure.
    :param table: of ``plan_errors.error_table``.
    :param kind: of the errors that are drawn.
    :param label: of the axis along which they are.
    :param values: ``Values`` with ``plan_errors.PARAMETERS``.
    """
    left, right = figure.subplots(1, 2)
    for number, speed in enumerate(values.speeds):
        _curve(left, table, number, f'{speed:g} m/s', kind, FELT, speed)
    left.set_ylim(bottom=0.0)
    left.set_title('point that feels how the object lies', loc='left')
    right.set_yscale('log')
    for number, robot in enumerate(ROBOTS):
        _curve(right, table, number, robot if robot != FELT else 'point that feels the object',
               kind, robot, values.blind_speed)
    right.axhline(MILLI * worst(table, [0.0]), color=paper.GREY, linewidth=0.8, zorder=1,
                  label='with the right belief, at most')
    right.set_title(f'all robots at {values.blind_speed:g} m/s', loc='left')
    for axes in (left, right):
        axes.set_xlabel(label)
        axes.set_ylabel(LABEL)
        axes.set_xlim(1.05 * SHARE * min(values.errors), 1.05 * SHARE * max(values.errors))
        low, high = axes.get_ylim()
        # Room for the legend.
        axes.set_ylim(low, high * math.sqrt(high / low) if axes is right else 1.3 * high)
        axes.legend(loc='upper center', ncols=3 if axes is left else 1, handlelength=2.8,
                    columnspacing=1.0)


def _curve(axes, table, number, label, kind, robot, speed):
    rows = ((table['kind'] == kind) & (table['robot'] == robot) & (table['speed_m_s'] == speed))
    errors, held = table['error'][rows], table['friction_usage'][rows] <= 1.0
    if not held.all():
        label += ', as far as it does not slide' if held.sum() > 1 else ': slides'
    if axes.get_yscale() == 'log':
        held = held & (errors != 0.0)
    size = np.where(held, MILLI * table['position_error_m'][rows], np.nan)
    axes.plot(SHARE * errors, size, marker=MARKS[number], markersize=6.5 - 1.5 * number,
              label=label, **paper.series(number))
