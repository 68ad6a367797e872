"""A small vocabulary for sketches: labels, arrows, angles, dimensions."""

import math

import numpy as np
from push_study.framework import paper

FORCE, PUSH, FLOOR = paper.SERIES[0][0], paper.SERIES[2][0], paper.SERIES[1][0]


def sheet(axes):
    """
    Make axes a drawing to scale, without frame.

    :param axes: matplotlib axes.
    """
    axes.set_aspect('equal')
    axes.set_axis_off()
    axes.margins(0.07)


def label(axes, at, text, angle, gap=9.0, color=paper.INK, size=9.0):
    """
    Write a text beside a point.

    :param axes: matplotlib axes.
    :param at: the point, data coordinates.
    :param text: to write.
    :param angle: direction from the point to the middle of the text [deg].
    :param gap: distance to it [points].
    :param color: of the text.
    :param size: of the text [points].
    """
    turn = math.radians(angle)
    axes.annotate(text, at, xytext=(gap * math.cos(turn), gap * math.sin(turn)),
                  textcoords='offset points', ha='center', va='center', color=color,
                  fontsize=size, annotation_clip=False)


def arrow(axes, start, vector, text='', color=paper.INK, at=None, side=90.0, gap=8.0, style='-|>'):
    """
    Draw an arrow, labelled beyond its tip or beside its shaft.

    :param axes: matplotlib axes.
    :param start: its tail, data coordinates.
    :param vector: from tail to tip, data coordinates.
    :param text: its label.
    :param color: of arrow and label.
    :param at: part of the shaft beside which the label stands; None for beyond the tip.
    :param side: direction of the label, from that of the arrow, beside the shaft [deg].
    :param gap: distance to the middle of the label [points].
    :param style: of the head, as matplotlib names it.
    """
    tip = start[0] + vector[0], start[1] + vector[1]
    axes.annotate('', tip, xytext=start, annotation_clip=False, arrowprops={
        'arrowstyle': style, 'color': color, 'linewidth': 1.4, 'shrinkA': 0.0, 'shrinkB': 0.0,
        'mutation_scale': 10.0})
    axes.update_datalim([start, tip])
    if text:
        part = 1.0 if at is None else at
        heading = math.degrees(math.atan2(vector[1], vector[0]))
        label(axes, (start[0] + part * vector[0], start[1] + part * vector[1]), text,
              heading + (0.0 if at is None else side), gap, color)


def angle(axes, center, radius, start, end, text, color=paper.INK, gap=9.0, at=0.5):
    """
    Draw an angle as an arc with a head at its end, labelled along it.

    :param axes: matplotlib axes.
    :param center: of the arc, data coordinates.
    :param radius: of the arc, data coordinates.
    :param start: where the angle begins [rad].
    :param end: where it ends; clockwise where it is less [rad].
    :param text: its label.
    :param color: of arc and label.
    :param gap: from the arc to the middle of the label [points]; below 0 inside.
    :param at: part of the arc at which the label stands.
    """
    turns = np.linspace(start, end, 40)
    x, y = center[0] + radius * np.cos(turns), center[1] + radius * np.sin(turns)
    axes.plot(x[:-3], y[:-3], color=color, linewidth=1.0)
    axes.annotate('', (x[-1], y[-1]), xytext=(x[-5], y[-5]), annotation_clip=False,
                  arrowprops={'arrowstyle': '-|>', 'color': color, 'linewidth': 0.8,
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 7.0})
    middle = start + at * (end - start)
    label(axes, (center[0] + radius * math.cos(middle), center[1] + radius * math.sin(middle)),
          text, math.degrees(middle), gap, color)


def dimension(axes, start, end, text, shift=0.0, side=1, gap=8.0):
    """
    Draw a dimension line between two points.

    :param axes: matplotlib axes.
    :param start: a point, data coordinates.
    :param end: another.
    :param text: its label.
    :param shift: of the line to the left of the way from start to end, data coordinates.
    :param side: 1 for a label on the left, -1 on the right.
    :param gap: from the line to the middle of the label [points].
    """
    heading = math.atan2(end[1] - start[1], end[0] - start[0])
    off = np.array((-math.sin(heading), math.cos(heading)))
    a, b = np.add(start, shift * off), np.add(end, shift * off)
    for near, far in ((start, a), (end, b)):
        line(axes, near, far, color=paper.GREY, linewidth=0.6)
    arrow(axes, a, b - a, text, paper.INK, 0.5, 90.0 * side, gap, '<|-|>')


def line(axes, start, end, **style):
    """
    Draw a line between two points.

    :param axes: matplotlib axes.
    :param start: a point, data coordinates.
    :param end: another.
    :param style: keywords of ``plot``; a thin dash-dotted line where there are none.
    """
    style = style or {'color': paper.GREY, 'linewidth': 0.8, 'linestyle': (0, (7, 2, 1, 2))}
    axes.plot((start[0], end[0]), (start[1], end[1]), **style)
