"""Draws studies without writing files, and finds texts that lie on lines or on one another."""

from typing import Any

from helpers.study_outcomes import outcome_of, values_of
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox
import numpy as np
from push_model.geometry import FloatArray
from studies.framework import plot_style
from studies.framework.runner import draw_figure
from studies.framework.study import Study


def drawn(study: Study, **overrides: Any) -> Figure:
    """Draw a study as the runner does; return the figure, laid out."""
    values, outcome = values_of(study, **overrides), outcome_of(study, **overrides)
    with plot_style.applied():
        figure = draw_figure(study, outcome, values)
        figure.set_dpi(plot_style.DPI)
        figure.draw_without_rendering()
    return figure


def texts(figure: Figure) -> set[str]:
    """List all texts on a figure's axes."""
    return {text.get_text() for axes in figure.axes for text in axes.texts} - {''}


def collisions(figure: Figure) -> list[tuple[str, str]]:
    """Name each pair of texts that overlap, and each text that a line or an edge crosses."""
    found: list[tuple[str, str]] = []
    for axes in figure.axes:
        marked = [text for text in axes.texts if text.get_text()]
        curves = _curves(axes)
        boxes = [text.get_window_extent().padded(-1.0) for text in marked]
        for i, text in enumerate(marked):
            name, box = text.get_text(), boxes[i]
            found += [(name, marked[j].get_text()) for j in range(i) if box.overlaps(boxes[j])]
            found += [(name, kind) for kind, points in curves if _hits(box, points)]
    return found


def _hits(box: Bbox, points: FloatArray) -> bool:
    return bool(np.any((points[:, 0] > box.x0) & (points[:, 0] < box.x1)
                       & (points[:, 1] > box.y0) & (points[:, 1] < box.y1)))


def _curves(axes: Axes) -> list[tuple[str, FloatArray]]:
    """List lines, arrows and edges as dense points on the screen, shape (n, 2)."""
    to_screen = axes.transData.transform
    curves: list[tuple[str, Any]] = [
        ('line', to_screen(line.get_xydata())) for line in axes.lines
        if line.get_transform() == axes.transData and line.get_linestyle() != 'None']
    curves += [('marker', to_screen(line.get_xydata())) for line in axes.lines
               if line.get_marker() not in ('None', None)]
    curves += [('edge', to_screen(patch.get_path().transformed(
        patch.get_patch_transform()).to_polygons()[0])) for patch in axes.patches]
    curves += [('arrow', to_screen([text.xyann, text.xy])) for text in axes.texts
               if isinstance(text, Annotation) and text.arrow_patch is not None
               and text.anncoords == 'data']
    return [(kind, _dense(curve)) for kind, curve in curves]


def _dense(curve: FloatArray) -> FloatArray:
    sections = [np.linspace(a, b, 200) for a, b in zip(curve[:-1], curve[1:])]
    return np.concatenate(sections) if sections else np.asarray(curve)
