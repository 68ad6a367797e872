"""How the believed supports answer to the direction of a push, as tables quick to read."""

import math

import numpy as np
from push_model.friction import friction_weight
from push_model.quasi_static import quasi_static_yaw_rate, vehicle

STEEPEST = 1.2
STEEPEST_USED = 0.7
SPACING = 0.1


class LimitSurfaceTable:
    """
    Turning and force of the supports themselves, over alpha, the push's angle from C->F.

    Turning is kept as the c^2 with which the ellipsoid turns as fast as the supports do; so it
    serves for friction centres near the believed one as well.
    """

    def __init__(self, obj, point):
        """
        Evaluate the supports for pushes at one point.

        :param obj: the ``PushedObject`` as believed.
        :param point: C in the object frame (x, y) [m].
        """
        flat = vehicle(obj, point)
        count = round(STEEPEST / SPACING)
        self._angles = np.arange(-count, count + 1) * SPACING
        squares, forces = [], []
        for alpha in self._angles.tolist():
            push = math.cos(flat.angle + alpha), math.sin(flat.angle + alpha)
            omega = quasi_static_yaw_rate(obj, point, *push)
            force = _force_angle(obj, point, push, omega)
            forces.append(math.remainder(force - flat.angle, 2.0 * math.pi))
            squares.append(flat.c_squared if abs(alpha) < 0.5 * SPACING else
                           -flat.arm * math.sin(alpha) / omega - flat.arm ** 2)
        self._squares = [max(1e-6, square) for square in squares]
        self._forces = np.maximum.accumulate(forces)

    def c_squared(self, alpha):
        """
        Effective c^2 of a push [m^2].

        :param alpha: angle from C->F to the velocity imposed at C [rad]; held beyond the table.
        """
        place = min(max((alpha + STEEPEST) / SPACING, 0.0), len(self._squares) - 1.001)
        index = int(place)
        share = place - index
        return (1.0 - share) * self._squares[index] + share * self._squares[index + 1]

    def push_angle(self, flat, curvature):
        """
        Angle alpha that turns an object by a curvature, ``tan(alpha) = -L(alpha) kappa``.

        :param flat: the ``Vehicle``; its c^2 is that of a push straight to the centre.
        :param curvature: turning rate over the speed along C->F [1/m].
        """
        alpha = 0.0
        for _ in range(4):
            alpha = -math.atan(self._wheelbase(flat, alpha) * curvature)
        return alpha

    def curvatures(self, flat, low, high):
        """
        Curvatures for which the force stays within two directions.

        :param flat: the ``Vehicle``.
        :param low: least angle of the force from C->F [rad].
        :param high: greatest angle [rad].
        :return: (lowest, highest) curvature [1/m].
        """
        bounds = np.interp((high, low), self._forces, self._angles).tolist()
        bounds = [min(STEEPEST_USED, max(-STEEPEST_USED, alpha)) for alpha in bounds]
        return tuple(-math.tan(alpha) / self._wheelbase(flat, alpha) for alpha in bounds)

    def _wheelbase(self, flat, alpha):
        share = self.c_squared(alpha) / self.c_squared(0.0)
        return flat.arm + share * flat.c_squared / flat.arm


def _force_angle(obj, point, push, omega):
    """Direction of the force that drags the supports along, object frame [rad]."""
    total_x = total_y = 0.0
    for support, capacity in zip(obj.supports, obj.capacities):
        v_x = push[0] - omega * (support.y - point[1])
        v_y = push[1] + omega * (support.x - point[0])
        weight = friction_weight(capacity, v_x, v_y, 1e-9)
        total_x, total_y = total_x + weight * v_x, total_y + weight * v_y
    return math.atan2(total_y, total_x)
