"""Friction at the four supports that is random: optimiser against feedback."""

import numpy as np
from push_model.geometry import Pose
from push_study.chapter3.scene import draw_center, draw_outlines, GOAL
from push_study.chapter4.floor import draw_friction, friction_table, gaussian
from push_study.chapter4.scene import (
    draw_angle, FEEDBACK, LABELS, LAWS, LOOKS, OPTIMISER, push, SCENE,
)
from push_study.framework.scenes import box
from push_study.framework.study import Finding, Outcome, Parameter, Study

PARAMETERS = (*SCENE, GOAL,
              Parameter('deviation', '', 'standard deviation of the friction of each support, '
                        'over what is believed'),
              Parameter('period', 's', 'time after which it is drawn anew'),
              Parameter('seeds', '', 'number of pushes, each with draws of its own'))
LASTING, CENTI = 60.0, 100.0


def compute(values, batch):
    """
    Push under both laws, with the same draws for both.

    :param values: ``Values`` with ``PARAMETERS``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    tables, pushes, centers = {}, {law: [] for law in LAWS}, []
    for seed in range(int(values.seeds)):
        changes = gaussian(seed, values.deviation, values.period, LASTING)
        for law in LAWS:
            pushes[law].append(push(values, values.goal, law, changes))
            tables[f'{law}_{seed}'] = pushes[law][-1].path
        tables[f'friction_{seed}'] = friction_table(
            values, changes, max(pushes[law][-1].duration for law in LAWS))
        centers.append(tables[f'friction_{seed}']['center_y_m'])
    errors = {law: np.array([one.position_error for one in pushes[law]]) for law in LAWS}
    turns = {law: np.array([one.heading_error for one in pushes[law]]) for law in LAWS}
    tables['ends'] = {'seed': np.arange(int(values.seeds)),
                      **{f'{law}_position_error_m': errors[law] for law in LAWS},
                      **{f'{law}_heading_error_rad': turns[law] for law in LAWS}}
    found = {name: Finding(CENTI * float(np.median(errors[law])), 'cm',
                           f'median distance from the goal, {LABELS[law]}')
             for name, law in (('optimiser', OPTIMISER), ('feedback', FEEDBACK))}
    swing = {law: np.mean([_travel(one.path['rho_rad']) for one in pushes[law]])
             for law in LAWS}
    return Outcome(tables, {
        **found,
        'worst': Finding(CENTI * float(errors[FEEDBACK].max()), 'cm',
                         'largest distance from the goal, feedback'),
        'worst_optimiser': Finding(CENTI * float(errors[OPTIMISER].max()), 'cm',
                                   'the same, optimiser'),
        'wins': Finding(float((errors[FEEDBACK] < errors[OPTIMISER]).sum()), '',
                        'pushes in which feedback ends nearer to the goal'),
        'pushes': Finding(float(values.seeds), '', 'number of pushes'),
        'turn': Finding(float(np.median(np.abs(turns[OPTIMISER]))), 'rad',
                        'median turn from the goal, optimiser'),
        'turn_feedback': Finding(float(np.median(np.abs(turns[FEEDBACK]))), 'rad',
                                 'the same, feedback'),
        'shift': Finding(CENTI * float(np.concatenate(centers).std()), 'cm', 'standard deviation '
                         'of the friction centre to the side'),
        'swing': Finding(float(swing[FEEDBACK]), 'rad', 'mean of how far the pushing angle goes '
                         'to and fro in all, feedback'),
        'swing_optimiser': Finding(float(swing[OPTIMISER]), 'rad', 'the same, optimiser')})


def _travel(angles):
    return np.abs(np.diff(angles[np.isfinite(angles)])).sum()


def draw_input(figure, outcome, values):
    """
    Draw the friction of the supports and the pushing angles of the first push.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    *sides, below = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 1.0, 1.6))
    for axes, side in zip(sides, ('left', 'right')):
        draw_friction(axes, outcome.tables['friction_0'], (f'front_{side}', f'rear_{side}'),
                      (1.4, 1.4))
        axes.set_ylabel('friction')
    for law in (FEEDBACK, OPTIMISER):
        draw_angle(below, outcome.tables[f'{law}_0'], 'time_s', law)
    below.legend(loc='center left', bbox_to_anchor=(1.0, 0.5))


def draw_ways(figure, outcome, values):
    """
    Draw the ways of the middle, and how far from the goal they end.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    ways, misses = figure.subplots(2, 1, height_ratios=(2.4, 1.0))
    draw_outlines(ways, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
    for law in (OPTIMISER, FEEDBACK):
        for seed in range(int(values.seeds)):
            draw_center(ways, outcome.tables[f'{law}_{seed}'],
                        label=LABELS[law] if seed == 0 else None,
                        **{**LOOKS[law], 'linewidth': 1.8 if seed == 0 else 0.8})
    ways.legend(loc='upper left')
    table = outcome.tables['ends']
    for row, (law, mark) in enumerate(((OPTIMISER, 's'), (FEEDBACK, 'o'))):
        errors = CENTI * table[f'{law}_position_error_m']
        misses.plot(errors, np.full(len(errors), row), mark, color=LOOKS[law]['color'],
                    fillstyle='none')
        misses.plot(2 * [np.median(errors)], [row - 0.3, row + 0.3], color=LOOKS[law]['color'])
    misses.set_yticks([0, 1], [LABELS[OPTIMISER], LABELS[FEEDBACK]])
    misses.set_ylim(-0.6, 1.6)
    misses.set_xlim(left=0.0)
    misses.set_xlabel('distance from the goal [cm]; bars: median')


STUDIES = (
    Study('4.6', 'Gaussian friction at the four supports: input', PARAMETERS, compute, draw_input,
          'Friction of each support is drawn anew again and again; feedback answers with pushing '
          'angles that go to and fro, by {swing:.0f} rad in all, while that of the '
          'optimiser only drifts as the box turns, by {swing_optimiser:.0f} rad.',
          'Each draw moves the friction centre to a side, by {shift:.1f} cm (standard deviation), '
          'and the box begins to turn to that side; the robot of the optimiser does not see it.',
          (6.4, 5.6)),
    Study('4.7', 'Gaussian friction at the four supports: trajectories', PARAMETERS, compute,
          draw_ways,
          'Of {pushes:.0f} pushes (the first is drawn bold), feedback ends nearer to the goal in '
          '{wins:.0f}; the median distance is {feedback:.0f} cm with feedback and {optimiser:.0f} '
          'cm without looking.',
          'Turns that chance has begun grow under a robot that does not see them; feedback stops '
          'them, but cannot know of the draws of the last stretch before the goal.', (6.4, 5.0)))
