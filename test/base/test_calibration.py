"""Calibration of drawn bases: what is measured, what is found, and where the robot stays."""

import dataclasses
import math
from typing import NamedTuple

from benchmarks.calibration.bases import (
    calibrate, draw_base, DrawnBase, errors_of, OBJECT_POSE, simulation_of, TOLERANCES,
)
import numpy as np
from push_base.calibration.estimation import estimate
from push_base.calibration.findings import find_faults, Finding
from push_base.calibration.program import CalibrationProgram, SIDE
from push_base.calibration.recording import Interruption, ReceivedPose, Recording
from push_base.calibration.report import files
from push_model.files.mapping import from_mapping, Location
from push_model.files.parameter_files import read_robot
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP, Twist
from push_scenario.calibration.simulated import RobotTracker, run_program
from push_scenario.definition.loader import read_sensors
from push_sim_node.drive_imperfections import DriveImperfections, SpeedFactor
from push_sim_node.sensors import SensorSettings
import pytest
import yaml

# Differential and holonomic; least speeds before and behind the lag, steps, uneven wheels.
SEEDS = range(4)


class Run(NamedTuple):
    """A calibration, and where the robot was at each odometry, from its start."""

    base: DrawnBase
    recording: Recording
    start: Pose
    poses: list[Pose]


def run_of(base, seed=0):
    """Run the program on a base that a tracker sees."""
    program, simulation = CalibrationProgram(base.nominal), simulation_of(base, seed)
    start, poses = simulation.plant.robot_pose, []
    run_program(program, simulation, RobotTracker(base.sensors, seed),
                progress=lambda _: poses.append(simulation.plant.robot_pose))
    return Run(base, program.recording, start, poses)


@pytest.fixture(scope='module')
def runs():
    """Calibrate a few of the bases of the benchmark."""
    return {seed: run_of(draw_base(seed), seed) for seed in SEEDS}


@pytest.fixture(scope='module')
def calibrations(runs):
    """Estimate what they are."""
    return {seed: (run.base, estimate(run.recording)) for seed, run in runs.items()}


@pytest.fixture(scope='module')
def good_run():
    """Calibrate a good base."""
    return run_of(good_base())


def good_base(drive='differential', **imperfections):
    """Return a base that does what it is told, but for what is planted."""
    robot = RoundRobot(0.17, drive=drive, max_speed=0.5, max_yaw_rate=1.9, max_acceleration=0.9)
    return draw_base(0)._replace(nominal=robot, robot=robot,
                                 imperfections=DriveImperfections(**imperfections),
                                 sensors=SensorSettings(pose_noise=0.002))


def faults_of(base):
    """Return what a calibration finds."""
    return find_faults(calibrate(base))


def run_with(base, change, delay=0.0):
    """Calibrate a base whose odometry is changed on its way; return the recording."""
    simulation = simulation_of(base)
    program = CalibrationProgram(base.nominal)
    while not program.is_done:
        measured = simulation.next_measurement()
        if isinstance(measured, Odometry):
            simulation.command(program.step(simulation.time + delay, change(measured)))
    return program.recording


@pytest.mark.slow
@pytest.mark.parametrize('seed', SEEDS)
def test_what_is_measured_is_true(calibrations, seed):
    """To the tolerances that are promised, and intervals cover what they are promised for."""
    base, calibration = calibrations[seed]
    errors = errors_of(base, calibration)
    for name, tolerance in TOLERANCES.items():
        error, is_covered = errors[name]
        assert abs(error) <= tolerance, (name, error)
        assert is_covered, name


@pytest.mark.slow
@pytest.mark.parametrize('seed', SEEDS)
def test_files_are_read_back(calibrations, seed, tmp_path):
    """As robot and sensors of a scenario, and as parameters of the nodes, the same robot."""
    _, calibration = calibrations[seed]
    texts = files(calibration)
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    robot = read_robot(tmp_path / 'robot.yaml')
    assert robot.dead_time == pytest.approx(calibration.drive.dead_time.value, abs=1e-4)
    assert read_sensors(tmp_path / 'sensors.yaml').odometry_rate == pytest.approx(50.0)
    parameters = yaml.safe_load(texts['params.yaml'])['/**']['ros__parameters']['robot']
    assert from_mapping(RoundRobot, parameters, Location('params.yaml')) == robot


@pytest.mark.slow
@pytest.mark.parametrize('seed', SEEDS)
def test_the_robot_stays_within_its_square(runs, seed):
    """Its whole disc, whatever the base is like, at any heading of the start."""
    base, _, start, poses = runs[seed]
    extent = max(max(map(abs, (start.inverse() @ pose)[:2])) for pose in poses)
    assert extent + base.robot.radius < 0.5 * SIDE
    # It uses the square: a robot that stands would pass, too.
    assert extent > 0.3


@pytest.mark.slow
@pytest.mark.parametrize('time', [0.5, 5.4, 37.0])
def test_interrupted_it_stops_and_keeps_what_it_has(time):
    """Whenever that is: the last command is zero, and there are files."""
    base = good_base()
    program, simulation = CalibrationProgram(base.nominal), simulation_of(base)
    commands = []

    def watch(now):
        commands.append(program.recording.commands[-1].twist)
        if now >= time:
            program.interrupt(Interruption.BY_USER, now)

    run_program(program, simulation, progress=watch)
    assert program.is_done
    assert commands[-1] == STOP
    assert simulation.time < time + 1.0
    assert Interruption.BY_USER.value in files(estimate(program.recording))['report.txt']


@pytest.mark.slow
def test_without_odometry_it_stops():
    """Within half a second; what is found is the odometry."""
    base = good_base()
    program, simulation = CalibrationProgram(base.nominal), simulation_of(base)
    while not program.is_done:
        measured = simulation.next_measurement()
        is_lost = simulation.time > 5.5
        if isinstance(measured, Odometry):
            simulation.command(program.step(simulation.time, None if is_lost else measured))
    assert simulation.time < 7.0
    assert program.recording.commands[-1].twist == STOP
    assert Finding.ODOMETRY_LOST in find_faults(estimate(program.recording))


def test_before_odometry_it_stands_and_says_so():
    """No command but zero; interrupted, there is a report."""
    program = CalibrationProgram(good_base().nominal)
    assert [program.step(0.1 * k, None) for k in range(20)] == [STOP] * 20
    program.interrupt(Interruption.BY_USER, 2.0)
    assert find_faults(estimate(program.recording)) == [Finding.NO_ODOMETRY]


def test_a_square_that_is_too_small_is_refused():
    """With the side that is needed."""
    with pytest.raises(ValueError, match='side: got 1 m, expected at least'):
        CalibrationProgram(good_base().nominal, 1.0)


@pytest.mark.slow
def test_nothing_is_found_at_a_good_base(good_run):
    """Of either drive: the other half of the next tests."""
    assert find_faults(estimate(good_run.recording)) == []
    assert faults_of(good_base('holonomic')) == []


PLANTED = {
    Finding.SMOOTHER: {'smoother_acceleration': 0.3},
    Finding.STOPPED: {'speed_factors': (SpeedFactor(15.0, 19.0, 0.0),)},
    Finding.SCALED: {'speed_factors': (SpeedFactor(15.0, 20.0, 0.5),)},
    Finding.UNEVEN_WHEELS: {'left_wheel_factor': 0.95},
    Finding.HIGH_LEAST_SPEED: {'output_min_speed': 0.13},
}


@pytest.mark.slow
@pytest.mark.parametrize('finding', PLANTED, ids=lambda finding: finding.name)
def test_a_fault_of_the_base_is_found_and_no_other(finding):
    """Each is found where it is planted, and alone."""
    assert faults_of(good_base(**PLANTED[finding])) == [finding]


@pytest.mark.slow
def test_a_late_base_is_found():
    """One that is later than pushing needs."""
    base = good_base()
    late = dataclasses.replace(base.robot, dead_time=0.36)
    assert faults_of(base._replace(robot=late)) == [Finding.LATE]


def mirrored(odometry):
    """Turn to the other side."""
    x, y, theta = odometry.pose
    return odometry._replace(pose=Pose(x, -y, -theta),
                             twist=odometry.twist._replace(omega=-odometry.twist.omega))


def swapped(odometry):
    """State a heading that is off by a right angle."""
    x, y, theta = odometry.pose
    v_x, v_y, omega = odometry.twist
    return odometry._replace(pose=Pose(x, y, theta - 0.5 * math.pi), twist=Twist(-v_y, v_x, omega))


def ahead(odometry):
    """Come from a clock that is a second ahead."""
    return odometry._replace(time=odometry.time + 1.0)


def still(odometry):
    """State that nothing moves."""
    return odometry._replace(pose=Pose(0.0, 0.0, 0.0), twist=STOP)


@pytest.mark.slow
@pytest.mark.parametrize('change, finding', [
    (mirrored, Finding.YAW_MIRRORED), (swapped, Finding.AXES_SWAPPED),
    (still, Finding.NO_MOTION)])
def test_a_fault_of_odometry_is_found_and_no_other(change, finding):
    """Wrong motions end the program early, before the robot goes far."""
    recording = run_with(good_base(), change)
    assert find_faults(estimate(recording)) == [finding]
    assert recording.commands[-1].time < 20.0
    assert recording.interruption is not None


@pytest.mark.slow
def test_a_clock_that_is_ahead_is_found_and_does_no_harm_to_the_dead_time():
    """Where stamps cannot be compared, arrivals are."""
    base = good_base()
    late = base._replace(robot=dataclasses.replace(base.robot, dead_time=0.15))
    calibration = estimate(run_with(late, ahead))
    assert find_faults(calibration) == [Finding.CLOCK_AHEAD]
    assert calibration.drive.dead_time.value == pytest.approx(0.15, abs=0.02)


@pytest.mark.slow
@pytest.mark.parametrize('change, finding', [
    (lambda item: item._replace(pose=Pose(item.pose.x, -item.pose.y, -item.pose.theta)),
     Finding.TRACKER_MIRRORED),
    (lambda item: item._replace(pose=item.pose._replace(theta=item.pose.theta + 1.0)),
     Finding.TRACKER_HEADING),
    (lambda item: item._replace(pose=Pose(1.1 * item.pose.x, 1.1 * item.pose.y,
                                          item.pose.theta)), Finding.ODOMETRY_ERRS)])
def test_a_fault_of_the_tracker_is_found_and_no_other(good_run, change, finding):
    """Frames that are mirrored or turned, and units that differ."""
    recording = dataclasses.replace(good_run.recording, robot_poses=[
        ReceivedPose(item.arrival, change(item.measured))
        for item in good_run.recording.robot_poses])
    assert find_faults(estimate(recording)) == [finding]


@pytest.mark.slow
def test_an_object_that_moves_as_the_robot_does_is_found(good_run):
    """As one whose pose is in the frame of the robot."""
    rng = np.random.default_rng(1)
    seen = []
    for odometry, robot in zip(good_run.recording.odometry, good_run.poses):
        pose = robot.inverse() @ OBJECT_POSE
        noise = 0.002 * rng.standard_normal(2)
        seen.append(ReceivedPose(odometry.arrival, ObjectPose(
            odometry.arrival, Pose(pose.x + noise[0], pose.y + noise[1], pose.theta))))
    recording = dataclasses.replace(good_run.recording, object_poses=seen)
    assert find_faults(estimate(recording)) == [Finding.OBJECT_MOVES_ALONG]
