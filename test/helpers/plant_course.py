"""A course of commands that a plant is driven through, with what is true along the way."""

from typing import Any, Iterable, Sequence

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP, Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import Truth

UNEVEN = {'friction': (0.2, 0.4, 0.3, 0.25), 'center_of_mass': (0.02, -0.03)}
HOLONOMIC = RoundRobot(0.17, 'holonomic', max_acceleration=3.0)
COMMANDS = [Twist(0.3, 0.05, 0.5), Twist(0.3, -0.3, -1.0), Twist(0.0, 0.0, 2.0),
            Twist(0.4, 0.0, 0.3), STOP, Twist(0.2, 0.1, -0.4)]


def plant_of(obj: PushedObject, object_pose: Iterable[float], robot_pose: Iterable[float],
             **settings: Any) -> Plant:
    """Return a plant whose poses are given by numbers."""
    return Plant(obj, HOLONOMIC, Pose(*object_pose), Pose(*robot_pose), **settings)


def course(plant: Plant, commands: Sequence[Twist] = COMMANDS, seconds: float = 0.7,
           samples: int = 7) -> list[Truth]:
    """Drive through the commands; return the truths along the way."""
    truths = []
    for i, command in enumerate(commands):
        for k in range(samples):
            plant.advance(seconds / samples, command)
            truths.append(plant.truth(i + (k + 1) / samples))
    return truths


def poses(truths: Iterable[Truth]) -> FloatArray:
    """Return object and robot poses, shape (n, 6)."""
    return np.array([(*t.object_pose, *t.robot_pose) for t in truths])


def forces(truths: Iterable[Truth]) -> FloatArray:
    """Return the contact forces, normal and tangential, shape (n, 2)."""
    return np.array([(t.force_n, t.force_t) for t in truths])
