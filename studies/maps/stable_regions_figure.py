"""Maps of an object with a band along its outline that is shaded by disturbance tolerance."""

import math
from typing import Any, Sequence

from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import FloatArray
from studies.framework import plot_style
from studies.framework.parameters import Values
from studies.framework.study import Outcome, Table
from studies.maps.perimeter import perimeter_locations, section_ends
from studies.maps.stable_regions import Panel

# Light to dark, so that the order survives grey print; white means no tolerance.
SHADES = LinearSegmentedColormap.from_list('tolerance', ('#FFFFFF', '#A9C4E4', '#3F6FB0',
                                                         '#0B2A6B'))
# Chosen, relative to the outline: inner edge of the band, length of a border mark, and margin.
BAND_EDGE = 0.74
MARK_LENGTH = 0.07
MARGIN = 0.3
# Chosen: the scale ends at a multiple of this [deg].
SCALE_STEP = 5.0
# Chosen: more panels are drawn in two rows.
PANELS_IN_A_ROW = 3
Section = tuple[tuple[float, float], tuple[float, float]]


def draw(panels: Sequence[Panel], figure: Figure, outcome: Outcome, values: Values) -> None:
    """
    Draw all panels.

    :param panels: of the map.
    :param figure: matplotlib figure.
    :param outcome: of ``stable_regions.compute``.
    :param values: its values.
    """
    rows = 1 if len(panels) <= PANELS_IN_A_ROW else 2
    all_axes = figure.subplots(rows, math.ceil(len(panels) / rows), squeeze=False).ravel()
    degrees = np.degrees(outcome.tables['map']['tolerance_rad'])
    norm = Normalize(0.0, max(SCALE_STEP, SCALE_STEP * math.ceil(degrees.max() / SCALE_STEP)))
    fractions = outcome.tables['fractions']['stable_fraction']
    for axes, panel, fraction in zip(all_axes, panels, fractions):
        _draw_panel(axes, panel, outcome.tables, int(values.locations), norm)
        axes.set_title(f'{panel.title}\nstable: {100.0 * fraction:.0f} % of the perimeter')
    for axes in all_axes[len(panels):]:
        axes.set_visible(False)
    for axes in all_axes[:len(panels) - len(all_axes) // rows]:
        axes.set_xlabel('')
    bar = figure.colorbar(ScalarMappable(norm, SHADES), ax=list(all_axes), shrink=0.8, aspect=30)
    bar.set_label('tolerated rotation to the weaker side [deg]\n'
                  'red: borders in closed form; cross: centre of friction', linespacing=1.6)


class _Frame:
    """Extent of an outline, given by points on it of shape (n, 2)."""

    def __init__(self, points: FloatArray) -> None:
        self.low, high = points.min(axis=0), points.max(axis=0)
        self.middle = 0.5 * (self.low + high)
        self.size = float((high - self.low).max())

    def scaled(self, point: Any, factor: float) -> FloatArray:
        """Move points towards the middle, or away from it."""
        return self.middle + factor * (np.asarray(point) - self.middle)

    def fit(self, axes: Axes) -> None:
        """Show the outline, and a part of the robot behind it."""
        half = 0.5 * self.size * (1.0 + MARGIN)
        axes.set_xlim(self.middle[0] - half, self.middle[0] + half)
        axes.set_ylim(self.middle[1] - half, self.middle[1] + half)
        axes.set_aspect('equal')
        axes.grid(False)
        axes.set_xlabel('x [m]')
        axes.set_ylabel('y [m]')


def _draw_panel(axes: Axes, panel: Panel, tables: dict[str, Table], count: int,
                norm: Normalize) -> None:
    table, borders = tables['map'], tables['borders']
    sections = [section_ends(panel.object, location)
                for location in perimeter_locations(panel.object, count)]
    frame = _Frame(np.reshape(sections, (-1, 2)))
    degrees = np.degrees(table['tolerance_rad'])[panel.rows(table)]
    _draw_band(axes, frame, sections, SHADES(norm(degrees)))
    border_points = np.transpose([borders['x_m'], borders['y_m']])[panel.rows(borders)]
    _draw_borders(axes, frame, border_points)
    axes.add_patch(Circle((frame.low[0] - panel.robot_radius, frame.middle[1]),
                          panel.robot_radius, facecolor=plot_style.LIGHT,
                          edgecolor=plot_style.GREY, linewidth=0.8))
    axes.plot(*friction_center(panel.object), marker='+', color=plot_style.INK, markersize=8.0,
              markeredgewidth=1.6)
    frame.fit(axes)


def _draw_band(axes: Axes, frame: _Frame, sections: Sequence[Section], colors: Any) -> None:
    quads: Any = [(start, end, frame.scaled(end, BAND_EDGE), frame.scaled(start, BAND_EDGE))
                  for start, end in sections]
    axes.add_collection(PolyCollection(quads, facecolors=colors, edgecolors='none',
                                       antialiased=False, rasterized=True))
    rim = np.array([start for start, _ in (*sections, sections[0])])
    axes.plot(*rim.T, color=plot_style.INK, linewidth=1.0)
    axes.plot(*frame.scaled(rim, BAND_EDGE).T, color=plot_style.GREY, linewidth=0.5)


def _draw_borders(axes: Axes, frame: _Frame, points: FloatArray) -> None:
    for point in points:
        outward = (point - frame.middle) / np.hypot(*(point - frame.middle))
        axes.plot(*np.transpose([point, point + MARK_LENGTH * frame.size * outward]),
                  color=plot_style.UNSTABLE, linewidth=1.4)
