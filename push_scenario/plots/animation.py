"""The animation of a replay: runs side by side, some seconds long, as a GIF."""

import math

from matplotlib.animation import PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_scenario.evaluation.report import TITLES
from push_scenario.plots.drawing import (
    draw_object, draw_robot, front, GOAL, INK, LAW_STYLES, outline, PLAN_STYLE, set_view,
)

FRAMES, HELD_FRAMES, RATE = 72, 14, 12
PANEL_WIDTH, DPI = 4.9, 90


def draw_animation(results, path):
    """
    Draw runs of one scenario in motion and save them.

    :param results: the ``Result`` of each run that moved, one or more.
    :param path: of the GIF.
    """
    figure = Figure(facecolor='white', dpi=DPI)
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(results), squeeze=False)[0]
    panels = [_Panel(ax, result, results) for ax, result in zip(axes, results)]
    width, height = np.ptp(axes[0].get_xlim()), np.ptp(axes[0].get_ylim())
    figure.set_size_inches(PANEL_WIDTH * len(results), PANEL_WIDTH * height / width + 0.75)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.9, bottom=0.09, wspace=0.02)
    clock = figure.text(0.5, 0.025, '', ha='center', fontsize=10, color=INK)
    end = max(result.tape['time'][-1] for result in results)
    factor = end * RATE / FRAMES
    writer = PillowWriter(fps=RATE)
    with writer.saving(figure, str(path), DPI):
        for number in range(FRAMES + HELD_FRAMES):
            time = min(end, end * number / FRAMES)
            for panel in panels:
                panel.show(time)
            clock.set_text(f't = {time:4.1f} s   ({factor:.1f} x real time)')
            writer.grab_frame()


class _Panel:
    """One run: what stays is drawn once, what moves is moved."""

    def __init__(self, axes, result, results):
        scenario, tape = result.scenario, result.tape
        style = LAW_STYLES[result.control_law]
        self._time = tape['time']
        self._objects, self._robots = tape.poses('object'), tape.poses('robot')
        self._object, self._radius = scenario.truth, scenario.robot_truth.radius
        plan = result.plan.object_poses
        axes.plot(plan[:, 0], plan[:, 1], **PLAN_STYLE)
        draw_object(axes, scenario.object, scenario.goal.pose, facecolor='none', edgecolor=GOAL,
                    linewidth=2.4, linestyle=(0, (2, 1)), zorder=2)
        self._trail, = axes.plot([], [], **style)
        self._box, self._front = draw_object(axes, self._object, self._objects[0], zorder=3,
                                             facecolor=style['color'] + '40',
                                             edgecolor=style['color'], linewidth=1.8)
        self._disc, self._heading = draw_robot(axes, self._radius, self._robots[0],
                                               facecolor='#8A8A8A', edgecolor=INK, linewidth=1.2,
                                               zorder=3)
        set_view(axes, results, 0.04)
        axes.set_axis_off()
        axes.set_title(TITLES[result.control_law], fontsize=12, color=style['color'])

    def show(self, time):
        """Move everything to a time [s]."""
        row = min(int(np.searchsorted(self._time, time)), len(self._time) - 1)
        pose, (x, y, phi) = self._objects[row], self._robots[row]
        self._trail.set_data(self._objects[:row + 1, 0], self._objects[:row + 1, 1])
        self._box.set_xy(outline(self._object, pose))
        self._front.set_data(*front(self._object, pose))
        self._disc.center = x, y
        self._heading.set_data([x, x + self._radius * math.cos(phi)],
                               [y, y + self._radius * math.sin(phi)])
