"""Steady turning rate of the box pushed at a corner, over where its supports stand."""

import math

from matplotlib.lines import Line2D
import numpy as np
from push_study.chapter2.corner_push.scene import (
    draw_rates, drawn_speeds, FRICTION, MASS, push_direction, pushed_box, SHAPE, spread,
    steady_rates, TOP_SPEED,
)
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study

EVEN = (-0.8, -0.4, 0.0, 0.4, 0.8)
# Places as shares of half the sides; the box is pushed at (-1, -1).
PATTERNS = {
    'across': ((-0.2, -0.2), (1.0, -1.0), (0.2, 0.2), (-1.0, 1.0)),
    'inner': ((-0.4, -0.4), (0.4, -0.4), (0.4, 0.4), (-0.4, 0.4)),
    'even': tuple((x, y) for x in EVEN for y in EVEN),
    'sides': ((-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)),
    'three': ((1.0, 1.0), (-1.0, 0.2), (0.2, -1.0)),
    'corners': ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))}


def compute(values, batch):
    """
    Steady turning rates over the speed, for each pattern.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    :raises ValueError: for a pattern that is not known.
    """
    direction, speeds = push_direction(values), drawn_speeds(values)
    curves = np.array([steady_rates(_box(values, name), direction, speeds)
                       for name in values.patterns])
    findings = {
        'slow_spread': Finding(spread(curves[:, :1]), '', 'largest relative distance of the '
                               f'curves at {speeds[0]:g} m/s'),
        'spread': Finding(spread(curves), '', 'the same at any speed'),
        'fast_spread': Finding(spread(curves[:, -1:]), '', f'the same at {speeds[-1]:g} m/s')}
    return Outcome({'steady': {'speed_m_s': speeds, **{
        f'{name}_rad_s': curve for name, curve in zip(values.patterns, curves)}}}, findings)


def draw(figure, outcome, values):
    """
    Draw the curves, and beside them a small picture of each pattern.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    speeds, *curves = outcome.tables['steady'].values()
    grid = figure.add_gridspec(len(curves), 2, width_ratios=(5.0, 1.0))
    axes = figure.add_subplot(grid[:, 0])
    draw_rates(axes, speeds, curves, values.patterns, 0.0)
    for number, name in enumerate(values.patterns):
        _draw_icon(figure.add_subplot(grid[number, 1]), _box(values, name), number, name,
                   push_direction(values))


def _draw_icon(axes, obj, number, name, direction):
    look, side = paper.series(number), abs(obj.outline[0][0])
    axes.fill(*zip(*obj.outline), facecolor='none', edgecolor=paper.GREY, linewidth=0.8)
    axes.plot([foot.x for foot in obj.supports], [foot.y for foot in obj.supports], 'o',
              color=look['color'], markersize=3.2 if len(obj.supports) < 9 else 1.6)
    tip = np.array(obj.outline[0])
    axes.annotate('', tip, tip - 1.1 * side * np.array([math.cos(direction), math.sin(direction)]),
                  arrowprops={'arrowstyle': '-|>', 'color': paper.INK, 'linewidth': 1.0,
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 7.0})
    axes.add_line(Line2D([1.6 * side, 4.2 * side], [0.35 * side] * 2, **look))
    axes.text(1.6 * side, -0.2 * side, name, va='top', fontsize=8.0)
    axes.set(aspect='equal', xlim=(-2.1 * side, 4.3 * side),
             ylim=(-1.5 * side, 1.15 * side))
    axes.axis('off')


def _box(values, name):
    if name not in PATTERNS:
        raise ValueError(f'patterns: got {name!r}, expected some of {", ".join(PATTERNS)}')
    return pushed_box(values, values.mass, values.friction_coefficient, feet=PATTERNS[name])


STUDIES = (Study(
    '2.26', 'Box pushed at a corner: steady turning rate and support pattern',
    (*SHAPE, MASS, FRICTION, TOP_SPEED,
     Parameter('patterns', '', 'support patterns, as drawn beside the curves')), compute, draw,
    'Feet near the line across the push through the middle let the box turn fastest, feet far '
    'ahead and behind slowest: the rates differ by {slow_spread:.0%} in slow pushes and by '
    '{fast_spread:.0%} in the fastest.',
    'Feet ahead of and behind the middle are dragged sideways when the box turns and so brake the '
    'turn, but at high speed it is mostly the inertia force that does.'),)
