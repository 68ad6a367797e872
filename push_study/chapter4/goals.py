"""The plan played without looking, and feedback, where friction is as believed."""

import numpy as np
from push_study.chapter3.scene import GOAL
from push_study.chapter4.goals_picture import draw_goals, draw_input, draw_way
from push_study.chapter4.scene import FEEDBACK, LABELS, LAWS, OPTIMISER, planned_input, push, SCENE
from push_study.framework.study import Finding, Outcome, Parameter, Study

SKIPPED, MILLI = 0.1, 1000.0


def compute_goals(values, batch):
    """
    Push to each goal under both laws.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    tables, rows = {}, []
    for number, goal in enumerate(values.goals, 1):
        pushes = [push(values, goal, law) for law in LAWS]
        tables.update({f'{law}_{number}': one.path for law, one in zip(LAWS, pushes)})
        rows.append([number, pushes[0].planned.duration] + [
            value for one in pushes for value in (one.position_error, one.heading_error,
                                                  one.duration)])
    names = [f'{law}_{what}' for law in LAWS for what in ('position_error_m', 'heading_error_rad',
                                                          'duration_s')]
    tables['ends'] = table = dict(zip(['goal', 'planned_s', *names], np.array(rows).T))
    times = [table[f'{law}_duration_s'] / table['planned_s'] for law in LAWS]
    return Outcome(tables, {
        'goals': Finding(len(values.goals), '', 'number of goals'),
        'optimiser': _largest(table, OPTIMISER), 'feedback': _largest(table, FEEDBACK),
        'time': Finding(100.0 * float(np.max(times) - 1.0), '%',
                        'largest time above that of the plan'),
        'apart': Finding(100.0 * float(np.abs(times[1] - times[0]).max()), '%',
                         'largest difference of the times of both, of that of the plan')})


def _largest(table, law):
    return Finding(MILLI * float(table[f'{law}_position_error_m'].max()), 'mm',
                   f'largest distance from the goal, {LABELS[law]}')


def compute(values, batch):
    """
    Push to one goal under both laws.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    pushes = {law: push(values, values.goal, law) for law in LAWS}
    planned = planned_input(pushes[FEEDBACK].planned)
    span = float(np.ptp(planned['rho_rad']))
    apart = {law: input_distance(one.path, planned) for law, one in pushes.items()}
    tables = {law: one.path for law, one in pushes.items()}
    return Outcome({**tables, 'planned': planned}, {
        'optimiser': Finding(MILLI * pushes[OPTIMISER].position_error, 'mm',
                             'distance from the goal, optimiser'),
        'feedback': Finding(MILLI * pushes[FEEDBACK].position_error, 'mm',
                            'distance from the goal, feedback'),
        'span': Finding(span, 'rad', 'range of the planned pushing angle'),
        'near': Finding(apart[FEEDBACK], 'rad', 'root mean square distance of the pushing angle '
                        'of feedback from the planned one over the way, from 0.1 m on'),
        'near_optimiser': Finding(apart[OPTIMISER], 'rad', 'the same of the optimiser'),
        'share': Finding(100.0 * apart[FEEDBACK] / span if span else np.nan, '%',
                         'that of feedback over the range'),
        'early': Finding(100.0 * _early(pushes[FEEDBACK].path, planned), '%', 'share of its mean '
                         'square within the first quarter of the way'),
        'way': Finding(float(pushes[FEEDBACK].path['way_m'][-1]), 'm',
                       'way of the contact, feedback'),
        'time': Finding(100.0 * float(pushes[FEEDBACK].duration / planned['time_s'][-1] - 1.0),
                        '%', 'time of feedback above that of the plan')})


def input_distance(path, planned):
    """
    Root mean square distance of a pushing angle from the planned one, over the way [rad].

    :param path: table of a ``Push``.
    :param planned: table of ``planned_input``.
    """
    return float(np.sqrt(np.mean(_apart(path, planned) ** 2)))


def _early(path, planned):
    squares = _apart(path, planned) ** 2
    return float(squares[:len(squares) // 4].sum() / squares.sum())


def _apart(path, planned):
    touching = np.isfinite(path['rho_rad'])
    end = min(path['way_m'][-1], planned['way_m'][-1])
    ways = np.linspace(min(SKIPPED, 0.5 * end), end, 400)
    return (np.interp(ways, path['way_m'][touching], path['rho_rad'][touching])
            - np.interp(ways, planned['way_m'], planned['rho_rad']))


ONE = (*SCENE, GOAL)
STUDIES = (
    Study('4.1', 'Optimiser and feedback: four goals',
          (*SCENE, Parameter('goals', 'm, m, rad', 'goal poses (x, y, theta)')),
          compute_goals, draw_goals,
          'Where all is as believed, both take the box to each of the {goals:.0f} goals: the plan '
          'played without looking misses by up to {optimiser:.0f} mm, feedback by up to '
          '{feedback:.0f} mm.',
          'Both follow the same plan; they set out and stop softly and take up to {time:.0f}% '
          'more time than it does.', (7.2, 5.0)),
    Study('4.2', 'Optimiser and feedback: trajectory of a box that turns', ONE, compute, draw_way,
          'Arrows are pushes of feedback; it ends {feedback:.0f} mm from the goal, and the plan '
          'played without looking {optimiser:.0f} mm.',
          'With the right belief there is next to nothing to correct along the {way:.2f} m of the '
          'contact, and the two ways cover each other.'),
    Study('4.3', 'Optimiser and feedback: input of the push of 4.2', ONE, compute, draw_input,
          'The pushing angle of feedback keeps to the planned one within {near:.2f} rad (root '
          'mean square), which is {share:.0f}% of its range of {span:.1f} rad.',
          'Feedback takes the angle from the curvature of the planned path and from friction '
          'alone, so that without optimising it gives what the optimiser gives; both slow down '
          'before the goal and arrive {time:.0f}% later than planned.'),
    Study('4.4', 'Optimiser and feedback: trajectory of a box that is moved aside', ONE, compute,
          draw_way,
          'To get to the right and end turned to the left, the box turns right first; feedback '
          'ends {feedback:.0f} mm from the goal, the plan played without looking {optimiser:.0f} '
          'mm.',
          'A box that is pushed from behind steers like a car and takes two opposite bends, '
          '{way:.1f} m of way for the contact.', (6.4, 3.6)),
    Study('4.5', 'Optimiser and feedback: input of the push of 4.4', ONE, compute, draw_input,
          'The input swings through {span:.1f} rad, and feedback keeps to it within {near:.2f} '
          'rad (root mean square), {share:.0f}% of that.',
          'It does so without optimising, from the planned path and the friction alone; most of '
          'the difference lies within the first quarter of the way.'))
