"""
Extended Kalman filter for object pose, push direction, centre of friction and rotation.

Odometry is the input; poses are measured late and enter at their own time. With x the
``PushState``, P its covariance, z the measured pose and H the rows of (x, y, theta):

    ``x+ = f(x, u)``,  ``P+ = F P F^T + Q ds``   for every step of odometry, ds the path length
    ``K = P H^T (H P H^T + R)^-1``,  ``x += K (z - H x)``,  ``P -= K H P``   for every pose
"""

from collections.abc import Iterator
import math
from typing import NamedTuple

import numpy as np
from push_control.estimation.contact_site import ContactSite
from push_control.estimation.dead_reckoning import RobotMotion
from push_control.estimation.push_motion import PushMotion, PushState
from push_control.settings import ControlSettings
from push_model.geometry import Coordinates, FloatArray, wrap_angle
from push_model.signals import ObjectPose, Odometry, Twist

# How long odometry is kept to be replayed from a late pose [s]. Chosen: far above the latency of
# any pose that is not stale.
INPUT_MEMORY = 1.0
# After so many rejected poses in a row the object was really moved, and the covariance of pose and
# push direction is inflated by so much. Chosen: the next pose then passes the gate.
MAX_CONSECUTIVE_REJECTIONS = 3
COVARIANCE_INFLATION = 25.0


class NoiseModel(NamedTuple):
    """
    What the filter reckons with.

    :param initial: variances of the ``PushState`` at the start, shape (7,).
    :param walk: Q, variances of the random walk of the state per path length, shape (7,).
    :param pose_gate: squared Mahalanobis distance at which a pose is rejected.
    :param center: nominal centre of friction, object frame (x, y) [m].
    :param max_center_offset: largest distance of the centre of friction from it [m].
    """

    initial: FloatArray
    walk: FloatArray
    pose_gate: float
    center: Coordinates
    max_center_offset: float

    @classmethod
    def of(cls, settings: ControlSettings, site: ContactSite, center: Coordinates) -> 'NoiseModel':
        """
        Make the noise model of a contact.

        :param settings: ``ControlSettings``.
        :param site: the ``ContactSite``.
        :param center: nominal centre of friction, object frame (x, y) [m].
        :return: ``NoiseModel``.
        """
        arm = math.hypot(center[0] - site.point[0], center[1] - site.point[1])
        standard_deviations = (
            settings.pose_noise, settings.pose_noise, settings.heading_noise,
            settings.push_direction_std, settings.center_std_ratio * arm,
            settings.center_std_ratio * arm, settings.c_squared_log_std)
        walks = (settings.position_walk, settings.position_walk, settings.heading_walk,
                 settings.push_direction_walk, settings.center_walk, settings.center_walk,
                 settings.c_squared_log_walk)
        return cls(np.square(standard_deviations), np.square(walks), settings.pose_gate, center,
                   settings.max_center_offset_ratio * arm)


class _Input(NamedTuple):
    """Mean motion of the robot between two times [s]."""

    start: float
    end: float
    twist: Twist


class OdometryBuffer:
    """Motion of the robot since some time, to be replayed from a late pose. ``last``: newest."""

    def __init__(self, start: float, odometry: Odometry):
        """
        Begin with one odometry, which holds since the start.

        :param start: not later than the odometry [s].
        :param odometry: first ``Odometry``.
        """
        self._inputs = [_Input(start, odometry.time, odometry.twist)]
        self.last = odometry

    def add(self, odometry: Odometry) -> None:
        """
        Add the mean motion since the last odometry.

        :param odometry: ``Odometry``, newer than the last.
        """
        mean = Twist(*(0.5 * (a + b) for a, b in zip(self.last.twist, odometry.twist)))
        self._inputs.append(_Input(self.last.time, odometry.time, mean))
        self.last = odometry

    def between(self, start: float, end: float) -> Iterator[tuple[float, Twist]]:
        """
        List the motions between two times; the last one goes on.

        :param start: begin [s].
        :param end: end [s].
        :return: yields duration [s] and ``Twist`` of each.
        """
        for item in self._inputs:
            duration = min(end, item.end) - max(start, item.start)
            if duration > 0.0:
                yield duration, item.twist
        beyond = end - max(start, self.last.time)
        if beyond > 0.0:
            yield beyond, self.last.twist

    def forget_before(self, time: float) -> None:
        """
        Drop what is no longer needed.

        :param time: of the earliest replay to come [s].
        """
        self._inputs = [item for item in self._inputs if item.end > time]


class PoseUpdate(NamedTuple):
    """
    What became of a measured pose.

    :param is_accepted: whether it passed the gate.
    :param motions: each ``RobotMotion`` that the filter has processed up to it.
    """

    is_accepted: bool
    motions: tuple[RobotMotion, ...] = ()


class Estimator:
    """
    Fuses odometry and late object poses.

    ``motion``: ``PushMotion`` of the contact. ``state``: ``PushState`` at the time of the last
    pose used. ``rejected_poses``: number of poses outside the gate.
    """

    def __init__(self, motion: PushMotion, settings: ControlSettings, center: Coordinates,
                 pose: ObjectPose, odometry: Odometry):
        """
        Start from one object pose and one odometry.

        :param motion: ``PushMotion`` of the nominal object at its contact.
        :param settings: ``ControlSettings``.
        :param center: nominal centre of friction, object frame (x, y) [m].
        :param pose: first ``ObjectPose``.
        :param odometry: first ``Odometry``.
        """
        site = motion.site
        self.motion = motion
        self._settings = settings
        self._noise = NoiseModel.of(settings, site, center)
        theta = pose.pose.theta
        misalignment = wrap_angle(odometry.pose.theta - theta - site.heading)
        self.state = PushState(pose.pose.x, pose.pose.y, theta,
                               theta + site.heading + misalignment, *center)
        self._covariance: FloatArray = np.diag(self._noise.initial)
        self._covariance[:3, :3] = settings.believed_covariance(pose).matrix
        self._time = min(pose.time, odometry.time)
        self._odometry = OdometryBuffer(self._time, odometry)
        # The state at the time of the last odometry, or None where it must be computed.
        self._latest: PushState | None = None
        self.rejected_poses = 0
        self._consecutive_rejections = 0

    @property
    def covariance(self) -> FloatArray:
        """Covariance at the time of the last pose used, shape (7, 7)."""
        return self._covariance.copy()

    def set_contact(self, site: ContactSite, is_lost: bool) -> None:
        """
        Go on with the contact as detected.

        :param site: the ``ContactSite``.
        :param is_lost: whether the robot does not touch the object.
        """
        self.motion = self.motion._replace(site=site, is_lost=is_lost)
        self._latest = None

    def add_odometry(self, odometry: Odometry) -> tuple[RobotMotion, ...]:
        """
        Remember a motion of the robot.

        :param odometry: ``Odometry``; one that is not newer than the last is ignored.
        :return: each ``RobotMotion`` that the filter has processed, as it got too old to keep.
        """
        last_time = self._odometry.last.time
        if odometry.time <= last_time:
            return ()
        self._odometry.add(odometry)
        if self._latest is not None:
            self._latest = self._propagated(self._latest, max(self._time, last_time),
                                            odometry.time)
        if odometry.time - INPUT_MEMORY > self._time:
            return self._advance(odometry.time - INPUT_MEMORY)
        return ()

    def add_pose(self, measured: ObjectPose) -> PoseUpdate:
        """
        Correct the estimate by a pose, at the pose's own time.

        :param measured: ``ObjectPose``; one older than the last that was used is ignored.
        :return: ``PoseUpdate``.
        """
        if measured.time < self._time:
            return PoseUpdate(False)
        motions = self._advance(measured.time)
        self._latest = None
        state, covariance = self.state, self._covariance
        innovation = np.array([measured.pose.x - state.x, measured.pose.y - state.y,
                               wrap_angle(measured.pose.theta - state.theta)])
        noise = self._settings.believed_covariance(measured).matrix
        information = np.linalg.inv(covariance[:3, :3] + noise)
        if innovation @ information @ innovation > self._noise.pose_gate:
            self._reject()
            return PoseUpdate(False, motions)
        self._consecutive_rejections = 0
        gain = covariance[:, :3] @ information
        self.state = self._clamped(PushState(*(np.array(state) + gain @ innovation).tolist()))
        covariance = covariance - gain @ covariance[:3, :]
        self._covariance = 0.5 * (covariance + covariance.T)
        return PoseUpdate(True, motions)

    def predict(self, time: float) -> PushState:
        """
        Carry the estimate to a later time.

        :param time: when [s], not before the last odometry.
        :return: ``PushState``.
        """
        last_time = self._odometry.last.time
        if self._latest is None:
            self._latest = self._propagated(self.state, self._time, last_time)
        return self._propagated(self._latest, max(self._time, last_time), time)

    def propagate(self, state: PushState, twist: Twist, duration: float) -> PushState:
        """
        Carry a state on under an expected motion.

        :param state: ``PushState``.
        :param twist: mean ``Twist`` of the robot, robot's axes.
        :param duration: how long it lasts [s].
        :return: ``PushState``.
        """
        return self.motion.propagate(state, twist, duration) if duration > 0.0 else state

    def _propagated(self, state: PushState, start: float, end: float) -> PushState:
        for duration, twist in self._odometry.between(start, end):
            state = self.motion.propagate(state, twist, duration)
        return state

    def _advance(self, time: float) -> tuple[RobotMotion, ...]:
        """Carry state and covariance to a later time; give the motion of the robot meanwhile."""
        motions: list[RobotMotion] = []
        for duration, twist in self._odometry.between(self._time, time):
            rates = self.motion.rates(self.state, twist)
            transition, distance = self.motion.linearize(self.state, rates, duration)
            motions.append(RobotMotion(twist, duration, distance, self.state.phi))
            self.state = self.motion.propagate(self.state, twist, duration, rates)
            self._covariance = transition @ self._covariance @ transition.T
            self._covariance[range(7), range(7)] += distance * self._noise.walk
        self._time = max(time, self._time)
        self._odometry.forget_before(self._time)
        return tuple(motions)

    def _reject(self) -> None:
        """Count a pose outside the gate; widen the gate after several in a row."""
        self.rejected_poses += 1
        self._consecutive_rejections += 1
        if self._consecutive_rejections >= MAX_CONSECUTIVE_REJECTIONS:
            scale = np.array([COVARIANCE_INFLATION] * 4 + [1.0] * 3)
            self._covariance = self._covariance * np.sqrt(np.outer(scale, scale))

    def _clamped(self, state: PushState) -> PushState:
        """Keep the centre of friction near its nominal place."""
        center, limit = self._noise.center, self._noise.max_center_offset
        off_x, off_y = state.p_x - center[0], state.p_y - center[1]
        off = math.hypot(off_x, off_y)
        if off <= limit:
            return state
        return state._replace(p_x=center[0] + off_x * limit / off,
                              p_y=center[1] + off_y * limit / off)
