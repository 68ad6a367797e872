"""
Slow pushes through a contact that sticks or slides: the motion cone.

A contact force F_C moves an object that slides slowly on its supports so that friction does the
most work (M. T. Mason 1986; S. Goyal, A. Ruina and J. Papadopoulos 1991): with V the motion of the
object (velocity of the contact C, yaw rate),

    P(V) = sum_i q_i |v_i|,    F_C = dP / dv_C,    0 = dP / domega.

* **Sticking**: v_C is that of the robot's surface; omega is where ``dP / domega = 0``.
* **Sliding**: the force lies on the edge of the friction cone, in the direction e. With d normal
  to e, V is the minimum of the convex P over the velocity of C along d and the yaw rate, at
  velocity 1 along e; its scale follows from the normal velocity of the robot.

The directions of v_C that belong to the two edges of the friction cone bound the *motion cone*: a
push inside it sticks, one outside it slides. A push inside the friction cone may well slide.

All functions take n contacts of one object at a time.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from push_model.geometry import FloatArray, wrap_angles
from push_model.parameters import PushedObject

# Friction is smoothed below this fraction of the velocity along the force. Chosen: below all that
# matters, and above what Newton's method resolves.
SMOOTHING = 1e-7
# Newton's method is led there from a smoothing of 1 in factors of this, in so many steps at most
# each. Chosen by trial.
CONTINUATION = 0.03
NEWTON_STEPS = 8
# A step of Newton's method below this is rounding.
CONVERGED = 1e-11
# Halvings of the bracket of a yaw rate: to rounding.
BISECTIONS = 60
# Halvings of a step that would make the power grow; chosen: a millionth of it is no step.
MAX_HALVINGS = 20
# A contact force this far inside the cone sticks [rad]: rounding.
ROUNDING = 1e-9


class ContactMotion(NamedTuple):
    """
    Motion of an object at n contacts, in its own axes.

    :param velocities: of the object at C, shape (n, 2) [m/s].
    :param yaw_rates: of the object, shape (n,) [rad/s].
    :param forces: of the robot on the object, shape (n, 2) [N].
    :param force_angles: of the force from the normal, shape (n,) [rad].
    :param slides: 0 where the contact sticks; 1 or -1 where the force is on the edge of the cone
        to the left or to the right of the normal, shape (n,).
    """

    velocities: FloatArray
    yaw_rates: FloatArray
    forces: FloatArray
    force_angles: FloatArray
    slides: NDArray[np.int_]


class SupportArrays(NamedTuple):
    """
    Supports of one object, or of n objects that differ.

    :param positions: in the object frame, shape (k, 2) or (n, k, 2) [m].
    :param capacities: friction capacities, shape (k,) or (n, k) [N].
    """

    positions: FloatArray
    capacities: FloatArray

    @classmethod
    def of(cls, obj: PushedObject) -> 'SupportArrays':
        """Take the supports of an object."""
        return cls(np.array([(support.x, support.y) for support in obj.supports]),
                   np.array(obj.capacities))


class _Arms(NamedTuple):
    """Supports seen from n contacts: arms rotated by 90 degrees (n, k, 2) [m]; capacities."""

    rotated: FloatArray
    capacities: FloatArray

    @classmethod
    def of(cls, supports: SupportArrays, points: FloatArray) -> '_Arms':
        arms = supports.positions - points[:, None, :]
        rotated = np.stack([-arms[..., 1], arms[..., 0]], axis=-1)
        return cls(rotated, np.broadcast_to(supports.capacities, arms.shape[:2]))

    def rows(self, chosen: Any) -> '_Arms':
        """Select contacts."""
        return _Arms(self.rotated[chosen], self.capacities[chosen])

    def friction(self, velocities: FloatArray, yaw_rates: FloatArray,
                 smoothing: Any) -> tuple[FloatArray, FloatArray]:
        """Return what the robot must exert: forces (n, 2) and moments about C (n,)."""
        slide = velocities[:, None, :] + yaw_rates[:, None, None] * self.rotated
        size = np.sqrt((slide ** 2).sum(axis=-1) + np.asarray(smoothing) ** 2)
        forces = (self.capacities / size)[..., None] * slide
        return forces.sum(axis=1), (forces * self.rotated).sum(axis=(1, 2))


def contact_motion(supports: SupportArrays, points: ArrayLike, normals: ArrayLike,
                   velocities: ArrayLike, contact_friction: ArrayLike) -> ContactMotion:
    """
    Find the motion of an object that is pushed slowly, sticking or sliding.

    :param supports: of the object, or of each.
    :param points: contacts in the object frame, shape (n, 2) [m].
    :param normals: directions of the normals n in the object frame, shape (n,) [rad].
    :param velocities: of the robot's surface at the contacts, object frame, with a part along n,
        shape (n, 2) [m/s].
    :param contact_friction: mu_c, one number or shape (n,).
    :return: the motion.
    """
    points, normals, velocities = (np.asarray(value, dtype=float)
                                   for value in (points, normals, velocities))
    arms = _Arms.of(supports, points)
    yaw_rates = _sticking_yaw_rates(arms, velocities)
    speeds = np.hypot(*velocities.T)
    forces, _ = arms.friction(velocities, yaw_rates, SMOOTHING * speeds[:, None])
    angles = wrap_angles(np.arctan2(forces[:, 1], forces[:, 0]) - normals)
    cone = np.broadcast_to(np.arctan(contact_friction), angles.shape)
    slides = np.where(np.abs(angles) > cone + ROUNDING, np.sign(angles), 0.0).astype(int)
    sliding = slides != 0
    if sliding.any():
        # The force lies on the edge of the cone; the contact stays closed.
        edges = slides[sliding] * cone[sliding]
        pushed = _cone_edge(arms.rows(sliding), normals[sliding] + edges)
        normal = np.column_stack([np.cos(normals[sliding]), np.sin(normals[sliding])])
        scale = ((velocities[sliding] * normal).sum(axis=1)
                 / (pushed.velocities * normal).sum(axis=1))
        velocities, forces = velocities.copy(), forces.copy()
        velocities[sliding] = scale[:, None] * pushed.velocities
        yaw_rates[sliding] = scale * pushed.yaw_rates
        forces[sliding], angles[sliding] = pushed.forces, edges
    return ContactMotion(velocities, yaw_rates, forces, angles, slides)


def motion_cone(supports: SupportArrays, points: ArrayLike, normals: ArrayLike,
                contact_friction: float) -> FloatArray:
    """
    Find the directions of the velocity of C at the two edges of the friction cone.

    :param supports: of the object.
    :param points: contacts in the object frame, shape (n, 2) [m].
    :param normals: directions of the normals n in the object frame, shape (n,) [rad].
    :param contact_friction: mu_c.
    :return: angles from the normal at the right and at the left edge, shape (n, 2) [rad].
    """
    points, normals = np.asarray(points, dtype=float), np.asarray(normals, dtype=float)
    arms, cone = _Arms.of(supports, points), math.atan(contact_friction)
    edges = [_cone_edge(arms, normals + side * cone).velocities for side in (-1.0, 1.0)]
    return np.column_stack([wrap_angles(np.arctan2(edge[:, 1], edge[:, 0]) - normals)
                            for edge in edges])


def _sticking_yaw_rates(arms: _Arms, velocities: FloatArray) -> FloatArray:
    """Bisect the moment, which grows with the yaw rate."""
    speeds = np.hypot(*velocities.T)
    longest_arms = np.sqrt((arms.rotated ** 2).sum(axis=-1)).max(axis=1)
    # A first bracket, widened below where it is too narrow.
    high = 4.0 * speeds / np.maximum(longest_arms, 1e-9)
    smoothing = SMOOTHING * speeds[:, None]
    while True:
        outside = ((arms.friction(velocities, high, smoothing)[1] < 0.0)
                   | (arms.friction(velocities, -high, smoothing)[1] > 0.0))
        if not outside.any():
            break
        high = np.where(outside, 2.0 * high, high)
    low = -high
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        is_above = arms.friction(velocities, middle, smoothing)[1] > 0.0
        low, high = np.where(is_above, low, middle), np.where(is_above, middle, high)
    return 0.5 * (low + high)


class _Pushed(NamedTuple):
    """Motion by a force in a given direction: velocity 1 along it, shapes as above."""

    velocities: FloatArray
    yaw_rates: FloatArray
    forces: FloatArray


def _cone_edge(arms: _Arms, directions: FloatArray) -> _Pushed:
    """Minimize P over the velocity b along d and the yaw rate, at velocity 1 along e."""
    e = np.column_stack([np.cos(directions), np.sin(directions)])
    d = np.column_stack([-e[:, 1], e[:, 0]])
    unknowns = np.zeros((len(e), 2))
    # Velocity of each support per unit of b and of omega, shape (n, k, 2) each.
    slopes = (np.broadcast_to(d[:, None, :], arms.rotated.shape), arms.rotated)

    def slides(at: FloatArray) -> FloatArray:
        return (e[:, None, :] + at[:, 0, None, None] * slopes[0]
                + at[:, 1, None, None] * slopes[1])

    def power(at: FloatArray, smoothing: float) -> FloatArray:
        size = np.sqrt((slides(at) ** 2).sum(axis=-1) + smoothing ** 2)
        return (arms.capacities * size).sum(axis=1)

    smoothing = 1.0
    while smoothing > SMOOTHING:
        smoothing = max(SMOOTHING, CONTINUATION * smoothing)
        for _ in range(NEWTON_STEPS):
            step = _newton_step(arms, slides(unknowns), slopes, smoothing)
            if np.abs(step).max() < CONVERGED:
                break
            unknowns = _damped(unknowns, step, power, smoothing)
    velocities = e + unknowns[:, :1] * d
    forces, _ = arms.friction(velocities, unknowns[:, 1], SMOOTHING)
    return _Pushed(velocities, unknowns[:, 1], forces)


def _newton_step(arms: _Arms, slide: FloatArray, slopes: tuple[FloatArray, FloatArray],
                 smoothing: float) -> FloatArray:
    """Solve for the step of both unknowns, shape (n, 2)."""
    size = np.sqrt((slide ** 2).sum(axis=-1) + smoothing ** 2)
    weights = arms.capacities / size
    along = [(slide * slope).sum(axis=-1) for slope in slopes]
    gradient = np.stack([(weights * part).sum(axis=1) for part in along], axis=-1)
    hessian = np.empty((len(slide), 2, 2))
    for i in range(2):
        for j in range(2):
            both = (slopes[i] * slopes[j]).sum(axis=-1)
            hessian[:, i, j] = (weights * (both - along[i] * along[j] / size ** 2)).sum(axis=1)
    step = np.linalg.solve(hessian, -gradient[..., None])[..., 0]
    return np.asarray(step, dtype=np.float64)


def _damped(unknowns: FloatArray, step: FloatArray, power: Any, smoothing: float) -> FloatArray:
    """Take the step, halved where the power would grow."""
    before = power(unknowns, smoothing)
    fraction = np.ones(len(unknowns))
    for _ in range(MAX_HALVINGS):
        # Growth by a rounding is none.
        grows = power(unknowns + fraction[:, None] * step, smoothing) > before * (1.0 + 1e-14)
        if not grows.any():
            break
        fraction = np.where(grows, 0.5 * fraction, fraction)
    return unknowns + fraction[:, None] * step
