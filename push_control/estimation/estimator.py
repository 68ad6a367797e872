"""
Extended Kalman filter for object pose, push direction, friction centre and turning.

Odometry is the input; poses are measured late and enter at their own time.
"""

import math

import numpy as np
from push_control.estimation.push_motion import PushMotion, PushState
from push_model.geometry import Pose, wrap_angle

MEMORY = 1.0
SETTLING_WAY = 0.5
REJECTIONS_IN_A_ROW = 3
INFLATION = 25.0


class Estimator:
    """Fuses odometry and late object poses."""

    def __init__(self, robot, site, supports, settings, center, pose, odometry):
        """
        Start from one object pose and one odometry.

        :param robot: the ``RoundRobot``.
        :param site: the contact ``ContactSite``.
        :param supports: the ``LimitSurfaceTable`` as believed.
        :param settings: ``ControlSettings``.
        :param center: believed friction centre, object frame (x, y) [m].
        :param pose: first ``ObjectPose``.
        :param odometry: first ``Odometry``.
        """
        self._settings, self._center = settings, center
        arm = math.hypot(center[0] - site.point[0], center[1] - site.point[1])
        self._motion = PushMotion(robot.radius, site, supports)
        self._limit = settings.max_center_offset_ratio * arm
        theta = pose.pose.theta
        turn = wrap_angle(odometry.pose.theta - theta - site.heading)
        self._belief = PushState(*pose.pose[:2], theta, theta + site.heading + turn, *center)
        deviations = (settings.pose_noise, settings.pose_noise, settings.heading_noise,
                      settings.push_direction_std, settings.center_std_ratio * arm,
                      settings.center_std_ratio * arm, settings.c_squared_log_std)
        self._covariance = np.diag(np.square(deviations))
        self._noise = np.diag(np.square(deviations[:3]))
        self._walk = np.square((settings.position_walk, settings.position_walk,
                                settings.heading_walk, settings.push_direction_walk,
                                settings.center_walk, settings.center_walk,
                                settings.c_squared_log_walk))
        self._time = min(pose.time, odometry.time)
        self._inputs = [(self._time, odometry.time, odometry.twist)]
        self._last, self._ahead = odometry, None
        self._place, self._heading, self._settled = odometry.pose[:2], self._belief.phi, 0.0
        self.rejected = self._in_a_row = 0

    @property
    def covariance(self):
        """Covariance at the time of the last accepted pose, shape (7, 7)."""
        return self._covariance.copy()

    @property
    def contact(self):
        """Where the contact is at that time, object frame (x, y) [m]."""
        return self._motion.site.at(self._belief.phi - self._belief.theta)[:2]

    def contact_offset(self, measured):
        """
        See where the robot is, by a pose that has just been added.

        :param measured: ``ObjectPose``.
        :return: ``push_control.estimation.contact_site.ContactOffset`` from where rolling contact has it.
        """
        belief, pose = self._belief, measured.pose
        theta = belief.theta + wrap_angle(pose.theta - belief.theta)
        return self._motion.site.offset(Pose(pose.x, pose.y, theta), belief.phi, self._place)

    def place_contact(self, site, drift, lost):
        """
        Go on with a contact as seen, and with a better place of the robot.

        :param site: the contact ``ContactSite``.
        :param drift: ``ContactOffset`` by which the place was wrong.
        :param lost: whether the robot does not touch the object.
        """
        belief = self._belief
        gamma = belief.theta + self._motion.site.at(belief.phi - belief.theta)[2]
        self._place = Pose(*self._place, gamma).transform((drift.gap, -drift.slid))
        self._motion, self._ahead = self._motion._replace(site=site, lost=lost), None

    def add_odometry(self, odometry):
        """
        Remember a motion of the robot.

        :param odometry: ``Odometry``, newer than the last; older ones are ignored.
        """
        if odometry.time <= self._last.time:
            return
        mean = tuple(0.5 * (a + b) for a, b in zip(self._last.twist, odometry.twist))
        begin = self._last.time
        self._inputs.append((begin, odometry.time, mean))
        self._last = odometry
        if self._ahead is not None:
            self._ahead = self._carried(self._ahead, max(self._time, begin), odometry.time)
        if odometry.time - MEMORY > self._time:
            self._advance(odometry.time - MEMORY)

    def add_pose(self, measured):
        """
        Correct the estimate by a pose, at the pose's own time.

        :param measured: ``ObjectPose``; one older than the last that was used is ignored.
        :return: whether it passed the gate.
        """
        if measured.time < self._time:
            return False
        self._advance(measured.time)
        self._ahead = None
        belief, covariance = self._belief, self._covariance
        error = np.array([measured.pose.x - belief.x, measured.pose.y - belief.y,
                          wrap_angle(measured.pose.theta - belief.theta)])
        inverse = np.linalg.inv(covariance[:3, :3] + self._noise)
        if error @ inverse @ error > self._settings.pose_gate:
            self._reject()
            return False
        self._in_a_row = 0
        gain = covariance[:, :3] @ inverse
        self._belief = self._clamped(PushState(*(np.array(belief) + gain @ error).tolist()))
        covariance = covariance - gain @ covariance[:3, :]
        self._covariance = 0.5 * (covariance + covariance.T)
        return True

    def predict(self, time):
        """
        Carry the estimate to a later time.

        :param time: when [s], not before the last odometry.
        :return: ``PushState``.
        """
        if self._ahead is None:
            self._ahead = self._carried(self._belief, self._time, self._last.time)
        return self._carried(self._ahead, max(self._time, self._last.time), time)

    def propagate(self, belief, twist, duration):
        """
        Carry a belief on under an expected motion.

        :param belief: ``PushState``.
        :param twist: mean motion, body axes.
        :param duration: how long it lasts [s].
        :return: ``PushState``.
        """
        return self._motion.moved(belief, twist, duration) if duration > 0.0 else belief

    def _carried(self, belief, start, end):
        for duration, twist in self._between(start, end):
            belief = self._motion.moved(belief, twist, duration)
        return belief

    def _reject(self):
        self.rejected += 1
        self._in_a_row += 1
        if self._in_a_row >= REJECTIONS_IN_A_ROW:
            scale = np.array([INFLATION] * 4 + [1.0] * 3)
            self._covariance = self._covariance * np.sqrt(np.outer(scale, scale))

    def _clamped(self, belief):
        off_x, off_y = belief.p_x - self._center[0], belief.p_y - self._center[1]
        off = math.hypot(off_x, off_y)
        if off <= self._limit:
            return belief
        return belief._replace(p_x=self._center[0] + off_x * self._limit / off,
                               p_y=self._center[1] + off_y * self._limit / off)

    def _between(self, start, end):
        for begin, finish, twist in self._inputs:
            duration = min(end, finish) - max(start, begin)
            if duration > 0.0:
                yield duration, twist
        after = end - max(start, self._last.time)
        if after > 0.0:
            yield after, self._last.twist

    def _move_robot(self, twist, duration, way):
        """Add up odometry along its own heading, with what is lastingly wrong with that."""
        wrong = self._belief.phi - self._heading
        self._settled += min(1.0, way / SETTLING_WAY) * (wrong - self._settled)
        ahead = Pose(*self._place, self._heading + self._settled + 0.5 * duration * twist[2])
        self._place = ahead.transform((duration * twist[0], duration * twist[1]))
        self._heading += duration * twist[2]

    def _advance(self, time):
        for duration, twist in self._between(self._time, time):
            transition, way = self._motion.jacobian(self._belief, twist, duration)
            self._move_robot(twist, duration, way)
            self._belief = self._motion.moved(self._belief, twist, duration)
            self._covariance = transition @ self._covariance @ transition.T
            self._covariance[range(7), range(7)] += way * self._walk
        self._time = max(time, self._time)
        self._inputs = [entry for entry in self._inputs if entry[1] > self._time]
