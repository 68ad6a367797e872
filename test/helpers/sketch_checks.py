"""Draws studies without writing files, and finds texts that lie on lines or on one another."""

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_study.framework import paper
from push_study.framework.run import run_here
from push_study.framework.values import read_table, values_of


def computed(study, **changes):
    """Compute a study; return its values and its outcome."""
    values = values_of(study, read_table(), changes)
    return values, study.compute(values, run_here)


def drawn(study, **changes):
    """Draw a study as the runner does; return the figure, laid out."""
    values, outcome = computed(study, **changes)
    with paper.style():
        figure = Figure(figsize=study.size, layout='constrained', dpi=paper.DPI)
        FigureCanvasAgg(figure)
        study.draw(figure, outcome, values)
        paper.annotate(figure, study, values)
        figure.draw_without_rendering()
    return figure


def texts(figure):
    """All texts on a figure's axes, by what they say."""
    return {text.get_text() for axes in figure.axes for text in axes.texts} - {''}


def collisions(figure):
    """Name each pair of texts that overlap, and each text that a line or an edge crosses."""
    found = []
    for axes in figure.axes:
        marked = [text for text in axes.texts if text.get_text()]
        lines = _lines(axes)
        boxes = [text.get_window_extent().padded(-1.0) for text in marked]
        for i, text in enumerate(marked):
            name, box = text.get_text(), boxes[i]
            found += [(name, marked[j].get_text()) for j in range(i) if box.overlaps(boxes[j])]
            found += [(name, what) for what, points in lines if _hit(box, points)]
    return found


def _hit(box, points):
    return bool(np.any((points[:, 0] > box.x0) & (points[:, 0] < box.x1)
                       & (points[:, 1] > box.y0) & (points[:, 1] < box.y1)))


def _lines(axes):
    """Lines, arrows and edges as dense points on the screen."""
    ways = [('line', axes.transData.transform(line.get_xydata())) for line in axes.lines
            if line.get_transform() == axes.transData and line.get_linestyle() != 'None']
    ways += [('marker', axes.transData.transform(line.get_xydata())) for line in axes.lines
             if line.get_marker() not in ('None', None)]
    ways += [('edge', axes.transData.transform(patch.get_path().transformed(
        patch.get_patch_transform()).to_polygons()[0])) for patch in axes.patches]
    ways += [('arrow', axes.transData.transform([text.xyann, text.xy])) for text in axes.texts
             if text.arrow_patch is not None and text.anncoords == 'data']
    return [(what, _dense(way)) for what, way in ways]


def _dense(way):
    parts = [np.linspace(a, b, 200) for a, b in zip(way[:-1], way[1:])]
    return np.concatenate(parts) if parts else np.asarray(way)
