"""
An independent judge of the plant: a rigid body in the plane under Coulomb friction.

Impulses are the unknowns, not velocities: each foot has one in a disc of radius ``h mu_i N_i``,
the contact one in the cone of its friction. Projected Gauss-Seidel sweeps solve for them (Jean and
Moreau's time stepping). No friction is smoothed. Geometry is taken at the start of a step, so the
error is of first order in the step. Nothing is imported from the plant.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject

GRAVITY = 9.81
# Greatest change of a velocity in the last sweep [m/s]: it ends the sweeps of a step.
TOLERANCE = 1e-8
MAX_SWEEPS = 2000
Vector = tuple[float, float]


class RoundPusher(NamedTuple):
    """
    A disc that ramps up to a constant velocity, from rest, without rotation.

    :param x: of its centre at the start [m].
    :param y: of its centre at the start [m].
    :param radius: [m].
    :param velocity: that it reaches [m/s].
    :param acceleration: along the way there [m/s^2].
    """

    x: float
    y: float
    radius: float
    velocity: Vector
    acceleration: float = 2.0

    def center(self, time: float) -> Vector:
        """Return the centre after a time [s]."""
        speed = math.hypot(*self.velocity)
        ramp = min(time, speed / self.acceleration)
        path = 0.5 * self.acceleration * ramp ** 2 + speed * (time - ramp)
        return (self.x + path * self.velocity[0] / speed, self.y + path * self.velocity[1] / speed)


def foot_limits(obj: PushedObject) -> list[float]:
    """Return mu_i N_i [N]: loads of least norm that balance weight and both moments."""
    feet = np.array([(foot.x, foot.y) for foot in obj.supports])
    balance = np.vstack([np.ones(len(feet)), (feet - np.array(obj.center_of_mass)).T])
    loads = np.linalg.lstsq(balance, [obj.mass * GRAVITY, 0.0, 0.0], rcond=None)[0]
    return [foot.friction_coefficient * load for foot, load in zip(obj.supports, loads.tolist())]


def nearest_point(obj: PushedObject, point: Vector) -> Vector:
    """Return the point of the outline nearest to a point, both in the object frame."""
    if obj.radius:
        scale = obj.radius / math.hypot(*point)
        return scale * point[0], scale * point[1]
    corners = np.array(obj.outline)
    edges = np.roll(corners, -1, axis=0) - corners
    along = np.sum((np.array(point) - corners) * edges, axis=1) / np.sum(edges ** 2, axis=1)
    points = corners + np.clip(along, 0.0, 1.0)[:, None] * edges
    nearest = points[np.argmin(np.hypot(*(points - np.array(point)).T))]
    return float(nearest[0]), float(nearest[1])


class PlanarIntegrator:
    """
    Object and pusher, stepped by impulses.

    :param obj: ``PushedObject`` at rest in the origin; heights play no part.
    :param pusher: ``RoundPusher``.
    :param step: h [s].
    """

    def __init__(self, obj: PushedObject, pusher: RoundPusher, step: float) -> None:
        self._obj = obj
        self._pusher = pusher
        self._step = step
        self._position = list(obj.center_of_mass)
        self._theta = 0.0
        # v_x, v_y [m/s] of the mass centre, yaw rate [rad/s].
        self._velocity = [0.0, 0.0, 0.0]
        self._limits = [step * limit for limit in foot_limits(obj)]
        self._foot_impulses = [[0.0, 0.0] for _ in obj.supports]
        self._contact_impulse = [0.0, 0.0]
        self._time = 0.0

    def end(self, duration: float) -> Pose:
        """Advance; return the pose of the object frame."""
        for _ in range(round(duration / self._step)):
            self._advance()
        c, s = math.cos(self._theta), math.sin(self._theta)
        com_x, com_y = self._obj.center_of_mass
        return Pose(self._position[0] - c * com_x + s * com_y,
                    self._position[1] - s * com_x - c * com_y, self._theta)

    def _advance(self) -> None:
        h, pusher = self._step, self._pusher
        start, end = pusher.center(self._time), pusher.center(self._time + h)
        drive = (end[0] - start[0]) / h, (end[1] - start[1]) / h
        arm, normal, gap = self._contact(start)
        feet = [self._arm((foot.x, foot.y)) for foot in self._obj.supports]
        for foot, impulse in zip(feet, self._foot_impulses):
            self._apply(foot, impulse[0], impulse[1])
        self._apply(arm, *self._along(normal, self._contact_impulse))
        for _ in range(MAX_SWEEPS):
            change = max(self._slide(*row) for row in zip(feet, self._foot_impulses, self._limits))
            change = max(change, self._touch(arm, normal, gap / h, drive))
            if change < TOLERANCE:
                break
        else:
            raise ArithmeticError(f'{MAX_SWEEPS} sweeps at {self._time:g} s do not converge')
        self._position[0] += h * self._velocity[0]
        self._position[1] += h * self._velocity[1]
        self._theta += h * self._velocity[2]
        self._time += h

    def _arm(self, point: Vector) -> Vector:
        """Return the arm of a point of the object from the mass centre, in world axes."""
        x, y = (point[i] - self._obj.center_of_mass[i] for i in (0, 1))
        c, s = math.cos(self._theta), math.sin(self._theta)
        return c * x - s * y, s * x + c * y

    def _contact(self, center: Vector) -> tuple[Vector, Vector, float]:
        """Return arm, normal into the object, and gap [m], for a centre of the pusher."""
        c, s = math.cos(self._theta), math.sin(self._theta)
        x, y = center[0] - self._position[0], center[1] - self._position[1]
        com_x, com_y = self._obj.center_of_mass
        arm = self._arm(nearest_point(self._obj, (c * x + s * y + com_x, c * y - s * x + com_y)))
        distance = math.hypot(arm[0] - x, arm[1] - y)
        normal = (arm[0] - x) / distance, (arm[1] - y) / distance
        return arm, normal, distance - self._pusher.radius

    @staticmethod
    def _along(normal: Vector, impulse: list[float]) -> Vector:
        """Return a (normal, tangential) impulse in world axes."""
        return (normal[0] * impulse[0] - normal[1] * impulse[1],
                normal[1] * impulse[0] + normal[0] * impulse[1])

    def _apply(self, arm: Vector, p_x: float, p_y: float) -> None:
        velocity = self._velocity
        velocity[0] += p_x / self._obj.mass
        velocity[1] += p_y / self._obj.mass
        velocity[2] += (arm[0] * p_y - arm[1] * p_x) / self._obj.inertia

    def _point_velocity(self, arm: Vector) -> Vector:
        v_x, v_y, omega = self._velocity
        return v_x - omega * arm[1], v_y + omega * arm[0]

    def _slide(self, arm: Vector, impulse: list[float], limit: float) -> float:
        """Stop a foot as far as its friction can; return the change of velocity [m/s]."""
        softness = 1.0 / self._obj.mass + (arm[0] ** 2 + arm[1] ** 2) / self._obj.inertia
        v_x, v_y = self._point_velocity(arm)
        p_x, p_y = impulse[0] - v_x / softness, impulse[1] - v_y / softness
        scale = min(1.0, limit / max(math.hypot(p_x, p_y), 1e-300))
        d_x, d_y = scale * p_x - impulse[0], scale * p_y - impulse[1]
        self._apply(arm, d_x, d_y)
        impulse[0] += d_x
        impulse[1] += d_y
        return softness * math.hypot(d_x, d_y)

    def _touch(self, arm: Vector, normal: Vector, closing: float, drive: Vector) -> float:
        """Keep object and pusher apart, then hold them by friction; return the change [m/s]."""
        total = 0.0
        for row, (a_x, a_y), target in ((0, normal, -closing),
                                        (1, (-normal[1], normal[0]), 0.0)):
            lever = arm[0] * a_y - arm[1] * a_x
            softness = 1.0 / self._obj.mass + lever ** 2 / self._obj.inertia
            v_x, v_y = self._point_velocity(arm)
            speed = (v_x - drive[0]) * a_x + (v_y - drive[1]) * a_y - target
            impulse = self._contact_impulse[row] - speed / softness
            if row == 0:
                impulse = max(0.0, impulse)
            else:
                bound = self._obj.contact_friction_coefficient * self._contact_impulse[0]
                impulse = min(bound, max(-bound, impulse))
            change = impulse - self._contact_impulse[row]
            self._apply(arm, change * a_x, change * a_y)
            self._contact_impulse[row] = impulse
            total = max(total, softness * abs(change))
        return total
