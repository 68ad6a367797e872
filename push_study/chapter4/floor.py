"""Friction at the four supports that changes with time, and how it is tabled and drawn."""

import dataclasses
import math

import numpy as np
from push_model.friction import friction_center
from push_sim_node.disturbance import friction_factors, FrictionChange
from push_study.framework import paper
from push_study.framework.scenes import box

# In the order of the corners of the box; it is pushed towards the front.
SUPPORTS = ('rear_right', 'front_right', 'front_left', 'rear_left')
SIDES = {'right': (0, 1), 'left': (2, 3)}


def spell(side, factor, begin, end):
    """
    Change the friction of the supports on one side for a while.

    :param side: one of ``SIDES``.
    :param factor: on their friction.
    :param begin: [s].
    :param end: [s].
    :return: tuple of ``FrictionChange``.
    :raises ValueError: where there is no such side.
    """
    if side not in SIDES:
        raise ValueError(f'side: got {side!r}, expected one of {", ".join(SIDES)}')
    return tuple(FrictionChange(begin, end, factor, support) for support in SIDES[side])


def gaussian(seed, deviation, period, duration):
    """
    Draw the friction of every support anew, again and again.

    :param seed: of the draws.
    :param deviation: standard deviation, as a share of the friction.
    :param period: between the draws [s].
    :param duration: until friction is as it was [s].
    :return: tuple of ``FrictionChange``; no friction is below zero.
    """
    drawn = np.random.default_rng(seed).standard_normal((round(duration / period), len(SUPPORTS)))
    factors = np.maximum(0.0, 1.0 + deviation * drawn).tolist()
    return tuple(FrictionChange(number * period, (number + 1) * period, factor, support)
                 for number, row in enumerate(factors) for support, factor in enumerate(row))


def changed(values, changes, time):
    """
    Return the box with the friction of one moment.

    :param values: ``Values`` with ``scenes.BOX``.
    :param changes: tuple of ``FrictionChange``.
    :param time: [s].
    :return: ``PushedObject``.
    """
    obj = box(values)
    factors = friction_factors(changes, time, len(obj.supports))
    return dataclasses.replace(obj, supports=tuple(
        dataclasses.replace(support, friction_coefficient=factor * support.friction_coefficient)
        for support, factor in zip(obj.supports, factors)))


def friction_table(values, changes, end):
    """
    Table the friction of the supports, and where that puts the friction centre.

    :param values: ``Values`` with ``scenes.BOX``.
    :param changes: tuple of ``FrictionChange``.
    :param end: of the table [s].
    :return: table with the columns time_s, ``SUPPORTS``, center_x_m and center_y_m; values hold
        from their time on.
    """
    times = sorted({0.0, end} | {time for one in changes for time in (one.start, one.end)
                                 if time < end})
    objects = [changed(values, changes, time) for time in times]
    rows = [[*(support.friction_coefficient for support in obj.supports), *friction_center(obj)]
            for obj in objects]
    return {'time_s': np.array(times), **dict(zip((*SUPPORTS, 'center_x_m', 'center_y_m'),
                                                  np.array(rows).T))}


def center_in_sight(path, table):
    """
    Find the angle from the normal at which the contact sees the friction centre.

    :param path: table of a push with the columns of ``plan_scene.PATH``.
    :param table: of ``friction_table``, for the same push.
    :return: angles [rad], shape (n,).
    """
    rows = np.searchsorted(table['time_s'], path['time_s'], side='right') - 1
    c_x, c_y = table['center_x_m'][rows], table['center_y_m'][rows]
    cosine, sine = np.cos(path['theta_rad']), np.sin(path['theta_rad'])
    away_x = path['x_m'] + cosine * c_x - sine * c_y - path['contact_x_m']
    away_y = path['y_m'] + sine * c_x + cosine * c_y - path['contact_y_m']
    angles = np.arctan2(away_y, away_x) - path['normal_rad']
    return np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi


def draw_friction(axes, table, names=SUPPORTS, widths=(3.6, 2.8, 2.0, 1.2)):
    """
    Draw the friction of supports over time.

    :param axes: matplotlib axes.
    :param table: of ``friction_table``.
    :param names: some of ``SUPPORTS``.
    :param widths: of the lines [points]; those of equal friction are nested.
    """
    for number, (name, width) in enumerate(zip(names, widths)):
        axes.step(table['time_s'], table[name], where='post', label=name.replace('_', ' '),
                  **{**paper.series(number), 'linewidth': width})
    axes.set_ylabel('friction of a support')
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(0.0, table['time_s'][-1])
    axes.legend(loc='center left', bbox_to_anchor=(1.0, 0.5))
