"""Maps as scenario files draw them: rows of characters."""

import dataclasses
import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray
from push_dynamics.walls import Wall
from push_model.geometry import BoolArray
from push_model.quantity import check, quantity
from push_navigation.map_file import GridMap
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_navigation.wall_segments import map_walls
from push_scenario.definition.placement import Placement

FREE, OCCUPIED, UNKNOWN = '.', '#', '?'


@dataclasses.dataclass(frozen=True)
class FloorMap:
    """A map of free, occupied and unknown cells."""

    resolution: float = quantity('side of a cell', 'm', above=0.0, high=10.0)
    rows: str = quantity('a line per row of cells, the first one has the largest y: # occupied, '
                         '. free, ? unknown')
    origin: Placement = Placement()

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        lines = self.rows.split()
        if len({len(line) for line in lines}) != 1 or set(''.join(lines)) - {
                FREE, OCCUPIED, UNKNOWN}:
            raise ValueError(f'FloorMap.rows: got {self.rows!r:.500}, expected lines of one '
                             f'length, of {OCCUPIED}, {FREE} and {UNKNOWN}')

    @functools.cached_property
    def characters(self) -> NDArray[np.uint8]:
        """Codes of the characters of the cells, shape (rows, columns), least y first."""
        lines = self.rows.split()
        codes = np.frombuffer(''.join(lines).encode('ascii'), dtype=np.uint8)
        return codes.reshape(len(lines), -1)[::-1]

    @property
    def occupied(self) -> BoolArray:
        """Tell whether each cell is occupied, and not only unknown, shape (rows, columns)."""
        return self.characters == ord(OCCUPIED)

    @functools.cached_property
    def occupancy_map(self) -> OccupancyMap:
        """The same where unknown cells are obstacles."""
        return self.read(MapSettings())

    @functools.cached_property
    def walls(self) -> tuple[Wall, ...]:
        """The ``Wall`` round each block of occupied cells; unknown ones are none."""
        return map_walls(self.read(MapSettings(allow_unknown=True)))

    def read(self, settings: MapSettings) -> OccupancyMap:
        """Return the same as an ``OccupancyMap``; its origin is the lower left corner."""
        occupied = self.occupied
        if not settings.allow_unknown:
            occupied |= self.characters == ord(UNKNOWN)
        return OccupancyMap(self.resolution, self.origin.pose, occupied)


def floor_map_values(grid: GridMap, lethal_cost_threshold: float) -> dict[str, Any]:
    """
    Draw a map file, as the mapping that a scenario file would hold.

    :param lethal_cost_threshold: value from which on a cell is occupied.
    """
    codes = np.where(grid.cells >= lethal_cost_threshold, ord(OCCUPIED),
                     np.where(grid.cells < 0, ord(UNKNOWN), ord(FREE))).astype(np.uint8)
    rows = '\n'.join(row.tobytes().decode('ascii') for row in codes[::-1])
    x, y, theta = grid.origin
    return {'resolution': grid.resolution, 'origin': {'x': x, 'y': y, 'theta': theta},
            'rows': rows}
