"""
Drawing primitives of sketches: objects, robots and points; arrows, angles and dimensions.

Positions and lengths are in data coordinates unless points (1/72 inch) are stated. Every function
draws on the matplotlib axes that it is given.
"""

import math
from typing import Any, Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from matplotlib.path import Path
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from studies.framework import plot_style

# Colours of what belongs to the contact force, to the imposed motion and to floor friction.
FORCE: str = plot_style.SERIES[0][0]
PUSH: str = plot_style.SERIES[2][0]
FLOOR: str = plot_style.SERIES[1][0]
CENTER_LINE: Any = (0, (7, 2, 1, 2))

# (x, y), or an array of shape (2,).
Point = Any


def set_up(axes: Axes) -> None:
    """
    Make axes a drawing to scale, without frame.

    :param axes: to draw on.
    """
    axes.set_aspect('equal')
    axes.set_axis_off()
    axes.margins(0.07)


def same_scale(panels: Sequence[Axes]) -> None:
    """
    Show sketches that stand side by side to one scale, with their titles at one height.

    :param panels: from the left to the right, all drawn.
    """
    height = max(float(np.ptp(axes.get_ylim())) for axes in panels)
    for axes in panels:
        middle = float(np.mean(axes.get_ylim()))
        axes.set_ylim(middle - 0.5 * height, middle + 0.5 * height)
    spec = panels[0].get_subplotspec()
    assert spec is not None
    spec.get_gridspec().set_width_ratios([float(np.ptp(axes.get_xlim())) for axes in panels])


def pushed_object(axes: Axes, obj: PushedObject, pose: Pose, ghost: bool = False) -> None:
    """
    Draw the outline and the support points of an object.

    :param axes: to draw on.
    :param obj: the object.
    :param pose: of its frame.
    :param ghost: whether it is there for comparison only, and dashed.
    """
    color = plot_style.GREY if ghost else plot_style.INK
    style: dict[str, Any] = {
        'facecolor': 'none' if ghost else plot_style.OBJECT_FILL, 'edgecolor': color,
        'linewidth': 1.3, 'linestyle': plot_style.DASHED if ghost else '-',
        'zorder': 0.9 if ghost else 1.0}
    if obj.outline:
        axes.add_patch(Polygon([pose.transform(corner) for corner in obj.outline], **style))
    else:
        axes.add_patch(Circle(pose[:2], obj.radius, **style))
    supports = np.array([pose.transform((support.x, support.y)) for support in obj.supports]).T
    axes.plot(*supports, 's', markersize=4.0, color=color,
              markerfacecolor='none' if ghost else plot_style.GREY, zorder=0.9 if ghost else 2.0)


def robot(axes: Axes, center: Point, radius: float,
          span: tuple[float, float] = (0.0, 2.0 * math.pi)) -> None:
    """
    Draw the edge of a round robot, or a part of it.

    :param axes: to draw on.
    :param center: of the robot.
    :param radius: of the robot.
    :param span: angles between which the edge is drawn [rad].
    """
    angles = np.linspace(*span, 200)
    axes.plot(center[0] + radius * np.cos(angles), center[1] + radius * np.sin(angles),
              color=plot_style.INK, linewidth=2.0, linestyle='-')


def point(axes: Axes, at: Point, text: str = '', angle: float = 45.0, gap: float = 9.0,
          color: str = plot_style.INK) -> None:
    """
    Draw a labelled point.

    :param axes: to draw on.
    :param at: position.
    :param text: of the label.
    :param angle: direction of the label [deg].
    :param gap: distance to its middle [points].
    :param color: of point and label.
    """
    axes.plot(*at, 'o', markersize=4.5, color=color, zorder=4.0)
    if text:
        label(axes, at, text, angle, gap=gap, color=color)


def mass_center(axes: Axes, at: Point, text: str = '$G$', angle: float = 45.0,
                gap: float = 11.0) -> None:
    """
    Draw the symbol of a centre of mass.

    :param axes: to draw on.
    :param at: position.
    :param text: of the label.
    :param angle: direction of the label [deg].
    :param gap: distance to its middle [points].
    """
    axes.plot(*at, 'o', markersize=9.0, color=plot_style.INK, markerfacecolor='white', zorder=3.0)
    for start in (0.0, 180.0):
        axes.plot(*at, marker=Path.wedge(start, start + 90.0), markersize=9.0,
                  color=plot_style.INK, markeredgewidth=0.0, linestyle='none', zorder=3.1)
    label(axes, at, text, angle, gap=gap)


def label(axes: Axes, at: Point, text: str, angle: float, *, gap: float = 9.0,
          color: str = plot_style.INK, size: float = 9.0) -> None:
    """
    Write a text beside a point.

    :param axes: to draw on.
    :param at: position of the point.
    :param text: to write.
    :param angle: direction from the point to the middle of the text [deg].
    :param gap: distance to it [points].
    :param color: of the text.
    :param size: of the text [points].
    """
    direction = math.radians(angle)
    axes.annotate(text, at, xytext=(gap * math.cos(direction), gap * math.sin(direction)),
                  textcoords='offset points', ha='center', va='center', color=color,
                  fontsize=size, annotation_clip=False)


def arrow(axes: Axes, start: Point, vector: Point, text: str = '', color: str = plot_style.INK, *,
          at: float | None = None, side: float = 90.0, gap: float = 8.0,
          style: str = '-|>') -> None:
    """
    Draw an arrow, labelled beyond its tip or beside its shaft.

    :param axes: to draw on.
    :param start: position of its tail.
    :param vector: from tail to tip.
    :param text: of the label.
    :param color: of arrow and label.
    :param at: fraction of the shaft beside which the label stands; None for beyond the tip.
    :param side: direction of a label beside the shaft, from that of the arrow [deg].
    :param gap: distance to the middle of the label [points].
    :param style: of the head, as matplotlib names it.
    """
    tip = start[0] + vector[0], start[1] + vector[1]
    axes.annotate('', tip, xytext=start, annotation_clip=False, arrowprops={
        'arrowstyle': style, 'color': color, 'linewidth': 1.4, 'shrinkA': 0.0, 'shrinkB': 0.0,
        'mutation_scale': 10.0})
    axes.update_datalim([start, tip])
    if not text:
        return
    heading = math.degrees(math.atan2(vector[1], vector[0]))
    fraction, direction = (1.0, heading) if at is None else (at, heading + side)
    position = start[0] + fraction * vector[0], start[1] + fraction * vector[1]
    label(axes, position, text, direction, gap=gap, color=color)


def angle(axes: Axes, center: Point, radius: float, span: tuple[float, float], text: str, *,
          color: str = plot_style.INK, gap: float = 9.0, at: float = 0.5) -> None:
    """
    Draw an angle as an arc with a head at its end, labelled along it.

    :param axes: to draw on.
    :param center: of the arc.
    :param radius: of the arc.
    :param span: where the angle begins and ends; clockwise where the end is less [rad].
    :param text: of the label.
    :param color: of arc and label.
    :param gap: from the arc to the middle of the label [points]; below 0 inside.
    :param at: fraction of the arc at which the label stands.
    """
    start, end = span
    angles = np.linspace(start, end, 40)
    x, y = center[0] + radius * np.cos(angles), center[1] + radius * np.sin(angles)
    axes.plot(x[:-3], y[:-3], color=color, linewidth=1.0)
    axes.annotate('', (x[-1], y[-1]), xytext=(x[-5], y[-5]), annotation_clip=False,
                  arrowprops={'arrowstyle': '-|>', 'color': color, 'linewidth': 0.8,
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 7.0})
    middle = start + at * (end - start)
    position = center[0] + radius * math.cos(middle), center[1] + radius * math.sin(middle)
    label(axes, position, text, math.degrees(middle), gap=gap, color=color)


def dimension(axes: Axes, start: Point, end: Point, text: str, *, shift: float = 0.0,
              side: int = 1, gap: float = 8.0) -> None:
    """
    Draw a dimension line between two points.

    :param axes: to draw on.
    :param start: one point.
    :param end: the other.
    :param text: of the label.
    :param shift: of the line to the left, seen from start to end.
    :param side: 1 for a label on the left, -1 on the right.
    :param gap: from the line to the middle of the label [points].
    """
    heading = math.atan2(end[1] - start[1], end[0] - start[0])
    left = np.array((-math.sin(heading), math.cos(heading)))
    tail, tip = np.add(start, shift * left), np.add(end, shift * left)
    for near, far in ((start, tail), (end, tip)):
        line(axes, near, far, color=plot_style.GREY, linewidth=0.6)
    arrow(axes, tail, tip - tail, text, plot_style.INK, at=0.5, side=90.0 * side, gap=gap,
          style='<|-|>')


def line(axes: Axes, start: Point, end: Point, **style: Any) -> None:
    """
    Draw a line between two points.

    :param axes: to draw on.
    :param start: one point.
    :param end: the other.
    :param style: keywords of ``plot``; a thin dash-dotted line where there are none.
    """
    style = style or {'color': plot_style.GREY, 'linewidth': 0.8, 'linestyle': CENTER_LINE}
    axes.plot((start[0], end[0]), (start[1], end[1]), **style)


def polar(direction: float, length: float, start: Sequence[float] = (0.0, 0.0)) -> Any:
    """
    Find the point at a distance from another one.

    :param direction: [rad].
    :param length: distance.
    :param start: the other point.
    :return: (x, y).
    """
    return start[0] + length * math.cos(direction), start[1] + length * math.sin(direction)
