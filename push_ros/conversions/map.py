"""Occupancy maps to messages and back."""

import array

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

# Values of ``nav_msgs/OccupancyGrid``: no knowledge, or the probability of an obstacle in percent.
UNKNOWN = -1
FREE = 0
FULL = 100


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
    info, cells = message.info, np.asarray(message.data)
    if not MIN_RESOLUTION <= info.resolution <= MAX_RESOLUTION:
        raise MessageRefused(f'{topic}: got the resolution {info.resolution:g}, expected '
                             f'{RESOLUTION_RANGE}')
    if not len(cells) or len(cells) != info.width * info.height:
        raise MessageRefused(f'{topic}: got {len(cells)} cells, expected {info.width} times '
                             f'{info.height}, at least one')
    wrong = np.flatnonzero((cells < UNKNOWN) | (cells > FULL))
    if len(wrong):
        raise MessageRefused(f'{topic}: got {cells[wrong[0]]} in cell {wrong[0]}, expected '
                             f'{UNKNOWN} to {FULL}')
    settings = settings or MapSettings()
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
