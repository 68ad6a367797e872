"""
Objects that stand and are bumped: they give way to what moves into them.

They slide on the floor as slowly as they are pushed, so that force and motion lie on a limit
surface, here an ellipsoid. Their contact is without friction and resists nothing. Walls hold them.
"""

import functools
import math
from typing import Any, NamedTuple

from push_dynamics.wall_grid import WallGrid, walls_near
from push_dynamics.walls import wall_gap
from push_model.contact import contact_point, face_normal, find_contact
from push_model.friction import ellipsoid_c_squared, friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject


# Overlap that is none, rounding [m]; and contacts that push an object in one step, chosen: both
# corners of a face, twice.
TOUCHING, MAX_CONTACTS = 1e-6, 4
# Overlap beyond which a body moves through an object that walls hold, and depth in a wall beyond
# which a point is not in it [m]; chosen: above what a body covers in one step, and twice that.
MAX_OVERLAP, MAX_WALL_DEPTH = 0.05, 0.1


class PlacedObject(NamedTuple):
    """
    An object and where it is.

    :param obj: the true ``PushedObject``.
    :param pose: its ``Pose`` in the world.
    """

    obj: PushedObject
    pose: Pose


class PlacedDisc(NamedTuple):
    """
    A disc and where it is, such as the robot.

    :param x: of its middle in the world [m].
    :param y: of its middle in the world [m].
    :param radius: [m].
    """

    x: float
    y: float
    radius: float


class _Overlap(NamedTuple):
    """
    Overlap of a body with an object.

    :param depth: [m], negative where they are apart.
    :param point: of the object in the world [m].
    :param direction: in which the object gets out of it [rad].
    """

    depth: float
    point: tuple[float, float]
    direction: float


_NO_OVERLAP = _Overlap(0.0, (0.0, 0.0), 0.0)


def displaced_pose(item: PlacedObject, body: PlacedObject | PlacedDisc) -> Pose:
    """
    Find where an object is once it has given way to a body that overlaps it a little.

    A contact force along the normal n at p moves it by the twist s (n, (p x n) / c^2) about its
    centre of friction, with the c^2 of the ellipsoid (Howe and Cutkosky 1996), until they touch
    there; then the next corner counts.

    :param item: the ``PlacedObject``.
    :param body: what has moved into it.
    :return: its ``Pose``; the same where they do not overlap, or by ``MAX_OVERLAP``.
    """
    for _ in range(MAX_CONTACTS):
        if _is_far(item, body):
            break
        overlap = _overlap(item, body)
        if not TOUCHING < overlap.depth < MAX_OVERLAP:
            break
        item = item._replace(pose=_moved_out(item, overlap))
    return item.pose


def do_overlap(item: PlacedObject, body: PlacedObject | PlacedDisc) -> bool:
    """Tell whether an object and a body overlap, however deep."""
    return not _is_far(item, body) and _overlap(item, body).depth > TOUCHING


def held_pose(item: PlacedObject, walls: WallGrid) -> Pose:
    """
    Find where an object is once walls have moved it out of them, as other bodies do.

    :param item: the ``PlacedObject``, a little inside walls.
    :param walls: those within ``outer_radius`` of its middle are looked at.
    :return: its ``Pose``; the same where it is in none.
    """
    first, last = walls_near(walls, *item.pose[:2])
    rows = [walls.rows[row] for row in walls.near[first:last]]
    for _ in range(MAX_CONTACTS):
        overlap = max((_with_wall(item, row) for row in rows), default=_NO_OVERLAP,
                      key=lambda overlap: overlap.depth)
        if overlap.depth <= TOUCHING:
            break
        item = item._replace(pose=_moved_out(item, overlap))
    return item.pose


def _with_wall(item: PlacedObject, wall: Any) -> _Overlap:
    """
    Find how deep an object is in a wall, or in a corner of one.

    :param wall: a row of ``wall_rows``.
    """
    if wall[4] == 0.0:
        overlap = _with_disc(item, PlacedDisc(wall[0], wall[1], 0.0))
        return overlap if overlap.depth < MAX_WALL_DEPTH else _NO_OVERLAP
    points = [item.pose.transform(corner) for corner in item.obj.outline or ((0.0, 0.0),)]
    radius = 0.0 if item.obj.outline else item.obj.radius
    overlap = _NO_OVERLAP
    for x, y in points:
        n_x, n_y, distance = wall_gap(wall, x, y, item.pose.x, item.pose.y)
        if overlap.depth < radius - distance < MAX_WALL_DEPTH:
            overlap = _Overlap(radius - distance, (x - radius * n_x, y - radius * n_y),
                               math.atan2(n_y, n_x))
    return overlap


def _moved_out(item: PlacedObject, overlap: _Overlap) -> Pose:
    """Move an object out of an overlap at one point."""
    n_x, n_y = math.cos(overlap.direction), math.sin(overlap.direction)
    x, y = item.pose.transform(friction_center(item.obj))
    lever = (overlap.point[0] - x) * n_y - (overlap.point[1] - y) * n_x
    c_squared = ellipsoid_c_squared(item.obj)
    scale = overlap.depth / (c_squared + lever * lever)
    moved = Pose(x + scale * c_squared * n_x, y + scale * c_squared * n_y, scale * lever)
    return moved @ Pose(-x, -y, 0.0) @ item.pose


def _is_far(item: PlacedObject, body: PlacedObject | PlacedDisc) -> bool:
    """Tell whether the discs about both do not meet."""
    if isinstance(body, PlacedDisc):
        middle, radius = (body.x, body.y), body.radius
    else:
        middle, radius = body.pose[:2], outer_radius(body.obj)
    return math.dist(item.pose[:2], middle) > outer_radius(item.obj) + radius


@functools.lru_cache(maxsize=64)
def outer_radius(obj: PushedObject) -> float:
    """Return the radius of the least disc about the frame of an object that contains it [m]."""
    return max((math.hypot(*corner) for corner in obj.outline), default=obj.radius)


def _overlap(item: PlacedObject, body: PlacedObject | PlacedDisc) -> _Overlap:
    """Find the shortest way of an object out of a body."""
    if isinstance(body, PlacedDisc):
        return _with_disc(item, body)
    if not body.obj.outline:
        return _with_disc(item, PlacedDisc(body.pose.x, body.pose.y, body.obj.radius))
    if not item.obj.outline:
        overlap = _with_disc(body, PlacedDisc(item.pose.x, item.pose.y, item.obj.radius))
        return overlap._replace(direction=overlap.direction + math.pi)
    through_body = _through_face(body, item)
    through_body = through_body._replace(direction=through_body.direction + math.pi)
    return min(_through_face(item, body), through_body, key=lambda overlap: overlap.depth)


def _with_disc(item: PlacedObject, disc: PlacedDisc) -> _Overlap:
    """Find how deep a disc is in an object."""
    contact = find_contact(item.obj, item.pose, (disc.x, disc.y), disc.radius)
    point = item.pose.transform(contact_point(item.obj, contact.contact))
    return _Overlap(-contact.gap, (float(point[0]), float(point[1])), contact.gamma)


def _through_face(item: PlacedObject, body: PlacedObject) -> _Overlap:
    """Find the face of an object through which a corner of another is least deep in it."""
    outline, to_item = item.obj.outline, item.pose.inverse() @ body.pose
    corners = [to_item.transform(corner) for corner in body.obj.outline]
    overlaps: list[_Overlap] = []
    for face, (x, y) in enumerate(outline):
        normal = face_normal(item.obj, face)
        c, s = math.cos(normal), math.sin(normal)
        depth, corner = max((c * (u - x) + s * (v - y), (u, v)) for u, v in corners)
        point = item.pose.transform(corner)
        overlaps.append(_Overlap(depth, (float(point[0]), float(point[1])),
                                 item.pose.theta + normal))
    return min(overlaps, key=lambda overlap: overlap.depth)
