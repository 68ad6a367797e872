"""
Reading of maps, large ones on a thread of their own: the node goes on meanwhile.

A map that comes again unchanged, as some are sent every second, is the one that was read before.
"""

import enum
import math
import threading
from typing import Any, NamedTuple

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_ros.conversions.map import from_map_message, map_origin
from push_ros.conversions.primitives import check_frame, MessageRefused, seconds

# Cells up to which a map is read at once; chosen: that takes some 10 ms.
LARGE_MAP = 500_000
# Shift of a map that is overlooked [m], [rad]; chosen: as the drift of frames.
MIN_SHIFT = 2e-3
MIN_TURN = 2e-3


class MapChange(enum.Enum):
    """Change of a map by a message."""

    NONE = 'unchanged'
    MOVED = 'moved'
    NEW = 'new'


class ReadMap(NamedTuple):
    """
    A map.

    :param occupancy_map: the ``OccupancyMap``.
    :param message: ``nav_msgs/OccupancyGrid`` that it comes from.
    :param change: ``MapChange`` against the map before.
    """

    occupancy_map: OccupancyMap
    message: Any
    change: MapChange

    @property
    def stamp(self) -> float:
        """Time of the map [s]."""
        return seconds(self.message.header.stamp)


class MapReader:
    """
    Reads the newest map.

    ``fault``: why there is none to rely on, one sentence; empty where there is one, or none has
    come. ``is_busy``: whether one is to be taken.
    """

    def __init__(self, frame: str, settings: MapSettings) -> None:
        """
        Wait for a map.

        :param frame: id of the world frame.
        """
        self._frame = frame
        self._settings = settings
        self._result: list[ReadMap | MessageRefused] = []
        self._thread: threading.Thread | None = None
        # The message that is being read, and the map that was read last.
        self._pending: Any = None
        self._held: ReadMap | None = None
        self.fault = ''
        self.is_busy = False

    def start(self, message: Any) -> None:
        """
        Start to read a map, in place of another one that is being read.

        :param message: ``nav_msgs/OccupancyGrid``.
        """
        if self._pending is not None and _has_same_cells(message, self._pending) \
                and message.info.origin == self._pending.info.origin:
            return
        # A thread that is still at the former one puts its result into the former list.
        self._result = result = []
        self._pending, self._thread = None, None
        self.is_busy = True
        held = self._held
        if held is not None and _has_same_cells(message, held.message):
            result.append(self._read_origin(message, held))
            return
        self.fault = 'a map is being read'
        self._pending = message
        if len(message.data) <= LARGE_MAP:
            self._read(message, result)
        else:
            self._thread = threading.Thread(target=self._read, args=(message, result), daemon=True)
            self._thread.start()

    def refuse(self, reason: str) -> None:
        """
        Take note of a map that cannot be read.

        :param reason: one sentence.
        """
        self._result = []
        self._pending, self._thread = None, None
        self.is_busy = False
        self.fault = reason

    def move(self, correction: Pose) -> ReadMap | None:
        """
        Move the map with the frame that it is in.

        :param correction: ``Pose`` that takes its former origin to the new one,
            ``correction @ origin``.
        :return: ``ReadMap``, or None where there is no map.
        """
        if self._held is not None:
            self._held = self._held._replace(
                occupancy_map=self._held.occupancy_map.moved(correction), change=MapChange.MOVED)
        return self._held

    def wait(self) -> None:
        """Wait until the map is there that is being read, if any."""
        if self._thread is not None:
            self._thread.join()

    def take(self) -> ReadMap | None:
        """
        Return the map once it is there.

        :return: ``ReadMap``, or None where there is none yet.
        :raises MessageRefused: where it cannot be used.
        """
        if not self._result:
            return None
        result, self._result = self._result[0], []
        self._pending, self._thread = None, None
        self.is_busy = False
        if isinstance(result, MessageRefused):
            self.fault = str(result)
            raise result
        if self.fault and result.change is MapChange.NONE:
            # Nobody uses the one that was held.
            result = result._replace(change=MapChange.NEW)
        self.fault = ''
        self._held = result
        return result

    def _read(self, message: Any, result: list[ReadMap | MessageRefused]) -> None:
        try:
            result.append(ReadMap(from_map_message(message, self._frame, settings=self._settings),
                                  message, MapChange.NEW))
        except MessageRefused as error:
            result.append(error)
        except (ValueError, MemoryError) as error:
            result.append(MessageRefused(f'map: {error}'))

    def _read_origin(self, message: Any, held: ReadMap) -> ReadMap | MessageRefused:
        """Read a message whose cells are those of the map that is held."""
        try:
            check_frame(message.header.frame_id, self._frame, 'map')
            origin = map_origin(message)
        except MessageRefused as error:
            return error
        previous = held.occupancy_map.origin
        if (distance(origin, previous) < MIN_SHIFT
                and abs(wrap_angle(origin.theta - previous.theta)) < MIN_TURN):
            return ReadMap(held.occupancy_map, message, MapChange.NONE)
        return ReadMap(held.occupancy_map.moved(origin @ previous.inverse()), message,
                       MapChange.MOVED)


def _has_same_cells(message: Any, other: Any) -> bool:
    """Tell whether two messages have the same grid, wherever it lies."""
    one, two = message.info, other.info
    # Numbers that are not finite equal none.
    return ((one.width, one.height) == (two.width, two.height)
            and math.isclose(one.resolution, two.resolution, rel_tol=1e-9)
            and np.array_equal(np.asarray(message.data), np.asarray(other.data)))
