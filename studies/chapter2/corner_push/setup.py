"""Case study 1: a box pushed at a corner, in a direction that is constant in the object frame."""

import math
from typing import Sequence

from matplotlib.axes import Axes
import numpy as np
from push_model.dynamics import impulse, ObjectTerms, State
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, Support
from studies.analysis.steady_turn import FIXED, steady_yaw_rate
from studies.analysis.time_integration import body_fixed_push, integrate
from studies.framework import plot_style
from studies.framework.box import BOX_LENGTH, BOX_WIDTH, rectangle
from studies.framework.parameters import Parameter, Values

SHAPE = (BOX_LENGTH, BOX_WIDTH,
         Parameter('corner_angle', 'rad', 'from the line corner to middle to the push, '
                   'counter-clockwise'))
MAX_SPEED = Parameter('max_speed', 'm/s', 'greatest speed of the contact that is drawn')
# Chosen: curves over the speed begin at this fraction of the greatest one, as 0 has no steady
# state, and have so many samples.
MIN_SPEED_FRACTION = 0.01
SPEED_SAMPLES = 60
SPEED_LABEL = 'pushing velocity [m/s]'
RATE_LABEL = 'yaw rate $\\omega$ [rad/s]'


def pushed_box(values: Values, mass: float, friction_coefficient: float, inertia: float = 0.0,
               support_pattern: Sequence[tuple[float, float]] = ()) -> PushedObject:
    """
    Make the box, its centre of mass in the middle.

    :param values: with the parameters ``SHAPE``.
    :param mass: [kg].
    :param friction_coefficient: of every support point.
    :param inertia: about the centre of mass [kg m^2]; 0 for that of a uniform plate.
    :param support_pattern: positions (x, y) of the support points as fractions of half the sides;
        empty for the corners.
    :return: the box.
    """
    outline = rectangle(values.box_length, values.box_width)
    half_x, half_y = outline[2]
    points = [(x * half_x, y * half_y) for x, y in support_pattern] or outline
    supports = tuple(Support(x, y, friction_coefficient) for x, y in points)
    return PushedObject(mass, inertia, supports, outline)


def push_direction(values: Values) -> float:
    """
    Compute the direction of the push.

    :param values: with the parameters ``SHAPE``.
    :return: in the object frame [rad].
    """
    return math.atan2(values.box_width, values.box_length) + values.corner_angle


def speed_samples(values: Values, count: int = SPEED_SAMPLES) -> FloatArray:
    """
    List the speeds over which a curve is drawn.

    :param values: with the parameter ``MAX_SPEED``.
    :param count: of the speeds.
    :return: speeds of the contact [m/s], shape (count,).
    """
    return np.linspace(MIN_SPEED_FRACTION * values.max_speed, values.max_speed, count)


def steady_yaw_rates(obj: PushedObject, direction: float,
                     speeds: FloatArray | Sequence[float]) -> FloatArray:
    """
    Compute the steady yaw rate at each speed.

    :param obj: the object, pushed at vertex 0.
    :param direction: of the push in the object frame [rad].
    :param speeds: of the contact [m/s], shape (n,).
    :return: yaw rates [rad/s], shape (n,).
    """
    return np.array([steady_yaw_rate(obj, obj.outline[0], direction, speed)
                     for speed in speeds])


def met_yaw_rate(obj: PushedObject, direction: float, speed: float) -> float:
    """
    Compute the yaw rate of a box at rest that is met at the speed: by the impulse at the corner.

    :param obj: the object, pushed at vertex 0.
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s].
    :return: yaw rate [rad/s].
    """
    start = State(0.0, 0.0, 0.0, 0.0, direction, *obj.outline[0])
    return float(impulse(ObjectTerms.of(obj), start, speed * math.cos(direction),
                         speed * math.sin(direction))[0])


def integrated_push(obj: PushedObject, direction: float, speed: float,
                    times: FloatArray | Sequence[float], yaw_rate: float = 0.0) -> FloatArray:
    """
    Integrate the push of a box whose corner moves at the speed from the start.

    :param obj: the object, pushed at vertex 0.
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s].
    :param times: where to sample [s], shape (n,).
    :param yaw_rate: at the start: 0, or ``met_yaw_rate`` of a box at rest [rad/s].
    :return: states in the order of ``push_model.dynamics.STATE``, shape (n, 7).
    """
    start = State(0.0, 0.0, 0.0, yaw_rate, direction, *obj.outline[0])
    return integrate(obj, FIXED, body_fixed_push(direction, speed), start, times)[1]


def relative_range(curves: FloatArray) -> float:
    """
    Compute the largest relative difference between curves at the same abscissa.

    :param curves: k curves, all above 0 or all below, shape (k, n).
    :return: largest over smallest magnitude, minus 1.
    """
    sizes = np.abs(curves)
    return float((sizes.max(axis=0) / sizes.min(axis=0) - 1.0).max())


def draw_rates(axes: Axes, speeds: FloatArray, curves: Sequence[FloatArray],
               labels: Sequence[str], step: float = 2.2) -> None:
    """
    Draw yaw rates over the pushing velocity.

    :param axes: to draw on.
    :param speeds: of the contact [m/s], shape (n,).
    :param curves: k yaw rates [rad/s], each of shape (n,).
    :param labels: k texts.
    :param step: as for ``plot_style.nested_series``.
    """
    for index, (curve, label) in enumerate(zip(curves, labels)):
        axes.plot(speeds, curve, label=label,
                  **plot_style.nested_series(index, len(labels), step))
    axes.set_xlabel(SPEED_LABEL)
    axes.set_ylabel(RATE_LABEL)
    axes.set_xlim(0.0, speeds[-1])
    axes.set_ylim(bottom=0.0)
