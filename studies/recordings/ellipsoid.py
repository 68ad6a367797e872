"""
The plain model of a pushed object: an ellipsoid as limit surface, and a Coulomb contact.

A slow push with the force f at the arm r from the centre of friction moves the object by

    v = f,    omega = m / c^2,    m = r_perp . f,    r_perp = (-r_y, r_x)

but for a scale, so that the contact moves by ``M f`` with ``M = 1 + r_perp r_perp^T / c^2``
(K. M. Lynch, H. Maekawa and K. Tanie 1992). Where ``M^-1 u`` for the velocity u of the rod leaves
the friction cone, the force is on its edge and the contact slides.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.analysis.slow_push import Shape
from push_model.geometry import FloatArray


class Ellipsoid(NamedTuple):
    """
    Parameters of the model.

    :param center: centre of friction, object frame, shape (2,) [m].
    :param c_squared: c^2 [m^2].
    :param contact_friction: mu_c.
    """

    center: FloatArray
    c_squared: float
    contact_friction: float


def integrate(shape: Shape, model: Ellipsoid, rod_radius: float, starts: FloatArray,
              paths: FloatArray) -> FloatArray:
    """
    Integrate pushes along paths of a rod that does not turn.

    :param shape: of the object.
    :param model: of the object.
    :param rod_radius: radius [m].
    :param starts: poses of the object, shape (n, 3) [m, rad].
    :param paths: of the rod, shape (n, m, 3) [m, rad].
    :return: poses in the end, shape (n, 3) [m, rad].
    """
    poses = np.array(starts, dtype=float)
    for before, after in zip(np.moveaxis(paths[:, :-1], 1, 0), np.moveaxis(paths[:, 1:], 1, 0)):
        turned = _rotations(-poses[:, 2])
        rods = _applied(turned, before[:, :2] - poses[:, :2])
        contacts, distances = shape.nearest(rods)
        normals = (contacts - rods) / distances[:, None]
        steps = _applied(turned, after[:, :2] - before[:, :2])
        steps -= (distances - rod_radius)[:, None] * normals
        presses = (steps * normals).sum(axis=1) > 0.0
        moved, turns = _motion(model, contacts, normals, steps)
        moved, turns = np.where(presses[:, None], moved, 0.0), np.where(presses, turns, 0.0)
        # The frame's origin turns about the centre of friction.
        moved += turns[:, None] * np.array([model.center[1], -model.center[0]])
        poses[:, :2] += _applied(_rotations(poses[:, 2] + 0.5 * turns), moved)
        poses[:, 2] += turns
    return poses


def _motion(model: Ellipsoid, contacts: FloatArray, normals: FloatArray,
            steps: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return displacements of the centre of friction (n, 2) and rotations (n,)."""
    arms = contacts - model.center
    perpendicular = np.column_stack([-arms[:, 1], arms[:, 0]])
    mobility = np.eye(2) + (perpendicular[:, :, None] * perpendicular[:, None, :]
                            / model.c_squared)
    forces = np.linalg.solve(mobility, steps[:, :, None])[..., 0]
    angles = np.arctan2(normals[:, 0] * forces[:, 1] - normals[:, 1] * forces[:, 0],
                        (normals * forces).sum(axis=1))
    cone = math.atan(model.contact_friction)
    edges = _applied(_rotations(np.sign(angles) * cone), normals)
    along = (_applied(mobility, edges) * normals).sum(axis=1)
    sliding = edges * ((steps * normals).sum(axis=1) / along)[:, None]
    forces = np.where((np.abs(angles) > cone)[:, None], sliding, forces)
    return forces, (perpendicular * forces).sum(axis=1) / model.c_squared


def _rotations(angles: FloatArray) -> FloatArray:
    cosines, sines = np.cos(angles), np.sin(angles)
    return np.moveaxis(np.array([[cosines, -sines], [sines, cosines]]), -1, 0)


def _applied(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    return (matrices @ vectors[:, :, None])[..., 0]
