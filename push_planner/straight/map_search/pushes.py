"""Straight pushes as the compiled search reads them: mean effects, and how sure these are."""

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from push_dynamics.compiled import compiled
from push_model.geometry import BoolArray, FloatArray, IntArray
from push_model.parameters import PushedObject
from push_primitives.store import PushPrimitives
from push_primitives.table import PrimitiveTable

# Lengths at which pushes of the search may end, of those of the table [m]; chosen: in ratios of
# about 1.6. Pushes on to the goal end anywhere.
END_LENGTHS = (0.045, 0.09, 0.16, 0.28, 0.48, 0.62, 0.8)
# Every this many-th point of a face, and angles up to this, are used before the last push; chosen:
# as many as the cost-to-go has, with those between.
POINT_STRIDE = 2
MAX_APPROACH_ANGLE = 0.31
# A contact counts as lost where it is nearer to a vertex than this, or the gap more than this [m].
VERTEX_DISTANCE = 0.005
LOST_GAP = 0.012
# Weight of the samples of friction with which the contact must hold.
HOLDING_WEIGHT = 0.95


# Places on the first axis of the effects of pushes: the first push of a chain, by a robot whose
# position is as uncertain as it is now, and later ones, by a robot that is localized.
FIRST, LATER = range(2)


class Pushes(NamedTuple):
    """
    Straight pushes; n of them start differently, and may end at L lengths.

    The first axis of ``means``, ``stds`` and ``last`` has ``FIRST`` and ``LATER`` pushes.

    :param primitives: indices in the table, shape (n,).
    :param faces: at which they push, shape (n,).
    :param starts: robot centre at first contact and direction of motion in the object frame, shape
        (n, 3).
    :param lengths: driven lengths, increasing from 0, shape (L,) [m].
    :param means: mean displacements of the object, shape (2, n, L, 3).
    :param stds: standard deviation of the vertex that varies most, shape (2, n, L) [m].
    :param last: index of the length up to which the contact holds, shape (2, n); pushes with 0
        or less are not made.
    :param coarse: whether pushes that are not the last one may start so, shape (n,).
    :param is_end: whether they may end at a length, shape (L,).
    :param middles: robot centres at contact with the middles of the faces, shape (f, 2) [m].
    :param normals: inward normals there, shape (f, 2).
    """

    primitives: IntArray
    faces: IntArray
    starts: FloatArray
    lengths: FloatArray
    means: FloatArray
    stds: FloatArray
    last: IntArray
    coarse: BoolArray
    is_end: BoolArray
    middles: FloatArray
    normals: FloatArray


class _Effects(NamedTuple):
    """Effects of pushes; fields as of ``Pushes``, without their first axis."""

    means: FloatArray
    stds: FloatArray
    last: IntArray


class _Contacts(NamedTuple):
    """
    Contacts of the pushes as compiled code reads them; fields as of ``Pushes``.

    :param sides: middle of the face (x, y), direction along it (x, y) and half its length, shape
        (n, 5); where the outline is curved, centre (x, y) and radius of the circle that it follows
        there, 0, and an infinite length.
    :param vertices: of the object, or points on its rim, shape (v, 2) [m].
    :param robot_radius: [m].
    """

    primitives: IntArray
    starts: FloatArray
    lengths: FloatArray
    sides: FloatArray
    vertices: FloatArray
    robot_radius: float


class _Starts(NamedTuple):
    """Starts of the pushes, which do not depend on the weights; fields as of ``Pushes``."""

    contacts: _Contacts
    coarse: BoolArray
    is_end: BoolArray
    middles: FloatArray
    normals: FloatArray


def make_pushes(primitives: PushPrimitives, obj: PushedObject, robot_radius: float,
                weights: FloatArray, is_localized: bool) -> Pushes:
    """
    Prepare the straight pushes of a table.

    :param robot_radius: [m].
    :param weights: of the samples of friction, shape (K,).
    :param is_localized: whether the robot is already localized for the first push.
    """
    table = primitives.table
    starts = _starts(table, obj, robot_radius)
    contacts = starts.contacts
    later = _effects(primitives.localized_displacements, weights, contacts)
    first = later if is_localized else _effects(primitives.unsure_displacements, weights, contacts)
    return Pushes(
        contacts.primitives, table.faces[contacts.primitives], contacts.starts, contacts.lengths,
        # In the order of FIRST and LATER.
        np.stack([first.means, later.means]), np.stack([first.stds, later.stds]),
        np.stack([first.last, later.last]),
        starts.coarse, starts.is_end, starts.middles, starts.normals)


def _effects(displacements: FloatArray, weights: FloatArray, contacts: _Contacts) -> _Effects:
    """Average displacements with errors of placement, shape (p, K, L, 3), by the weights."""
    count, lengths = len(contacts.primitives), len(contacts.lengths)
    effects = _Effects(np.zeros((count, lengths, 3)), np.zeros((count, lengths)),
                       np.zeros(count, dtype=np.int64))
    _average(displacements, weights, contacts, effects, np.empty((len(weights), 4)))
    return effects


# As many tables as a process has objects.
@functools.lru_cache(maxsize=8)
def _starts(table: PrimitiveTable, obj: PushedObject, robot_radius: float) -> _Starts:
    primitives = np.flatnonzero(table.curvatures == 0.0)
    point_indices = table.point_indices[primitives]
    angles = np.abs(table.approach_angles[primitives])
    coarse = np.where(table.is_curved[point_indices], np.isclose(angles, 0.0),
                      (angles <= MAX_APPROACH_ANGLE) & (point_indices % POINT_STRIDE == 0))
    is_end = np.asarray(np.isclose(table.lengths[:, None], END_LENGTHS).any(axis=1), dtype=bool)
    sides, middles, normals = [], [], []
    for face in range(table.face_count):
        own = [point for point in table.face_points if point.face == face]
        points = np.array([point.position for point in own])
        angle = own[len(own) // 2].normal
        normal = np.array([math.cos(angle), math.sin(angle)])
        if len({point.normal for point in own}) > 1:
            point = points[len(own) // 2]
            sides.append((*_circle_through(points), 0.0, math.inf))
        else:
            point, along = points.mean(axis=0), np.array([-normal[1], normal[0]])
            sides.append((*point, *along, _half_length(obj, point, along)))
        middles.append(point - robot_radius * normal)
        normals.append(normal)
    faces = table.faces[primitives]
    contacts = _Contacts(primitives, table.starts[primitives], table.lengths,
                         np.array(sides)[faces], _vertices(obj), robot_radius)
    return _Starts(contacts, coarse, is_end, np.array(middles), np.array(normals))


def _circle_through(points: FloatArray) -> tuple[float, float, float]:
    """Centre (x, y) and radius of the circle that lies nearest to points [m]."""
    # |p|^2 = 2 p.c + (r^2 - |c|^2) is linear in the unknowns.
    unknowns, *_ = np.linalg.lstsq(np.column_stack([2.0 * points, np.ones(len(points))]),
                                   (points ** 2).sum(axis=1), rcond=None)
    x, y, constant = unknowns.tolist()
    return x, y, math.sqrt(max(0.0, constant + x * x + y * y))


def _half_length(obj: PushedObject, middle: FloatArray, along: FloatArray) -> float:
    """Half the length of the face about a point [m]."""
    corners = np.array(obj.outline) - middle
    across = np.abs(corners[:, 0] * along[1] - corners[:, 1] * along[0])
    return float(np.abs(corners[np.argsort(across)[:2]] @ along).mean())


def _vertices(obj: PushedObject) -> FloatArray:
    if obj.outline:
        return np.array(obj.outline, dtype=float)
    return obj.radius * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])


@compiled
def _average(displacements: FloatArray, weights: FloatArray, contacts: _Contacts,
             effects: _Effects, motions: FloatArray) -> None:
    """
    Write means and standard deviations of displacements, and up to where the contacts hold.

    :param displacements: of the object, shape (p, K, L, 3).
    :param weights: of the samples of friction, shape (K,).
    :param effects: ``_Effects`` with zeros, is written.
    :param motions: scratch, shape (K, 4).
    """
    means, stds, last = effects
    lengths = contacts.lengths
    for i in range(last.shape[0]):
        last[i] = lengths.shape[0] - 1
        for step in range(lengths.shape[0]):
            for k in range(weights.shape[0]):
                x, y, theta = displacements[contacts.primitives[i], k, step]
                motions[k, 0], motions[k, 1] = x, y
                motions[k, 2], motions[k, 3] = math.cos(theta), math.sin(theta)
                means[i, step, 0] += weights[k] * x
                means[i, step, 1] += weights[k] * y
                means[i, step, 2] += weights[k] * theta
            stds[i, step] = _vertex_std(motions, weights, contacts.vertices)
            if last[i] >= step and not _holds(motions, weights, contacts, i, lengths[step]):
                last[i] = step - 1


@compiled
def _vertex_std(motions: Any, weights: Any, vertices: Any) -> float:
    """Compute the standard deviation of the vertex that varies most [m]."""
    worst = 0.0
    for n in range(vertices.shape[0]):
        x, y = vertices[n, 0], vertices[n, 1]
        mean_x, mean_y, square = 0.0, 0.0, 0.0
        for k in range(weights.shape[0]):
            c, s = motions[k, 2], motions[k, 3]
            d_x = motions[k, 0] + (c - 1.0) * x - s * y
            d_y = motions[k, 1] + s * x + (c - 1.0) * y
            mean_x += weights[k] * d_x
            mean_y += weights[k] * d_y
            square += weights[k] * (d_x * d_x + d_y * d_y)
        worst = max(worst, square - mean_x * mean_x - mean_y * mean_y)
    return math.sqrt(worst)


@compiled
def _holds(motions: Any, weights: Any, contacts: _Contacts, i: int, length: float) -> bool:
    """Tell whether the robot is still at the face after a length of a push, most probably."""
    start, side, robot_radius = contacts.starts[i], contacts.sides[i], contacts.robot_radius
    x = start[0] + length * math.cos(start[2])
    y = start[1] + length * math.sin(start[2])
    holding = 0.0
    for k in range(weights.shape[0]):
        c, s = motions[k, 2], motions[k, 3]
        d_x, d_y = x - motions[k, 0], y - motions[k, 1]
        p_x, p_y = c * d_x + s * d_y, c * d_y - s * d_x
        p_x, p_y = p_x - side[0], p_y - side[1]
        if side[4] > 1e6:
            along, gap = 0.0, math.sqrt(p_x * p_x + p_y * p_y) - side[2] - robot_radius
        else:
            along = abs(p_x * side[2] + p_y * side[3])
            # The inward normal is a quarter turn right of the direction along the face.
            gap = p_y * side[2] - p_x * side[3] - robot_radius
        if along <= side[4] - VERTEX_DISTANCE and gap <= LOST_GAP:
            holding += weights[k]
    return holding >= HOLDING_WEIGHT
