"""A trial in simulation: a base that drives imperfectly, sensors, and a robot placed by hand."""

import dataclasses
import math

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import LidarScan, ObjectPose, Twist
from push_scenario.recordings.bag import Track
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
from push_sim_node.simulation import Simulation, SimulationSettings
from studies.experiment.trial import read_trial, Trial

# Gap before the first touch [m], and time before the robot starts [s]; chosen: as where somebody
# places it.
GAP = 0.02
REST_TIME = 0.5
# Sensors of the benchmarks: poses as of a camera on the ceiling, odometry of wheels.
SENSORS = SensorSettings(pose_rate=20.0, pose_noise=2e-3, pose_heading_noise=math.radians(0.3),
                         pose_latency=0.08, pose_drop_probability=0.05,
                         odometry_scale_noise=0.02, odometry_heading_drift_noise=0.02)


@dataclasses.dataclass(frozen=True)
class SimulatedPush:
    """
    A straight push at the rear face of a box, with what is drawn for it.

    :param obj: the box as it is believed to be.
    :param robot: the robot.
    :param speed: that is commanded [m/s].
    :param length: driven from the first touch [m].
    :param rotation_deviation: standard deviation of the rotation of the box as it is placed [rad].
    :param lateral_deviation: of the robot to the side [m].
    :param friction_deviation: of the friction at each foot, relative.
    :param wheel_deviation: of the speed of the left wheel of a differential drive, relative.
    :param seed: of all draws.
    """

    obj: PushedObject
    robot: RoundRobot
    speed: float
    length: float
    rotation_deviation: float
    lateral_deviation: float
    friction_deviation: float
    wheel_deviation: float
    seed: int

    def run(self) -> Trial:
        """Drive straight at the box, and measure its rotation."""
        rng = np.random.default_rng(self.seed)
        rotation, lateral = rng.normal(0.0, (self.rotation_deviation, self.lateral_deviation))
        factors = rng.normal(1.0, self.friction_deviation, len(self.obj.supports)).tolist()
        wheel_factor = float(rng.normal(1.0, self.wheel_deviation))
        true = dataclasses.replace(self.obj, supports=tuple(
            dataclasses.replace(foot, friction_coefficient=factor * foot.friction_coefficient)
            for foot, factor in zip(self.obj.supports, factors)))
        settings = SimulationSettings(seed=self.seed, drive=DriveImperfections(
            left_wheel_factor=wheel_factor if self.robot.drive == 'differential' else 1.0))
        simulation = Simulation(true, self.robot, Pose(0.0, 0.0, float(rotation)),
                                self._robot_start(float(rotation), float(lateral)), settings,
                                SENSORS)
        return read_trial(*_drive(simulation, Twist(self.speed),
                                  REST_TIME + (self.length + GAP) / self.speed))

    def _robot_start(self, rotation: float, lateral: float) -> Pose:
        """Place the robot behind the middle of the rear face, with a gap, heading along x."""
        rear = min(x for x, _ in self.obj.outline)
        x, y = Pose(0.0, 0.0, rotation).rotate((rear, 0.0))
        away = self.robot.radius / math.cos(rotation) + GAP
        return Pose(x - away, y + lateral, 0.0)


def _drive(simulation: Simulation, command: Twist, end: float) -> tuple[Track, Track]:
    """Stand, then drive until the end; return the measured tracks of robot and object."""
    robot: list[tuple[float, ...]] = []
    obj: list[tuple[float, ...]] = []
    while simulation.time < end:
        measurement = simulation.next_measurement()
        if isinstance(measurement, LidarScan):
            continue
        row = (measurement.time, *measurement.pose)
        if isinstance(measurement, ObjectPose):
            obj.append(row)
        else:
            robot.append(row)
            simulation.command(command if simulation.time >= REST_TIME else Twist(0.0))
    return _track(np.array(robot)), _track(np.array(obj))


def _track(rows: FloatArray) -> Track:
    rows[:, 3] = np.unwrap(rows[:, 3])
    return Track(rows[:, 0], rows[:, 1:])
