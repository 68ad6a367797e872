"""Plans of tasks in a map: object and robot meet no obstacle; what is out of reach is refused."""

import dataclasses
import math

from helpers.maps import walled_floor
from helpers.objects import box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.dubins import advance_along_arc
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import sample_path
from push_navigation.settings import DriveSettings
from push_planner.initial_guess.dubins_routes import tightest_turns
from push_planner.problem import PlanningFailed
from push_planner.sequence.candidates import MAX_DEVIATION
from push_planner.sequence.planner import plan_task
from push_planner.sequence.steps import FlatSegment, SequenceStep
from push_planner.single_push.planner import plan_push, PlanRequirements
import pytest
from scipy.spatial import cKDTree

pytestmark = pytest.mark.slow
HERE, START = Pose(-2.0, 1.0, 0.0), Pose(-1.0, 0.0, 0.3)
MARGIN = DriveSettings().map_clearance


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
@pytest.mark.parametrize('goal', [Pose(1.0, 0.0, 0.0), Pose(1.0, 1.0, 1.5)])
def test_nothing_is_touched_in_a_door(robot, goal):
    """The robot's path and the first push are free, and so is the object after every push."""
    occupancy_map = walled_floor(6.0, 6.0, 1.5)
    found = plan_task(box(), robot, START, HERE, goal, occupancy_map=occupancy_map)
    push, path = found.plan.trajectory, sample_path(found.approach_path, robot, 0.01)
    assert occupancy_map.object_is_free(box(), push.object_poses, MARGIN)
    assert occupancy_map.robot_is_free(robot, push.robot_poses, MARGIN)
    assert occupancy_map.robot_is_free(robot, path, MARGIN)
    assert occupancy_map.object_is_free(box(), [push.end for push in found.pushes], MARGIN)
    assert found.pushes[-1].end == goal
    # On open floor rotations are refined in fewer steps.
    assert found.duration >= 0.999 * plan_task(box(), robot, START, HERE, goal).duration


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
def test_a_wide_map_changes_nothing(robot):
    """Twenty metres of free floor are as good as no map."""
    goal = Pose(-0.9, 0.1, 0.35)
    open_, mapped = (plan_task(box(), robot, START, HERE, goal, occupancy_map=occupancy_map)
                     for occupancy_map in (None, walled_floor(20.0, 20.0)))
    assert mapped.duration == pytest.approx(open_.duration, rel=1e-3)
    assert len(mapped.pushes) == len(open_.pushes)


@pytest.mark.parametrize('robot, occupancy_map, goal, code, reason', [
    (HOLONOMIC, walled_floor(6.0, 6.0, 0.3), Pose(1.0, 0.0, 0.0), PlanFailure.BLOCKED,
     'only outside the map or through'),
    (DIFFERENTIAL, walled_floor(6.0, 6.0, 0.5), Pose(1.0, 0.0, 0.0), PlanFailure.BLOCKED,
     'only outside the map or through'),
    (HOLONOMIC, walled_floor(6.0, 6.0), Pose(4.0, 0.0, 0.0), PlanFailure.NOT_FREE,
     'the goal is at 4.00 m, 0.00 m, where'),
    (HOLONOMIC, walled_floor(1.8, 6.0), Pose(0.3, 0.0, 0.0), PlanFailure.NOT_FREE,
     'the object stands at -1.00 m, 0.00 m')],
    ids=['no door', 'narrow door', 'goal outside', 'start outside'])
def test_what_the_map_forbids_is_refused(robot, occupancy_map, goal, code, reason):
    """With a code, and a sentence that has the numbers."""
    with pytest.raises(PlanningFailed, match=reason) as failure:
        plan_task(box(), robot, START, HERE, goal, occupancy_map=occupancy_map)
    assert failure.value.code is code


def test_at_a_goal_near_the_wall_the_margin_is_smaller():
    """It is that of the goal where it is nearer to the wall than the settings ask for."""
    occupancy_map, goal = walled_floor(6.0, 6.0), Pose(2.71, 0.0, 0.0)
    assert not occupancy_map.object_is_free(box(), [goal], MARGIN)
    found = plan_task(box(), HOLONOMIC, START, HERE, goal, occupancy_map=occupancy_map)
    assert occupancy_map.object_is_free(box(), found.plan.trajectory.object_poses, 0.0)
    assert math.isclose(found.pushes[-1].end.x, goal.x)


@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=['differential', 'holonomic'])
def test_the_first_push_keeps_near_the_path_that_was_checked(robot):
    """However the solver would cut it short, a plan leaves the path by no more than is allowed."""
    found = plan_task(box(), robot, START, HERE, Pose(1.0, 1.0, 1.5))
    problem = found.plan.problem
    curvature = tightest_turns(problem)[0].curvature / 1.2
    segments = (FlatSegment(0.8, 0.0), FlatSegment(1.2 / curvature, curvature),
                FlatSegment(0.8, 0.0))
    flat = Pose(*problem.vehicle.flat_output, problem.vehicle.angle)
    end = flat
    for segment in segments:
        end = advance_along_arc(end, *segment)
    problem = dataclasses.replace(
        problem, goal=problem.start @ end @ flat.inverse(),
        settings=dataclasses.replace(problem.settings, max_path_length=20.0))
    step = SequenceStep(problem, found.pushes[0]._replace(start=problem.start), segments)
    free, near = (plan_push(problem, requirements=PlanRequirements(step.route(max_deviation)))
                  for max_deviation in (math.inf, MAX_DEVIATION))
    path = cKDTree(np.array(step.object_poses(0.002))[:, :2])
    deviations = [path.query(plan.trajectory.object_poses[:, :2])[0].max()
                  for plan in (free, near)]
    assert deviations[1] < min(deviations[0], 2.0 * MAX_DEVIATION)
    assert near.trajectory.duration >= free.trajectory.duration - 1e-6


def test_a_requirement_that_nothing_meets_is_asked_only_so_often():
    """The number of programs is limited, and the reason is handed on."""
    problem = plan_task(box(), HOLONOMIC, START, HERE, Pose(1.0, 1.0, 1.5)).plan.problem
    checked = []

    def violation(trajectory):
        checked.append(trajectory)
        return 'not as required'

    for max_solves in (1, 3):
        checked.clear()
        with pytest.raises(PlanningFailed, match='not as required'):
            plan_push(problem, requirements=PlanRequirements(violation=violation,
                                                             max_solves=max_solves))
        assert 1 <= len(checked) <= max_solves


@pytest.mark.parametrize('goal', [Pose(6.6, 1.6, 0.0), Pose(6.6, 1.0, -0.8)])
def test_round_a_corner_through_a_corridor(goal):
    """No rotation on a grid hits a corridor: the search bends sequences until they fit."""
    occupied = np.zeros((64, 160), dtype=bool)
    occupied[:22, 60:100] = occupied[42:, 60:100] = True
    occupancy_map = OccupancyMap(0.05, Pose(0.0, 0.0, 0.0), occupied)
    start, here = Pose(1.8, 1.0, -1.8), Pose(2.4, 0.4, 1.1)
    found = plan_task(box(), DIFFERENTIAL, start, here, goal, occupancy_map=occupancy_map)
    push = found.plan.trajectory
    assert occupancy_map.object_is_free(box(), push.object_poses, MARGIN)
    assert occupancy_map.robot_is_free(DIFFERENTIAL, push.robot_poses, MARGIN)
    assert found.pushes[-1].end == goal
