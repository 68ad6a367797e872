"""The place of the robot, from the messages of a map, odometry and scans."""

import dataclasses

from builtin_interfaces.msg import Time
from helpers.lidar_rooms import EXACT, RESOLUTION, room_cells, scan_at, standing
import numpy as np
from push_control.ros.parameters import ControllerParameters, SECTIONS
from push_control.ros.robot_placing import RobotPlacing
from push_localization.localizer import FIT_COUNT
from push_model.files import data
from push_model.files.flat_values import from_parameter_values, to_parameter_values
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.signals import PoseCovariance, RobotPlace
from push_navigation.occupancy_map import OccupancyMap
from push_ros.conversions.lidar import to_scan_message
from push_ros.conversions.map import to_map_message
from push_ros.conversions.primitives import to_stamp
import pytest

CELLS = room_cells(5.0, 4.0, [(40, 30, 55, 40)])
ORIGIN, PLACE = Pose(-1.0, 2.0, 0.2), Pose(1.5, 1.2, 0.4)
MAP = to_map_message(OccupancyMap(0.05, ORIGIN, CELLS), Time(), 'odom')


def placing_by(**changes):
    """Make it with some settings of the place; a stated mounting needs no transforms."""
    values = {**to_parameter_values(read_object(data.config_file('objects/box_04.yaml')),
                                    'object.'),
              **to_parameter_values(read_robot(data.config_file('robots/disc_017.yaml')),
                                    'robot.')}
    parameters = ControllerParameters(*(from_parameter_values(section, values, prefix)
                                        for prefix, section in SECTIONS))
    place = dataclasses.replace(EXACT, mount='stated', **changes)
    return RobotPlacing(parameters._replace(place=place), None)


def measure(placing, robot, start=0.0):
    """Let odometry and a scan of a robot come that stands."""
    return stand_and_scan(placing, robot, scan_at(CELLS, robot, origin=ORIGIN), start)


def stand_and_scan(placing, robot, scan, start):
    """Let odometry of a robot come that stands, and a scan."""
    for time in (start, start + 0.1):
        placing.update(standing(time, robot), None)
    message = to_scan_message(scan._replace(time=start), to_stamp(start), 'laser')
    placing.update(placing.read_scan(message), None)
    return placing.newest


def test_a_map_and_a_scan_make_a_place_which_moves_with_the_map():
    """Where the map lies elsewhere, the robot that sees the same is elsewhere, too."""
    robot = ORIGIN @ PLACE
    placing = placing_by()
    assert measure(placing, robot) is None
    placing.reset()
    placing.set_map(MAP)
    first = measure(placing, robot)
    assert np.allclose(first.pose, robot, atol=2e-3)
    moved = Pose(ORIGIN.x + 0.04, ORIGIN.y - 0.02, ORIGIN.theta + 0.03)
    placing.set_map_origin(moved)
    for index in range(1, 5):
        # The scan is the same: the robot stands where it stood in the map.
        place = measure(placing, robot, 0.2 * index)
    assert np.allclose(place.pose, moved @ PLACE, atol=2e-3)
    placing.reset()
    assert placing.newest is None


@pytest.mark.parametrize('source', ['none', 'place'])
def test_scans_count_only_where_they_are_the_source(source):
    """A place of another localization is taken as it is."""
    placing = placing_by(source=source)
    placing.set_map(MAP)
    assert measure(placing, ORIGIN @ PLACE) is None
    place = RobotPlace(0.0, PLACE, PoseCovariance.from_deviations(0.01, 0.01))
    placing.update(place, None)
    assert placing.newest == place


def test_objects_that_stand_are_no_walls_that_the_map_lacks() -> None:
    """Scans of four boxes about the robot fit where their poses are known, and none is pushed."""
    cells, box = CELLS.copy(), read_object(data.config_file('objects/box_04.yaml'))
    centers = [(2.2, 1.2), (0.8, 1.2), (1.5, 1.9), (1.5, 0.5)]
    for x, y in centers:
        column, row = (round((value - 0.2) / RESOLUTION) for value in (x, y))
        cells[row:row + 8, column:column + 8] = True
    scan, warnings = scan_at(cells, PLACE), []
    for known, pushed in (([], []), (centers, []), (centers, centers)):
        placing = placing_by()
        placing.set_map(MAP)
        for x, y in known:
            placing.note_standing(f'{x} {y}', box, ORIGIN @ Pose(x, y, 0.0))
        for x, y in pushed:
            placing.set_object(f'{x} {y}', box)
        for index in range(FIT_COUNT):
            stand_and_scan(placing, ORIGIN @ PLACE, scan, 0.2 * index)
        warnings.append(placing.fit_warning())
    assert [bool(warning) for warning in warnings] == [True, False, True]
