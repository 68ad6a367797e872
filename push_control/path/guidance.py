"""Follows the path of z, and draws a new one where the old one no longer serves."""

from typing import NamedTuple

import numpy as np
from push_control.path.path import path_to_goal, project_on_path

# What is believed of the pose is off by some millimetres itself.
ARRIVED_SHARE = 0.85
LEAST_CARE, GENTLER = 0.5, 0.8
LOOKS_AHEAD = np.linspace(0.0, 1.0, 11)


class PathProjection(NamedTuple):
    """
    Where z is on its path.

    :param lateral_error: left of the path is positive [m].
    :param heading_error: to the left is positive [rad].
    :param curvature: of the path [1/m].
    :param remaining_distance: way that is left [m].
    """

    lateral_error: float
    heading_error: float
    curvature: float
    remaining_distance: float


class Guidance:
    """One path, the place on it, and when to leave it for another."""

    def __init__(self, path, settings):
        """
        Begin at the start of a path.

        :param path: ``SampledPath`` or ``FinalStraightPath``.
        :param settings: ``ControlSettings``.
        """
        self._path, self._settings = path, settings
        self._way = 0.0
        self._since_new = settings.replan_period
        self.budget = path.length
        self.path_replans = 0
        self.reapproaches = 0

    def follow(self, pose):
        """
        Find z on the path.

        :param pose: ``Pose`` of z in the frame of the z-goal.
        :return: ``PathProjection``.
        """
        self._way, aside, turned, curvature = project_on_path(self._path, pose, self._way)
        return PathProjection(aside, turned, curvature, self._path.length - self._way)

    def preview(self, ways):
        """
        Look ahead along the path.

        :param ways: beyond the place found last [m], shape (n,).
        :return: curvatures [1/m], shape (n,).
        """
        return self._path.curvatures(self._way + ways)

    def revise(self, pose, track, limits, firm, travelled_distance, dt):
        """
        Draw a new path if errors or limits ask for it and it is worth its length.

        :param pose: ``Pose`` of z in the frame of the z-goal.
        :param track: ``PathProjection`` on the present path.
        :param limits: ``CurvatureLimits`` for a new path.
        :param firm: ``CurvatureLimits`` that no path may exceed.
        :param travelled_distance: way of the contact since the start [m].
        :param dt: time since the last call [s].
        :return: ``PathProjection`` on the path that now holds.
        """
        settings = self._settings
        self._since_new += dt
        if self._since_new < settings.replan_period or travelled_distance < settings.replan_min_distance:
            return track
        if track.remaining_distance < settings.reapproach_distance:
            far = self.is_off(track, settings.reapproach_tolerance_ratio)
            return self.reapproach(pose, limits) or track if far else track
        if (abs(track.lateral_error) <= settings.replan_lateral_error
                and abs(track.heading_error) <= settings.replan_heading_error
                and not self._is_too_sharp(track, firm)):
            return track
        self._since_new = 0.0
        path = path_to_goal(pose, limits, settings.final_straight)
        if path.length > settings.replan_length_ratio * track.remaining_distance:
            return track
        self.path_replans += 1
        return self._take(path, pose)

    def _is_too_sharp(self, track, firm):
        ahead = self.preview(np.minimum(LOOKS_AHEAD, track.remaining_distance))
        return ahead.max() > firm.high or ahead.min() < firm.low

    def is_off(self, track, share=1.0):
        """
        Tell whether the errors exceed a share of the tolerances.

        :param track: ``PathProjection``.
        :param share: of the tolerances.
        """
        settings = self._settings
        return (abs(track.lateral_error) > share * settings.position_tolerance
                or abs(track.heading_error) > share * settings.heading_tolerance)

    def care(self, wrong):
        """
        Share of the cone for new paths.

        :param wrong: how far the friction centre is from where it was believed, over its distance
            from the contact: supports rub otherwise than believed, and so turn otherwise.
        :return: less the more that is, and with every turn that has missed.
        """
        return max(LEAST_CARE, 1.0 - wrong) * GENTLER ** self.reapproaches

    def arrive(self, pose, track, limits):
        """
        Approach the goal anew unless the push has come near enough.

        :param pose: ``Pose`` of z in the frame of the z-goal.
        :param track: ``PathProjection`` at the end of the present path.
        :param limits: ``CurvatureLimits`` for the new path.
        :return: ``PathProjection`` on the new path, or None where there is none.
        """
        return self.reapproach(pose, limits) if self.is_off(track, ARRIVED_SHARE) else None

    def reapproach(self, pose, limits):
        """
        Approach the goal anew, as often as the settings allow.

        :param pose: ``Pose`` of z in the frame of the z-goal.
        :param limits: ``CurvatureLimits`` for the new path.
        :return: ``PathProjection`` on the new path, or None.
        """
        if self.reapproaches >= self._settings.max_reapproaches:
            return None
        self.reapproaches += 1
        path = path_to_goal(pose, limits, self._settings.final_straight)
        self.budget += path.length
        return self._take(path, pose)

    def _take(self, path, pose):
        self._path, self._way, self._since_new = path, 0.0, 0.0
        return self.follow(pose)
