"""How the box pushed at a corner reaches its steady yaw rate."""

import functools
from typing import Callable, NamedTuple, Sequence

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from studies.chapter2.corner_push.setup import (
    integrated_push, met_yaw_rate, push_direction, pushed_box, RATE_LABEL, SHAPE,
    steady_yaw_rates,
)
from studies.chapter2.corner_push.steady_rates import (
    Boxes, boxes_by_inertia, boxes_by_mass, INERTIA, INERTIAS, MASSES, masses, RISE_FRACTION,
    RISE_TIME,
)
from studies.framework import plot_style
from studies.framework.box import FRICTION, MASS
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: smooth curves.
SAMPLES = 241
# In the names of columns of boxes that are met at rest.
MET = 'met'
TIMING = (Parameter('speed', 'm/s', 'speed of the contact'),
          Parameter('duration', 's', 'time that is drawn'))


class Transients(NamedTuple):
    """
    Yaw rates over time of k boxes: they move already and do not rotate, or are met at rest.

    :param table: times and yaw rates, ``MET`` in the names of those met at rest.
    :param rise_times: until ``RISE_FRACTION`` of the steady rate [s], shape (k,).
    :param final_errors: relative differences of the last yaw rates from the steady ones,
        shape (k,).
    :param met: yaw rates of boxes at rest right after they were met [rad/s], shape (k,).
    """

    table: Table
    rise_times: FloatArray
    final_errors: FloatArray
    met: FloatArray


def transients(objects: Sequence[PushedObject], values: Values) -> Transients:
    """
    Integrate the yaw rates of boxes over time.

    :param objects: one per curve.
    :param values: with the parameters ``SHAPE`` and ``TIMING``.
    :return: the transients.
    """
    times, direction = np.linspace(0.0, values.duration, SAMPLES), push_direction(values)
    table: Table = {'time_s': times}
    rise_times: list[float] = []
    errors: list[float] = []
    met: list[float] = []
    for index, obj in enumerate(objects):
        omega = integrated_push(obj, direction, values.speed, times)[:, 3]
        steady = steady_yaw_rates(obj, direction, [values.speed])[0]
        rise_times.append(np.interp(RISE_FRACTION, omega / steady, times))
        errors.append(abs(omega[-1] / steady - 1.0))
        table[f'omega_{index + 1}_rad_s'] = omega
        met.append(met_yaw_rate(obj, direction, values.speed))
        after = integrated_push(obj, direction, values.speed, times, met[-1])[:, 3]
        errors[-1] = max(errors[-1], abs(after[-1] / steady - 1.0))
        table[f'omega_{index + 1}_{MET}_rad_s'] = after
    return Transients(table, np.array(rise_times), np.array(errors), np.array(met))


def _curves(table: Table, *, met: bool) -> list[FloatArray]:
    """Select the yaw rates of boxes that are met at rest, or of those that move already."""
    return [np.asarray(column) for name, column in table.items()
            if name != 'time_s' and (MET in name) == met]


def _met_findings(met: FloatArray) -> dict[str, Finding]:
    return {'met_low': Finding(float(met.min()), 'rad/s', 'least yaw rate of a box right after '
                               'it was met at rest'),
            'met_high': Finding(float(met.max()), 'rad/s', 'greatest')}


def compute_masses(values: Values, _: RunJobs) -> Outcome:
    """Compute transients of light and heavy boxes: load in the middle, or all over the box."""
    objects = list(boxes_by_mass(values).values())
    centered = transients(objects, values)
    uniform = transients([pushed_box(values, mass, values.friction_coefficient)
                          for mass in masses(values)], values)
    curves = _curves(uniform.table, met=False)
    findings = {
        **_met_findings(np.concatenate([centered.met, uniform.met])),
        'steady': _steady(objects[0], values),
        'lightest': Finding(float(centered.rise_times[0]), 's',
                            f'{RISE_TIME}, lightest box, inertia kept'),
        'heaviest': Finding(float(centered.rise_times[-1]), 's',
                            f'{RISE_TIME}, heaviest box, inertia kept'),
        'plate': Finding(float(uniform.rise_times[0]), 's',
                         f'{RISE_TIME}, inertia of a uniform plate'),
        'plate_spread': Finding(float(np.ptp(curves, axis=0).max()), 'rad/s', 'largest difference '
                                'between the curves where the inertia is that of a uniform '
                                'plate'),
        'final_error': Finding(float(max(*centered.final_errors, *uniform.final_errors)), '',
                               'largest relative difference of an end from the steady rate')}
    return Outcome({'inertia_kept': centered.table, 'uniform_plate': uniform.table}, findings)


def compute_inertias(values: Values, _: RunJobs) -> Outcome:
    """Compute transients of boxes of one mass whose load lies further in or out."""
    objects = list(boxes_by_inertia(values).values())
    table, rise_times, errors, met = transients(objects, values)
    findings = {'steady': _steady(objects[0], values), **_met_findings(met),
                'least': Finding(float(rise_times[0]), 's',
                                 f'{RISE_TIME}, first moment of inertia'),
                'greatest': Finding(float(rise_times[-1]), 's',
                                    f'{RISE_TIME}, last moment of inertia'),
                'final_error': Finding(float(errors.max()), '', 'largest relative difference of '
                                       'an end from the steady rate')}
    return Outcome({'transients': table}, findings)


def _draw(make_boxes: Callable[[Values], Boxes], figure: Figure, outcome: Outcome,
          values: Values) -> None:
    """Draw the yaw rates of each table over time."""
    labels = list(make_boxes(values))
    panels = figure.subplots(1, len(outcome.tables), sharey=True, squeeze=False)[0]
    for axes, (name, table) in zip(panels, outcome.tables.items()):
        times = table['time_s']
        for index, (curve, met, label) in enumerate(zip(
                _curves(table, met=False), _curves(table, met=True), labels)):
            # The curves of uniform plates coincide.
            style = (plot_style.nested_series(index, len(labels)) if name == 'uniform_plate'
                     else plot_style.series(index))
            axes.plot(times, curve, label=label, **style)
            axes.plot(times, met, color=style['color'], linewidth=0.7, zorder=1.5)
        axes.axhline(outcome.findings['steady'].value, color=plot_style.GREY, linewidth=0.8,
                     zorder=1, label='steady rate')
        axes.plot([], [], color=plot_style.INK, linewidth=0.7, label='thin: met at rest')
        axes.set_xlim(times[0], times[-1])
        axes.set_xlabel('time [s]')
        axes.locator_params(axis='x', nbins=5)
        if len(panels) > 1:
            axes.set_title(name.replace('_', ' '), loc='left')
    panels[0].set_ylim(bottom=0.0)
    panels[0].set_ylabel(RATE_LABEL)
    panels[-1].legend(loc='lower right', handlelength=3.5)


def _steady(obj: PushedObject, values: Values) -> Finding:
    rate = steady_yaw_rates(obj, push_direction(values), [values.speed])[0]
    return Finding(float(rate), 'rad/s', 'steady yaw rate')


STUDIES = (
    Study('2.22', 'Box pushed at a corner: transients of light and heavy boxes',
          (*SHAPE, *MASSES, INERTIA, FRICTION, *TIMING), compute_masses,
          functools.partial(_draw, boxes_by_mass),
          'Boxes move already and do not rotate at first. With the same moment of inertia (left) '
          'the lightest takes {lightest:.2f} s to 90 % of the final rate, the heaviest '
          '{heaviest:.2f} s; with even load (right) all take {plate:.2f} s. A box that is met at '
          'rest (thin) starts at {met_low:.2f} to {met_high:.2f} rad/s and comes down to '
          '{steady:.2f} rad/s.',
          'Only the ratio of inertia to mass counts.'),
    Study('2.25', 'Box pushed at a corner: transients over the moment of inertia',
          (*SHAPE, MASS, INERTIAS, FRICTION, *TIMING), compute_inertias,
          functools.partial(_draw, boxes_by_inertia),
          'Boxes move already and do not rotate at first. All reach the same rate; 90 % of it '
          'takes {least:.2f} to {greatest:.2f} s. A box that is met at rest (thin) starts at '
          '{met_low:.2f} to {met_high:.2f} rad/s and comes down to {steady:.2f} rad/s.',
          'The time grows with I + m r², the moment of inertia about the corner.'))
