"""Steady yaw rate of the box pushed at a corner, over where its support points are."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
import numpy as np
from push_model.parameters import PushedObject
from studies.chapter2.corner_push.setup import (
    draw_rates, MAX_SPEED, push_direction, pushed_box, relative_range, SHAPE, speed_samples,
    steady_yaw_rates,
)
from studies.framework import plot_style
from studies.framework.box import FRICTION, MASS
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

EVEN_SPACING = (-0.8, -0.4, 0.0, 0.4, 0.8)
# Positions as fractions of half the sides; the box is pushed at (-1, -1). Chosen, so that the
# support points lie across the push, ahead and behind, further in, evenly, or on three points.
PATTERNS = {
    'across': ((-0.2, -0.2), (1.0, -1.0), (0.2, 0.2), (-1.0, 1.0)),
    'inner': ((-0.4, -0.4), (0.4, -0.4), (0.4, 0.4), (-0.4, 0.4)),
    'even': tuple((x, y) for x in EVEN_SPACING for y in EVEN_SPACING),
    'sides': ((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)),
    'three': ((1.0, 1.0), (-1.0, 0.2), (0.2, -1.0)),
    'corners': ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))}


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute steady yaw rates over the speed for each pattern."""
    direction, speeds = push_direction(values), speed_samples(values)
    curves = np.array([steady_yaw_rates(_box(values, name), direction, speeds)
                       for name in values.patterns])
    findings = {
        'slow_spread': Finding(relative_range(curves[:, :1]), '', 'largest relative difference '
                               f'between the curves at {speeds[0]:g} m/s'),
        'spread': Finding(relative_range(curves), '', 'the same at any speed'),
        'fast_spread': Finding(relative_range(curves[:, -1:]), '',
                               f'the same at {speeds[-1]:g} m/s')}
    columns = {f'{name}_rad_s': curve for name, curve in zip(values.patterns, curves)}
    return Outcome({'steady': {'speed_m_s': speeds, **columns}}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the curves, and beside them an icon of each pattern."""
    speeds, *curves = outcome.tables['steady'].values()
    grid = figure.add_gridspec(len(curves), 2, width_ratios=(5.0, 1.0))
    draw_rates(figure.add_subplot(grid[:, 0]), speeds, curves, values.patterns, step=0.0)
    for index, name in enumerate(values.patterns):
        _draw_icon(figure.add_subplot(grid[index, 1]), _box(values, name), index, name,
                   push_direction(values))


def _draw_icon(axes: Axes, obj: PushedObject, index: int, name: str, direction: float) -> None:
    style, half_side = plot_style.series(index), abs(obj.outline[0][0])
    axes.fill(*zip(*obj.outline), facecolor='none', edgecolor=plot_style.GREY, linewidth=0.8)
    axes.plot([support.x for support in obj.supports], [support.y for support in obj.supports],
              'o', color=style['color'], markersize=3.2 if len(obj.supports) < 9 else 1.6)
    tip_x, tip_y = obj.outline[0]
    length = 1.1 * half_side
    tail = tip_x - length * math.cos(direction), tip_y - length * math.sin(direction)
    axes.annotate('', (tip_x, tip_y), tail,
                  arrowprops={'arrowstyle': '-|>', 'color': plot_style.INK, 'linewidth': 1.0,
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 7.0})
    axes.add_line(Line2D([1.6 * half_side, 4.2 * half_side], [0.35 * half_side] * 2, **style))
    axes.text(1.6 * half_side, -0.2 * half_side, name, va='top', fontsize=8.0)
    axes.set(aspect='equal', xlim=(-2.1 * half_side, 4.3 * half_side),
             ylim=(-1.5 * half_side, 1.15 * half_side))
    axes.axis('off')


def _box(values: Values, name: str) -> PushedObject:
    if name not in PATTERNS:
        raise ValueError(f'patterns: got {name!r}, expected some of {", ".join(PATTERNS)}')
    return pushed_box(values, values.mass, values.friction_coefficient,
                      support_pattern=PATTERNS[name])


STUDIES = (Study(
    '2.26', 'Box pushed at a corner: steady yaw rate and support pattern',
    (*SHAPE, MASS, FRICTION, MAX_SPEED,
     Parameter('patterns', '', 'support patterns, as drawn beside the curves')), compute, draw,
    'Support points near the line across the push let the box rotate fastest; the rates differ by '
    '{slow_spread:.0%} in slow pushes, by {fast_spread:.0%} in the fastest.',
    'Points far ahead or behind are dragged sideways.'),)
