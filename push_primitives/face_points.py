"""Points on the outline of an object where a push may begin."""

from collections.abc import Sequence
import itertools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import wrap_angle
from push_model.parameters import Outline, PushedObject

# Shortest face that is pushed at [m], chosen: the points below leave a third of it for errors of
# placement.
MIN_FACE_LENGTH = 0.15
# Distance of the outermost points from the vertices [m], chosen: about two deviations of where a
# localized robot touches.
VERTEX_DISTANCE = 0.015
# Points of a face and of a disc, chosen: 26 mm apart on a face of 0.4 m, which is less than the
# effect of a push changes noticeably over, and 7.5 degrees apart on a disc, which
# rolls off along the normal however it is pushed: at 15 degrees it gets stuck beside walls.
POINTS_PER_FACE = 15
POINTS_OF_DISC = 48
# A disc has no faces; these many sectors of it count as such.
DISC_SECTORS = 4
# Sharpest turn of an outline at a vertex of a curve [rad]; chosen: a regular polygon of twelve
# vertices has such ones, and rolls nearly like a disc.
SHARPEST_TURN = 0.53
# Part of the outline that a face takes that lies in a curve, at least; chosen: at most 12 faces.
CURVE_FACE_RATIO = 0.08
# Sectors of a curve that goes all round, and points of a sector; chosen: as on discs.
CURVE_SECTORS = DISC_SECTORS
POINTS_PER_SECTOR = POINTS_OF_DISC // DISC_SECTORS


class FacePoint(NamedTuple):
    """
    A point of the outline where a push may begin, in the object frame.

    :param face: index of the face among those that are pushed at, or of the sector of a disc or
        of a curve.
    :param position: (x, y) on the outline [m].
    :param normal: angle of the inward contact normal [rad].
    :param offset: distance along the face or the sector of a curve from its middle,
        counter-clockwise about the object [m]; on a disc the angle of the point times the radius.
    """

    face: int
    position: tuple[float, float]
    normal: float
    offset: float


class _Edge(NamedTuple):
    """
    An edge of an outline.

    :param start: (x, y) of its first vertex [m].
    :param along: unit vector to its second vertex.
    :param length: [m].
    """

    start: tuple[float, float]
    along: tuple[float, float]
    length: float

    @property
    def direction(self) -> float:
        """Angle [rad]."""
        return math.atan2(self.along[1], self.along[0])

    def point(self, face: int, distance: float, offset: float) -> FacePoint:
        """
        Make a point.

        :param face: its index.
        :param distance: from the first vertex [m].
        :param offset: of the point [m].
        """
        position = (self.start[0] + distance * self.along[0],
                    self.start[1] + distance * self.along[1])
        return FacePoint(face, position, math.atan2(self.along[0], -self.along[1]), offset)


def face_points(obj: PushedObject) -> tuple[FacePoint, ...]:
    """
    List the points where a push may begin, face by face, counter-clockwise.

    Short edges that turn but little from one to the next make a curve, whose sectors count as
    faces. So does the whole outline where all faces are short. Outlines of more than some dozen
    vertices should be simplified before.

    :return: ``FacePoint`` of every face or curve of at least 0.15 m, or round a disc.
    :raises ValueError: where the outline is shorter.
    """
    if obj.radius > 0.0:
        return tuple(_point_on_disc(obj.radius, index) for index in range(POINTS_OF_DISC))
    points: list[FacePoint] = []
    edges = _edges(obj.outline)
    for piece in _pieces(edges):
        if sum(edge.length for edge in piece) >= MIN_FACE_LENGTH:
            face = points[-1].face + 1 if points else 0
            points += (_points_on_face(piece[0], face) if len(piece) == 1
                       else _points_on_curve(piece, face, len(piece) == len(edges)))
    if not points:
        around = sum(edge.length for edge in edges)
        if around < MIN_FACE_LENGTH:
            raise ValueError(f'PushedObject.outline: got {around:g} m all round, expected at '
                             f'least {MIN_FACE_LENGTH:g} m')
        points += _points_on_curve(edges, 0, True)
    return tuple(points)


def _edges(outline: Outline) -> list[_Edge]:
    edges: list[_Edge] = []
    for start, (x, y) in zip(outline, (*outline[1:], outline[0])):
        length = math.hypot(x - start[0], y - start[1])
        edges.append(_Edge(start, ((x - start[0]) / length, (y - start[1]) / length), length))
    return edges


def _pieces(edges: Sequence[_Edge]) -> list[list[_Edge]]:
    """Split an outline into faces of one edge and curves of more."""
    around = sum(edge.length for edge in edges)
    # Whether a curve may go on from the edge before.
    is_smooth = [_turn(edges[i - 1], edge) <= SHARPEST_TURN for i, edge in enumerate(edges)]
    is_face = [edge.length >= MIN_FACE_LENGTH and (
        not (is_smooth[i] and is_smooth[(i + 1) % len(edges)])
        or edge.length >= CURVE_FACE_RATIO * around) for i, edge in enumerate(edges)]
    starts = [i for i in range(len(edges)) if not is_smooth[i] or is_face[i] or is_face[i - 1]]
    if not starts:
        return [list(edges)]
    return [[edges[i % len(edges)] for i in range(first, last)]
            for first, last in itertools.pairwise([*starts, starts[0] + len(edges)])]


def _turn(before: _Edge, edge: _Edge) -> float:
    return wrap_angle(edge.direction - before.direction)


def _points_on_face(edge: _Edge, face: int) -> list[FacePoint]:
    half = 0.5 * edge.length - VERTEX_DISTANCE
    return [edge.point(face, 0.5 * edge.length + offset, offset)
            for offset in np.linspace(-half, half, POINTS_PER_FACE).tolist()]


def _points_on_curve(edges: Sequence[_Edge], first_face: int,
                     is_closed: bool) -> list[FacePoint]:
    ends = [0.0, *itertools.accumulate(edge.length for edge in edges)]
    rotation = sum(itertools.starmap(_turn, itertools.pairwise(edges)))
    start, end = (0.0, ends[-1]) if is_closed else (VERTEX_DISTANCE, ends[-1] - VERTEX_DISTANCE)
    count = max(1, min(round(CURVE_SECTORS * rotation / (2.0 * math.pi)),
                       int(ends[-1] / MIN_FACE_LENGTH)))
    length = (end - start) / count
    points: list[FacePoint] = []
    for sector in range(count):
        for index in range(POINTS_PER_SECTOR):
            offset = length * ((index + 0.5) / POINTS_PER_SECTOR - 0.5)
            along = start + (sector + 0.5) * length + offset
            edge = max(i for i in range(len(edges)) if ends[i] <= along)
            points.append(edges[edge].point(first_face + sector, along - ends[edge], offset))
    return points


def _point_on_disc(radius: float, index: int) -> FacePoint:
    angle = 2.0 * math.pi * index / POINTS_OF_DISC
    position = (radius * math.cos(angle), radius * math.sin(angle))
    return FacePoint(index * DISC_SECTORS // POINTS_OF_DISC, position,
                     math.remainder(angle + math.pi, 2.0 * math.pi), angle * radius)
