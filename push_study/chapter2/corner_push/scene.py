"""Case study 1: a box pushed at a corner, in a direction that stays the same on the box."""

import math

import numpy as np
from push_model.analysis.steady_turn import FIXED, steady_yaw_rate
from push_model.analysis.time_integration import body_fixed_push, integrate
from push_model.dynamics import State
from push_model.parameters import PushedObject, Support
from push_study.framework import paper
from push_study.framework.scenes import BOX, corners
from push_study.framework.study import Parameter

SHAPE = (*BOX[:2], Parameter('corner_angle', 'rad', 'from the line corner to middle to the push, '
                             'counter-clockwise'))
MASS, FRICTION = BOX[2:4]
TOP_SPEED = Parameter('top_speed', 'm/s', 'greatest speed of the contact that is drawn')
LEAST_SHARE, SAMPLES = 0.01, 60
SPEED_LABEL, RATE_LABEL = 'pushing velocity [m/s]', 'turning rate $\\omega$ [rad/s]'


def pushed_box(values, mass, friction_coefficient, inertia=0.0, feet=()):
    """
    Make the box, its mass centre in the middle.

    :param values: ``Values`` with the parameters ``SHAPE``.
    :param mass: [kg].
    :param friction_coefficient: of every support.
    :param inertia: about the mass centre [kg m^2]; 0 for that of a uniform plate.
    :param feet: places of the supports as shares of half the sides (x, y); none for the corners.
    :return: ``PushedObject``.
    """
    outline = corners(values.box_length, values.box_width)
    half_x, half_y = outline[2]
    places = [(x * half_x, y * half_y) for x, y in feet] or outline
    supports = tuple(Support(x, y, friction_coefficient) for x, y in places)
    return PushedObject(mass, inertia, supports, outline)


def push_direction(values):
    """
    Direction of the push in the object frame [rad].

    :param values: ``Values`` with the parameters ``SHAPE``.
    """
    return math.atan2(values.box_width, values.box_length) + values.corner_angle


def drawn_speeds(values, count=SAMPLES):
    """
    Speeds that a curve is drawn over [m/s], shape (count,).

    :param values: ``Values`` with ``TOP_SPEED``.
    :param count: of the speeds.
    """
    return np.linspace(LEAST_SHARE * values.top_speed, values.top_speed, count)


def steady_rates(obj, direction, speeds):
    """
    Steady turning rate at each speed [rad/s].

    :param obj: the ``PushedObject``, pushed at vertex 0.
    :param direction: of the push in the object frame [rad].
    :param speeds: of the contact [m/s].
    :return: array.
    """
    return np.array([steady_yaw_rate(obj, obj.outline[0], direction, speed)
                     for speed in speeds])


def motion(obj, direction, speed, times):
    """
    Integrate the push of a box that moves with it from the start, but does not turn yet.

    :param obj: the ``PushedObject``, pushed at vertex 0.
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s].
    :param times: where to sample [s], shape (n,).
    :return: states in the order of ``push_model.dynamics.STATE``, shape (n, 7).
    """
    start = State(0.0, 0.0, 0.0, 0.0, direction, *obj.outline[0])
    return integrate(obj, FIXED, body_fixed_push(direction, speed), start, times)[1]


def spread(curves):
    """
    Largest relative distance of curves at the same place.

    :param curves: shape (k, n), all above 0 or all below.
    """
    sizes = np.abs(curves)
    return float((sizes.max(axis=0) / sizes.min(axis=0) - 1.0).max())


def draw_rates(axes, speeds, curves, labels, step=2.2):
    """
    Draw turning rates over the pushing velocity.

    :param axes: matplotlib axes.
    :param speeds: of the contact [m/s], shape (n,).
    :param curves: turning rates [rad/s], k sequences of shape (n,).
    :param labels: k texts.
    :param step: as for ``nested``.
    """
    for number, (curve, label) in enumerate(zip(curves, labels)):
        axes.plot(speeds, curve, label=label, **nested(number, len(labels), step))
    axes.set_xlabel(SPEED_LABEL)
    axes.set_ylabel(RATE_LABEL)
    axes.set_xlim(0.0, speeds[-1])
    axes.set_ylim(bottom=0.0)


def nested(number, count, step=2.2):
    """
    Line style of a curve that may lie on others, as keywords of ``plot``.

    :param number: of the curve, from 0; later ones are thinner, so that all show.
    :param count: of the curves.
    :param step: how much thinner [points].
    """
    colour, dashes = paper.SERIES[number % len(paper.SERIES)]
    width = 1.8 + step * (count - 1 - number)
    if step and dashes != '-':
        # Dashes count in line widths; here in points, whatever the width.
        dashes = dashes[0], tuple(2.0 * part / width for part in dashes[1])
    return {'color': colour, 'linestyle': dashes, 'linewidth': width,
            'solid_capstyle': 'butt'}
