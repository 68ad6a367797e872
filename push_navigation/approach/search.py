"""Search for the quickest manoeuvre: a coarse scan of shapes, a pattern search of the best."""

import math
from typing import Any

from push_dynamics.compiled import compiled
from push_navigation.approach.clearance import keeps_clear
from push_navigation.approach.encoding import (
    ARRIVAL, ARRIVAL_ANGLE, DEPARTURE, DEPARTURE_ANGLE, DIRECTION, FIRST_RADIUS, GEAR,
    LAST_RADIUS, LENGTH, MANOEUVRE_SIZE, Manoeuvring, REVERSES, SIDE,
)
from push_navigation.approach.layout import lay_out
from push_navigation.approach.timing import duration

# Gears, sides, and senses of both curves.
SHAPES = 54
# Scanned manoeuvres that are slower than the quickest by more than this are left out, and
# likewise refined ones [s]. Chosen: above what refining usually gains.
SCAN_MARGIN = 1.0
REFINE_MARGIN = 0.7
# Refined are at most so many shapes, in so many rounds. Measured on 300 approaches: with seven
# shapes none was quicker, with twelve rounds the mean by 4 ms.
REFINED_SHAPES = 4
HALVINGS = 8


@compiled
def evaluate(given: Manoeuvring, manoeuvre: Any, segments: Any, bound: float) -> float:
    """
    Compute the time of a manoeuvre.

    :param given: ``Manoeuvring``.
    :param manoeuvre: its numbers.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :param bound: of the times that count [s].
    :return: time [s]; infinite where it is not below the bound, not a number where the object is
        in the way, the robot would move backwards too far, or there is no such manoeuvre.
    """
    count = lay_out(given, manoeuvre, segments)
    if count == 0:
        return math.nan
    length = backwards = 0.0
    for i in range(count):
        length += segments[i, LENGTH]
        backwards += segments[i, LENGTH] * segments[i, REVERSES]
    if backwards > given.reverse_limit:
        return math.nan
    if length >= bound * given.speed:
        return math.inf
    time = duration(given, segments, count)
    if time >= bound:
        return math.inf
    return time if keeps_clear(given, segments, count) else math.nan


@compiled
def shape_of(manoeuvre: Any) -> int:
    """
    Return the number of the shape of a manoeuvre: gear, side, and sense of both curves.

    :param manoeuvre: its numbers.
    """
    first = (manoeuvre[FIRST_RADIUS] > 0.0) - (manoeuvre[FIRST_RADIUS] < 0.0)
    last = (manoeuvre[LAST_RADIUS] > 0.0) - (manoeuvre[LAST_RADIUS] < 0.0)
    number = 3 * (first + 1) + last + 1
    return 9 * (3 * (manoeuvre[GEAR] > 0.0) + int(manoeuvre[SIDE]) + 1) + number


@compiled
def scan_sides(given: Manoeuvring, row: Any, found: Any, segments: Any, quickest: float) -> float:
    """
    Keep a manoeuvre on either side of the object where it is the quickest of its shape.

    :param given: ``Manoeuvring``.
    :param row: numbers of the manoeuvre, of which the side is changed.
    :param found: as of ``scan``, changed.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :param quickest: time of the quickest manoeuvre so far [s].
    :return: the same now [s].
    """
    for side in (0.0, 1.0, -1.0):
        row[SIDE] = side
        best = found[shape_of(row)]
        time = evaluate(given, row, segments, min(best[0], quickest + SCAN_MARGIN))
        if time < best[0]:
            best[0] = time
            quickest = min(quickest, time)
            for k in range(MANOEUVRE_SIZE):
                best[1 + k] = row[k]
        # Where the object is not in the way, going round it is no quicker.
        if side == 0.0 and not math.isnan(time):
            break
    return quickest


@compiled
def scan(given: Manoeuvring, starts: Any, ends: Any, found: Any, segments: Any) -> None:
    """
    Find the quickest manoeuvre of each shape, among given departures and arrivals.

    :param given: ``Manoeuvring``.
    :param starts: numbers of manoeuvres up to ``FIRST_RADIUS``, shape (n, MANOEUVRE_SIZE).
    :param ends: the others, shape (m, MANOEUVRE_SIZE).
    :param found: time and numbers for each shape, changed, shape (SHAPES + 1, MANOEUVRE_SIZE + 2);
        its last row is scratch.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    """
    for i in range(SHAPES):
        found[i, 0] = math.inf
    quickest = math.inf
    row = found[SHAPES, 1:]
    for gear in (1.0, -1.0):
        if gear < 0.0 and not given.starts_backwards:
            continue
        row[GEAR] = gear
        for i in range(len(starts)):
            for j in range(len(ends)):
                # In the gear in which it departs or arrives, the first or last curve is the arc.
                if starts[i, DEPARTURE_ANGLE] if gear < 0.0 else ends[j, ARRIVAL_ANGLE]:
                    continue
                for k in range(DIRECTION, MANOEUVRE_SIZE):
                    row[k] = starts[i, k] if k < LAST_RADIUS else ends[j, k]
                quickest = scan_sides(given, row, found, segments, quickest)


@compiled
def refine(given: Manoeuvring, steps: Any, least: Any, found: Any, segments: Any) -> float:
    """
    Make the quickest manoeuvres quicker, one number after the other.

    :param given: ``Manoeuvring``.
    :param steps: first step of each number, 0 where it stays, shape (MANOEUVRE_SIZE,).
    :param least: least magnitude of each number, shape (MANOEUVRE_SIZE,).
    :param found: as of ``scan``, changed.
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    :return: time of the quickest [s].
    """
    quickest = math.inf
    for i in range(SHAPES):
        quickest = min(quickest, found[i, 0])
    for _ in range(REFINED_SHAPES):
        best = -1
        for i in range(SHAPES):
            if found[i, 0] < quickest + REFINE_MARGIN and found[i, MANOEUVRE_SIZE + 1] == 0.0 and (
                    best < 0 or found[i, 0] < found[best, 0]):
                best = i
        if best < 0:
            break
        refine_one(given, steps, least, found[best], segments)
        found[best, MANOEUVRE_SIZE + 1] = 1.0
        quickest = min(quickest, found[best, 0])
    return quickest


@compiled
def refine_one(given: Manoeuvring, steps: Any, least: Any, row: Any, segments: Any) -> None:
    """
    Make one manoeuvre quicker by pattern search.

    :param given: ``Manoeuvring``.
    :param steps: first step of each number, 0 where it stays, shape (MANOEUVRE_SIZE,).
    :param least: least magnitude of each number, shape (MANOEUVRE_SIZE,).
    :param row: time and numbers, changed, shape (MANOEUVRE_SIZE + 2,).
    :param segments: scratch, shape (s, SEGMENT_SIZE).
    """
    manoeuvre = row[1:]
    scale = 1.0
    for _ in range(HALVINGS):
        for k in range(DIRECTION, MANOEUVRE_SIZE):
            value = manoeuvre[k]
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
                manoeuvre[k] = trial
                time = evaluate(given, manoeuvre, segments, row[0])
                if time < row[0]:
                    row[0], chosen = time, trial
            manoeuvre[k] = chosen
        scale *= 0.6
