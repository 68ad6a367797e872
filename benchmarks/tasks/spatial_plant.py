"""The plant of a task in MuJoCo: bodies in space, soft contacts, loads that shift with heights."""

import dataclasses
import math
from typing import Any, ClassVar

from push_model.geometry import Pose
from push_model.parameters import GRAVITY, PushedObject, RoundRobot
from push_model.signals import Twist
from push_mujoco.scene import ELLIPTIC, Engine
from push_mujoco.velocity_robot import MujocoPlant
from push_sim_node.plant import IMMEDIATE_DRIVE, Plant

# Friction of the feet on slopes. By default an object at rest creeps downhill by 0.15 mm/s; much
# stiffer feet chatter. Chosen: less than half of the creep that counts as motion.
HOLDING_FRICTION = 0.006, 1.0


class SpatialPlant(Plant):
    """
    A ``Plant`` that MuJoCo moves; forces, contact mode and energy are not given.

    Contacts are soft, and slip under any tangential force.

    :param obj: the true ``PushedObject``; its outline a disc or a rectangle along the axes.
    :param robot: the true ``RoundRobot``.
    :param object_pose: ``Pose`` of the object frame in the world.
    :param robot_pose: ``Pose`` of the robot in the world.
    :param options: of ``Plant``, without meaning here.
    """

    engine: ClassVar[Engine] = ELLIPTIC

    def __init__(self, obj: PushedObject, robot: RoundRobot, object_pose: Pose, robot_pose: Pose,
                 *options: Any, **more_options: Any) -> None:
        super().__init__(obj, robot, object_pose, robot_pose, *options, **more_options)
        self._engine = MujocoPlant(obj, robot, object_pose, self.robot_pose, self.engine)
        if self._imperfect_drive is not None:
            self._engine.drive = IMMEDIATE_DRIVE

    def set_object_pose(self, pose: Pose) -> None:
        """
        Put the object elsewhere, at rest, as a person would.

        :param pose: ``Pose`` of the object frame in the world.
        :raises ValueError: where it is not finite or the robot is in the way.
        """
        super().set_object_pose(pose)
        self._engine.set_object_pose(pose)

    def _follow(self, duration: float, command: Twist) -> None:
        """Move on while the drive, with its lag and limits, follows a command."""
        engine = self._engine
        engine.advance(duration, command)
        self.stand_at(engine.object_pose, engine.robot_pose)
        self.set_velocities(engine.object_twist, engine.twist)

    def _load_on_robot(self) -> tuple[tuple[float, float], float]:
        """Return force, own axes [N], and moment [N m] of the object on the robot in one step."""
        x, y = Pose(0.0, 0.0, -self.robot_pose.theta).rotate(self._engine.force_on_robot)
        return (float(x), float(y)), self._engine.moment_on_robot


def spatial_plant(angle: float = 0.0, direction: float = 0.0) -> type[SpatialPlant]:
    """
    Return the class of plants on a floor that slopes.

    Poses are those in the plane of the floor.

    :param angle: of the slope [rad].
    :param direction: of the descent, in the world [rad].
    """
    if angle == 0.0:
        return SpatialPlant
    along = GRAVITY * math.sin(angle)
    gravity = (along * math.cos(direction), along * math.sin(direction),
               -GRAVITY * math.cos(angle))

    class SlopedPlant(SpatialPlant):
        """A ``SpatialPlant`` on that floor."""

        engine: ClassVar[Engine] = dataclasses.replace(
            ELLIPTIC, gravity=gravity, floor_friction=HOLDING_FRICTION)

    return SlopedPlant
