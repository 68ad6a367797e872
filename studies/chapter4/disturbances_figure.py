"""Figures of pushes during a disturbance."""

from typing import Callable

from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
import numpy as np
from push_model.geometry import Pose
from studies.chapter3.setup import draw_center, draw_outlines, poses_at
from studies.chapter4.random_friction import draw_ends, mark_new_paths
from studies.chapter4.setup import (
    DIPOLE, draw_angle, FEEDBACK, FORCE_ANGLE, KEPT_PATH, LABELS, Law, MPC, NO_JUMP_TEST,
    OBJECT_FRAME, OPEN_LOOP, REPLANNED, STYLES,
)
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Values
from studies.framework.study import Outcome

# Chosen: poses at which the box is drawn.
OUTLINES = 6
# By panel: (a) the optimiser, (b) feedback.
PANELS: tuple[tuple[Law, ...], ...] = (
    (OPEN_LOOP, OBJECT_FRAME, REPLANNED), (FEEDBACK, MPC, NO_JUMP_TEST))
# Laws under which the box is pushed on each drawn disturbance.
REPEATED: tuple[Law, ...] = (OPEN_LOOP, REPLANNED, FEEDBACK, FORCE_ANGLE, DIPOLE)
# Those whose box is drawn.
OUTLINED: tuple[tuple[Law, ...], ...] = ((OPEN_LOOP, REPLANNED), (FEEDBACK, MPC))
TITLES = ('optimiser', 'feedback')
# When the disturbance ends [s].
EndTime = Callable[[Values], float]


def draw_centers(end_time: EndTime, figure: Figure, outcome: Outcome, values: Values) -> None:
    """
    Draw the paths of the middle, one panel for the optimiser and one for feedback.

    :param end_time: when the disturbance ends.
    """
    end = end_time(values)
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for letter, axes, laws, title in zip('ab', panels, PANELS, TITLES):
        path = outcome.tables[laws[0]]
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        rows = (path['time_s'] >= values.start_time) & (path['time_s'] <= end)
        axes.plot(path['x_m'][rows], path['y_m'][rows], color=plot_style.LIGHT, linewidth=7.0,
                  solid_capstyle='butt', zorder=2.0, label='disturbed')
        for law in laws:
            draw_center(axes, outcome.tables[law], label=LABELS[law], **STYLES[law])
        axes.set_title(f'({letter}) {title}', loc='left')
        axes.label_outer()
        axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))


def draw_objects(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box on its path, in the panels of ``draw_centers``, and the ends of all pushes."""
    # Figures of their own, so that the labels of one do not narrow the other.
    above, below = figure.subfigures(2, 1, height_ratios=(1.6, 1.0))
    obj = box(values)
    panels = above.subplots(2, 1, sharex=True, sharey=True)
    for letter, axes, laws, title in zip('ab', panels, OUTLINED, TITLES):
        draw_outlines(axes, obj, [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
        for law in laws:
            path = outcome.tables[law]
            poses = poses_at(path, np.linspace(0.0, path['time_s'][-1], OUTLINES))
            for pose in poses[1:]:
                axes.fill(*zip(*map(pose.transform, obj.outline)), facecolor='none', zorder=2.0,
                          edgecolor=STYLES[law]['color'],
                          linewidth=1.6 if pose is poses[-1] else 0.7)
            draw_center(axes, path, label=LABELS[law], **STYLES[law])
        axes.set_title(f'({letter}) {title}', loc='left')
        axes.yaxis.set_major_locator(MultipleLocator(0.5))
        axes.label_outer()
        axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))
    draw_ends(below.subplots(), outcome.tables['ends'], REPEATED)


def draw_inputs(end_time: EndTime, figure: Figure, outcome: Outcome, values: Values) -> None:
    """
    Draw the pushing angles over time.

    :param end_time: when the disturbance ends.
    """
    path = outcome.tables[FEEDBACK]
    panels = figure.subplots(3, 1, sharex=True)
    last = max(outcome.tables[law]['time_s'][-1] for law in (FEEDBACK, REPLANNED, OPEN_LOOP))
    rows: tuple[tuple[Law, ...], ...] = ((FEEDBACK, MPC), (NO_JUMP_TEST, KEPT_PATH),
                                         (REPLANNED, OPEN_LOOP))
    for axes, laws in zip(panels, rows):
        axes.axvspan(values.start_time, min(last, end_time(values)), color=plot_style.LIGHT,
                     alpha=0.6, linewidth=0.0, label='disturbed')
        if axes is panels[0]:
            axes.plot(path['time_s'], path['aim_rad'], color=plot_style.GREY, linewidth=1.0,
                      label='towards the centre of friction')
        for law in laws:
            draw_angle(axes, outcome.tables[law], 'time_s', law)
        if laws[0] != REPLANNED:
            mark_new_paths(axes, outcome.tables[laws[0]])
        axes.set_ylabel('$\\rho$ [rad]')
        axes.label_outer()
        axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.05))
    panels[0].set_xlim(0.0, last)
