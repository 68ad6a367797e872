"""Point robot: the planned push and its input, and what few constant pushing angles cost."""

import numpy as np
from push_planner.single_push.planner import plan_push
from push_planner.verification.verification import verify
from push_study.chapter2.corner_push.scene import nested
from push_study.chapter3.scene import (
    draw_center, draw_inputs, draw_outlines, draw_push, input_table, path_table, poses_at,
    push_problem, SCENE, SEGMENTS, SPEED,
)
from push_study.framework.scenes import box
from push_study.framework.study import Finding, Outcome, Parameter, Study

OUTLINES, PUSH = 7, 0.16


def compute(values, batch):
    """
    Plan one push.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    found = plan_push(push_problem(values, values.speed, values.segments))
    check, inputs = verify(found), input_table(found)
    way = float(inputs['end_m'][-1])
    return Outcome({'path': path_table(found.trajectory), 'inputs': inputs}, {
        'duration': Finding(found.trajectory.duration, 's', 'time that the push takes'),
        'way': Finding(way, 'm', 'way of the contact'),
        'detour': Finding(100.0 * (found.report['over_displacement_bound'] - 1.0), '%',
                          'time above that of the straight displacement of the contact'),
        'first': Finding(float(inputs['rho_rad'][0]), 'rad', 'first pushing angle'),
        'last': Finding(float(inputs['rho_rad'][-1]), 'rad', 'last pushing angle'),
        'miss': Finding(check.position_error, 'm', 'distance from the goal, integrated anew'),
        'turn_miss': Finding(check.heading_error, 'rad', 'turn from the goal, integrated anew')})


def compute_counts(values, batch):
    """
    Plan the same push in several numbers of constant pushing angles.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    tables, ways, paths = {}, [], []
    for count in values.counts:
        found = plan_push(push_problem(values, values.speed, count))
        tables[f'path_{count}'] = path_table(found.trajectory)
        tables[f'inputs_{count}'] = input_table(found)
        ways.append(float(found.segment_ends[-1]))
        paths.append(np.column_stack([tables[f'path_{count}'][name] for name in ('x_m', 'y_m')]))
    durations = np.array(ways) / values.speed
    lost = 100.0 * (durations / durations[-1] - 1.0)
    apart = [float(np.hypot(*(path - paths[-1]).T).max()) for path in paths]
    tables['durations'] = {'segments': values.counts, 'duration_s': durations,
                           'above_most_percent': lost, 'path_from_most_m': apart}
    return Outcome(tables, {
        'falls': Finding(float((np.diff(durations) <= 0.0).all()), '',
                         'whether more segments never take longer'),
        'lost_fewest': Finding(float(lost[0]), '%', 'time lost with the fewest segments, to the '
                               'most'),
        'lost_six': Finding(float(np.interp(6.0, values.counts, lost)), '%',
                            'time lost with 6 segments, to the most'),
        'apart': Finding(100.0 * apart[0], 'cm', 'greatest distance of the way of the middle with '
                         'the fewest segments from that with the most')})


def draw(figure, outcome, values):
    """
    Draw the way of the box, and its input.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    above, below = figure.subplots(2, 1, height_ratios=(2.3, 1.0))
    path, inputs = outcome.tables['path'], outcome.tables['inputs']
    draw_outlines(above, box(values), poses_at(path, np.linspace(0.0, path['time_s'][-1],
                                                                 OUTLINES)))
    draw_center(above, path, color='#0B2A6B')
    for begin, angle in zip(inputs['begin_s'], inputs['rho_rad']):
        draw_push(above, path, begin, angle, PUSH)
    draw_inputs(below, inputs, 's', color='#0B2A6B')
    below.set_xlim(0.0, path['time_s'][-1])


def draw_counts(figure, outcome, values):
    """
    Draw ways, inputs and lost times.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    panels = figure.subplot_mosaic('AA;BC', height_ratios=(1.2, 1.0), width_ratios=(1.7, 1.0))
    ways, inputs, lost = panels['A'], panels['B'], panels['C']
    paths = [outcome.tables[f'path_{count}'] for count in values.counts]
    draw_outlines(ways, box(values), poses_at(paths[-1], paths[-1]['time_s'][[0, -1]]))
    for number, count in enumerate(values.counts):
        look = nested(number, len(values.counts), 1.1)
        draw_center(ways, paths[number], label=f'{count} segments', **look)
        draw_inputs(inputs, outcome.tables[f'inputs_{count}'],
                    **{**look, 'linewidth': 2.4 - 0.3 * number, 'linestyle': '-'})
    ways.legend(loc='center left', bbox_to_anchor=(1.0, 0.5))
    table = outcome.tables['durations']
    lost.plot(table['segments'][:-1], table['above_most_percent'][:-1], 'o-', color='#0B2A6B')
    lost.set_xscale('log')
    lost.set_yscale('log')
    lost.set_xticks(values.counts[:-1], [str(count) for count in values.counts[:-1]])
    lost.minorticks_off()
    lost.set_xlabel('segments')
    lost.set_ylabel('time lost [%]')


STUDIES = (
    Study('3.3', 'Point robot: trajectory of the object and input', (*SCENE, SPEED, SEGMENTS),
          compute, draw,
          'The box is at its goal after {duration:.2f} s: a push to the right of the normal, at '
          '{first:.2f} rad, swings it round to the left, and the angle then goes step by step to '
          '{last:.2f} rad.',
          'What turns the box to the left also carries its middle to the right at first, so that '
          'the contact goes {way:.2f} m, {detour:.1f}% more than its straight displacement.',
          (6.4, 5.6)),
    Study('3.4', 'Point robot: trajectories and inputs for several numbers of segments',
          (*SCENE, SPEED, Parameter('counts', '', 'numbers of constant pushing angles')),
          compute_counts, draw_counts,
          'However coarse the input, the middle of the box goes nearly the same way, within '
          '{apart:.0f} cm; two segments take {lost_fewest:.2f}% more time than the most, six '
          '{lost_six:.2f}%.',
          'Two angles and the length of the push are as many numbers as a goal pose has; more '
          'angles only approach the smooth best course, each doubling by a smaller gain.',
          (6.4, 5.2)))
