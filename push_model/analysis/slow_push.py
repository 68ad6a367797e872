"""
Slow pushes by a round robot, integrated for many objects, parameters or starts at a time.

Without inertia (``sliding_contact``): the contact sticks or slides, is taken where robot and
object are nearest at the start of a step, and a gap or an overlap that is left is made up for
in the next one.

A contact above the floor shifts loads between the supports (``docs/physics.md``, section 11). The
loads of a step are those that the contact force of the step before causes; the first step takes a
force along the displacement, as great as all friction.
"""

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from push_model.analysis.planar import rotated
from push_model.analysis.sliding_contact import contact_motion, SupportArrays
from push_model.friction import load_gradients
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject


class Shape(NamedTuple):
    """
    Outline of an object.

    :param outline: vertices, counter-clockwise, shape (e, 2) [m]; empty for a disc.
    :param radius: of a disc about the frame's origin [m].
    """

    outline: FloatArray
    radius: float

    @classmethod
    def of(cls, obj: PushedObject) -> 'Shape':
        """Take the outline of an object."""
        return cls(np.array(obj.outline, dtype=float).reshape(-1, 2), obj.radius)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """
        Find what is nearest to points outside of the outline.

        :param points: object frame, shape (n, 2) [m].
        :return: nearest points of the outline, shape (n, 2) [m], and their distances, (n,) [m].
        """
        if not len(self.outline):
            sizes = np.hypot(*points.T)
            return points * (self.radius / sizes)[:, None], sizes - self.radius
        edges = np.roll(self.outline, -1, axis=0) - self.outline
        offsets = points[:, None, :] - self.outline
        fractions = (offsets * edges).sum(axis=-1) / (edges ** 2).sum(axis=-1)
        candidates = self.outline + np.clip(fractions, 0.0, 1.0)[..., None] * edges
        distances = np.hypot(*np.moveaxis(points[:, None, :] - candidates, -1, 0))
        rows, best = np.arange(len(points)), np.argmin(distances, axis=1)
        return candidates[rows, best], distances[rows, best]


class LoadedSupports(NamedTuple):
    """
    Supports of one object, or of n objects that differ, whose loads a contact force may shift.

    :param at_rest: positions, and friction capacities under the loads at rest.
    :param shifts: change of each capacity by the contact force, ``mu_i z_C eta_i`` in the object
        frame, shape (k, 2) or (n, k, 2); 0 for a contact on the floor.
    """

    at_rest: SupportArrays
    shifts: FloatArray

    @classmethod
    def of(cls, obj: PushedObject) -> 'LoadedSupports':
        """Take the supports of an object, and the height of its contact."""
        friction = np.array([support.friction_coefficient for support in obj.supports])
        shifts = obj.contact_height * friction[:, None] * np.array(load_gradients(obj))
        return cls(SupportArrays.of(obj), shifts)

    @classmethod
    def stacked(cls, each: Sequence['LoadedSupports']) -> 'LoadedSupports':
        """Stack supports of objects, of each or of sets of them, to those of n objects."""
        rows = [[np.reshape(array, (-1, *array.shape[-dimensions:]))
                 for array, dimensions in ((one.at_rest.positions, 2),
                                           (one.at_rest.capacities, 1), (one.shifts, 2))]
                for one in each]
        positions, capacities, shifts = (np.concatenate(column) for column in zip(*rows))
        return cls(SupportArrays(positions, capacities), shifts)

    def rows(self, rows: NDArray[np.int_]) -> 'LoadedSupports':
        """Select pushes."""
        (positions, capacities), shifts = self
        return LoadedSupports(
            SupportArrays(positions if positions.ndim == 2 else positions[rows],
                          capacities if capacities.ndim == 1 else capacities[rows]),
            shifts if shifts.ndim == 2 else shifts[rows])

    def under(self, forces: FloatArray) -> SupportArrays:
        """
        Return the supports under contact forces; one that lifts has no friction.

        :param forces: of the robot on the object, object frame, shape (n, 2) [N].
        """
        capacities = self.at_rest.capacities + (self.shifts @ forces[:, :, None])[..., 0]
        return SupportArrays(self.at_rest.positions, np.maximum(capacities, 0.0))


class SlowPushes(NamedTuple):
    """
    Integrated pushes.

    :param poses: of the object frame in the world, shape (n, m, 3) [m, rad].
    :param forces: of the robot on the object in world axes in the step that leads there, 0 without
        contact, shape (n, m, 2) [N].
    :param slides: as of ``ContactMotion``, shape (n, m).
    """

    poses: FloatArray
    forces: FloatArray
    slides: NDArray[np.int_]


def integrate_slow_pushes(shape: Shape, supports: LoadedSupports, contact_friction: ArrayLike,
                          robot_radius: float, starts: FloatArray,
                          paths: FloatArray) -> SlowPushes:
    """
    Integrate pushes along paths of the robot.

    :param shape: of the object.
    :param supports: of the object, or of each push.
    :param contact_friction: mu_c, one number or shape (n,).
    :param robot_radius: R_p [m], above 0.
    :param starts: poses of the object, shape (n, 3) [m, rad].
    :param paths: poses of the robot, a step apart that is small against its radius and the object,
        shape (n, m, 3) [m, rad].
    :return: the pushes at the points of the paths.
    """
    friction = np.broadcast_to(np.asarray(contact_friction, dtype=float), len(starts))
    poses = np.array(starts, dtype=float)
    pushes = SlowPushes(np.empty_like(paths), np.zeros((*paths.shape[:2], 2)),
                        np.zeros(paths.shape[:2], dtype=int))
    pushes.poses[:, 0] = poses
    forces = np.full((len(starts), 2), np.nan)
    for index in range(1, paths.shape[1]):
        step = _Step.of(shape, robot_radius, poses, paths[:, index - 1], paths[:, index])
        rows = np.flatnonzero(step.presses)
        if len(rows):
            pushed = supports.rows(rows)
            before = _first_forces(pushed, forces[rows], step.displacements[rows])
            motion = contact_motion(pushed.under(before), step.points[rows], step.normals[rows],
                                    step.displacements[rows], friction[rows])
            forces[rows] = motion.forces
            moved = _moved(poses[rows], step.points[rows], motion.velocities, motion.yaw_rates)
            pushes.forces[rows, index] = _rotated_rows(poses[rows, 2], motion.forces)
            pushes.slides[rows, index] = motion.slides
            poses[rows] = moved
        pushes.poses[:, index] = poses
    return pushes


class _Step(NamedTuple):
    """
    Contacts of n pushes in one step, in the object frame.

    :param points: of the outline that are nearest to the robot, shape (n, 2) [m].
    :param normals: directions of the normals, shape (n,) [rad].
    :param displacements: of the robot's surface there, less the gap, shape (n, 2) [m].
    :param presses: whether the robot presses on the object, shape (n,).
    """

    points: FloatArray
    normals: FloatArray
    displacements: FloatArray
    presses: NDArray[np.bool_]

    @classmethod
    def of(cls, shape: Shape, robot_radius: float, poses: FloatArray, before: FloatArray,
           after: FloatArray) -> '_Step':
        centers = _rotated_rows(-poses[:, 2], before[:, :2] - poses[:, :2])
        points, distances = shape.nearest(centers)
        inward = points - centers
        normals = np.arctan2(inward[:, 1], inward[:, 0])
        inwards = np.column_stack([np.cos(normals), np.sin(normals)])
        tangents = np.column_stack([-inwards[:, 1], inwards[:, 0]])
        spin = robot_radius * (after[:, 2] - before[:, 2])
        steps = _rotated_rows(-poses[:, 2], after[:, :2] - before[:, :2])
        steps = steps + spin[:, None] * tangents
        # What is left of the gap is not pushed.
        steps = steps - (distances - robot_radius)[:, None] * inwards
        return cls(points, normals, steps, (steps * inwards).sum(axis=1) > 0.0)


def _first_forces(supports: LoadedSupports, forces: FloatArray,
                  displacements: FloatArray) -> FloatArray:
    """Take the forces of the step before, and all friction along the displacement in the first."""
    sizes = supports.at_rest.capacities.sum(axis=-1) / np.hypot(*displacements.T)
    return np.where(np.isnan(forces), sizes[:, None] * displacements, forces)


def _moved(poses: FloatArray, points: FloatArray, displacements: FloatArray,
           rotations: FloatArray) -> FloatArray:
    """Move poses so that their material points are displaced, rotating at the middle heading."""
    middle = poses[:, 2] + 0.5 * rotations
    origin = displacements + rotations[:, None] * np.column_stack([points[:, 1], -points[:, 0]])
    return np.column_stack([poses[:, :2] + _rotated_rows(middle, origin), poses[:, 2] + rotations])


def _rotated_rows(angles: FloatArray, vectors: FloatArray) -> FloatArray:
    return np.column_stack(rotated(angles, vectors[:, 0], vectors[:, 1]))
