"""Alpha over a pushing location, with the sense of rotation, equilibria and their basin."""

import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
import numpy as np
from push_model.analysis.pushing_location import force_alpha
from push_model.analysis.stability import equilibria, tolerances
from push_study.framework import paper

ARROWS, NO_MARGIN = 11, 1e-9
DASHES = (0, (4, 2))
BASIN = '#E3EAF4'
KINDS = (('stable', 'full', lambda margin: margin > NO_MARGIN),
         ('marginal', 'left', lambda margin: abs(margin) <= NO_MARGIN),
         ('unstable', 'none', lambda margin: margin < -NO_MARGIN))


def middle(location):
    """
    Find the equilibrium that is nearest to the reference.

    :param location: ``PushingLocation``.
    :return: ``Equilibrium``.
    """
    return min(equilibria(location), key=lambda one: abs(one.rotation))


def tables(location, column, places, turns, place, contact_friction):
    """
    Tables of alpha, of the equilibria and of the basin of the one nearest to the reference.

    :param location: ``PushingLocation``.
    :param column: name of what alpha is drawn over, with its unit.
    :param places: values of it, ascending, shape (n,).
    :param turns: of the object there [rad], shape (n,).
    :param place: function of a turn that returns the place.
    :param contact_friction: mu_c; infinite where the contact is not to slide.
    :return: dict of tables, as in ``Outcome``.
    """
    # Where the contact slides, the push is no longer imposed at C and alpha = 0 means nothing.
    found = [one for one in equilibria(location) if places[0] <= place(one.rotation) <= places[-1]
             and abs(one.rho) <= math.atan(contact_friction)]
    start = middle(location)
    edges = sorted((float(place(start.rotation + one.rotation)), one.limit)
                   for one in tolerances(location, start, contact_friction) if one.rotation)
    force = force_alpha(location, turns, contact_friction)
    alpha = location.alpha(turns)
    return {'alpha': {column: places, 'alpha_rad': alpha, 'force_alpha_rad': force,
                      'rolls': (force == alpha).astype(int)},
            'equilibria': {column: [float(place(one.rotation)) for one in found],
                           'margin_m': [one.margin for one in found]},
            'basin': {column: [edge for edge, _ in edges],
                      'limit': [limit for _, limit in edges]}}


def draw(axes, tables, column, label):
    """
    Draw alpha with arrows for the sense of rotation, equilibria and the basin.

    Solid where the contact rolls, dashed where it slides.

    :param axes: matplotlib axes.
    :param tables: of ``tables``.
    :param column: name of what alpha is drawn over.
    :param label: of the horizontal axis.
    """
    table, edges = tables['alpha'], tables['basin'][column]
    places, alpha, rolls = table[column], table['alpha_rad'], table['rolls'] == 1
    handles = []
    if edges:
        axes.axvspan(*edges, color=BASIN, linewidth=0.0, zorder=0.5)
        handles.append(Patch(color=BASIN, label='returns from here'))
    axes.axhline(0.0, color=paper.GREY, linewidth=0.8)
    for where, dashes, name in ((rolls, '-', 'rolls'), (~rolls, DASHES, 'slides')):
        line, = axes.plot(places, paper.split_where(where, alpha), color=paper.STABLE,
                          linestyle=dashes, label=f'contact {name}')
        handles += [] if rolls.all() else [line]
    handles += _mark_equilibria(axes, tables['equilibria'], column)
    axes.set_xlabel(label)
    axes.set_ylabel('$\\alpha$ [rad]; above 0: clockwise'
                    + ('' if rolls.all() else ' while rolling'))
    axes.set_xlim(places[0], places[-1])
    _arrows(axes, table, column, tables['equilibria'][column])
    axes.legend(handles=handles, loc='lower left', bbox_to_anchor=(0.0, 1.0), ncols=4,
                borderaxespad=0.2, columnspacing=1.4, handletextpad=0.6)


def _mark_equilibria(axes, table, column):
    handles = []
    for name, fill, belongs in KINDS:
        places = [place for place, margin in zip(table[column], table['margin_m'])
                  if belongs(margin)]
        look = {'marker': 'o', 'markersize': 7.0, 'fillstyle': fill, 'linestyle': 'none',
                'color': paper.UNSTABLE if fill == 'none' else paper.STABLE,
                'markerfacecoloralt': 'white', 'markeredgewidth': 1.5}
        if places:
            axes.plot(places, np.zeros(len(places)), zorder=4, clip_on=False, **look)
            handles.append(Line2D([], [], label=f'{name} equilibrium', **look))
    return handles


def _arrows(axes, table, column, marks):
    places, alpha, sense = table[column], table['alpha_rad'], table['force_alpha_rad']
    height, width = np.ptp(alpha), places[-1] - places[0]
    axes.set_ylim(alpha.min() - 0.2 * height, alpha.max() + 0.2 * height)
    steep = np.hypot(1.0, np.gradient(alpha, places) * width / height)
    for index in np.linspace(0, len(places) - 1, 2 * ARROWS + 1).astype(int)[1::2]:
        near = any(abs(places[index] - mark) < 0.035 * width for mark in marks)
        if not near and abs(sense[index]) > NO_MARGIN:
            # Beside the curve, away from the axis, so that they hide neither.
            beside = math.copysign(min(0.12, 0.065 * steep[index]) * height, alpha[index])
            paper.rotation_arrow(axes, places[index], alpha[index] + beside,
                                 bool(sense[index] > 0.0), 8.0)
