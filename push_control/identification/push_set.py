"""Recorded pushes of one object: where they end with other friction, and how ends depend on it."""

from collections.abc import Hashable
import math
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_control.identification.friction_changes import (
    changed_loaded_supports, CONTACT_FRICTION, mean_square, nominal_unknowns, PATTERNS,
)
from push_control.identification.recorded_push import RecordedPush, stacked
from push_model.analysis.sliding_contact import SupportArrays
from push_model.analysis.slow_push import integrate_slow_pushes, LoadedSupports, Shape
from push_model.geometry import FloatArray, wrap_angles
from push_model.parameters import PushedObject

# Chosen: points of each path; the ends change by less than 0.5 % of the push with twice as many.
POINTS = 31
# Steps of the differences: metres, and logarithms. Chosen: far above rounding.
DIFFERENCES = (1e-3, 1e-3, 0.02, 0.02, 0.02)
PATTERN_DIFFERENCE = 0.02


class Linearization(NamedTuple):
    """
    How n pushes end, and how that depends on u unknowns.

    :param slope: derivatives of the residuals, shape (3 n, u).
    :param residuals: ends minus recorded ends (x, y, l theta), shape (3 n,) [m].
    :param slides: whether the contact slides at some time, shape (n,).
    """

    slope: FloatArray
    residuals: FloatArray
    slides: NDArray[np.bool_]


class PushSet(NamedTuple):
    """
    Stacked pushes of a nominal object.

    :param obj: nominal object.
    :param robot_radius: R_p [m].
    :param starts: poses of the object, shape (n, 3) [m, rad].
    :param ends: poses of the object, shape (n, 3) [m, rad].
    :param paths: poses of the robot, shape (n, POINTS, 3) [m, rad].
    """

    obj: PushedObject
    robot_radius: float
    starts: FloatArray
    ends: FloatArray
    paths: FloatArray

    @classmethod
    def of(cls, obj: PushedObject, robot_radius: float,
           pushes: Sequence[RecordedPush]) -> 'PushSet':
        """Stack pushes."""
        return cls(obj, robot_radius, *stacked(pushes, POINTS))

    @property
    def nominal(self) -> FloatArray:
        """Unknowns of the nominal object, shape (u,)."""
        return nominal_unknowns(self.obj)

    @property
    def length(self) -> float:
        """Length that makes angles lengths: the root of the mean square distance from F [m]."""
        return math.sqrt(mean_square(SupportArrays.of(self.obj)))

    def differences(self, unknowns: FloatArray) -> FloatArray:
        """Unknowns, and those with each of them changed by a step, shape (1 + u, u)."""
        return np.vstack([unknowns, unknowns + np.diag(_steps(len(unknowns)))])

    def supports(self, unknowns: FloatArray) -> LoadedSupports:
        """Supports of k sets of unknowns (k, u), for each of the n pushes of a set."""
        return LoadedSupports.stacked(
            [changed_loaded_supports(self.obj, row) for row in unknowns
             for _ in range(len(self.starts))])

    def ends_apart(self, ends: FloatArray) -> FloatArray:
        """
        Subtract recorded from integrated ends.

        :param ends: of k sets of unknowns, shape (k n, 3) [m, rad].
        :return: residuals (x, y, l theta), shape (k, 3 n) [m].
        """
        residuals = ends - np.tile(self.ends, (len(ends) // len(self.ends), 1))
        residuals[:, 2] = self.length * wrap_angles(residuals[:, 2])
        return residuals.reshape(-1, 3 * len(self.ends))


class Residuals(NamedTuple):
    """
    How the n pushes of a set end for k sets of unknowns.

    :param ends: minus recorded ends (x, y, l theta), shape (k, 3 n) [m].
    :param slides: whether the contact slides at some time, shape (k, n).
    """

    ends: FloatArray
    slides: NDArray[np.bool_]

    def linearized(self) -> Linearization:
        """Differentiate, where the unknowns are those of ``PushSet.differences``."""
        slope = ((self.ends[1:] - self.ends[0]) / _steps(len(self.ends) - 1)[:, None]).T
        return Linearization(slope, self.ends[0], self.slides[0])


def integrated(sets: Sequence[PushSet], unknowns: Sequence[FloatArray]) -> list[Residuals]:
    """
    Integrate the pushes of all sets, those of equal shape at once.

    :param sets: pushes of each object.
    :param unknowns: sets of unknowns for each object, shapes (k, u).
    :return: how they end, object by object.
    """
    groups: dict[Hashable, list[int]] = {}
    for index, one in enumerate(sets):
        shape = (one.obj.outline, one.obj.radius, one.robot_radius, len(one.obj.supports))
        groups.setdefault(shape, []).append(index)
    results: dict[int, Residuals] = {}
    for indices in groups.values():
        results.update(zip(indices, _integrated_group([sets[index] for index in indices],
                                                      [unknowns[index] for index in indices])))
    return [results[index] for index in range(len(sets))]


def _integrated_group(sets: Sequence[PushSet], unknowns: Sequence[FloatArray]) -> list[Residuals]:
    """Integrate the pushes of objects of one shape and one number of supports."""
    supports = LoadedSupports.stacked(
        [one.supports(rows) for one, rows in zip(sets, unknowns)])
    friction = [np.repeat(np.exp(rows[:, CONTACT_FRICTION]), len(one.starts))
                for one, rows in zip(sets, unknowns)]
    starts = [np.tile(one.starts, (len(rows), 1)) for one, rows in zip(sets, unknowns)]
    paths = [np.tile(one.paths, (len(rows), 1, 1)) for one, rows in zip(sets, unknowns)]
    pushes = integrate_slow_pushes(
        Shape.of(sets[0].obj), supports, np.concatenate(friction), sets[0].robot_radius,
        np.concatenate(starts), np.concatenate(paths))
    bounds = np.cumsum([len(rows) for rows in starts])[:-1]
    return [Residuals(one.ends_apart(ends), (slides != 0).any(axis=1).reshape(len(rows), -1))
            for one, rows, ends, slides in zip(
                sets, unknowns, np.split(pushes.poses[:, -1], bounds),
                np.split(pushes.slides, bounds))]


def _steps(unknowns: int) -> FloatArray:
    return np.array([*DIFFERENCES, *[PATTERN_DIFFERENCE] * (unknowns - PATTERNS)])
