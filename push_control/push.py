"""One push with feedback: estimator, guidance and steering law for one target."""

import math

import numpy as np
from push_control.command import mean_motion
from push_control.contact_drive import ContactDrive
from push_control.contact_watch import ContactWatch
from push_control.estimator import Estimator
from push_control.feedback import contact_speed
from push_control.guidance import Guidance
from push_control.monitor import FollowMonitor, OneSidedMonitor
from push_control.motion import contact_velocity
from push_control.reference import flat_pose, SampledPath
from push_control.site import site_of
from push_control.steering import Situation
from push_control.supports import SupportTable
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.quasi_static import vehicle
from push_model.signals import STOP


class ClosedLoopPush:
    """Brings the object along the path of a target, from late and noisy measurements."""

    def __init__(self, obj, robot, settings, law, target, observation):
        """
        Begin a push.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param law: the steering law, as ``ClosedFormLaw``; it is set out anew.
        :param target: the ``PushTrajectory``.
        :param observation: first ``Observation``, with an object pose.
        :raises ValueError: where this robot cannot push so at the target's contact.
        """
        self._obj, self._robot, self._settings, self._law = obj, robot, settings, law
        self._site = site = site_of(obj, robot, target)
        believed, supports = vehicle(obj, site.point), SupportTable(obj, site.point)
        self._drive = ContactDrive(obj, robot, settings, site, supports, believed)
        self._goal = Pose(*target.object_poses[-1].tolist())
        self._guidance = Guidance(SampledPath(believed, target), settings)
        self._estimator = Estimator(robot, site, supports, settings, friction_center(obj),
                                    observation.object_pose, observation.odometry)
        self._monitor, self._one_sided = FollowMonitor(settings), OneSidedMonitor(settings)
        self._watch = ContactWatch(settings, robot.radius, site)
        self._fastest = float(np.hypot(*target.contact_twists[:, :2].T).max())
        self._last, self._pose_time = observation.odometry, observation.object_pose.time
        self._command, self._curvature = STOP, None
        law.restart()
        self._flat = self._flat_of = None
        self._elapsed = self.travelled = 0.0
        self._belief, self._track = self._estimator.predict(observation.time), None
        self.finished, self.failure = False, ''

    def observe(self, observation):
        """
        Take in the measurements that are new.

        :param observation: ``Observation``, usable.
        """
        measured = observation.object_pose
        self.roll(observation.odometry)
        if measured.time > self._pose_time:
            self._pose_time = measured.time
            self._estimator.add_pose(measured)
            self._look(measured)
            if self._monitor.lost(self.travelled, measured.pose.transform(self._site.point)):
                self.failure = 'contact is lost: the object does not follow the robot'

    def _look(self, measured):
        found = self._watch.look(self._estimator.beside_contact(measured), self.travelled)
        self._site = self._drive.site = self._site.slid(found.slid)
        self._estimator.place_contact(self._site, found.drift, self._watch.lost)

    def roll(self, odometry):
        """
        Take in the robot's motion alone.

        :param odometry: ``Odometry``, finite.
        """
        if odometry.time > self._last.time:
            twist, lead = odometry.twist, self._site.lead
            speed = math.hypot(*contact_velocity(0.0, lead, self._robot.radius, twist))
            self.travelled += speed * (odometry.time - self._last.time)
            self._estimator.add_odometry(odometry)
            self._last = odometry

    def pause(self, odometry):
        """
        Stand still; the next advance sets out anew.

        :param odometry: ``Odometry`` to take in meanwhile, or None.
        """
        self._elapsed, self._command = 0.0, STOP
        self._law.restart()
        if odometry is not None:
            self.roll(odometry)

    def advance(self, time, dt):
        """
        Compute the command.

        :param time: now [s].
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once ``finished`` or ``failure`` is set.
        """
        now, lag = self._estimator.predict(time), self._robot.time_constant
        motion = mean_motion(self._last.twist, self._command, lag)
        self._belief = ahead = self._estimator.carry_on(now, motion, lag)
        c_x, c_y, normal = self._site.at(ahead.phi - ahead.theta)
        flat = self._vehicle((c_x, c_y), ahead.center)
        pose = self._from_goal(flat, ahead)
        planning = self._drive.limits(flat, normal, self._settings.plan_margin)
        track = self._guidance.revise(pose, self._guidance.follow(pose), planning,
                                      self.travelled, dt)
        if track.remaining <= self._settings.stop_distance:
            track = self._arrive(pose, track, planning)
        self._track = track
        if self._watch.lost:
            self._command = self._approach(dt)
            return self._command
        if self.travelled > self._settings.overrun * self._guidance.budget + 1.0:
            self.failure = f'gave up after {self.travelled:.1f} m, planned were ' \
                           f'{self._guidance.budget:.1f} m'
        if not (self.finished or self.failure):
            self._command = self._steer(flat, now, track, dt)
        if self.finished or self.failure:
            self._command = STOP
        return self._command

    @property
    def notice(self):
        """What is out of the ordinary, empty while nothing is."""
        return self._watch.notice

    @property
    def report(self):
        """What the status tells: errors of the estimate, way left, friction centre, counts."""
        belief, goal = self._belief, self._goal
        return {'position_error': math.hypot(belief.x - goal.x, belief.y - goal.y),
                'heading_error': wrap_angle(belief.theta - goal.theta),
                'remaining': self._track.remaining if self._track else self._guidance.budget,
                'travelled': self.travelled, 'friction_center': belief.center,
                'push_direction': belief.phi, 'object_pose': belief.pose,
                'replans': self._guidance.replans, 'go_arounds': self._guidance.go_arounds,
                'slips': self._watch.slips, 'losses': self._watch.losses,
                'rejected_poses': self._estimator.rejected, **self._law.report}

    def _approach(self, dt):
        """Close a gap; the object lies still meanwhile."""
        self.failure = self._watch.out_of_reach(self._settings.start_speed * dt)
        self._elapsed, self._curvature = 0.0, None
        self._law.restart()
        return STOP if self.failure else self._drive.approach(self._belief)

    def _vehicle(self, point, center):
        if (point, center) != self._flat_of:
            self._flat_of = point, center
            self._flat = vehicle(self._obj, point, center)
        return self._flat

    def _arrive(self, pose, track, planning):
        if not self._guidance.is_off(track):
            self.finished = True
            return track
        again = self._guidance.go_around(pose, planning)
        if again is None:
            self.failure = (f'ended {1e3 * track.lateral_error:.0f} mm and '
                            f'{math.degrees(track.heading_error):.1f} deg beside the goal')
        return again or track

    def _from_goal(self, flat, belief):
        local = flat_pose(flat)
        return local.inverse() @ self._goal.inverse() @ belief.pose @ local

    def _steer(self, flat, now, track, dt):
        settings = self._settings
        self._elapsed += dt
        speed = contact_speed(self._elapsed, track.remaining, self._fastest, settings)
        normal = self._site.at(now.phi - now.theta)[2]
        limits = self._drive.limits(flat, normal, settings.feedback_margin)
        self.failure = self._one_sided.trouble(limits, self.travelled)
        if self.failure:
            return STOP
        situation = Situation(
            track, lambda: self._guidance.follow(self._from_goal(flat, now)),
            self._guidance.preview, flat, limits=limits, before=self._curvature,
            change=settings.curvature_rate * speed * dt, moved=speed * dt,
            lag=speed * self._robot.time_constant, **self._drive.stance(flat, normal))
        self._curvature = situation.allowed(self._law.curvature(situation))
        command, self.failure = self._drive.command(flat, self._belief, self._curvature, speed)
        return STOP if self.failure else command
