"""Where object, robot and contact are: what is known from the measurements so far."""

import math

from push_control.estimation.contact_detection import ContactDetector
from push_control.estimation.estimator import Estimator
from push_control.estimation.monitors import FollowMonitor
from push_control.events import EventReport, PushEvent
from push_control.laws.command import mean_twist
from push_model.robot_kinematics import contact_velocity


class PushTracker:
    """Estimator, contact watch and the ways gone, fed with every measurement once."""

    def __init__(self, robot, site, supports, settings, center, observation):
        """
        Begin in contact.

        :param robot: the ``RoundRobot``.
        :param site: the contact ``ContactSite``.
        :param supports: the ``LimitSurfaceTable`` as believed.
        :param settings: ``ControlSettings``.
        :param center: believed friction centre, object frame (x, y) [m].
        :param observation: first ``Observation``, with an object pose.
        """
        measured, odometry = observation.object_pose, observation.odometry
        self._robot, self.site = robot, site
        self._estimator = Estimator(robot, site, supports, settings, center, measured, odometry)
        self._monitor = FollowMonitor(settings)
        self.watch = ContactDetector(settings, robot.radius, site)
        self.last, self._pose_time = odometry, measured.time
        self.way = 0.0

    def observe(self, observation) -> EventReport | None:
        """
        Take in the measurements that are new.

        :param observation: ``Observation``, usable.
        :return: ``EventReport`` where the push has failed, or None.
        """
        measured = observation.object_pose
        self.roll(observation.odometry)
        if measured.time <= self._pose_time:
            return None
        self._pose_time = measured.time
        self._estimator.add_pose(measured)
        found = self.watch.look(self._estimator.contact_offset(measured), self.way)
        self.site = self.site.slid(found.slid)
        self._estimator.place_contact(self.site, found.drift, self.watch.lost)
        if self._monitor.lost(self.way, measured.pose.transform(self._estimator.contact)):
            return PushEvent.OBJECT_DOES_NOT_FOLLOW.report()
        return None

    def roll(self, odometry):
        """
        Take in the robot's motion alone.

        :param odometry: ``Odometry``, finite.
        """
        if odometry.time > self.last.time:
            twist, last = odometry.twist, self._estimator.predict(self.last.time)
            heading_offset = last.theta + self.site.at(last.phi - last.theta)[2] - last.phi
            speed = math.hypot(*contact_velocity(0.0, heading_offset, self._robot.radius, twist))
            self.way += speed * (odometry.time - self.last.time)
            self._estimator.add_odometry(odometry)
            self.last = odometry

    def states(self, time, command):
        """
        Predict over delay and drive lag.

        :param time: now [s].
        :param command: ``Twist`` that the robot follows.
        :return: ``PushState`` now, and one drive lag later.
        """
        now, lag = self._estimator.predict(time), self._robot.time_constant
        motion = mean_twist(self.last.twist, command, lag)
        return now, self._estimator.propagate(now, motion, lag)

    @property
    def report(self):
        """Counts for the status."""
        return {'in_contact': not self.watch.lost, 'slips': self.watch.slips,
                'contact_losses': self.watch.contact_losses,
                'rejected_poses': self._estimator.rejected}
