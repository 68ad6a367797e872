"""
State of an ensemble filter: its members, and the measurements that they include.

Prediction and measurement update write it; ``EnsembleReading`` reads it.
"""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_control.perception.ensemble.ensemble_update import center
from push_control.perception.ensemble.independent_samples import independent_samples
from push_control.perception.ensemble.members import (
    CONTACT_FRICTION_STD, DRIFT, Members, ODOMETRY_ERRORS, SCALE, SUPPORT_LOG_STD, YAW_SCALE)
from push_control.perception.ensemble.pose_bias import PoseBias
from push_control.perception.ensemble.pose_history import PoseHistory
from push_control.perception.ensemble.relation import relative_poses
from push_model.geometry import FloatArray, Pose
from push_model.signals import Odometry

# Relative error of rotations measured by odometry; chosen: one per cent of the track width.
YAW_SCALE_STD = 0.01
# Standard deviation of the robot's position up to which contacts tell of friction [m]; chosen:
# a robot that has only driven round the object is known better.
MAX_CONTACT_STD = 0.05
# Coordinates of a pose.
POSE = 3
# Columns of a member's state that are forces.
_FORCES = list(range(15, 18))


class OdometryNoise(NamedTuple):
    """
    Standard deviations of the errors of odometry.

    :param scale: relative error of distances.
    :param drift: heading error per distance [rad/m].
    :param walk: random walk of the position [m/sqrt(m)].
    :param heading_walk: random walk of the heading [rad/sqrt(m)].
    :param creep: part of the way that wheels lose for each newton of a push [1/N]; 0 where pushes
        are seen, so that poses tell it.
    """

    scale: float
    drift: float
    walk: float
    heading_walk: float
    creep: float = 0.0


class RobotMemory(NamedTuple):
    """
    Estimate of the robot at a time.

    :param odometry_pose: ``Pose`` of odometry then.
    :param robots: poses (x, y, theta) of all members, shape (n, 3).
    :param odometry_errors: of all members, shape (n, 3).
    """

    odometry_pose: Pose
    robots: FloatArray
    odometry_errors: FloatArray


class EnsembleState:
    """
    Members of an ensemble with what they have seen.

    ``members``: the ``Members``. ``history``: ``PoseHistory`` of their poses. ``bias``:
    ``PoseBias`` of object poses. ``odometry``: the newest one, or None. ``pose_time``: of the
    newest object pose [s], or None. ``last_contact``: time of the last contact [s]. ``outliers``:
    number of object poses in a row that nothing explains. ``log_likelihood``: logarithm of the
    likelihood of all object poses, up to a constant. ``coupled_until``: time up to which object
    poses tell of a contact that nobody has seen [s]. ``explained_time``: of the newest object pose
    that the members explain [s]. ``is_relative``: whether the newest object pose is relative to
    the robot. ``is_in_map``: whether the robot is localized with errors that stay, as in a map.
    """

    def __init__(self, members: Members, bias: PoseBias, odometry_noise: OdometryNoise,
                 rng: np.random.Generator) -> None:
        """
        Start without poses, with drawn odometry errors and friction.

        :param members: equal ``Members``.
        :param rng: generator of everything but the bias.
        """
        self.members = members
        self.bias = bias
        self.odometry_noise = odometry_noise
        self.rng = rng
        self.history = PoseHistory()
        self.odometry: Odometry | None = None
        self.pose_time: float | None = None
        self.last_contact = -math.inf
        self.outliers = 0
        self.log_likelihood = 0.0
        self.coupled_until = -math.inf
        self.explained_time = -math.inf
        self.is_relative = False
        self.is_in_map = False
        self._draw_parameters()
        if odometry_noise.creep > 0.0:
            members.wheel_creep[:] = odometry_noise.creep * self.normal((members.count, 1))

    def _draw_parameters(self) -> None:
        members, noise = self.members, self.odometry_noise
        parameters = members.parameters
        samples = self.normal((members.count, parameters.shape[1]))
        parameters[:, SCALE] = noise.scale * samples[:, SCALE]
        parameters[:, YAW_SCALE] = YAW_SCALE_STD * samples[:, YAW_SCALE]
        parameters[:, DRIFT] = noise.drift * samples[:, DRIFT]
        parameters[:, ODOMETRY_ERRORS:-1] = SUPPORT_LOG_STD * samples[:, ODOMETRY_ERRORS:-1]
        parameters[:, -1] *= 1.0 + CONTACT_FRICTION_STD * samples[:, -1]
        members.apply_parameters()

    @property
    def position_deviation(self) -> float:
        """
        Standard deviation of x or y of the robot, the greater one [m].

        Where object poses are relative to it: in the frame of the object, which is all that a push
        needs.
        """
        members = self.members
        if not self.is_relative:
            return members.position_deviation
        relation = relative_poses(members.object_poses, members.robot_poses)
        return float(relation[:, :2].std(axis=0).max())

    @property
    def knows_contact(self) -> bool:
        """
        Whether the place of the robot is known well enough for a contact to tell of friction.

        In a map members may touch an object that the robot is only near, and that it does not move
        would mean a contact without friction.
        """
        return not self.is_in_map or self.position_deviation <= MAX_CONTACT_STD

    def normal(self, shape: tuple[int, int]) -> FloatArray:
        """
        Draw standard normal numbers whose mean over the members is 0.

        Where poses are relative to the robot, they have no correlation with poses and errors of
        odometry either, see ``independent_samples``.

        :param shape: number of members and of columns.
        """
        samples = self.rng.standard_normal(shape)
        if self.is_relative:
            members = self.members
            errors = members.parameters[:, :ODOMETRY_ERRORS]
            return independent_samples(samples, np.hstack((members.poses, errors)))
        center(samples, np.empty(shape[1]))
        return samples

    def time_since_contact(self, time: float) -> float:
        """
        Return the time since the last contact [s]; infinite before the first.

        :param time: now [s].
        """
        return time - self.last_contact

    def set_robots(self, poses: FloatArray) -> None:
        """
        Place the robots, off the object, and restart the history.

        :param poses: (x, y, theta), shape (n, 3).
        """
        members = self.members
        members.set_robot_poses(poses)
        members.states[:, _FORCES] = 0.0
        if self.pose_time is not None:
            members.close_gaps()
        self.restart_history()

    def inflate_robots(self, stds: Sequence[float]) -> None:
        """
        Add independent errors to the robots.

        :param stds: standard deviations of x, y [m] and heading [rad] that are added.
        """
        errors = self.normal((self.members.count, POSE)) * stds
        self.set_robots(self.members.robot_poses + errors)

    def restart_history(self) -> None:
        """Forget previous poses, which are those of a previous estimate."""
        if self.odometry is not None:
            self.history.restart(self.odometry.time, self.members.poses)

    def assign(self, other: 'EnsembleState') -> None:
        """
        Take over the estimate of another state, but not its random numbers.

        :param other: a fork of this one, with the same measurements; not used afterwards.
        """
        self.members.assign(other.members)
        self.history, self.bias = other.history, other.bias
        self.outliers, self.last_contact = other.outliers, other.last_contact
        self.coupled_until = other.coupled_until
        self.explained_time = other.explained_time
        self.is_relative = other.is_relative
