"""Shortest tracks among the obstacles of a map, the object included."""

import functools
import math
from typing import NamedTuple

import numpy as np
from push_navigation.path_ends import NoPathFound
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

NEIGHBOURS = ((1, 0), (0, 1), (1, 1), (1, -1))
SPACING = 0.08
LINKED = 2.0
BEYOND = 4.0


class Lattice(NamedTuple):
    """
    Places where the robot fits between the obstacles of a map, and straight pieces between them.

    :param points: (x, y) in the world, shape (n, 2) [m].
    :param edges: numbers of the points at both ends of each piece, shape (m, 2).
    :param spacing: distance between neighbours along a row [m].
    """

    points: np.ndarray
    edges: np.ndarray
    spacing: float


def grid_waypoints(occupancy_map, room, body, object_pose, start, goal):
    """
    Find the shortest track on a lattice, and pull it straight.

    It is looked for up to 4 m beyond start and goal.

    :param occupancy_map: ``OccupancyMap``.
    :param room: distance from obstacles that the robot's centre keeps [m].
    :param body: ``InflatedObstacle`` object that it keeps out of.
    :param object_pose: ``Pose`` of the object.
    :param start: (x, y) in the world [m].
    :param goal: the same.
    :return: list of (x, y, 0.0) behind the start.
    :raises NoWay: where there is none.
    """
    space = _Space(occupancy_map, room, body, object_pose)
    ends = np.array([start, goal], dtype=float)
    if space.sees(ends[0], ends[1:])[0]:
        return [(*goal, 0.0)]
    lattice = _lattice(occupancy_map, room, _window(occupancy_map, ends))
    links = [_links(space, lattice, number, place) for number, place in enumerate(ends)]
    points = np.concatenate([lattice.points, ends])
    edges = np.concatenate([lattice.edges[space.object_allows(lattice)], *links])
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    count = len(points)
    graph = csr_matrix((lengths, edges.T), shape=(count, count))
    away, before = dijkstra(graph, directed=False, indices=count - 2, return_predecessors=True)
    if not math.isfinite(away[count - 1]):
        raise NoPathFound('obstacles of the map, or the object between them, are in the way')
    path = [count - 1]
    while path[-1] != count - 2:
        path.append(before[path[-1]])
    corners = _straightened(space, points[path[::-1]], lattice.spacing)
    return [(float(x), float(y), 0.0) for x, y in corners[1:]]


class _Space:
    """Where the robot's centre may be."""

    def __init__(self, occupancy_map, room, body, object_pose):
        self._workspace, self._room, self._body = occupancy_map, room, body
        c, s = math.cos(object_pose.theta), math.sin(object_pose.theta)
        self._turn, self._shift = np.array([[c, -s], [s, c]]), np.array(object_pose[:2])

    def distances(self, points):
        """Distance of points from the grown object."""
        return self._body.distances((points - self._shift) @ self._turn)

    def sees(self, place, points):
        """Tell to which points the straight piece from a place is free."""
        samples = _between(place[None, :], points, self._workspace.resolution / 2)
        free = self._workspace.clearance(samples) >= self._room - 1e-9
        free[free] = self.distances(samples[free]) >= -1e-6
        return free.reshape(len(points), -1).all(axis=1)

    def object_allows(self, lattice):
        """Tell which pieces of a lattice keep out of the object."""
        away = self.distances(lattice.points)[lattice.edges]
        first, last = (lattice.points[lattice.edges[:, i]] for i in (0, 1))
        allowed = away.min(axis=1) >= 0.0
        lengths = np.linalg.norm(last - first, axis=1)
        unsure = np.flatnonzero(allowed & (away.sum(axis=1) < lengths))
        if unsure.size:
            samples = _between(first[unsure], last[unsure], lattice.spacing / 8)
            allowed[unsure] = self.distances(samples).reshape(unsure.size, -1).min(axis=1) >= 0.0
        return allowed


def _window(occupancy_map, ends):
    # In whole steps, so that ways near each other share their lattice.
    cells = occupancy_map.to_map(ends) / occupancy_map.resolution
    step = math.ceil(BEYOND / occupancy_map.resolution)
    low = (np.floor(cells.min(axis=0) / step).astype(int) - 1) * step
    high = (np.floor(cells.max(axis=0) / step).astype(int) + 2) * step
    return tuple(np.clip([low, high], 0, occupancy_map.occupied.shape[::-1]).ravel().tolist())


@functools.lru_cache(maxsize=4)
def _lattice(occupancy_map, room, window):
    cells = math.ceil(SPACING / occupancy_map.resolution - 1e-9)
    left, bottom, right, top = window
    ys, xs = np.mgrid[bottom:top:cells, left:right:cells]
    local = np.stack((xs, ys), axis=-1).reshape(-1, 2) + 0.5
    points = occupancy_map.from_map(occupancy_map.resolution * local)
    free = occupancy_map.clearance(points) >= room
    numbers = np.arange(len(points)).reshape(xs.shape)
    pairs = []
    for right, up in NEIGHBOURS:
        low = numbers[max(0, -up):numbers.shape[0] - max(0, up), :numbers.shape[1] - right]
        high = numbers[max(0, up):numbers.shape[0] + min(0, up), right:]
        pairs.append(np.stack((low.ravel(), high.ravel()), axis=1))
    edges = np.concatenate(pairs)
    edges = edges[free[edges].all(axis=1)]
    samples = _between(points[edges[:, 0]], points[edges[:, 1]], occupancy_map.resolution / 2)
    clear = occupancy_map.clearance(samples).reshape(len(edges), -1) >= room
    return Lattice(points, edges[clear.all(axis=1)], cells * occupancy_map.resolution)


def _between(first, last, spacing):
    longest = np.linalg.norm(last - first, axis=1).max(initial=0.0)
    shares = np.linspace(0.0, 1.0, 2 + math.floor(longest / spacing))
    return (first[:, None, :] + shares[:, None] * (last - first)[:, None, :]).reshape(-1, 2)


def _links(space, lattice, number, place):
    away = np.linalg.norm(lattice.points - place, axis=1)
    near = np.flatnonzero(away <= LINKED * lattice.spacing)
    seen = near[space.sees(place, lattice.points[near])]
    return np.stack((np.full_like(seen, len(lattice.points) + number), seen), axis=1)


def _straightened(space, path, spacing):
    # The second pass may cut the corners that the lattice made, at places between its points.
    for _ in range(2):
        fine = [_between(*np.array([[a], [b]]), spacing)[:-1] for a, b in zip(path, path[1:])]
        path = _shortcut(space, np.concatenate([*fine, path[-1:]]))
    return path


def _shortcut(space, path):
    kept, last = [path[0]], 0
    while last < len(path) - 1:
        seen = np.flatnonzero(space.sees(path[last], path[last + 1:]))
        last += 1 + (int(seen[-1]) if seen.size else 0)
        kept.append(path[last])
    return np.array(kept)
