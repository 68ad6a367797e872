"""Steady yaw rate of the box pushed at a corner, over mass, friction and moment of inertia."""

import functools
import math
from typing import Callable, NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from studies.analysis.steady_turn import steady_force
from studies.chapter2.corner_push.setup import (
    draw_rates, integrated_push, MAX_SPEED, push_direction, pushed_box, relative_range, SHAPE,
    SPEED_LABEL, speed_samples, steady_yaw_rates,
)
from studies.framework import plot_style
from studies.framework.box import FRICTION, MASS
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: speeds at which the motion is integrated.
CHECKED_SPEEDS = 9
# When it is sampled [s]. Chosen: densely while the rate rises, and once after so long that it is
# steady to 1e-6 at all speeds.
TIMES = np.append(np.linspace(0.0, 2.0, 401), 30.0)
# Chosen: the usual definition of a rise time.
RISE_FRACTION = 0.9
RISE_TIME = f'time to {RISE_FRACTION:.0%} of the steady rate'
MASSES = (Parameter('least_mass', 'kg', 'lightest box', 0.5),
          Parameter('masses_between', 'kg', 'other boxes'),
          Parameter('greatest_mass', 'kg', 'heaviest box', 3.0))
FRICTIONS = Parameter('friction_coefficients', '',
                      'friction of all support points, one per curve')
INERTIA = Parameter('inertia', 'kg m^2', 'moment of inertia of every box')
INERTIAS = Parameter('inertias', 'kg m^2', 'moments of inertia, one per curve')

# Label of a curve -> the box that it belongs to.
Boxes = dict[str, PushedObject]


class _BoxRates(NamedTuple):
    """
    Rates of rotation of one box.

    :param curve: steady yaw rates at the speeds that are drawn [rad/s], shape (n,).
    :param steady: the same at the checked speeds, shape (k,).
    :param ends: yaw rates at the end of motions that are integrated at these [rad/s], shape (k,).
    :param rises: when these first reach ``RISE_FRACTION`` of the steady rate [s], shape (k,).
    :param forces: steady contact forces at these [N], shape (k,).
    """

    curve: FloatArray
    steady: FloatArray
    ends: FloatArray
    rises: FloatArray
    forces: FloatArray


def masses(values: Values) -> list[float]:
    """
    List the masses of the boxes.

    :param values: with the parameters ``MASSES``.
    :return: masses in ascending order [kg].
    """
    return [values.least_mass, *values.masses_between, values.greatest_mass]


def boxes_by_mass(values: Values) -> Boxes:
    """
    Make boxes of several masses and one moment of inertia.

    :param values: with the parameters ``MASSES``, ``INERTIA`` and ``FRICTION``.
    :return: boxes by label.
    """
    return {f'{mass:g} kg': pushed_box(values, mass, values.friction_coefficient, values.inertia)
            for mass in masses(values)}


def boxes_by_inertia(values: Values) -> Boxes:
    """
    Make boxes of several moments of inertia and one mass.

    :param values: with the parameters ``INERTIAS``, ``MASS`` and ``FRICTION``.
    :return: boxes by label.
    """
    return {f'{inertia:g} kg m²': pushed_box(values, values.mass, values.friction_coefficient,
                                             inertia)
            for inertia in values.inertias}


def boxes_by_friction(values: Values) -> Boxes:
    """
    Make boxes with several friction coefficients.

    :param values: with the parameters ``FRICTIONS`` and ``MASS``.
    :return: boxes by label.
    """
    return {f'$\\mu$ = {friction:g}': pushed_box(values, values.mass, friction)
            for friction in values.friction_coefficients}


def _compute(make_boxes: Callable[[Values], Boxes], values: Values, _: RunJobs) -> Outcome:
    """Compute steady yaw rates and forces of several boxes, and integrate some motions."""
    speeds, checked = speed_samples(values), speed_samples(values, CHECKED_SPEEDS)
    boxes = [_box_rates(obj, push_direction(values), speeds, checked)
             for obj in make_boxes(values).values()]
    curves, expected, ends, rises, forces = (np.array(column) for column in zip(*boxes))
    findings = {
        'spread': Finding(relative_range(curves), '',
                          'largest relative difference between the curves'),
        'integrated_spread': Finding(relative_range(ends), '',
                                     'the same between the ends of the integrated motions'),
        'integration_error': Finding(float(np.abs(ends / expected - 1.0).max()), '', 'largest '
                                     'relative difference of the end of an integrated motion from '
                                     'its curve'),
        'force_ratio': Finding(float((forces[-1] / forces[0]).mean()), '', 'contact force of the '
                               'last box over that of the first, mean over the speeds'),
        'first_rise': Finding(float(rises[0].max()), 's', f'{RISE_TIME}, first box, slowest rise'),
        'last_rise': Finding(float(rises[-1].max()), 's', 'the same, last box')}
    return Outcome({'steady': _table(speeds, curves), 'integrated': _table(checked, ends),
                    'force': _table(checked, forces, 'force_{}_n'),
                    'rise': _table(checked, rises, 'rise_{}_s')}, findings)


def _box_rates(obj: PushedObject, direction: float, speeds: FloatArray,
               checked: FloatArray) -> _BoxRates:
    """Compute and integrate the motion of one box, pushed in a direction [rad]."""
    steady = steady_yaw_rates(obj, direction, checked)
    motions = [integrated_push(obj, direction, speed, TIMES)[:, 3] for speed in checked]
    forces = [math.hypot(*steady_force(obj, obj.outline[0], direction, speed, direction))
              for speed in checked]
    return _BoxRates(steady_yaw_rates(obj, direction, speeds), steady,
                     np.array([rates[-1] for rates in motions]),
                     np.array(list(map(rise_time, motions, steady))), np.array(forces))


def rise_time(rates: FloatArray, steady: float) -> float:
    """
    Find when a yaw rate first reaches ``RISE_FRACTION`` of its steady value.

    :param rates: at the times ``TIMES`` [rad/s], shape (n,).
    :param steady: value [rad/s].
    :return: time [s].
    """
    fractions = rates / steady
    after = int(np.argmax(fractions >= RISE_FRACTION))
    return float(np.interp(RISE_FRACTION, fractions[after - 1:after + 1],
                           TIMES[after - 1:after + 1]))


def _draw_rates(make_boxes: Callable[[Values], Boxes], figure: Figure, outcome: Outcome,
                values: Values) -> None:
    """Draw the rates of several boxes."""
    axes, labels = figure.subplots(), list(make_boxes(values))
    speeds, *curves = outcome.tables['steady'].values()
    checked, *ends = outcome.tables['integrated'].values()
    draw_rates(axes, speeds, curves, labels, step=0.0)
    for index, end in enumerate(ends):
        axes.plot(checked, end, 'o', markersize=5.0, markerfacecolor='white', clip_on=False,
                  markeredgecolor=plot_style.series(index)['color'], zorder=4)
    axes.plot([], [], 'o', markersize=6.0, markerfacecolor='white',
              markeredgecolor=plot_style.INK, label='end of the\nintegrated\nmotion')
    axes.legend(loc='upper left', bbox_to_anchor=(1.01, 1.0))


def _draw_effects(make_boxes: Callable[[Values], Boxes], figure: Figure, outcome: Outcome,
                  values: Values) -> None:
    """Draw the rate that all boxes share, and what differs: time to reach it, and force."""
    panels, labels = figure.subplots(1, 3), list(make_boxes(values))
    speeds, curve, *_ = outcome.tables['steady'].values()
    checked, *ends = outcome.tables['integrated'].values()
    draw_rates(panels[0], speeds, [curve], ['steady, all boxes'])
    for end, marker in zip(ends, 'o+xs'):
        panels[0].plot(checked, end, marker, markersize=7.0, color=plot_style.INK, clip_on=False,
                       fillstyle='none', zorder=4)
    panels[0].plot([], [], 'o', color=plot_style.INK, fillstyle='none',
                   label='ends of all integrated\nmotions')
    panels[0].legend(loc='lower right')
    for axes, name, label in zip(panels[1:], ('rise', 'force'),
                                 (RISE_TIME.replace(' of the', '\nof the') + ' [s]',
                                  'contact force, steady [N]')):
        checked, *columns = outcome.tables[name].values()
        for index, column in enumerate(columns):
            axes.plot(checked, column, label=labels[index], clip_on=False,
                      **plot_style.series(index))
        axes.set_ylabel(label)
        axes.set_xlabel(SPEED_LABEL)
        axes.set_xlim(0.0, speeds[-1])
        axes.set_ylim(bottom=0.0)
    panels[2].legend(loc='upper left', bbox_to_anchor=(1.01, 1.0))


def _table(speeds: FloatArray, curves: FloatArray, name: str = 'omega_{}_rad_s') -> Table:
    return {'speed_m_s': speeds, **{name.format(index + 1): curve
                                    for index, curve in enumerate(curves)}}


def _study(figure: str, subject: str, parameters: tuple[Parameter, ...],
           make_boxes: Callable[[Values], Boxes], observation: str, explanation: str, *,
           is_shared: bool = True) -> Study:
    """Make a study; the rate is shared where it does not depend on what differs."""
    draw, size = (_draw_effects, (9.6, 3.6)) if is_shared else (_draw_rates, (6.4, 4.2))
    return Study(figure, f'Box pushed at a corner: steady yaw rate {subject}',
                 (*SHAPE, *parameters, MAX_SPEED), functools.partial(_compute, make_boxes),
                 functools.partial(draw, make_boxes), observation, explanation, size)


STUDIES = (
    _study('2.21', 'of light and heavy boxes', (*MASSES, INERTIA, FRICTION), boxes_by_mass,
           'The steady rate is the same for all masses. The heaviest box needs {force_ratio:.0f} '
           'times the force of the lightest. From a box that moves already and does not rotate '
           'it takes {last_rise:.2f} s in place of {first_rise:.2f} s.',
           'Friction and inertia force both grow with the mass.'),
    _study('2.23', 'and friction on the floor', (MASS, FRICTIONS), boxes_by_friction,
           'The rates of slow pushes coincide; those of fast ones differ by up to {spread:.0%}.',
           'Friction rotates the box against the inertia force.', is_shared=False),
    _study('2.24', 'and moment of inertia', (MASS, INERTIAS, FRICTION), boxes_by_inertia,
           'The steady rate does not depend on the moment of inertia; the time to reach it does '
           '({first_rise:.2f} to {last_rise:.2f} s at most, from a box that moves already and '
           'does not rotate).',
           'In a steady turn the angular acceleration is 0.'))
