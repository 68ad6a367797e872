"""Response of the supports to the direction of a push, tabulated for fast look-up."""

import math
from typing import Any

import numpy as np
from push_dynamics.compiled import compiled, interpreted, kernel_array
from push_model.friction import friction_weight, LoadTransfer
from push_model.geometry import Coordinates, FloatArray
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


class LimitSurfaceTable:
    """
    Turning and force of the supports themselves, over the angle alpha of the push from C->F.

    Turning is kept as the c^2 with which the ellipsoidal limit surface turns as fast as the
    supports do, ``omega = -r sin(alpha) / (c^2 + r^2)`` for unit speed; so the table also serves
    for centre of frictions near the nominal one. ``values``: that c^2 over alpha, for compiled
    functions [m^2].
    """

    def __init__(self, obj: PushedObject, point: Coordinates):
        """
        Evaluate the supports for pushes at one point.

        :param obj: the nominal ``PushedObject``.
        :param point: C in the object frame (x, y) [m].
        """
        nominal = vehicle(obj, point)
        count = round(MAX_ANGLE / SPACING)
        self._angles = np.asarray(np.arange(-count, count + 1) * SPACING, dtype=np.float64)
        c_squared: list[float] = []
        forces: list[float] = []
        for alpha in self._angles.tolist():
            push = math.cos(nominal.angle + alpha), math.sin(nominal.angle + alpha)
            omega = quasi_static_yaw_rate(obj, point, *push)
            force = _force_angle(obj, point, push, omega)
            forces.append(math.remainder(force - nominal.angle, 2.0 * math.pi))
            # Straight to the centre nothing turns, and c^2 is the limit of the quotient.
            c_squared.append(nominal.c_squared if abs(alpha) < 0.5 * SPACING else
                             -nominal.arm * math.sin(alpha) / omega - nominal.arm ** 2)
        self._c_squared = [max(MIN_C_SQUARED, value) for value in c_squared]
        self.values = kernel_array(self._c_squared)
        self._forces: FloatArray = np.maximum.accumulate(forces)

    def c_squared(self, alpha: float) -> float:
        """
        Effective c^2 of a push.

        :param alpha: angle from C->F to the velocity imposed at C [rad]; held beyond the table.
        :return: c^2 [m^2].
        """
        return interpreted(tabulated_c_squared)(self._c_squared, alpha)

    def push_angle(self, vehicle: Vehicle, curvature: float) -> float:
        """
        Angle alpha that turns an object by a curvature, ``tan(alpha) = -L(alpha) kappa``.

        :param vehicle: the object as ``Vehicle``; its c^2 is that of a push straight to the
            centre.
        :param curvature: kappa, yaw rate over the speed along C->F [1/m].
        :return: alpha [rad].
        """
        alpha = 0.0
        for _ in range(ITERATIONS):
            alpha = -math.atan(self._wheelbase(vehicle, alpha) * curvature)
        return alpha

    def curvatures(self, vehicle: Vehicle, low: float, high: float) -> tuple[float, float]:
        """
        Curvatures for which the force stays between two directions.

        :param vehicle: the object as ``Vehicle``.
        :param low: least angle of the force from C->F [rad].
        :param high: greatest angle [rad].
        :return: (lowest, highest) curvature [1/m].
        """
        # A force to one side turns the object to the other one.
        rightmost, leftmost = np.interp((high, low), self._forces, self._angles).tolist()
        return self._curvature(vehicle, rightmost), self._curvature(vehicle, leftmost)

    def _curvature(self, vehicle: Vehicle, alpha: float) -> float:
        alpha = min(MAX_STEERING_ANGLE, max(-MAX_STEERING_ANGLE, alpha))
        return -math.tan(alpha) / self._wheelbase(vehicle, alpha)

    def _wheelbase(self, vehicle: Vehicle, alpha: float) -> float:
        ratio = self.c_squared(alpha) / self.c_squared(0.0)
        return vehicle.arm + ratio * vehicle.c_squared / vehicle.arm


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
