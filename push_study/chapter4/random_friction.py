"""Random friction at the four support points: open loop against feedback."""

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_study.chapter3.setup import draw_center, draw_outlines, GOAL, POSE_COLUMNS
from push_study.chapter4.setup import (
    draw_angle, ExecutedPush, FEEDBACK, LABELS, Law, LAWS, OPEN_LOOP, push, SETUP, STYLES,
)
from push_study.chapter4.support_friction import draw_friction, friction_table, gaussian_friction
from push_study.framework.box import box
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table
from scipy.stats import binom

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
        **_median_interval(errors[FEEDBACK], 'feedback'),
        **_median_interval(errors[OPEN_LOOP], 'open_loop'),
        'deviation': Finding(values.deviation, '', 'standard deviation of the friction'),
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


def _median_interval(errors: FloatArray, name: str) -> dict[str, Finding]:
    """Bound the median distance from the goal by order statistics, at 95 %."""
    # Ranks between which a binomial variable with probability 1/2 lies.
    low, high = binom.interval(0.95, len(errors), 0.5)
    ranked = CENTIMETRES * np.sort(errors)
    return {f'{name}_low': Finding(float(ranked[max(0, int(low) - 1)]), 'cm',
                                   'lower end of its 95 % interval'),
            f'{name}_high': Finding(float(ranked[min(len(errors) - 1, int(high))]), 'cm',
                                    'upper end')}


def _total_variation(angles: FloatArray) -> float:
    """Sum up all changes of an angle, without the samples that are nan [rad]."""
    return np.abs(np.diff(angles[np.isfinite(angles)])).sum()


def draw_coefficients(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the friction of the support points in the first push."""
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    draw_friction(panels.ravel().tolist(), outcome.tables['friction_0'])


def draw_input(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the pushing angle of feedback in the first push, and where the force should lead."""
    axes = figure.subplots()
    draw_angle(axes, outcome.tables[f'{FEEDBACK}_0'], 'time_s', FEEDBACK)
    draw_angle(axes, outcome.tables[f'{OPEN_LOOP}_0'], 'time_s', OPEN_LOOP)
    axes.legend(loc='best')


def draw_paths(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the paths of the middle, one panel for each law, and how far off they end."""
    panels = figure.subplot_mosaic('ab;cc', height_ratios=(1.6, 1.0))
    for letter, law in zip('ab', LAWS):
        axes = panels[letter]
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        for seed in range(int(values.seeds)):
            path = outcome.tables[f'{law}_{seed}']
            draw_center(axes, path, **{**STYLES[law], 'linewidth': 0.5 if seed else 1.8})
        end = Pose(*(outcome.tables[f'{law}_0'][name][-1] for name in POSE_COLUMNS))
        axes.fill(*zip(*map(end.transform, box(values).outline)), facecolor='none', zorder=2.0,
                  edgecolor=STYLES[law]['color'], linewidth=1.2)
        axes.set_title(f'({letter}) {LABELS[law]}', loc='left')
        axes.set_xlim(-0.3, values.goal[0] + 0.4)
        axes.set_ylim(-0.6, values.goal[1] + 0.6)
    below, table = panels['c'], outcome.tables['ends']
    for row, (law, marker) in enumerate(zip(LAWS, 'so')):
        errors = CENTIMETRES * table[f'{law}_position_error_m']
        median, color = np.median(errors), STYLES[law]['color']
        below.plot(errors, np.full(len(errors), row), marker, color=color, fillstyle='none')
        below.plot([median, median], [row - 0.3, row + 0.3], color=color)
    below.set_yticks([0, 1], [LABELS[law] for law in LAWS])
    below.set_ylim(-0.6, 1.6)
    below.set_xscale('log')
    below.set_xlabel('distance from the goal [cm]; bars: median')


STUDIES = (
    Study('4.5', 'Gaussian friction at the four support points: coefficients over time',
          PARAMETERS, compute, draw_coefficients,
          'The friction of each support point is drawn again and again, with a standard deviation '
          'of {deviation:.0%} of its nominal value.',
          'Each draw moves the centre of friction to one side, by {shift:.1f} cm (standard '
          'deviation); neither planner nor controller is informed.'),
    Study('4.6', 'Gaussian friction at the four support points: input', PARAMETERS, compute,
          draw_input,
          'Feedback responds to the draws with pushing angles whose total variation is '
          '{variation:.0f} rad, while that of the open loop only drifts as the box rotates, by '
          '{variation_open_loop:.0f} rad.',
          'Each draw moves the centre of friction to one side, by {shift:.1f} cm (standard '
          'deviation), and the box begins to rotate to that side; the open loop does not observe '
          'it.', (6.4, 3.6)),
    Study('4.7', 'Gaussian friction at the four support points: trajectories', PARAMETERS,
          compute, draw_paths,
          'Of {pushes:.0f} pushes (the first is drawn bold), feedback ends nearer to the goal in '
          '{wins:.0f}; the median distance is {feedback:.1f} cm with feedback ({feedback_low:.1f} '
          'to {feedback_high:.1f}, 95% interval) and {open_loop:.0f} cm in open loop '
          '({open_loop_low:.0f} to {open_loop_high:.0f}).',
          'Rotations that begin by chance grow in open loop; feedback stops them, but cannot '
          'foresee the draws on the last part of the path before the goal.', (6.4, 5.0)))
