"""Twelve pushes of about a metre over every kind of contact, to measure errors of a time step."""

import dataclasses
import math
from typing import Protocol

from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_sim_node.plant import Plant

ORIGIN = Pose(0.0, 0.0, 0.0)
SQUARE = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
FEET = ((-0.17, -0.17), (0.17, -0.17), (0.17, 0.17), (-0.17, 0.17))
# Of the robot [m]: that of config/robots/holonomic_017.yaml.
RADIUS = 0.17
# Lever by which rotations enter the error [m]: half the width of the square.
LEVER = 0.2
Commands = tuple[tuple[float, Twist], ...]


def robot_without_lag(radius: float) -> RoundRobot:
    """
    Make a robot that two engines move the same way: it ramps up at 2 m/s^2, without a lag.

    :param radius: [m].
    """
    return RoundRobot(radius, 'holonomic', max_speed=2.0, max_yaw_rate=4.0, max_acceleration=2.0,
                      max_yaw_acceleration=10.0, time_constant=0.0)


class MovingObject(Protocol):
    """What a scene moves: the plant, or anything with the same interface."""

    @property
    def object_pose(self) -> Pose:
        """Pose of the object in the world."""
        ...

    def advance(self, duration: float, command: Twist) -> None:
        """Advance time under a constant command."""


@dataclasses.dataclass(frozen=True)
class Scene:
    """
    An object at the origin and a robot that follows commands.

    :param name: what the scene shows.
    :param grip: coefficient of friction between robot and object.
    :param robot_pose: of the robot at the start.
    :param commands: (duration [s], ``Twist``), one after another.
    :param load_fractions: of the feet, relative to each other.
    :param radius: of the robot [m].
    """

    name: str
    grip: float
    robot_pose: Pose
    commands: Commands
    load_fractions: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    radius: float = RADIUS

    @property
    def object(self) -> PushedObject:
        """The ``PushedObject``: a square of 2 kg on four feet, its mass centre by the loads."""
        total = sum(self.load_fractions)
        x, y = (sum(fraction * foot[i] for fraction, foot in zip(self.load_fractions, FEET))
                / total for i in (0, 1))
        supports = tuple(Support(foot_x, foot_y, 0.3, fraction)
                         for (foot_x, foot_y), fraction in zip(FEET, self.load_fractions))
        return PushedObject(mass=2.0, inertia=2.0 * 0.16 / 6, supports=supports, outline=SQUARE,
                            center_of_mass=(x, y), contact_friction_coefficient=self.grip)

    @property
    def robot(self) -> RoundRobot:
        """The ``RoundRobot``."""
        return robot_without_lag(self.radius)

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return sum(seconds for seconds, _ in self.commands)

    def plant(self, step: float) -> Plant:
        """Return a ``Plant`` at the start."""
        return Plant(self.object, self.robot, ORIGIN, self.robot_pose, step)

    def end(self, plant: MovingObject) -> Pose:
        """Run a plant to the end; return the object's pose."""
        for seconds, command in self.commands:
            plant.advance(seconds, command)
        return plant.object_pose


def face(offset: float, gap: float = 0.0) -> Pose:
    """Return the pose of a robot at the left face."""
    return Pose(-0.2 - RADIUS - gap, offset, 0.0)


def vertex(normal: float) -> Pose:
    """Return the pose of a robot at the lower left vertex, for a direction of the normal."""
    return Pose(-0.2 - RADIUS * math.cos(normal), -0.2 - RADIUS * math.sin(normal), 0.0)


def straight(speed: float, angle: float = 0.0, distance: float = 1.0) -> Commands:
    """Return one command that drives straight over a distance."""
    return ((round(distance / speed, 2),
             Twist(speed * math.cos(angle), speed * math.sin(angle), 0.0)),)


def spinning(speed: float, rate: float) -> Commands:
    """Return commands, in robot axes, that drive along x of the world while the robot spins."""
    return tuple((0.05, Twist(speed * math.cos(rate * t), -speed * math.sin(rate * t), rate))
                 for t in (0.05 * i + 0.025 for i in range(round(1.0 / speed / 0.05))))


SCENES = (
    Scene('face, sticking', 1.0, face(0.01), straight(0.25)),
    Scene('face, rolling to the edge', 1.5, face(0.06), straight(0.25)),
    Scene('0.05 m/s', 1.0, face(0.01), straight(0.05)),
    Scene('1 m/s', 1.0, face(0.02), straight(1.0)),
    Scene('face, sliding', 0.2, face(-0.1), straight(0.25, 0.35)),
    Scene('vertex, sticking', 1.0, vertex(0.75), straight(0.25, 0.8)),
    Scene('vertex, sliding', 0.15, vertex(0.5), straight(0.25, 0.95)),
    Scene('first impact', 0.6, face(0.03, 0.1), straight(0.4, 0.05)),
    Scene('round a corner', 0.4, face(0.13), straight(0.25)),
    Scene('spin', 0.5, face(0.0), spinning(0.25, 0.6)),
    Scene('arc with spin', 0.8, face(0.0), ((4.0, Twist(0.25, 0.03, 0.15)),)),
    Scene('stop and go, uneven loads', 0.6, face(0.02),
          tuple((0.8, Twist(speed, 0.0, 0.0)) for speed in (0.4, 0.0, 0.4, 0.0, 0.4, 0.0)),
          (1.0, 2.0, 1.5, 0.7)),
)


def apart(one: Pose, other: Pose) -> float:
    """Return the error of the outline [m]: distance, plus rotation times half the width."""
    return (math.hypot(one.x - other.x, one.y - other.y)
            + LEVER * abs(wrap_angle(one.theta - other.theta)))


def extrapolated(fine: Pose, finer: Pose) -> Pose:
    """Extrapolate to a step of 0, from a step and half of it (Richardson, first order)."""
    return Pose(2.0 * finer.x - fine.x, 2.0 * finer.y - fine.y, 2.0 * finer.theta - fine.theta)
