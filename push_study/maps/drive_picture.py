"""Picture of the curvatures that can be steered: round the outline, and along it."""

import math

import numpy as np
from push_model.contact import normal_range
from push_model.friction import friction_center
from push_model.parameters import Contact
from push_scenario.plots.drawing import outline
from push_study.framework import paper

SIDES = (('left_per_m', 1.0, 'to the left', paper.series(0)),
         ('right_per_m', -1.0, 'to the right', paper.series(1)))
# Sharper turns are on the spot, for all that matters.
SHARPEST = 8.0
ROOM = 0.7


def draw(obj, figure, outcome, values):
    """
    Draw the limits outward from the outline, and along it.

    :param obj: the ``PushedObject``.
    :param figure: matplotlib figure.
    :param outcome: of ``drive_map.compute``.
    :param values: its ``Values``.
    """
    table = outcome.tables['contacts']
    top = 1.1 * min(SHARPEST, max(np.nanmax(np.abs(table[name]), initial=0.5)
                                  for name, *_ in SIDES))
    around, along = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _draw_around(around, obj, table, top)
    _draw_along(along, table, top)
    along.legend(loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=3)


def _draw_around(axes, obj, table, top):
    rim = outline(obj, (0.0, 0.0, 0.0))
    size = float(np.ptp(rim, axis=0).max())
    points, away = np.transpose([table['x_m'], table['y_m']]), _outward(obj, table)
    axes.fill(*rim.T, facecolor='#F2F2F2', edgecolor=paper.INK, linewidth=1.0)
    for name, side, _, style in SIDES:
        reach = np.minimum(side * table[name], top) / top * 0.5 * ROOM * size
        reach = paper.split_where(reach > 0.0, reach)
        ends = points + reach[:, None] * away
        for rows in _stretches(table):
            axes.plot(*ends[rows].T, **style)
        for i in np.flatnonzero(np.equal(table['kind'], 'vertex')):
            shift = 0.012 * side * size * np.array([-away[i][1], away[i][0]])
            axes.plot(*np.transpose([points[i] + shift, ends[i] + shift]), **style)
    axes.plot(*friction_center(obj), marker='+', color=paper.INK, markersize=8.0)
    low, high = rim.min(axis=0), rim.max(axis=0)
    unit = 0.5 * ROOM * size / top * _round_number(0.5 * top)
    x, y = low[0], low[1] - 0.5 * (ROOM + 0.12) * size
    axes.plot([x, x + unit], [y, y], color=paper.INK, linewidth=2.5)
    axes.annotate(f'{_round_number(0.5 * top):g} 1/m', (x + unit, y), (4, 0),
                  textcoords='offset points', va='center', fontsize=8.0)
    half = 0.5 * size * (1.0 + ROOM) + 0.12 * size
    for setter, middle in zip((axes.set_xlim, axes.set_ylim), 0.5 * (low + high)):
        setter(middle - half, middle + half)
    axes.set_aspect('equal')
    axes.grid(False)
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')
    clipped = max(np.nanmax(side * table[name], initial=0.0) for name, side, *_ in SIDES) > top
    axes.set_title('limit outward from the outline'
                   + (f', up to {top:.2g} 1/m' if clipped else ''))


def _draw_along(axes, table, top):
    axes.axhline(0.0, color=paper.GREY, linewidth=0.8)
    corner = np.equal(table['kind'], 'vertex')
    for rows in _stretches(table):
        axes.fill_between(table['along_m'][rows], table['right_per_m'][rows],
                          table['left_per_m'][rows], color=paper.LIGHT, linewidth=0.0)
    for name, _, label, style in SIDES:
        for number, rows in enumerate(_stretches(table)):
            axes.plot(table['along_m'][rows], table[name][rows],
                      label='_' if number else f'sharpest {label}', **style)
    if corner.any():
        ends = (np.clip(table[name][corner], -2.0 * top, 2.0 * top) for name, *_ in SIDES)
        axes.vlines(table['along_m'][corner], *ends, color=paper.INK, linewidth=2.0)
        for name, _, _, style in SIDES:
            axes.plot(table['along_m'][corner], table[name][corner], 'D', markersize=4.5,
                      color=style['color'])
        axes.plot([], [], 'D-', color=paper.INK, markersize=4.5, label='at a vertex')
    axes.set_ylim(-top, top)
    axes.set_xlabel('way along the outline from vertex 0, counter-clockwise [m]')
    axes.set_ylabel('curvature of the path [1/m], left above 0')


def _stretches(table):
    """Rows of each face, or of a round outline."""
    kinds, indices = np.array(table['kind']), np.array(table['index'])
    for index in np.unique(indices):
        rows = np.flatnonzero((kinds != 'vertex') & (indices == index))
        if len(rows):
            yield rows


def _outward(obj, table):
    offsets = table.get('offset_m', table.get('offset_rad'))
    middles = [0.5 * sum(normal_range(obj, Contact(*fields)))
               for fields in zip(table['kind'], table['index'], offsets)]
    return -np.transpose([np.cos(middles), np.sin(middles)])


def _round_number(value):
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value)
