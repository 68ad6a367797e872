"""
Grid planner: routes among the obstacles of a map, the object included, that keep off both.

A grid graph links neighbouring points where the robot fits; Dijkstra's algorithm finds the
shortest route on it, on which lengths near obstacles count more, so that it keeps to the middle
of passages. Shortcuts between points that see each other pull it straight, as long as they come no
nearer to obstacles.
"""

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from push_model.geometry import BoolArray, Coordinates, FloatArray, IntArray, Pose
from push_navigation.map_clearance import MapClearance
from push_navigation.obstacle import InflatedObstacle
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, PathFailure, Waypoint
from push_navigation.visibility import last_seen, make_visibility, see_points

# Steps to the right and up to half of the neighbours of a grid point; the others link to it.
NEIGHBOURS = ((1, 0), (0, 1), (1, 1), (1, -1))
# Distance between neighbours, at least [m]. Chosen: half a robot radius, so that doors are found,
# and few enough points for a room in some milliseconds.
SPACING = 0.08
# Start and goal are linked to the grid points within this distance, in spacings. Chosen: twelve
# points or so, of which some are free.
LINK_RANGE = 2.0
# Start and goal are surrounded by at least this much of the map [m], the second where nothing is
# found in the first. Chosen: the width of a room; and as far as the search for pushes looks.
WINDOW_MARGINS = 4.0, 10.0
# Gap of the robot from obstacles from which on it is no concern [m], and by which part a length
# counts more where there is none; chosen: a detour of a decimetre at a door is worth 5 cm of gap.
COMFORTABLE_GAP = 0.15
NEARNESS_COST = 1.0
# The gap of a robot that may drift off its route, with the same cost for each length that it lacks
# [m]; chosen: half the width of a corridor.
DRIFTING_GAP = 0.6
# Gap that a shortcut may lose [m]; chosen: below a cell, so that routes get straight.
SHORTCUT_LOSS = 0.02


class GridGraph(NamedTuple):
    """
    Points where the robot fits between the obstacles of a map, and free edges between them.

    :param points: (x, y) in the world, shape (n, 2) [m].
    :param edges: numbers of the points at both ends of each edge, shape (m, 2).
    :param clearances: least distance from obstacles on each edge, shape (m,) [m].
    :param spacing: distance between neighbours along a row [m].
    """

    points: FloatArray
    edges: IntArray
    clearances: FloatArray
    spacing: float


def grid_waypoints(margins: MapClearance, body: InflatedObstacle, object_pose: Pose,
                   start: Coordinates, goal: Coordinates) -> list[Waypoint]:
    """
    Find the best route on a grid, and pull it straight.

    It is searched up to ``WINDOW_MARGINS`` beyond start and goal.

    :param margins: ``MapClearance`` of the path.
    :param body: ``InflatedObstacle`` that the robot's centre keeps out of.
    :param start: (x, y) in the world [m].
    :param goal: (x, y) in the world [m].
    :return: list of ``Waypoint`` behind the start, with straight segments.
    :raises NoPathFound: where there is none.
    """
    space = _FreeSpace(margins, body, object_pose)
    ends = np.array([start, goal], dtype=float)
    if space.sees(ends[0], ends[1:], margins.radius + _comfortable_gap(margins))[0]:
        return [Waypoint(*goal)]
    windows = dict.fromkeys(_window(margins.context.occupancy_map, ends, margin)
                            for margin in WINDOW_MARGINS)
    for window in windows:
        tree = _route_tree(margins, body, object_pose, (float(start[0]), float(start[1])), window)
        corners = _route_to(space, tree, *ends)
        if corners is not None:
            return [Waypoint(float(x), float(y)) for x, y in corners[1:]]
    raise NoPathFound(PathFailure.NO_ROUTE.report())


class _RouteTree(NamedTuple):
    """
    Best routes from one start to all grid points of a window.

    :param points: (x, y) in the world, shape (n, 2) [m].
    :param spacing: distance between neighbours along a row [m].
    :param costs: of the route to each point, shape (n,) [m]; infinite where none leads there.
    :param before: number of the point before each, negative where that is the start.
    """

    points: FloatArray
    spacing: float
    costs: FloatArray
    before: IntArray


# The paths to all first pushes of a plan start alike, with three clearances in two windows, and
# whether drift counts or not; a tree of a flat takes a megabyte.
@functools.lru_cache(maxsize=16)
def _route_tree(margins: MapClearance, body: InflatedObstacle, object_pose: Pose,
                start: tuple[float, float], window: tuple[int, int, int, int]) -> _RouteTree:
    # Imported here: without a map nothing of scipy is needed.
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra
    space, end = _FreeSpace(margins, body, object_pose), np.array(start)
    grid = grid_graph(margins.context.occupancy_map, margins.radius + margins.margin, window)
    free = space.keeps_off_object(grid) & (
        grid.clearances >= margins.required(grid.points)[grid.edges].max(axis=1))
    edges, count = grid.edges[free], len(grid.points)
    lengths = np.linalg.norm(grid.points[edges[:, 0]] - grid.points[edges[:, 1]], axis=1)
    seen, link_costs = _links(space, grid.points, grid.spacing, end)
    # The start is one point more.
    ends = np.concatenate([edges, np.stack((np.full_like(seen, count), seen), axis=1)])
    costs = np.concatenate([space.costs(lengths, grid.clearances[free]), link_costs])
    graph = csr_matrix((costs, ends.T), shape=(count + 1, count + 1))
    away, before = dijkstra(graph, directed=False, indices=count, return_predecessors=True)
    before[before == count] = -1
    return _RouteTree(grid.points, grid.spacing, away[:count], before[:count])


def _route_to(space: '_FreeSpace', tree: _RouteTree, start: FloatArray,
              goal: FloatArray) -> FloatArray | None:
    """Find the corners of the best route to a goal; None where there is none in the window."""
    seen, link_costs = _links(space, tree.points, tree.spacing, goal)
    costs = tree.costs[seen] + link_costs
    if not math.isfinite(costs.min(initial=math.inf)):
        return None
    route = [int(seen[np.argmin(costs)])]
    while tree.before[route[-1]] >= 0:
        route.append(int(tree.before[route[-1]]))
    points = np.concatenate([[start], tree.points[route[::-1]], [goal]])
    return _straightened(space, points, tree.spacing)


def _comfortable_gap(margins: MapClearance) -> float:
    return COMFORTABLE_GAP if margins.counts_drift else DRIFTING_GAP


class _FreeSpace:
    """Points where the robot's centre may be."""

    def __init__(self, margins: MapClearance, body: InflatedObstacle, object_pose: Pose) -> None:
        self._margins = margins
        self._map = margins.context.occupancy_map
        self._visibility = make_visibility(margins, body, object_pose)
        self._body = body
        c, s = math.cos(object_pose.theta), math.sin(object_pose.theta)
        self._object_rotation = np.array([[c, -s], [s, c]])
        self._object_position = np.array(object_pose[:2])

    def distances(self, points: FloatArray) -> FloatArray:
        """Distance of points from the inflated object."""
        return self._body.distances((points - self._object_position) @ self._object_rotation)

    def clearance(self, points: FloatArray) -> FloatArray:
        """Distance of points from obstacles."""
        return self._map.clearance(points)

    def gap_distances(self, points: FloatArray) -> FloatArray:
        """Distance of points from obstacles, as far as that is of concern."""
        gap = _comfortable_gap(self._margins)
        return np.minimum(self._map.clearance(points), self._margins.radius + gap)

    def costs(self, lengths: FloatArray, clearances: FloatArray) -> FloatArray:
        """
        Compute what edges cost, so that routes keep to the middle of passages [m].

        :param lengths: of the edges, shape (n,) [m].
        :param clearances: least distance from obstacles on each, shape (n,) [m].
        """
        gap = _comfortable_gap(self._margins)
        shortfalls = np.clip(1.0 - (clearances - self._margins.radius) / gap, 0.0, 1.0)
        # Rounded, so that ties do not depend on how the map lies in the world.
        nearness = NEARNESS_COST * gap / COMFORTABLE_GAP
        return np.round(lengths * (1.0 + nearness * shortfalls), 6)

    def sees(self, point: FloatArray, points: FloatArray, least: float = 0.0) -> BoolArray:
        """Tell to which points the straight line from a point is free, with a clearance [m]."""
        return see_points(self._visibility, self._map.to_map([point])[0], self._map.to_map(points),
                          np.full(len(points), least), self._map.resolution / 2)

    def last_seen(self, point: FloatArray, points: FloatArray, clearances: FloatArray) -> int:
        """Find the last point to which the line is free, with such clearances, -1 for none."""
        return last_seen(self._visibility, self._map.to_map([point])[0], self._map.to_map(points),
                         clearances, self._map.resolution / 2)

    def keeps_off_object(self, grid: GridGraph) -> BoolArray:
        """Tell which edges of a grid keep out of the inflated object."""
        away = self.distances(grid.points)[grid.edges]
        first, last = (grid.points[grid.edges[:, i]] for i in (0, 1))
        free = away.min(axis=1) >= 0.0
        lengths = np.linalg.norm(last - first, axis=1)
        # An edge shorter than its ends are away, together, cannot reach the object.
        unsure = np.flatnonzero(free & (away.sum(axis=1) < lengths))
        if unsure.size:
            samples = _between(first[unsure], last[unsure], grid.spacing / 8)
            free[unsure] = self.distances(samples).reshape(unsure.size, -1).min(axis=1) >= 0.0
        return free


def _window(occupancy_map: OccupancyMap, ends: FloatArray,
            margin: float) -> tuple[int, int, int, int]:
    """Cells (left, bottom, right, top) of the map to search."""
    # In whole steps, so that paths near each other share their grid graph.
    cells = occupancy_map.to_map(ends) / occupancy_map.resolution
    step = math.ceil(margin / occupancy_map.resolution)
    low = (np.floor(cells.min(axis=0) / step).astype(int) - 1) * step
    high = (np.floor(cells.max(axis=0) / step).astype(int) + 2) * step
    left, bottom, right, top = np.clip(
        [low, high], 0, occupancy_map.occupied.shape[::-1]).ravel().tolist()
    return left, bottom, right, top


# One task asks for the same few windows over and over; a graph of a room takes a few MB.
@functools.lru_cache(maxsize=4)
def grid_graph(occupancy_map: OccupancyMap, clearance: float,
               window: tuple[int, int, int, int]) -> GridGraph:
    """
    Link the points of a window between which the robot fits.

    :param clearance: of its centre from obstacles, at least [m].
    :param window: cells (left, bottom, right, top) of the map, without the last.
    """
    cells = math.ceil(SPACING / occupancy_map.resolution - 1e-9)
    left, bottom, right, top = window
    ys, xs = np.mgrid[bottom:top:cells, left:right:cells]
    cell_centers = np.stack((xs, ys), axis=-1).reshape(-1, 2) + 0.5
    points = occupancy_map.from_map(occupancy_map.resolution * cell_centers)
    indices = np.arange(len(points)).reshape(xs.shape)
    # The map has a border of one cell.
    distances = occupancy_map.distances[bottom + 1:top + 1, left + 1:right + 1]
    pairs: list[IntArray] = []
    clearances: list[FloatArray] = []
    for columns, rows in NEIGHBOURS:
        low = indices[max(0, -rows):indices.shape[0] - max(0, rows), :indices.shape[1] - columns]
        high = indices[max(0, rows):indices.shape[0] + min(0, rows), columns:]
        least = _least_on_edges(distances, low.shape, (columns, rows), cells)
        clear = least >= clearance
        pairs.append(np.stack((low[clear], high[clear]), axis=1))
        clearances.append(least[clear])
    return GridGraph(points, np.concatenate(pairs), np.concatenate(clearances),
                     cells * occupancy_map.resolution)


def _least_on_edges(distances: NDArray[np.float32], shape: tuple[int, ...],
                    direction: tuple[int, int], cells: int) -> FloatArray:
    """
    Find the least distance from obstacles on edges that lead from grid points in one direction.

    Along rows and columns it is that of a cell, as between their centres distances are
    interpolated; along diagonals they are looked at in the middle between centres, too.

    :param distances: of the centres of the cells in the window, shape (h, w) [m].
    :param shape: number of edges along columns and rows.
    :param direction: columns and rows to the neighbour, one of ``NEIGHBOURS``.
    :param cells: between neighbours.
    :return: of that shape [m].
    """
    columns, rows = direction
    first_row = cells if rows < 0 else 0

    def shifted(right: int, up: int) -> NDArray[np.float32]:
        return distances[first_row + up::cells, right::cells][:shape[0], :shape[1]]

    least = shifted(0, 0)
    for step in range(1, cells + 1):
        before, there = (step - 1) * columns, (step - 1) * rows
        if columns and rows:
            corners = [shifted(before + i, there + j * rows) for i in (0, 1) for j in (0, 1)]
            least = np.minimum(least, 0.25 * np.sum(corners, axis=0))
        least = np.minimum(least, shifted(step * columns, step * rows))
    return least.astype(float)


def _between(first: FloatArray, last: FloatArray, spacing: float) -> FloatArray:
    """
    Sample straight lines, all with as many samples as the longest needs.

    :param first: begin of each line, shape (n, 2), or (1, 2) for one that all have in common [m].
    :param last: end of each line, shape (n, 2) [m].
    :param spacing: largest distance between samples [m].
    :return: samples line by line, shape (n * k, 2) [m].
    """
    longest = np.linalg.norm(last - first, axis=1).max(initial=0.0)
    fractions = np.linspace(0.0, 1.0, 2 + math.floor(longest / spacing), dtype=np.float64)
    lines = first[:, None, :] + fractions[:, None] * (last - first)[:, None, :]
    return lines.reshape(-1, 2)


def _links(space: _FreeSpace, points: FloatArray, spacing: float,
           end: FloatArray) -> tuple[IntArray, FloatArray]:
    """Numbers of the grid points that a place sees, and what the ways to them cost [m]."""
    away = np.linalg.norm(points - end, axis=1)
    near = np.flatnonzero(away <= LINK_RANGE * spacing)
    seen = near[space.sees(end, points[near])]
    return seen, space.costs(away[seen], space.clearance(points[seen]))


def _straightened(space: _FreeSpace, corners: FloatArray, spacing: float) -> FloatArray:
    # The second pass may cut the corners that the grid made, at places between its points.
    for _ in range(2):
        fine = [_between(first[None, :], last[None, :], spacing)[:-1]
                for first, last in zip(corners, corners[1:])]
        corners = _shortcut(space, np.concatenate([*fine, corners[-1:]]))
    return corners


def _shortcut(space: _FreeSpace, points: FloatArray) -> FloatArray:
    """Go on from each point to the last that it sees, without coming nearer to obstacles."""
    margins, last = [points[0]], 0
    gaps = space.gap_distances(points)
    while last < len(points) - 1:
        # Between points of the route it may be a little nearer than at them.
        least = np.minimum.accumulate(gaps[last:])[1:] - SHORTCUT_LOSS
        last += 1 + max(0, space.last_seen(points[last], points[last + 1:], least))
        margins.append(points[last])
    return np.array(margins)
