"""Braking distance: what the drive of the simulator needs from the command to stop."""

import numpy as np
from push_control.steered.laws.braking import braking_distance
from push_dynamics.actuation import track_command
from push_dynamics.encoding import drive_values
from push_model.parameters import RoundRobot
import pytest

# Speeds below, at and above that from which the drive brakes at its limit, up to fast robots.
SPEEDS = (0.0, 0.01, 0.05, 0.089, 0.09, 0.091, 0.12, 0.2, 0.3, 0.5, 1.0, 2.0)
STOP = np.zeros(3)


def simulated(robot, speed, duration=20.0, step=None):
    """Let the drive stop; return how far it moves."""
    drive = np.array(drive_values(robot))
    if step is None:
        return duration * track_command(speed, 0.0, 0.0, STOP, drive, duration).mean_x
    travelled = 0.0
    for _ in range(round(duration / step)):
        tracked = track_command(speed, 0.0, 0.0, STOP, drive, step)
        travelled += step * tracked.mean_x
        speed = tracked.end_x
    return travelled


@pytest.mark.parametrize('lag', [0.0, 0.02, 0.1, 0.3])
@pytest.mark.parametrize('limit', [0.3, 0.9, 3.0])
def test_it_is_what_the_drive_needs(lag, limit):
    """At any speed, whether the drive brakes at its limit, lags behind, or one after the other."""
    robot = RoundRobot(radius=0.17, time_constant=lag, max_acceleration=limit, max_speed=2.0)
    for speed in SPEEDS:
        assert braking_distance(robot, speed) == pytest.approx(simulated(robot, speed), abs=1e-9)


def test_it_does_not_matter_how_often_the_command_is_repeated():
    """Commands to stop that follow each other add up to one."""
    robot = RoundRobot(radius=0.17, time_constant=0.1, max_acceleration=0.9)
    assert simulated(robot, 0.3, 3.0, 0.02) == pytest.approx(braking_distance(robot, 0.3))


def test_it_grows_with_speed_and_lag():
    """A faster robot needs longer, and so does one that answers later."""
    robots = [RoundRobot(radius=0.17, time_constant=lag) for lag in (0.0, 0.05, 0.1, 0.2)]
    distances = np.array([[braking_distance(robot, speed) for speed in SPEEDS]
                          for robot in robots])
    assert (np.diff(distances, axis=1) > 0.0).all() and not distances[:, 0].any()
    assert (np.diff(distances[:, 1:], axis=0) > 0.0).all()
