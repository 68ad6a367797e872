"""Pictures of pushes during a disturbance."""

import numpy as np
from push_model.geometry import Pose
from push_study.chapter3.scene import draw_center, draw_outlines, poses_at
from push_study.chapter4.floor import draw_friction
from push_study.chapter4.scene import draw_angle, FEEDBACK, LABELS, LAWS, LONGEST, LOOKS, OPTIMISER
from push_study.framework import paper
from push_study.framework.scenes import box

OUTLINES, CENTI = 8, 100.0


def draw_coefficients(figure, outcome, values):
    """
    Draw the friction of the supports, and where the friction centre is.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1.0))
    table = outcome.tables['friction']
    draw_friction(above, table)
    below.step(table['time_s'], CENTI * table['center_y_m'], where='post', color=paper.INK)
    below.set_ylabel('friction centre,\nto the left [cm]')
    below.set_xlabel('time [s]')


def draw_centers(figure, outcome, values):
    """
    Draw the ways of the middle.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
    end = values.begin + getattr(values, 'lasting', LONGEST)
    for law in (FEEDBACK, OPTIMISER):
        path = outcome.tables[law]
        rows = (path['time_s'] >= values.begin) & (path['time_s'] <= end)
        axes.plot(path['x_m'][rows], path['y_m'][rows], color=paper.LIGHT, linewidth=6.0,
                  solid_capstyle='butt', zorder=2.0,
                  label='disturbed' if law == OPTIMISER else None)
        draw_center(axes, path, label=LABELS[law], **LOOKS[law])
    axes.legend(loc='lower left', bbox_to_anchor=(0.0, 1.0), ncols=3)


def draw_objects(figure, outcome, values):
    """
    Draw the box on its way, one panel for each law.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for axes, law in zip(panels, LAWS):
        path, obj = outcome.tables[law], box(values)
        draw_outlines(axes, obj, [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        poses = poses_at(path, np.linspace(0.0, path['time_s'][-1], OUTLINES))
        for pose in poses[1:]:
            axes.fill(*zip(*map(pose.transform, obj.outline)), facecolor='none', zorder=2.0,
                      edgecolor=LOOKS[law]['color'], linewidth=1.6 if pose is poses[-1] else 0.7)
        draw_center(axes, path, **LOOKS[law])
        axes.set_title(LABELS[law], loc='left')
        axes.label_outer()


def draw_inputs(figure, outcome, values):
    """
    Draw the pushing angles over time.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    last = max(outcome.tables[law]['time_s'][-1] for law in LAWS)
    end = min(last, values.begin + getattr(values, 'lasting', LONGEST))
    axes.axvspan(values.begin, end, color=paper.LIGHT, alpha=0.6, linewidth=0.0,
                 label='disturbed')
    path = outcome.tables[FEEDBACK]
    axes.plot(path['time_s'], path['aim_rad'], color=paper.GREY, linewidth=1.0,
              label='towards the friction centre')
    for law in (FEEDBACK, OPTIMISER):
        draw_angle(axes, outcome.tables[law], 'time_s', law)
    axes.set_xlim(0.0, last)
    axes.legend(loc='best')
