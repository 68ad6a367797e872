"""Tasks inside a map: object and robot meet no obstacle, and what is out of reach says so."""

import math

import numpy as np
from objects import box
from push_drive.settings import DriveSettings
from push_drive.way import sampled
from push_drive.workspace import Workspace
from push_model.geometry import Pose
from push_planner.problem import PlanningFailed
from push_planner.task import plan_task
from push_problems import DIFFERENTIAL, HOLONOMIC
import pytest

HERE, START = Pose(-2.0, 1.0, 0.0), Pose(-1.0, 0.0, 0.3)
MARGIN = DriveSettings().map_clearance


def room(width, height, wall=None, resolution=0.05):
    """Return a room about the origin; a wall across it at x = 0 has a door of a width."""
    occupied = np.zeros((round(height / resolution), round(width / resolution)), dtype=bool)
    occupied[[0, -1]] = True
    occupied[:, [0, -1]] = True
    if wall is not None:
        rows, columns = occupied.shape
        door = round(0.5 * wall / resolution)
        occupied[:, columns // 2] = True
        occupied[rows // 2 - door:rows // 2 + door, columns // 2] = False
    return Workspace(resolution, Pose(-0.5 * width, -0.5 * height, 0.0), occupied)


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
@pytest.mark.parametrize('goal', [Pose(1.0, 0.0, 0.0), Pose(1.0, 1.0, 1.5)])
def test_through_a_door_nothing_is_touched(robot, goal):
    """The way and the first push are free, and so is the object at the end of every push."""
    workspace = room(6.0, 6.0, 1.5)
    found = plan_task(box(), robot, START, HERE, goal, workspace=workspace)
    push = found.plan.trajectory
    assert workspace.object_is_free(box(), push.object_poses, MARGIN)
    assert workspace.robot_is_free(robot, push.robot_poses, MARGIN)
    assert workspace.robot_is_free(robot, sampled(found.way, robot, 0.01), MARGIN)
    assert workspace.object_is_free(box(), [push.end for push in found.pushes], MARGIN)
    assert found.pushes[-1].end == goal
    assert found.duration >= plan_task(box(), robot, START, HERE, goal).duration - 1e-6


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
def test_a_wide_map_changes_nothing(robot):
    """Twenty metres of free floor are as good as no map."""
    goal = Pose(-0.9, 0.1, 0.35)
    open_, mapped = (plan_task(box(), robot, START, HERE, goal, workspace=workspace)
                     for workspace in (None, room(20.0, 20.0)))
    assert mapped.duration == pytest.approx(open_.duration, rel=1e-3)
    assert len(mapped.pushes) == len(open_.pushes)


@pytest.mark.parametrize('robot, workspace, goal, reason', [
    (HOLONOMIC, room(6.0, 6.0, 0.3), Pose(1.0, 0.0, 0.0), 'only outside the map or through'),
    (DIFFERENTIAL, room(6.0, 6.0, 0.5), Pose(1.0, 0.0, 0.0), 'only outside the map or through'),
    (HOLONOMIC, room(6.0, 6.0), Pose(4.0, 0.0, 0.0), 'the goal is at 4.00 m, 0.00 m, where'),
    (HOLONOMIC, room(1.8, 6.0), Pose(0.3, 0.0, 0.0), 'the object stands at -1.00 m, 0.00 m')],
    ids=['no door', 'narrow door', 'goal outside', 'start outside'])
def test_what_the_map_forbids_is_said(robot, workspace, goal, reason):
    """One sentence each."""
    with pytest.raises(PlanningFailed, match=reason):
        plan_task(box(), robot, START, HERE, goal, workspace=workspace)


def test_a_goal_at_the_wall_keeps_what_room_there_is():
    """The margin is that of the goal where it is nearer to the wall than the settings ask for."""
    workspace, goal = room(6.0, 6.0), Pose(2.67, 0.0, 0.0)
    assert not workspace.object_is_free(box(), [goal], MARGIN)
    found = plan_task(box(), HOLONOMIC, START, HERE, goal, workspace=workspace)
    assert workspace.object_is_free(box(), found.plan.trajectory.object_poses, 0.0)
    assert math.isclose(found.pushes[-1].end.x, goal.x)
