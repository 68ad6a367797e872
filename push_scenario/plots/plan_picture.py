"""
Picture of a plan, or of why there is none.

A plan is drawn as ghosts of the object, numbered by their pushes, and the robot's ways in between;
a refusal as the place, the room and the faces that stand against it.
"""

import math
from os import PathLike
import textwrap
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Ellipse, Patch, Polygon
import numpy as np
from numpy.typing import NDArray
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_planner.planned_pushes import PlannedPush
from push_planner.refusal_marks import FaceMark, NarrowPlace, NO_MARKS, RefusalMarks
from push_scenario.definition.scenario import Scenario
from push_scenario.first_plan import FirstPlan
from push_scenario.plots.drawing import (
    DASHED_GOAL, draw_map, draw_object, draw_push_number, draw_robot, GOAL, INK, map_extent,
    outline, PUSH_COLORS, ROBOT_PATH_STYLE, style_axes, WARNING)

# Width of the picture [in], its resolution, its least height, and that of title and legend.
WIDTH, DPI, MIN_HEIGHT, TEXT_HEIGHT = 8.0, 80, 2.5, 1.5
# Free rim about all that is drawn [m].
MARGIN = 0.6
# Rim of what lies outside of the map [m], and its colour.
RIM, OUTSIDE = 0.3, '#B8B8B8'
# Points of each segment of a way, and characters in a line of the title.
APPROACH_POINTS, TITLE_WIDTH = 12, 92
UNCERTAIN = '#B35C00'
# Standard deviations that the ellipse of the robot's position shows.
ELLIPSE_SIGMAS = 2.0
OPEN_FLOOR_STYLE: dict[str, Any] = {'color': GOAL, 'linewidth': 1.4,
                                    'linestyle': (0, (1, 2))}
FREE_STYLE: dict[str, Any] = {'facecolor': WARNING + '30', 'edgecolor': WARNING,
                              'linewidth': 1.4}
NEEDED_STYLE: dict[str, Any] = {'facecolor': 'none', 'edgecolor': WARNING, 'linewidth': 1.6,
                                'linestyle': (0, (4, 2))}
ELLIPSE_STYLE: dict[str, Any] = {'facecolor': UNCERTAIN + '50', 'edgecolor': UNCERTAIN,
                                 'linewidth': 1.4}
BLOCKED_STYLE: dict[str, Any] = {'facecolor': 'none', 'edgecolor': WARNING, 'linewidth': 1.2}
ROOM_STYLE: dict[str, Any] = {'facecolor': 'none', 'edgecolor': INK, 'linewidth': 1.2,
                              'linestyle': (0, (2, 2))}
NEAREST_STYLE: dict[str, Any] = {'facecolor': '#FFFFFF80', 'edgecolor': INK, 'linewidth': 1.4,
                                 'linestyle': (0, (4, 2))}
OVERLAP_STYLE: dict[str, Any] = {'facecolor': WARNING + '40', 'edgecolor': WARNING,
                                 'linewidth': 2.0, 'hatch': '////'}


def draw_plan_picture(scenario: Scenario, plan: FirstPlan, path: str | PathLike[str]) -> None:
    """
    Draw the first plan of a task, or why there is none.

    :param path: of the PNG.
    """
    figure = Figure(dpi=DPI, facecolor='white', layout='constrained')
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    request, radius = plan.request, scenario.robot.radius
    _draw_outside(axes, scenario)
    draw_map(axes, scenario)
    draw_object(axes, request.obj, request.object_pose, facecolor='#ECECEC', edgecolor=INK,
                linewidth=1.4, zorder=3)
    draw_object(axes, request.obj, request.goal, facecolor='none', edgecolor=GOAL,
                linewidth=2.6, linestyle=DASHED_GOAL, zorder=5)
    draw_robot(axes, radius, request.robot_pose, facecolor='#8A8A8A', edgecolor=INK,
               linewidth=1.0, zorder=3)
    draw_pushes(axes, request.obj, radius, plan.pushes)
    if _leads_to_open_floor(plan):
        axes.plot(*zip(plan.pushes[-1].end[:2], request.goal[:2]), **OPEN_FLOOR_STYLE, zorder=5)
    marks = NO_MARKS if plan.refusal is None else plan.refusal.marks
    width, height = _set_view(axes, scenario, plan)
    draw_refusal(axes, request.obj, radius, marks)
    title, color = _title(scenario, plan)
    axes.set_title(title, loc='left', fontsize=10, color=color)
    axes.legend(handles=_legend(plan, marks), loc='upper center', bbox_to_anchor=(0.5, -0.08),
                ncols=2, fontsize=9, frameon=False)
    style_axes(axes)
    figure.set_size_inches(WIDTH, max(MIN_HEIGHT, WIDTH * height / width) + TEXT_HEIGHT)
    figure.savefig(path, metadata={'Software': None})


def draw_pushes(axes: Axes, obj: PushedObject, radius: float,
                pushes: tuple[PlannedPush, ...]) -> None:
    """
    Draw planned pushes: ghosts of the object, and the robot's ways between them.

    :param axes: matplotlib axes.
    :param radius: of the robot [m].
    """
    for index, push in enumerate(pushes):
        color = PUSH_COLORS[index % len(PUSH_COLORS)]
        if push.approach is not None:
            axes.plot(*_points_of(push).T, **_approach_style(color), zorder=4)
        axes.plot(*zip(push.start[:2], push.end[:2]), color=color, linewidth=2.4, zorder=5)
        draw_object(axes, obj, push.end, facecolor=color + '18', edgecolor=color,
                    linewidth=1.2, zorder=4)
        draw_robot(axes, radius, push.robot_start, facecolor='none', edgecolor=color,
                   linewidth=0.8, zorder=4)
        draw_push_number(axes, index, push.end[:2])


def draw_refusal(axes: Axes, obj: PushedObject, radius: float, marks: RefusalMarks) -> None:
    """
    Draw what stands against a plan.

    :param axes: matplotlib axes.
    :param radius: of the robot [m].
    """
    if marks.robot_path:
        axes.plot(*zip(*marks.robot_path), **_approach_style(UNCERTAIN), zorder=8)
    if marks.narrow_place is not None:
        _draw_narrow_place(axes, marks.narrow_place)
    for face in marks.faces:
        _draw_face(axes, face, radius)
    if marks.overlap is not None:
        draw_object(axes, obj, marks.overlap, **OVERLAP_STYLE, zorder=8)
    if marks.nearest is not None:
        draw_object(axes, obj, marks.nearest, **NEAREST_STYLE, zorder=7)


def _leads_to_open_floor(plan: FirstPlan) -> bool:
    """Tell whether the last planned push ends before the goal."""
    return bool(plan.pushes) and not plan.request.tolerances._replace(
        heading=math.pi).contain(plan.pushes[-1].end, plan.request.goal)


def _draw_narrow_place(axes: Axes, place: NarrowPlace) -> None:
    """Draw the free floor and the floor that is needed, as discs of these widths."""
    axes.add_patch(Circle((place.x, place.y), 0.5 * place.width, **FREE_STYLE, zorder=8))
    text, reach = f'{place.width:.2f} m free', place.width
    if place.needed_width is not None:
        text += f',\n{place.needed_width:.2f} m needed'
        reach = max(reach, place.needed_width)
        axes.add_patch(Circle((place.x, place.y), 0.5 * place.needed_width, **NEEDED_STYLE,
                              zorder=8))
    if place.ellipse is not None:
        major, minor = (2.0 * ELLIPSE_SIGMAS * half for half in place.ellipse[:2])
        axes.add_patch(Ellipse((place.x, place.y), major, minor,
                               angle=math.degrees(place.ellipse.angle), **ELLIPSE_STYLE,
                               zorder=9))
    # Where there is more of the picture.
    side = 1.0 if place.y < sum(axes.get_ylim()) / 2.0 else -1.0
    axes.annotate(text, (place.x, place.y + 0.5 * side * reach), xytext=(0.0, 5.0 * side),
                  textcoords='offset points', ha='center', va='bottom' if side > 0.0 else 'top',
                  fontsize=9, color=WARNING, zorder=12, bbox={'facecolor': 'white',
                  'edgecolor': 'none', 'alpha': 0.85, 'pad': 1.0})


def _draw_face(axes: Axes, face: FaceMark, radius: float) -> None:
    """Draw the robot at a face; crossed out where it has no room."""
    axes.add_patch(Circle((face.x, face.y), radius, zorder=7,
                          **(ROOM_STYLE if face.has_room else BLOCKED_STYLE)))
    if not face.has_room:
        axes.plot(face.x, face.y, marker='x', markersize=12, markeredgewidth=2.4, color=WARNING,
                  zorder=8)


def _approach_style(color: str) -> dict[str, Any]:
    return {**ROBOT_PATH_STYLE, 'color': color}


def _points_of(push: PlannedPush) -> NDArray[np.float64]:
    """Sample the robot's way to a push, shape (n, 2)."""
    fractions: NDArray[np.float64] = np.linspace(0.0, 1.0, APPROACH_POINTS).astype(np.float64)
    segments = () if push.approach is None else push.approach.segments
    return np.concatenate([np.zeros((0, 2)), *(segment.poses(fractions)[:, :2]
                                               for segment in segments)])


def _title(scenario: Scenario, plan: FirstPlan) -> tuple[str, str]:
    """Say what is planned, or why nothing is; and in which colour."""
    text = f'{scenario.name.replace("_", " ")}: {plan}'
    return textwrap.fill(text, TITLE_WIDTH), INK if plan.refusal is None else WARNING


def _legend(plan: FirstPlan, marks: RefusalMarks) -> list[Any]:
    handles: list[Any] = [
        Patch(facecolor='#ECECEC', edgecolor=INK, label='object now'),
        Line2D([], [], color=GOAL, linestyle=DASHED_GOAL, linewidth=2.6, label='goal'),
        Line2D([], [], color=INK, marker='o', markerfacecolor='#8A8A8A', markersize=9,
               linestyle='none', label='robot now')]
    if plan.pushes:
        color = PUSH_COLORS[0]
        handles += [
            Patch(facecolor=color + '18', edgecolor=color, label='object after push 1, 2, ...'),
            Line2D([], [], color=color, marker='o', markerfacecolor='none', markersize=9,
                   linestyle='none', label='robot where a push starts'),
            Line2D([], [], label="robot's way to it", **_approach_style(color))]
    if _leads_to_open_floor(plan):
        handles.append(Line2D([], [], label='open floor: planned when it gets there',
                              **OPEN_FLOOR_STYLE))
    return [*handles, *refusal_legend(marks)]


def refusal_legend(marks: RefusalMarks) -> list[Any]:
    """List the entries of a legend for the marks of a refusal."""
    handles: list[Any] = []
    if marks.robot_path:
        handles.append(Line2D([], [], label='way that the robot may not go',
                              **_approach_style(UNCERTAIN)))
    place = marks.narrow_place
    if place is not None:
        handles.append(Patch(label='free floor', **FREE_STYLE))
        if place.needed_width is not None:
            handles.append(Patch(label='floor that is needed', **NEEDED_STYLE))
        if place.ellipse is not None:
            handles.append(Patch(label='where the robot may be (2 standard deviations)',
                                 **ELLIPSE_STYLE))
    if any(not face.has_room for face in marks.faces):
        handles.append(Line2D([], [], color=WARNING, marker='x', markersize=9, linestyle='none',
                              markeredgewidth=2.4, label='no room for the robot at this face'))
    if any(face.has_room for face in marks.faces):
        handles.append(Line2D([], [], color=INK, marker='o', markerfacecolor='none',
                              markersize=9, linestyle='none',
                              label='room for the robot, but no way there or no push'))
    if marks.nearest is not None:
        handles.append(Patch(label='as near to the goal as the object gets', **NEAREST_STYLE))
    if marks.overlap is not None:
        handles.append(Patch(label='overlaps an obstacle', **OVERLAP_STYLE))
    return handles


def _set_view(axes: Axes, scenario: Scenario, plan: FirstPlan) -> tuple[float, float]:
    """Show all that is drawn but the far map, at equal scale; return width and height [m]."""
    request, radius = plan.request, scenario.robot.radius
    poses = [request.object_pose, request.goal, *(push.end for push in plan.pushes)]
    points = [outline(request.obj, pose) for pose in poses]
    points += [_points_of(push) for push in plan.pushes]
    points.append(_around(request.robot_pose, radius))
    marks = NO_MARKS if plan.refusal is None else plan.refusal.marks
    points.append(np.reshape(np.array(marks.robot_path), (-1, 2)))
    if marks.narrow_place is not None:
        place = marks.narrow_place
        points.append(_around(place, 0.5 * (place.needed_width or place.width)))
    shown = np.concatenate(points)
    low, high = shown.min(axis=0) - MARGIN, shown.max(axis=0) + MARGIN
    map_low, map_high = map_extent(scenario)
    if map_low is not None and map_high is not None:
        low, high = np.maximum(low, map_low - RIM), np.minimum(high, map_high + RIM)
    # Not taller than wide.
    beside = max(0.0, float((high - low)[1] - (high - low)[0])) / 2.0
    low[0], high[0] = low[0] - beside, high[0] + beside
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect('equal')
    return float(high[0] - low[0]), float(high[1] - low[1])


def _draw_outside(axes: Axes, scenario: Scenario) -> None:
    """Shade what lies outside of the map, where nothing may move."""
    occupancy_map = None if scenario.task is None else scenario.task.occupancy_map
    if occupancy_map is None:
        return
    rows, columns = occupancy_map.occupied.shape
    corners = occupancy_map.resolution * np.array([[0, 0], [columns, 0], [columns, rows],
                                                   [0, rows]])
    axes.set_facecolor(OUTSIDE)
    axes.add_patch(Polygon(occupancy_map.from_map(corners), facecolor='white', zorder=0.4))


def _around(place: Pose | NarrowPlace, radius: float) -> NDArray[np.float64]:
    """Corners of the square about a place, shape (2, 2)."""
    return np.array([[place.x - radius, place.y - radius], [place.x + radius, place.y + radius]])
