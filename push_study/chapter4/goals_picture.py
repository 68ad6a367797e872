"""Pictures of pushes to goals under both laws."""

import numpy as np
from push_model.geometry import Pose
from push_study.chapter3.scene import draw_center, draw_outlines, draw_push, poses_at
from push_study.chapter4.scene import draw_angle, FEEDBACK, LABELS, LOOKS, OPTIMISER
from push_study.framework import paper
from push_study.framework.scenes import box

OUTLINES, PUSHES = 7, 9


def draw_goals(figure, outcome, values):
    """
    Draw the ways to all goals.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    panels = figure.subplots(-(-len(values.goals) // 2), 2, sharex=True, sharey=True,
                             squeeze=False)
    for number, (axes, goal) in enumerate(zip(panels.flat, values.goals), 1):
        draw_outlines(axes, box(values), [Pose(0.0, 0.0, 0.0), Pose(*goal)])
        for law in (FEEDBACK, OPTIMISER):
            draw_center(axes, outcome.tables[f'{law}_{number}'], label=LABELS[law], **LOOKS[law])
        axes.set_title(f'goal {number}: {goal[0]:g} m, {goal[1]:g} m, {goal[2]:g} rad', loc='left')
        axes.label_outer()
    panels[0, 0].legend(loc='upper left')


def draw_way(figure, outcome, values):
    """
    Draw the way of the box, with the pushes of feedback.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    path = outcome.tables[FEEDBACK]
    times = np.linspace(0.0, path['time_s'][-1], OUTLINES)
    draw_outlines(axes, box(values), [*poses_at(path, times[:-1]), Pose(*values.goal)])
    for law in (FEEDBACK, OPTIMISER):
        draw_center(axes, outcome.tables[law], label=LABELS[law], **LOOKS[law])
    touching = np.isfinite(path['rho_rad'])
    for time in np.linspace(1.0, 0.95 * times[-1], PUSHES):
        angle = np.interp(time, path['time_s'][touching], path['rho_rad'][touching])
        draw_push(axes, path, time, float(angle), 0.16)
    axes.legend(loc='best')


def draw_input(figure, outcome, values):
    """
    Draw pushing angles over the way, and the speed over time.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    above, below = figure.subplots(2, 1, height_ratios=(1.6, 1.0))
    planned = outcome.tables['planned']
    above.plot(planned['way_m'], planned['rho_rad'], color=paper.LIGHT, linewidth=5.0,
               label='planned')
    for law in (FEEDBACK, OPTIMISER):
        draw_angle(above, outcome.tables[law], 'way_m', law)
        below.plot(outcome.tables[law]['time_s'], outcome.tables[law]['speed_m_s'], **LOOKS[law])
    above.legend(loc='best')
    below.set_xlabel('time [s]')
    below.set_ylabel('robot [m/s]')
    below.set_ylim(bottom=0.0)
