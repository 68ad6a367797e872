"""Plans of straight pushes, as the plant drives them, and the primitives behind them."""

import dataclasses
import math

import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Twist
from push_model.trajectory import PushLine, PushStyle, PushTrajectory
from push_primitives.cost_settings import CostSettings
from push_primitives.face_points import face_points
from push_primitives.store import load_primitives
from push_sim_node.plant import Plant

# A drive that follows its commands at once.
IDEAL = RoundRobot(radius=0.17, max_speed=1.0, max_acceleration=50.0, max_yaw_acceleration=500.0,
                   time_constant=1e-3)
# Distance between two samples of a plan [m].
SPACING = 0.01


def straight_push(obj, start, length, curvature=0.0, object_pose=Pose(0.0, 0.0, 0.0),
                  speed=0.15):
    """
    Simulate a push along an arc.

    :param start: ``Pose`` of the robot at first contact, heading along the push, object frame.
    :return: ``PushTrajectory`` of style ``STRAIGHT``.
    """
    plant = Plant(obj, IDEAL, object_pose, object_pose @ start)
    count = max(2, math.ceil(length / SPACING))
    command = Twist(speed, 0.0, speed * curvature)
    plant.set_velocities(Twist(0.0, 0.0, 0.0), command)
    rows = [_row(plant, obj)]
    for _ in range(count):
        plant.advance(length / count / speed, command)
        rows.append(_row(plant, obj))
    times = np.arange(count + 1) * length / count / speed
    poses = [np.array(column) for column in zip(*rows)]
    for angles in poses:
        angles[:, 2] = np.unwrap(angles[:, 2])
    twists = [np.gradient(column, times, axis=0) for column in poses]
    columns = [column for pair in zip(poses, twists) for column in pair]
    line = PushLine(start, curvature, length, _face(obj, poses[1][0, :2] - object_pose[:2],
                                                    object_pose))
    return PushTrajectory(times, *columns, style=PushStyle.STRAIGHT, line=line)


def _face(obj, arm, object_pose):
    """Find the face of the point that is nearest to the first contact."""
    contact = Pose(0.0, 0.0, -object_pose.theta).rotate(arm)
    return min(face_points(obj), key=lambda point: math.dist(point.position, contact)).face


def _row(plant, obj):
    """Poses of object, contact and robot."""
    robot = plant.robot_pose
    normal = find_contact(obj, plant.object_pose, robot[:2], IDEAL.radius).gamma
    point = (robot.x + IDEAL.radius * math.cos(normal), robot.y + IDEAL.radius * math.sin(normal))
    return plant.object_pose, (*point, normal), robot


def open_floor_primitives(obj, drive='differential', speed=0.3):
    """Load what a robot of this drive and speed knows of pushes, with the usual tolerances."""
    supervision = SupervisionSettings()
    return load_primitives(obj, dataclasses.replace(IDEAL, drive=drive), CostSettings(
        position_tolerance=supervision.position_tolerance,
        heading_tolerance=supervision.heading_tolerance, robot_speed=speed, drive=drive))
