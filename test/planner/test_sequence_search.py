"""Search for push sequences: no random one is faster, and limits and costs are respected."""

import itertools
import math

from helpers.objects import box
from helpers.push_problems import DIFFERENTIAL
from helpers.push_sequences import (
    CHANGE_TIME, FIRST_TIME, GOALS, HOME, KIND_IDS, KINDS, SETTINGS, simple_costs, SPEED,
    table_of, TASK,
)
import numpy as np
from push_planner.sequence.kinematics import complete_rotations, solve_straights
from push_planner.sequence.miss_probability import miss_probability
from push_planner.sequence.search import PatternSearch, search_sequences
from push_planner.sequence.steps import build_steps
from push_planner.settings import TaskSettings
import pytest

ALL_DIRECTIONS = np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=2)))


def steps_of(sequence, table, goal):
    """Return the pushes of a sequence that starts at the origin."""
    return build_steps(sequence, table, HOME, goal, SETTINGS)


def last_push_of(steps):
    """Return what the probability of a miss depends on, of the last of several pushes."""
    last = steps[-1]
    return (last.rotation, last.segments[-1].length, last.push.path_length,
            last.problem.contact.kind == 'face')


def test_pattern_search_finds_the_minimum_of_a_quadratic():
    """Of several at once; where the minimum is out of bounds, the nearest point within."""
    centers = np.array([[0.3, 0.6], [0.9, 0.1], [1.7, 0.4], [0.2, -0.5]])
    bounds = np.ones((4, 2))

    def evaluate(points):
        return ((points - centers[:, None, :]) ** 2).sum(axis=2)

    search = PatternSearch(evaluate, ALL_DIRECTIONS, bounds)
    found = search.minimize(np.full((4, 2), 0.5), 0.4, 40)
    assert found == pytest.approx(np.clip(centers, 0.0, 1.0), abs=1e-4)


def test_pattern_search_makes_nothing_worse():
    """And leaves what it is given as it is."""
    rng = np.random.default_rng(3)
    start = rng.uniform(size=(50, 2))
    kept = start.copy()

    def evaluate(points):
        return np.sin(17.0 * points[..., 0]) * np.cos(23.0 * points[..., 1])

    found = PatternSearch(evaluate, ALL_DIRECTIONS, np.ones((50, 2))).minimize(start, 0.1, 8)
    assert np.array_equal(start, kept)
    assert np.all(evaluate(found) <= evaluate(start)) and np.all((found >= 0.0) & (found <= 1.0))
    assert np.mean(evaluate(found) < evaluate(start)) > 0.9


@pytest.mark.slow
@pytest.mark.parametrize('obj, robot', KINDS, ids=KIND_IDS)
@pytest.mark.parametrize('goal', GOALS)
def test_no_random_sequence_is_faster(obj, robot, goal):
    """Of thousands of random sequences none beats what the search finds by more than 1 %."""
    table = table_of(obj, robot)
    costs = simple_costs(table)
    found = search_sequences(table, costs, goal, TASK, math.inf)
    rng = np.random.default_rng(5)
    for count in (2, 3):
        moves = rng.integers(len(table.primitives), size=(20000, count))
        rotations = table.sides[moves] * rng.uniform(0.0, 1.0, moves.shape) ** 2 * math.pi
        rotations = complete_rotations(table, moves, rotations[:, :-1], goal.theta)
        least = np.full(moves.shape, TASK.min_last_straight)
        goes_on = table.locations[moves[:, :-1]] == table.locations[moves[:, 1:]]
        least[:, :-1] = np.where(goes_on, 0.0, TASK.min_straight)
        lengths = solve_straights(table, moves, rotations, goal, least).path_lengths.sum(axis=1)
        times = costs.besides_pushing(moves) + lengths / costs.speed
        assert found.sequences[0].duration < 1.01 * times.min()


def test_sequences_come_in_order_and_push_at_different_locations():
    """Each keeps to the least lengths, and to the limit of the search."""
    table, goal = table_of(box(), DIFFERENTIAL), GOALS[1]
    costs = simple_costs(table)
    sequences = search_sequences(table, costs, goal, TASK, math.inf).sequences
    times = [sequence.duration for sequence in sequences]
    assert times == sorted(times) and 3 < len(sequences) <= TASK.alternatives
    locations = set()
    for sequence in sequences:
        steps = steps_of(sequence, table, goal)
        assert sequence.moves[-1].straight_after >= TASK.min_last_straight
        assert all(step.segments[-1].length >= TASK.min_straight for step in steps)
        locations.add(tuple(step.problem.contact for step in steps))
        pushing = sum(step.push.path_length for step in steps) / costs.speed
        assert sequence.duration == pytest.approx(
            FIRST_TIME + CHANGE_TIME * (len(steps) - 1) + pushing)
    assert len(locations) > 3
    fewer = search_sequences(table, costs, goal, TASK, 1.05 * times[0]).sequences
    assert fewer[0].duration == pytest.approx(times[0], rel=1e-6)


def test_where_changes_cost_more_there_are_fewer_pushes():
    """And the sequence gets no faster."""
    table = table_of(box(), DIFFERENTIAL)
    counts, times = [], []
    for change in (0.0, 10.0, 1000.0):
        sequence = search_sequences(table, simple_costs(table, change), GOALS[2], TASK,
                                    math.inf).sequences[0]
        counts.append(len(steps_of(sequence, table, GOALS[2])))
        times.append(sequence.duration)
    assert times == sorted(times)
    assert counts == sorted(counts, reverse=True) and counts[0] > 1 and counts[-1] == 1


def test_where_long_pushes_are_refused_there_are_more():
    """The sequence gets slower, and none of its pushes is longer than what is accepted."""
    table, goal, times = table_of(box(), DIFFERENTIAL), GOALS[1], []
    for longest in (math.inf, 2.2, 1.9):
        sequence = search_sequences(table, simple_costs(table, longest=longest), goal, TASK,
                                    math.inf).sequences[0]
        steps = steps_of(sequence, table, goal)
        assert max(step.push.path_length for step in steps) <= longest
        times.append(sequence.duration)
    assert times == sorted(times) and times[0] < times[-1]


@pytest.mark.parametrize('obj, robot', KINDS, ids=KIND_IDS)
def test_a_sequence_costs_what_a_miss_of_its_last_push_is_likely_to(obj, robot):
    """Its time is that of its parts, and the time of a correction times the probability."""
    table, goal = table_of(obj, robot), GOALS[1]
    task = TaskSettings(correction_time=50.0)
    for sequence in search_sequences(table, simple_costs(table), goal, task, math.inf).sequences:
        steps = steps_of(sequence, table, goal)
        pushing = sum(step.push.path_length for step in steps) / SPEED
        correction = 50.0 * miss_probability(*last_push_of(steps))
        assert sequence.duration - correction == pytest.approx(
            FIRST_TIME + CHANGE_TIME * (len(steps) - 1) + pushing)


@pytest.mark.slow
@pytest.mark.parametrize('obj, robot', KINDS, ids=KIND_IDS)
@pytest.mark.parametrize('goal', [GOALS[0], GOALS[2], GOALS[3]])
def test_the_dearer_a_miss_the_less_likely_it_is(obj, robot, goal):
    """And the longer the sequence takes: time is exchanged for probability, never given away."""
    table, probabilities, times, both = table_of(obj, robot), [], [], []
    for correction_time in (0.0, 10.0, 40.0, 200.0):
        task = TaskSettings(correction_time=correction_time)
        sequence = search_sequences(table, simple_costs(table), goal, task, math.inf).sequences[0]
        steps = steps_of(sequence, table, goal)
        probabilities.append(float(miss_probability(*last_push_of(steps))))
        times.append(sequence.duration - correction_time * probabilities[-1])
        both.append(sequence.duration)
    assert np.all(np.diff(probabilities) <= 0.01)
    assert np.all(np.diff(times) >= -0.01 * times[0]) and np.all(np.diff(both) > 0.0)
