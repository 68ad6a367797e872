"""Figures of pushes to goals under both laws."""

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from push_study.chapter3.setup import draw_center, draw_outlines, draw_push, poses_at
from push_study.chapter4.setup import draw_angle, FEEDBACK, LABELS, Law, LAWS, OPEN_LOOP, STYLES
from push_study.framework import plot_style
from push_study.framework.box import box
from push_study.framework.parameters import Values
from push_study.framework.study import Outcome

# Chosen: poses at which the box is drawn, and pushes that are drawn as arrows.
OUTLINES = 7
PUSHES = 9
# Chosen: panels stand side by side where the goal is further aside than this fraction of its
# distance ahead.
NARROW = 0.4
TITLES: dict[Law, str] = {OPEN_LOOP: 'optimiser, in open loop', FEEDBACK: 'feedback law'}


def draw_goals(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the paths to all goals."""
    rows = (len(values.goals) + 1) // 2
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for number, (axes, goal) in enumerate(zip(panels.flat, values.goals), 1):
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*goal)])
        for law in (FEEDBACK, OPEN_LOOP):
            draw_center(axes, outcome.tables[f'{law}_{number}'], label=LABELS[law], **STYLES[law])
        axes.set_title(f'goal {number}: {goal[0]:g} m, {goal[1]:g} m, {goal[2]:g} rad', loc='left')
        axes.label_outer()
    panels[0, 0].legend(loc='upper left')


def draw_path(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the path of the box with the pushes, one panel for each law."""
    count = 2 if abs(values.goal[1]) > NARROW * values.goal[0] else 1
    panels = figure.subplots(3 - count, count, sharex=True, sharey=True).ravel()
    for letter, axes, law in zip('ab', panels, LAWS):
        path = outcome.tables[law]
        times = np.linspace(0.0, path['time_s'][-1], OUTLINES)
        draw_outlines(axes, box(values), [*poses_at(path, times[:-1]), Pose(*values.goal)])
        draw_center(axes, path, **STYLES[law])
        touching = np.isfinite(path['rho_rad'])
        for time in np.linspace(1.0, 0.95 * times[-1], PUSHES):
            angle = np.interp(time, path['time_s'][touching], path['rho_rad'][touching])
            draw_push(axes, path, time, float(angle))
        axes.set_title(f'({letter}) {TITLES[law]}', loc='left')
        axes.label_outer()


def draw_input(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw pushing angles over the distance, and the speed over time."""
    above, below = figure.subplots(2, 1, height_ratios=(1.6, 1.0))
    planned = outcome.tables['planned']
    above.plot(planned['distance_m'], planned['rho_rad'], color=plot_style.LIGHT, linewidth=5.0,
               label='planned')
    for law in (FEEDBACK, OPEN_LOOP):
        path = outcome.tables[law]
        draw_angle(above, path, 'distance_m', law)
        below.plot(path['time_s'], path['speed_m_s'], **STYLES[law])
    above.legend(loc='best')
    below.set_xlabel('time [s]')
    below.set_ylabel('robot [m/s]')
    below.set_ylim(bottom=0.0)
