"""
Benchmark of the planner: goals reached, CPU time, and distance from the best known plans.

scipy simulates every plan in open loop. Takes some minutes, ``--quick`` less than one. Ctrl-C ends
the current part; the report has what was done until then. Prints Markdown, and writes it with a
figure to a directory if one is given (``--out docs/reports``).
"""

import argparse
import dataclasses
import functools
import math
from pathlib import Path
import time
from typing import Callable, Optional, Sequence

from benchmarks.planner.goals import families, mid_face, ProblemMaker, problems
from benchmarks.planner.measure import Answer, collect, measure, whole_plan
from benchmarks.planner.random_starts import Quality, quality
from benchmarks.planner.report import picture, text
from benchmarks.planner.results import Results, WarmStart
from benchmarks.planner.sites import choices, KINDS
import numpy as np
from push_model.geometry import Pose, wrap_angle
from push_planner.problem import InitialMotion, PlanningFailed, PushProblem
from push_planner.steered.continuation import ROUTE
from push_planner.steered.plan import Plan

DESCRIPTION = 'Benchmark of the planner: goals reached, CPU time, quality of plans.'
SQUARE = 'square, mid-face, holonomic'
SEED = 2026
WARM_SEED = 7
MOVED_SEED = 11
# Range of the displacement of goals that move [m, rad]; chosen: as a supervisor corrects them.
MOVED = 0.05
# Part of a push after which it is planned on, and how far the object is off its path there at most
# [m, m, rad]. Chosen: as a push that is corrected half-way.
PUSHED_FRACTIONS = 0.1, 0.6
OFF_PATH = np.array([0.003, 0.003, 0.005])
# Numbers that growth is measured over: segments of slow pushes, faces.
SEGMENT_COUNTS = 12, 24, 48, 96, 192
SLOW_SPEEDS = (0.25,)
FACE_COUNTS = 3, 4, 6, 8, 12


def family(name: str, make: ProblemMaker, count: int, warm: int) -> list[Answer]:
    """Measure pushes of one kind, after some others so that every NLP has been built."""
    collect(problems(make, warm, WARM_SEED), f'{name}, to warm up', _quietly)
    return collect(problems(make, count, SEED), name, measure)


def _quietly(problem: PushProblem) -> Optional[Plan]:
    try:
        return whole_plan(problem)
    except PlanningFailed:
        return None


def first_plan() -> float:
    """Return the CPU time of the first plan of the process, building the NLPs included [s]."""
    began = time.process_time()
    _quietly(problems(mid_face, 1, WARM_SEED)[0])
    return time.process_time() - began


def warm_starts(answers: Sequence[Answer]) -> dict[str, list[WarmStart]]:
    """Plan for pushes that have changed a little, from nothing and from the plan before."""
    solved = [answer.problem for answer in answers if not answer.fault]
    return {name: [one for one in collect(solved, name, functools.partial(_warm_start, change))
                   if one is not None]
            for name, change in (('a goal that moved', _moved), ('a push under way', _pushed_on))}


def _warm_start(change: Callable[[Plan, np.random.Generator], PushProblem],
                problem: PushProblem) -> Optional[WarmStart]:
    """Plan twice; None where there is no plan from nothing."""
    rng = np.random.default_rng((MOVED_SEED, int(1e6 * abs(problem.goal.x))))
    before = whole_plan(problem)
    changed = change(before, rng)
    try:
        began = time.process_time()
        first = whole_plan(changed)
        between = time.process_time()
        again = whole_plan(changed, before)
        ended = time.process_time()
    except PlanningFailed:
        return None
    return WarmStart(between - began, ended - between,
                     again.trajectory.duration / first.trajectory.duration,
                     again.report['route'] == ROUTE)


def _moved(plan: Plan, rng: np.random.Generator) -> PushProblem:
    """Move the goal of a plan."""
    x, y = rng.uniform(-MOVED, MOVED, 2)
    goal = plan.problem.goal @ Pose(x, y, rng.uniform(-MOVED, MOVED))
    return dataclasses.replace(plan.problem, goal=goal)


def _pushed_on(plan: Plan, rng: np.random.Generator) -> PushProblem:
    """Push on from somewhere along a plan, the object a little off, its goal as it was."""
    motion = plan.trajectory
    now = motion.at(rng.uniform(*PUSHED_FRACTIONS) * motion.duration)
    off = rng.uniform(-1.0, 1.0, 3) * OFF_PATH
    velocity, normal = now['contact_twists'][:2], now['contact_poses'][2]
    angle = wrap_angle(math.atan2(velocity[1], velocity[0]) - normal)
    return dataclasses.replace(
        plan.problem, start=Pose(*(now['object_poses'] + off).tolist()),
        normal=float(normal + off[2]), heading=float(now['robot_poses'][2]),
        motion=InitialMotion(math.hypot(*velocity), float(now['object_twists'][2]), angle))


def options() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--goals', type=int, default=500, help='random goals of the square')
    parser.add_argument('--others', type=int, default=100, help='pushes of every other kind')
    parser.add_argument('--warm', type=int, default=30, help='plans of each kind before')
    parser.add_argument('--quality', type=int, default=100,
                        help='pushes of squares, and as many of random boxes, compared with '
                             'random starts')
    parser.add_argument('--starts', type=int, default=64, help='random starts of each')
    parser.add_argument('--sites', type=int, default=30, help='goals for the choice of a site')
    parser.add_argument('--growing', type=int, default=20, help='goals for each size')
    parser.add_argument('--quick', action='store_true', help='few of everything')
    parser.add_argument('--out', type=Path, help='directory for planner.md and planner.png')
    chosen = parser.parse_args()
    if chosen.quick:
        chosen.goals, chosen.others, chosen.warm, chosen.growing = 20, 4, 3, 3
        chosen.quality, chosen.starts, chosen.sites = 2, 8, 3
    return chosen


def measure_all(chosen: argparse.Namespace) -> Results:
    """Run all parts; return ``Results``."""
    first = first_plan()
    kinds = {SQUARE: family(SQUARE, mid_face, chosen.goals, chosen.warm)}
    for name, make in families().items():
        kinds[name] = family(name, make, chosen.others, chosen.warm)
    square, boxes = kinds[SQUARE], kinds['random boxes, face, holonomic']
    return Results(
        kinds, first, warm_starts(square[:chosen.others]), quality_of(square, boxes, chosen),
        chosen.starts, {kind: choices(kind, chosen.sites, chosen.warm) for kind in KINDS},
        growth(chosen))


def growth(chosen: argparse.Namespace) -> list[tuple[str, int, list[float]]]:
    """Measure how plans grow with their segments, and choices of sites with the faces."""
    rows: list[tuple[str, int, list[float]]] = []
    for count in SEGMENT_COUNTS:
        make = functools.partial(mid_face, speeds=SLOW_SPEEDS, segments=count, segment_length=20.0)
        answers = family(f'{count} segments', make, chosen.growing, 3)
        rows.append(('segments of a plan', count, [answer.cpu for answer in answers]))
    for faces in FACE_COUNTS:
        sites = choices('holonomic', chosen.growing, 3, faces)
        rows.append(('faces of an object, choosing a site', faces,
                     [choice.cpu for choice in sites if choice.is_found]))
    return rows


def quality_of(square: Sequence[Answer], boxes: Sequence[Answer],
               chosen: argparse.Namespace) -> dict[str, list[Quality]]:
    """Compare plans with random starts, by kind of object."""
    return {name: collect([answer for answer in answers[:chosen.quality] if not answer.fault],
                          f'random starts, {name}',
                          lambda answer: quality(answer, chosen.starts))
            for name, answers in (('squares', square), ('random boxes', boxes))}


def main() -> None:
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
