"""Walls that are drawn on open floor or on a map."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import Coordinates
from push_navigation.occupancy_map import OccupancyMap
from push_view.server.commands import CommandRefused

# Side of a cell of the map on which walls are drawn, and thickness of a wall [m]; chosen: as fine
# as maps of robots.
RESOLUTION = 0.05
THICKNESS = 0.1
# Half the side of the floor round the object that such a map covers [m]; all outside it is
# occupied.
HALF_SIDE = 5.0


class Wall(NamedTuple):
    """
    A straight wall.

    :param start: one end (x, y) [m].
    :param end: the other end (x, y) [m].
    """

    start: tuple[float, float]
    end: tuple[float, float]


@dataclasses.dataclass(frozen=True, eq=False)
class Drawing:
    """
    What has been drawn, and what was there before.

    :param background: map on which it is drawn; None for open floor.
    :param center: middle (x, y) of the floor on which it is drawn, where there is no map [m].
    :param walls: in the order in which they were drawn.
    :param previous: the drawing before the last change; None where there was none.
    """

    background: OccupancyMap | None
    center: tuple[float, float] = (0.0, 0.0)
    walls: tuple[Wall, ...] = ()
    previous: Drawing | None = None

    @functools.cached_property
    def occupancy_map(self) -> OccupancyMap | None:
        """The ``OccupancyMap`` with all walls; None for open floor."""
        if not self.walls:
            return self.background
        drawn = open_floor(self.center) if self.background is None else self.background
        for wall in self.walls:
            drawn = with_wall(drawn, *wall)
        return drawn

    def add(self, wall: Wall) -> Drawing:
        """Draw another wall."""
        return self._changed((*self.walls, wall))

    def remove(self, index: int) -> Drawing:
        """
        Remove one wall.

        :param index: of the wall.
        :raises CommandRefused: where there is no such wall.
        """
        if not 0 <= index < len(self.walls):
            raise CommandRefused(f'remove_wall.wall: got {index}, expected one of '
                                 f'{len(self.walls)} walls, from 0 on')
        return self._changed(self.walls[:index] + self.walls[index + 1:])

    def clear(self) -> Drawing:
        """Remove all walls."""
        return self._changed(())

    def undo(self) -> Drawing:
        """
        Take the last change back.

        :raises CommandRefused: where there was none.
        """
        if self.previous is None:
            raise CommandRefused('undo: got no change of walls before, expected one')
        return self.previous

    def _changed(self, walls: tuple[Wall, ...]) -> Drawing:
        return dataclasses.replace(self, walls=walls, previous=self)


def open_floor(center: Coordinates) -> OccupancyMap:
    """
    Make a map without obstacles.

    :param center: (x, y) of its middle [m].
    """
    count = round(2.0 * HALF_SIDE / RESOLUTION)
    origin = (center[0] - HALF_SIDE, center[1] - HALF_SIDE, 0.0)
    return OccupancyMap(RESOLUTION, origin, np.zeros((count, count), dtype=bool))


def with_wall(occupancy_map: OccupancyMap, start: Coordinates,
              end: Coordinates) -> OccupancyMap:
    """
    Draw a straight wall.

    :param start: one end (x, y) [m].
    :param end: the other end (x, y) [m].
    :return: a map with the wall too.
    """
    resolution = occupancy_map.resolution
    rows, columns = occupancy_map.occupied.shape
    (x0, y0), (x1, y1) = occupancy_map.to_map(np.array([start[:2], end[:2]])).tolist()
    y, x = resolution * (np.indices((rows, columns)) + 0.5)
    squared = max((x1 - x0) ** 2 + (y1 - y0) ** 2, 1e-12)
    along = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / squared, 0.0, 1.0)
    distance = np.hypot(x - x0 - along * (x1 - x0), y - y0 - along * (y1 - y0))
    # At least the cells that the line runs through.
    half_width = max(0.5 * THICKNESS, resolution * math.sqrt(0.5))
    return OccupancyMap(resolution, occupancy_map.origin,
                        occupancy_map.occupied | (distance <= half_width))
