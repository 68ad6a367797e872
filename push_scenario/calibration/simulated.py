"""Calibration of a simulated base, in one process."""

from collections.abc import Callable

import numpy as np
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording import ReceivedPose
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation


class RobotTracker:
    """Measures the robot in the world, with rate and errors of the object poses."""

    def __init__(self, sensors: SensorSettings, seed: int) -> None:
        """
        Start before the first measurement.

        :param seed: of its noise.
        """
        self._sensors = sensors
        self._noise = np.random.default_rng([seed, 1])
        self._due = 0.0

    def measure(self, time: float, pose: Pose) -> ObjectPose | None:
        """
        Take a measurement, where one is due.

        :param time: now [s].
        """
        if time < self._due - 1e-9:
            return None
        self._due += 1.0 / self._sensors.pose_rate
        e_x, e_y, e_theta = self._noise.standard_normal(3).tolist()
        noise, heading_noise = self._sensors.pose_noise, self._sensors.pose_heading_noise
        return ObjectPose(time, Pose(pose.x + noise * e_x, pose.y + noise * e_y,
                                     wrap_angle(pose.theta + heading_noise * e_theta)))


def run_program(program: CalibrationProgram, simulation: Simulation,
                tracker: RobotTracker | None = None,
                progress: Callable[[float], None] = lambda time: None) -> None:
    """
    Run a program to its end.

    :param simulation: ``Simulation`` in which the base is.
    :param tracker: ``RobotTracker``; None for none.
    :param progress: takes the time [s], at each odometry.
    """
    recording = program.recording
    while not program.is_done:
        measured = simulation.next_measurement()
        time = simulation.time
        if isinstance(measured, Odometry):
            simulation.command(program.step(time, measured))
            pose = None if tracker is None else tracker.measure(time, simulation.plant.robot_pose)
            if pose is not None:
                recording.robot_poses.append(ReceivedPose(time, pose))
            progress(time)
        elif isinstance(measured, ObjectPose):
            recording.object_poses.append(ReceivedPose(time, measured))
