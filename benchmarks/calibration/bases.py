"""
Calibration of drawn bases in simulation.

Bases have a dead band before or behind the lag, dead time, lag, steps of speeds, uneven wheels,
and odometry that errs.
"""

from typing import NamedTuple

import numpy as np
from push_base.calibration.estimation import BaseCalibration, estimate
from push_base.calibration.program import CalibrationProgram
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.interval import Interval
from push_model.parameters import RoundRobot
from push_scenario.calibration.simulated import RobotTracker, run_program
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Simulation

# The object stands out of the square.
OBJECT_POSE, ROBOT_POSE = Pose(4.0, 0.0, 0.3), Pose(0.0, 0.0, 0.5)
# Errors that count as right: dead time [s], least speed [m/s], lag and scale (relative).
TOLERANCES = {'dead_time': 0.02, 'least_speed': 0.01, 'time_constant': 0.2, 'scale': 0.005}


class DrawnBase(NamedTuple):
    """
    A base.

    :param nominal: ``RoundRobot`` as its user states it.
    :param robot: ``RoundRobot`` as it is.
    :param imperfections: ``DriveImperfections``.
    :param sensors: ``SensorSettings``.
    """

    nominal: RoundRobot
    robot: RoundRobot
    imperfections: DriveImperfections
    sensors: SensorSettings


def draw_base(seed: int) -> DrawnBase:
    """
    Draw a base.

    :param seed: of the draws; even ones are differential.
    """
    rng = np.random.default_rng([seed, 31])
    drive = 'differential' if seed % 2 == 0 else 'holonomic'
    least = float(rng.choice([0.0, rng.uniform(0.01, 0.09)], p=[0.2, 0.8]))
    is_behind_lag = rng.random() < 0.4
    step = float(rng.choice([0.0, 0.01], p=[0.7, 0.3]))
    nominal = RoundRobot(0.17, drive=drive, max_speed=0.5, max_yaw_rate=1.9,
                         max_acceleration=0.9, max_yaw_acceleration=6.0, time_constant=0.1)
    yaw_least = 2.0 * least if drive == 'holonomic' else 0.0
    before_lag = (0.0, 0.0) if is_behind_lag else (least, yaw_least)
    robot = RoundRobot(0.17, drive=drive, max_speed=0.6, max_yaw_rate=2.5, max_acceleration=0.9,
                       max_yaw_acceleration=6.0,
                       time_constant=float(rng.uniform(0.04, 0.15)),
                       dead_time=float(rng.uniform(0.0, 0.3)), speed_step=step,
                       min_speed=before_lag[0], min_yaw_rate=before_lag[1])
    behind = (least, yaw_least) if is_behind_lag else (0.0, 0.0)
    is_uneven = drive == 'differential' and rng.random() < 0.5
    imperfections = DriveImperfections(left_wheel_factor=0.95 if is_uneven else 1.0,
                                       output_min_speed=behind[0],
                                       output_min_yaw_rate=behind[1])
    sensors = SensorSettings(
        pose_noise=0.002, pose_heading_noise=0.005, pose_latency=0.08,
        odometry_scale=float(rng.choice([-0.01, 0.01])),
        odometry_yaw_scale=float(rng.choice([-0.01, 0.0, 0.01])),
        odometry_heading_drift=float(rng.uniform(-0.01, 0.01)),
        odometry_speed_noise=float(rng.uniform(0.0, 0.005)),
        odometry_yaw_rate_noise=float(rng.uniform(0.0, 0.02)))
    return DrawnBase(nominal, robot, imperfections, sensors)


def simulation_of(base: DrawnBase, seed: int = 0) -> Simulation:
    """
    Put a base into the simulator.

    :param base: ``DrawnBase``.
    :param seed: of its noise.
    """
    settings = SimulationSettings(step=0.005, seed=seed, drive=base.imperfections)
    return Simulation(read_object('box_04'), base.robot, OBJECT_POSE,
                      ROBOT_POSE, settings, base.sensors, interpret=True)


def calibrate(base: DrawnBase, seed: int = 0) -> BaseCalibration:
    """
    Calibrate a base.

    :param base: ``DrawnBase``.
    :param seed: of the noise.
    """
    program = CalibrationProgram(base.nominal)
    run_program(program, simulation_of(base, seed), RobotTracker(base.sensors, seed))
    return estimate(program.recording)


def errors_of(base: DrawnBase,
              calibration: BaseCalibration) -> dict[str, tuple[float, bool]]:
    """
    Compare with the truth.

    :param base: ``DrawnBase``.
    :param calibration: ``BaseCalibration`` of it.
    :return: error, and whether the interval covers the truth, by name.
    """
    drive, errors = calibration.drive, calibration.errors
    assert drive is not None and errors is not None
    truth = base.robot
    least = max(truth.min_speed, base.imperfections.output_min_speed)
    measured: dict[str, tuple[Interval | None, float, float]] = {
        'dead_time': (drive.dead_time, truth.dead_time, 1.0),
        'time_constant': (drive.time_constant, truth.time_constant, truth.time_constant),
        'least_speed': (drive.least_speeds[0], least, 1.0),
        'scale': (errors.scale, base.sensors.odometry_scale, 1.0),
        'yaw_scale': (errors.yaw_scale, base.sensors.odometry_yaw_scale, 1.0),
        'heading_drift': (errors.heading_drift, base.sensors.odometry_heading_drift, 1.0)}
    return {name: (float('nan'), False) if interval is None
            else ((interval.value - value) / unit, interval.covers(value))
            for name, (interval, value, unit) in measured.items()}
