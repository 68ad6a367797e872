"""Chains of pushes as algebra: where they end, what they cost, and that none is quicker."""

import math

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_planner.collocation.speed_profile import push_time
from push_planner.problem import PlanningFailed
from push_planner.sequence.kinematics import (
    complete_rotations, object_poses_along, SequenceMotions, solve_straights,
)
from push_planner.sequence.primitives import primitive_table
from push_planner.sequence.search import PushSequence, search, SequenceCosts
from push_planner.sequence.steps import build_steps
from push_planner.settings import PlannerSettings, TaskSettings
import pytest
from scipy.optimize import linprog

# Misses are left out but where they are what it is about.
SETTINGS, TASK = PlannerSettings(), TaskSettings(correction_time=0.0)
GOALS = [Pose(0.05, 0.0, 0.0), Pose(-1.0, 0.7, 1.9), Pose(0.0, 0.0, math.pi),
         Pose(1.6, -2.0, -0.4)]
KINDS = [(box(), DIFFERENTIAL), (box(friction=(0.4, 0.3, 0.35, 0.2)), HOLONOMIC),
         (bin_(), HOLONOMIC)]
IDS = ['differential', 'held', 'round']


def table_of(obj, robot):
    """List the elements of an object and a robot."""
    return primitive_table(obj, robot, SETTINGS, TASK, 0.3)


def sequence_costs(table, change=9.0, longest=math.inf):
    """Take 10 s to any first push, and as long for every change of place."""
    apart = table.numbers[:, None] != table.numbers
    return SequenceCosts(np.full(len(apart), 10.0), np.where(apart, change, 0.0), 0.15, longest)


def random_chains(table, count, goal, seed, number=400):
    """Weigh chains of random elements with random turns; return those that reach the goal."""
    rng = np.random.default_rng(seed)
    sites = rng.integers(len(table.primitives), size=(number, count))
    turns = table.sides[sites] * rng.uniform(0.0, 2.5, sites.shape)
    turns = complete_rotations(table, sites, turns[:, :-1], goal.theta)
    least = rng.uniform(0.0, 0.5, sites.shape)
    chains = solve_straights(table, sites, turns, goal, least)
    reached = np.isfinite(chains.ways).all(axis=1)
    assert 20 < reached.sum()
    return sites[reached], least[reached], [column[reached] for column in chains]


def as_chain(sites, weighed, row):
    """Take one chain out of many."""
    return PushSequence(*(tuple(column[row].tolist()) for column in (sites, *weighed[:3])), 0.0)


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
@pytest.mark.parametrize('count', [2, 3, 4])
def test_a_chain_laid_out_ends_at_the_goal(obj, robot, count):
    """Following the flat points piece by piece leads to the goal, by the ways that were told."""
    table, goal = table_of(obj, robot), GOALS[1]
    sites, least, weighed = random_chains(table, count, goal, count)
    assert np.all(weighed[1] >= 0.0) and np.all(weighed[2] >= least)
    places = object_poses_along(table, sites, weighed, 1).reshape(len(sites), 3 * count, 3)
    assert not len(object_poses_along(table, sites[:0], SequenceMotions(*(part[:0] for part in weighed)), 1))
    for row in range(20):
        chain = as_chain(sites, weighed, row)
        steps = build_steps(chain, table, Pose(0.0, 0.0, 0.0), goal, SETTINGS)
        assert sum(step.push.path_length for step in steps) == pytest.approx(weighed[3][row].sum())
        for step, after in zip(steps, steps[1:] + [None]):
            end = step.object_poses(0.1)[-1]
            wanted = after.push.start if after else goal
            assert distance(end, wanted) < 1e-9
            assert abs(wrap_angle(end.theta - wanted.theta)) < 1e-9
        ends = [step.push.end for step in steps]
        for end in ends:
            assert np.hypot(*(places[row, :, :2] - end[:2]).T).min() < 1e-9


def test_the_straight_pushes_are_the_shortest():
    """A linear programme over all straight lengths finds no less."""
    table, goal = table_of(box(), DIFFERENTIAL), GOALS[3]
    sites, least, weighed = random_chains(table, 3, goal, 7)
    turns, before, after, _ = weighed
    heading = np.cumsum(turns, axis=1) - turns
    first = heading + table.angles[sites]
    for row in range(40):
        angles = np.concatenate([first[row], first[row] + turns[row]])
        directions = np.array([np.cos(angles), np.sin(angles)])
        lengths = np.concatenate([before[row], after[row]])
        found = linprog(np.ones(6), A_eq=directions, b_eq=directions @ lengths,
                        bounds=[(0.0, None)] * 3 + [(low, None) for low in least[row]])
        assert found.fun == pytest.approx(lengths.sum(), abs=1e-7)


@pytest.mark.parametrize('obj, robot', KINDS, ids=IDS)
@pytest.mark.parametrize('goal', GOALS)
def test_no_random_chain_is_quicker(obj, robot, goal):
    """Of thousands of random chains none beats what the search finds by more than 1 %."""
    table = table_of(obj, robot)
    costs = sequence_costs(table)
    found = search(table, costs, goal, TASK, math.inf)
    rng = np.random.default_rng(5)
    for count in (2, 3):
        sites = rng.integers(len(table.primitives), size=(20000, count))
        turns = table.sides[sites] * rng.uniform(0.0, 1.0, sites.shape) ** 2 * math.pi
        turns = complete_rotations(table, sites, turns[:, :-1], goal.theta)
        least = np.full(sites.shape, TASK.min_last_straight)
        least[:, :-1] = np.where(table.numbers[sites[:, :-1]] == table.numbers[sites[:, 1:]],
                                 0.0, TASK.min_straight)
        ways = solve_straights(table, sites, turns, goal, least).ways.sum(axis=1)
        times = costs.besides(sites) + ways / costs.speed
        assert found.chains[0].duration < 1.01 * times.min()


def test_chains_come_in_order_and_push_at_different_places():
    """Each keeps to the lengths that are asked for, and to the limit."""
    table = table_of(box(), DIFFERENTIAL)
    costs = sequence_costs(table)
    chains = search(table, costs, GOALS[1], TASK, math.inf).chains
    times = [chain.duration for chain in chains]
    assert times == sorted(times) and 3 < len(chains) <= TASK.alternatives
    places = set()
    for chain in chains:
        steps = build_steps(chain, table, Pose(0.0, 0.0, 0.0), GOALS[1], SETTINGS)
        assert chain.after[-1] >= TASK.min_last_straight
        assert all(step.segments[-1][0] >= TASK.min_straight for step in steps)
        places.add(tuple(step.problem.contact for step in steps))
        pushing = sum(step.push.path_length for step in steps) / costs.speed
        assert chain.duration == pytest.approx(10.0 + 9.0 * (len(steps) - 1) + pushing)
    assert len(places) > 3
    fewer = search(table, costs, GOALS[1], TASK, 1.05 * times[0]).chains
    assert fewer[0].duration == pytest.approx(times[0], rel=1e-6)


def test_where_changes_cost_more_there_are_fewer_pushes():
    """And the chain gets no quicker."""
    table = table_of(box(), DIFFERENTIAL)
    counts, times = [], []
    for change in (0.0, 10.0, 1000.0):
        chain = search(table, sequence_costs(table, change), GOALS[2], TASK, math.inf).chains[0]
        counts.append(len(build_steps(chain, table, Pose(0.0, 0.0, 0.0), GOALS[2], SETTINGS)))
        times.append(chain.duration)
    assert times == sorted(times)
    assert counts == sorted(counts, reverse=True) and counts[0] > 1 and counts[-1] == 1


def test_where_long_pushes_are_refused_there_are_more():
    """The chain gets slower, and none of its pushes is longer than what is accepted."""
    table, goal, times = table_of(box(), DIFFERENTIAL), GOALS[1], []
    for longest in (math.inf, 2.2, 1.9):
        chain = search(table, sequence_costs(table, longest=longest), goal, TASK, math.inf).chains[0]
        steps = build_steps(chain, table, Pose(0.0, 0.0, 0.0), goal, SETTINGS)
        assert max(step.push.path_length for step in steps) <= longest
        times.append(chain.duration)
    assert times == sorted(times) and times[0] < times[-1]


@pytest.mark.parametrize('settings', [SETTINGS, PlannerSettings(acceleration=0.2),
                                      PlannerSettings(deceleration=0.0)])
def test_the_time_of_a_push_is_that_of_its_speed(settings):
    """Between the way at full speed and at the slowest, and the same for every further metre."""
    times = [push_time(settings, way) for way in (1.0, 2.0, 3.0)]
    assert np.diff(times) == pytest.approx(1.0 / settings.pushing_speed)
    assert 1.0 / settings.pushing_speed <= times[0] < 1.0 / settings.end_speed
    assert (times[0] == pytest.approx(1.0 / 0.15)) == (settings.deceleration == 0.0)


def test_a_drive_turns_the_more_sharply_the_less_it_is_asked_to_reserve():
    """Radii go with the slack; a differential drive has one element to each side of a vertex."""
    tables = [primitive_table(box(), DIFFERENTIAL, SETTINGS, TaskSettings(radius_factor=slack), 0.0)
              for slack in (1.0, 2.0)]
    assert tables[1].radii == pytest.approx(2.0 * tables[0].radii)
    assert len(tables[0].primitives) == 8 and sorted(tables[0].sides) == [-1.0] * 4 + [1.0] * 4
    with pytest.raises(PlanningFailed, match='no site will do.*not supported'):
        primitive_table(bin_(), DIFFERENTIAL, SETTINGS, TASK, 0.0)
