"""Driving along a path, and maps that change meanwhile."""

from helpers.maps import walled_room
from push_control.behaviors.path_execution import blocks, PathExecution
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_navigation.path import Path
from push_navigation.settings import DriveSettings

ROBOT = RoundRobot(radius=0.17)
START, END = Pose(-1.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0)
# A wall across the path at x = 0, and one beside it.
ACROSS = walled_room((-0.1, 0.1, -1.0, 1.0))
BESIDE = walled_room((-0.1, 0.1, 0.3, 1.0))


def execution() -> PathExecution:
    """Set out along the x axis."""
    return PathExecution(ROBOT, DriveSettings(), Path((START, END)), stall_timeout=4.0)


def test_a_new_map_blocks_what_is_left_of_a_path() -> None:
    """And not what is behind the robot, nor what it passes beside."""
    assert blocks(execution(), None, ACROSS, START)
    assert not blocks(execution(), None, BESIDE, START)
    assert not blocks(execution(), ACROSS, None, START)
    assert not blocks(execution(), None, ACROSS, Pose(0.5, 0.0, 0.0))


def test_an_obstacle_that_was_there_before_blocks_nothing_new() -> None:
    """The path was planned in spite of it, as where the robot stands at a wall."""
    assert not blocks(execution(), ACROSS, ACROSS, START)


def test_a_robot_that_stands_is_not_blocked() -> None:
    assert not blocks(None, None, ACROSS, START)
