"""Random friction at the four support points: open loop against feedback."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
import numpy as np
from push_model.geometry import Pose
from studies.chapter3.setup import draw_center, draw_outlines, GOAL, POSE_COLUMNS
from studies.chapter4.repeated_push import (
    COLUMNS, CONFIDENCE, median_findings, median_interval, repeat, RepeatedPush,
)
from studies.chapter4.setup import (
    draw_angle, ExecutedPush, FEEDBACK, LABELS, Law, MPC, OBJECT_FRAME, OPEN_LOOP, push, SETUP,
    STYLES, total_variation,
)
from studies.chapter4.support_friction import draw_coefficients, friction_table
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

PUSH = (*SETUP, GOAL,
        Parameter('deviation', '', 'standard deviation of the friction of each support point, '
                  'over its nominal value'),
        Parameter('period', 's', 'time between draws'))
PARAMETERS = (*PUSH, Parameter('seeds', '', 'number of pushes, each with draws of its own'))
# By panel: (a) the optimiser's plan, (b) feedback.
PANELS: tuple[tuple[Law, Law], tuple[Law, Law]] = ((OPEN_LOOP, OBJECT_FRAME), (FEEDBACK, MPC))
LAWS: tuple[Law, ...] = (*PANELS[0], *PANELS[1])
CENTIMETRES = 100.0
# Chosen: beyond this ratio of the greatest to the least distance, only powers of ten are labelled.
LABELLED_RANGE = 3000.0


def first_pushes(values: Values) -> dict[Law, ExecutedPush]:
    """
    Push under all laws with the first draws.

    :param values: with the parameters ``PUSH``.
    :return: law -> push.
    """
    changes = RepeatedPush.of_gaussian(values).friction(0)
    return {law: push(values, values.goal, law, changes) for law in LAWS}


def compute_first(values: Values, _: RunJobs) -> Outcome:
    """Push once under every law, with the same draws for all."""
    pushes = first_pushes(values)
    friction = friction_table(values, RepeatedPush.of_gaussian(values).friction(0),
                              max(executed.duration for executed in pushes.values()))
    tables: dict[str, Table] = {law: executed.path for law, executed in pushes.items()}
    return Outcome({**tables, 'friction': friction}, {
        'deviation': Finding(values.deviation, '', 'standard deviation of the friction'),
        'shift': Finding(CENTIMETRES * float(friction['center_y_m'].std()), 'cm', 'standard '
                         'deviation of the centre of friction to the side'),
        'new_paths': Finding(float(tables[FEEDBACK]['new_paths'][-1]), '',
                             'new paths that feedback has drawn'),
        **{f'variation_{law}': Finding(total_variation(executed.path), 'rad', 'total variation of '
                                       f'the pushing angle, {LABELS[law]}')
           for law, executed in pushes.items()}})


def compute_all(values: Values, run_jobs: RunJobs) -> Outcome:
    """Push many times under every law, with the same draws for all."""
    ends = repeat(RepeatedPush.of_gaussian(values), LAWS, int(values.seeds), run_jobs)
    errors = {law: CENTIMETRES * ends[f'{law}_{COLUMNS[0]}'] for law in LAWS}
    findings = {'pushes': Finding(float(values.seeds), '', 'number of pushes under each law')}
    for law in LAWS:
        findings.update(median_findings(law, errors[law], 'cm',
                                        f'median distance from the goal, {LABELS[law]}'))
        findings[f'worst_{law}'] = Finding(float(errors[law].max()), 'cm', 'largest')
        headings = np.abs(ends[f'{law}_{COLUMNS[1]}'])
        findings[f'heading_{law}'] = Finding(float(np.median(headings)), 'rad',
                                             'median magnitude of the heading error')
    findings['wins'] = Finding(
        float((errors[FEEDBACK] < np.minimum(errors[OPEN_LOOP], errors[OBJECT_FRAME])).sum()), '',
        'pushes in which feedback ends nearer to the goal than open loop in either frame')
    tables: dict[str, Table] = {law: executed.path
                                for law, executed in first_pushes(values).items()}
    return Outcome({**tables, 'ends': ends}, findings)


def draw_input(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the pushing angles in the first push."""
    above, below = figure.subplots(2, 1, sharex=True, sharey=True)
    for axes, laws in ((above, PANELS[1]), (below, PANELS[0])):
        for law in laws:
            draw_angle(axes, outcome.tables[law], 'time_s', law)
        axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))
        axes.label_outer()
    mark_new_paths(above, outcome.tables[FEEDBACK])
    above.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))


def mark_new_paths(axes: Axes, path: Table) -> None:
    """
    Mark when feedback has drawn a new path.

    :param axes: over time.
    :param path: table of an ``ExecutedPush``.
    """
    times = path['time_s'][1:][np.diff(path['new_paths']) > 0]
    axes.plot(times, np.full(len(times), 0.03), '^', color=plot_style.INK, markersize=4.5,
              transform=axes.get_xaxis_transform(), zorder=4.0, label='new path')


def draw_paths(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the first path of the middle, one panel for each kind of law, and all ends."""
    # Figures of their own, so that the labels of one do not narrow the other.
    above, below = figure.subfigures(2, 1, height_ratios=(1.1, 1.0))
    panels = above.subplots(1, 2, sharey=True)
    for letter, axes, laws, title in zip('ab', panels, PANELS, ('optimiser, open loop',
                                                                'feedback')):
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        for law in laws:
            path = outcome.tables[law]
            draw_center(axes, path, label=LABELS[law], **STYLES[law])
            end = Pose(*(path[name][-1] for name in POSE_COLUMNS))
            axes.fill(*zip(*map(end.transform, box(values).outline)), facecolor='none',
                      zorder=2.0, edgecolor=STYLES[law]['color'], linewidth=1.2)
        axes.set_title(f'({letter}) {title}', loc='left')
        axes.set_xlim(-0.3, values.goal[0] + 0.4)
        axes.set_ylim(-0.6, values.goal[1] + 1.0)
        axes.legend(loc='upper left')
        axes.label_outer()
    draw_ends(below.subplots(), outcome.tables['ends'], LAWS)


def draw_ends(axes: Axes, table: Table, laws: tuple[Law, ...]) -> None:
    """
    Draw how far from the goal all pushes end, one row for each law.

    :param axes: to draw on.
    :param table: of ``repeat``.
    :param laws: from the top to the bottom.
    """
    confidences: list[float] = []
    for row, law in enumerate(reversed(laws)):
        errors = CENTIMETRES * table[f'{law}_{COLUMNS[0]}']
        median, low, high, confidence = median_interval(errors)
        confidences.append(min(confidence, CONFIDENCE))
        color = STYLES[law]['color']
        axes.plot(errors, np.full(len(errors), row - 0.12), 'o', color=color, fillstyle='none',
                  markersize=3.5, markeredgewidth=0.8)
        axes.plot([low, high], [row + 0.25, row + 0.25], color=color, linewidth=2.5)
        axes.plot(median, row + 0.25, 'D', color=color, markersize=5.0)
    axes.set_yticks(range(len(laws)), [LABELS[law] for law in reversed(laws)])
    axes.set_ylim(-0.5, len(laws) - 0.4)
    axes.set_xscale('log')
    low, high = axes.get_xlim()
    subs = (1.0, 2.0, 5.0) if high < LABELLED_RANGE * low else (1.0,)
    axes.xaxis.set_major_locator(LogLocator(subs=subs))
    axes.xaxis.set_major_formatter('{x:g}')
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel('distance from the goal [cm]; bars: median and its '
                    f'{100.0 * min(confidences):.3g} % interval')


STUDIES = (
    Study('4.5', 'Gaussian friction at the four support points: coefficients over time',
          PUSH, compute_first, draw_coefficients,
          'The friction of each support point is random, with a standard deviation of '
          '{deviation:.0%}.',
          'Each sample moves the centre of friction by {shift:.1f} cm (standard deviation); '
          'neither planner nor controller is informed.'),
    Study('4.6', 'Gaussian friction at the four support points: input', PUSH, compute_first,
          draw_input,
          'The pushing angle of feedback varies by {variation_feedback:.1f} rad in total (mpc: '
          '{variation_mpc:.1f} rad), in open loop in the frame of the object by '
          '{variation_object_frame:.1f} rad.',
          'Feedback replaces its path {new_paths:.0f} times (triangles); turns of new paths are '
          'spikes.',
          (7.4, 4.4)),
    Study('4.7', 'Gaussian friction at the four support points: trajectories', PARAMETERS,
          compute_all, draw_paths,
          'Of {pushes:.0f} pushes feedback ends nearer to the goal in {wins:.0f}. Median '
          'distances (95% interval): feedback {feedback:.1f} cm ({feedback_low:.1f} to '
          '{feedback_high:.1f}), mpc {mpc:.1f} cm ({mpc_low:.1f} to {mpc_high:.1f}), open loop in '
          'the world {open_loop:.0f} cm ({open_loop_low:.0f} to {open_loop_high:.0f}), in the '
          'frame of the object {object_frame:.0f} cm ({object_frame_low:.0f} to '
          '{object_frame_high:.0f}).',
          'Random rotations grow in the world; feedback stops them.',
          (7.0, 5.6)))
