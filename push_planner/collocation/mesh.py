"""
Steps of a push and its speed: ``V = v^2`` rises after a soft start, and falls before the goal.

Ramps and the straight run-in have fixed lengths; the way S between them is the programme's.
"""

import math
from typing import NamedTuple

import numpy as np
from push_planner.collocation.speed_profile import ramps

RAMP_STEPS = 3
RUN_IN_STEPS = 3
SUB_STEPS = 24
COUNT_STEP = 8
FAST, FINER = 0.4, 0.8


class Mesh(NamedTuple):
    """
    Steps of a push; all arrays have shape (n,).

    :param lengths: fixed part of each step [m].
    :param shares: share of S of each step.
    :param squares: V at its begin [m^2/s^2].
    :param slopes: dV/ds [m/s^2].
    :param free: 1 where the pushing angle may change.
    :param speed: highest speed of the contact [m/s].
    :param fixed: length of all steps but for S [m].
    """

    lengths: np.ndarray
    shares: np.ndarray
    squares: np.ndarray
    slopes: np.ndarray
    free: np.ndarray
    speed: float
    fixed: float

    @property
    def ends(self):
        """The squared speeds V at the ends of the steps [m^2/s^2]."""
        return self.squares + self.slopes * self.lengths

    def steps(self, way):
        """
        Lengths of the steps [m].

        :param way: S [m].
        """
        return self.lengths + self.shares * way

    def times(self, way):
        """
        Durations of the steps [s].

        :param way: S [m].
        """
        return 2.0 * self.steps(way) / (np.sqrt(self.squares) + np.sqrt(self.ends))


def build_mesh(problem, way, final_straight, finer=False):
    """
    Divide a push into steps.

    :param problem: the ``PushProblem``.
    :param way: way of the contact, about, run-in included [m].
    :param final_straight: straight push at its end [m]; 0: none.
    :param finer: whether linear pushing angles get twice as many pieces.
    :return: ``Mesh``.
    """
    settings = problem.settings
    speeds = ramps(settings, problem.motion, way)
    jumps = settings.pushing_angles == 'constant'
    pieces, longest = settings.segments, settings.segment_length
    if not jumps:
        # With inertia it takes finer steering to follow the cone's edge; and in a longer piece
        # than the wheelbase a push runs away from its path.
        share = FINER if speeds.highest > FAST ** 2 else 1.0
        longest = min(share * longest, problem.vehicle.wheelbase)
        if finer:
            pieces, longest = 2 * pieces, 0.5 * longest
    if way > pieces * longest:
        # Few different numbers of pieces: a programme is built for each.
        pieces = COUNT_STEP * math.ceil(way / longest / COUNT_STEP)
    per_piece = max(1, SUB_STEPS // pieces) if jumps else 1
    stretches = []
    if speeds.rise > 0.0:
        stretches.append((RAMP_STEPS, speeds.rise, 0.0, speeds.first,
                          (speeds.highest - speeds.first) / speeds.rise, 0.0 if jumps else 1.0))
    stretches.append((pieces * per_piece, 0.0, 1.0, speeds.highest, 0.0, 1.0))
    stretches += _ending(speeds, final_straight, 0.0 if jumps else 1.0, way / pieces)
    columns = [np.concatenate([np.full(n, value / n if i < 2 else value)
                               for n, *values in stretches for value in (values[i],)])
               for i in range(5)]
    lengths, shares, squares, slopes, free = columns
    begin = 0
    for n, length, _, _, slope, _ in stretches:
        squares[begin:begin + n] += slope * length / n * np.arange(n)
        begin += n
    if jumps:
        main = stretches[0][0] if speeds.rise > 0.0 else 0
        free[main:main + pieces * per_piece] = np.arange(pieces * per_piece) % per_piece == 0
        free[main] = 0.0
    return Mesh(lengths, shares, squares, slopes, free, math.sqrt(speeds.highest),
                float(lengths.sum()))


def _ending(speeds, final_straight, free, longest):
    """Stretches (steps, length, share, V, dV/ds, free) of braking and run-in."""
    slope = (speeds.last - speeds.highest) / speeds.fall if speeds.fall > 0.0 else 0.0
    found = []
    early, straight = max(0.0, speeds.fall - final_straight), min(speeds.fall, final_straight)
    if early > 0.0:
        steps = max(RAMP_STEPS, math.ceil(early / longest))
        found.append((steps, early, 0.0, speeds.highest, slope, free))
    if final_straight > speeds.fall:
        found.append((RUN_IN_STEPS, final_straight - speeds.fall, 0.0, speeds.highest, 0.0, 0.0))
    if straight > 0.0:
        found.append((RUN_IN_STEPS, straight, 0.0, speeds.highest + slope * early, slope, 0.0))
    return found
