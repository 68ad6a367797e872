"""Twelve pushes over every kind of contact, about a metre each, to judge a time step by."""

import dataclasses
import math

from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot, Support
from push_model.signals import Twist
from push_sim_node.plant import Plant

ORIGIN = Pose(0.0, 0.0, 0.0)
SQUARE = ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))
FEET = ((-0.17, -0.17), (0.17, -0.17), (0.17, 0.17), (-0.17, 0.17))
RADIUS = 0.17
LEVER = 0.2


@dataclasses.dataclass(frozen=True)
class Scene:
    """
    An object at the origin and a robot that follows commands.

    :param name: what it shows.
    :param grip: friction between robot and object.
    :param robot_pose: where the robot starts.
    :param commands: (duration [s], ``Twist``), one after another.
    :param shares: load shares of the feet.
    :param radius: of the robot [m].
    """

    name: str
    grip: float
    robot_pose: Pose
    commands: tuple
    shares: tuple = (1.0, 1.0, 1.0, 1.0)
    radius: float = RADIUS

    @property
    def object(self):
        """The ``PushedObject``: a square of 2 kg on four feet, its mass centre above the loads."""
        total = sum(self.shares)
        middle = tuple(sum(share * place[i] for share, place in zip(self.shares, FEET)) / total
                       for i in (0, 1))
        supports = [Support(*place, 0.3, share) for place, share in zip(FEET, self.shares)]
        return PushedObject(mass=2.0, inertia=2.0 * 0.16 / 6, supports=supports, outline=SQUARE,
                            center_of_mass=middle, contact_friction_coefficient=self.grip)

    @property
    def robot(self):
        """The ``RoundRobot``: it ramps up at 2 m/s^2."""
        return RoundRobot(self.radius, 'holonomic', 2.0, 4.0, 2.0, 10.0, 0.0)

    @property
    def duration(self):
        """Length [s]."""
        return sum(seconds for seconds, _ in self.commands)

    def plant(self, step):
        """Return a ``Plant`` at the start."""
        return Plant(self.object, self.robot, ORIGIN, self.robot_pose, step)

    def end(self, plant):
        """Run a plant, or whatever moves as one, to the end; return the object's pose."""
        for seconds, command in self.commands:
            plant.advance(seconds, command)
        return plant.object_pose


def face(offset, gap=0.0):
    """Return a robot's pose before the left face."""
    return Pose(-0.2 - RADIUS - gap, offset, 0.0)


def vertex(normal):
    """Return a robot's pose at the lower left vertex, for a normal of that angle."""
    return Pose(-0.2 - RADIUS * math.cos(normal), -0.2 - RADIUS * math.sin(normal), 0.0)


def straight(speed, angle=0.0, distance=1.0):
    """Return one command that goes a metre."""
    return ((round(distance / speed, 2),
             Twist(speed * math.cos(angle), speed * math.sin(angle), 0.0)),)


def spinning(speed, rate):
    """Return commands that drive along x while the robot spins, its own axes turning."""
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


def apart(one, other):
    """Return how far the object's outline is off [m]: distance, and turn at its half width."""
    return (math.hypot(one.x - other.x, one.y - other.y)
            + LEVER * abs(wrap_angle(one.theta - other.theta)))


def extrapolated(fine, finer):
    """Return the pose for a step of 0, from that of a step and of half of it (first order)."""
    return Pose(*(2.0 * b - a for a, b in zip(fine, finer)))
