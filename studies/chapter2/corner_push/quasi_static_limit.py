"""Yaw rate of the box pushed at a corner: quasi-static against dynamic."""

import dataclasses
from typing import NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject
from push_model.quasi_static import quasi_static_yaw_rate
from studies.chapter2.corner_push.setup import (
    MAX_SPEED, push_direction, pushed_box, RATE_LABEL, SHAPE, SPEED_LABEL, speed_samples,
    steady_yaw_rates,
)
from studies.chapter2.corner_push.simulated_push import push_by_robot
from studies.framework import plot_style
from studies.framework.box import CONTACT_FRICTION, FRICTION, MASS
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: speeds at which the contact simulation is compared.
SIMULATED_SPEEDS = 6
# Chosen: a push of this duration is steady at its end, to 1e-4 at all speeds [s].
SETTLING_TIME = 4.0
ROBOT = (CONTACT_FRICTION,
         Parameter('robot_radius', 'm', 'radius of the robot in the contact simulation'))


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute quasi-static and steady dynamic yaw rate, and simulate some pushes."""
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    direction, speeds = push_direction(values), speed_samples(values)
    dynamic = steady_yaw_rates(obj, direction, speeds)
    quasi_static = np.array([
        quasi_static_yaw_rate(obj, obj.outline[0], speed * np.cos(direction),
                              speed * np.sin(direction)) for speed in speeds])
    simulated = _simulate(values, obj, direction)
    ratio, peak = dynamic / quasi_static, int(dynamic.argmax())
    decreases = bool((np.diff(ratio) < 0.0).all())
    findings = {
        'slow_ratio': Finding(float(ratio[0]), '',
                              f'dynamic over quasi-static rate at {speeds[0]:g} m/s'),
        'fast_ratio': Finding(float(ratio[-1]), '', f'the same at {speeds[-1]:g} m/s'),
        'decreases': Finding(float(decreases), '', 'whether that ratio decreases throughout'),
        'half_speed': Finding(float(np.interp(-0.5, -ratio, speeds)), 'm/s',
                              'speed at which it is one half'),
        'peak_speed': Finding(float(speeds[peak]), 'm/s',
                              'speed at which the dynamic rate is greatest'),
        'peak': Finding(float(dynamic[peak]), 'rad/s', 'greatest dynamic rate'),
        'simulation_error': Finding(simulated.error, '',
                                    'largest relative error of a simulated rate')}
    rates = {'speed_m_s': speeds, 'quasi_static_rad_s': quasi_static, 'dynamic_rad_s': dynamic,
             'ratio': ratio}
    return Outcome({'rates': rates, 'simulated': {'speed_m_s': simulated.speeds,
                                                  'omega_rad_s': simulated.rates}}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw both rates and their ratio."""
    table, simulated = outcome.tables['rates'], outcome.tables['simulated']
    left, right = figure.subplots(1, 2)
    for index, (name, label) in enumerate((('dynamic_rad_s', 'dynamic, steady'),
                                           ('quasi_static_rad_s', 'quasi-static'))):
        left.plot(table['speed_m_s'], table[name], label=label, **plot_style.series(index))
    left.plot(simulated['speed_m_s'], simulated['omega_rad_s'], 'o', markersize=5.0,
              clip_on=False, zorder=4, markerfacecolor='white', markeredgecolor=plot_style.INK,
              label='contact simulation')
    left.set_ylabel(RATE_LABEL)
    left.legend(loc='upper left')
    right.plot(table['speed_m_s'], table['ratio'], **plot_style.series(0))
    right.set_ylabel('dynamic over quasi-static rate')
    for axes in (left, right):
        axes.set_xlabel(SPEED_LABEL)
        axes.set_xlim(0.0, values.max_speed)
        axes.set_ylim(bottom=0.0)


class SimulatedRates(NamedTuple):
    """
    Yaw rates at the end of simulated pushes.

    :param speeds: of the contact [m/s], shape (n,).
    :param rates: [rad/s], shape (n,).
    :param error: largest relative error against the steady rates.
    """

    speeds: FloatArray
    rates: FloatArray
    error: float


def _simulate(values: Values, obj: PushedObject, direction: float) -> SimulatedRates:
    obj = dataclasses.replace(obj, contact_friction_coefficient=values.contact_friction)
    speeds = speed_samples(values, SIMULATED_SPEEDS)
    rates = np.array([push_by_robot(obj, direction, speed, values.robot_radius,
                                    SETTLING_TIME)[-1].object_twist[2] for speed in speeds])
    error = np.abs(rates / steady_yaw_rates(obj, direction, speeds) - 1.0).max()
    return SimulatedRates(speeds, rates, float(error))


STUDIES = (Study(
    '2.19', 'Box pushed at a corner: quasi-static and dynamic yaw rate',
    (*SHAPE, MASS, FRICTION, *ROBOT, MAX_SPEED), compute, draw,
    'The yaw rate over the quasi-static one is {slow_ratio:.4f} in a slow push, half at '
    '{half_speed:.2f} m/s, {fast_ratio:.2f} at the right end. The contact simulation agrees to '
    '{simulation_error:.4f}.',
    'The inertia force against the turning velocity grows with speed, friction does not.'),)
