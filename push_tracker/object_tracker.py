"""
Object poses from sightings of its tags.

A tag at the place t with the yaw theta, mounted at an offset from the object's origin, gives the
pose ``(t - d, theta)`` of the object, d being that offset in the world. With the standard
deviations sigma of its place and tau of its yaw, the error of that pose has the covariance

    [ sigma^2 I + tau^2 n n'   tau^2 n ]
    [ tau^2 n'                 tau^2   ]      with n = (d_y, -d_x).

The poses of several tags are averaged with the inverses of their covariances as weights. A pose
that the object cannot have reached since the last one, or that other tags contradict, is an
outlier; several in a row that agree with each other are an object that somebody has moved.
"""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.rigid_transform import RigidTransform
from push_model.signals import ObjectPose, PoseCovariance
from push_tracker.settings import MountedTag, TrackerSettings


class TagSighting(NamedTuple):
    """
    A tag as it was seen.

    :param frame: of the tag.
    :param pose: ``RigidTransform`` of the tag in the world.
    :param distance: from the camera that saw it [m].
    """

    frame: str
    pose: RigidTransform
    distance: float


class TrackerUpdate(NamedTuple):
    """
    Update from the sightings of one time.

    :param object_pose: ``ObjectPose`` with its covariance, or None where all are outliers.
    :param outliers: frames of the tags that were not used.
    """

    object_pose: ObjectPose | None
    outliers: tuple[str, ...]


class _Candidate(NamedTuple):
    """Pose of the object as one tag has it, with its covariance, shape (3, 3)."""

    frame: str
    pose: Pose
    covariance: FloatArray


class ObjectTracker:
    """Turns sightings of tags into object poses."""

    def __init__(self, settings: TrackerSettings) -> None:
        """Start without a pose."""
        self._settings = settings
        self._tags = {tag.frame: tag for tag in settings.tags}
        self._last: ObjectPose | None = None
        self._suspected: ObjectPose | None = None
        self._confirmations = 0

    def reset(self) -> None:
        """Forget all poses, as when time went back."""
        self._last = self._suspected = None
        self._confirmations = 0

    def update(self, time: float, sightings: Sequence[TagSighting]) -> TrackerUpdate:
        """
        Take in what was seen at a time.

        :param time: of the image [s], later than the last one.
        :param sightings: ``TagSighting`` of each tag that was seen.
        """
        candidates = [self._candidate(sighting) for sighting in sightings
                      if self._tilt(sighting) <= self._settings.max_tilt]
        expected = [candidate for candidate in candidates if self._follows(self._last, candidate,
                                                                           time)]
        if expected or self._last is None:
            used = self._consensus(expected or candidates)
            pose = self._fuse(used, time)
            self._suspected, self._confirmations = None, 0
        else:
            used = self._consensus(candidates)
            pose = self._confirmed(self._fuse(used, time), used, time)
        if pose is not None:
            self._last = pose
        frames = {candidate.frame for candidate in used} if pose is not None else set[str]()
        return TrackerUpdate(pose, tuple(sighting.frame for sighting in sightings
                                         if sighting.frame not in frames))

    def _tilt(self, sighting: TagSighting) -> float:
        return (sighting.pose @ self._tags[sighting.frame].pose.inverse()).tilt

    def _candidate(self, sighting: TagSighting) -> _Candidate:
        settings, tag = self._settings, self._tags[sighting.frame]
        pose = (sighting.pose @ tag.pose.inverse()).planar
        position_deviation = math.hypot(settings.position_noise,
                                        settings.distance_noise * sighting.distance)
        return _Candidate(sighting.frame, pose, _covariance(tag, pose.theta, position_deviation,
                                                            settings.heading_noise))

    def _follows(self, before: ObjectPose | None, candidate: _Candidate, time: float) -> bool:
        """Tell whether an object can have come from one pose to another."""
        if before is None:
            return False
        settings, pose, duration = self._settings, candidate.pose, time - before.time
        position, heading = _deviations(candidate.covariance)
        return (distance(pose, before.pose)
                <= settings.max_speed * duration + settings.gate_sigmas * position
                and abs(wrap_angle(pose.theta - before.pose.theta))
                <= settings.max_yaw_rate * duration + settings.gate_sigmas * heading)

    def _consensus(self, candidates: Sequence[_Candidate]) -> list[_Candidate]:
        """Keep those that agree with the one with which most agree."""
        agreeing = [[other for other in candidates if self._agree(candidate, other)]
                    for candidate in candidates]
        return max(agreeing, key=len, default=[])

    def _agree(self, a: _Candidate, b: _Candidate) -> bool:
        position, heading = _deviations(a.covariance + b.covariance)
        gate = self._settings.gate_sigmas
        return (distance(a.pose, b.pose) <= gate * position
                and abs(wrap_angle(a.pose.theta - b.pose.theta)) <= gate * heading)

    def _fuse(self, candidates: Sequence[_Candidate], time: float) -> ObjectPose | None:
        """Average poses by their covariances; headings relative to the first one."""
        if not candidates:
            return None
        first = candidates[0].pose.theta
        information, weighted = np.zeros((3, 3)), np.zeros(3)
        for _, pose, covariance in candidates:
            inverse = np.linalg.inv(covariance)
            information += inverse
            weighted += inverse @ (pose.x, pose.y, wrap_angle(pose.theta - first))
        covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
        x, y, rotation = (covariance @ weighted).tolist()
        return ObjectPose(time, Pose(x, y, wrap_angle(first + rotation)),
                          PoseCovariance.from_matrix(covariance))

    def _confirmed(self, pose: ObjectPose | None, used: Sequence[_Candidate],
                   time: float) -> ObjectPose | None:
        """Accept a pose that the object cannot have reached, once enough of them agree."""
        if pose is None:
            return None
        is_confirmed = any(self._follows(self._suspected, candidate, time) for candidate in used)
        self._confirmations = self._confirmations + 1 if is_confirmed else 1
        self._suspected = pose
        if self._confirmations < self._settings.confirmations:
            return None
        self._suspected, self._confirmations = None, 0
        return pose


def _covariance(tag: MountedTag, heading: float, position_deviation: float,
                yaw_deviation: float) -> FloatArray:
    """Covariance of the object pose of one tag; see the formula of the module."""
    d_x, d_y = Pose(0.0, 0.0, heading).rotate((tag.x, tag.y))
    column = np.array((d_y, -d_x, 1.0))
    return (np.diag((position_deviation ** 2, position_deviation ** 2, 0.0))
            + yaw_deviation ** 2 * np.outer(column, column))


def _deviations(covariance: FloatArray) -> tuple[float, float]:
    """Return the standard deviations of x or y, the greater one [m], and heading [rad]."""
    return (math.sqrt(max(covariance[0, 0], covariance[1, 1])), math.sqrt(covariance[2, 2]))
