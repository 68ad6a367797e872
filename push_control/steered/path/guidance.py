"""Guidance: follows the path of z, and plans another one where the present one will not do."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.path.path import (
    FlatOutputPath, PathProjection, project_on_path, PROJECTION_SIZE)
from push_model.geometry import FloatArray, Pose

# How much of the friction cone new paths may use: at least so much of their part of it, and less
# by this factor with every approach that has missed. Chosen: wider turns miss by less where
# supports rub otherwise than their nominal values.
MIN_CAUTION = 0.5
CAUTION_FACTOR = 0.8
# Draws a path to the goal from a pose of z in its goal frame; None where none may be followed.
PathSource: TypeAlias = Callable[[Pose], FlatOutputPath | None]


class Guidance:
    """
    Follows a path, and decides when to leave it for another.

    ``rows``: those of the path. ``projection``: numbers of the last ``PathProjection``; on a new
    path, of its start. ``planned_length``: length of the first path [m].
    ``path_replans``: number of new paths. ``reapproaches``: number of further approaches.
    """

    def __init__(self, path: FlatOutputPath, settings: ControlSettings):
        """Start at the start of a path."""
        self._path = path
        self._settings = settings
        self.rows = path.rows
        self.projection: FloatArray = np.zeros(PROJECTION_SIZE)
        self._time_since_replan = settings.replan_period
        self.planned_length = path.length
        self.path_replans = 0
        self.reapproaches = 0
        # Changes nothing; but loads machine code before the robot moves.
        project_on_path(path, path.at(0.0).pose, np.zeros(PROJECTION_SIZE))
        path.curvatures(0.0, self.projection)

    def project(self, pose: Pose) -> PathProjection:
        """
        Project z on the path, near its last projection.

        :param pose: ``Pose`` of z in its goal frame.
        """
        return project_on_path(self._path, pose, self.projection)

    @property
    def last_projection(self) -> PathProjection:
        """The last ``PathProjection``."""
        return PathProjection(*self.projection.tolist())

    def restart(self) -> None:
        """Look for the next projection at the start of the path."""
        self.projection[:] = 0.0

    def preview(self, distances: FloatArray) -> FloatArray:
        """
        Look ahead along the path.

        :param distances: beyond the last projection [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        return self._path.curvatures(self.projection[0], distances)

    def is_due(self, remaining_distance: float, keeps_path: bool, travelled_distance: float,
               dt: float) -> bool:
        """
        Tell whether it is time to look for another path.

        :param remaining_distance: arc length to the end of the present path [m].
        :param keeps_path: whether z is near the present path, and that keeps to the limits.
        :param travelled_distance: path length of the contact since the start [m].
        :param dt: time since the last call [s].
        :return: whether the present path cannot be kept, or is about to end.
        """
        settings = self._settings
        self._time_since_replan += dt
        if keeps_path and remaining_distance >= settings.reapproach_distance:
            return False
        return (self._time_since_replan >= settings.replan_period
                and travelled_distance >= settings.replan_min_distance)

    def update(self, pose: Pose, projection: PathProjection,
               draw_path: PathSource) -> PathProjection:
        """
        Plan a new path, where that is due, if it is worth its length.

        :param pose: ``Pose`` of z in its goal frame.
        :param projection: ``PathProjection`` on the present path.
        :return: ``PathProjection`` on the path that is followed from now on.
        """
        settings = self._settings
        if projection.remaining_distance < settings.reapproach_distance:
            return self._reapproach_in_time(pose, projection, draw_path)
        self._time_since_replan = 0.0
        path = draw_path(pose)
        longest = settings.replan_length_ratio * projection.remaining_distance
        if path is None or path.length > longest:
            return projection
        self.path_replans += 1
        return self._follow(path, pose)

    def cone_fraction(self, center_error_ratio: float) -> float:
        """
        Fraction of the cone that new paths may use, of what the settings allow them.

        :param center_error_ratio: distance of the centre of friction from its nominal place, over
            that from the contact: where it is large, supports rub otherwise than their nominal
            values, and so rotate otherwise.
        :return: fraction, the smaller the larger that is, and the more approaches have missed.
        """
        return (max(MIN_CAUTION, 1.0 - center_error_ratio)
                * CAUTION_FACTOR ** self.reapproaches)

    def reapproach(self, pose: Pose, draw_path: PathSource) -> PathProjection | None:
        """
        Approach the goal again, where number and room allow it.

        :param pose: ``Pose`` of z in its goal frame.
        :return: ``PathProjection`` on the new path, or None where there is none.
        """
        if self.reapproaches >= self._settings.max_reapproaches:
            return None
        path = draw_path(pose)
        if path is None:
            return None
        self.reapproaches += 1
        return self._follow(path, pose)

    def _reapproach_in_time(self, pose: Pose, projection: PathProjection,
                            draw_path: PathSource) -> PathProjection:
        """Approach the goal again before the end of a path that will miss it."""
        settings = self._settings
        ratio = settings.reapproach_tolerance_ratio
        if (abs(projection.lateral_error) <= ratio * settings.position_tolerance
                and abs(projection.heading_error) <= ratio * settings.heading_tolerance):
            return projection
        self._time_since_replan = 0.0
        again = self.reapproach(pose, draw_path)
        return projection if again is None else again

    def _follow(self, path: FlatOutputPath, pose: Pose) -> PathProjection:
        self._path = path
        self.rows = path.rows
        self.restart()
        self._time_since_replan = 0.0
        return self.project(pose)
