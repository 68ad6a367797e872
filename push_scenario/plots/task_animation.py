"""The animation of a task: round the object, push, round it again, away; as a GIF."""

import math

from matplotlib.animation import PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_control.task.status import TaskState
from push_scenario.evaluation.report import TITLES
from push_scenario.plots.drawing import (
    ALONE, ALONE_STYLE, draw_goals, draw_map, draw_object, draw_robot, front, INK, outline,
    phases_of, set_task_view, TROUBLE,
)

FRAMES, HELD_FRAMES, RATE = 120, 18, 12
PANEL, DPI = 5.6, 80
DOING = {
    TaskState.PLAN: 'looks and plans', TaskState.APPROACH: 'drives to the object',
    TaskState.ALIGN: 'feels for it', TaskState.PUSH: 'pushes', TaskState.RETREAT: 'backs off',
    TaskState.DONE: 'done', TaskState.FAILED: 'has given up', TaskState.IDLE: 'stands',
    TaskState.PAUSED: 'stands'}


def draw_task_animation(results, path):
    """
    Draw runs of one task in motion and save them.

    :param results: the ``TaskResult`` of each run, one or more.
    :param path: of the GIF.
    """
    figure = Figure(facecolor='white', dpi=DPI)
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(results), squeeze=False)[0]
    panels = [_Panel(ax, result, results) for ax, result in zip(axes, results)]
    width, height = np.ptp(axes[0].get_xlim()), np.ptp(axes[0].get_ylim())
    scale = PANEL / max(width, height)
    figure.set_size_inches(max(4.2, scale * width) * len(results), scale * height + 0.8)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.92, bottom=0.07, wspace=0.02)
    clock = figure.text(0.5, 0.02, '', ha='center', fontsize=10, color=INK)
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
        tape = result.tape
        self._axes, self._scenario, self._title = axes, result.scenario, TITLES[result.control_law]
        self._time, self._phases = tape['time'], phases_of(result)
        self._objects, self._robots = tape.poses('object'), tape.poses('robot')
        self._radius = result.scenario.robot_truth.radius
        draw_map(axes, result.scenario)
        draw_object(axes, result.scenario.object, self._objects[0], facecolor='#F1F1F1',
                    edgecolor='#B0B0B0', linewidth=1.0, zorder=2)
        self._marks = []
        self._way, = axes.plot([], [], **ALONE_STYLE, zorder=3)
        self._trails = [axes.plot([], [], color=phase.color, linewidth=2.6, zorder=7)[0]
                        for phase in self._phases]
        self._box, self._front = draw_object(axes, result.scenario.truth, self._objects[0],
                                             linewidth=1.8, zorder=6)
        self._disc, self._heading = draw_robot(axes, self._radius, self._robots[0],
                                               facecolor='#8A8A8A', edgecolor=INK, linewidth=1.2,
                                               zorder=8)
        set_task_view(axes, results, 0.06)
        axes.set_axis_off()

    def show(self, time):
        """Move everything to a time [s]."""
        row = min(int(np.searchsorted(self._time, time)), len(self._time) - 1)
        self._way.set_data(self._robots[:row + 1, 0], self._robots[:row + 1, 1])
        phase = self._phases[0]
        for later, trail in zip(self._phases, self._trails):
            if later.rows.start <= row:
                phase = later
            if later.number is not None:
                rows = slice(later.rows.start, min(later.rows.stop, row + 1))
                trail.set_data(self._objects[rows, 0], self._objects[rows, 1])
        self._tell(phase, row)
        for artist in self._marks:
            artist.remove()
        self._marks = draw_goals(self._axes, self._scenario, time)
        self._place(row, phase.color)

    def _tell(self, phase, row):
        doing = DOING[phase.state]
        if phase.number is not None:
            doing = f'push {phase.number + 1}'
        is_new = self._time[row] < self._time[phase.rows.start] + 2.0
        trouble = phase.trouble if phase.trouble and is_new else ''
        self._axes.set_title(_short(trouble) or f'{self._title}: {doing}', fontsize=11,
                             color=TROUBLE if trouble else
                             INK if phase.color == ALONE else phase.color)

    def _place(self, row, color):
        pose, (x, y, phi) = self._objects[row], self._robots[row]
        self._box.set_xy(outline(self._scenario.truth, pose))
        self._box.set(facecolor=color + '40', edgecolor=color)
        self._front.set_data(*front(self._scenario.truth, pose))
        self._front.set_color(color)
        self._disc.center = x, y
        self._heading.set_data([x, x + self._radius * math.cos(phi)],
                               [y, y + self._radius * math.sin(phi)])


def _short(text):
    return text if len(text) <= 48 else text[:47].rsplit(' ', 1)[0] + ' …'
