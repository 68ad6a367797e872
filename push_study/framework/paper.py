"""One look for all pictures: colours and line styles that survive grey print, source of values."""

import contextlib
import math
import textwrap

import matplotlib
import numpy as np

DPI = 130
INK, GREY, LIGHT = '#202020', '#7A7A7A', '#D8D8D8'
# Dark to light, so that they differ in grey as well; each has a dash pattern of its own.
SERIES = (('#0B2A6B', '-'), ('#B3261E', (0, (6, 2))), ('#00795C', (0, (6, 2, 1, 2))),
          ('#D07A00', (0, (2, 1.5))), ('#7B5EA7', (0, (1, 1))), ('#4C9BD6', (0, (8, 2, 2, 2))))
STABLE, UNSTABLE = '#0B2A6B', '#B3261E'
# Marked text is looked up by this many characters per inch of a 7-point line.
CHARACTERS_PER_INCH = 19


@contextlib.contextmanager
def style():
    """Set fonts and lines while a picture is drawn, whatever the user's own settings are."""
    settings = {
        'font.size': 9.0, 'axes.titlesize': 9.5, 'axes.labelsize': 9.0, 'legend.fontsize': 8.0,
        'legend.frameon': False, 'axes.grid': True, 'grid.color': '#E4E4E4',
        'grid.linewidth': 0.6, 'axes.axisbelow': True, 'axes.spines.top': False,
        'axes.spines.right': False, 'lines.linewidth': 1.8, 'svg.hashsalt': 'push_study',
        'svg.fonttype': 'none', 'axes.formatter.useoffset': False}
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(settings)
        yield


def series(number):
    """
    Colour and dash pattern of a curve, as keywords of ``plot``.

    :param number: of the curve, from 0.
    """
    colour, dashes = SERIES[number % len(SERIES)]
    return {'color': colour, 'linestyle': dashes}


def annotate(figure, study, values):
    """
    Write the title on top, and below where the parameters come from.

    :param figure: matplotlib figure with a constrained layout.
    :param study: the ``Study``.
    :param values: its ``Values``.
    """
    figure.suptitle(f'{study.figure}  {study.title}', fontsize=10.5, color=INK, x=0.01, ha='left')
    lines = []
    for source, title in (('caption', 'As captioned: '), ('ours', 'Our values: '),
                          ('set', 'Set by hand: ')):
        texts = [value.text() for value in values if value.source == source]
        if texts:
            lines += textwrap.wrap(title + ', '.join(texts),
                                   int(CHARACTERS_PER_INCH * study.size[0]))
    if lines:
        figure.supxlabel('\n'.join(lines), fontsize=6.5, color=GREY, x=0.01, ha='left')


def rotation_arrow(axes, x, y, clockwise, size=9.0, color=INK):
    """
    Draw a small curved arrow that tells the sense in which the object turns.

    :param axes: matplotlib axes.
    :param x: its middle, data coordinates.
    :param y: the same.
    :param clockwise: sense.
    :param size: radius of the arc [points].
    :param color: of the arrow.
    """
    bend = 0.9 if clockwise else -0.9
    left, right = (-0.8 * size, 0.0), (0.8 * size, 0.0)
    axes.annotate('', (x, y), xycoords='data', annotation_clip=True)
    axes.annotate('', xy=right if clockwise else left, xytext=left if clockwise else right,
                  xycoords=_around(axes, x, y), textcoords=_around(axes, x, y),
                  arrowprops={'arrowstyle': '-|>', 'color': color, 'linewidth': 1.2,
                              'connectionstyle': f'arc3,rad={-bend if clockwise else -bend}',
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 9.0})


def _around(axes, x, y):
    """Coordinates in points about a place in the data."""
    figure = axes.get_figure()
    return (matplotlib.transforms.Affine2D().scale(1.0 / 72.0) + figure.dpi_scale_trans
            + matplotlib.transforms.ScaledTranslation(x, y, axes.transData))


def split_where(condition, values):
    """
    Blank out values where a condition does not hold, so that a curve is drawn in parts.

    :param condition: array of bool.
    :param values: array.
    :return: array with nan where not.
    """
    return np.where(condition, values, math.nan)
