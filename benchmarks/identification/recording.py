"""Recordings of pushes of the plant: poses of a robot and an object over time, with noise."""

import math
from typing import Any

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_scenario.recordings.bag import Track
from push_sim_node.plant import Plant

# Contact face, offset from its middle [m] and direction from its normal [rad] of ten pushes:
# beside the middle, and inclined so that some slide.
PUSHES = ((0, 0.1, 0.0), (1, -0.1, 0.2), (2, 0.12, -0.3), (3, -0.12, 0.0), (0, -0.05, 0.7),
          (1, 0.05, -0.7), (2, 0.0, 0.75), (3, 0.08, -0.7), (0, -0.12, 0.3), (2, -0.1, 0.1))
SPEED = 0.05
LENGTH = 0.15
RATE = 20.0
REST_TIME = 1.6


def record_pushes(obj: PushedObject, robot: RoundRobot, rng: np.random.Generator, *,
                  noise: float = 1e-3, heading_noise: float = 3e-3) -> tuple[Track, Track]:
    """
    Push a box on all sides in the plant; return tracks of robot and object, a path in air between.

    :param obj: the true object, with an outline.
    :param robot: a holonomic robot.
    :param rng: of the noise of object poses.
    :param noise: standard deviation of their position [m].
    :param heading_noise: of their heading [rad].
    """
    rows: list[tuple[float, ...]] = []
    pose, time = Pose(0.0, 0.0, 0.0), 0.0
    for face, offset, angle in PUSHES:
        (x_0, y_0), (x_1, y_1) = obj.outline[face], obj.outline[(face + 1) % len(obj.outline)]
        along = math.atan2(y_1 - y_0, x_1 - x_0)
        normal = along + 0.5 * math.pi
        point = (0.5 * (x_0 + x_1) + offset * math.cos(along),
                 0.5 * (y_0 + y_1) + offset * math.sin(along))
        back = robot.radius + 0.01
        center = pose.transform((point[0] - back * math.cos(normal),
                                 point[1] - back * math.sin(normal)))
        plant = Plant(obj, robot, pose, Pose(*center, pose.theta + normal + angle), 2e-3)
        for command, duration in ((0.0, REST_TIME), (SPEED, LENGTH / SPEED), (0.0, REST_TIME)):
            for _ in range(round(duration * RATE)):
                plant.advance(1.0 / RATE, Twist(command))
                time += 1.0 / RATE
                rows.append((time, *plant.robot_pose, *plant.object_pose))
        pose = plant.object_pose
    table: Any = np.array(rows)
    measured = table[:, 4:] + rng.standard_normal((len(table), 3)) * (noise, noise, heading_noise)
    measured[:, 2] = np.unwrap(measured[:, 2])
    return Track(table[:, 0], table[:, 1:4]), Track(table[:, 0], measured)
