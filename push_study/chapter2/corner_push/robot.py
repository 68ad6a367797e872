"""A round robot that pushes the box at a corner in the contact simulation."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_sim_node.plant import Plant

STEP = 2e-3


def push_by_robot(obj, direction, speed, radius, duration, acceleration=3.0):
    """
    Push from rest; the robot stands behind vertex 0 in the push and turns as the box turns.

    Its velocity is set every step so that its surface at the corner moves as wanted.

    :param obj: the ``PushedObject``, at the origin.
    :param direction: of the push in the object frame [rad].
    :param speed: of the contact [m/s].
    :param radius: of the robot [m], above 0.
    :param duration: how long [s].
    :param acceleration: of the robot, up to the speed and after [m/s^2].
    :return: list of ``Truth``, one per step.
    """
    robot = RoundRobot(radius, 'holonomic', max_speed=10.0, max_yaw_rate=50.0,
                       max_acceleration=acceleration, max_yaw_acceleration=1000.0,
                       time_constant=0.0)
    behind = Pose(*obj.outline[0], direction).transform((-radius, 0.0))
    plant = Plant(obj, robot, Pose(0.0, 0.0, 0.0), Pose(*behind, direction), STEP)
    truths = []
    for number in range(round(duration / STEP)):
        plant.advance(STEP, _command(plant, direction, speed))
        truths.append(plant.truth((number + 1) * STEP))
    return truths


def _command(plant, direction, speed):
    pose, omega, robot = plant.object_pose, plant.object_twist[2], plant.robot_pose
    ahead = pose.theta + direction
    arm_x, arm_y = np.subtract(pose.transform(plant.obj.outline[0]), robot[:2])
    velocity = (speed * math.cos(ahead) + omega * arm_y, speed * math.sin(ahead) - omega * arm_x)
    return Twist(*Pose(0.0, 0.0, -robot.theta).rotate(velocity), omega)
