"""Turning rate of the box pushed at a corner: quasi-static against dynamic."""

import dataclasses

import numpy as np
from push_model.quasi_static import quasi_static_yaw_rate
from push_study.chapter2.corner_push.robot import push_by_robot
from push_study.chapter2.corner_push.scene import (
    drawn_speeds, FRICTION, MASS, push_direction, pushed_box, RATE_LABEL, SHAPE, SPEED_LABEL,
    steady_rates, TOP_SPEED,
)
from push_study.framework import paper
from push_study.framework.scenes import BOX
from push_study.framework.study import Finding, Outcome, Parameter, Study

SIMULATED, SETTLED = 6, 4.0
ROBOT = (BOX[4], Parameter('robot_radius', 'm', 'radius of the robot in the contact simulation'))


def compute(values, batch):
    """
    Quasi-static and steady dynamic turning rate of one box, and the one that is simulated.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    direction, speeds = push_direction(values), drawn_speeds(values)
    dynamic = steady_rates(obj, direction, speeds)
    slow = np.array([quasi_static_yaw_rate(obj, obj.outline[0], speed * np.cos(direction),
                                           speed * np.sin(direction)) for speed in speeds])
    checked, simulated, off = _simulated(values, obj, direction)
    ratio, peak = dynamic / slow, int(dynamic.argmax())
    findings = {
        'slow_ratio': Finding(ratio[0], '', f'dynamic over quasi-static at {speeds[0]:g} m/s'),
        'fast_ratio': Finding(ratio[-1], '', f'the same at {speeds[-1]:g} m/s'),
        'falls': Finding(float((np.diff(ratio) < 0.0).all()), '', 'whether it falls throughout'),
        'half_speed': Finding(float(np.interp(-0.5, -ratio, speeds)), 'm/s', 'where it is one '
                              'half'),
        'peak_speed': Finding(speeds[peak], 'm/s', 'where the dynamic rate is greatest'),
        'peak': Finding(dynamic[peak], 'rad/s', 'greatest dynamic rate'),
        'simulated_off': Finding(off, '', 'largest relative distance of a simulated rate')}
    return Outcome({'rates': {'speed_m_s': speeds, 'quasi_static_rad_s': slow,
                              'dynamic_rad_s': dynamic, 'ratio': ratio},
                    'simulated': {'speed_m_s': checked, 'omega_rad_s': simulated}},
                   {name: one._replace(value=float(one.value)) for name, one in findings.items()})


def draw(figure, outcome, values):
    """
    Draw both rates and their ratio.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    table = outcome.tables['rates']
    left, right = figure.subplots(1, 2)
    for number, (name, label) in enumerate((('dynamic_rad_s', 'dynamic, steady'),
                                            ('quasi_static_rad_s', 'quasi-static'))):
        left.plot(table['speed_m_s'], table[name], label=label, **paper.series(number))
    left.plot(*outcome.tables['simulated'].values(), 'o', markersize=5.0, clip_on=False, zorder=4,
              markerfacecolor='white', markeredgecolor=paper.INK, label='contact simulation')
    left.set_ylabel(RATE_LABEL)
    left.legend(loc='upper left')
    right.plot(table['speed_m_s'], table['ratio'], **paper.series(0))
    right.set_ylabel('dynamic over quasi-static rate')
    for axes in (left, right):
        axes.set_xlabel(SPEED_LABEL)
        axes.set_xlim(0.0, values.top_speed)
        axes.set_ylim(bottom=0.0)


def _simulated(values, obj, direction):
    obj = dataclasses.replace(obj, contact_friction_coefficient=values.contact_friction)
    speeds = drawn_speeds(values, SIMULATED)
    rates = np.array([push_by_robot(obj, direction, speed, values.robot_radius,
                                    SETTLED)[-1].object_twist[2] for speed in speeds])
    return speeds, rates, np.abs(rates / steady_rates(obj, direction, speeds) - 1.0).max()


STUDIES = (Study(
    '2.19', 'Box pushed at a corner: quasi-static and dynamic turning rate',
    (*SHAPE, MASS, FRICTION, *ROBOT, TOP_SPEED), compute, draw,
    'A slow push turns the box as the quasi-static rate says (ratio {slow_ratio:.4f}), a fast one '
    'less and less: half as fast at {half_speed:.2f} m/s, {fast_ratio:.2f} times at the right '
    'end; a robot in the contact simulation gets the same to {simulated_off:.4f} of it.',
    'When the box turns, its velocity turns with it: the inertia force against that has a moment '
    'about the corner that brakes the turn and grows with speed, while the friction under the '
    'box that turns it does not grow.'),)
