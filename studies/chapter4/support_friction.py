"""Friction at the four support points that changes with time: generated, tabulated and drawn."""

import dataclasses
from typing import Sequence

from matplotlib.figure import Figure
import numpy as np
from push_model.friction import friction_center
from push_model.geometry import FloatArray, wrap_angles
from push_model.parameters import PushedObject
from push_sim_node.disturbance import friction_factors, FrictionChange
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Values
from studies.framework.study import Outcome, Table

# In the order of the corners of the box, which is pushed towards the front.
SUPPORTS = ('rear_right', 'front_right', 'front_left', 'rear_left')
SIDES = {'right': (0, 1), 'left': (2, 3)}
# Top left, top right, bottom left, bottom right of the box as it lies in the figures, its front to
# the right.
PANELS = ('rear_left', 'front_left', 'rear_right', 'front_right')


def friction_interval(side: str, factor: float, start: float,
                      end: float) -> tuple[FrictionChange, ...]:
    """
    Change the friction of the support points on one side for an interval.

    :param side: one of ``SIDES``.
    :param factor: on their friction.
    :param start: of the interval [s].
    :param end: of the interval [s].
    :return: one change per support point.
    :raises ValueError: where there is no such side.
    """
    if side not in SIDES:
        raise ValueError(f'side: got {side!r}, expected one of {", ".join(SIDES)}')
    return tuple(FrictionChange(start, end, factor, support) for support in SIDES[side])


def gaussian_friction(seed: int, deviation: float, period: float, duration: float,
                      supports: int = len(SUPPORTS)) -> tuple[FrictionChange, ...]:
    """
    Draw the friction of every support point from a Gaussian, again and again.

    :param seed: of the draws.
    :param deviation: standard deviation over the nominal friction.
    :param period: between the draws [s].
    :param duration: after which friction is nominal again [s].
    :param supports: number of support points.
    :return: changes; no friction is below zero.
    """
    count = round(duration / period)
    samples = np.random.default_rng(seed).standard_normal((count, supports))
    factors = np.maximum(0.0, 1.0 + deviation * samples).tolist()
    return tuple(FrictionChange(index * period, (index + 1) * period, factor, support)
                 for index, row in enumerate(factors) for support, factor in enumerate(row))


def box_at(values: Values, changes: Sequence[FrictionChange], time: float) -> PushedObject:
    """
    Make the box with the friction that it has at a time.

    :param values: with the parameters ``BOX``.
    :param changes: of the friction.
    :param time: [s].
    :return: the box.
    """
    obj = box(values)
    factors = friction_factors(changes, time, len(obj.supports))
    return dataclasses.replace(obj, supports=tuple(
        dataclasses.replace(support, friction_coefficient=factor * support.friction_coefficient)
        for support, factor in zip(obj.supports, factors)))


def friction_table(values: Values, changes: Sequence[FrictionChange], end: float) -> Table:
    """
    Tabulate the friction of the support points, and the centre of friction.

    :param values: with the parameters ``BOX``.
    :param changes: of the friction.
    :param end: of the table [s].
    :return: table with the columns time_s, ``SUPPORTS``, center_x_m and center_y_m; values hold
        from their time on.
    """
    times = sorted({0.0, end} | {time for change in changes for time in (change.start, change.end)
                                 if time < end})
    objects = [box_at(values, changes, time) for time in times]
    rows = [[*(support.friction_coefficient for support in obj.supports), *friction_center(obj)]
            for obj in objects]
    return {'time_s': np.array(times), **dict(zip((*SUPPORTS, 'center_x_m', 'center_y_m'),
                                                  np.array(rows).T))}


def angle_to_friction_center(path: Table, friction: Table) -> FloatArray:
    """
    Find the angle from the contact normal to the line from the contact to the centre of friction.

    :param path: table of a push with the columns ``chapter3.setup.PATH_COLUMNS``, n rows.
    :param friction: of ``friction_table``, for the same push.
    :return: angles [rad], shape (n,).
    """
    rows = np.searchsorted(friction['time_s'], path['time_s'], side='right') - 1
    c_x, c_y = friction['center_x_m'][rows], friction['center_y_m'][rows]
    cosine, sine = np.cos(path['theta_rad']), np.sin(path['theta_rad'])
    line_x = path['x_m'] + cosine * c_x - sine * c_y - path['contact_x_m']
    line_y = path['y_m'] + sine * c_x + cosine * c_y - path['contact_y_m']
    angles = np.arctan2(line_y, line_x) - path['normal_rad']
    return wrap_angles(angles)


def draw_coefficients(figure: Figure, outcome: Outcome, _: Values) -> None:
    """
    Draw the friction of each support point over time, in a panel of its own.

    :param outcome: with the table ``friction``, of ``friction_table``.
    """
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    table = outcome.tables['friction']
    for letter, axes, name in zip('abcd', panels.ravel().tolist(), PANELS):
        axes.step(table['time_s'], table[name], where='post', **plot_style.series(0))
        axes.set_title(f'({letter}) {name.replace("_", " ")}', loc='left')
        axes.set_ylim(0.0, 1.15 * max(table[support].max() for support in SUPPORTS))
        axes.set_xlim(0.0, table['time_s'][-1])
        axes.set_ylabel('friction')
        axes.set_xlabel('time [s]')
        axes.label_outer()
