"""The same pushes in the plant and in MuJoCo, and the differences of the final poses."""

import dataclasses
import math
from typing import Callable, NamedTuple, Sequence

from benchmarks.plant.scenes import ORIGIN, robot_without_lag
from push_dynamics.walls import Wall
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import Outline, PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_mujoco.scene import (
    DEFAULT, ELLIPTIC, Engine, HARD, HEAVY_BUMPER, Room, TUNED)
from push_mujoco.velocity_robot import MujocoPlant
from push_sim_node.plant import Plant
from push_sim_node.truth import ContactMode

ENGINES = {'default': DEFAULT, 'heavy bumper': HEAVY_BUMPER, 'elliptic': ELLIPTIC, 'hard': HARD,
           'tuned': TUNED}
# Number of poses along a push; chosen for the figure.
SAMPLES = 20


class PoseDifference(NamedTuple):
    """Distance [m] and absolute angle [rad] between two poses."""

    distance: float
    angle: float


@dataclasses.dataclass(frozen=True)
class Push:
    """
    One push along x, from the object's left side.

    :param kind: 'box', 'square', 'uneven box', 'three feet', 'bin' or 'table'.
    :param mass: [kg].
    :param friction: coefficient of the feet; of an uneven box the mean.
    :param grip: coefficient of friction between robot and object.
    :param offset: of the robot's centre line, to the left [m].
    :param speed: (v_x, v_y) of the robot [m/s].
    :param spin: yaw rate of the robot [rad/s].
    :param radius: of the robot [m].
    :param distance: that the robot drives [m].
    :param contact_height: of the object [m].
    :param center_of_mass_height: of the object [m].
    :param room: walls that stop the object.
    """

    kind: str
    mass: float
    friction: float
    grip: float
    offset: float
    speed: tuple[float, float]
    spin: float = 0.0
    radius: float = 0.17
    distance: float = 0.6
    contact_height: float = 0.0
    center_of_mass_height: float = 0.0
    room: Room = Room()

    @property
    def object(self) -> PushedObject:
        """The ``PushedObject``."""
        return dataclasses.replace(
            OBJECTS[self.kind](self.mass, self.friction, self.grip),
            contact_height=self.contact_height, center_of_mass_height=self.center_of_mass_height)

    @property
    def robot(self) -> RoundRobot:
        """The ``RoundRobot``."""
        return robot_without_lag(self.radius)

    @property
    def command(self) -> Twist:
        """``Twist`` of the robot; a spinning one drives along a wide arc."""
        v_x, v_y = self.speed
        return Twist(v_x, v_y, self.spin)

    @property
    def duration(self) -> float:
        """Duration of the push [s], a multiple of 10 ms."""
        return round(self.distance / math.hypot(*self.speed), 2)

    def robot_pose(self) -> Pose:
        """Return the pose of the robot that touches the object at rest in the origin."""
        offset, obj = self.offset, self.object
        if obj.radius:
            return Pose(-math.sqrt((obj.radius + self.radius) ** 2 - offset ** 2), offset, 0.0)
        return Pose(min(x for x, _ in obj.outline) - self.radius, offset, 0.0)


def rectangle(size: tuple[float, float], positions: Outline, mass: float,
              frictions: Sequence[float], grip: float,
              com: tuple[float, float] = (0.0, 0.0)) -> PushedObject:
    """Return an object with a rectangular outline of a length and a width."""
    length, width = size
    x, y = length / 2, width / 2
    supports = tuple(Support(foot_x, foot_y, mu)
                     for (foot_x, foot_y), mu in zip(positions, frictions))
    return PushedObject(mass=mass, inertia=mass * (length ** 2 + width ** 2) / 12,
                        supports=supports, outline=((-x, -y), (x, -y), (x, y), (-x, y)),
                        center_of_mass=com, contact_friction_coefficient=grip)


def corners(x: float, y: float) -> Outline:
    """Return the corners of a rectangle about the origin."""
    return (-x, -y), (x, -y), (x, y), (-x, y)


def bin_(mass: float, friction: float, grip: float) -> PushedObject:
    """Return a round bin on three feet."""
    angles = [2.0 * math.pi * i / 3 for i in range(3)]
    return PushedObject(mass=mass, inertia=0.5 * mass * 0.2 ** 2, radius=0.2,
                        supports=tuple(Support(0.16 * math.cos(a), 0.16 * math.sin(a), friction)
                                       for a in angles), contact_friction_coefficient=grip)


# Statics determines the loads of three feet; four equal ones around the mass centre share evenly.
OBJECTS: dict[str, Callable[[float, float, float], PushedObject]] = {
    'box': lambda m, mu, grip: rectangle((0.4, 0.4), corners(0.17, 0.17), m, 4 * [mu], grip),
    'square': lambda m, mu, grip: rectangle((0.4, 0.4), corners(0.2, 0.2), m, 4 * [mu], grip),
    'uneven box': lambda m, mu, grip: rectangle(
        (0.4, 0.4), corners(0.17, 0.17), m, [0.8 * mu, 1.3 * mu, 1.1 * mu, 0.8 * mu], grip),
    'three feet': lambda m, mu, grip: rectangle(
        (0.4, 0.4), ((-0.15, -0.12), (-0.15, 0.12), (0.15, 0.0)), m, 3 * [mu], grip,
        (-0.05, 0.0)),
    'bin': bin_,
    'table': lambda m, mu, grip: rectangle((0.5, 0.8), corners(0.2, 0.3), m, 4 * [mu], grip),
}
PUSHES = (
    Push('box', 2.0, 0.3, 0.5, 0.0, (0.05, 0.0)),
    Push('box', 2.0, 0.3, 0.5, 0.02, (0.05, 0.0)),
    Push('box', 2.0, 0.3, 0.5, 0.02, (0.2, 0.0)),
    Push('box', 2.0, 0.3, 0.5, 0.02, (0.5, 0.0)),
    Push('box', 2.0, 0.3, 0.5, 0.02, (1.0, 0.0)),
    Push('box', 8.0, 0.2, 0.8, -0.05, (0.1, 0.0)),
    Push('box', 0.5, 0.5, 0.8, -0.05, (0.1, 0.02)),
    Push('box', 2.0, 0.3, 0.8, 0.05, (0.25, 0.0), radius=0.5),
    Push('box', 2.0, 0.3, 0.8, 0.0, (0.1, 0.0), spin=0.15),
    Push('uneven box', 3.0, 0.3, 0.6, 0.0, (0.05, 0.0)),
    Push('uneven box', 3.0, 0.3, 0.6, 0.02, (0.25, 0.0)),
    Push('uneven box', 3.0, 0.3, 0.6, -0.03, (0.5, 0.05)),
    Push('three feet', 2.0, 0.3, 0.5, 0.02, (0.05, 0.0)),
    Push('three feet', 2.0, 0.4, 0.8, -0.04, (0.2, 0.0)),
    Push('three feet', 5.0, 0.2, 0.8, 0.02, (1.0, 0.0)),
    Push('bin', 3.0, 0.3, 0.5, 0.0, (0.2, 0.0)),
    Push('bin', 3.0, 0.3, 0.5, 0.01, (0.05, 0.0), distance=0.4),
    Push('bin', 6.0, 0.2, 0.5, -0.01, (0.5, 0.0), distance=0.4),
    Push('table', 6.0, 0.4, 0.5, 0.03, (0.05, 0.0)),
    Push('table', 6.0, 0.4, 0.5, -0.08, (0.2, 0.0)),
    Push('table', 12.0, 0.25, 0.7, 0.05, (0.5, 0.0)),
    Push('table', 6.0, 0.4, 0.7, 0.05, (1.0, 0.0), radius=0.3),
    Push('box', 2.0, 0.3, 0.2, -0.08, (0.05, 0.05), distance=0.15),
    Push('box', 2.0, 0.3, 0.2, -0.08, (0.2, 0.2), distance=0.15),
    Push('three feet', 2.0, 0.3, 0.3, 0.1, (0.1, -0.1), distance=0.2),
    Push('table', 6.0, 0.4, 0.3, -0.2, (0.05, 0.05), distance=0.25),
    Push('table', 6.0, 0.4, 0.3, -0.2, (0.4, 0.4), distance=0.25),
)

# Bumpers above the floor, each with the height of the mass centre [m].
RAISED = tuple(
    Push(*push, distance=distance, contact_height=height, center_of_mass_height=center)
    for push, distance in (
        (('square', 2.0, 0.3, 0.8, 0.02, (0.05, 0.0)), 0.3),
        (('uneven box', 2.0, 0.3, 0.8, 0.02, (0.05, 0.0)), 0.3),
        (('three feet', 2.0, 0.3, 0.8, 0.02, (0.05, 0.0)), 0.2),
        (('bin', 3.0, 0.3, 0.8, 0.02, (0.1, 0.0)), 0.2))
    for height, center in ((0.05, 0.1), (0.1, 0.1), (0.2, 0.2)))

# Beside a wall, and towards one at an angle. MuJoCo's robot is not held back: none is wedged.
AT_WALLS = (
    Push('box', 2.0, 0.3, 0.5, -0.05, (0.1, 0.0), room=Room((Wall(-2.0, 0.2, 2.0, 0.2),))),
    Push('box', 2.0, 0.3, 0.5, -0.05, (0.1, 0.0), room=Room((Wall(-2.0, 0.2, 2.0, 0.2),), 0.0)),
    Push('box', 2.0, 0.3, 0.8, 0.0, (0.1, 0.0), room=Room((Wall(0.0, 0.7, 1.5, -0.4),), 0.1)),
    Push('bin', 3.0, 0.3, 0.3, 0.0, (0.1, 0.0), distance=0.4,
         room=Room((Wall(-1.0, 0.32, 2.0, 0.02),), 0.2)),
    Push('table', 6.0, 0.4, 0.5, 0.1, (0.1, 0.0), distance=0.5,
         room=Room((Wall(-2.0, -0.41, 2.0, -0.41),))))


def by_plant(push: Push, step: float = 1e-3) -> tuple[list[Pose], set[ContactMode]]:
    """
    Push in the plant.

    :param push: ``Push``.
    :param step: longest step [s].
    :return: poses of the object at equal times (list of ``Pose``), set of the contact modes.
    """
    plant = Plant(push.object, push.robot, ORIGIN, push.robot_pose(), step,
                  walls=push.room.walls, wall_friction=push.room.friction)
    poses: list[Pose] = []
    modes: set[ContactMode] = set()
    for _ in range(SAMPLES):
        plant.advance(push.duration / SAMPLES, push.command)
        poses.append(plant.object_pose)
        modes.add(plant.truth(0.0).mode)
    return poses, modes


def by_mujoco(push: Push, engine: Engine) -> list[Pose]:
    """
    Push in MuJoCo.

    :param push: ``Push``.
    :param engine: ``Engine``.
    :return: poses of the object at the times of ``by_plant``.
    """
    plant = MujocoPlant(push.object, push.robot, ORIGIN, push.robot_pose(), engine,
                        room=push.room)
    edges = [round(push.duration * i / SAMPLES / engine.step) for i in range(SAMPLES + 1)]
    poses: list[Pose] = []
    for start, end in zip(edges, edges[1:]):
        plant.advance((end - start) * engine.step, push.command)
        poses.append(plant.object_pose)
    return poses


def pose_difference(one: Pose, other: Pose) -> PoseDifference:
    """Return the difference of two poses."""
    return PoseDifference(math.hypot(one.x - other.x, one.y - other.y),
                          abs(wrap_angle(one.theta - other.theta)))
