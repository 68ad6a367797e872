"""Steady yaw rate of the box pushed at a corner, over mass, friction and moment of inertia."""

import functools
from typing import Callable

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from push_study.chapter2.corner_push.setup import (
    draw_rates, integrated_push, MAX_SPEED, push_direction, pushed_box, relative_spread, SHAPE,
    speed_samples, steady_yaw_rates,
)
from push_study.framework import plot_style
from push_study.framework.box import FRICTION, MASS
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: speeds at which the motion is integrated for comparison.
CHECKED_SPEEDS = 6
# Chosen: long enough that the integrated yaw rates are steady to 1e-6 at all speeds [s].
SETTLING_TIME = 30.0
# Chosen: curves nearer than this are drawn nested, as they would hide one another.
COINCIDENT = 0.01
MASSES = (Parameter('least_mass', 'kg', 'lightest box', 0.5),
          Parameter('masses_between', 'kg', 'other boxes'),
          Parameter('greatest_mass', 'kg', 'heaviest box', 3.0))
FRICTIONS = Parameter('friction_coefficients', '',
                      'friction of all support points, one per curve')
INERTIA = Parameter('inertia', 'kg m^2', 'moment of inertia of every box')
INERTIAS = Parameter('inertias', 'kg m^2', 'moments of inertia, one per curve')

# Label of a curve -> the box that it belongs to.
Boxes = dict[str, PushedObject]


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
    """Compute the steady yaw rates of several boxes, and integrate some of their motions."""
    objects, direction = make_boxes(values).values(), push_direction(values)
    speeds, checked = speed_samples(values), speed_samples(values, CHECKED_SPEEDS)
    curves = np.array([steady_yaw_rates(obj, direction, speeds) for obj in objects])
    ends = np.array([[integrated_push(obj, direction, speed, (0.0, SETTLING_TIME))[-1, 3]
                      for speed in checked] for obj in objects])
    expected = np.array([steady_yaw_rates(obj, direction, checked) for obj in objects])
    error = ends / expected - 1.0
    findings = {
        'spread': Finding(relative_spread(curves), '',
                          'largest relative difference between the curves'),
        'integrated_spread': Finding(relative_spread(ends), '',
                                     'the same between the ends of the integrated motions'),
        'integration_error': Finding(float(np.abs(error).max()), '', 'largest relative difference '
                                     'of the end of an integrated motion from its curve')}
    return Outcome({'steady': _table(speeds, curves), 'integrated': _table(checked, ends)},
                   findings)


def _draw(make_boxes: Callable[[Values], Boxes], figure: Figure, outcome: Outcome,
          values: Values) -> None:
    """Draw the curves of several boxes."""
    axes, labels = figure.subplots(), list(make_boxes(values))
    speeds, *curves = outcome.tables['steady'].values()
    checked, *ends = outcome.tables['integrated'].values()
    coincide = outcome.findings['spread'].value < COINCIDENT
    draw_rates(axes, speeds, curves, labels, step=2.0 if coincide else 0.0)
    for number, end in enumerate(ends):
        # Rings about rings where the marks coincide.
        size = 5.0 + 3.2 * (len(ends) - 1 - number) if coincide else 5.0
        axes.plot(checked, end, 'o', markersize=size, markerfacecolor='white', clip_on=False,
                  markeredgecolor=plot_style.series(number)['color'], zorder=4)
    axes.plot([], [], 'o', markersize=6.0, markerfacecolor='white',
              markeredgecolor=plot_style.INK, label='end of the\nintegrated\nmotion')
    axes.legend(loc='upper left', bbox_to_anchor=(1.01, 1.0), handlelength=3.5)


def _table(speeds: FloatArray, curves: FloatArray) -> Table:
    return {'speed_m_s': speeds, **{f'omega_{number + 1}_rad_s': curve
                                    for number, curve in enumerate(curves)}}


def _study(figure: str, subject: str, parameters: tuple[Parameter, ...],
           make_boxes: Callable[[Values], Boxes], observation: str, explanation: str) -> Study:
    return Study(figure, f'Box pushed at a corner: steady yaw rate {subject}',
                 (*SHAPE, *parameters, MAX_SPEED), functools.partial(_compute, make_boxes),
                 functools.partial(_draw, make_boxes), observation, explanation)


STUDIES = (
    _study('2.21', 'of light and heavy boxes', (*MASSES, INERTIA, FRICTION), boxes_by_mass,
           'The curves of all masses coincide to rounding, and the integrated motions of all '
           'boxes end on them to better than a millionth.',
           'Friction under the box and the inertia force against its rotation both grow in '
           'proportion to its mass.'),
    _study('2.23', 'and friction on the floor', (MASS, FRICTIONS), boxes_by_friction,
           'The rates of slow pushes coincide and then spread: the greatest exceeds the smallest '
           'by up to {spread:.0%}.',
           'Friction under the box is what rotates it; the more there is, the faster a push may '
           'be before the inertia force against the rotation counts.'),
    _study('2.24', 'and moment of inertia', (MASS, INERTIAS, FRICTION), boxes_by_inertia,
           'One curve holds for all moments of inertia: the integrated motions of all of them end '
           'on it to better than a millionth.',
           'In a steady turn the angular acceleration is 0, and the moment of inertia acts on '
           'nothing else.'))
