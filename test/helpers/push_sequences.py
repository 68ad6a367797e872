"""Push sequences that several tests of the sequence planner ask for."""

import math

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_planner.sequence.costs import SequenceCosts
from push_planner.sequence.kinematics import (
    complete_rotations, IntArray, SequenceMotions, solve_straights,
)
from push_planner.sequence.primitives import primitive_table, PrimitiveTable
from push_planner.sequence.steps import Move, PushSequence
from push_planner.settings import PlannerSettings, TaskSettings

HOME = Pose(0.0, 0.0, 0.0)
SETTINGS = PlannerSettings()
# Misses are left out except where they are the subject.
TASK = TaskSettings(correction_time=0.0)
GOALS = [Pose(0.05, 0.0, 0.0), Pose(-1.0, 0.7, 1.9), Pose(0.0, 0.0, math.pi),
         Pose(1.6, -2.0, -0.4)]
# Object and robot of each kind of contact.
KINDS = [(box(), DIFFERENTIAL), (box(friction=(0.4, 0.3, 0.35, 0.2)), HOLONOMIC),
         (bin_(), HOLONOMIC)]
KIND_IDS = ['differential', 'held', 'round']
# Speed of the contact, and times until the first push and between two contact locations.
SPEED = 0.15
FIRST_TIME = 10.0
CHANGE_TIME = 9.0


def table_of(obj: PushedObject, robot: RoundRobot) -> PrimitiveTable:
    """Return the primitives of an object and a robot."""
    return primitive_table(obj, robot, SETTINGS, TASK, 0.3)


def simple_costs(table: PrimitiveTable, change: float = CHANGE_TIME,
                 longest: float = math.inf) -> SequenceCosts:
    """Return costs that are the same for all first pushes, and for all changes of location."""
    apart = table.locations[:, None] != table.locations
    return SequenceCosts(np.full(len(apart), FIRST_TIME), np.where(apart, change, 0.0), SPEED,
                         longest)


def random_moves(table: PrimitiveTable, count: int, rng: np.random.Generator, number: int = 400,
                 repeat: float = 0.0) -> IntArray:
    """Draw numbers of primitives; each repeats the one before with a probability."""
    moves = rng.integers(len(table.primitives), size=(number, count))
    again = rng.uniform(size=moves.shape) < repeat
    for i in range(1, count):
        moves[again[:, i], i] = moves[again[:, i], i - 1]
    return moves


def random_motions(table: PrimitiveTable, moves: IntArray, goal: Pose,
                   rng: np.random.Generator) -> tuple[IntArray, FloatArray, SequenceMotions]:
    """
    Draw rotations and least straights, and complete them to motions.

    :return: moves, least straights and ``SequenceMotions`` of those that reach the goal.
    """
    rotations = table.sides[moves] * rng.uniform(0.0, 2.5, moves.shape)
    rotations = complete_rotations(table, moves, rotations[:, :-1], goal.theta)
    least = rng.uniform(0.0, 0.5, moves.shape)
    motions = solve_straights(table, moves, rotations, goal, least)
    reached = np.isfinite(motions.path_lengths).all(axis=1)
    assert 20 < reached.sum()
    return moves[reached], least[reached], motions.select(reached)


def sequence_of(moves: IntArray, motions: SequenceMotions, row: int) -> PushSequence:
    """Return one sequence out of many."""
    return PushSequence(tuple(map(Move, moves[row].tolist(), motions.rotations[row].tolist(),
                                  motions.straight_before[row].tolist(),
                                  motions.straight_after[row].tolist())), 0.0)
