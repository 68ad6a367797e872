"""Tasks inside a map: object and robot meet no obstacle, and what is out of reach says so."""

import dataclasses
import math

from helpers.objects import box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.dubins import advance_along_arc
from push_model.geometry import Pose
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import sample_path
from push_navigation.settings import DriveSettings
from push_planner.initial_guess.dubins_routes import tightest_turns
from push_planner.problem import PlanningFailed
from push_planner.sequence.candidates import ASIDE
from push_planner.sequence.planner import plan_task
from push_planner.sequence.steps import SequenceStep
from push_planner.single_push.planner import plan_push, PlanRequirements
import pytest
from scipy.spatial import cKDTree

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
    return OccupancyMap(resolution, Pose(-0.5 * width, -0.5 * height, 0.0), occupied)


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
@pytest.mark.parametrize('goal', [Pose(1.0, 0.0, 0.0), Pose(1.0, 1.0, 1.5)])
def test_through_a_door_nothing_is_touched(robot, goal):
    """The way and the first push are free, and so is the object at the end of every push."""
    occupancy_map = room(6.0, 6.0, 1.5)
    found = plan_task(box(), robot, START, HERE, goal, occupancy_map=occupancy_map)
    push = found.plan.trajectory
    assert occupancy_map.object_is_free(box(), push.object_poses, MARGIN)
    assert occupancy_map.robot_is_free(robot, push.robot_poses, MARGIN)
    assert occupancy_map.robot_is_free(robot, sample_path(found.way, robot, 0.01), MARGIN)
    assert occupancy_map.object_is_free(box(), [push.end for push in found.pushes], MARGIN)
    assert found.pushes[-1].end == goal
    # On open floor turns are refined for a shorter while.
    assert found.duration >= 0.999 * plan_task(box(), robot, START, HERE, goal).duration


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
def test_a_wide_map_changes_nothing(robot):
    """Twenty metres of free floor are as good as no map."""
    goal = Pose(-0.9, 0.1, 0.35)
    open_, mapped = (plan_task(box(), robot, START, HERE, goal, occupancy_map=occupancy_map)
                     for occupancy_map in (None, room(20.0, 20.0)))
    assert mapped.duration == pytest.approx(open_.duration, rel=1e-3)
    assert len(mapped.pushes) == len(open_.pushes)


@pytest.mark.parametrize('robot, occupancy_map, goal, reason', [
    (HOLONOMIC, room(6.0, 6.0, 0.3), Pose(1.0, 0.0, 0.0), 'only outside the map or through'),
    (DIFFERENTIAL, room(6.0, 6.0, 0.5), Pose(1.0, 0.0, 0.0), 'only outside the map or through'),
    (HOLONOMIC, room(6.0, 6.0), Pose(4.0, 0.0, 0.0), 'the goal is at 4.00 m, 0.00 m, where'),
    (HOLONOMIC, room(1.8, 6.0), Pose(0.3, 0.0, 0.0), 'the object stands at -1.00 m, 0.00 m')],
    ids=['no door', 'narrow door', 'goal outside', 'start outside'])
def test_what_the_map_forbids_is_said(robot, occupancy_map, goal, reason):
    """One sentence each."""
    with pytest.raises(PlanningFailed, match=reason):
        plan_task(box(), robot, START, HERE, goal, occupancy_map=occupancy_map)


def test_a_goal_at_the_wall_keeps_what_room_there_is():
    """The margin is that of the goal where it is nearer to the wall than the settings ask for."""
    occupancy_map, goal = room(6.0, 6.0), Pose(2.67, 0.0, 0.0)
    assert not occupancy_map.object_is_free(box(), [goal], MARGIN)
    found = plan_task(box(), HOLONOMIC, START, HERE, goal, occupancy_map=occupancy_map)
    assert occupancy_map.object_is_free(box(), found.plan.trajectory.object_poses, 0.0)
    assert math.isclose(found.pushes[-1].end.x, goal.x)


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
def test_the_first_push_keeps_near_the_way_that_was_checked(robot):
    """However the programme would cut it short, a way is left by no more than was said."""
    found = plan_task(box(), robot, START, HERE, Pose(1.0, 1.0, 1.5))
    problem = found.plan.problem
    turn = tightest_turns(problem)[0].curvature / 1.2
    segments = (0.8, 0.0), (1.2 / turn, turn), (0.8, 0.0)
    flat = Pose(*problem.vehicle.flat_output, problem.vehicle.angle)
    end = flat
    for piece in segments:
        end = advance_along_arc(end, *piece)
    problem = dataclasses.replace(
        problem, goal=problem.start @ end @ flat.inverse(),
        settings=dataclasses.replace(problem.settings, max_path_length=20.0))
    step = SequenceStep(problem, found.pushes[0]._replace(start=problem.start), segments)
    free, near = (plan_push(problem, requirements=PlanRequirements(step.route(aside))) for aside in (math.inf, ASIDE))
    way = cKDTree(np.array(step.object_poses(0.002))[:, :2])
    offs = [way.query(found.trajectory.object_poses[:, :2])[0].max() for found in (free, near)]
    assert offs[1] < min(offs[0], 2.0 * ASIDE)
    assert near.trajectory.duration >= free.trajectory.duration - 1e-6


def test_what_finds_fault_with_all_pushes_is_asked_only_so_often():
    """A budget of programmes holds, and the reason is handed on."""
    problem = plan_task(box(), HOLONOMIC, START, HERE, Pose(1.0, 1.0, 1.5)).plan.problem
    seen = []

    def violation(trajectory):
        seen.append(trajectory)
        return 'not to my liking'

    for max_solves in (1, 3):
        seen.clear()
        with pytest.raises(PlanningFailed, match='not to my liking'):
            plan_push(problem, requirements=PlanRequirements(violation=violation, max_solves=max_solves))
        assert 1 <= len(seen) <= max_solves


@pytest.mark.parametrize('goal', [Pose(6.6, 1.6, 0.0), Pose(6.6, 1.0, -0.8)])
def test_round_a_corner_through_a_corridor(goal):
    """No turn on a grid hits a corridor: turns and straights are bent until there is room."""
    occupied = np.zeros((64, 160), dtype=bool)
    occupied[:22, 60:100] = occupied[42:, 60:100] = True
    occupancy_map = OccupancyMap(0.05, Pose(0.0, 0.0, 0.0), occupied)
    start, here = Pose(1.8, 1.0, -1.8), Pose(2.4, 0.4, 1.1)
    found = plan_task(box(), DIFFERENTIAL, start, here, goal, occupancy_map=occupancy_map)
    push = found.plan.trajectory
    assert occupancy_map.object_is_free(box(), push.object_poses, MARGIN)
    assert occupancy_map.robot_is_free(DIFFERENTIAL, push.robot_poses, MARGIN)
    assert found.pushes[-1].end == goal
