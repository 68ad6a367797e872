"""Touches by drawn robots: radii that are not as stated, and trackers that are off."""

import dataclasses
from typing import NamedTuple

import numpy as np
from push_base.calibration.estimation import BaseCalibration, estimate
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.touch_program import TouchPlan
from push_model.files.parameter_files import read_object
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose
from push_scenario.calibration.simulated import RobotTracker, run_program
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
from push_sim_node.settings import SimulationSettings
from push_sim_node.simulation import Measurement, Simulation

# The robot, and the object ahead of it.
ROBOT_POSE, OBJECT_POSE = Pose(0.0, 0.0, 0.5), Pose(1.3, 0.7, 0.6)
SENSORS = SensorSettings(pose_noise=0.002, pose_heading_noise=0.005, pose_latency=0.08)
ROBOT = RoundRobot(0.17, max_speed=0.5, max_yaw_rate=1.9, max_acceleration=0.9)
# Greatest errors that are drawn [m], chosen: what a tape measure and a marker err by.
MAX_ERROR = 0.012
# Errors that count as right [m].
TOLERANCE = 0.003


class DrawnTouch(NamedTuple):
    """
    A touch.

    :param obj: the ``PushedObject``.
    :param robot: nominal ``RoundRobot``.
    :param true_robot: ``RoundRobot`` as it is.
    :param offset: of the object poses, object frame (x, y) [m].
    :param stamp_delay: by which stamps are later than what they measure [s].
    :param wheel_creep: as of ``DriveImperfections`` [1/N].
    :param sides: that are touched.
    :param has_tracker: whether ``robot_pose`` is measured.
    """

    obj: PushedObject
    robot: RoundRobot
    true_robot: RoundRobot
    offset: tuple[float, float] = (0.0, 0.0)
    stamp_delay: float = 0.0
    wheel_creep: float = 0.0
    sides: int = 2
    has_tracker: bool = True


def good_touch(**changes: object) -> DrawnTouch:
    """
    Return a touch at which all is as stated.

    :param changes: of its fields.
    """
    touch = DrawnTouch(read_object('box_04'), ROBOT, ROBOT)
    return touch._replace(**changes)


def draw_touch(seed: int) -> DrawnTouch:
    """
    Draw a touch from two sides.

    :param seed: of the draws; even ones are differential.
    """
    rng = np.random.default_rng([seed, 32])
    error, x, y = rng.uniform(-MAX_ERROR, MAX_ERROR, 3).tolist()
    robot = dataclasses.replace(
        ROBOT, drive='differential' if seed % 2 == 0 else 'holonomic',
        dead_time=float(rng.uniform(0.0, 0.3)), time_constant=float(rng.uniform(0.04, 0.15)))
    return good_touch(robot=robot, offset=(x, y),
                      true_robot=dataclasses.replace(robot, radius=robot.radius + error))


class _ShiftedPoses(Simulation):
    """Simulation whose object poses are off, and stamped late."""

    offset: Pose = Pose(0.0, 0.0, 0.0)
    stamp_delay: float = 0.0

    def next_measurement(self) -> Measurement:
        """Let time pass until the next measurement is delivered."""
        measured = super().next_measurement()
        if not isinstance(measured, ObjectPose):
            return measured
        return measured._replace(pose=measured.pose @ self.offset,
                                 time=measured.time + self.stamp_delay)


def touch_object(touch: DrawnTouch, seed: int = 0) -> tuple[BaseCalibration, Simulation]:
    """
    Drive a touch.

    :param touch: ``DrawnTouch``.
    :param seed: of the noise.
    :return: what it tells, and the simulation at its end.
    """
    settings = SimulationSettings(step=0.005, seed=seed,
                                  drive=DriveImperfections(wheel_creep=touch.wheel_creep))
    simulation = _ShiftedPoses(touch.obj, touch.true_robot, OBJECT_POSE, ROBOT_POSE, settings,
                               SENSORS, interpret=True)
    simulation.offset = Pose(*touch.offset, 0.0)
    simulation.stamp_delay = touch.stamp_delay
    program = CalibrationProgram(touch.robot, touch=TouchPlan(touch.obj, touch.sides, True))
    run_program(program, simulation, RobotTracker(SENSORS, seed) if touch.has_tracker else None)
    return estimate(program.recording), simulation


def errors_of_touch(touch: DrawnTouch, calibration: BaseCalibration) -> dict[str, float]:
    """
    Compare with the truth.

    :param touch: ``DrawnTouch``.
    :param calibration: ``BaseCalibration`` of it.
    :return: errors by name [m]; nan where nothing was found.
    """
    result = calibration.touches
    if result is None or result.size_error is None or result.pose_offset is None:
        return {'size': float('nan'), 'offset': float('nan')}
    direction = result.touches[0].direction
    along = float(np.dot(touch.offset, (np.cos(direction), np.sin(direction))))
    return {'size': result.size_error.value - (touch.true_robot.radius - touch.robot.radius),
            'offset': result.pose_offset.value - along}
