"""MuJoCo behind the interface of the simulator's own plant: only what moves the bodies differs."""

import dataclasses
import functools
import math
from typing import Any, Callable, Sequence

import numpy as np
from push_dynamics import actuation
from push_dynamics.actuation import limit_command
from push_dynamics.compiled import interpreted
from push_dynamics.encoding import drive_values
from push_dynamics.step import step_count
from push_dynamics.walls import Wall
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP, Twist
from push_model.wheels import twist_of_wheels
from push_mujoco.lidar import EngineLidar
from push_mujoco.pixel_sensor import Eye, PixelSensor
from push_mujoco.scene import Room
from push_mujoco.simulated_robot import DEFAULT_ROBOTS, read_simulated_robot, SimulatedRobot
from push_mujoco.wheeled_robot import ENGINE, Looks, WheeledPlant
from push_sim_node.lidar import Lidar, LidarSensorSettings
from push_sim_node.plant import IMMEDIATE_DRIVE, Plant
from push_sim_node.sensors import PoseSensor, SensorSettings

# Single calls are not worth compiling them.
track_command = interpreted(actuation.track_command)
chord_velocity = interpreted(actuation.chord_velocity)
# What decides in MuJoCo, and no parameter of a base.
OF_THE_ENGINE = {'wheel_creep': 0.0, 'stall_force': math.inf, 'yaw_stiffness': math.inf}


class WheelOdometry:
    """
    Pose by the ticks of both wheels; the heading by a gyro, where the robot has one.

    ``pose``: ``Pose`` by what was counted, its angle not wrapped.

    :param robot: ``SimulatedRobot``.
    :param pose: of the robot at first.
    """

    def __init__(self, robot: SimulatedRobot, pose: Pose) -> None:
        self.pose = pose
        self._robot = robot
        self._tick = 2.0 * math.pi / robot.ticks_per_turn
        self._counts: tuple[float, float] | None = None

    def count(self, angles: tuple[float, float], rotation: float) -> None:
        """
        Read the ticks, and add the arc that both wheels have gone since.

        :param angles: of the wheels (left, right) [rad].
        :param rotation: of the robot since, as a gyro without errors has it [rad].
        """
        counts = math.floor(angles[0] / self._tick), math.floor(angles[1] / self._tick)
        before = self._counts or counts
        self._counts = counts
        left, right = ((now - then) * self._tick * self._robot.wheel_radius
                       for now, then in zip(counts, before))
        arc = twist_of_wheels(left, right, self._robot.track)
        if self._robot.has_gyro:
            arc = arc._replace(omega=(1.0 + self._robot.gyro_scale) * rotation)
        x, y = chord_velocity(self.pose.theta, *arc, 1.0)
        self.pose = Pose(self.pose.x + x, self.pose.y + y, self.pose.theta + arc.omega)


class EnginePlant(Plant):
    """
    A ``Plant`` that MuJoCo moves; contact mode and energy are not given.

    The robot has the outline, the drive and the base's imperfections that ``Plant`` is given, but
    its wheels slip by the friction and the motors of the ``SimulatedRobot``. Odometry counts the
    ticks of the wheels, with the heading of a gyro where there is one; that of a holonomic base is
    what it is asked for.

    ``engine``: the ``WheeledPlant``.

    :param obj: the true ``PushedObject``.
    :param robot: the true ``RoundRobot``.
    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param step: as of ``Plant``.
    :param smoothing: as of ``Plant``.
    :param simulated_robot: ``SimulatedRobot``; None for the one of the drive.
    :param looks: ``Looks`` for cameras.
    :param eye: ``Eye`` by which the object is seen; None for the errors of ``SensorSettings``.
    :param options: of ``Plant``.
    :raises ValueError: where the robot is no round one of that drive, or the floor has patches.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
                 step: float = 2e-3, smoothing: float = 1e-5, *,
                 simulated_robot: SimulatedRobot | None = None, looks: Looks = Looks(),
                 eye: Eye | None = None, **options: Any) -> None:
        if options.get('floor'):
            raise ValueError('SimulationSettings.floor_patches: got some, expected none in MuJoCo')
        if 'imperfections' in options:
            options['imperfections'] = dataclasses.replace(options['imperfections'],
                                                           **OF_THE_ENGINE)
        super().__init__(obj, dataclasses.replace(robot, max_push_force=math.inf), object_pose,
                         robot_pose, step, smoothing, **options)
        base = simulated_robot or read_simulated_robot(DEFAULT_ROBOTS[robot.drive])
        base = base.shaped_as(robot)
        room = Room(tuple(options.get('walls', ())), options.get('wall_friction', 0.3))
        self.engine = WheeledPlant(base, room, obj, object_pose, self.robot_pose, looks)
        self._drive = drive_values(robot) if self._imperfect_drive is None else IMMEDIATE_DRIVE
        self._asked = STOP
        self._eye = eye
        self._has_gyro = base.drive == 'differential' and base.has_gyro
        self._odometry = WheelOdometry(base, self.robot_pose)
        self._asked_pose = self.robot_pose
        self._foot_pairs = [self.engine.pair_index('floor', f'foot{i}')
                            for i in range(len(obj.supports))]

    def set_friction_factors(self, factors: Sequence[float]) -> None:
        """
        Multiply the friction of the supports.

        :param factors: one factor for each support, of at least 0.
        """
        for index, support, factor in zip(self._foot_pairs, self.obj.supports, factors):
            self.engine.model.pair_friction[index, :2] = factor * support.friction_coefficient

    def set_object_pose(self, pose: Pose) -> None:
        """
        Put the object elsewhere, at rest, as a person would.

        :param pose: ``Pose`` of the object frame in the world.
        :raises ValueError: where it is not finite or the robot is in the way.
        """
        super().set_object_pose(pose)
        self.engine.set_object_pose(pose)

    def make_lidar(self, settings: LidarSensorSettings, walls: Sequence[Wall],
                   noise: np.random.Generator) -> Lidar:
        """Make the lidar of the robot, whose beams MuJoCo traces; see ``Plant``."""
        return EngineLidar(settings, self.obj, self.engine, walls, noise)

    def make_pose_sensor(self, settings: SensorSettings, noise: np.random.Generator,
                         losses: np.random.Generator, outliers: np.random.Generator) -> PoseSensor:
        """Make the sensor of object poses, which takes images where there is an ``Eye``."""
        if self._eye is None:
            return super().make_pose_sensor(settings, noise, losses, outliers)
        return PixelSensor(settings, noise, losses, outliers, eye=self._eye, plant=self.engine)

    def is_bumper_pressed(self, force: float, time: float) -> bool:
        """Tell whether object or wall press the bumper of the robot; see ``Plant``."""
        return self.engine.normal_force('bumper', 'skirt') > force

    @property
    def odometry_pose(self) -> Pose:
        """Pose of the robot by what its wheels turned; the angle is not wrapped."""
        return self._odometry.pose if self.robot.drive == 'differential' else self._asked_pose

    @property
    def odometry_twist(self) -> Twist:
        """Velocity of the robot by what its wheels are asked to turn, and its gyro; own axes."""
        if not self._has_gyro:
            return self._asked
        return self._asked._replace(omega=self.engine.twist.omega)

    def _follow(self, duration: float, command: Twist) -> None:
        """Move on while the motors hold the speeds that the drive, with its lag, asks for."""
        command = limit_command(self.robot, command)
        count = step_count(duration, ENGINE.step)
        step = duration / count
        for _ in range(count):
            before, asked = self._asked, self._asked_pose
            tracked = track_command(before.v_x, before.v_y, before.omega, command, self._drive,
                                    step)
            self._asked = Twist(tracked.end_x, tracked.end_y, tracked.end_omega)
            self.engine.drive(self._asked, step)
            x, y = chord_velocity(asked.theta, tracked.mean_x, tracked.mean_y, tracked.mean_omega,
                                  step)
            self._asked_pose = Pose(asked.x + x * step, asked.y + y * step,
                                    asked.theta + tracked.mean_omega * step)
        robot_pose = _continued(self.robot_pose, self.engine.pose)
        if self.robot.drive == 'differential':
            self._odometry.count(self.engine.wheel_angles,
                                 robot_pose.theta - self.robot_pose.theta)
        self.stand_at(_continued(self.object_pose, self.engine.object_pose), robot_pose)
        self.set_velocities(self.engine.object_twist, self.engine.twist)


def _continued(before: Pose, pose: Pose) -> Pose:
    """Choose the angle of a pose that is nearest to the one of before."""
    return Pose(pose.x, pose.y, before.theta + wrap_angle(pose.theta - before.theta))


def engine_plant(simulated_robot: SimulatedRobot | None = None, looks: Looks = Looks(),
                 eye: Eye | None = None) -> Callable[..., EnginePlant]:
    """
    Return what makes plants in MuJoCo, as ``Simulation`` takes it.

    :param simulated_robot: as of ``EnginePlant``.
    :param looks: likewise.
    :param eye: likewise.
    """
    return functools.partial(EnginePlant, simulated_robot=simulated_robot, looks=looks, eye=eye)
