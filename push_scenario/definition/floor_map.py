"""Maps as scenario files draw them: rows of characters."""

import dataclasses
import functools

import numpy as np
from push_model.quantity import check, quantity
from push_navigation.occupancy_map import OccupancyMap
from push_scenario.definition.placement import Placement

FREE, OCCUPIED = '.', '#'


@dataclasses.dataclass(frozen=True)
class FloorMap:
    """A map of free and occupied cells."""

    resolution: float = quantity('side of a cell', 'm', above=0.0, high=10.0)
    rows: str = quantity('a line per row of cells, the first one has the largest y: # occupied, '
                         '. free')
    origin: Placement = Placement()

    def __post_init__(self) -> None:
        """Validate the fields."""
        check(self)
        lines = self.rows.split()
        if len({len(line) for line in lines}) != 1 or set(''.join(lines)) - {FREE, OCCUPIED}:
            raise ValueError(f'FloorMap.rows: got {self.rows!r}, expected lines of one length, of '
                             f'{OCCUPIED} and {FREE}')

    @functools.cached_property
    def occupancy_map(self) -> OccupancyMap:
        """The same as an ``OccupancyMap``; ``origin`` is the corner with the least x and y."""
        cells = np.array([list(line) for line in reversed(self.rows.split())])
        return OccupancyMap(self.resolution, self.origin.pose, cells == OCCUPIED)
