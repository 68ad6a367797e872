"""One style for all figures: colours and dashes that survive grey print, sources of values."""

import contextlib
import math
import textwrap
from typing import Any, Generator

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D, ScaledTranslation, Transform
import numpy as np
from push_model.geometry import FloatArray
from studies.framework.parameters import Source, Values
from studies.framework.study import Study

# Chosen: 6.4 inch give 832 pixels, the width of a page on a screen.
DPI = 130
INK = '#202020'
GREY = '#7A7A7A'
LIGHT = '#D8D8D8'
# Colour and dashes of curves, dark to light, so that they differ in grey as well.
SERIES: tuple[tuple[str, Any], ...] = (
    ('#0B2A6B', '-'), ('#B3261E', (0, (6, 2))), ('#00795C', (0, (6, 2, 1, 2))),
    ('#D07A00', (0, (2, 1.5))), ('#7B5EA7', (0, (1, 1))), ('#4C9BD6', (0, (8, 2, 2, 2))),
    ('#C2478F', (0, (4, 1))), ('#6B4A2B', (0, (4, 1, 1, 1, 1, 1))), ('#8F8F00', (0, (3, 1, 1, 1))),
    ('#3AA6A0', (0, (10, 2))))
STABLE = '#0B2A6B'
UNSTABLE = '#B3261E'
# Fills: of regions in a plot, such as a friction cone or a basin of attraction, and of objects.
REGION = '#E3EAF4'
OBJECT_FILL = '#F1F1F1'
DASHED: Any = (0, (4, 2))
# Measured on the finished figures: of the 6.5-point line below a figure.
CHARACTERS_PER_INCH = 19
SOURCE_TITLES = {Source.CAPTION: 'From the caption: ', Source.CHOSEN: 'Chosen values: ',
                 Source.OVERRIDE: 'Set by the user: '}


@contextlib.contextmanager
def applied() -> Generator[None, None, None]:
    """Set fonts and lines while a figure is drawn, whatever the user's own settings are."""
    settings = {
        'font.size': 9.0, 'axes.titlesize': 9.5, 'axes.labelsize': 9.0, 'legend.fontsize': 8.0,
        'legend.frameon': False,
        # Long enough that dashes can be told apart.
        'legend.handlelength': 3.6, 'axes.grid': True, 'grid.color': '#E4E4E4',
        'grid.linewidth': 0.6, 'axes.axisbelow': True, 'axes.spines.top': False,
        'axes.spines.right': False, 'lines.linewidth': 1.8, 'svg.hashsalt': 'studies',
        'svg.fonttype': 'none', 'axes.formatter.useoffset': False}
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(settings)
        yield


def series(index: int) -> dict[str, Any]:
    """
    Return colour and dashes of a curve, as keywords of ``plot``.

    :param index: of the curve, from 0.
    :return: keywords.
    """
    color, dashes = SERIES[index % len(SERIES)]
    return {'color': color, 'linestyle': dashes}


def nested_series(index: int, count: int, step: float = 2.2) -> dict[str, Any]:
    """
    Return the line style of a curve that may coincide with others, as keywords of ``plot``.

    :param index: of the curve, from 0; later ones are thinner, so that all remain visible.
    :param count: of the curves.
    :param step: by how much each is thinner than the one before [points].
    :return: keywords.
    """
    color, dashes = SERIES[index % len(SERIES)]
    width = 1.8 + step * (count - 1 - index)
    if step and dashes != '-':
        # Matplotlib counts dashes in line widths; here they are in points, whatever the width.
        dashes = dashes[0], tuple(2.0 * part / width for part in dashes[1])
    return {'color': color, 'linestyle': dashes, 'linewidth': width, 'solid_capstyle': 'butt'}


def annotate(figure: Figure, study: Study, values: Values) -> None:
    """
    Write the title on top, and the parameters with the source of their values below.

    :param figure: matplotlib figure with a constrained layout.
    :param study: which is drawn.
    :param values: of its parameters.
    """
    figure.suptitle(f'{study.label}  {study.title_of(values)}', fontsize=10.5, color=INK, x=0.01,
                    ha='left')
    lines: list[str] = []
    for source, title in SOURCE_TITLES.items():
        texts = [value.text() for value in values if value.source is source]
        if texts:
            lines += textwrap.wrap(title + ', '.join(texts),
                                   int(CHARACTERS_PER_INCH * study.size[0]))
    if lines:
        figure.supxlabel('\n'.join(lines), fontsize=6.5, color=GREY, x=0.01, ha='left')


def rotation_arrow(axes: Axes, x: float, y: float, clockwise: bool, *, size: float = 9.0,
                   color: str = INK) -> None:
    """
    Draw a small curved arrow that shows in which sense an object rotates.

    :param axes: to draw on.
    :param x: of its centre, data coordinates.
    :param y: likewise.
    :param clockwise: sense of rotation.
    :param size: radius of the arc [points].
    :param color: of the arrow.
    """
    left, right = (-0.8 * size, 0.0), (0.8 * size, 0.0)
    tail, tip = (left, right) if clockwise else (right, left)
    axes.annotate('', (x, y), xycoords='data', annotation_clip=True)
    around = _points_around(axes, x, y)
    bend = -0.9 if clockwise else 0.9
    axes.annotate('', xy=tip, xytext=tail, xycoords=around, textcoords=around,
                  arrowprops={'arrowstyle': '-|>', 'color': color, 'linewidth': 1.2,
                              'connectionstyle': f'arc3,rad={bend}',
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 9.0})


def _points_around(axes: Axes, x: float, y: float) -> Transform:
    """Make coordinates in points, with a point of the data as origin."""
    figure = axes.get_figure()
    assert figure is not None
    # The stubs know affine transforms only; the data may be on logarithmic axes.
    data: Any = axes.transData
    return Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans + ScaledTranslation(x, y, data)


def split_where(condition: Any, values: FloatArray) -> FloatArray:
    """
    Blank out values where a condition does not hold, so that a curve is drawn in parts.

    :param condition: bool, shape (n,).
    :param values: shape (n,).
    :return: values with nan where the condition does not hold, shape (n,).
    """
    return np.where(condition, values, math.nan)
