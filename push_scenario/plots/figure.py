"""
Figure of runs of a scenario, one column per run.

From top to bottom: the scene with the paths of object and robot, each push in its own colour; the
errors of the object's pose over time; how the robot pushes and where the contact force points in
the friction cone; in a map, how far object and robot keep from obstacles; and, once for all, the
friction on which nominal and true object differ.
"""

from collections.abc import Callable, Sequence
import math
from os import PathLike
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
import numpy as np
from numpy.typing import NDArray
from push_control.law_names import law_title
from push_model.friction import friction_center
from push_model.geometry import wrap_angles
from push_navigation.occupancy_map import OccupancyMap
from push_planner.refusal_marks import NO_MARKS, RefusalMarks
from push_scenario.definition.scenario import Scenario
from push_scenario.evaluation.metrics import bounds_missed, force_angle, verdict
from push_scenario.plots.drawing import (
    DASHED_GOAL, draw_displacements, draw_goals, draw_map, draw_object, draw_push_number,
    draw_robot, GOAL, goal_poses, INK, outline, PLAN_STYLE, PUSH_COLORS, ROBOT_PATH_STYLE,
    segments_of, set_view, StateRows, style_axes, tape_of, WARNING,
)
from push_scenario.plots.plan_picture import draw_refusal, refusal_legend
from push_scenario.simulation.result import Outcome, RunResult

FloatArray = NDArray[np.float64]

# Layout in inches: the column of one run, narrower where several stand side by side.
COLUMN_WIDTH, NARROW_COLUMN_WIDTH = 8.0, 5.6
STRIP_HEIGHT, STRIP_GAP, SCENE_GAP = 1.1, 0.3, 0.65
LEFT, RIGHT, TOP, BOTTOM = 0.9, 0.2, 0.75, 0.15
FOOTER_HEIGHT, FOOTER_GAP, FRICTION_WIDTH = 2.2, 0.9, 3.0
DPI = 110
VIEW_MARGIN = 0.12  # free rim around everything that moves [m]
# Smallest error that the logarithmic axes show [mm], [deg].
MIN_POSITION_ERROR, MIN_HEADING_ERROR = 0.5, 1e-3
CONE_STYLE: dict[str, Any] = {'color': '#5F8A5F', 'linestyle': (0, (5, 2, 1, 2)),
                              'linewidth': 1.2}
# Resolution of the picture of a floor, and height of its scene over that of its strip.
FLOOR_DPI, FLOOR_SHARE = 80, 4.5
# Clearances that are shown at most [mm], and their samples.
MAX_CLEARANCE, CLEARANCE_SAMPLES = 600.0, 800
# Poses of object and robot that are drawn in a push: the start, some on the way, the end.
MOMENTS = 4


def draw_figure(results: Sequence[RunResult], path: str | PathLike[str]) -> None:
    """
    Draw runs of one scenario side by side and save the figure.

    :param results: the ``RunResult`` of each run that moved, one or more.
    :param path: of the PNG.
    """
    figure = Figure(dpi=DPI, facecolor='white')
    FigureCanvasAgg(figure)
    strips: list[Callable[[Axes, RunResult], None]] = [
        _position_error, _heading_error, _pushing_angle, _force_angle]
    if _map_of(results[0]) is not None:
        strips.append(_clearances)
    columns = [[figure.add_axes((0.0, 0.0, 1.0, 1.0), label=f'{row} of {column}')
                for row in range(1 + len(strips))] for column in range(len(results))]
    footer = [figure.add_axes((0.0, 0.0, 1.0, 1.0), label=name) for name in ('friction', 'legend')]
    aspects: list[float] = []
    for result, (scene, *axes) in zip(results, columns):
        _scene(scene, result)
        width, height = set_view(scene, results, VIEW_MARGIN)
        aspects.append(height / width)
        for ax, draw in zip(axes, strips):
            _strip(ax, result, draw)
            ax.tick_params(labelbottom=ax is axes[-1])
        axes[-1].set_xlabel('time [s]')
    for row in zip(*columns):
        _share_y(row)
    _friction(footer[0], results[0].scenario)
    _legend(footer[1], results)
    _lay_out(figure, columns, footer, aspects[0])
    figure.savefig(path, metadata={'Software': None})


def draw_floor(result: RunResult, path: str | PathLike[str]) -> None:
    """
    Draw a task in a map: the scene, and below it the clearances.

    :param path: of the PNG.
    """
    figure = Figure(dpi=FLOOR_DPI, facecolor='white', layout='constrained')
    FigureCanvasAgg(figure)
    scene, clearances = figure.subplots(2, 1, height_ratios=(FLOOR_SHARE, 1.0))
    _scene(scene, result)
    width, height = set_view(scene, [result], VIEW_MARGIN)
    _strip(clearances, result, _clearances)
    clearances.set_xlabel('time [s]')
    clearances.legend(fontsize=8, loc='upper right', ncols=2)
    scene_height = COLUMN_WIDTH * height / width
    figure.set_size_inches(COLUMN_WIDTH, scene_height * (1.0 + 1.0 / FLOOR_SHARE) + TOP)
    figure.savefig(path, metadata={'Software': None})


def _share_y(row: Sequence[Axes]) -> None:
    """Give the axes of one row the same range, and a label at the left only."""
    limits = [ax.get_ylim() for ax in row]
    for ax in row:
        ax.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    for ax in row[1:]:
        ax.set_ylabel('')


def _lay_out(figure: Figure, columns: Sequence[Sequence[Axes]], footer: Sequence[Axes],
             aspect: float) -> None:
    """Place all axes, in inches from the upper left corner."""
    column_width = COLUMN_WIDTH if len(columns) == 1 else NARROW_COLUMN_WIDTH
    heights = [column_width * aspect] + [STRIP_HEIGHT] * (len(columns[0]) - 1)
    width = len(columns) * (LEFT + column_width + RIGHT)
    gaps = [SCENE_GAP] + [STRIP_GAP] * (len(heights) - 2) + [FOOTER_GAP]
    height = TOP + sum(heights) + sum(gaps) + FOOTER_HEIGHT + BOTTOM
    figure.set_size_inches(width, height)

    def place(ax: Axes, left: float, top: float, size: tuple[float, float]) -> None:
        ax.set_position((left / width, 1.0 - (top + size[1]) / height, size[0] / width,
                         size[1] / height))

    top = TOP
    for index, column in enumerate(columns):
        left, top = LEFT + index * (LEFT + column_width + RIGHT), TOP
        for ax, ax_height, gap in zip(column, heights, gaps):
            place(ax, left, top, (column_width, ax_height))
            top += ax_height + gap
    friction, legend = footer
    place(friction, LEFT, top, (FRICTION_WIDTH, FOOTER_HEIGHT))
    place(legend, LEFT + FRICTION_WIDTH, top,
          (width - LEFT - FRICTION_WIDTH - RIGHT, FOOTER_HEIGHT))


def _scene(axes: Axes, result: RunResult) -> None:
    scenario, tape = result.scenario, tape_of(result)
    objects, robots = tape.poses('object'), tape.poses('robot')
    radius = scenario.true_robot.radius
    draw_map(axes, scenario)
    draw_object(axes, scenario.object, objects[0], facecolor='#ECECEC', edgecolor=INK,
                linewidth=1.2, zorder=2)
    draw_robot(axes, radius, robots[0], facecolor='#F4F4F4', edgecolor=INK, linewidth=1.0,
               zorder=2)
    for segment in segments_of(result):
        _segment(axes, scenario, objects[segment.rows], robots[segment.rows], segment)
    if result.plan is not None:
        axes.plot(*result.plan.object_poses[:, :2].T, **PLAN_STYLE, zorder=7.5)
    draw_displacements(axes, result)
    draw_refusal(axes, scenario.object, radius, _marks_of(result))
    is_missed = bool(bounds_missed(result))
    draw_object(axes, scenario.true_object, objects[-1], linewidth=1.6, zorder=4, edgecolor=INK,
                facecolor=(WARNING if is_missed else GOAL) + '30')
    draw_robot(axes, radius, robots[-1], facecolor='#8A8A8A', edgecolor=INK, linewidth=1.2,
               zorder=8)
    draw_goals(axes, scenario)
    style_axes(axes)
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')
    bounds = scenario.final_bounds
    axes.set_title(
        f'{scenario.name.replace("_", " ")}, {law_title(result.control_law)}\n'
        f'{verdict(result)} after {result.duration:.1f} s, '
        f'{_millimetres(result.position_error)} and '
        f'{abs(math.degrees(result.heading_error)):.1f}° from the goal\n'
        f'bounds: {_millimetres(bounds.position_error)} and '
        f'{math.degrees(bounds.heading_error):.1f}°',
        loc='left', fontsize=11, color=WARNING if is_missed else INK)


def _marks_of(result: RunResult) -> RefusalMarks:
    """Look up what stood against a plan at the end of a run."""
    if result.outcome is not Outcome.FAILED or not result.refusals:
        return NO_MARKS
    return result.refusals[-1].failure.marks


def _millimetres(metres: float) -> str:
    return f'{1e3 * metres:.1f} mm' if metres < 0.0995 else f'{1e3 * metres:.0f} mm'


def _segment(axes: Axes, scenario: Scenario, objects: FloatArray, robots: FloatArray,
             segment: StateRows) -> None:
    if segment.push is None:
        axes.plot(robots[:, 0], robots[:, 1], **ROBOT_PATH_STYLE, zorder=6)
        return
    style: dict[str, Any] = {'facecolor': segment.color + '0C', 'edgecolor': segment.color,
                             'linewidth': 0.9}
    axes.plot(robots[:, 0], robots[:, 1], color=segment.color, linewidth=1.0, zorder=6)
    axes.plot(objects[:, 0], objects[:, 1], color=segment.color, linewidth=3.0, zorder=7)
    for row in np.linspace(0, len(objects) - 1, MOMENTS).astype(int)[1:]:
        draw_object(axes, scenario.true_object, objects[row], **style, zorder=3)
        draw_robot(axes, scenario.true_robot.radius, robots[row], **style, zorder=3)
    draw_robot(axes, scenario.true_robot.radius, robots[0], **style, zorder=3)
    draw_push_number(axes, segment.push, robots[0, :2])


def _strip(axes: Axes, result: RunResult, draw: Callable[[Axes, RunResult], None]) -> None:
    """Draw one quantity over time, pushes shaded, failures and new goals marked."""
    time = tape_of(result)['time']
    style_axes(axes)
    draw(axes, result)
    for segment in segments_of(result):
        start, end = time[segment.rows][[0, -1]]
        if segment.push is not None:
            axes.axvspan(start, end, color=segment.color, alpha=0.15, linewidth=0.0, zorder=0.5)
        elif segment.reason:
            axes.axvline(start, color=WARNING, linewidth=1.4)
    axes.set_xlim(0.0, time[-1])


def _pose_errors(result: RunResult) -> FloatArray:
    """Pose of the object minus the goal that is valid at the time, shape (n, 3)."""
    tape, task = tape_of(result), result.scenario.task
    goal_times = [later.time for later in task.goals] if task is not None else []
    goals = np.array(goal_poses(result.scenario))
    return tape.poses('object') - goals[np.searchsorted(goal_times, tape['time'], side='right')]


def _position_error(axes: Axes, result: RunResult) -> None:
    error = 1e3 * np.hypot(*_pose_errors(result)[:, :2].T)
    _log_error(axes, result, np.maximum(error, MIN_POSITION_ERROR),
               1e3 * result.scenario.final_bounds.position_error)
    axes.set_ylabel('position\nerror [mm]')


def _heading_error(axes: Axes, result: RunResult) -> None:
    error = np.abs(wrap_angles(_pose_errors(result)[:, 2]))
    _log_error(axes, result, np.maximum(np.degrees(error), MIN_HEADING_ERROR),
               math.degrees(result.scenario.final_bounds.heading_error))
    axes.set_ylabel('heading\nerror [°]')


def _log_error(axes: Axes, result: RunResult, error: FloatArray, bound: float) -> None:
    axes.set_yscale('log')
    axes.axhline(bound, color=GOAL, linewidth=1.2, linestyle=DASHED_GOAL)
    axes.plot(tape_of(result)['time'], error, color=INK, linewidth=1.4)


def _map_of(result: RunResult) -> OccupancyMap | None:
    task = result.scenario.task
    return None if task is None else task.occupancy_map


def _clearances(axes: Axes, result: RunResult) -> None:
    occupancy_map, tape, scenario = _map_of(result), tape_of(result), result.scenario
    if occupancy_map is None:
        return
    rows = np.linspace(0, len(tape['time']) - 1, CLEARANCE_SAMPLES).astype(int)
    objects, robots = tape.poses('object')[rows], tape.poses('robot')[rows]
    of_object = [occupancy_map.object_clearance(scenario.true_object, [pose]) for pose in objects]
    of_robot = occupancy_map.clearance(robots[:, :2]) - scenario.true_robot.radius
    axes.axhline(0.0, color=WARNING, linewidth=1.2)
    axes.plot(tape['time'][rows], 1e3 * np.array(of_object), color=INK, linewidth=1.4,
              label='object')
    axes.plot(tape['time'][rows], 1e3 * of_robot, color=INK, linewidth=1.0,
              linestyle=(0, (2, 1.2)), label='robot')
    axes.set_ylabel('clearance\n[mm]')
    axes.set_ylim(-20.0, MAX_CLEARANCE)


def _pushing_angle(axes: Axes, result: RunResult) -> None:
    tape, plan = tape_of(result), result.plan
    axes.plot(tape['time'], np.degrees(tape['pushing_angle']), color=INK, linewidth=1.0)
    if plan is not None:
        velocity = plan.contact_twists
        angle = np.arctan2(velocity[:, 1], velocity[:, 0]) - plan.contact_poses[:, 2]
        axes.plot(plan.times, np.degrees(np.arctan2(np.sin(angle), np.cos(angle))), **PLAN_STYLE)
    axes.set_ylabel('pushing\nangle [°]')
    axes.set_ylim(-60.0, 60.0)


def _force_angle(axes: Axes, result: RunResult) -> None:
    tape = tape_of(result)
    coefficient = result.scenario.true_object.contact_friction_coefficient
    limit = math.degrees(math.atan(coefficient))
    for edge in (-limit, limit):
        axes.axhline(edge, **CONE_STYLE)
    axes.plot(tape['time'], np.degrees(force_angle(tape)), color=INK, linewidth=1.0)
    axes.set_ylabel('contact\nforce [°]')
    axes.set_ylim(-1.6 * limit, 1.6 * limit)


def _friction(axes: Axes, scenario: Scenario) -> None:
    """Draw the friction coefficients and centres of friction of nominal and true object."""
    nominal, true = scenario.object, scenario.true_object
    edge = outline(nominal, (0.0, 0.0, 0.0))
    axes.fill(edge[:, 0], edge[:, 1], facecolor='#F6F6F6', edgecolor=INK, linewidth=1.0)
    # Points squared per friction coefficient: the largest disc is as wide as its number.
    scale = 420.0 / max(support.friction_coefficient
                        for support in true.supports + nominal.supports)
    styles: list[dict[str, Any]] = [{'color': '#A6A6A6'}, {
        'facecolor': 'none', 'edgecolor': INK, 'linestyle': '--'}]
    for supports, style in zip((true.supports, nominal.supports), styles):
        axes.scatter([support.x for support in supports], [support.y for support in supports],
                     s=[scale * support.friction_coefficient for support in supports], **style)
    for support in true.supports:
        axes.annotate(f'{support.friction_coefficient:.2f}', (support.x, support.y), fontsize=9,
                      xytext=(math.copysign(16.0, support.x), 0.0), textcoords='offset points',
                      ha='left' if support.x > 0.0 else 'right', va='center', color=INK,
                      bbox={'facecolor': 'white', 'edgecolor': 'none', 'pad': 0.8})
    axes.plot(*friction_center(nominal), '+', color=INK, markersize=12, markeredgewidth=1.8,
              zorder=4)
    axes.plot(*friction_center(true), 'X', color=WARNING, markersize=9)
    axes.set_aspect('equal', adjustable='datalim')
    axes.margins(0.05)
    axes.set_axis_off()
    changes = ', before it changes' if scenario.simulation.friction_changes else ''
    axes.set_title(f'friction under the supports{changes}', fontsize=10, color=INK)


def _legend(axes: Axes, results: Sequence[RunResult]) -> None:
    axes.set_axis_off()
    handles: list[Any] = [
        Line2D([], [], color=GOAL, linestyle=DASHED_GOAL, linewidth=2.6, label='goal; bounds'),
        Line2D([], [], color=PUSH_COLORS[0], linewidth=3.0,
               label='path of the object, in the colour of the push'),
        Line2D([], [], color=PUSH_COLORS[0], linewidth=1.0, label='path of the robot in a push')]
    if any(result.plan is not None for result in results):
        handles.append(Line2D([], [], **PLAN_STYLE, label='plan'))
    if results[0].scenario.task is not None:
        handles += [
            Line2D([], [], **ROBOT_PATH_STYLE, label='path of the robot between pushes'),
            Line2D([], [], color=WARNING, linewidth=1.4, label='failure, or a new goal')]
    handles += refusal_legend(_marks_of(results[0]))
    handles += [
        Line2D([], [], **CONE_STYLE, label='friction cone: within it the contact sticks'),
        Line2D([], [], color=WARNING, marker='X', linestyle='none', markersize=9,
               label='true centre of friction (grey, numbers: true friction)'),
        Line2D([], [], color=INK, marker='+', linestyle='none', markersize=11,
               markeredgewidth=1.8, label='nominal centre of friction (dashed: nominal friction)')]
    axes.legend(handles=handles, loc='center left', frameon=False, fontsize=10, labelspacing=0.5,
                borderaxespad=0.0)
