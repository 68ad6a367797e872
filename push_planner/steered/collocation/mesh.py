"""
Mesh of a push: its collocation steps, and the speed over them.

A push is divided into sections: acceleration, main section, deceleration, final straight. The
sections have fixed lengths, but for the main one, whose free length S is a variable of the
program. The steps of a section are equally long, but for shorter ones at both ends of the main
section.
"""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, IntArray
from push_planner.problem import PushProblem
from push_planner.steered.collocation.speed_profile import speed_profile, SpeedProfile

# Steps of an acceleration or a deceleration, and of a final straight. Chosen: V is linear in s
# there, so that few are enough.
RAMP_STEPS = 3
STRAIGHT_STEPS = 3
# Least number of steps of pushes at constant angles, whose segments are divided into as many.
# Chosen: the default number of segments of linear angles.
MIN_CONSTANT_ANGLE_STEPS = 24
# Numbers of segments above the least one are multiples of this. Chosen: a program is built for
# each number, which takes longer than solving it.
SEGMENT_COUNT_STEP = 8
# Factor on the number of segments, per speed [s/m]; rounded, and at least 1. Measured: with
# inertia it takes finer steering to follow the edge of the cone. With 3, and no refinement after
# it, 193 pushes at 0.4 m/s and more took 10 to 20 % more CPU time, and led to pushes as long.
SPEED_FACTOR = 2.0
# Longest segment over the wheelbase. Measured: of 120 pushes of squares and random boxes, 95 %
# come within 0.2 % of the best of 24 random starts with finer meshes; with 1 it is 0.35 %.
SEGMENT_RATIO = 2.0 / 3.0
# Number of shorter segments at either end of the main section, and their length over that of the
# others. Measured: angles change fastest where a push begins, and towards the heading at the goal.
# Of 100 pushes of a square each, with as many segments, those with a straight end take 0.45 % less
# time (mean, at most 1.5 %), those of a differential drive at a vertex 0.28 %; others as much.
END_SEGMENTS = 2
END_SEGMENT_RATIO = 0.5
# Longest segment of a differential drive that ends straight, over that of others. Measured: its
# heading settles within its radius; in segments as long as the wheelbase 40 pushes took 1.6 % more
# (median, at most 3.7 %).
STRAIGHT_DRIVE_RATIO = 0.75


@dataclasses.dataclass(frozen=True, eq=False)
class MeshSection:
    """
    Steps of a push, equal but for those at both ends.

    :param steps: n, their number.
    :param length: fixed length of the section [m]; 0 in the main section.
    :param free_fraction: fraction of S that the section has: 1 in the main section, else 0.
    :param v_squared: V at its start [m^2/s^2].
    :param v_squared_slope: dV/ds [m/s^2].
    :param may_steer: 1 where the pushing angle may change, else 0, shape (n,).
    :param end_ratio: length of the steps at both ends over that of the others.
    """

    steps: int
    length: float
    free_fraction: float
    v_squared: float
    v_squared_slope: float
    may_steer: FloatArray
    end_ratio: float = 1.0

    def step_fractions(self) -> FloatArray:
        """Lengths of the steps over that of the section."""
        lengths = np.ones(self.steps)
        lengths[:END_SEGMENTS] = lengths[-END_SEGMENTS:] = self.end_ratio
        return lengths / lengths.sum()

    def step_v_squared(self) -> FloatArray:
        """Squared speeds V at the starts of the steps [m^2/s^2]."""
        fractions = self.step_fractions()
        starts = self.length * (np.cumsum(fractions) - fractions)
        return self.v_squared + self.v_squared_slope * starts


class Mesh(NamedTuple):
    """
    Steps of a push; all arrays have shape (n,).

    :param lengths: fixed part of the length of each step [m].
    :param free_fractions: fraction of S of each step.
    :param v_squared: V at its start [m^2/s^2].
    :param v_squared_slopes: dV/ds [m/s^2].
    :param may_steer: 1 where the pushing angle may change, else 0.
    :param fixed_length: length of all steps but for S [m].
    """

    lengths: FloatArray
    free_fractions: FloatArray
    v_squared: FloatArray
    v_squared_slopes: FloatArray
    may_steer: FloatArray
    fixed_length: float

    @classmethod
    def of_sections(cls, sections: list[MeshSection]) -> 'Mesh':
        """
        Join sections.

        :param sections: of the push, in order.
        """
        lengths = np.concatenate([s.length * s.step_fractions() for s in sections])
        return cls(lengths,
                   np.concatenate([s.free_fraction * s.step_fractions() for s in sections]),
                   np.concatenate([s.step_v_squared() for s in sections]),
                   np.concatenate([np.full(s.steps, s.v_squared_slope) for s in sections]),
                   np.concatenate([s.may_steer for s in sections]), float(lengths.sum()))

    def divided(self, parts: IntArray) -> 'Mesh':
        """
        Divide each step into a number of equal ones.

        :param parts: number of the parts of each step, shape (n,).
        """
        lengths, v_squared, v_squared_slopes = (
            np.repeat(values, parts)
            for values in (self.lengths / parts, self.v_squared, self.v_squared_slopes))
        within = np.arange(len(lengths)) - np.repeat(np.cumsum(parts) - parts, parts)
        return Mesh(lengths, np.repeat(self.free_fractions / parts, parts),
                    v_squared + v_squared_slopes * within * lengths, v_squared_slopes,
                    np.repeat(self.may_steer, parts), self.fixed_length)

    @property
    def end_v_squared(self) -> FloatArray:
        """Squared speeds V at the ends of the steps [m^2/s^2]."""
        return self.v_squared + self.v_squared_slopes * self.lengths

    def step_lengths(self, free_length: float) -> FloatArray:
        """
        Lengths of the steps [m].

        :param free_length: S [m].
        """
        return self.lengths + self.free_fractions * free_length

    def step_times(self, free_length: float) -> FloatArray:
        """
        Durations of the steps [s].

        :param free_length: S [m].
        """
        return 2.0 * self.step_lengths(free_length) / (
            np.sqrt(self.v_squared) + np.sqrt(self.end_v_squared))


def build_mesh(problem: PushProblem, path_length: float, final_straight: float,
               refined: bool = False) -> Mesh:
    """
    Divide a push into steps.

    :param path_length: approximate path length of the contact, final straight included [m].
    :param final_straight: length of the straight push at the end [m]; 0: none.
    :param refined: whether linear pushing angles get twice as many segments.
    """
    profile = speed_profile(problem.settings, problem.motion, path_length)
    jumps = problem.settings.pushing_angles == 'constant'
    segments = _segment_count(problem, path_length, profile, final_straight, refined)
    sections: list[MeshSection] = []
    # Angles that jump are constant on ramps.
    ramp_steering = 0.0 if jumps else 1.0
    if profile.rise_length > 0.0:
        sections.append(MeshSection(RAMP_STEPS, profile.rise_length, 0.0, profile.v_squared_start,
                                    profile.rise_slope, np.full(RAMP_STEPS, ramp_steering)))
    sections.append(_main_section(segments, profile.v_squared_max, jumps))
    sections += _final_sections(profile, final_straight, ramp_steering, path_length / segments)
    return Mesh.of_sections(sections)


def _segment_count(problem: PushProblem, path_length: float, profile: SpeedProfile,
                   final_straight: float, refined: bool) -> int:
    """Count the segments of the pushing angle in the main section."""
    settings = problem.settings
    segments = settings.segments
    longest = settings.segment_length
    if settings.pushing_angles != 'constant':
        factor = 1
        if settings.motion_model == 'dynamic':
            factor = max(1, round(SPEED_FACTOR * math.sqrt(profile.v_squared_max)))
        if refined:
            factor *= 2
        segments *= factor
        # In a longer segment than the wheelbase a push runs away from its path.
        longest = min(longest, SEGMENT_RATIO * problem.vehicle.wheelbase) / factor
        if problem.kind == 'differential' and final_straight > 0.0:
            longest *= STRAIGHT_DRIVE_RATIO
    if path_length > segments * longest:
        segments = SEGMENT_COUNT_STEP * math.ceil(path_length / longest / SEGMENT_COUNT_STEP)
    return segments


def _main_section(segments: int, v_squared: float, jumps: bool) -> MeshSection:
    if not jumps:
        return MeshSection(segments, 0.0, 1.0, v_squared, 0.0, np.full(segments, 1.0),
                           END_SEGMENT_RATIO)
    steps_per_segment = max(1, MIN_CONSTANT_ANGLE_STEPS // segments)
    steps = segments * steps_per_segment
    # The angle jumps at the start of a segment, but for the first one, where it is set anyhow.
    may_steer = (np.arange(steps) % steps_per_segment == 0).astype(float)
    may_steer[0] = 0.0
    return MeshSection(steps, 0.0, 1.0, v_squared, 0.0, may_steer)


def _final_sections(profile: SpeedProfile, final_straight: float, ramp_steering: float,
                    longest_step: float) -> list[MeshSection]:
    """Deceleration and final straight, whichever begins first."""
    top = profile.v_squared_max
    slope = profile.fall_slope
    sections: list[MeshSection] = []
    steered_fall = max(0.0, profile.fall_length - final_straight)
    straight_fall = min(profile.fall_length, final_straight)
    if steered_fall > 0.0:
        steps = max(RAMP_STEPS, math.ceil(steered_fall / longest_step))
        sections.append(MeshSection(steps, steered_fall, 0.0, top, slope,
                                    np.full(steps, ramp_steering)))
    no_steering = np.zeros(STRAIGHT_STEPS)
    if final_straight > profile.fall_length:
        sections.append(MeshSection(STRAIGHT_STEPS, final_straight - profile.fall_length, 0.0, top,
                                    0.0, no_steering))
    if straight_fall > 0.0:
        sections.append(MeshSection(STRAIGHT_STEPS, straight_fall, 0.0, top + slope * steered_fall,
                                    slope, no_steering))
    return sections
