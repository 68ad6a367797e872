"""Figures of pushes to goals under both laws."""

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from studies.chapter3.setup import draw_center, draw_outlines, draw_push, poses_at
from studies.chapter4.setup import (
    draw_angle, FEEDBACK, KEPT_PATH, LABELS, Law, MPC, OBJECT_FRAME, OPEN_LOOP, OWN_PATH,
    REPLANNED, STYLES,
)
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Values
from studies.framework.study import Outcome

# Chosen: poses at which the box is drawn, and pushes that are drawn as arrows.
OUTLINES = 7
PUSHES = 9
# Chosen: panels stand side by side where the goal is further aside than this fraction of its
# distance ahead.
NARROW = 0.4
# Chosen: height of a legend in a narrow panel [m].
LEGEND_ROOM = 0.4
# By panel: (a) optimiser, (b) feedback law; the first of each is drawn with its pushes.
PANELS: tuple[tuple[Law, ...], ...] = (
    (REPLANNED, OPEN_LOOP, OBJECT_FRAME), (OWN_PATH,))
TITLES = ('optimiser', 'feedback law, path of its own')
INPUT_LAWS: tuple[Law, ...] = (REPLANNED, FEEDBACK, KEPT_PATH, MPC)
GOAL_LAWS: tuple[Law, ...] = (OPEN_LOOP, REPLANNED, FEEDBACK, OWN_PATH, KEPT_PATH, MPC)


def draw_goals(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the paths to all goals."""
    rows = (len(values.goals) + 1) // 2
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for number, (axes, goal) in enumerate(zip(panels.flat, values.goals), 1):
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*goal)])
        for law in GOAL_LAWS:
            draw_center(axes, outcome.tables[f'{law}_{number}'], label=LABELS[law],
                        **STYLES[law])
        axes.set_title(f'goal {number}: {goal[0]:g} m, {goal[1]:g} m, {goal[2]:g} rad', loc='left')
        axes.label_outer()
    panels[0, -1].legend(*panels[0, 0].get_legend_handles_labels(), loc='upper left',
                         bbox_to_anchor=(1.0, 1.0))


def draw_path(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the path of the box with the pushes, one panel for optimiser and one for feedback."""
    count = 2 if abs(values.goal[1]) > NARROW * values.goal[0] else 1
    panels = figure.subplots(3 - count, count, sharex=True, sharey=True).ravel()
    for letter, axes, laws, title in zip('ab', panels, PANELS, TITLES):
        path = outcome.tables[laws[0]]
        times = np.linspace(0.0, path['time_s'][-1], OUTLINES)
        draw_outlines(axes, box(values), [*poses_at(path, times), Pose(*values.goal)])
        for law in laws:
            draw_center(axes, outcome.tables[law], label=LABELS[law], **STYLES[law])
        touching = np.isfinite(path['rho_rad'])
        for time in np.linspace(1.0, 0.95 * times[-1], PUSHES):
            angle = np.interp(time, path['time_s'][touching], path['rho_rad'][touching])
            draw_push(axes, path, time, float(angle))
        axes.set_title(f'({letter}) {title}', loc='left')
        axes.label_outer()
        if count == 2:
            axes.legend(loc='upper left')
        else:
            axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))
    if count == 2:
        # Room for the legends.
        panels[0].set_ylim(top=panels[0].get_ylim()[1] + LEGEND_ROOM)


def draw_input(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw pushing angles over the distance, and the speed over time."""
    above, below = figure.subplots(2, 1, height_ratios=(1.8, 1.0))
    planned = outcome.tables['planned']
    above.plot(planned['distance_m'], planned['rho_rad'], color=plot_style.LIGHT, linewidth=5.0,
               label='optimiser')
    for law in INPUT_LAWS:
        path = outcome.tables[law]
        draw_angle(above, path, 'distance_m', law)
        below.plot(path['time_s'], path['speed_m_s'], **STYLES[law])
    path = outcome.tables[OPEN_LOOP]
    below.plot(path['time_s'], path['speed_m_s'], color=plot_style.LIGHT, linewidth=5.0,
               zorder=1.0)
    above.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))
    below.set_xlabel('time [s]')
    below.set_ylabel('robot speed [m/s]')
    below.set_ylim(bottom=0.0)
