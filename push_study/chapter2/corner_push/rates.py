"""How fast the box pushed at a corner turns in the end, over the pushing velocity."""

import numpy as np
from push_study.chapter2.corner_push.scene import (
    draw_rates, drawn_speeds, FRICTION, MASS, motion, push_direction, pushed_box, SHAPE, spread,
    steady_rates, TOP_SPEED,
)
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study

CHECKS, SETTLED = 6, 30.0
MASSES = (Parameter('mass_from', 'kg', 'lightest box', 0.5),
          Parameter('masses_between', 'kg', 'other boxes'),
          Parameter('mass_to', 'kg', 'heaviest box', 3.0))
FRICTIONS = Parameter('friction_coefficients', '', 'friction of all supports, one per curve')
INERTIA = Parameter('inertia', 'kg m^2', 'moment of inertia of every box')
INERTIAS = Parameter('inertias', 'kg m^2', 'moments of inertia, one per curve')


def masses(values):
    """
    List the masses of the boxes [kg].

    :param values: ``Values`` with ``MASSES``.
    """
    return [values.mass_from, *values.masses_between, values.mass_to]


def boxes(values):
    """
    Make the boxes that a study compares.

    :param values: ``Values`` with one of the parameters that vary.
    :return: dict of labels to ``PushedObject``.
    """
    if hasattr(values, 'mass_from'):
        return {f'{mass:g} kg': pushed_box(values, mass, values.friction_coefficient,
                                           values.inertia) for mass in masses(values)}
    if hasattr(values, 'inertias'):
        return {f'{inertia:g} kg m²': pushed_box(values, values.mass,
                                                 values.friction_coefficient, inertia)
                for inertia in values.inertias}
    return {f'$\\mu$ = {friction:g}': pushed_box(values, values.mass, friction)
            for friction in values.friction_coefficients}


def compare(values, batch):
    """
    Steady turning rates of several boxes, and what the integrated motion ends at.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    objects, direction = boxes(values).values(), push_direction(values)
    speeds, checked = drawn_speeds(values), drawn_speeds(values, CHECKS)
    curves = np.array([steady_rates(obj, direction, speeds) for obj in objects])
    ends = np.array([[motion(obj, direction, speed, (0.0, SETTLED))[-1, 3] for speed in checked]
                     for obj in objects])
    off = ends / np.array([steady_rates(obj, direction, checked) for obj in objects]) - 1.0
    findings = {'spread': Finding(spread(curves), '', 'largest relative distance of the curves'),
                'integrated_spread': Finding(spread(ends), '', 'the same where the integrated '
                                             'motions end'),
                'off': Finding(float(np.abs(off).max()), '', 'largest relative distance of the '
                               'end of an integrated motion from its curve')}
    return Outcome({'steady': _columns(speeds, curves), 'integrated': _columns(checked, ends)},
                   findings)


def draw_compared(figure, outcome, values):
    """
    Draw the curves of several boxes.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes, labels = figure.subplots(), list(boxes(values))
    speeds, *curves = outcome.tables['steady'].values()
    checked, *ends = outcome.tables['integrated'].values()
    coincide = outcome.findings['spread'].value < 0.01
    draw_rates(axes, speeds, curves, labels, 2.0 if coincide else 0.0)
    for number, end in enumerate(ends):
        size = 5.0 + 3.2 * coincide * (len(ends) - 1 - number)
        axes.plot(checked, end, 'o', markersize=size, markerfacecolor='white', clip_on=False,
                  markeredgecolor=paper.series(number)['color'], zorder=4)
    axes.plot([], [], 'o', markersize=6.0, markerfacecolor='white', markeredgecolor=paper.INK,
              label='end of the\nintegrated\nmotion')
    axes.legend(loc='upper left', bbox_to_anchor=(1.01, 1.0), handlelength=3.5)


def _columns(speeds, curves):
    return {'speed_m_s': speeds, **{f'omega_{number + 1}_rad_s': curve
                                    for number, curve in enumerate(curves)}}


STUDIES = (
    Study('2.21', 'Box pushed at a corner: steady turning rate of light and heavy boxes',
          (*SHAPE, *MASSES, INERTIA, FRICTION, TOP_SPEED), compare, draw_compared,
          'The curves of all masses lie on one another to rounding, and the integrated '
          'motions of all boxes end on them to better than a millionth.',
          'Friction under the box and the inertia force against its turn both grow in proportion '
          'to its mass.'),
    Study('2.23', 'Box pushed at a corner: steady turning rate and friction on the floor',
          (*SHAPE, MASS, FRICTIONS, TOP_SPEED), compare, draw_compared,
          'The rates start as one line and then spread: the greatest is above the smallest by up '
          'to {spread:.0%}.',
          'Friction under the box is what turns it; the more there is, the faster a push may be '
          'before the inertia force against the turn counts.'),
    Study('2.24', 'Box pushed at a corner: steady turning rate and moment of inertia',
          (*SHAPE, MASS, INERTIAS, FRICTION, TOP_SPEED), compare, draw_compared,
          'One curve holds for all moments of inertia: the integrated motions of all of them end '
          'on it to better than a millionth.',
          'In a steady turn the angular acceleration is 0, which is all that the moment of '
          'inertia acts upon.'))
