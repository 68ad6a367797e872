"""Maps of an object with a band round its outline that is shaded by disturbance tolerance."""

import math

import matplotlib
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.patches import Circle
import numpy as np
from push_model.friction import friction_center
from push_study.framework import paper
from push_study.maps.perimeter import ends, places

# Light to dark, so that the order survives grey print; white bears nothing.
SHADES = LinearSegmentedColormap.from_list('tolerance', ('#FFFFFF', '#A9C4E4', '#3F6FB0',
                                                         '#0B2A6B'))
INNER, TICK, WINDOW = 0.74, 0.07, 0.3
STEP = 5.0


def draw(panels, figure, outcome, values):
    """
    Draw all panels.

    :param panels: list of ``perimeter_table.Panel``.
    :param figure: matplotlib figure.
    :param outcome: of ``perimeter_table.compute``.
    :param values: its ``Values``.
    """
    rows = 1 if len(panels) < 4 else 2
    axes = figure.subplots(rows, math.ceil(len(panels) / rows), squeeze=False).ravel()
    table, edges = outcome.tables['map'], outcome.tables['borders']
    degrees = np.degrees(table['tolerance_rad'])
    norm = Normalize(0.0, max(STEP, STEP * math.ceil(degrees.max() / STEP)))
    shares = outcome.tables['shares']['stable_share']
    for one, panel, share in zip(axes, panels, shares):
        cells = [ends(panel.object, place) for place in places(panel.object, values.places)]
        frame = _Frame(np.reshape(cells, (-1, 2)))
        _draw_band(one, frame, cells, SHADES(norm(degrees[panel.rows(table)])))
        _draw_borders(one, frame, np.transpose([edges['x_m'], edges['y_m']])[panel.rows(edges)])
        one.add_patch(Circle((frame.low[0] - panel.robot_radius, frame.middle[1]),
                             panel.robot_radius, facecolor=paper.LIGHT, edgecolor=paper.GREY,
                             linewidth=0.8))
        one.plot(*friction_center(panel.object), marker='+', color=paper.INK, markersize=8.0,
                 markeredgewidth=1.6)
        frame.fit(one)
        one.set_title(f'{panel.title}\nstable: {100.0 * share:.0f} % of the perimeter')
    for one in axes[len(panels):]:
        one.set_visible(False)
    for one in axes[:len(panels) - len(axes) // rows]:
        one.set_xlabel('')
    bar = figure.colorbar(matplotlib.cm.ScalarMappable(norm, SHADES), ax=list(axes), shrink=0.8,
                          aspect=30)
    bar.set_label('turn borne to the weaker side [deg]\n'
                  'red: borders in closed form; cross: friction centre')


class _Frame:
    """Extent of an outline, given by points on it."""

    def __init__(self, points):
        self.low, high = points.min(axis=0), points.max(axis=0)
        self.middle, self.size = 0.5 * (self.low + high), float((high - self.low).max())

    def scaled(self, point, factor):
        """Move a point towards the middle, or away from it."""
        return self.middle + factor * (np.asarray(point) - self.middle)

    def fit(self, axes):
        """Show the outline, with more room behind it for a part of the robot."""
        half = 0.5 * self.size * (1.0 + WINDOW)
        axes.set_xlim(self.middle[0] - half, self.middle[0] + half)
        axes.set_ylim(self.middle[1] - half, self.middle[1] + half)
        axes.set_aspect('equal')
        axes.grid(False)
        axes.set_xlabel('x [m]')
        axes.set_ylabel('y [m]')


def _draw_band(axes, frame, cells, colours):
    quads = [(begin, end, frame.scaled(end, INNER), frame.scaled(begin, INNER))
             for begin, end in cells]
    axes.add_collection(PolyCollection(quads, facecolors=colours, edgecolors='none',
                                       antialiased=False, rasterized=True))
    rim = np.array([begin for begin, _ in (*cells, cells[0])])
    axes.plot(*rim.T, color=paper.INK, linewidth=1.0)
    axes.plot(*frame.scaled(rim, INNER).T, color=paper.GREY, linewidth=0.5)


def _draw_borders(axes, frame, points):
    for point in points:
        away = (point - frame.middle) / np.hypot(*(point - frame.middle))
        axes.plot(*np.transpose([point, point + TICK * frame.size * away]),
                  color=paper.UNSTABLE, linewidth=1.4)
