"""Tracking of a push: what all measurements so far tell of object, robot and contact."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.estimation.contact_detection import ContactDetector, ContactState
from push_control.steered.estimation.contact_site import RollingContact
from push_control.steered.estimation.dead_reckoning import RobotDeadReckoning, RobotMotion
from push_control.steered.estimation.estimator import Estimator
from push_control.steered.estimation.push_motion import PushMotion
from push_control.steered.monitors import FollowMonitor
from push_model.events import EventReport, PushEvent
from push_model.geometry import Coordinates, FloatArray, Pose, wrap_angle
from push_model.observation import Observation
from push_model.signals import ObjectPose, Odometry


class PushTracker:
    """
    Runs estimator, dead reckoning and contact detection, each measurement once.

    ``detector``: the ``ContactDetector``.
    """

    def __init__(self, motion: PushMotion, settings: ControlSettings, center: Coordinates,
                 pose: ObjectPose, odometry: Odometry):
        """
        Start in contact.

        :param motion: ``PushMotion`` of the nominal object at its contact.
        :param center: nominal centre of friction, object frame (x, y) [m].
        :param pose: first ``ObjectPose``.
        :param odometry: first ``Odometry``.
        """
        self._estimator = Estimator(motion, settings, center, pose, odometry)
        self._robot = RobotDeadReckoning((odometry.pose.x, odometry.pose.y),
                                         self._estimator.state.phi)
        self._follow_monitor = FollowMonitor(settings)
        self._pose_time = pose.time
        self.detector = ContactDetector(settings, motion.robot_radius, motion.site)

    @property
    def last_odometry(self) -> Odometry:
        """The newest ``Odometry`` used."""
        return self._estimator.last_odometry

    @property
    def travelled_distance(self) -> float:
        """Path length of the contact since the start [m]."""
        return self._estimator.travelled_distance

    @property
    def site(self) -> RollingContact:
        """The ``RollingContact`` as it is by now."""
        return self._estimator.motion.site

    @property
    def is_contact_lost(self) -> bool:
        """Tell whether contact was detected to be lost."""
        return self.detector.state is ContactState.LOST

    @property
    def rejected_poses(self) -> int:
        """Number of measured poses outside the gate."""
        return self._estimator.rejected_poses

    def pose_fault(self, time: float) -> EventReport | None:
        """
        Tell why poses have not been believed for a while, as of ``Estimator.pose_fault``.

        :param time: now [s].
        """
        return self._estimator.pose_fault(time)

    def pose_deviations(self, goal: Pose) -> tuple[float, float]:
        """
        Return the standard deviations of the object at the time of the last pose.

        :return: of its distance from a goal [m], and of its heading [rad].
        """
        covariance, state = self._estimator.covariance, self._estimator.state
        offset = np.array((state.x - goal.x, state.y - goal.y))
        length = float(np.hypot(*offset))
        along = np.array((1.0, 0.0)) if length == 0.0 else offset / length
        return (math.sqrt(along @ covariance[:2, :2] @ along), math.sqrt(covariance[2, 2]))

    def observe(self, observation: Observation) -> EventReport | None:
        """
        Process the measurements that are new.

        :param observation: ``Observation``, usable.
        :return: ``EventReport`` of an object that does not follow, or None.
        """
        self.add_odometry(observation.odometry)
        measured = observation.object_pose
        if measured is None or measured.time <= self._pose_time:
            return None
        self._pose_time = measured.time
        update = self._estimator.add_pose(measured)
        self._store(update.motions)
        if not update.is_possible or self.pose_fault(observation.time) is not None:
            return None
        self._detect_contact(measured.pose)
        contact = self.site.contact_at(self._estimator.state.relative_heading)
        if self._follow_monitor.is_lost(self.travelled_distance,
                                        measured.pose.transform((contact.x, contact.y))):
            return PushEvent.OBJECT_DOES_NOT_FOLLOW.report()
        return None

    def add_odometry(self, odometry: Odometry) -> None:
        """
        Process the robot's motion alone.

        :param odometry: ``Odometry``, finite; one that is not newer than the last is ignored.
        """
        self._store(self._estimator.add_odometry(odometry))

    @property
    def filter_memory(self) -> FloatArray:
        """Numbers of the filter, see ``filter_kernel``."""
        return self._estimator.memory

    def interval_until(self, time: float) -> float:
        """
        Bring ``latest`` of the filter up to date, and tell how far that is from a later time.

        :param time: now [s].
        :return: [s].
        """
        return self._estimator.interval_until(time)

    def _store(self, motions: tuple[RobotMotion, ...]) -> None:
        if motions:
            self._robot = self._robot.moved(motions)

    def _detect_contact(self, pose: Pose) -> None:
        """Compare the robot with a robot that has rolled; correct contact and robot by that."""
        state, site = self._estimator.state, self.site
        theta = state.theta + wrap_angle(pose.theta - state.theta)
        offset = site.offset(Pose(pose.x, pose.y, theta), state.phi, self._robot.center)
        detected = self.detector.update(offset, self.travelled_distance)
        gamma = state.theta + site.contact_at(state.relative_heading).normal
        self._robot = self._robot.corrected(detected.drift, gamma)
        self._estimator.set_contact(site.after_slip(detected.slip), self.is_contact_lost)
        if self.detector.state is not ContactState.TOUCHING:
            self._estimator.restart_jump_test()
