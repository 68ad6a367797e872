"""Weighing how likely the last push misses: laws of the chance, and what it does to chains."""

import math
import re

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.geometry import Pose
from push_planner.sequence.kinematics import (
    complete_rotations, last_push, longest_pushes, SequenceMotions, solve_straights,
)
from push_planner.sequence.miss_probability import miss_probability
from push_planner.sequence.planner import plan_task
from push_planner.sequence.primitives import primitive_table
from push_planner.sequence.search import PushSequence, search, SequenceCosts
from push_planner.sequence.steps import build_steps
from push_planner.settings import PlannerSettings, TaskSettings
import pytest

HOME, HERE = Pose(0.0, 0.0, 0.0), Pose(-1.2, 0.9, 2.0)
SETTINGS, SURE = PlannerSettings(), TaskSettings(correction_time=0.0)
KINDS = [(box(), DIFFERENTIAL), (box(friction=(0.4, 0.3, 0.35, 0.2)), HOLONOMIC),
         (bin_(), HOLONOMIC)]
IDS = ['differential', 'held', 'round']
TURNED = np.linspace(0.0, 12.0, 25)[:, None, None, None]
STRAIGHT = np.array([0.0, 0.05, 0.2, 0.35, 0.6, 3.0, math.inf])[:, None, None]
WAYS = np.array([0.0, 0.4, 0.7, 1.0, 1.4, 2.0, math.inf])[:, None]
FACES = np.array([False, True])


def grid():
    """Weigh all sorts of pushes."""
    return miss_probability(TURNED, STRAIGHT, WAYS, FACES)


def test_a_chance_is_one():
    """Between 0 and 1, never certain to hit, and for numbers the same as for arrays."""
    chances = grid()
    assert chances.min() > 0.0 and chances.max() == 1.0
    for i, j, k, m in ((0, 0, 0, 1), (1, 1, 2, 0), (3, 2, 3, 1), (13, 5, 6, 0)):
        one = miss_probability(float(TURNED[i].item()), float(STRAIGHT[j].item()),
                               float(WAYS[k].item()), bool(FACES[m]))
        assert float(one) == chances[i, j, k, m]


def test_what_is_harder_misses_more():
    """The chance grows with the turn, and falls with the straight end and with the way."""
    chances = grid()
    assert np.all(np.diff(chances, axis=0) >= 0.0) and np.all(chances[-1] > chances[0])
    assert np.all(np.diff(chances, axis=1) <= 0.0)
    assert np.all(np.diff(chances, axis=2) <= 0.0)
    # A turn that is over long before the end does no harm, unless it goes nearly round.
    assert np.all(chances[0, -1] == chances[1, -1])
    assert np.all(chances[1, 0] > chances[1, -1])


def test_at_a_face_only_short_ways_miss_more():
    """There the place along the face tells; in the end a long way corrects for it."""
    chances = grid()[0, -1]
    assert chances[0, 1] > chances[0, 0]
    assert chances[-1, 1] == chances[-1, 0]
    assert np.all(np.diff(chances[:, 1] - chances[:, 0]) <= 0.0)


def table_of(obj, robot):
    """List the elements of an object and a robot."""
    return primitive_table(obj, robot, SETTINGS, SURE, 0.3)


def sequence_costs(table):
    """Take 10 s to any first push, and 9 s for every change of place."""
    apart = table.numbers[:, None] != table.numbers
    return SequenceCosts(np.full(len(apart), 10.0), np.where(apart, 9.0, 0.0), 0.15, math.inf)


def last_of(step):
    """Turn to and fro, straight end, way, and whether it is at a face, of a push laid out."""
    return (sum(abs(length * curvature) for length, curvature in step.segments),
            step.segments[-1][0], step.push.path_length, step.problem.contact.kind == 'face')


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
@pytest.mark.parametrize('count', [2, 4])
def test_pushes_in_columns_are_those_laid_out(obj, robot, count):
    """Moves that follow each other at one place count as one; one that comes back does not."""
    table, goal, rng = table_of(obj, robot), Pose(-1.0, 0.7, 1.9), np.random.default_rng(count)
    sites = rng.integers(len(table.primitives), size=(800, count))
    again = rng.uniform(size=sites.shape) < 0.4
    for i in range(1, count):
        sites[again[:, i], i] = sites[again[:, i], i - 1]
    turns = table.sides[sites] * rng.uniform(0.0, 2.5, sites.shape)
    turns = complete_rotations(table, sites, turns[:, :-1], goal.theta)
    weighed = solve_straights(table, sites, turns, goal, rng.uniform(0.0, 0.5, sites.shape))
    reached = np.flatnonzero(np.isfinite(weighed.ways).all(axis=1))[:60]
    sites, weighed = sites[reached], SequenceMotions(*(column[reached] for column in weighed))
    numbers, joined = table.numbers[sites], 0
    turned, way = last_push(numbers, weighed)
    longest = longest_pushes(numbers, weighed.ways)
    for row in range(len(sites)):
        chain = PushSequence(*(tuple(column[row].tolist()) for column in (sites, *weighed[:3])), 0.0)
        steps = build_steps(chain, table, HOME, goal, SETTINGS)
        joined += len(steps) < count
        assert last_of(steps[-1])[::2] == pytest.approx((turned[row], way[row]))
        assert longest[row] == pytest.approx(max(step.push.path_length for step in steps))
    assert 5 < joined < len(sites) > 20


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
def test_chains_cost_what_their_last_push_is_likely_to_miss(obj, robot):
    """The time of a chain is that of its parts, and of the chance times the time of mending."""
    table, goal = table_of(obj, robot), Pose(-1.0, 0.7, 1.9)
    for chain in search(table, sequence_costs(table), goal, TaskSettings(correction_time=50.0),
                        math.inf).chains:
        steps = build_steps(chain, table, HOME, goal, SETTINGS)
        pushing = sum(step.push.path_length for step in steps) / 0.15
        assert chain.duration - 50.0 * miss_probability(*last_of(steps[-1])) == pytest.approx(
            10.0 + 9.0 * (len(steps) - 1) + pushing)


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
@pytest.mark.parametrize('goal', [Pose(0.05, 0.0, 0.0), Pose(0.0, 0.0, math.pi),
                                  Pose(1.6, -2.0, -0.4)])
def test_the_dearer_a_miss_the_less_likely_it_is(obj, robot, goal):
    """And the longer the chain takes: time is exchanged for chance, and never given away."""
    table, chances, times, both = table_of(obj, robot), [], [], []
    for mending in (0.0, 10.0, 40.0, 200.0):
        chain = search(table, sequence_costs(table), goal, TaskSettings(correction_time=mending),
                       math.inf).chains[0]
        last = build_steps(chain, table, HOME, goal, SETTINGS)[-1]
        chances.append(float(miss_probability(*last_of(last))))
        times.append(chain.duration - mending * chances[-1])
        both.append(chain.duration)
    assert np.all(np.diff(chances) <= 0.01)
    assert np.all(np.diff(times) >= -0.01 * times[0]) and np.all(np.diff(both) > 0.0)


@pytest.mark.parametrize('obj, robot, goal', [
    (box(), DIFFERENTIAL, Pose(0.8, -0.3, 0.03)), (box(), HOLONOMIC, Pose(0.7, 0.9, 1.0)),
    (bin_(), HOLONOMIC, Pose(-0.5, 0.4, 2.0))])
def test_of_all_that_were_tried_the_least_is_the_answer(obj, robot, goal):
    """Time and what a miss costs, together."""
    found, tried = plan_task(obj, robot, HOME, HERE, goal), {}
    for line in found.report['tried']:
        if parts := re.search(r': ([\d.]+) \+ ([\d.]+) s$', line):
            tried[line.split(':')[0]] = (float(parts[1]), float(parts[2]))
    sites = ', '.join(f'{push.contact.kind} {push.contact.index}' for push in found.pushes)
    duration, hazard = tried[sites]
    assert duration == pytest.approx(found.duration, abs=0.051)
    assert 0.0 < hazard <= TaskSettings().correction_time
    assert duration + hazard <= min(map(sum, tried.values())) + 0.11
