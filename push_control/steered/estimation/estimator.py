"""
Extended Kalman filter for object pose, push direction, centre of friction and rotation.

Odometry is the input; poses are measured late and enter at their own time. With x the
``MotionState``, P its covariance, z the measured pose and H the rows of (x, y, theta):

    ``x+ = f(x, u)``,  ``P+ = F P F^T + Q ds``   for every step of odometry, ds the path length
    ``K = P H^T (H P H^T + R)^-1``,  ``x += K (z - H x)``,  ``P -= K H P``   for every pose
"""

from collections import deque
import itertools
import math
from typing import NamedTuple

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.estimation.contact_site import RollingContact
from push_control.steered.estimation.dead_reckoning import RobotMotion
from push_control.steered.estimation.filter_kernel import (
    add_motion, advance, C_SQUARED, CENTER, correct, COVARIANCE, END, LAST, LATEST,
    load_machine_code, MATRIX_COUNT, MEMORY_SIZE, MOTION_COLUMNS, ODOMETRY_COLUMNS, predict,
    replay, SITE, SIZE, STATE, WALK)
from push_control.steered.estimation.jump_detector import JumpDetector
from push_control.steered.estimation.push_motion import MotionState, PushMotion
from push_dynamics.compiled import array_view
from push_model.events import EventReport, PushEvent
from push_model.geometry import Coordinates, distance, FloatArray, Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry, PoseCovariance, STOP, Twist

# How long odometry is kept to be replayed from a late pose [s]. Chosen: far above the latency of
# any pose that is not stale.
INPUT_MEMORY = 1.0
# After so many rejected poses in a row that agree with each other the object was really moved;
# chosen: of poses with ten times the noise that is stated, three do so by accident in 2 s, and
# four seldom.
AGREEING_COUNT = 4
# Displacement up to which it is followed, at least [m], and rotation [rad]; chosen: some times
# what slip and wheels that spin amount to from one pose to the next, and the angle of a friction
# cone, beyond which the contact does not hold.
MIN_MAX_DISPLACEMENT = 0.1
MAX_ROTATION = 0.3
# Path of the contact in which displacements may add up to so much [m]; chosen: wheels that slip
# for two seconds, or somebody who bumps into the object, but no odometry that is a quarter wrong.
DISPLACEMENT_PATH = 1.0
MAX_DISPLACEMENT = 0.25
# Motions of the robot for which there is room at first; chosen: those between two poses.
FIRST_CAPACITY = 64


class NoiseModel(NamedTuple):
    """
    Noise that the filter assumes.

    :param initial: variances of the ``MotionState`` at the start, shape (7,).
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
    def of(cls, settings: ControlSettings, site: RollingContact,
           center: Coordinates) -> 'NoiseModel':
        """
        Make the noise model of a contact.

        :param center: nominal centre of friction, object frame (x, y) [m].
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


class _RejectedPose(NamedTuple):
    """
    A pose outside the gate.

    :param shift: from where the object is expected (x, y, theta) [m], [rad].
    :param covariance: ``PoseCovariance`` of the pose.
    :param travelled_distance: path length of the contact since the start [m].
    """

    shift: Pose
    covariance: PoseCovariance
    travelled_distance: float


class PoseUpdate(NamedTuple):
    """
    Result of the update by a measured pose.

    :param is_accepted: whether it passed the gate.
    :param is_possible: whether it passed, or is near where the object is expected and agrees with
        the poses before it, as where the contact slides.
    :param motions: each ``RobotMotion`` that the filter has processed up to it.
    """

    is_accepted: bool
    is_possible: bool = False
    motions: tuple[RobotMotion, ...] = ()


class Estimator:
    """
    Fuses odometry and late object poses.

    ``motion``: ``PushMotion`` of the contact. ``last_odometry``: the newest ``Odometry`` used.
    ``travelled_distance``: path length of the contact since the start [m]. ``rejected_poses``:
    number of poses outside the gate. ``memory``: numbers of the filter, see ``filter_kernel``.
    """

    def __init__(self, motion: PushMotion, settings: ControlSettings, center: Coordinates,
                 pose: ObjectPose, odometry: Odometry):
        """
        Start from one object pose and one odometry.

        :param motion: ``PushMotion`` of the nominal object at its contact.
        :param center: nominal centre of friction, object frame (x, y) [m].
        :param pose: first ``ObjectPose``.
        :param odometry: first ``Odometry``.
        """
        site = motion.site
        self._settings = settings
        noise = NoiseModel.of(settings, site, center)
        self._pose_gate = noise.pose_gate
        theta = pose.pose.theta
        misalignment = wrap_angle(odometry.pose.theta - theta - site.heading)
        state = MotionState(*pose.pose, theta + site.heading + misalignment, *center)
        covariance: FloatArray = np.diag(noise.initial)
        covariance[:3, :3] = settings.assumed_covariance(pose).matrix
        self.memory: FloatArray = np.zeros(MEMORY_SIZE)
        self.memory[C_SQUARED:LAST] = motion.supports.values
        self.memory[LAST:STATE] = (odometry.time, *odometry.twist)
        self.memory[STATE:LATEST] = state
        self.memory[WALK:CENTER] = noise.walk
        self.memory[CENTER:] = (*noise.center, noise.max_center_offset)
        self._matrices: FloatArray = np.zeros((MATRIX_COUNT, SIZE, SIZE))
        self._matrices[COVARIANCE] = covariance
        self._motions: FloatArray = np.zeros((FIRST_CAPACITY + 1, MOTION_COLUMNS))
        self._odometry: FloatArray = np.zeros((FIRST_CAPACITY, ODOMETRY_COLUMNS))
        # Time and velocity of an odometry.
        self._measured: FloatArray = np.zeros(4)
        self._measured_view = array_view(self._measured)
        self._time = min(pose.time, odometry.time)
        # The first odometry holds since the start.
        self._odometry[0] = self._time, odometry.time, *odometry.twist
        self._count = 1
        self.last_odometry = odometry
        self.travelled_distance = 0.0
        self.rejected_poses = 0
        # Time of the last pose that was accepted [s], and those that were not since.
        self._accepted_time = pose.time
        self._rejected: deque[_RejectedPose] = deque(maxlen=AGREEING_COUNT)
        # Displacements that were followed [m], and path length of the contact by then [m].
        self._displacements: deque[tuple[float, float]] = deque()
        self._jumps = JumpDetector(settings.jump_threshold)
        self._jump_variance = (settings.center_jump_std_ratio * math.dist(center, site.point)) ** 2
        self.motion = motion
        self.set_contact(site, motion.is_lost)
        load_machine_code(self.memory)

    @property
    def state(self) -> MotionState:
        """``MotionState`` at the time of the last pose used."""
        return MotionState(*self.memory[STATE:LATEST].tolist())

    @property
    def covariance(self) -> FloatArray:
        """Covariance at the time of the last pose used, shape (7, 7)."""
        return self._matrices[COVARIANCE].copy()

    def set_contact(self, site: RollingContact, is_lost: bool) -> None:
        """
        Go on with the contact as detected.

        :param is_lost: whether the robot does not touch the object.
        """
        self.motion = self.motion._replace(site=site, is_lost=is_lost)
        self.memory[SITE:C_SQUARED] = (*site.values, is_lost)
        # Whether ``latest`` is the state at the time of the last odometry.
        self._is_replayed = False

    def restart_jump_test(self) -> None:
        """Forget heading innovations: a contact that slides or is lost rotates the object too."""
        self._jumps.restart()

    def add_odometry(self, odometry: Odometry) -> tuple[RobotMotion, ...]:
        """
        Remember a motion of the robot: the mean one since the last odometry.

        Where that is long ago, the robot was stopped meanwhile, and has stood.

        :param odometry: ``Odometry``; one that is not newer than the last is ignored.
        :return: each ``RobotMotion`` that the filter has processed, as it got too old to keep.
        """
        last, timeout = self.last_odometry.time, self._settings.odometry_timeout
        if odometry.time <= last:
            return ()
        self._replay()
        if odometry.time - last > 2.0 * timeout:
            self._add_motion(last + timeout, STOP)
            self._add_motion(odometry.time - timeout, STOP)
        self._add_motion(odometry.time, odometry.twist)
        self.last_odometry = odometry
        if odometry.time - INPUT_MEMORY > self._time:
            return self._advance(odometry.time - INPUT_MEMORY)
        return ()

    def _add_motion(self, time: float, twist: Twist) -> None:
        """Remember the motion until a time [s] at which the robot had a ``Twist``."""
        if self._count == len(self._odometry):
            self._grow()
        view = self._measured_view
        view[0], (view[1], view[2], view[3]) = time, twist
        self.travelled_distance += add_motion(self.memory, self._odometry[self._count],
                                              self._time, self._measured)
        self._count += 1

    def add_pose(self, measured: ObjectPose) -> PoseUpdate:
        """
        Correct the estimate by a pose, at the pose's own time.

        :param measured: ``ObjectPose``; one older than the last that was used is ignored.
        """
        if measured.time < self._time:
            return PoseUpdate(False)
        motions = self._advance(measured.time)
        self._is_replayed = False
        x, y, theta = self.memory[STATE:STATE + 3].tolist()
        innovation = Pose(measured.pose.x - x, measured.pose.y - y,
                          wrap_angle(measured.pose.theta - theta))
        noise = self._settings.assumed_covariance(measured)
        heading_variance = float(self._matrices[COVARIANCE, 2, 2]) + noise.theta_theta
        is_accepted, is_possible = self._correct(innovation, noise), False
        if is_accepted:
            self._watch_for_jump(innovation.theta, heading_variance)
        else:
            self.rejected_poses += 1
            self._rejected.append(_RejectedPose(innovation, noise, self.travelled_distance))
            is_possible = self._is_near(innovation) and self._poses_agree
            if is_possible and len(self._rejected) == AGREEING_COUNT:
                self._add_displacement(innovation)
                is_accepted = self._correct(innovation, noise)
        if is_accepted:
            self._rejected.clear()
            self._accepted_time = measured.time
        return PoseUpdate(is_accepted, is_accepted or is_possible, motions)

    def pose_fault(self, time: float) -> EventReport | None:
        """
        Tell why poses have not been believed for a while, or again and again.

        :param time: now [s].
        :return: ``EventReport``, or None where it is known where the object is.
        """
        displacement = sum(size for size, _ in self._displacements)
        if displacement > MAX_DISPLACEMENT:
            return PushEvent.OBJECT_STAYS_BEHIND.report(path=DISPLACEMENT_PATH,
                                                        distance=1e3 * displacement)
        rejected = self._rejected
        if (len(rejected) < AGREEING_COUNT
                or time - self._accepted_time <= self._settings.pose_timeout):
            return None
        event, shift = PushEvent.OBJECT_ELSEWHERE, rejected[-1].shift
        if not self._poses_agree:
            event, last = PushEvent.OBJECT_POSES_SCATTER, rejected[-2].shift
            shift = Pose(shift.x - last.x, shift.y - last.y, wrap_angle(shift.theta - last.theta))
        return event.report(distance=1e3 * math.hypot(shift.x, shift.y),
                            rotation=math.degrees(abs(shift.theta)))

    def predict(self, time: float) -> MotionState:
        """
        Carry the estimate to a later time.

        :param time: when [s], not before the last odometry.
        """
        states: FloatArray = np.zeros(2 * SIZE)
        predict(self.memory, self.interval_until(time), np.zeros(3), 0.0, states)
        return MotionState(*states[:SIZE].tolist())

    def interval_until(self, time: float) -> float:
        """
        Bring ``latest`` of the memory up to date, and tell how far that is from a later time.

        :param time: when [s], not before the last odometry.
        :return: [s].
        """
        self._replay()
        return time - max(self._time, self.last_odometry.time)

    def _replay(self) -> None:
        """Bring ``latest`` to the time of the last odometry, if it is not there."""
        if not self._is_replayed:
            replay(self.memory, self._odometry, self._count, self._time)
            self._is_replayed = True

    def _advance(self, time: float) -> tuple[RobotMotion, ...]:
        """Carry state and covariance to a later time; give the motion of the robot meanwhile."""
        pending, motions = self._odometry[:self._count], self._motions
        listed = advance(self.memory, self._matrices, pending, self._time, time, motions)
        self._time = max(time, self._time)
        pending = pending[pending[:, END] > self._time]
        self._count = len(pending)
        self._odometry[:self._count] = pending
        return tuple(RobotMotion(Twist(v_x, v_y, omega), *fields)
                     for v_x, v_y, omega, *fields in motions[:listed].tolist())

    def _grow(self) -> None:
        """Make room for twice as many motions."""
        self._odometry = np.concatenate((self._odometry, np.zeros_like(self._odometry)))
        self._motions = np.zeros((len(self._odometry) + 1, MOTION_COLUMNS))

    def _correct(self, innovation: Pose, noise: PoseCovariance) -> bool:
        """Correct the estimate, unless the pose lies outside the gate."""
        return correct(self.memory, self._matrices, np.array((*innovation, *noise)),
                       self._pose_gate)

    def _watch_for_jump(self, heading: float, variance: float) -> None:
        """
        Let the centre of friction be elsewhere where the object rotates otherwise.

        :param heading: innovation [rad].
        :param variance: that was expected of it [rad^2].
        """
        if self._jumps.update(heading, variance):
            covariance = self._matrices[COVARIANCE]
            covariance[4, 4] += self._jump_variance
            covariance[5, 5] += self._jump_variance
            self.memory[WALK + 4:WALK + 6] = self._settings.center_walk_after_jump ** 2

    def _add_displacement(self, shift: Pose) -> None:
        """Reckon with an object that was moved by so much; the push begins anew there."""
        covariance = self._matrices[COVARIANCE]
        moved = shift.x ** 2 + shift.y ** 2
        for axis, variance in enumerate((moved, moved, shift.theta ** 2)):
            covariance[axis, axis] += variance
        covariance[3, 3] = max(covariance[3, 3], self._settings.push_direction_std ** 2)
        displacements, travelled = self._displacements, self.travelled_distance
        displacements.append((math.sqrt(moved), travelled))
        while displacements[0][1] < travelled - DISPLACEMENT_PATH:
            displacements.popleft()

    @property
    def _poses_agree(self) -> bool:
        """Tell whether the last rejected poses, at least two, agree with each other."""
        return (len(self._rejected) > 1
                and all(self._agree(*pair) for pair in itertools.pairwise(self._rejected)))

    def _is_near(self, shift: Pose) -> bool:
        """Tell whether an object that is displaced by so much may still be pushed."""
        limit = max(self._settings.max_approach_distance, MIN_MAX_DISPLACEMENT)
        return math.hypot(shift.x, shift.y) <= limit and abs(shift.theta) <= MAX_ROTATION

    def _agree(self, before: _RejectedPose, after: _RejectedPose) -> bool:
        """Tell whether poses differ by noise, and by what the robot has driven meanwhile."""
        a, b = before.covariance, after.covariance
        driven = after.travelled_distance - before.travelled_distance
        turned = abs(wrap_angle(after.shift.theta - before.shift.theta))
        return (distance(before.shift, after.shift) <= driven + math.sqrt(
                    self._pose_gate * (a.x_x + a.y_y + b.x_x + b.y_y))
                and turned <= driven / self.motion.robot_radius + math.sqrt(
                    self._pose_gate * (a.theta_theta + b.theta_theta)))
