"""Reading of maps, large ones on a thread of their own: measurements are answered meanwhile."""

import threading
from typing import Any, NamedTuple

from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.map import from_map_message
from push_ros.conversions.primitives import MessageRefused

# Cells up to which a map is read at once; chosen: that takes some 20 ms.
LARGE_MAP = 500_000


class ReadMap(NamedTuple):
    """
    A map.

    :param occupancy_map: the ``OccupancyMap``.
    :param message: ``nav_msgs/OccupancyGrid`` that it comes from.
    """

    occupancy_map: OccupancyMap
    message: Any


class MapReader:
    """
    Reads the newest map.

    ``fault``: why there is none to rely on, one sentence; empty where there is one, or none has
    come. ``is_busy``: whether one is to be taken.
    """

    def __init__(self, frame: str) -> None:
        """
        Wait for a map.

        :param frame: id of the world frame.
        """
        self._frame = frame
        self._result: list[ReadMap | MessageRefused] = []
        self.fault = ''
        self.is_busy = False

    def start(self, message: Any) -> None:
        """
        Begin to read a map, in place of one that is being read.

        :param message: ``nav_msgs/OccupancyGrid``.
        """
        # A thread that is still at the former one puts its result into the former list.
        self._result = result = []
        self.is_busy = True
        self.fault = 'a map is being read'
        if len(message.data) <= LARGE_MAP:
            self._read(message, result)
        else:
            threading.Thread(target=self._read, args=(message, result), daemon=True).start()

    def refuse(self, reason: str) -> None:
        """
        Take note of a map that cannot be read.

        :param reason: one sentence.
        """
        self._result = []
        self.is_busy = False
        self.fault = reason

    def take(self) -> ReadMap | None:
        """
        Return the map once it is there.

        :return: ``ReadMap``, or None where there is none yet.
        :raises MessageRefused: where it cannot be used.
        """
        if not self._result:
            return None
        found, self.is_busy = self._result[0], False
        if isinstance(found, MessageRefused):
            self.fault = str(found)
            raise found
        self.fault = ''
        return found

    def _read(self, message: Any, result: list[ReadMap | MessageRefused]) -> None:
        try:
            result.append(ReadMap(from_map_message(message, self._frame), message))
        except MessageRefused as error:
            result.append(error)
        except (ValueError, MemoryError) as error:
            result.append(MessageRefused(f'map: {error}'))
