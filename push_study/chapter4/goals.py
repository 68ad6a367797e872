"""Open loop and feedback where friction is nominal."""

import numpy as np
from push_model.geometry import FloatArray
from push_study.chapter3.setup import GOAL
from push_study.chapter4.goals_figure import draw_goals, draw_input, draw_path
from push_study.chapter4.setup import (
    FEEDBACK, LABELS, Law, LAWS, OPEN_LOOP, planned_input, push, SETUP,
)
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: inputs are compared from this distance on, after the soft start [m], and at so many
# points.
SKIPPED_DISTANCE = 0.1
COMPARED_POINTS = 400
MILLIMETRES = 1000.0
PERCENT = 100.0


def compute_goals(values: Values, _: RunJobs) -> Outcome:
    """Push to each goal under both laws."""
    tables: dict[str, Table] = {}
    rows: list[list[float]] = []
    for number, goal in enumerate(values.goals, 1):
        pushes = [push(values, goal, law) for law in LAWS]
        tables.update({f'{law}_{number}': executed.path for law, executed in zip(LAWS, pushes)})
        rows.append([number, pushes[0].planned.duration])
        for executed in pushes:
            rows[-1] += [executed.position_error, executed.heading_error, executed.duration]
    names = [f'{law}_{column}' for law in LAWS
             for column in ('position_error_m', 'heading_error_rad', 'duration_s')]
    tables['ends'] = table = dict(zip(['goal', 'planned_s', *names], np.array(rows).T))
    times = [table[f'{law}_duration_s'] / table['planned_s'] for law in LAWS]
    return Outcome(tables, {
        'goals': Finding(len(values.goals), '', 'number of goals'),
        'open_loop': _largest_error(table, OPEN_LOOP),
        'feedback': _largest_error(table, FEEDBACK),
        'delay': Finding(PERCENT * float(np.max(times) - 1.0), '%',
                         'largest duration above that of the plan'),
        'difference': Finding(PERCENT * float(np.abs(times[1] - times[0]).max()), '%',
                              'largest difference of both durations, over that of the plan')})


def _largest_error(table: Table, law: Law) -> Finding:
    return Finding(MILLIMETRES * float(table[f'{law}_position_error_m'].max()), 'mm',
                   f'largest distance from the goal, {LABELS[law]}')


def compute(values: Values, _: RunJobs) -> Outcome:
    """Push to one goal under both laws."""
    pushes = {law: push(values, values.goal, law) for law in LAWS}
    feedback, open_loop = pushes[FEEDBACK], pushes[OPEN_LOOP]
    planned = planned_input(feedback.planned)
    span = float(np.ptp(planned['rho_rad']))
    differences = {law: input_difference(executed.path, planned)
                   for law, executed in pushes.items()}
    tables = {**{law: executed.path for law, executed in pushes.items()}, 'planned': planned}
    relative = differences[FEEDBACK] / span if span else np.nan
    return Outcome(tables, {
        'open_loop': Finding(MILLIMETRES * open_loop.position_error, 'mm',
                             'distance from the goal, open loop'),
        'feedback': Finding(MILLIMETRES * feedback.position_error, 'mm',
                            'distance from the goal, feedback'),
        'span': Finding(span, 'rad', 'range of the planned pushing angle'),
        'difference': Finding(differences[FEEDBACK], 'rad', 'root mean square difference of the '
                              'pushing angle of feedback from the planned one over the distance, '
                              f'from {SKIPPED_DISTANCE:g} m on'),
        'difference_open_loop': Finding(differences[OPEN_LOOP], 'rad', 'the same, open loop'),
        'relative_difference': Finding(PERCENT * relative, '%',
                                       'that of feedback over the range'),
        'early': Finding(PERCENT * _early_fraction(feedback.path, planned), '%', 'fraction of its '
                         'mean square within the first quarter of the distance'),
        'distance': Finding(float(feedback.path['distance_m'][-1]), 'm',
                            'distance travelled by the contact, feedback'),
        'delay': Finding(PERCENT * float(feedback.duration / planned['time_s'][-1] - 1.0), '%',
                         'duration of feedback above that of the plan')})


def input_difference(path: Table, planned: Table) -> float:
    """
    Compute the root mean square difference of a pushing angle from the planned one.

    :param path: table of an ``ExecutedPush``.
    :param planned: table of ``planned_input``.
    :return: difference over the distance travelled by the contact [rad].
    """
    return float(np.sqrt(np.mean(_differences(path, planned) ** 2)))


def _early_fraction(path: Table, planned: Table) -> float:
    squares = _differences(path, planned) ** 2
    return float(squares[:len(squares) // 4].sum() / squares.sum())


def _differences(path: Table, planned: Table) -> FloatArray:
    """Subtract the planned from the executed pushing angle, at even distances [rad]."""
    touching = np.isfinite(path['rho_rad'])
    end = min(path['distance_m'][-1], planned['distance_m'][-1])
    distances = np.linspace(min(SKIPPED_DISTANCE, 0.5 * end), end, COMPARED_POINTS)
    return (np.interp(distances, path['distance_m'][touching], path['rho_rad'][touching])
            - np.interp(distances, planned['distance_m'], planned['rho_rad']))


PARAMETERS = (*SETUP, GOAL)
STUDIES = (
    Study('4.1', 'Control action by optimiser and by feedback law: a box that rotates', PARAMETERS,
          compute, draw_input,
          'The pushing angle of feedback stays within {difference:.2f} rad (root mean square) of '
          'the planned one, which is {relative_difference:.0f}% of its range of {span:.1f} rad.',
          'Feedback computes the angle from the curvature of the planned path and from friction '
          'alone, and so reproduces the optimal input without optimization; both slow down '
          'before the goal and arrive {delay:.0f}% later than planned.'),
    Study('4.2', 'Control action by optimiser and by feedback law: a box that is moved aside',
          PARAMETERS, compute, draw_input,
          'The input spans {span:.1f} rad, and feedback stays within {difference:.2f} rad (root '
          'mean square) of it, {relative_difference:.0f}%.',
          'It does so without optimization, from the planned path and the friction alone; most of '
          'the difference lies within the first quarter of the distance.'),
    Study('4.3', 'Object trajectory by (a) optimiser and (b) feedback law: a box that rotates',
          PARAMETERS, compute, draw_path,
          'Arrows are pushes; feedback ends {feedback:.0f} mm from the goal, the optimal input in '
          'open loop {open_loop:.0f} mm.',
          'With a correct model there is almost nothing to correct along the {distance:.2f} m of '
          'the contact, and the two paths coincide.', (6.4, 5.2)),
    Study('4.4', 'Object trajectory by (a) optimiser and (b) feedback law: a box that is moved '
          'aside', PARAMETERS, compute, draw_path,
          'To move to the right and end rotated to the left, the box first turns right; feedback '
          'ends {feedback:.0f} mm from the goal, the open loop {open_loop:.0f} mm.',
          'A box that is pushed from behind steers like a car and takes two opposite bends, over '
          'which the contact travels {distance:.1f} m.', (6.4, 4.6)),
    Study('four-goals', 'Open loop and feedback: four goals',
          (*SETUP, Parameter('goals', 'm, m, rad', 'goal poses (x, y, theta)')),
          compute_goals, draw_goals,
          'With a correct model both move the box to each of the {goals:.0f} goals: the plan '
          'executed in open loop misses by up to {open_loop:.0f} mm, feedback by up to '
          '{feedback:.0f} mm.',
          'Both follow the same plan; they start and stop gently and take up to {delay:.0f}% '
          'longer than planned.', (7.2, 5.0)))
