"""Figure of the curvatures that can be steered: round the outline, and along it."""

import math
from typing import Any, Iterator, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray
from push_model.contact import normal_range
from push_model.friction import friction_center
from push_model.geometry import FloatArray
from push_model.parameters import Contact, PushedObject
from push_scenario.plots.drawing import outline
from push_study.framework import plot_style
from push_study.framework.parameters import Values
from push_study.framework.study import Outcome, Table


class Side(NamedTuple):
    """
    Limit to one side.

    :param column: of the table.
    :param sign: of its curvatures.
    :param label: for the legend.
    :param style: of its curve.
    """

    column: str
    sign: float
    label: str
    style: dict[str, Any]


SIDES = (Side('left_per_m', 1.0, 'sharpest to the left', plot_style.series(0)),
         Side('right_per_m', -1.0, 'sharpest to the right', plot_style.series(1)))
# Chosen: sharper turns count as turns on the spot [1/m].
MAX_DRAWN_CURVATURE = 8.0
# Chosen: space for the limits round the outline, relative to its size.
MARGIN = 0.7


def draw(obj: PushedObject, figure: Figure, outcome: Outcome, _: Values) -> None:
    """
    Draw the limits outward from the outline, and along it.

    :param obj: the object.
    :param figure: matplotlib figure.
    :param outcome: of ``drive_map``.
    """
    table = outcome.tables['contacts']
    sharpest = max(np.nanmax(np.abs(table[side.column]), initial=0.5) for side in SIDES)
    top = 1.1 * min(MAX_DRAWN_CURVATURE, sharpest)
    around, along = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _draw_around(around, obj, table, top)
    _draw_along(along, table, top)
    along.legend(loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=3)


def _draw_around(axes: Axes, obj: PushedObject, table: Table, top: float) -> None:
    """Draw the limits outward from the outline, at a scale where ``top`` fills the margin."""
    rim = outline(obj, (0.0, 0.0, 0.0))
    size = float(np.ptp(rim, axis=0).max())
    metres_per_curvature = 0.5 * MARGIN * size / top
    axes.fill(*rim.T, facecolor=plot_style.OBJECT_FILL, edgecolor=plot_style.INK, linewidth=1.0)
    for side in SIDES:
        _draw_limit_around(axes, obj, table, side, metres_per_curvature, top)
    axes.plot(*friction_center(obj), marker='+', color=plot_style.INK, markersize=8.0)
    low, high = rim.min(axis=0), rim.max(axis=0)
    _draw_scale(axes, (low[0], low[1] - 0.5 * (MARGIN + 0.12) * size), metres_per_curvature,
                _round_down(0.5 * top))
    half = 0.5 * size * (1.0 + MARGIN) + 0.12 * size
    middle_x, middle_y = 0.5 * (low + high)
    axes.set_xlim(middle_x - half, middle_x + half)
    axes.set_ylim(middle_y - half, middle_y + half)
    axes.set_aspect('equal')
    axes.grid(False)
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')
    sharpest = max(np.nanmax(side.sign * table[side.column], initial=0.0) for side in SIDES)
    axes.set_title('limit outward from the outline'
                   + (f', up to {top:.2g} 1/m' if sharpest > top else ''))


def _draw_limit_around(axes: Axes, obj: PushedObject, table: Table, side: Side,
                       metres_per_curvature: float, top: float) -> None:
    points, outward = np.transpose([table['x_m'], table['y_m']]), _outward_normals(obj, table)
    length = metres_per_curvature * np.minimum(side.sign * table[side.column], top)
    length = plot_style.split_where(length > 0.0, length)
    ends = points + length[:, None] * outward
    for rows in _sections(table):
        axes.plot(*ends[rows].T, **side.style)
    # Both sides of a vertex beside one another.
    gap = 0.012 * side.sign * float(np.ptp(outline(obj, (0.0, 0.0, 0.0)), axis=0).max())
    for i in np.flatnonzero(np.equal(table['kind'], 'vertex')):
        shift = gap * np.array([-outward[i][1], outward[i][0]])
        axes.plot(*np.transpose([points[i] + shift, ends[i] + shift]), **side.style)


def _draw_scale(axes: Axes, start: tuple[float, float], metres_per_curvature: float,
                curvature: float) -> None:
    x, y = start
    end = x + metres_per_curvature * curvature
    axes.plot([x, end], [y, y], color=plot_style.INK, linewidth=2.5)
    axes.annotate(f'{curvature:g} 1/m', (end, y), (4, 0), textcoords='offset points',
                  va='center', fontsize=8.0)


def _draw_along(axes: Axes, table: Table, top: float) -> None:
    """Draw the limits over the arc length, those of vertices as vertical lines."""
    axes.axhline(0.0, color=plot_style.GREY, linewidth=0.8)
    along, at_vertex = table['along_m'], np.equal(table['kind'], 'vertex')
    for rows in _sections(table):
        axes.fill_between(along[rows], table['right_per_m'][rows], table['left_per_m'][rows],
                          color=plot_style.LIGHT, linewidth=0.0)
    for side in SIDES:
        for number, rows in enumerate(_sections(table)):
            axes.plot(along[rows], table[side.column][rows],
                      label='_' if number else side.label, **side.style)
    if at_vertex.any():
        ends = (np.clip(table[side.column][at_vertex], -2.0 * top, 2.0 * top) for side in SIDES)
        axes.vlines(along[at_vertex], *ends, color=plot_style.INK, linewidth=2.0)
        for side in SIDES:
            axes.plot(along[at_vertex], table[side.column][at_vertex], 'D', markersize=4.5,
                      color=side.style['color'])
        axes.plot([], [], 'D-', color=plot_style.INK, markersize=4.5, label='at a vertex')
    axes.set_ylim(-top, top)
    axes.set_xlabel('arc length along the outline from vertex 0, counter-clockwise [m]')
    axes.set_ylabel('curvature of the path [1/m], left above 0')


def _sections(table: Table) -> Iterator[NDArray[np.intp]]:
    """Yield the rows of each face, or of a round outline."""
    kinds, indices = np.array(table['kind']), np.array(table['index'])
    for index in np.unique(indices):
        rows = np.flatnonzero((kinds != 'vertex') & (indices == index))
        if len(rows):
            yield rows


def _outward_normals(obj: PushedObject, table: Table) -> FloatArray:
    """Compute unit vectors away from the object, at a vertex in the middle, shape (n, 2)."""
    offsets = table['offset_m' if obj.outline else 'offset_rad']
    inward = [0.5 * sum(normal_range(obj, Contact(*fields)))
              for fields in zip(table['kind'], table['index'], offsets)]
    return -np.transpose([np.cos(inward), np.sin(inward)])


def _round_down(value: float) -> float:
    """Round down to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value)
