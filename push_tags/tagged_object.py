"""Object poses from the tags of one object in an image."""

import enum
import math
from typing import NamedTuple, Sequence

import numpy as np
from push_model.geometry import distance, wrap_angle
from push_model.signals import ObjectPose, PoseCovariance
from push_tags.detection import TagDetection
from push_tags.pose_fit import CornerPixels, fit_pose, PoseFit, View
from push_tags.settings import DetectorSettings
from push_tags.tag_layout import ObjectTag, TagLayout
from push_tags.tag_start import poses_of_tag

# Standard deviations within which two poses are the same, and by which motion may be exceeded;
# chosen.
SAME_SIGMAS = 3.0
# Parameters of a fit, and what the floor tells of them.
UNKNOWNS, FLOOR_TERMS = 6, 3


class PoseFailure(enum.Enum):
    """Reason why an image tells no pose of an object."""

    NO_TAG = 'sees no tag of the object'
    INCONSISTENT = 'tags contradict each other, their layout, or the floor'
    AMBIGUOUS = 'two poses fit the tags alike'


class TagPose(NamedTuple):
    """
    What an image tells of an object.

    :param object_pose: ``ObjectPose`` with its covariance; None for none.
    :param failure: why there is none.
    :param outliers: numbers of the tags that were not used.
    """

    object_pose: ObjectPose | None
    failure: PoseFailure | None = None
    outliers: tuple[int, ...] = ()


class _Seen(NamedTuple):
    """A tag of the object, and where it is in the image."""

    tag: ObjectTag
    detection: TagDetection


class TaggedObject:
    """
    An object with tags: turns what is detected into its poses.

    :param layout: ``TagLayout``.
    :param settings: ``DetectorSettings``.
    """

    def __init__(self, layout: TagLayout, settings: DetectorSettings) -> None:
        self._tags = {tag.id: tag for tag in layout.tags}
        self._settings = settings
        self._last: ObjectPose | None = None

    def reset(self) -> None:
        """Forget the last pose, as when time went back."""
        self._last = None

    def locate(self, time: float, detections: Sequence[TagDetection], view: View) -> TagPose:
        """
        Estimate the pose of the object in an image.

        All corners of all tags count together. A tag that contradicts at least two others is left
        out. Where two poses fit alike, as of a single small tag, that one is taken which the last
        pose allows, or none.

        :param time: of the image [s].
        :param detections: ``TagDetection`` of each tag in it.
        :param view: ``View`` that took it.
        """
        seen = [_Seen(self._tags[detection.id], detection) for detection in detections
                if detection.id in self._tags]
        if not seen:
            return TagPose(None, PoseFailure.NO_TAG)
        used, minima = self._consistent(seen, view)
        outliers = tuple(item.tag.id for item in seen if item not in used)
        if not minima:
            return TagPose(None, PoseFailure.INCONSISTENT, outliers)
        fit = self._chosen(time, minima)
        if fit is None:
            return TagPose(None, PoseFailure.AMBIGUOUS, outliers)
        pose = fit.pose._replace(theta=wrap_angle(fit.pose.theta))
        self._last = ObjectPose(time, pose, PoseCovariance.from_matrix(fit.covariance))
        return TagPose(self._last, None, outliers)

    def _consistent(self, seen: list[_Seen], view: View) -> tuple[list[_Seen], list[PoseFit]]:
        """Fit all tags; where they do not agree, leave out the one without which they do best."""
        minima = self._minima(seen, view)
        if minima or len(seen) < 3:
            return (seen if minima else []), minima
        subsets = [[item for item in seen if item is not one] for one in seen]
        results = [(subset, self._minima(subset, view)) for subset in subsets]
        results = [(subset, minima) for subset, minima in results if minima]
        return min(results, key=lambda result: result[1][0].cost, default=([], []))

    def _minima(self, seen: list[_Seen], view: View) -> list[PoseFit]:
        """List the poses that explain tags, the best one first."""
        corners = CornerPixels(np.concatenate([item.tag.corners for item in seen]),
                               np.concatenate([item.detection.corners for item in seen]))
        starts = [start for item in seen for start in
                  poses_of_tag(item.tag, item.detection, view.camera, view.optical_pose)]
        fits = [fit_pose(start, corners, view, self._settings) for start in starts]
        freedom = corners.pixels.size + FLOOR_TERMS - UNKNOWNS
        limit = freedom * self._settings.max_residual ** 2
        possible = sorted((fit for fit in fits if fit is not None and fit.cost <= limit),
                          key=lambda fit: fit.cost)
        # Tags that fit worse than the settings say have larger errors than these.
        factor = max(1.0, possible[0].cost / freedom) if possible else 1.0
        minima: list[PoseFit] = []
        for fit in possible:
            fit = fit._replace(covariance=factor * fit.covariance)
            is_refuted = fit.cost - possible[0].cost > factor * self._settings.ambiguity
            if not is_refuted and not any(_are_same(fit, other) for other in minima):
                minima.append(fit)
        return minima

    def _chosen(self, time: float, minima: list[PoseFit]) -> PoseFit | None:
        """Choose among poses by the last one; None where it allows several, or none."""
        if len(minima) == 1:
            return minima[0]
        allowed = [fit for fit in minima if self._follows(time, fit)]
        return allowed[0] if len(allowed) == 1 else None

    def _follows(self, time: float, fit: PoseFit) -> bool:
        """Tell whether the object can have come to a pose since the last one."""
        last, settings = self._last, self._settings
        if last is None:
            return False
        duration = abs(time - last.time)
        covariance = PoseCovariance.from_matrix(fit.covariance)
        return (distance(fit.pose, last.pose) <= settings.max_speed * duration
                + SAME_SIGMAS * covariance.position_deviation
                and abs(wrap_angle(fit.pose.theta - last.pose.theta))
                <= settings.max_yaw_rate * duration
                + SAME_SIGMAS * covariance.heading_deviation)


def _are_same(one: PoseFit, other: PoseFit) -> bool:
    """Tell whether two poses differ by less than their errors."""
    deviations = np.sqrt(np.diag(one.covariance))
    return (math.hypot(one.pose.x - other.pose.x, one.pose.y - other.pose.y)
            <= SAME_SIGMAS * float(deviations[:2].max())
            and abs(wrap_angle(one.pose.theta - other.pose.theta))
            <= SAME_SIGMAS * float(deviations[2]))
