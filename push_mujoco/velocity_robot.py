"""
The planar push in MuJoCo: an object on small feet, and a velocity-controlled cylinder.

Contact and mass centre are at the heights of the object, at floor height where it has none: there
no load shifts from foot to foot.
"""

import math
from typing import Any

import mujoco
from push_dynamics.actuation import chord_velocity, limit_command, track_command
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_mujoco.scene import (
    DEFAULT, Engine, object_part, planar_pose, pusher_part, Room, scene_xml, SETTLING_TIME,
    walls_part,
)

# MuJoCo defines these in an extension module without type stubs.
_mujoco: Any = mujoco


class MujocoPlant:
    """
    The plant in MuJoCo, with the interface of ``push_sim_node.plant.Plant``.

    :param obj: the ``PushedObject``; its outline a disc or a rectangle along the axes, its load
        shares those that equal feet would take.
    :param robot: the ``RoundRobot``; its drive is the plant's.
    :param object_pose: ``Pose`` of the object frame.
    :param robot_pose: ``Pose`` of the robot.
    :param engine: ``Engine``.
    :param steps_per_command: steps between two settings of the robot's velocity.
    :param room: walls that stop the object; the robot passes them.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
                 engine: Engine = DEFAULT, *, steps_per_command: int = 1,
                 room: Room = Room()) -> None:
        self.engine = engine
        self.robot = robot
        self.steps_per_command = steps_per_command
        self.model = _mujoco.MjModel.from_xml_string(
            scene_xml(engine, object_part(obj, engine), pusher_part(obj, robot, engine),
                      walls_part(room, engine, object_pose)))
        self.data = _mujoco.MjData(self.model)
        self.drive = (robot.time_constant, robot.max_acceleration, robot.max_yaw_acceleration)
        self._settle()
        self.set_object_pose(object_pose)
        self.data.qpos[7:10] = robot_pose
        self.twist = Twist()

    def _settle(self) -> None:
        """Let the object sink to its rest on the soft floor, far from the robot."""
        self.data.qpos[7:10] = 5.0, 5.0, 0.0
        _mujoco.mj_step(self.model, self.data, int(round(SETTLING_TIME / self.engine.step)))
        self.data.qvel[:] = 0.0
        self.data.qpos[:2] = 0.0

    def set_object_pose(self, pose: Pose) -> None:
        """
        Put the object elsewhere, at rest.

        :param pose: ``Pose`` of the object frame in the world.
        """
        self.data.qpos[0:2] = pose[:2]
        self.data.qpos[3:7] = math.cos(pose[2] / 2), 0.0, 0.0, math.sin(pose[2] / 2)
        self.data.qvel[0:6] = 0.0

    def advance(self, duration: float, command: Twist) -> None:
        """
        Advance time under a constant command.

        :param duration: how long [s].
        :param command: ``Twist`` for the robot, in its own axes.
        """
        command = limit_command(self.robot, command)
        count = int(round(duration / self.engine.step))
        data, h = self.data, self.engine.step
        while count > 0:
            steps = min(self.steps_per_command, count)
            v_x, v_y, omega, m_x, m_y, m_omega = track_command(
                self.twist.v_x, self.twist.v_y, self.twist.omega, command, self.drive, steps * h)
            self.twist = Twist(v_x, v_y, omega)
            u_x, u_y = chord_velocity(data.qpos[9], m_x, m_y, m_omega, steps * h)
            data.qvel[6:9] = u_x, u_y, m_omega
            _mujoco.mj_step(self.model, data, steps)
            count -= steps

    @property
    def object_pose(self) -> Pose:
        """Pose of the object frame in the world; the angle within +-pi."""
        return planar_pose(self.data.qpos[:7])

    @property
    def object_twist(self) -> Twist:
        """Velocity of the object frame's origin, world axes, and yaw rate."""
        v_x, v_y, _, _, _, omega = self.data.qvel[:6].tolist()
        return Twist(v_x, v_y, omega)

    @property
    def robot_pose(self) -> Pose:
        """Pose of the robot in the world."""
        x, y, theta = self.data.qpos[7:10].tolist()
        return Pose(x, y, theta)

    @property
    def force_on_robot(self) -> tuple[float, float]:
        """Force of the object on the robot (x, y) in the last step, world axes [N]."""
        # Of all constraints only the contact with the object acts on the joints of the robot.
        x, y = self.data.qfrc_constraint[6:8].tolist()
        return x, y

    @property
    def moment_on_robot(self) -> float:
        """Moment of the object on the robot about its axis in the last step [N m]."""
        return float(self.data.qfrc_constraint[8])
