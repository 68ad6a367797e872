"""
Animation of a room that is put in order, as a GIF.

It shows what comes next and why: the goals, the moves that are planned as numbered ghosts, and how
long they will take.
"""

from os import PathLike
from typing import Any

from matplotlib.animation import PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
import numpy as np
from push_planner.rearrangement.problem import Move
from push_scenario.plots.drawing import (
    DASHED_GOAL, draw_map, draw_object, draw_push_number, GOAL, INK, outline, PUSH_COLORS)
from push_scenario.plots.moving_bodies import ShadedObject, WheeledRobot
from push_scenario.tidying.report import progress_text
from push_scenario.tidying.room import Room
from push_scenario.tidying.tidy import MoveResult, TidyResult

# Frames per second, simulated time between two of them [s], and frames that hold the end.
FRAME_RATE, FRAME_PERIOD, FINAL_FRAMES = 12, 2.0, 18
# Width of the picture [in], height of title and legend, and the resolution.
WIDTH, RIM_HEIGHT, DPI = 7.0, 1.0, 70
FLOOR, TITLE_SIZE = '#F6F4EF', 11
VIEW_MARGIN = 0.5  # free rim around starts, goals and temporary places [m]
MOVE_STYLE: dict[str, Any] = {'linestyle': (0, (2, 2)), 'linewidth': 1.6, 'zorder': 4}


def draw_room_animation(result: TidyResult, path: str | PathLike[str]) -> None:
    """
    Draw how a room was put in order, in motion.

    :param path: of the GIF.
    """
    figure = Figure(facecolor='white', dpi=DPI)
    FigureCanvasAgg(figure)
    picture = _RoomPicture(figure.add_subplot(), result)
    width, height = picture.size
    figure.set_size_inches(WIDTH, WIDTH * height / width + RIM_HEIGHT)
    top = RIM_HEIGHT / (WIDTH * height / width + RIM_HEIGHT)
    figure.subplots_adjust(left=0.01, right=0.99, top=1.0 - 0.4 * top, bottom=0.6 * top)
    writer = PillowWriter(fps=FRAME_RATE)
    with writer.saving(figure, str(path), DPI):
        for move in result.moves:
            for row in picture.begin(move):
                picture.show(move, row)
                writer.grab_frame()
        picture.end()
        for _ in range(FINAL_FRAMES):
            writer.grab_frame()


class _RoomPicture:
    """What stays is drawn once, plans at each move, bodies at each frame."""

    def __init__(self, axes: Axes, result: TidyResult) -> None:
        self._axes = axes
        self._result = result
        room = result.room
        draw_map(axes, room.any_scenario)
        for name, scenario in room.scenarios.items():
            if name not in room.without_goal:
                draw_object(axes, scenario.object, scenario.goal.pose, facecolor='none',
                            edgecolor=GOAL, linestyle=DASHED_GOAL, linewidth=1.6, zorder=3)
        self._objects = {
            name: ShadedObject(axes, scenario.true_object, scenario.start.object.pose, zorder=6)
            for name, scenario in room.scenarios.items()}
        self._names = {name: axes.text(0.0, 0.0, name, ha='center', va='center', fontsize=8,
                                       color=INK, zorder=7) for name in room.scenarios}
        self._robot = WheeledRobot(axes, room.any_scenario.true_robot, zorder=8)
        self._plan: list[Artist] = []
        axes.set(xticks=[], yticks=[], facecolor=FLOOR)
        axes.set_aspect('equal')
        low, high = _extent(result)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        self.size = float(high[0] - low[0]), float(high[1] - low[1])
        axes.legend(handles=[
            Line2D([], [], color=GOAL, linestyle=DASHED_GOAL, label='goal'),
            Line2D([], [], color=PUSH_COLORS[0], label='next move (1), and where it ends',
                   linestyle=MOVE_STYLE['linestyle'])],
            loc='upper center', bbox_to_anchor=(0.5, -0.01), ncols=2, fontsize=9, frameon=False)

    def begin(self, move: MoveResult) -> list[int]:
        """Draw the plan at a move; return the rows of its tape that are shown."""
        self._erase_plan()
        progress = move.progress
        self._axes.set_title(progress_text(progress), fontsize=TITLE_SIZE, color=INK)
        for index, planned in enumerate(progress.plan.moves):
            self._plan += _draw_move(self._axes, self._result.room, planned, index)
        for name, pose in progress.poses.items():
            self._move(name, pose)
        tape = move.run.tape
        if tape is None:
            return []
        times = np.arange(tape['time'][0], tape['time'][-1], FRAME_PERIOD)
        return np.searchsorted(tape['time'], times).tolist()

    def show(self, move: MoveResult, row: int) -> None:
        """Show one row of the tape of a move."""
        tape = move.run.tape
        if tape is not None:
            self._move(move.move.name, tape.poses('object')[row].tolist())
            self._robot.move(tape.poses('robot')[row].tolist())

    def end(self) -> None:
        """Show where all are at the end, and what was not possible."""
        self._erase_plan()
        result = self._result
        for name, pose in result.poses.items():
            self._move(name, pose)
        self._robot.move(result.robot_pose)
        failed = [name for name in result.poses if not result.is_placed(name)]
        text = f'not at their goals: {", ".join(failed)}' if failed else 'all at their goals'
        self._axes.set_title(f'{text}, after {result.duration:.0f} s', fontsize=TITLE_SIZE,
                             color=INK)

    def _erase_plan(self) -> None:
        for artist in self._plan:
            artist.remove()
        self._plan = []

    def _move(self, name: str, pose: Any) -> None:
        self._objects[name].move(pose)
        self._names[name].set_position((pose[0], pose[1]))


def _draw_move(axes: Axes, room: Room, move: Move, index: int) -> list[Artist]:
    """Draw a planned move: its way, and a numbered ghost where it ends; the next one is strong."""
    color, alpha = PUSH_COLORS[index % len(PUSH_COLORS)], 1.0 if index == 0 else 0.45
    obj = room.scenarios[move.name].object
    line, = axes.plot(*move.path.T, color=color, alpha=alpha, **MOVE_STYLE)
    artists: list[Artist] = [line, *draw_object(
        axes, obj, move.end, facecolor='none', edgecolor=color, linewidth=1.6, alpha=alpha,
        zorder=4)]
    before = len(axes.texts)
    # Beside the name of an object that stands there.
    vertices = outline(obj, move.end)
    draw_push_number(axes, index, vertices[np.argmax(vertices[:, 1])])
    return [*artists, *axes.texts[before:]]


def _extent(result: TidyResult) -> tuple[Any, Any]:
    """Corners of what is shown: all objects wherever they stand, and the robot [m]."""
    room, radius = result.room, result.room.any_scenario.robot.radius
    points = [outline(scenario.object, pose) for scenario in room.scenarios.values()
              for pose in (scenario.start.object.pose, scenario.goal.pose)]
    points += [outline(room.scenarios[move.name].object, move.end)
               for item in result.moves for move in item.progress.plan.moves]
    for item in result.moves:
        if item.run.tape is not None:
            robots = item.run.tape.poses('robot')[:, :2]
            points += [robots + radius, robots - radius]
    shown = np.concatenate(points)
    return shown.min(axis=0) - VIEW_MARGIN, shown.max(axis=0) + VIEW_MARGIN
