"""Candidates are solved in order of their expected time, and no more of them than need be."""

from dataclasses import dataclass
import math

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
from helpers.push_sequences import HOME
import numpy as np
from push_model.geometry import Pose
from push_planner.sequence.candidates import (
    CandidateReport, RejectedCandidate, solve_in_order, SolvedCandidate,
)
from push_planner.sequence.planner import plan_task
from push_planner.settings import TaskSettings
import pytest


@dataclass(frozen=True)
class Bounded:
    """A candidate that states a lower bound of its time; None as time: it has no solution."""

    expected_time: float
    time: float
    time_to_beat: float = math.inf
    optimality_ratio: float = 1.0


def solver(log):
    """Return a function that solves candidates and writes down which, and their time limits."""
    def solve(candidate, time_limit):
        log.append((candidate, time_limit))
        if candidate.time is None:
            return RejectedCandidate(CandidateReport('', 0.0, 0.0, 'none'))
        return SolvedCandidate((), None, None, (), candidate.time, 0.0)
    return solve


@pytest.mark.parametrize('seed', range(20))
def test_the_fastest_is_found_with_the_fewest_solutions(seed):
    """Bounds being true, exactly those are solved whose bound is below the best time."""
    rng = np.random.default_rng(seed)
    bounds = rng.uniform(1.0, 10.0, 12)
    times = [None if rng.uniform() < 0.3 else float(bound * rng.uniform(1.0, 3.0))
             for bound in bounds]
    candidates = [Bounded(*pair) for pair in zip(bounds.tolist(), times)]
    log = []
    best = solve_in_order(candidates, solver(log))
    fastest = min(time for time in times if time is not None)
    assert best.duration == fastest
    solved = [candidate.expected_time for candidate, _ in log]
    assert solved == sorted(bound for bound in bounds if bound < fastest)
    limits = [limit for _, limit in log]
    assert limits == sorted(limits, reverse=True)


def test_without_solution_everything_was_tried():
    log = []
    assert solve_in_order([Bounded(2.0, None), Bounded(1.0, None)], solver(log)) is None
    assert [candidate.expected_time for candidate, _ in log] == [1.0, 2.0]
    assert solve_in_order([], solver(log)) is None


def test_a_ratio_skips_what_is_hardly_better_and_an_estimate_limits_the_others():
    log = []
    candidates = [Bounded(10.0, 11.0), Bounded(10.5, 1.0, optimality_ratio=0.95),
                  Bounded(10.4, 1.0, time_to_beat=12.0, optimality_ratio=0.95)]
    assert solve_in_order(candidates, solver(log)).duration == 1.0
    assert log[0] == (candidates[0], 12.0)
    log.clear()
    assert solve_in_order(candidates[:2], solver(log)).duration == 11.0
    assert [candidate for candidate, _ in log] == candidates[:1]


def test_a_report_in_one_line():
    assert str(CandidateReport('face 1, face 2', 12.34, 2.0, '')) == 'face 1, face 2: 12.3 + 2.0 s'
    assert str(CandidateReport('face 1', 12.34, 2.0, 'too long')) == 'face 1: too long'


@pytest.mark.slow
@pytest.mark.parametrize('obj, robot, goal', [
    (box(), DIFFERENTIAL, Pose(0.8, -0.3, 0.03)), (box(), HOLONOMIC, Pose(0.7, 0.9, 1.0)),
    (bin_(), HOLONOMIC, Pose(-0.5, 0.4, 2.0))])
def test_of_all_candidates_that_were_solved_the_fastest_is_the_plan(obj, robot, goal):
    """By the time of everything and of an expected correction together."""
    found = plan_task(obj, robot, HOME, Pose(-1.2, 0.9, 2.0), goal)
    solved = [report for report in found.report.candidates if not report.rejection]
    best = min(solved, key=lambda report: report.duration + report.expected_correction)
    assert best.sites == ', '.join(f'{push.contact.kind} {push.contact.index}'
                                   for push in found.pushes)
    assert best.duration == found.duration
    assert 0.0 < best.expected_correction <= TaskSettings().correction_time
    assert found.report.evaluations > 1000
