"""Maps that come again, move, or cannot be used."""

import math

from nav_msgs.msg import OccupancyGrid
import numpy as np
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_ros.conversions.map import from_map_message, map_reader, to_map_message
from push_ros.conversions.primitives import MessageRefused, to_pose_message, to_stamp
from push_ros.map_reader import MapChange, MapReader
import pytest
from rclpy.serialization import deserialize_message, serialize_message

ORIGIN = Pose(1.0, -2.0, 0.5)
CELLS = np.random.default_rng(0).random((40, 60)) < 0.1


def message(cells=CELLS, origin=ORIGIN, time=0.0):
    """Make a map."""
    return to_map_message(OccupancyMap(0.05, origin, cells), to_stamp(time), 'odom')


def read(reader, sent):
    """Let it be read."""
    reader.start(sent)
    reader.wait()
    return reader.take()


def reader(**settings):
    """Make a reader."""
    return MapReader('odom', MapSettings(**settings))


def test_a_map_that_comes_again_is_the_same_one():
    """The same object, so that nothing is computed or planned again; its stamp is the newer."""
    maps = reader()
    first, again = read(maps, message()), read(maps, message(time=1.0))
    assert (first.change, again.change) == (MapChange.NEW, MapChange.NONE)
    assert again.occupancy_map is first.occupancy_map and again.stamp == 1.0
    other = CELLS.copy()
    other[3, 4] = not other[3, 4]
    assert read(maps, message(other)).change is MapChange.NEW


def test_a_map_that_comes_again_elsewhere_is_moved():
    """As that of one in a frame that drifts; its distances are kept. Small shifts add up."""
    maps = reader()
    first = read(maps, message())
    for step in range(1, 4):
        origin = ORIGIN._replace(x=ORIGIN.x + 1.5e-3 * step)
        found = read(maps, message(origin=origin))
        assert abs(found.occupancy_map.origin.x - origin.x) < 2e-3
    far = Pose(0.0, 3.0, -2.0)
    found = read(maps, message(origin=far))
    assert found.change is MapChange.MOVED
    assert found.occupancy_map.origin == pytest.approx(far, abs=1e-9)
    assert found.occupancy_map.distances is first.occupancy_map.distances


def test_a_map_that_is_refused_leaves_none_to_rely_on():
    """Until one comes that can be used, also the one of before."""
    maps = reader()
    first = read(maps, message())
    bad = message()
    bad.data[3] = 101
    with pytest.raises(MessageRefused, match='got 101 in cell 3'):
        read(maps, bad)
    assert 'got 101' in maps.fault
    tilted = message()
    tilted.info.origin = to_pose_message(ORIGIN)
    tilted.info.origin.position.x = math.nan
    with pytest.raises(MessageRefused, match='origin'):
        read(maps, tilted)
    found = read(maps, message())
    assert not maps.fault and found.occupancy_map is first.occupancy_map
    assert found.change is MapChange.NEW


def test_a_large_map_that_is_sent_again_while_it_is_read_is_read_once(monkeypatch):
    """Else one that is sent every second would never be there."""
    monkeypatch.setattr('push_ros.map_reader.LARGE_MAP', 100)
    maps = reader()
    maps.start(message())
    assert maps.is_busy and maps.fault == 'a map is being read'
    thread = maps._thread
    maps.start(message())
    assert maps._thread is thread
    maps.wait()
    assert maps.take().change is MapChange.NEW and not maps.fault


@pytest.mark.parametrize('value, settings, occupied', [
    (-1, {'allow_unknown': True}, False), (-1, {'lethal_cost_threshold': 99.0}, True),
    (98, {'lethal_cost_threshold': 99.0}, False), (99, {'lethal_cost_threshold': 99.0}, True),
    (100, {'allow_unknown': True}, True)])
def test_settings_say_what_an_obstacle_is(value, settings, occupied):
    """Unknown cells, and costs of a costmap."""
    sent = message()
    sent.data[65] = value
    found = from_map_message(sent, 'odom', settings=MapSettings(**settings))
    assert found.occupied[1, 5] == occupied


@pytest.mark.parametrize('frame', ['', 'm', 'ab', 'abc', 'odom', 'a/long/frame_of_a_map'])
@pytest.mark.parametrize('size', [(1, 1), (3, 5), (40, 60)])
def test_of_a_map_that_is_too_large_all_but_the_cells_is_read(frame, size):
    """It is refused by its size; one that is as large as it may be is read as it is."""
    sent = to_map_message(OccupancyMap(0.05, ORIGIN, CELLS[:size[0], :size[1]]), to_stamp(3.5),
                          frame)
    data, count = serialize_message(sent), size[0] * size[1]
    sent = deserialize_message(data, OccupancyGrid)
    assert map_reader(MapSettings(max_cells=count))(data) == sent
    # Beyond a few bytes that may follow.
    limit = MapSettings(max_cells=max(1, count - 20))
    received = map_reader(limit)(data)
    if count > 20:
        assert (received.header, received.info) == (sent.header, sent.info)
        assert not received.data
    if count > limit.max_cells:
        with pytest.raises(MessageRefused, match='cells, expected at most .*map.max_cells'):
            from_map_message(received, frame, settings=limit)


def test_bytes_that_are_no_map_are_not_read():
    """However few."""
    for data in (b'', bytes(4), b'\0\1\0\0' + bytes(7), b'\0\7\0\0' + bytes(100)):
        with pytest.raises(RuntimeError):
            map_reader(MapSettings())(data)
