"""Random friction at the four support points: open loop against feedback."""

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_study.chapter3.setup import draw_center, draw_outlines, GOAL
from push_study.chapter4.setup import (
    draw_angle, ExecutedPush, FEEDBACK, LABELS, Law, LAWS, OPEN_LOOP, push, SETUP, STYLES,
)
from push_study.chapter4.support_friction import draw_friction, friction_table, gaussian_friction
from push_study.framework.box import box
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table

PARAMETERS = (*SETUP, GOAL,
              Parameter('deviation', '', 'standard deviation of the friction of each support '
                        'point, over its nominal value'),
              Parameter('period', 's', 'time between draws'),
              Parameter('seeds', '', 'number of pushes, each with draws of its own'))
# Chosen: longer than any of the pushes [s].
DURATION = 60.0
CENTIMETRES = 100.0


def compute(values: Values, _: RunJobs) -> Outcome:
    """Push under both laws, with the same draws for both."""
    tables: dict[str, Table] = {}
    pushes: dict[Law, list[ExecutedPush]] = {law: [] for law in LAWS}
    centers: list[FloatArray] = []
    for seed in range(int(values.seeds)):
        changes = gaussian_friction(seed, values.deviation, values.period, DURATION)
        for law in LAWS:
            pushes[law].append(push(values, values.goal, law, changes))
            tables[f'{law}_{seed}'] = pushes[law][-1].path
        friction = tables[f'friction_{seed}'] = friction_table(
            values, changes, max(pushes[law][-1].duration for law in LAWS))
        centers.append(friction['center_y_m'])
    errors = {law: np.array([executed.position_error for executed in pushes[law]])
              for law in LAWS}
    heading_errors = {law: np.array([executed.heading_error for executed in pushes[law]])
                      for law in LAWS}
    tables['ends'] = {'seed': np.arange(int(values.seeds)),
                      **{f'{law}_position_error_m': errors[law] for law in LAWS},
                      **{f'{law}_heading_error_rad': heading_errors[law] for law in LAWS}}
    variation = {law: np.mean([_total_variation(executed.path['rho_rad'])
                               for executed in pushes[law]]) for law in LAWS}
    return Outcome(tables, {
        'open_loop': Finding(CENTIMETRES * float(np.median(errors[OPEN_LOOP])), 'cm',
                             'median distance from the goal, open loop'),
        'feedback': Finding(CENTIMETRES * float(np.median(errors[FEEDBACK])), 'cm',
                            'median distance from the goal, feedback'),
        'worst': Finding(CENTIMETRES * float(errors[FEEDBACK].max()), 'cm',
                         'largest distance from the goal, feedback'),
        'worst_open_loop': Finding(CENTIMETRES * float(errors[OPEN_LOOP].max()), 'cm',
                                   'the same, open loop'),
        'wins': Finding(float((errors[FEEDBACK] < errors[OPEN_LOOP]).sum()), '',
                        'pushes in which feedback ends nearer to the goal'),
        'pushes': Finding(float(values.seeds), '', 'number of pushes'),
        'heading': Finding(float(np.median(np.abs(heading_errors[OPEN_LOOP]))), 'rad',
                           'median heading error at the goal, open loop'),
        'heading_feedback': Finding(float(np.median(np.abs(heading_errors[FEEDBACK]))), 'rad',
                                    'the same, feedback'),
        'shift': Finding(CENTIMETRES * float(np.concatenate(centers).std()), 'cm', 'standard '
                         'deviation of the centre of friction to the side'),
        'variation': Finding(float(variation[FEEDBACK]), 'rad', 'mean total variation of the '
                             'pushing angle, feedback'),
        'variation_open_loop': Finding(float(variation[OPEN_LOOP]), 'rad',
                                       'the same, open loop')})


def _total_variation(angles: FloatArray) -> float:
    """Sum up all changes of an angle, without the samples that are nan [rad]."""
    return np.abs(np.diff(angles[np.isfinite(angles)])).sum()


def draw_input(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the friction of the support points and the pushing angles of the first push."""
    *side_panels, below = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 1.0, 1.6))
    for axes, side in zip(side_panels, ('left', 'right')):
        draw_friction(axes, outcome.tables['friction_0'], (f'front_{side}', f'rear_{side}'),
                      (1.4, 1.4))
        axes.set_ylabel('friction')
    for law in (FEEDBACK, OPEN_LOOP):
        draw_angle(below, outcome.tables[f'{law}_0'], 'time_s', law)
    below.legend(loc='center left', bbox_to_anchor=(1.0, 0.5))


def draw_paths(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the paths of the middle, and how far from the goal they end."""
    above, below = figure.subplots(2, 1, height_ratios=(2.4, 1.0))
    draw_outlines(above, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
    for law in (OPEN_LOOP, FEEDBACK):
        for seed in range(int(values.seeds)):
            is_first = seed == 0
            draw_center(above, outcome.tables[f'{law}_{seed}'],
                        label=LABELS[law] if is_first else None,
                        **{**STYLES[law], 'linewidth': 1.8 if is_first else 0.8})
    above.legend(loc='upper left')
    table = outcome.tables['ends']
    for row, (law, marker) in enumerate(zip(LAWS, 'so')):
        errors = CENTIMETRES * table[f'{law}_position_error_m']
        median, color = np.median(errors), STYLES[law]['color']
        below.plot(errors, np.full(len(errors), row), marker, color=color, fillstyle='none')
        below.plot([median, median], [row - 0.3, row + 0.3], color=color)
    below.set_yticks([0, 1], [LABELS[law] for law in LAWS])
    below.set_ylim(-0.6, 1.6)
    below.set_xlim(left=0.0)
    below.set_xlabel('distance from the goal [cm]; bars: median')


STUDIES = (
    Study('4.6', 'Gaussian friction at the four support points: input', PARAMETERS, compute,
          draw_input,
          'The friction of each support point is drawn again and again; feedback responds with '
          'pushing angles whose total variation is {variation:.0f} rad, while that of the open '
          'loop only drifts as the box rotates, by {variation_open_loop:.0f} rad.',
          'Each draw moves the centre of friction to one side, by {shift:.1f} cm (standard '
          'deviation), and the box begins to rotate to that side; the open loop does not observe '
          'it.', (6.4, 5.6)),
    Study('4.7', 'Gaussian friction at the four support points: trajectories', PARAMETERS,
          compute, draw_paths,
          'Of {pushes:.0f} pushes (the first is drawn bold), feedback ends nearer to the goal in '
          '{wins:.0f}; the median distance is {feedback:.0f} cm with feedback and '
          '{open_loop:.0f} cm in open loop.',
          'Rotations that begin by chance grow in open loop; feedback stops them, but cannot '
          'foresee the draws on the last part of the path before the goal.', (6.4, 5.0)))
