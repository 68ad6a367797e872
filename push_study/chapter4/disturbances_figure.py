"""Figures of pushes during a disturbance."""

from typing import Callable

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from push_study.chapter3.setup import draw_center, draw_outlines, poses_at
from push_study.chapter4.setup import draw_angle, FEEDBACK, LABELS, LAWS, OPEN_LOOP, STYLES
from push_study.chapter4.support_friction import draw_friction
from push_study.framework import plot_style
from push_study.framework.box import box
from push_study.framework.parameters import Values
from push_study.framework.study import Outcome

# Chosen: poses at which the box is drawn.
OUTLINES = 8
CENTIMETRES = 100.0
# When the disturbance ends [s].
EndTime = Callable[[Values], float]


def draw_coefficients(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the friction of the support points, one panel for each."""
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    draw_friction(panels.ravel().tolist(), outcome.tables['friction'])


def draw_centers(end_time: EndTime, figure: Figure, outcome: Outcome, values: Values) -> None:
    """
    Draw the paths of the middle, one panel for each law.

    :param end_time: when the disturbance ends.
    """
    end = end_time(values)
    for letter, axes, law in zip('ab', figure.subplots(2, 1, sharex=True, sharey=True), LAWS):
        path = outcome.tables[law]
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        rows = (path['time_s'] >= values.start_time) & (path['time_s'] <= end)
        axes.plot(path['x_m'][rows], path['y_m'][rows], color=plot_style.LIGHT, linewidth=6.0,
                  solid_capstyle='butt', zorder=2.0, label='disturbed')
        draw_center(axes, path, **STYLES[law])
        axes.set_title(f'({letter}) {LABELS[law]}', loc='left')
        axes.label_outer()
        axes.legend(loc='upper left')


def draw_objects(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box on its path, one panel for each law."""
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for letter, axes, law in zip('ab', panels, LAWS):
        path, obj = outcome.tables[law], box(values)
        draw_outlines(axes, obj, [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        poses = poses_at(path, np.linspace(0.0, path['time_s'][-1], OUTLINES))
        for pose in poses[1:]:
            axes.fill(*zip(*map(pose.transform, obj.outline)), facecolor='none', zorder=2.0,
                      edgecolor=STYLES[law]['color'], linewidth=1.6 if pose is poses[-1] else 0.7)
        draw_center(axes, path, **STYLES[law])
        axes.set_title(f'({letter}) {LABELS[law]}', loc='left')
        axes.label_outer()


def draw_inputs(end_time: EndTime, figure: Figure, outcome: Outcome, values: Values) -> None:
    """
    Draw the pushing angles over time.

    :param end_time: when the disturbance ends.
    """
    axes = figure.subplots()
    last = max(outcome.tables[law]['time_s'][-1] for law in LAWS)
    axes.axvspan(values.start_time, min(last, end_time(values)), color=plot_style.LIGHT,
                 alpha=0.6, linewidth=0.0, label='disturbed')
    path = outcome.tables[FEEDBACK]
    axes.plot(path['time_s'], path['aim_rad'], color=plot_style.GREY, linewidth=1.0,
              label='towards the centre of friction')
    for law in (FEEDBACK, OPEN_LOOP):
        draw_angle(axes, outcome.tables[law], 'time_s', law)
    axes.set_xlim(0.0, last)
    axes.legend(loc='best')
