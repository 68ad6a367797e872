"""The map of a room without its objects, and the map with those that stand."""

import array
from collections.abc import Sequence

from builtin_interfaces.msg import Time
from nav_msgs.msg import OccupancyGrid
import numpy as np
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_ros.conversions.map import FREE, from_map_message, UNKNOWN
from push_tidy.obstacles import covered_cells, MapGrid, StandingObject


class RoomMap:
    """
    The map of a room.

    ``occupancy_map``: the ``OccupancyMap`` without the objects.

    :param message: ``nav_msgs/OccupancyGrid`` in the world frame.
    :param frame: id of the world frame.
    :param settings: ``MapSettings``.
    :raises MessageRefused: where it cannot be used.
    """

    def __init__(self, message: OccupancyGrid, frame: str, settings: MapSettings) -> None:
        self.occupancy_map: OccupancyMap = from_map_message(message, frame, 'room_map',
                                                            settings=settings)
        self._message = message
        self._settings = settings

    def with_objects(self, standing: Sequence[StandingObject], margin: float,
                     pushed: StandingObject, stamp: Time) -> OccupancyGrid:
        """
        Make the map in which objects stand, as unknown cells: they are no walls for a lidar.

        Unknown cells of the room become free where they are no obstacles.

        :param standing: ``StandingObject`` of each.
        :param margin: uncertainty of their outlines [m].
        :param pushed: the object that is pushed past them; where it stands is free of them.
        :param stamp: of the map.
        """
        info, origin = self._message.info, self.occupancy_map.origin
        cells = np.array(self._message.data, dtype=np.int8).reshape(info.height, info.width)
        if self._settings.allow_unknown:
            cells[cells == UNKNOWN] = FREE
        grid = MapGrid(self.occupancy_map.resolution, origin, *cells.shape)
        covered = covered_cells(grid, standing, margin, pushed)
        cells[covered & ~self.occupancy_map.occupied] = UNKNOWN
        message = OccupancyGrid(info=info)
        message.header.stamp, message.header.frame_id = stamp, self._message.header.frame_id
        message.data = array.array('b', cells.tobytes())
        return message
