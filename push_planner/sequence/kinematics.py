"""
Kinematics of push sequences: where they lead, and their shortest straights.

A sequence is made of moves. A move pushes with one primitive: straight by a_j, along a circle that
rotates the object by the angle dtheta_j, and straight by b_j. Moves that follow each other at one
contact location are one push. Arrays have the axes (m sequences, n moves).

The flat output point z of a push (fixed in the object, at p_j in its frame) moves like a vehicle:
in the direction ``psi``, which is at a fixed angle ``nu`` in the object frame. With theta_j the
orientation of the object before move j, relative to the start, R_j the radius of the circle,
side_j = 1 for a rotation to the left and -1 to the right, u(psi) the unit vector and Rot the
rotation matrix::

    psi_j = theta_j + nu_j                direction before the rotation
    psi_j' = psi_j + dtheta_j             direction after it
    d_j = R_j side_j (sin psi_j' - sin psi_j, cos psi_j - cos psi_j')
          + (Rot(theta_j) - Rot(theta_j + dtheta_j)) p_j
    goal = sum_j a_j u(psi_j) + d_j + b_j u(psi_j')

d_j is the displacement of the object's origin in the rotation. The headings follow from the
rotations alone; then the goal is linear in the lengths a_j >= 0 and b_j >= least b_j. Their least
sum is that of a linear program with two equations: two of the 2 n directions are enough, and the
best are the two next to the missing displacement, one on either side of it.

Two pushes as an example, both with nu = 0 and p = 0, R = 0.5, side = 1, dtheta = (90, 0) degrees,
to the goal (1, 2, 90 degrees), without least lengths: the directions are 0 and 90 degrees before
and after the first rotation, and 90 degrees in the second move. d_1 = (0.5, 0.5), so that
(0.5, 1.5) is missing, at 71.6 degrees, between 0 and 90 degrees: a_1 = 0.5 and a_2 = 1.5 are the
shortest.
"""

import dataclasses
from typing import Union

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import FloatArray, Pose
from push_planner.sequence.primitives import PrimitiveTable

IntArray = NDArray[np.int_]
BoolArray = NDArray[np.bool_]
Rows = Union[IntArray, BoolArray]

# Angles [rad] and lengths [m] that count as 0: above the rounding errors of a few sums.
ROUNDING = 1e-9
# Margin of the angle between the two directions to a straight line [rad], chosen: nearly opposite
# directions would need straights a thousand times as long as what they bring.
MIN_OPENING = 1e-3


@dataclasses.dataclass(frozen=True)
class SequenceMotions:
    """
    Motions of m sequences of n moves.

    :param rotations: signed rotations of the object [rad], shape (m, n).
    :param straight_before: straight lengths before the rotations [m], shape (m, n).
    :param straight_after: straight lengths after the rotations [m], shape (m, n).
    :param path_lengths: of the contact [m], shape (m, n); infinite where the goal is not reached.
    """

    rotations: FloatArray
    straight_before: FloatArray
    straight_after: FloatArray
    path_lengths: FloatArray

    def select(self, rows: Rows) -> 'SequenceMotions':
        """
        Select sequences.

        :param rows: numbers or mask of the sequences.
        """
        return SequenceMotions(self.rotations[rows], self.straight_before[rows],
                               self.straight_after[rows], self.path_lengths[rows])


@dataclasses.dataclass(frozen=True)
class Displacements:
    """
    What rotations do, whatever the straight lengths; all of shape (m, n).

    :param heading: theta, of the object before each move, relative to the start [rad].
    :param before: psi, direction of the straight before each rotation [rad].
    :param after: psi', direction of the straight after it [rad].
    :param x: displacement d of the object's origin in each rotation, x [m].
    :param y: the same, y [m].
    """

    heading: FloatArray
    before: FloatArray
    after: FloatArray
    x: FloatArray
    y: FloatArray

    @classmethod
    def of(cls, table: PrimitiveTable, moves: IntArray, rotations: FloatArray) -> 'Displacements':
        """
        Compute them.

        :param table: ``PrimitiveTable``.
        :param moves: numbers of the primitives, shape (m, n).
        :param rotations: signed rotations [rad], shape (m, n).
        """
        heading = np.cumsum(rotations, axis=1) - rotations
        before = heading + table.flat_angles[moves]
        return cls(heading, before, before + rotations,
                   *_rotation_displacement(table, moves, heading, rotations, before,
                                           before + rotations))


@dataclasses.dataclass(frozen=True)
class _TwoStraights:
    """
    The shortest two straights that make a displacement, for each of m sequences.

    :param left: length along the direction on the left of it [m], shape (m,).
    :param left_column: number of that direction, shape (m,).
    :param right: length along the direction on its right [m], shape (m,).
    :param right_column: number of that direction, shape (m,).
    :param reached: whether there are such, shape (m,); the lengths are 0 where there are none.
    """

    left: FloatArray
    left_column: IntArray
    right: FloatArray
    right_column: IntArray
    reached: BoolArray


def complete_rotations(table: PrimitiveTable, moves: IntArray, rotations: FloatArray,
                       heading: float) -> FloatArray:
    """
    Append the rotations of the last moves, which follow from the heading of the goal.

    :param table: ``PrimitiveTable``.
    :param moves: numbers of the primitives, shape (m, n).
    :param rotations: signed rotations of all moves but the last [rad], shape (m, n - 1).
    :param heading: of the goal, relative to the start [rad].
    :return: signed rotations, shape (m, n); NaN in the last column where it would be too large.
    """
    last = moves[:, -1]
    missing = table.sides[last] * (heading - rotations.sum(axis=1))
    missing = np.maximum((missing + ROUNDING) % (2.0 * np.pi) - ROUNDING, 0.0)
    missing[missing > table.max_rotations[last] + ROUNDING] = np.nan
    return np.column_stack([rotations, table.sides[last] * missing])


def solve_straights(table: PrimitiveTable, moves: IntArray, rotations: FloatArray, goal: Pose,
                    min_after: FloatArray) -> SequenceMotions:
    """
    Find the shortest straights with which sequences reach the goal.

    :param table: ``PrimitiveTable``.
    :param moves: numbers of the primitives, shape (m, n).
    :param rotations: signed rotations [rad], shape (m, n), as ``complete_rotations`` makes them.
    :param goal: ``Pose`` in the frame of the object before the first push.
    :param min_after: least straight length after each rotation [m], shape (m, n).
    :return: ``SequenceMotions``.
    """
    part = Displacements.of(table, moves, rotations)
    x = goal.x - (part.x + min_after * np.cos(part.after)).sum(axis=1)
    y = goal.y - (part.y + min_after * np.sin(part.after)).sum(axis=1)
    two = _two_straights(np.hstack([part.before, part.after]), x, y)
    rows = np.arange(len(moves))
    n = moves.shape[1]
    straights = np.zeros((len(moves), 2 * n))
    straights[:, n:] = min_after
    straights[rows, two.left_column] += two.left
    straights[rows, two.right_column] += two.right
    before = straights[:, :n]
    after = straights[:, n:]
    arcs = np.abs(rotations) * table.radii[moves] * table.length_ratios[moves]
    path_lengths = arcs + before + after
    return SequenceMotions(rotations, before, after,
                           np.where(two.reached[:, None], path_lengths, np.inf))


def longest_pushes(locations: IntArray, path_lengths: FloatArray) -> FloatArray:
    """
    Find the path length of the longest push of each sequence [m], shape (m,).

    :param locations: numbers of the contact locations of the moves, shape (m, n).
    :param path_lengths: of the contact in the moves [m], shape (m, n).
    """
    length = longest = path_lengths[:, 0]
    for i in range(1, locations.shape[1]):
        goes_on = locations[:, i] == locations[:, i - 1]
        length = path_lengths[:, i] + np.where(goes_on, length, 0.0)
        longest = np.maximum(longest, length)
    return longest


def last_push(locations: IntArray, motions: SequenceMotions) -> tuple[FloatArray, FloatArray]:
    """
    Find how the last push of each sequence rotates the object, and its path length.

    :param locations: numbers of the contact locations of the moves, shape (m, n).
    :param motions: ``SequenceMotions`` of m sequences.
    :return: (rotation to and fro [rad], path length of the contact [m]), each of shape (m,).
    """
    same_location = locations == locations[:, -1:]
    in_last_push = np.logical_and.accumulate(same_location[:, ::-1], axis=1)[:, ::-1]
    rotation = np.abs(np.where(in_last_push, motions.rotations, 0.0)).sum(axis=1)
    return rotation, np.where(in_last_push, motions.path_lengths, 0.0).sum(axis=1)


def _rotation_displacement(table: PrimitiveTable, moves: IntArray, heading: FloatArray,
                           rotations: FloatArray, before: FloatArray,
                           after: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (x, y) of d in the module's docstring, each of shape (m, n)."""
    radius = table.radii[moves] * table.sides[moves]
    f_x, f_y = table.flat_outputs[moves, 0], table.flat_outputs[moves, 1]
    end = heading + rotations
    c, s = np.cos(heading) - np.cos(end), np.sin(heading) - np.sin(end)
    return (radius * (np.sin(after) - np.sin(before)) + c * f_x - s * f_y,
            radius * (np.cos(before) - np.cos(after)) + s * f_x + c * f_y)


def _two_straights(directions: FloatArray, x: FloatArray, y: FloatArray) -> _TwoStraights:
    """
    Split displacements into lengths along the directions next to them, by the sine rule.

    :param directions: that there are [rad], shape (m, k).
    :param x: displacement, x [m], shape (m,).
    :param y: displacement, y [m], shape (m,).
    """
    distance = np.hypot(x, y)
    angle = directions - np.arctan2(y, x)[:, None]
    angle = (angle + np.pi) % (2.0 * np.pi) - np.pi
    to_left = np.where(angle >= 0.0, angle, np.inf)
    to_right = np.where(angle <= 0.0, -angle, np.inf)
    left_column, right_column = to_left.argmin(axis=1), to_right.argmin(axis=1)
    rows = np.arange(len(x))
    left_angle, right_angle = to_left[rows, left_column], to_right[rows, right_column]
    opening = left_angle + right_angle
    reached = (opening < np.pi - MIN_OPENING) | (distance < ROUNDING)
    # Straight ahead both angles are 0, and either direction will do.
    ahead = opening < ROUNDING
    sine = np.where(reached & ~ahead, np.sin(np.where(np.isfinite(opening), opening, 1.0)), 1.0)
    left = np.where(ahead, distance,
                    distance * np.sin(np.where(reached, right_angle, 0.0)) / sine)
    right = np.where(ahead, 0.0, distance * np.sin(np.where(reached, left_angle, 0.0)) / sine)
    return _TwoStraights(np.where(reached, left, 0.0), left_column,
                         np.where(reached, right, 0.0), right_column, reached)
