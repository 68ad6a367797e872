"""Response of the supports to the direction of a push, tabulated for fast look-up."""

import math
from typing import Any

import numpy as np
from push_dynamics.compiled import compiled, interpreted, kernel_array
from push_model.friction import friction_weight, LoadTransfer
from push_model.geometry import Coordinates
from push_model.parameters import PushedObject
from push_model.quasi_static import (
    quasi_static_yaw_rate, sliding_capacities, Vehicle, vehicle,
)

# Range and spacing of the tabulated alpha [rad]. Chosen: wider than any push that is commanded,
# and fine enough for one percent of the turning rate (held by a test).
MAX_ANGLE = 1.2
SPACING = 0.1
# Largest |alpha| that curvature limits are read at [rad]. Chosen: beyond, the object turns about a
# point so near that neither estimate nor path can follow.
MAX_STEERING_ANGLE = 0.7
# Smallest tabulated c^2 [m^2], so that supports in one line do not divide by zero.
MIN_C_SQUARED = 1e-6
# Number of tabulated angles.
TABLE_SIZE = 2 * round(MAX_ANGLE / SPACING) + 1
# Steps of the fixed-point iteration of ``push_angle``. Chosen: the table's error is larger.
ITERATIONS = 4


@compiled
def tabulated_c_squared(values: Any, alpha: float) -> float:
    """
    Interpolate the effective c^2 of a push.

    :param values: ``LimitSurfaceTable.values`` [m^2].
    :param alpha: angle from C->F to the velocity imposed at C [rad]; held beyond the table.
    :return: c^2 [m^2].
    """
    position = (alpha + MAX_ANGLE) / SPACING
    # Written so that a number that is none stays in the table too.
    position = min(position, len(values) - 1.001) if position > 0.0 else 0.0
    index = int(position)
    ratio = position - index
    return (1.0 - ratio) * values[index] + ratio * values[index + 1]


@compiled
def tabulated_angle(forces: Any, force: float) -> float:
    """
    Interpolate the angle of the push that a force comes from.

    :param forces: direction of the force at every tabulated angle, ascending [rad].
    :param force: direction of the force [rad]; held beyond the table.
    :return: alpha [rad].
    """
    count = len(forces)
    if not force > forces[0]:
        return -MAX_ANGLE
    if force >= forces[count - 1]:
        return MAX_ANGLE
    index = 0
    while force >= forces[index + 1]:
        index += 1
    ratio = (force - forces[index]) / (forces[index + 1] - forces[index])
    return SPACING * (index + ratio) - MAX_ANGLE


@compiled
def wheelbase_at(values: Any, arm: float, c_squared: float, alpha: float) -> float:
    """
    Wheelbase of a push.

    :param values: ``LimitSurfaceTable.values`` [m^2].
    :param arm: r of the ``Vehicle`` [m].
    :param c_squared: c^2 of the ``Vehicle``, for a push straight to the centre [m^2].
    :param alpha: angle from C->F to the velocity imposed at C [rad].
    :return: L [m].
    """
    ratio = tabulated_c_squared(values, alpha) / tabulated_c_squared(values, 0.0)
    return arm + ratio * c_squared / arm


@compiled
def angle_of_curvature(values: Any, arm: float, c_squared: float, curvature: float) -> float:
    """
    Angle that turns an object by a curvature, ``tan(alpha) = -L(alpha) kappa``.

    :param values: ``LimitSurfaceTable.values`` [m^2].
    :param arm: r of the ``Vehicle`` [m].
    :param c_squared: c^2 of the ``Vehicle`` [m^2].
    :param curvature: kappa [1/m].
    :return: alpha [rad].
    """
    alpha = 0.0
    for _ in range(ITERATIONS):
        alpha = -math.atan(wheelbase_at(values, arm, c_squared, alpha) * curvature)
    return alpha


@compiled
def curvature_of_force(values: Any, forces: Any, arm: float, c_squared: float,
                       force: float) -> float:
    """
    Curvature at which an object is turned by a force.

    :param values: ``LimitSurfaceTable.values`` [m^2].
    :param forces: ``LimitSurfaceTable.forces`` [rad].
    :param arm: r of the ``Vehicle`` [m].
    :param c_squared: c^2 of the ``Vehicle`` [m^2].
    :param force: its angle from C->F [rad].
    :return: kappa [1/m].
    """
    alpha = tabulated_angle(forces, force)
    alpha = min(MAX_STEERING_ANGLE, max(-MAX_STEERING_ANGLE, alpha))
    return -math.tan(alpha) / wheelbase_at(values, arm, c_squared, alpha)


@compiled
def curvatures_of_forces(values: Any, forces: Any, arm: float, c_squared: float, low: float,
                         high: float) -> tuple[float, float]:
    """
    Curvatures for which the force stays between two directions.

    :param values: ``LimitSurfaceTable.values`` [m^2].
    :param forces: ``LimitSurfaceTable.forces`` [rad].
    :param arm: r of the ``Vehicle`` [m].
    :param c_squared: c^2 of the ``Vehicle`` [m^2].
    :param low: least angle of the force from C->F [rad].
    :param high: greatest angle [rad].
    :return: (lowest, highest) curvature [1/m].
    """
    # A force to one side turns the object to the other one.
    return (curvature_of_force(values, forces, arm, c_squared, high),
            curvature_of_force(values, forces, arm, c_squared, low))


class LimitSurfaceTable:
    """
    Turning and force of the supports themselves, over the angle alpha of the push from C->F.

    Turning is kept as the c^2 with which the ellipsoidal limit surface turns as fast as the
    supports do, ``omega = -r sin(alpha) / (c^2 + r^2)`` for unit speed; so the table also serves
    for centre of frictions near the nominal one. ``values``: that c^2 over alpha [m^2].
    ``forces``: angle of the force over alpha [rad].
    """

    def __init__(self, obj: PushedObject, point: Coordinates):
        """
        Evaluate the supports for pushes at one point.

        :param point: C in the object frame (x, y) [m].
        """
        nominal = vehicle(obj, point)
        count = TABLE_SIZE // 2
        c_squared: list[float] = []
        forces: list[float] = []
        for alpha in (np.arange(-count, count + 1) * SPACING).tolist():
            push = math.cos(nominal.angle + alpha), math.sin(nominal.angle + alpha)
            omega = quasi_static_yaw_rate(obj, point, *push)
            force = _force_angle(obj, point, push, omega)
            forces.append(math.remainder(force - nominal.angle, 2.0 * math.pi))
            # Straight to the centre nothing turns, and c^2 is the limit of the quotient.
            c_squared.append(nominal.c_squared if abs(alpha) < 0.5 * SPACING else
                             -nominal.arm * math.sin(alpha) / omega - nominal.arm ** 2)
        self.values = kernel_array([max(MIN_C_SQUARED, value) for value in c_squared])
        self.forces = kernel_array(np.maximum.accumulate(forces))

    def c_squared(self, alpha: float) -> float:
        """
        Effective c^2 of a push.

        :param alpha: angle from C->F to the velocity imposed at C [rad]; held beyond the table.
        :return: c^2 [m^2].
        """
        return interpreted(tabulated_c_squared)(self.values, alpha)

    def push_angle(self, vehicle: Vehicle, curvature: float) -> float:
        """
        Angle alpha that turns an object by a curvature, ``tan(alpha) = -L(alpha) kappa``.

        :param vehicle: the object as ``Vehicle``; its c^2 is that of a push straight to the
            centre.
        :param curvature: kappa, yaw rate over the speed along C->F [1/m].
        :return: alpha [rad].
        """
        return interpreted(angle_of_curvature)(self.values, vehicle.arm, vehicle.c_squared,
                                               curvature)


def _force_angle(obj: PushedObject, point: Coordinates, push: tuple[float, float],
                 omega: float) -> float:
    """Direction of the force that drags the supports along, object frame [rad]."""
    total_x = total_y = 0.0
    slides = [(push[0] - omega * (support.y - point[1]),
               push[1] + omega * (support.x - point[0])) for support in obj.supports]
    capacities = sliding_capacities(obj, LoadTransfer.of(obj), slides, 1e-9)
    for (v_x, v_y), capacity in zip(slides, capacities):
        weight = friction_weight(capacity, v_x, v_y, 1e-9)
        total_x, total_y = total_x + weight * v_x, total_y + weight * v_y
    return math.atan2(total_y, total_x)
