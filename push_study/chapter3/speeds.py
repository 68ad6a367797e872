"""Point robot: the push to the same goal at several speeds."""

import math

import numpy as np
from push_planner.single_push.planner import plan_push
from push_study.chapter2.corner_push.scene import nested
from push_study.chapter3.scene import (
    draw_center, draw_inputs, draw_outlines, input_table, path_table, poses_at, push_problem,
    SCENE, SEGMENTS,
)
from push_study.framework import paper
from push_study.framework.scenes import box
from push_study.framework.study import Finding, Outcome, Parameter, Study


def compute(values, batch):
    """
    Plan the push at each speed.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    tables, plans = {}, [plan_push(push_problem(values, speed, values.segments))
                         for speed in values.speeds]
    for speed, found in zip(values.speeds, plans):
        tables[f'path_{speed:g}'] = path_table(found.trajectory)
        tables[f'inputs_{speed:g}'] = input_table(found)
    ways = np.array([found.segment_ends[-1] for found in plans])
    angles = [tables[f'inputs_{speed:g}']['rho_rad'] for speed in values.speeds]
    apart = [_apart(tables[f'path_{speed:g}'], tables[f'path_{values.speeds[0]:g}'])
             for speed in values.speeds]
    tables['ways'] = {'speed_m_s': values.speeds, 'way_m': ways,
                      'duration_s': ways / np.array(values.speeds), 'path_from_slowest_m': apart}
    return Outcome(tables, {
        'slowest': Finding(float(ways[0] / values.speeds[0]), 's', 'time at the lowest speed'),
        'fastest': Finding(float(ways[-1] / values.speeds[-1]), 's', 'time at the highest speed'),
        'way_growth': Finding(100.0 * float(ways[-1] / ways[0] - 1.0), '%', 'longer way of the '
                              'contact at the highest speed than at the lowest'),
        'apart': Finding(100.0 * apart[-1], 'cm', 'greatest distance of the ways of the middle at '
                         'the highest and the lowest speed'),
        'angle_middle': Finding(_furthest(angles[len(angles) // 2], angles[0]), 'rad', 'greatest '
                                'difference of the input at the middle speed from that at the '
                                'lowest'),
        'angle_fastest': Finding(_furthest(angles[-1], angles[0]), 'rad', 'the same at the '
                                 'highest speed')})


def _furthest(angles, others):
    return float(np.abs(angles - others).max())


def _apart(path, other):
    """Greatest distance of two ways, at the same part of their time [m]."""
    return max(math.hypot(*step) for step in zip(path['x_m'] - other['x_m'],
                                                 path['y_m'] - other['y_m']))


def draw(figure, outcome, values):
    """
    Draw ways and inputs.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    above, below = figure.subplots(2, 1, height_ratios=(1.6, 1.0))
    slowest = outcome.tables[f'path_{values.speeds[0]:g}']
    draw_outlines(above, box(values), poses_at(slowest, slowest['time_s'][[0, -1]]))
    for number, speed in enumerate(values.speeds):
        look = nested(number, len(values.speeds), 1.4)
        inputs = outcome.tables[f'inputs_{speed:g}']
        draw_center(above, outcome.tables[f'path_{speed:g}'], label=f'{speed:g} m/s, '
                    f'{inputs["end_s"][-1]:.1f} s', **look)
        draw_inputs(below, inputs, **{**paper.series(number), 'linewidth': look['linewidth']})
    above.legend(loc='upper left')


STUDIES = (Study(
    '3.5', 'Point robot: the same goal at several speeds',
    (*SCENE, SEGMENTS, Parameter('speeds', 'm/s', 'speeds of the contact', [0.05, 0.25, 0.5])),
    compute, draw,
    'From the lowest to the highest speed the way of the contact grows by {way_growth:.1f}%, so '
    'that time goes nearly as one over the speed, from {slowest:.1f} to {fastest:.1f} s; the '
    'inputs at the two lower speeds differ by {angle_middle:.2f} rad, that at the highest by '
    '{angle_fastest:.2f} rad.',
    'A slow push is one of friction alone, in which speed plays no part; inertia, which grows '
    'with its square, makes the box slower to turn, and it takes larger angles for the same way, '
    'to within {apart:.0f} cm.', (6.4, 5.2)),)
