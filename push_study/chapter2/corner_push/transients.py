"""How the box pushed at a corner comes to its steady turning rate."""

import numpy as np
from push_study.chapter2.corner_push.rates import boxes, INERTIA, INERTIAS, MASSES, masses
from push_study.chapter2.corner_push.scene import (
    FRICTION, MASS, motion, nested, push_direction, pushed_box, RATE_LABEL, SHAPE, steady_rates,
)
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES, SHARE = 241, 0.9
TIMING = (Parameter('speed', 'm/s', 'speed of the contact'),
          Parameter('duration', 's', 'time that is drawn'))
RISE = f'time to {SHARE:.0%} of the steady rate'


def transients(objects, values):
    """
    Integrate the turning rates over time of boxes that do not turn yet.

    :param objects: the ``PushedObject`` of each curve.
    :param values: ``Values``.
    :return: (table, times to ``SHARE`` of the steady rate [s], shape (k,), relative distances of
        the ends from the steady rate, shape (k,)).
    """
    times, direction = np.linspace(0.0, values.duration, SAMPLES), push_direction(values)
    table, rises, off = {'time_s': times}, [], []
    for number, obj in enumerate(objects):
        omega = motion(obj, direction, values.speed, times)[:, 3]
        steady = steady_rates(obj, direction, [values.speed])[0]
        rises.append(np.interp(SHARE, omega / steady, times))
        off.append(abs(omega[-1] / steady - 1.0))
        table[f'omega_{number + 1}_rad_s'] = omega
    return table, np.array(rises), np.array(off)


def compute_masses(values, batch):
    """
    Transients of light and heavy boxes: load in the middle, or all over the box.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    objects = list(boxes(values).values())
    middle, rises, off = transients(objects, values)
    spread_out = [pushed_box(values, mass, values.friction_coefficient)
                  for mass in masses(values)]
    plate, plate_rises, plate_off = transients(spread_out, values)
    curves = [column for name, column in plate.items() if name != 'time_s']
    findings = {
        'steady': _steady(objects[0], values),
        'lightest': Finding(float(rises[0]), 's', f'{RISE}, lightest box, inertia kept'),
        'heaviest': Finding(float(rises[-1]), 's', f'{RISE}, heaviest box, inertia kept'),
        'plate': Finding(float(plate_rises[0]), 's', f'{RISE}, inertia of a uniform plate'),
        'plate_spread': Finding(float(np.ptp(curves, axis=0).max()), 'rad/s', 'largest distance '
                                'of the curves where the inertia is that of a uniform plate'),
        'off': Finding(float(max(*off, *plate_off)), '', 'largest relative distance of an end '
                       'from the steady rate')}
    return Outcome({'inertia_kept': middle, 'uniform_plate': plate}, findings)


def compute_inertias(values, batch):
    """
    Transients of boxes of one mass whose load lies further in or out.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    objects = list(boxes(values).values())
    table, rises, off = transients(objects, values)
    findings = {'steady': _steady(objects[0], values),
                'least': Finding(float(rises[0]), 's', f'{RISE}, first moment of inertia'),
                'greatest': Finding(float(rises[-1]), 's', f'{RISE}, last moment of inertia'),
                'off': Finding(float(off.max()), '', 'largest relative distance of an end from '
                               'the steady rate')}
    return Outcome({'transients': table}, findings)


def draw(figure, outcome, values):
    """
    Draw the turning rates of each table over time.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    labels = list(boxes(values))
    panels = figure.subplots(1, len(outcome.tables), sharey=True, squeeze=False)[0]
    for axes, (name, table) in zip(panels, outcome.tables.items()):
        times, *curves = table.values()
        coincide = len(panels) > 1 and axes is panels[-1]
        for number, (curve, label) in enumerate(zip(curves, labels)):
            look = nested(number, len(labels)) if coincide else paper.series(number)
            axes.plot(times, curve, label=label, **look)
        axes.axhline(outcome.findings['steady'].value, color=paper.GREY, linewidth=0.8, zorder=1,
                     label='steady rate')
        axes.set_xlim(times[0], times[-1])
        axes.set_xlabel('time [s]')
        axes.locator_params(axis='x', nbins=5)
        if len(panels) > 1:
            axes.set_title(name.replace('_', ' '), loc='left')
    panels[0].set_ylim(bottom=0.0)
    panels[0].set_ylabel(RATE_LABEL)
    panels[-1].legend(loc='lower right', handlelength=3.5)


def _steady(obj, values):
    rate = steady_rates(obj, push_direction(values), [values.speed])[0]
    return Finding(float(rate), 'rad/s', 'steady turning rate')


STUDIES = (
    Study('2.22', 'Box pushed at a corner: transients of light and heavy boxes',
          (*SHAPE, *MASSES, INERTIA, FRICTION, *TIMING), compute_masses, draw,
          'With the same moment of inertia (load added in the middle of the box, left) the '
          'lightest box takes {lightest:.2f} s to 90 % of the rate that all end at, the heaviest '
          '{heaviest:.2f} s; with load spread evenly (right) all take {plate:.2f} s.',
          'Every moment on the box grows with its mass, so that only the share of inertia to mass '
          'is left in its acceleration: it falls in the left picture and is the same for all in '
          'the right one.'),
    Study('2.25', 'Box pushed at a corner: transients over the moment of inertia',
          (*SHAPE, MASS, INERTIAS, FRICTION, *TIMING), compute_inertias, draw,
          'All end at the same rate, but from {least:.2f} s to 90 % of it at the least moment of '
          'inertia the time grows to {greatest:.2f} s at the greatest.',
          'The same moments turn every box; the time goes with I + m r², the moment of inertia '
          'about the corner that it is pushed at.'))
