"""Clearance of push sequences in a map: against a sum over all poses, and its symmetries."""

from helpers.maps import walled_floor
from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
from helpers.push_sequences import (
    HOME, random_motions, random_moves, sequence_of, SETTINGS, table_of,
)
import numpy as np
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.sequence.clearance import (
    ClearanceCheck, COARSE_SAMPLES, FINE_SAMPLES, PENALTY_RATE,
)
from push_planner.sequence.kinematics import (
    complete_rotations, object_poses_along, solve_straights,
)
from push_planner.sequence.steps import build_steps
import pytest

DRIVE = DriveSettings()
START, GOAL = Pose(-1.2, -0.4, 0.5), Pose(1.1, 0.8, 2.0)
FLOOR = walled_floor(4.0, 4.0, 1.2)
KINDS = [(box(), DIFFERENTIAL), (bin_(), HOLONOMIC)]
IDS = ['box', 'bin']


def sequences_in(table, seed=1, count=2):
    """Draw sequences from ``START`` to ``GOAL``."""
    rng = np.random.default_rng(seed)
    goal = START.inverse() @ GOAL
    moves, _, motions = random_motions(table, random_moves(table, count, rng), goal, rng)
    return moves, motions


def check(obj, robot, occupancy_map=FLOOR, start=START, goal=GOAL):
    """Return the check of an object and a robot."""
    return ClearanceCheck(occupancy_map, obj, robot, start, goal, DRIVE)


def deficit(poses, point, required):
    """Return what the clearance of a point of the object is short of, pose by pose."""
    points = np.array([pose.transform(point) for pose in poses])
    return max(0.0, required - FLOOR.clearance(points).min())


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
@pytest.mark.parametrize('fine', [False, True])
def test_penalty_is_the_sum_of_what_points_are_short_of(obj, robot, fine):
    """Of the robot, of a circle in the object and, at a fine look, of its corners."""
    table = table_of(obj, robot)
    moves, motions = sequences_in(table)
    penalties = check(obj, robot).penalty(table)(moves, motions, fine)
    samples = object_poses_along(table, moves, motions, FINE_SAMPLES if fine else COARSE_SAMPLES)
    inner_radius = 0.5 * 0.4 if obj.outline else obj.radius
    margin = DRIVE.map_clearance
    for row in range(40):
        expected = 0.0
        by_move = [[START @ Pose(*pose) for pose in poses] for poses in samples[row]]
        everything = sum(by_move, [])
        behind = [table.robot_poses[number] for number in table.locations[moves[row]]]
        expected = max(deficit(poses, place[:2], robot.radius + margin)
                       for poses, place in zip(by_move, behind))
        expected += deficit(everything, (0.0, 0.0), inner_radius + margin)
        if fine:
            expected += sum(deficit(everything, corner, margin) for corner in obj.outline)
        assert penalties[row] == pytest.approx(PENALTY_RATE * expected, abs=1e-6)
    assert 0.0 < np.mean(penalties > 0.0)


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
def test_on_wide_floor_nothing_is_short_of_clearance(obj, robot):
    """And what does not reach the goal is never free."""
    table, goal = table_of(obj, robot), START.inverse() @ GOAL
    rng = np.random.default_rng(3)
    moves = random_moves(table, 2, rng)
    rotations = table.sides[moves] * rng.uniform(0.0, 2.5, moves.shape)
    rotations = complete_rotations(table, moves, rotations[:, :-1], goal.theta)
    motions = solve_straights(table, moves, rotations, goal, np.full(moves.shape, 0.2))
    reached = motions.reaches_goal & (motions.path_lengths.sum(axis=1) < 20.0)
    penalties = check(obj, robot, walled_floor(60.0, 60.0)).penalty(table)(moves, motions, True)
    assert 20 < reached.sum() < len(moves)
    assert np.all(penalties[reached] == 0.0)
    assert np.all(np.isinf(penalties[~motions.reaches_goal]))


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
def test_it_does_not_matter_where_in_the_world(obj, robot):
    """Map, start and goal moved together give the same penalties."""
    table = table_of(obj, robot)
    moves, motions = sequences_in(table)
    frame = Pose(7.0, -3.0, 2.2)
    moved_floor = OccupancyMap(FLOOR.resolution, frame @ FLOOR.origin, FLOOR.occupied)
    one = check(obj, robot).penalty(table)(moves, motions, True)
    two = check(obj, robot, moved_floor, frame @ START, frame @ GOAL).penalty(table)(
        moves, motions, True)
    assert two == pytest.approx(one, abs=1e-6)


def test_a_larger_robot_has_no_more_clearance():
    """And a fine look finds no less than a coarse one."""
    table = table_of(box(), DIFFERENTIAL)
    moves, motions = sequences_in(table)
    wide = DriveSettings(map_clearance=2.0 * DRIVE.map_clearance)
    penalties = [ClearanceCheck(FLOOR, box(), DIFFERENTIAL, START, GOAL, drive).penalty(table)(
        moves, motions, fine) for drive, fine in ((DRIVE, False), (DRIVE, True), (wide, True))]
    assert np.all(penalties[1] >= penalties[0] - 1e-9)
    assert np.all(penalties[2] >= penalties[1] - 1e-9)
    assert np.any(penalties[1] > penalties[0] + 1.0)


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
def test_steps_are_free_where_every_pose_of_them_is(obj, robot):
    """Sampled four times as finely; both verdicts occur."""
    table, clearance = table_of(obj, robot), check(obj, robot)
    moves, motions = sequences_in(table)
    verdicts = []
    for row in range(len(moves)):
        steps = build_steps(sequence_of(moves, motions, row), table, START, GOAL, SETTINGS)
        verdicts.append(clearance.steps_are_free(steps))
        if verdicts[-1]:
            for step in steps:
                poses = step.object_poses(0.25 * FLOOR.resolution)
                assert FLOOR.object_is_free(obj, poses, DRIVE.map_clearance - FLOOR.resolution)
    assert any(verdicts) and not all(verdicts)


@pytest.mark.parametrize('start, goal, words', [
    (Pose(0.0, 1.5, 0.0), GOAL, 'the object stands at 0.00 m, 1.50 m'),
    (START, Pose(9.0, 0.0, 0.0), 'the goal is at 9.00 m, 0.00 m')])
def test_start_and_goal_must_be_free(start, goal, words):
    with pytest.raises(PlanningFailed, match=words) as failure:
        check(box(), DIFFERENTIAL, start=start, goal=goal)
    assert failure.value.code is PlanFailure.NOT_FREE


@pytest.mark.parametrize('distance, fraction', [(0.5, 1.0), (0.29, 0.5), (0.252, 0.0)])
def test_the_margin_is_what_the_goal_allows(distance, fraction):
    """All of it, half of it, or none."""
    x = 2.0 - FLOOR.resolution - distance
    clearance = check(box(), HOLONOMIC, walled_floor(4.0, 4.0), Pose(0.0, 0.0, 0.0),
                      Pose(x, 0.0, 0.0))
    assert clearance.is_free([Pose(x, 0.0, 0.0)], [Pose(-1.0, 0.0, 0.0)])
    margin = DRIVE.map_clearance
    nearer = Pose(x + distance - 0.2 - fraction * margin + 2.0 * FLOOR.resolution, 0.0, 0.0)
    assert not clearance.is_free([nearer], [Pose(-1.0, 0.0, 0.0)])
    assert not clearance.is_free([HOME], [Pose(1.9, 0.0, 0.0)])
