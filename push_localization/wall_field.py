"""
Walls of a map as a signed distance, with its gradient.

With the distance of a cell's centre from the nearest occupied centre outside walls, and from the
nearest free one inside, less half a cell each, the field s is 0 on the faces between occupied and
free cells: interpolated linearly it is exact beside a straight face, and smooth through it. Walls
of maps are mostly thinner than their cells, so that their surface lies a part of a cell deeper.

A scan ends at few places of a large map. So distances are computed tile by tile, where they are
asked for first; within the greatest distance of a tile nothing else matters to them.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from push_model.geometry import BoolArray, Coordinates, FloatArray, Pose

# Greatest distance that the field tells [m]; chosen: farther walls say nothing to a match.
MAX_DISTANCE = 1.0
# Side of a tile, over the margin of cells that its distances depend on; chosen: about half of what
# is computed is kept.
TILE_MARGINS = 4


class FieldSample(NamedTuple):
    """
    Signed distances of points from walls.

    :param distances: positive in the open, shape (n,) [m].
    :param gradients: along the axes of the world, shape (n, 2).
    """

    distances: FloatArray
    gradients: FloatArray


class WallField:
    """
    Signed distance from the walls of a map.

    ``resolution``: side of a cell [m]. ``origin``: ``Pose`` of the outer corner of the first cell.
    """

    def __init__(self, resolution: float, origin: Coordinates, walls: ArrayLike,
                 offset: float = 0.0) -> None:
        """
        Take the walls.

        :param resolution: side of a cell [m].
        :param origin: ``Pose`` in the world of the outer corner of the first cell.
        :param walls: whether each cell is occupied, unknown ones are not, shape (rows, columns).
        :param offset: depth of walls behind the faces of their cells, in cells.
        """
        self.resolution = resolution
        self._offset = offset
        self._origin = Pose(*origin)
        # Beyond the border of the map there is nothing, as far as the field tells.
        self._margin = math.ceil(MAX_DISTANCE / resolution) + 2
        self._walls = np.pad(np.asarray(walls, dtype=bool), self._margin)
        self._tile = TILE_MARGINS * self._margin
        rows, columns = self._walls.shape
        # Memory of tiles that nobody asks for is never touched.
        self._distances: NDArray[np.float32] = np.empty((rows, columns), dtype=np.float32)
        self._is_computed = np.zeros((rows // self._tile + 1, columns // self._tile + 1),
                                     dtype=bool)
        c, s = math.cos(self._origin.theta), math.sin(self._origin.theta)
        self._rotation = np.array([[c, -s], [s, c]])

    @property
    def origin(self) -> Pose:
        """``Pose`` in the world of the outer corner of the first cell."""
        return self._origin

    def moved(self, origin: Coordinates) -> 'WallField':
        """
        Return the same walls with another origin.

        :param origin: ``Pose`` in the world of the outer corner of the first cell.
        """
        result = object.__new__(WallField)
        result.__dict__.update(self.__dict__)
        result._origin = Pose(*origin)
        c, s = math.cos(result._origin.theta), math.sin(result._origin.theta)
        result._rotation = np.array([[c, -s], [s, c]])
        return result

    def sample(self, points: FloatArray) -> FieldSample:
        """
        Interpolate distances and gradients, linearly between the centres of cells.

        :param points: (x, y) in the world, shape (n, 2) [m].
        """
        u, v = self._cells(points).T
        field = self._distances
        column = np.clip(np.floor(u).astype(np.int64), 0, field.shape[1] - 2)
        row = np.clip(np.floor(v).astype(np.int64), 0, field.shape[0] - 2)
        self._compute_at(row, column)
        a, b = np.clip(u - column, 0.0, 1.0), np.clip(v - row, 0.0, 1.0)
        low, high = field[row, column], field[row, column + 1]
        low_up, high_up = field[row + 1, column], field[row + 1, column + 1]
        below, above = low + a * (high - low), low_up + a * (high_up - low_up)
        slopes = np.stack(((1.0 - b) * (high - low) + b * (high_up - low_up), above - below))
        return FieldSample(below + b * (above - below),
                           (self._rotation @ slopes).T / self.resolution)

    def nearest_distances(self, points: FloatArray) -> NDArray[np.float32]:
        """
        Look up the distances of the cells that points are in.

        :param points: (x, y) in the world, shape (..., 2) [m].
        :return: shape (...) [m].
        """
        field = self._distances
        cells = np.rint(self._cells(points)).astype(np.int64)
        column = np.clip(cells[..., 0], 0, field.shape[1] - 1)
        row = np.clip(cells[..., 1], 0, field.shape[0] - 1)
        self._compute_at(row, column)
        return field[row, column]

    def _cells(self, points: FloatArray) -> FloatArray:
        """Return columns and rows of points in the field, whole ones at centres of cells."""
        in_map = (points - self._origin[:2]) @ self._rotation
        return in_map / self.resolution + (self._margin - 0.5)

    def _compute_at(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> None:
        """Compute the tiles that cells are in, with the next cell in each direction."""
        tile_row, tile_column = row // self._tile, column // self._tile
        is_missing = ~self._is_computed[tile_row, tile_column]
        if is_missing.any():
            missing = np.stack((tile_row[is_missing], tile_column[is_missing]), axis=1)
            for first, second in np.unique(missing, axis=0).tolist():
                self._compute_tile(first, second)

    def _compute_tile(self, tile_row: int, tile_column: int) -> None:
        margin = self._margin
        low, left = self._tile * tile_row, self._tile * tile_column
        # Interpolation between the last centre of a tile and the next one needs both.
        kept = self._distances[low:low + self._tile + 1, left:left + self._tile + 1]
        first_row, first_column = max(low - margin, 0), max(left - margin, 0)
        window = self._walls[first_row:low + self._tile + 1 + margin,
                             first_column:left + self._tile + 1 + margin]
        distances = _signed_distances(window, self.resolution, self._offset)
        row, column = low - first_row, left - first_column
        kept[:] = distances[row:row + kept.shape[0], column:column + kept.shape[1]]
        self._is_computed[tile_row, tile_column] = True


def _signed_distances(cells: BoolArray, resolution: float, offset: float) -> NDArray[np.float32]:
    from scipy.ndimage import distance_transform_edt
    if not cells.any():
        return np.full(cells.shape, MAX_DISTANCE, dtype=np.float32)
    if cells.all():
        return np.full(cells.shape, -MAX_DISTANCE, dtype=np.float32)
    outside = np.asarray(distance_transform_edt(~cells), dtype=np.float32)
    inside = np.asarray(distance_transform_edt(cells), dtype=np.float32)
    faces = np.where(cells, 0.5 - inside, outside - 0.5)
    distances = np.float32(resolution) * (faces + np.float32(offset))
    return np.clip(distances, -MAX_DISTANCE, MAX_DISTANCE).astype(np.float32)
