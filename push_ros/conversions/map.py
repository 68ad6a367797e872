"""Occupancy maps to messages and back."""

import array
from collections.abc import Callable

from builtin_interfaces.msg import Time
from nav_msgs.msg import OccupancyGrid
import numpy as np
from push_model.geometry import Pose
from push_navigation.occupancy_map import (
    MAX_RESOLUTION, MIN_RESOLUTION, OccupancyMap, RESOLUTION_RANGE,
)
from push_navigation.settings import MapSettings
from push_ros.conversions.primitives import (
    check_frame, check_upright, from_pose_message, MessageRefused, to_pose_message,
)
from push_ros.conversions.serialized import (
    DOUBLE_ALIGNMENT, LENGTH, LENGTH_ALIGNMENT, PLAIN_CDR, POSE_SIZE, STAMP,
)
from rclpy.serialization import deserialize_message

# Values of ``nav_msgs/OccupancyGrid``: no knowledge, or the probability of an obstacle in percent.
UNKNOWN = -1
FREE = 0
FULL = 100
# Bytes that may follow the cells of a serialized map [B].
PADDING = 16


def to_map_message(occupancy_map: OccupancyMap, stamp: Time, frame: str) -> OccupancyGrid:
    """
    Convert a map to a message.

    :param stamp: of the map.
    :param frame: id of the world frame.
    """
    message = OccupancyGrid()
    message.header.stamp, message.header.frame_id = stamp, frame
    message.info.map_load_time, message.info.resolution = stamp, occupancy_map.resolution
    message.info.height, message.info.width = occupancy_map.occupied.shape
    message.info.origin = to_pose_message(occupancy_map.origin)
    # An array is taken as it is, a list number by number.
    cells = np.where(occupancy_map.occupied, FULL, FREE).astype(np.int8)
    message.data = array.array('b', cells.tobytes())
    return message


def map_reader(settings: MapSettings) -> Callable[[bytes], OccupancyGrid]:
    """
    Make a function that reads a serialized map; of one that is too large all but its cells.

    A map of 400 million cells takes seconds to read, in which a node does nothing else.

    :param settings: ``MapSettings``.
    """
    def read(data: bytes) -> OccupancyGrid:
        start = _cells_start(data)
        has_room = len(data) <= start + LENGTH.size + settings.max_cells + PADDING
        return deserialize_message(data if has_room else data[:start] + LENGTH.pack(0),
                                   OccupancyGrid)
    return read


def _cells_start(data: bytes) -> int:
    """
    Find where the number of cells stands in a serialized map.

    In plain CDR that is behind stamp and frame of the header, time, resolution, width, height, and
    the seven numbers of the origin, which are aligned to 8 bytes.

    :raises RuntimeError: where it is not plain CDR.
    """
    stamp_end = len(PLAIN_CDR) + STAMP.size
    if not data.startswith(PLAIN_CDR) or len(data) < stamp_end + LENGTH.size:
        raise RuntimeError('got no plain CDR')
    size = LENGTH.unpack_from(data, stamp_end)[0]
    position = STAMP.size + LENGTH.size + size
    position += -position % LENGTH_ALIGNMENT + STAMP.size + 3 * LENGTH.size
    position += -position % DOUBLE_ALIGNMENT + POSE_SIZE * DOUBLE_ALIGNMENT
    return len(PLAIN_CDR) + position


def from_map_message(message: OccupancyGrid, frame: str, topic: str = 'map', *,
                     settings: MapSettings | None = None) -> OccupancyMap:
    """
    Read a map.

    :param message: ``nav_msgs/OccupancyGrid``.
    :param frame: id of the world frame.
    :param topic: what errors call the message.
    :param settings: ``MapSettings``, or None for the defaults.
    :raises MessageRefused: naming what is wrong with it.
    """
    check_frame(message.header.frame_id, frame, topic)
    settings = settings or MapSettings()
    info, cells = message.info, np.asarray(message.data)
    if not MIN_RESOLUTION <= info.resolution <= MAX_RESOLUTION:
        raise MessageRefused(f'{topic}: got the resolution {info.resolution:g}, expected '
                             f'{RESOLUTION_RANGE}')
    if info.width * info.height > settings.max_cells:
        raise MessageRefused(f'{topic}: got {info.width} times {info.height} cells, expected at '
                             f'most {settings.max_cells} in all (map.max_cells)')
    if not len(cells) or len(cells) != info.width * info.height:
        raise MessageRefused(f'{topic}: got {len(cells)} cells, expected {info.width} times '
                             f'{info.height}, at least one')
    wrong = np.flatnonzero((cells < UNKNOWN) | (cells > FULL))
    if len(wrong):
        raise MessageRefused(f'{topic}: got {cells[wrong[0]]} in cell {wrong[0]}, expected '
                             f'{UNKNOWN} to {FULL}')
    occupied = cells >= settings.lethal_cost_threshold
    if not settings.allow_unknown:
        occupied |= cells == UNKNOWN
    return OccupancyMap(info.resolution, map_origin(message, topic),
                        occupied.reshape(info.height, info.width))


def map_origin(message: OccupancyGrid, topic: str = 'map') -> Pose:
    """
    Read where the outer corner of the first cell is.

    :param message: ``nav_msgs/OccupancyGrid``.
    :param topic: what errors call the message.
    :raises MessageRefused: where it is tilted, or not finite.
    """
    check_upright(message.info.origin.orientation, f'{topic}: origin')
    return from_pose_message(message.info.origin, f'{topic}: origin')


def map_text(message: OccupancyGrid) -> str:
    """
    Describe a map in words.

    :param message: ``nav_msgs/OccupancyGrid``.
    """
    return f'has a map of {message.info.width} times {message.info.height} cells'
