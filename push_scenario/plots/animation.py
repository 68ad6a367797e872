"""Animation of runs of a scenario, side by side, some seconds long, as a GIF."""

from collections.abc import Sequence
from os import PathLike

from matplotlib.animation import PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_control.law_names import law_title
from push_control.task.status import TaskState
from push_scenario.evaluation.metrics import bounds_missed
from push_scenario.plots.drawing import (
    draw_goals, draw_map, draw_object, INK, NO_PUSH, PLAN_STYLE, ROBOT_PATH_STYLE, segments_of,
    set_view, StateRows, tape_of, WARNING,
)
from push_scenario.plots.moving_bodies import ShadedObject, WheeledRobot
from push_scenario.simulation.result import RunResult

# Frames that move, frames that hold the end, and frames per second: 11.5 s in all.
FRAMES, FINAL_FRAMES, FRAME_RATE = 120, 18, 12
# Longer side of a panel, least width for its title, height of title and clock [inch].
PANEL_SIZE, MIN_PANEL_WIDTH, RIM_HEIGHT = 8.0, 5.0, 1.0
DPI = 80
TITLE_SIZE, CLOCK_SIZE = 16, 12
FLOOR, RIM = '#F6F4EF', '#D8D4C8'
VIEW_MARGIN = 0.06  # free rim around everything that moves [m]
# How long the reason of a failure stays in the title [s], and how many characters fit there.
REASON_TIME = 2.0
TITLE_LENGTH = 48
ACTIVITIES = {
    TaskState.PLAN: 'localizes and plans', TaskState.APPROACH: 'drives to the object',
    TaskState.ALIGN: 'probes for contact', TaskState.PUSH: 'pushes',
    TaskState.RETREAT: 'backs off', TaskState.LOOK: 'looks for the object',
    TaskState.DONE: 'done', TaskState.FAILED: 'aborted',
    TaskState.IDLE: 'idle', TaskState.PAUSED: 'paused'}


def draw_animation(results: Sequence[RunResult], path: str | PathLike[str]) -> None:
    """
    Draw runs of one scenario in motion and save them.

    :param results: the ``RunResult`` of each run that moved, one or more.
    :param path: of the GIF.
    """
    figure = Figure(facecolor='white', dpi=DPI)
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(results), squeeze=False)[0]
    panels = [_Panel(ax, result, results) for ax, result in zip(axes, results)]
    width, height = np.ptp(axes[0].get_xlim()), np.ptp(axes[0].get_ylim())
    scale = PANEL_SIZE / max(width, height)
    figure.set_size_inches(max(MIN_PANEL_WIDTH, scale * width) * len(results),
                           scale * height + RIM_HEIGHT)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.92, bottom=0.07, wspace=0.02)
    clock = figure.text(0.5, 0.02, '', ha='center', fontsize=CLOCK_SIZE, color=INK)
    end = max(tape_of(result)['time'][-1] for result in results)
    speed_up = end * FRAME_RATE / FRAMES
    writer = PillowWriter(fps=FRAME_RATE)
    with writer.saving(figure, str(path), DPI):
        for frame in range(FRAMES + FINAL_FRAMES):
            time = min(end, end * frame / FRAMES)
            for panel in panels:
                panel.show(time)
            clock.set_text(f't = {time:4.1f} s   ({speed_up:.1f} x real time)')
            writer.grab_frame()


class _Panel:
    """One run: what stays is drawn once, what moves is moved."""

    def __init__(self, axes: Axes, result: RunResult, results: Sequence[RunResult]) -> None:
        self._axes = axes
        self._result = result
        self._tape = tape_of(result)
        self._segments = segments_of(result)
        self._is_missed = bool(bounds_missed(result))
        # Several runs are told apart by their laws.
        self._law = f'{law_title(result.control_law)}: ' if len(results) > 1 else ''
        start = self._tape.poses('object')[0]
        draw_map(axes, result.scenario)
        draw_object(axes, result.scenario.object, start, facecolor='#F1F1F1',
                    edgecolor='#B0B0B0', linewidth=1.0, zorder=2)
        if result.plan is not None:
            axes.plot(*result.plan.object_poses[:, :2].T, **PLAN_STYLE, zorder=3)
        self._goals: list[Artist] = []
        self._robot_path, = axes.plot([], [], **ROBOT_PATH_STYLE, zorder=3)
        self._push_paths = [axes.plot([], [], color=segment.color, linewidth=2.6, zorder=7)[0]
                            for segment in self._segments]
        self._object = ShadedObject(axes, result.scenario.true_object, start, zorder=6)
        self._robot = WheeledRobot(axes, result.scenario.true_robot, zorder=8)
        set_view(axes, results, VIEW_MARGIN)
        axes.set(xticks=[], yticks=[], facecolor=FLOOR)
        for spine in axes.spines.values():
            spine.set_color(RIM)

    def show(self, time: float) -> None:
        """Move everything to a time [s]."""
        times = self._tape['time']
        row = min(int(np.searchsorted(times, time)), len(times) - 1)
        robots = self._tape.poses('robot')
        self._robot_path.set_data(robots[:row + 1, 0], robots[:row + 1, 1])
        segment = self._extend_push_paths(row)
        self._show_title(segment, row)
        for artist in self._goals:
            artist.remove()
        self._goals = draw_goals(self._axes, self._result.scenario, time)
        self._object.move(self._tape.poses('object')[row])
        self._robot.move(self._tape.poses('robot')[row])

    def _extend_push_paths(self, row: int) -> StateRows:
        """Draw the path of the object in each push up to a row; return the present segment."""
        present, objects = self._segments[0], self._tape.poses('object')
        for segment, path in zip(self._segments, self._push_paths):
            if segment.rows.start <= row:
                present = segment
            if segment.push is not None:
                rows = slice(segment.rows.start, min(segment.rows.stop, row + 1))
                path.set_data(objects[rows, 0], objects[rows, 1])
        return present

    def _show_title(self, segment: StateRows, row: int) -> None:
        time = self._tape['time']
        is_recent = time[row] < time[segment.rows.start] + REASON_TIME
        if segment.reason and is_recent:
            self._axes.set_title(_shortened(segment.reason), fontsize=TITLE_SIZE, color=WARNING)
            return
        if segment.state is TaskState.DONE and self._is_missed:
            self._axes.set_title(f'{self._law}missed the goal', fontsize=TITLE_SIZE,
                                 color=WARNING)
            return
        activity = ACTIVITIES[segment.state]
        if segment.push is not None and self._result.scenario.task is not None:
            activity = f'push {segment.push + 1} of {self._result.pushes}'
        self._axes.set_title(f'{self._law}{activity}', fontsize=TITLE_SIZE,
                             color=INK if segment.color == NO_PUSH else segment.color)


def _shortened(text: str) -> str:
    if len(text) <= TITLE_LENGTH:
        return text
    return text[:TITLE_LENGTH - 1].rsplit(' ', 1)[0] + ' …'
