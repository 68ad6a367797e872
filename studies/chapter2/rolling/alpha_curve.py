"""Alpha over a pushing location: computed and drawn with equilibria and basin of attraction."""

import math
from typing import Any, Callable

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
import numpy as np
from push_model.geometry import FloatArray
from studies.analysis.pushing_location import PushingLocation
from studies.analysis.stability import equilibria, Equilibrium, tolerances
from studies.framework import plot_style
from studies.framework.study import Table

# Chosen: number of arrows along a curve.
ARROWS = 11
# Chosen: a stability margin below this is rounding [m]; likewise an alpha [rad].
NO_MARGIN = 1e-9
# Name, marker fill and margin [m] of the kinds of equilibria.
EquilibriumKind = tuple[str, Any, Callable[[float], bool]]
KINDS: tuple[EquilibriumKind, ...] = (
    ('stable', 'full', lambda margin: margin > NO_MARGIN),
    ('marginal', 'left', lambda margin: abs(margin) <= NO_MARGIN),
    ('unstable', 'none', lambda margin: margin < -NO_MARGIN))


def middle_equilibrium(location: PushingLocation) -> Equilibrium:
    """
    Find the equilibrium that is nearest to the reference.

    :param location: where the object is pushed.
    :return: the equilibrium.
    """
    return min(equilibria(location), key=lambda equilibrium: abs(equilibrium.rotation))


def compute_tables(location: PushingLocation, column: str, abscissa: FloatArray,
                   rotations: FloatArray, abscissa_at: Callable[[Any], Any]) -> dict[str, Table]:
    """
    Compute alpha, the equilibria, and the basin of the middle one, for a contact that rolls.

    :param location: where the object is pushed.
    :param column: name of the abscissa, with its unit.
    :param abscissa: values over which alpha is drawn, ascending, shape (n,).
    :param rotations: of the object there, from the reference [rad], shape (n,).
    :param abscissa_at: maps a rotation to the abscissa.
    :return: tables ``alpha``, ``equilibria`` and ``basin``, as in ``Outcome``.
    """
    shown = [equilibrium for equilibrium in equilibria(location)
             if abscissa[0] <= abscissa_at(equilibrium.rotation) <= abscissa[-1]]
    middle = middle_equilibrium(location)
    edges = sorted((float(abscissa_at(middle.rotation + tolerance.rotation)), tolerance.limit)
                   for tolerance in tolerances(location, middle, math.inf)
                   if tolerance.rotation)
    alpha = location.alpha(rotations)
    return {'alpha': {column: abscissa, 'alpha_rad': alpha,
                      'turn': np.where(np.abs(alpha) > NO_MARGIN, -np.sign(alpha), 0.0),
                      'rolls': np.ones(len(alpha), int)},
            'equilibria': {column: [float(abscissa_at(equilibrium.rotation))
                                    for equilibrium in shown],
                           'margin_m': [equilibrium.margin for equilibrium in shown]},
            'basin': {column: [edge for edge, _ in edges],
                      'limit': [limit for _, limit in edges]}}


def draw(axes: Axes, tables: dict[str, Table], column: str, label: str) -> None:
    """
    Draw alpha with arrows for the sense of rotation, the equilibria and the basin.

    The curve is solid where the contact rolls, dashed where it slides.

    :param axes: to draw on.
    :param tables: of ``compute_tables``.
    :param column: name of the abscissa.
    :param label: of the abscissa.
    """
    table, edges = tables['alpha'], tables['basin'][column]
    abscissa, alpha, rolls = table[column], table['alpha_rad'], table['rolls'] == 1
    handles: list[Any] = []
    if edges:
        axes.axvspan(*edges, color=plot_style.REGION, linewidth=0.0, zorder=0.5)
        handles.append(Patch(color=plot_style.REGION, label='returns from here'))
    axes.axhline(0.0, color=plot_style.GREY, linewidth=0.8)
    for where, dashes, name in ((rolls, '-', 'rolls'), (~rolls, plot_style.DASHED, 'slides')):
        line, = axes.plot(abscissa, plot_style.split_where(where, alpha),
                          color=plot_style.STABLE, linestyle=dashes, label=f'contact {name}')
        if not rolls.all():
            handles.append(line)
    handles += _draw_equilibria(axes, tables['equilibria'], column)
    axes.set_xlabel(label)
    axes.set_ylabel('$\\alpha$ [rad]; above 0: clockwise'
                    + ('' if rolls.all() else ' while rolling'))
    axes.set_xlim(abscissa[0], abscissa[-1])
    _draw_arrows(axes, table, column, tables['equilibria'][column])
    axes.legend(handles=handles, loc='lower left', bbox_to_anchor=(0.0, 1.0), ncols=4,
                borderaxespad=0.2, columnspacing=1.4, handletextpad=0.6, handlelength=2.6)


def draw_rolling_range(axes: Axes, low: float, high: float, friction: float) -> None:
    """
    Mark where the contact force leaves the friction cone.

    :param axes: with the pushing angle as abscissa, and alpha drawn.
    :param low: least pushing angle of a contact that rolls [rad].
    :param high: greatest one [rad].
    :param friction: of the contact.
    """
    left, right = axes.get_xlim()
    abscissa, alpha = map(np.asarray, axes.get_lines()[1].get_data())
    for edge in (low, high):
        if left < edge < right:
            # On the side of the axis where the curve and its arrows are not.
            is_above = np.interp(edge, abscissa, alpha) < 0.0
            height, alignment = (0.97, 'top') if is_above else (0.03, 'bottom')
            axes.axvline(edge, color=plot_style.UNSTABLE, linewidth=1.0, linestyle=(0, (1, 2)))
            axes.annotate(f'slides, $\\mu_c$ = {friction:g}', (edge, height), (4, 0),
                          xycoords=axes.get_xaxis_transform(), textcoords='offset points',
                          color=plot_style.UNSTABLE, fontsize=7.5, rotation=90.0,
                          ha='left', va=alignment)


def _draw_equilibria(axes: Axes, table: Table, column: str) -> list[Line2D]:
    """Mark the equilibria on the axis; return the legend entries."""
    handles: list[Line2D] = []
    for name, fill, belongs in KINDS:
        positions = [position for position, margin in zip(table[column], table['margin_m'])
                     if belongs(margin)]
        color = plot_style.UNSTABLE if fill == 'none' else plot_style.STABLE
        style: dict[str, Any] = {
            'marker': 'o', 'markersize': 7.0, 'fillstyle': fill, 'linestyle': 'none',
            'color': color, 'markerfacecoloralt': 'white', 'markeredgewidth': 1.5}
        if positions:
            axes.plot(positions, np.zeros(len(positions)), zorder=4, clip_on=False, **style)
            handles.append(Line2D([], [], label=f'{name} equilibrium', **style))
    return handles


def _draw_arrows(axes: Axes, table: Table, column: str, marks: list[float]) -> None:
    """Draw the sense of rotation along the curve, except at rest and near the marks."""
    abscissa, alpha, turn = table[column], table['alpha_rad'], table['turn']
    height, width = np.ptp(alpha), abscissa[-1] - abscissa[0]
    axes.set_ylim(alpha.min() - 0.2 * height, alpha.max() + 0.2 * height)
    steepness = np.hypot(1.0, np.gradient(alpha, abscissa) * width / height)
    for index in np.linspace(0, len(abscissa) - 1, 2 * ARROWS + 1).astype(int)[1::2]:
        near = any(abs(abscissa[index] - mark) < 0.035 * width for mark in marks)
        if not near and turn[index]:
            # Beside the curve, away from the axis, so that they hide neither.
            beside = math.copysign(min(0.12, 0.065 * steepness[index]) * height, alpha[index])
            plot_style.rotation_arrow(axes, abscissa[index], alpha[index] + beside,
                                      clockwise=bool(turn[index] < 0.0), size=8.0)
