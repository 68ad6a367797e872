"""
Plans measured: how many goals are reached, how fast, and how near to the best that is known.

Every plan is driven anew by scipy; the thesis' way of planning runs on the same goals. Takes some
minutes, ``--quick`` less than one. Ctrl-C ends the part that runs, the report has what was done.
Prints Markdown, and writes it with a picture to a directory if one is given
(``--out docs/planner``).
"""

import argparse
import dataclasses
from pathlib import Path
import time
from typing import NamedTuple

from benchmarks.planner.goals import families, mid_face, problems
from benchmarks.planner.measure import collect, measure
from benchmarks.planner.nlp_solvers import compare_solvers, quality
from benchmarks.planner.report import picture, text
from benchmarks.planner.shooting import shoot
from benchmarks.planner.vehicle_bound import Bounded
import numpy as np
from push_model.geometry import Pose
from push_planner.problem import PlanningFailed
from push_planner.single_push.planner import plan_push

SQUARE = 'square, mid-face, holonomic'
SEED, WARM_SEED, MOVED_SEED = 2026, 7, 11
MOVED = 0.05


class Results(NamedTuple):
    """
    All that was measured.

    :param kinds: name -> ``Answer`` of each push.
    :param first: CPU time of the first plan [s].
    :param shots: (segments, pairs of ``Answer`` and ``Shot``).
    :param again: per goal, (CPU time, duration) from nothing and from the plan before [s].
    :param quality: name -> ``planner_programme.Quality`` of each push.
    :param bounded: name -> (time over the vehicle bound, over the upper one) of each push.
    :param solvers: ``planner_programme.SolverRun`` of each solver.
    :param starts: number of random starts.
    """

    kinds: dict
    first: float
    shots: list
    again: list
    quality: dict
    bounded: dict
    solvers: list
    starts: int


def family(name, make, count, warm):
    """Measure pushes of one kind, after some others so that every programme has been built."""
    collect(problems(make, warm, WARM_SEED), f'{name}, to warm up', _quietly)
    return collect(problems(make, count, SEED), name, measure)


def _quietly(problem):
    try:
        return plan_push(problem)
    except PlanningFailed:
        return None


def first_plan():
    """Return the CPU time of the first plan of the process, programmes included [s]."""
    began = time.process_time()
    _quietly(problems(mid_face, 1, WARM_SEED)[0])
    return time.process_time() - began


def shots(answers, segments):
    """Plan by single shooting what has been planned; return pairs (``Answer``, ``Shot``)."""
    return collect([answer for answer in answers if not answer.fault],
                   f'single shooting, {segments} segments',
                   lambda answer: (answer, shoot(answer.problem, segments)))


def again(answers):
    """Plan for a goal that moved a little, from nothing and from the plan before."""
    return collect([answer for answer in answers if not answer.fault], 'moved goals', _again)


def _again(answer):
    problem = answer.problem
    rng = np.random.default_rng((MOVED_SEED, int(1e6 * abs(problem.goal.x))))
    goal = problem.goal @ Pose(*rng.uniform(-MOVED, MOVED, 2), rng.uniform(-MOVED, MOVED))
    moved, before = dataclasses.replace(problem, goal=goal), plan_push(problem)
    times = []
    for known in ({}, {'previous': before}):
        began = time.process_time()
        found = plan_push(moved, **known)
        times.append((time.process_time() - began, found.trajectory.duration))
    return times


def options():
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--goals', type=int, default=500, help='random goals of the square')
    parser.add_argument('--others', type=int, default=100, help='pushes of every other kind')
    parser.add_argument('--warm', type=int, default=30, help='plans of each kind before')
    parser.add_argument('--shots', type=int, default=20, help='goals for single shooting')
    parser.add_argument('--fine', type=int, default=5,
                        help='goals for single shooting with 24 segments')
    parser.add_argument('--quality', type=int, default=100,
                        help='pushes of squares, and as many of random boxes, held against '
                             'random starts')
    parser.add_argument('--starts', type=int, default=64, help='random starts of each')
    parser.add_argument('--bounded', type=int, default=100,
                        help='pushes of each held against the vehicle bound')
    parser.add_argument('--solvers', type=int, default=20, help='goals for each solver')
    parser.add_argument('--compiled', action='store_true',
                        help='compile a programme for the comparison of solvers: minutes')
    parser.add_argument('--quick', action='store_true', help='few of everything')
    parser.add_argument('--out', type=Path, help='directory for planner.md and planner.png')
    chosen = parser.parse_args()
    if chosen.quick:
        chosen.goals, chosen.others, chosen.warm, chosen.shots, chosen.fine = 20, 4, 3, 3, 0
        chosen.quality, chosen.bounded, chosen.starts, chosen.solvers = 2, 2, 8, 3
    return chosen


def measure_all(chosen):
    """Run all parts; return ``Results``."""
    first = first_plan()
    kinds = {SQUARE: family(SQUARE, mid_face, chosen.goals, chosen.warm)}
    for name, make in families().items():
        kinds[name] = family(name, make, chosen.others, chosen.warm)
    square, boxes = kinds[SQUARE], kinds['random boxes, face, holonomic']
    return Results(
        kinds, first, [(count, shots(square[:tried], count))
                       for count, tried in ((6, chosen.shots), (24, chosen.fine))],
        again(square[:chosen.others]), quality_of(square, boxes, chosen),
        bounded(square, boxes, chosen.bounded),
        compare_solvers([answer.problem for answer in square[:chosen.solvers]], collect,
                        chosen.compiled),
        chosen.starts)


def quality_of(square, boxes, chosen):
    """Hold plans against random starts, by kind of object."""
    return {name: collect([answer for answer in answers[:chosen.quality] if not answer.fault],
                          f'random starts, {name}',
                          lambda answer: quality(answer, chosen.starts))
            for name, answers in (('squares', square), ('random boxes', boxes))}


def bounded(square, boxes, count):
    """Hold plans on the ellipsoidal limit surface against the vehicle bound, by object."""
    work = Bounded()
    return {name: collect([answer.problem for answer in answers[:count]], f'bounds, {name}', work)
            for name, answers in (('squares', square), ('random boxes', boxes))}


def main():
    """Measure, print, write."""
    chosen = options()
    results = measure_all(chosen)
    written = text(results)
    print(written)
    if chosen.out:
        chosen.out.mkdir(parents=True, exist_ok=True)
        (chosen.out / 'planner.md').write_text(written, encoding='utf-8')
        picture(chosen.out / 'planner.png', results)


if __name__ == '__main__':
    main()
