"""What a higher speed does to the push and the contact force where nothing limits them."""

import math

import numpy as np
from push_planner.single_push.planner import plan_push
from push_planner.verification.verification import verify
from push_study.chapter3.friction_cone import INSIDE, MAKING
from push_study.chapter3.scene import draw_inputs, input_table, push_problem
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study
from scipy.optimize import brentq


def compute(values, batch):
    """
    Plan the push at each speed without any limit.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    cone, tables, rows = math.atan(values.contact_friction), {}, []
    for speed in values.speeds:
        found = _unlimited(values, speed)
        inputs, touch = input_table(found), found.switches[0]
        tables[f'inputs_{speed:g}'] = inputs
        rows.append((speed, _steepest(inputs['rho_rad']), cone * verify(found).friction_usage,
                     abs(math.atan2(touch.tangential_impulse, touch.normal_impulse))))
    names = ('speed_m_s', 'push_rad', 'force_rad', 'touch_rad')
    table = tables['steepest'] = dict(zip(names, map(np.array, zip(*rows))))
    return Outcome(tables, {
        'cone': Finding(cone, 'rad', 'half-angle of the friction cone'),
        'leaves': Finding(_leaving_speed(values, cone), 'm/s', 'speed above which the push leaves '
                          'the cone'),
        'slowest': Finding(float(table['push_rad'][0]), 'rad', 'greatest pushing angle at the '
                           'lowest speed'),
        'fastest': Finding(float(table['push_rad'][-1]), 'rad', 'the same at the highest'),
        'friction_slowest': Finding(math.tan(table['force_rad'][0]), '', 'contact friction that '
                                    'the force takes at the lowest speed'),
        'friction_fastest': Finding(math.tan(table['force_rad'][-1]), '', 'the same at the '
                                    'highest')})


def _unlimited(values, speed):
    return plan_push(push_problem(values, speed, values.segments, angle_limit='none',
                             cone_margin=1.0))


def _steepest(angles):
    return float(np.abs(angles).max())


def _leaving_speed(values, cone):
    """Speed at which the greatest pushing angle is that of the cone [m/s]; 0 where none is."""
    def beyond(speed):
        return _steepest(np.array(_unlimited(values, speed).pushing_angles)) - cone

    low, high = values.speeds[0], values.speeds[-1]
    if beyond(low) * beyond(high) > 0.0:
        return 0.0
    return float(brentq(beyond, low, high, xtol=1e-3))


def draw(figure, outcome, values):
    """
    Draw inputs, and the steepest angles over the speed.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    inputs, steepest = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    cone = outcome.findings['cone'].value
    inputs.axhspan(-cone, cone, color=INSIDE, linewidth=0.0, zorder=0.5)
    for number, speed in enumerate(values.speeds[::2]):
        draw_inputs(inputs, outcome.tables[f'inputs_{speed:g}'], label=f'{speed:g} m/s',
                    **paper.series(number))
    inputs.legend(loc='lower right')
    table = outcome.tables['steepest']
    steepest.axhspan(0.0, cone, color=INSIDE, linewidth=0.0, zorder=0.5, label='friction cone')
    for number, (name, label) in enumerate((('push', 'push'), ('force', 'contact force'),
                                            ('touch', 'impulse of the touch'))):
        steepest.plot(table['speed_m_s'], table[f'{name}_rad'], label=label,
                      **paper.series(number))
    steepest.set_xlim(0.0, values.speeds[-1])
    steepest.set_ylim(0.0, 1.15 * max(table['push_rad']))
    steepest.set_xlabel('speed [m/s]')
    steepest.set_ylabel('greatest angle to the normal [rad]')
    steepest.legend(loc='upper left')


STUDIES = (
    Study('3.7', 'Raising the velocity where the pushing angle is not limited',
          (*MAKING, Parameter('speeds', 'm/s', 'speeds of the contact')),
          compute, draw,
          'The greatest angle of the push grows from {slowest:.2f} rad to {fastest:.2f} rad and '
          'leaves the friction cone above {leaves:.2f} m/s; the force stays in it, but the '
          'friction that it takes grows from {friction_slowest:.2f} to {friction_fastest:.2f}.',
          'The faster the push, the more inertia holds against the turn, and the further it must '
          'aim beside the friction centre; the force leans less, as the friction centre does not '
          'move to the side as much as the contact.'),)
