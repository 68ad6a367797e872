"""What a late base will do: against the plant, and paths that are followed by it."""

import dataclasses
import math

import numpy as np
from push_base.base_model import BaseModel
from push_model.geometry import distance, Pose
from push_model.parameters import RoundRobot
from push_model.signals import STOP, Twist
from push_navigation.path import differential_path, holonomic_path, Waypoint
from push_navigation.path_follower import PathFollower
from push_navigation.settings import DriveSettings
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.imperfect_drive import ImperfectDrive
import pytest

PERIOD = 0.02
DRIVES = 'differential', 'holonomic'
ORIGIN = Pose(0.0, 0.0, 0.0)


def robot_of(drive, dead_time):
    """Return a robot whose acceleration is not limited."""
    return RoundRobot(0.17, drive=drive, max_speed=1.0, max_yaw_rate=4.0, time_constant=0.08,
                      max_acceleration=100.0, max_yaw_acceleration=1000.0, dead_time=dead_time)


def driven(base, command):
    """Let a base drive for a period."""
    base.command(command)
    for _ in range(10):
        base.step(0.1 * PERIOD, (0.0, 0.0))


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('dead_time', [0.1, 0.2, 0.3])
def test_the_motion_ahead_is_what_the_plant_does(drive, dead_time):
    """Whatever is commanded from now on, the plant goes there by then."""
    rng = np.random.default_rng(7)
    robot = robot_of(drive, dead_time)
    model, base = BaseModel(robot), ImperfectDrive(robot, DriveImperfections(), ORIGIN, 1.0)
    predictions, poses, twists = [], [], []
    for k in range(150):
        if k % 5 == 0:
            v_x, v_y, omega = rng.uniform(-0.4, 0.4, 3).tolist()
            command = Twist(v_x, v_y if drive == 'holonomic' else 0.0, 3.0 * omega)
        poses.append(base.odometry_pose)
        predicted = model.predict(base.odometry_twist, PERIOD * k)
        predictions.append((base.odometry_pose @ predicted.displacement, predicted.velocity))
        twists.append(base.odometry_twist)
        model.add_command(command, PERIOD * k)
        driven(base, command)
    shift = round(dead_time / PERIOD)
    for k in range(50, 150 - shift):
        predicted, velocity = predictions[k]
        assert distance(predicted, poses[k + shift]) < 2e-3
        assert predicted.theta == pytest.approx(poses[k + shift].theta, abs=0.02)
        assert velocity[:2] == pytest.approx(twists[k + shift][:2], abs=0.02)


def test_without_dead_time_nothing_is_ahead():
    """The velocity is the measured one itself, and nothing is under way."""
    model, velocity = BaseModel(robot_of('holonomic', 0.0)), Twist(0.3, 0.1, 1.0)
    model.add_command(Twist(0.5, 0.0, 0.0), 0.0)
    displacement, predicted = model.predict(velocity, 0.1)
    assert displacement == ORIGIN and predicted is velocity
    assert not model.has_pending_motion(0.1)


def test_a_command_is_under_way_for_the_dead_time():
    """From its sending on, and no longer; a clock that falls back forgets it."""
    model = BaseModel(robot_of('differential', 0.2))
    assert not model.has_pending_motion(0.0)
    model.add_command(Twist(0.5, 0.0, 0.0), 1.0)
    model.add_command(STOP, 1.1)
    assert model.has_pending_motion(1.05)
    assert model.has_pending_motion(1.29)
    assert not model.has_pending_motion(1.31)
    assert model.predict(STOP, 1.31).displacement == ORIGIN
    model.add_command(Twist(0.5, 0.0, 0.0), 2.0)
    model.add_command(STOP, 0.5)
    assert not model.has_pending_motion(0.5)


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('dead_time', [0.2, 0.3])
def test_a_late_robot_follows_a_path_as_a_prompt_one(drive, dead_time):
    """It comes to its end in little more time, and does not leave the path meanwhile."""
    late = dataclasses.replace(robot_of(drive, dead_time), max_acceleration=0.9, max_speed=0.3,
                               max_yaw_acceleration=6.0, max_yaw_rate=1.9)
    prompt = dataclasses.replace(late, dead_time=0.0)
    (seconds, offset), (unaided, swerve), (best, narrow) = (
        follow(late, BaseModel(late)), follow(late, BaseModel(prompt)),
        follow(prompt, BaseModel(prompt)))
    assert seconds < best + 3.0 * dead_time + 0.3
    assert offset < narrow + 0.01
    assert unaided > seconds + 0.5 or swerve > offset + 0.01


def follow(robot, model):
    """Return the time to the end of a path round a corner, and the farthest from it."""
    goal = Pose(1.0, 1.0, 0.5 * math.pi)
    waypoints = [Waypoint(1.0, 0.0), Waypoint(goal.x, goal.y)]
    if robot.drive == 'differential':
        path = differential_path(ORIGIN, goal, waypoints, [False, False])
    else:
        path = holonomic_path(ORIGIN, goal, waypoints)
    follower = PathFollower(robot, DriveSettings(), path)
    base = ImperfectDrive(robot, DriveImperfections(), ORIGIN, 1.0)
    farthest = 0.0
    for k in range(1500):
        pose, twist = base.odometry_pose, base.odometry_twist
        farthest = max(farthest, pose.x - 1.0, -pose.y)
        predicted = None
        if model.dead_time > 0.0:
            displacement, velocity = model.predict(twist, PERIOD * k)
            lag = robot.time_constant
            predicted = pose @ displacement @ Pose(*(lag * value for value in velocity))
        command = follower.step(pose, PERIOD, predicted)
        if follower.finished:
            return PERIOD * k, farthest
        model.add_command(command, PERIOD * k)
        driven(base, command)
    return math.inf, farthest
