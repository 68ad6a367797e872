"""Picture of a room: where objects stood, their goals, how they got there, and where they are."""

from os import PathLike

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from push_scenario.plots.drawing import (
    DASHED_GOAL, draw_map, draw_object, draw_robot, GOAL, INK, NO_PUSH, PUSH_COLORS,
    ROBOT_PATH_STYLE, style_axes)
from push_scenario.tidying.tidy import TidyResult

# Width of the picture [in], and its resolution.
WIDTH, DPI = 9.0, 100


def draw_room(result: TidyResult, path: str | PathLike[str]) -> None:
    """
    Draw how a room was put in order.

    :param path: of the PNG.
    """
    figure = Figure(dpi=DPI, facecolor='white', layout='constrained')
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    room = result.room
    draw_map(axes, room.any_scenario)
    colors = {name: PUSH_COLORS[index % len(PUSH_COLORS)]
              for index, name in enumerate(room.scenarios)}
    for name, scenario in room.scenarios.items():
        draw_object(axes, scenario.object, scenario.start.object.pose, facecolor='none',
                    edgecolor=NO_PUSH, linestyle=':', zorder=2)
        if name not in room.without_goal:
            draw_object(axes, scenario.object, scenario.goal.pose, facecolor='none',
                        edgecolor=GOAL, linestyle=DASHED_GOAL, linewidth=1.6, zorder=5)
    for number, item in enumerate(result.moves, 1):
        tape = item.run.tape
        if tape is None:
            continue
        axes.plot(*tape.poses('robot')[:, :2].T, zorder=2, **ROBOT_PATH_STYLE)
        x, y, _ = tape.poses('object').T
        axes.plot(x, y, color=colors[item.move.name], linewidth=2.0, zorder=4)
        middle = len(x) // 2
        axes.annotate(str(number), (x[middle], y[middle]), color=colors[item.move.name],
                      fontsize=11, zorder=7)
    for name, pose in result.poses.items():
        draw_object(axes, room.scenarios[name].object, pose, facecolor=colors[name],
                    edgecolor=INK, alpha=0.5, zorder=3)
        axes.annotate(name, pose[:2], ha='center', va='center', fontsize=8, zorder=6)
    draw_robot(axes, room.any_scenario.robot.radius, result.robot_pose, facecolor='white',
               edgecolor=INK, zorder=6)
    axes.legend(handles=[
        Line2D([], [], color=NO_PUSH, linestyle=':', label='start'),
        Line2D([], [], color=GOAL, linestyle=DASHED_GOAL, label='goal'),
        Line2D([], [], color=PUSH_COLORS[0], label='path of an object, with the number of its '
               'move'),
        Line2D([], [], label='path of the robot', **ROBOT_PATH_STYLE)],
        loc='upper center', bbox_to_anchor=(0.5, -0.06), ncols=2, fontsize=8, frameon=False)
    style_axes(axes)
    axes.set_aspect('equal')
    left, right = axes.get_xlim()
    low, high = axes.get_ylim()
    figure.set_size_inches(WIDTH, WIDTH * (high - low) / (right - left) + 1.0)
    figure.savefig(path, metadata={'Software': None})
