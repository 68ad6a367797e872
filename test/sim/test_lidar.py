"""Laws of the simulated lidar."""

import dataclasses
import math

from helpers.lidar_rooms import cast, room_cells
import numpy as np
from push_model.files import data
from push_model.files.parameter_files import read_object, read_robot
from push_model.geometry import Pose
from push_model.signals import LidarScan, ObjectPose, Odometry, Twist
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.wall_segments import map_walls
from push_sim_node.lidar import (
    BodyPoses, distances_to_segments, Lidar, LidarSensorSettings,
)
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation
import pytest

BOX = read_object(data.config_file('objects/box_04.yaml'))
ROBOT = read_robot(data.config_file('robots/holonomic_017.yaml'))
CELLS = room_cells(5.0, 4.0, [(40, 30, 55, 40), (2, 60, 12, 70)])
ORIGIN = Pose(-2.0, -1.5, 0.3)
EXACT = LidarSensorSettings(rate=10.0, noise=0.0, outlier_probability=0.0)
FAR = Pose(50.0, 0.0, 0.0)
WALLS = map_walls(OccupancyMap(0.05, ORIGIN, CELLS))


def lidar_of(settings, seed=0):
    """Make a lidar in the room."""
    return Lidar(settings, BOX, WALLS, np.random.default_rng(seed))


def standing_scan(lidar, robot, obj=FAR):
    """Measure where nothing moves."""
    for time in (0.0, 0.1):
        lidar.observe(BodyPoses(time, robot, obj))
    return lidar.measure(0.0)


def test_beams_end_at_the_faces_of_cells():
    """As where small steps along each beam enter an occupied cell."""
    robot = ORIGIN @ Pose(1.5, 1.2, 0.7)
    scan = standing_scan(lidar_of(EXACT), robot)
    angles = scan.angle_min + scan.angle_increment * np.arange(360)
    stepped = cast(CELLS, ORIGIN, robot, angles)
    assert np.quantile(np.abs(scan.ranges - stepped), 0.99) < 3e-3


def test_beams_meet_the_nearest_segment_before_them():
    """Of two walls one behind the other, and none behind the start."""
    segments = np.array([[1.0, -1.0, 1.0, 1.0], [2.0, -3.0, 2.0, 3.0]])
    starts, rays = np.zeros((3, 2)), np.array([[1.0, 0.0], [0.6, 0.8], [-1.0, 0.0]])
    assert distances_to_segments(starts, rays, segments) == pytest.approx(
        [1.0, 2.0 / 0.6, math.inf])


def test_beams_that_look_at_near_walls_first_meet_what_beams_meet_that_look_at_all():
    """In a room full of specks, while the robot drives and turns."""
    rng = np.random.default_rng(1)
    cells = np.array(CELLS)
    cells[rng.integers(0, cells.shape[0], 300), rng.integers(0, cells.shape[1], 300)] = True
    walls = map_walls(OccupancyMap(0.05, ORIGIN, cells))
    start = ORIGIN @ Pose(1.5, 1.2, 0.7)
    lidar = Lidar(EXACT, BOX, walls, rng)
    for time in (0.0, 0.1):
        lidar.observe(BodyPoses(time, start._replace(
            x=start.x + 2.0 * time, theta=start.theta + 3.0 * time), FAR))
    scan = lidar.measure(0.0)
    parts = np.arange(360) / 360
    starts = np.stack((start.x + 0.2 * parts, np.full(360, start.y)), axis=1)
    angles = start.theta + 0.3 * parts + scan.angle_min + scan.angle_increment * np.arange(360)
    segments = np.array([dataclasses.astuple(wall) for wall in walls])
    expected = distances_to_segments(
        starts, np.stack((np.cos(angles), np.sin(angles)), axis=1), segments)
    is_measured = expected >= EXACT.range_min
    assert scan.ranges[is_measured] == pytest.approx(expected[is_measured], abs=1e-5)
    assert is_measured.sum() > 300


def test_the_object_hides_the_wall():
    """Its side is met where it faces the lidar; a lidar above it looks over it."""
    robot, box = ORIGIN @ Pose(1.2, 2.2, 0.0), ORIGIN @ Pose(1.8, 2.2, 0.0)
    front = 0.6 + min(x for x, _ in BOX.outline)
    scan = standing_scan(lidar_of(EXACT), robot, box)
    assert scan.ranges[180] == pytest.approx(front)
    over = standing_scan(lidar_of(dataclasses.replace(EXACT, sees_object=False)), robot, box)
    assert over.ranges[180] > 1.0


def test_every_beam_is_measured_at_its_own_time():
    """A robot that turns once during a scan, backwards, sees one direction all the time."""
    lidar = lidar_of(EXACT)
    start = ORIGIN @ Pose(1.5, 1.2, 0.7)
    for time in np.linspace(0.0, 0.1, 26).tolist():
        lidar.observe(BodyPoses(time, start._replace(
            theta=start.theta - 2.0 * math.pi * time / 0.1), FAR))
    ranges = lidar.measure(0.0).ranges
    assert ranges.max() - ranges.min() < 1e-6


def test_noise_and_outliers_are_as_stated():
    """The spread of a range, and the part of beams that end before their wall."""
    lidar = lidar_of(LidarSensorSettings(rate=10.0, noise=0.02, outlier_probability=0.1))
    exact = standing_scan(lidar_of(EXACT), ORIGIN @ Pose(1.5, 1.2, 0.0)).ranges
    scans = [standing_scan(lidar, ORIGIN @ Pose(1.5, 1.2, 0.0)).ranges for _ in range(30)]
    errors = np.concatenate([scan - exact for scan in scans])
    assert np.mean(errors < -0.1) == pytest.approx(0.09, abs=0.02)
    assert np.std(errors[np.abs(errors) < 0.08]) == pytest.approx(0.02, rel=0.15)
    again = lidar_of(LidarSensorSettings(rate=10.0, noise=0.02, outlier_probability=0.1))
    assert np.array_equal(standing_scan(again, ORIGIN @ Pose(1.5, 1.2, 0.0)).ranges, scans[0])


def measurements(sensors, until=0.45):
    """Simulate a robot that drives and turns beside a box."""
    simulation = Simulation(BOX, ROBOT, Pose(1.0, 0.0, 0.0), Pose(0.0, 0.0, 0.0),
                            settings=SimulationSettings(walls=WALLS), sensors=sensors)
    taken = []
    while simulation.time < until:
        simulation.command(Twist(0.2, 0.0, 0.5))
        taken.append((simulation.next_measurement(), simulation.time))
    return taken


def test_scans_come_at_their_end_after_odometry_and_change_nothing_else():
    """Ten a second; all other measurements are the same without a lidar."""
    noisy = SensorSettings(pose_noise=0.01, odometry_scale_noise=0.02)
    with_lidar = measurements(dataclasses.replace(noisy, lidar=EXACT))
    scans = [(scan, time) for scan, time in with_lidar if isinstance(scan, LidarScan)]
    assert [scan.time for scan, _ in scans] == pytest.approx([0.0, 0.1, 0.2, 0.3])
    assert [time for _, time in scans] == pytest.approx([0.1, 0.2, 0.3, 0.4])
    for index, (measured, time) in enumerate(with_lidar):
        if isinstance(measured, LidarScan):
            before, odometry_time = with_lidar[index - 1]
            assert isinstance(before, Odometry) and odometry_time == time
    others = [measured for measured, _ in with_lidar if not isinstance(measured, LidarScan)]
    plain = [measured for measured, _ in measurements(noisy)]
    assert others == plain[:len(others)]
    assert {type(measured) for measured in plain} == {Odometry, ObjectPose}
