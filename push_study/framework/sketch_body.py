"""What sketches show: objects on their feet, robots, points, mass centres."""

import math

from matplotlib.patches import Circle, Polygon
from matplotlib.path import Path
import numpy as np
from push_study.framework import paper
from push_study.framework.sketch import label


def solid(axes, obj, pose, ghost=False):
    """
    Draw an object's outline and feet.

    :param axes: matplotlib axes.
    :param obj: the ``PushedObject``.
    :param pose: its ``Pose``.
    :param ghost: whether it is only there for comparison.
    """
    look = {'facecolor': 'none' if ghost else '#F1F1F1', 'linewidth': 1.3,
            'zorder': 0.9 if ghost else 1.0,
            'edgecolor': paper.GREY if ghost else paper.INK,
            'linestyle': (0, (4, 2)) if ghost else '-'}
    axes.add_patch(Polygon([pose.transform(corner) for corner in obj.outline], **look)
                   if obj.outline else Circle(pose[:2], obj.radius, **look))
    feet = np.array([pose.transform((foot.x, foot.y)) for foot in obj.supports]).T
    axes.plot(*feet, 's', markersize=4.0, color=look['edgecolor'],
              markerfacecolor='none' if ghost else paper.GREY, zorder=0.9 if ghost else 2.0)


def disc(axes, center, radius, span=(0.0, 2.0 * math.pi), ghost=False):
    """
    Draw a round robot, or a part of its edge.

    :param axes: matplotlib axes.
    :param center: data coordinates.
    :param radius: data coordinates.
    :param span: angles between which the edge is drawn [rad].
    :param ghost: whether it is only there for comparison.
    """
    turns = np.linspace(*span, 200)
    axes.plot(center[0] + radius * np.cos(turns), center[1] + radius * np.sin(turns),
              color=paper.GREY if ghost else paper.INK, linewidth=1.0 if ghost else 2.0,
              linestyle=(0, (4, 2)) if ghost else '-')


def point(axes, at, text='', angle=45.0, gap=9.0, color=paper.INK):
    """
    Draw a labelled point.

    :param axes: matplotlib axes.
    :param at: data coordinates.
    :param text: its label.
    :param angle: direction of the label [deg].
    :param gap: distance to its middle [points].
    :param color: of both.
    """
    axes.plot(*at, 'o', markersize=4.5, color=color, zorder=4.0)
    if text:
        label(axes, at, text, angle, gap, color)


def mass_centre(axes, at, text='$G$', angle=45.0, gap=11.0):
    """
    Draw the sign of a mass centre.

    :param axes: matplotlib axes.
    :param at: data coordinates.
    :param text: its label.
    :param angle: direction of the label [deg].
    :param gap: distance to its middle [points].
    """
    axes.plot(*at, 'o', markersize=9.0, color=paper.INK, markerfacecolor='white', zorder=3.0)
    for start in (0.0, 180.0):
        axes.plot(*at, marker=Path.wedge(start, start + 90.0), markersize=9.0, color=paper.INK,
                  markeredgewidth=0.0, linestyle='none', zorder=3.1)
    label(axes, at, text, angle, gap)
