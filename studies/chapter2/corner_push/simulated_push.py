"""A round robot that pushes the box at a corner in the contact simulation."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant
from push_sim_node.truth import Truth

# Chosen: integration step of the simulation, at which rates agree to 1e-4 [s].
STEP = 2e-3


def push_by_robot(obj: PushedObject, direction: float, speed: float, radius: float,
                  duration: float) -> list[Truth]:
    """
    Push from rest; the robot is behind vertex 0 and rotates with the box.

    Its velocity is set every step so that its surface at the corner moves as requested.

    :param obj: the object, at the origin.
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s].
    :param radius: of the robot [m], above 0.
    :param duration: of the push [s].
    :return: the state after each step.
    """
    # Far more agile than the push needs, so that its limits play no part but in the start.
    robot = RoundRobot(radius, 'holonomic', max_speed=10.0, max_yaw_rate=50.0,
                       max_acceleration=3.0, max_yaw_acceleration=1000.0, time_constant=0.0)
    behind = Pose(*obj.outline[0], direction).transform((-radius, 0.0))
    plant = Plant(obj, robot, Pose(0.0, 0.0, 0.0), Pose(*behind, direction), STEP)
    truths: list[Truth] = []
    for step in range(round(duration / STEP)):
        plant.advance(STEP, _command(plant, direction, speed))
        truths.append(plant.truth((step + 1) * STEP))
    return truths


def _command(plant: Plant, direction: float, speed: float) -> Twist:
    """Find the robot's twist for which the point at the corner has the requested velocity."""
    pose, omega, robot = plant.object_pose, plant.object_twist[2], plant.robot_pose
    forward = pose.theta + direction
    arm_x, arm_y = np.subtract(pose.transform(plant.obj.outline[0]), robot[:2])
    velocity = (speed * math.cos(forward) + omega * arm_y,
                speed * math.sin(forward) - omega * arm_x)
    return Twist(*Pose(0.0, 0.0, -robot.theta).rotate(velocity), omega)
