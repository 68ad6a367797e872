"""Kinematics of push sequences: where they lead, and that no straights are shorter."""

import math

from helpers.objects import box
from helpers.push_problems import DIFFERENTIAL
from helpers.push_sequences import (
    GOALS, HOME, KIND_IDS, KINDS, random_motions, random_moves, sequence_of, SETTINGS, table_of,
)
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_planner.sequence.kinematics import (
    Displacements, last_push, longest_pushes, solve_straights,
)
from push_planner.sequence.steps import build_steps
import pytest
from scipy.optimize import linprog


def test_worked_example_of_two_pushes():
    """The numbers of the module's docstring."""
    table = table_of(box(), DIFFERENTIAL)
    table = table._replace(sides=np.ones(2), radii=np.full(2, 0.5), length_ratios=np.ones(2),
                           flat_angles=np.zeros(2), flat_outputs=np.zeros((2, 2)))
    moves, rotations = np.array([[0, 1]]), np.array([[0.5 * math.pi, 0.0]])
    part = Displacements.of(table, moves, rotations)
    assert (part.x[0, 0], part.y[0, 0]) == pytest.approx((0.5, 0.5))
    assert part.before[0] == pytest.approx([0.0, 0.5 * math.pi])
    assert part.after[0] == pytest.approx([0.5 * math.pi, 0.5 * math.pi])
    motions = solve_straights(table, moves, rotations, Pose(1.0, 2.0, 0.5 * math.pi),
                              np.zeros((1, 2)))
    assert motions.straight_before[0] == pytest.approx([0.5, 1.5])
    assert motions.straight_after[0] == pytest.approx([0.0, 0.0])
    assert motions.path_lengths.sum() == pytest.approx(2.0 + 0.25 * math.pi)


@pytest.mark.parametrize('obj, robot', KINDS, ids=KIND_IDS)
@pytest.mark.parametrize('count', [2, 3, 4])
def test_a_sequence_ends_at_the_goal(obj, robot, count):
    """Following the flat output piece by piece leads to the goal, by the stated path lengths."""
    table, goal, rng = table_of(obj, robot), GOALS[1], np.random.default_rng(count)
    moves, least, motions = random_motions(table, random_moves(table, count, rng), goal, rng)
    assert np.all(motions.straight_before >= 0.0) and np.all(motions.straight_after >= least)
    for row in range(20):
        steps = build_steps(sequence_of(moves, motions, row), table, HOME, goal, SETTINGS)
        assert sum(step.push.path_length for step in steps) == pytest.approx(
            motions.path_lengths[row].sum())
        ends = [step.push.start for step in steps[1:]] + [goal]
        for step, expected in zip(steps, ends, strict=True):
            end = step.object_poses(0.1)[-1]
            assert distance(end, expected) < 1e-9
            assert abs(wrap_angle(end.theta - expected.theta)) < 1e-9


def test_the_straights_are_the_shortest():
    """A linear program over all straight lengths finds no less."""
    table, goal, rng = table_of(box(), DIFFERENTIAL), GOALS[3], np.random.default_rng(7)
    moves, least, motions = random_motions(table, random_moves(table, 3, rng), goal, rng)
    part = Displacements.of(table, moves, motions.rotations)
    for row in range(40):
        angles = np.concatenate([part.before[row], part.after[row]])
        directions = np.array([np.cos(angles), np.sin(angles)])
        lengths = np.concatenate([motions.straight_before[row], motions.straight_after[row]])
        found = linprog(np.ones(6), A_eq=directions, b_eq=directions @ lengths,
                        bounds=[(0.0, None)] * 3 + [(low, None) for low in least[row]])
        assert found.fun == pytest.approx(lengths.sum(), abs=1e-7)


@pytest.mark.parametrize('obj, robot', KINDS, ids=KIND_IDS)
@pytest.mark.parametrize('count', [2, 4])
def test_pushes_in_columns_are_those_of_the_steps(obj, robot, count):
    """Moves that follow each other at one location are one push; one that comes back is not."""
    table, goal, rng = table_of(obj, robot), GOALS[1], np.random.default_rng(count)
    moves, _, motions = random_motions(
        table, random_moves(table, count, rng, number=800, repeat=0.4), goal, rng)
    moves, motions = moves[:60], motions.select(np.arange(60))
    locations, joined = table.locations[moves], 0
    rotation, path_length = last_push(locations, motions)
    longest = longest_pushes(locations, motions.path_lengths)
    for row in range(len(moves)):
        steps = build_steps(sequence_of(moves, motions, row), table, HOME, goal, SETTINGS)
        joined += len(steps) < count
        last = steps[-1]
        assert (last.rotation, last.push.path_length) == pytest.approx(
            (rotation[row], path_length[row]))
        assert longest[row] == pytest.approx(max(step.push.path_length for step in steps))
    assert 5 < joined < len(moves)
