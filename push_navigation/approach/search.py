"""Search for the quickest candidate: a coarse scan of shapes, a pattern search of the best."""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.approach.clearance import keeps_clear
from push_navigation.approach.encoding import (
    ApproachProblem, ARRIVAL, ARRIVAL_ANGLE, CANDIDATE_SIZE, DEPARTURE, DEPARTURE_ANGLE, DIRECTION,
    FIRST_RADIUS, GEAR, LAST_RADIUS, LENGTH, REVERSES, SIDE,
)
from push_navigation.approach.layout import lay_out
from push_navigation.approach.timing import duration

# Gears, sides, and senses of both curves.
SHAPES = 54
# Scanned candidates that are slower than the quickest by more than this are left out, and
# likewise refined ones [s]. Chosen: above what refining usually gains.
SCAN_MARGIN = 1.0
REFINE_MARGIN = 0.7
# Refined are at most so many shapes, in so many rounds. Measured on 300 approaches: with seven
# shapes none was quicker, with twelve rounds the mean by 4 ms.
REFINED_SHAPES = 4
HALVINGS = 8


@compiled
def evaluate(problem: ApproachProblem, candidate: Any, segments: Any, bound: float) -> float:
    """
    Compute the time of a candidate.

    :param candidate: its values.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :param bound: of the times that count [s].
    :return: time [s]; infinite where it is not below the bound, not a number where the object is
        in the way, the robot would move backwards too far, or there is no such candidate.
    """
    count = lay_out(problem, candidate, segments)
    if count == 0:
        return math.nan
    length = backwards = 0.0
    for i in range(count):
        length += segments[i, LENGTH]
        backwards += segments[i, LENGTH] * segments[i, REVERSES]
    if backwards > problem.reverse_limit:
        return math.nan
    if length >= bound * problem.speed:
        return math.inf
    time = duration(problem, segments, count)
    if time >= bound:
        return math.inf
    return time if keeps_clear(problem, segments, count) else math.nan


@compiled
def shape_of(candidate: Any) -> int:
    """
    Return the index of the shape of a candidate: gear, side, and sense of both curves.

    :param candidate: its values.
    """
    first = (candidate[FIRST_RADIUS] > 0.0) - (candidate[FIRST_RADIUS] < 0.0)
    last = (candidate[LAST_RADIUS] > 0.0) - (candidate[LAST_RADIUS] < 0.0)
    ends = 3 * (first + 1) + last + 1
    return 9 * (3 * (candidate[GEAR] > 0.0) + int(candidate[SIDE]) + 1) + ends


@compiled
def scan_sides(problem: ApproachProblem, row: Any, results: Any, segments: Any,
               quickest: float) -> float:
    """
    Keep a candidate on either side of the object where it is the quickest of its shape.

    :param row: values of the candidate, of which the side is changed.
    :param results: as of ``scan``, changed.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :param quickest: time of the quickest candidate so far [s].
    :return: the same now [s].
    """
    for side in (0.0, 1.0, -1.0):
        row[SIDE] = side
        best = results[shape_of(row)]
        time = evaluate(problem, row, segments, min(best[0], quickest + SCAN_MARGIN))
        if time < best[0]:
            best[0] = time
            quickest = min(quickest, time)
            for k in range(CANDIDATE_SIZE):
                best[1 + k] = row[k]
        # Where the object is not in the way, going round it is no quicker.
        if side == 0.0 and not math.isnan(time):
            break
    return quickest


@compiled
def scan(problem: ApproachProblem, starts: Any, ends: Any, results: Any, segments: Any) -> None:
    """
    Find the quickest candidate of each shape, among departures and arrivals.

    :param starts: values of candidates up to ``FIRST_RADIUS``, shape (n, CANDIDATE_SIZE).
    :param ends: the others, shape (m, CANDIDATE_SIZE).
    :param results: time and values for each shape, changed, shape
        (SHAPES + 1, CANDIDATE_SIZE + 2); its last row is scratch.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    """
    for i in range(SHAPES):
        results[i, 0] = math.inf
    quickest = math.inf
    row = results[SHAPES, 1:]
    for gear in (1.0, -1.0):
        if gear < 0.0 and not problem.starts_backwards:
            continue
        row[GEAR] = gear
        for i in range(len(starts)):
            for j in range(len(ends)):
                # In the gear in which it departs or arrives, the first or last curve is the arc.
                if starts[i, DEPARTURE_ANGLE] if gear < 0.0 else ends[j, ARRIVAL_ANGLE]:
                    continue
                for k in range(DIRECTION, CANDIDATE_SIZE):
                    row[k] = starts[i, k] if k < LAST_RADIUS else ends[j, k]
                quickest = scan_sides(problem, row, results, segments, quickest)


@compiled
def refine(problem: ApproachProblem, steps: Any, least: Any, results: Any, segments: Any) -> float:
    """
    Make the quickest candidates quicker, one value after the other.

    :param steps: first step of each number, 0 where it stays, shape (CANDIDATE_SIZE,).
    :param least: least magnitude of each number, shape (CANDIDATE_SIZE,).
    :param results: as of ``scan``, changed.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :return: time of the quickest [s].
    """
    quickest = math.inf
    for i in range(SHAPES):
        quickest = min(quickest, results[i, 0])
    for _ in range(REFINED_SHAPES):
        best = -1
        for i in range(SHAPES):
            is_refined = results[i, CANDIDATE_SIZE + 1] != 0.0
            if results[i, 0] < quickest + REFINE_MARGIN and not is_refined and (
                    best < 0 or results[i, 0] < results[best, 0]):
                best = i
        if best < 0:
            break
        refine_one(problem, steps, least, results[best], segments)
        results[best, CANDIDATE_SIZE + 1] = 1.0
        quickest = min(quickest, results[best, 0])
    return quickest


@compiled
def refine_one(problem: ApproachProblem, steps: Any, least: Any, row: Any, segments: Any) -> None:
    """
    Make one candidate quicker by pattern search.

    :param steps: first step of each number, 0 where it stays, shape (CANDIDATE_SIZE,).
    :param least: least magnitude of each number, shape (CANDIDATE_SIZE,).
    :param row: time and values, changed, shape (CANDIDATE_SIZE + 2,).
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    """
    candidate = row[1:]
    scale = 1.0
    for _ in range(HALVINGS):
        for k in range(DIRECTION, CANDIDATE_SIZE):
            value = candidate[k]
            # A turn in place stays one; an arc that is not there stays away.
            if steps[k] == 0.0 or (value == 0.0 and (k == FIRST_RADIUS or k == LAST_RADIUS)):
                continue
            # Both senses count alike, so that mirror images stay mirror images.
            chosen = value
            for sign in (1.0, -1.0):
                trial = value + sign * scale * steps[k]
                # Straight lines have no sense; one of no length becomes no shorter.
                if trial < 0.0 and (k == DEPARTURE or k == ARRIVAL):
                    trial = least[k]
                if k != DIRECTION and (abs(trial) < least[k] or trial * value < 0.0):
                    trial = math.copysign(least[k], value)
                candidate[k] = trial
                time = evaluate(problem, candidate, segments, row[0])
                if time < row[0]:
                    row[0], chosen = time, trial
            candidate[k] = chosen
        scale *= 0.6
