"""One push with feedback: estimator, guidance and law."""

import functools
import math

import numpy as np
from push_control.command import differential_command, holonomic_command, limited, mean_motion
from push_control.estimator import Estimator
from push_control.feedback import contact_speed, held_limits, trailing_limits, wanted_curvature
from push_control.guidance import Guidance
from push_control.monitor import FollowMonitor, jackknifed
from push_control.reference import flat_pose, SampledPath
from push_control.site import site_of
from push_control.supports import SupportTable
from push_model.contact import contact_velocity
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.quasi_static import vehicle
from push_model.signals import STOP


class FeedbackPush:
    """Brings the object along the path of a target, from late and noisy measurements."""

    def __init__(self, obj, robot, settings, target, observation):
        """
        Begin a push.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param target: the ``PushTrajectory``.
        :param observation: first ``Observation``, with an object pose.
        :raises ValueError: where this robot cannot push so at the target's contact.
        """
        self._obj, self._robot, self._settings = obj, robot, settings
        self._site = site = site_of(obj, robot, target)
        if robot.drive == 'differential' and site.kind != 'vertex':
            raise ValueError(f'target: got a contact of kind {site.kind!r} for a differential '
                             'drive, which cannot steer there, expected a vertex')
        self._believed, self._supports = vehicle(obj, site.point), SupportTable(obj, site.point)
        self._estimator = Estimator(robot, site, self._supports, settings, friction_center(obj),
                                    observation.object_pose, observation.odometry)
        self._last, self._pose_time = observation.odometry, observation.object_pose.time
        self._command, self._curvature, self._elapsed, self._speed = STOP, None, 0.0, 0.0
        self._vehicle = functools.lru_cache(maxsize=1)(functools.partial(vehicle, obj))
        self._belief = self._estimator.predict(observation.time)
        self._aim(target)

    def go_on(self, target, observation):
        """
        Take up another target without a stop, where it starts at the push that is under way.

        :param target: the ``PushTrajectory``.
        :param observation: the newest ``Observation``.
        :return: whether it does.
        :raises ValueError: where the robot does not touch the object at the target's start.
        """
        meant = site_of(self._obj, self._robot, target)
        shift = self._belief.pose.inverse() @ Pose(*target.object_poses[0].tolist())
        if observation.time < self._last.time or not self._site.is_kept(meant, shift):
            return False
        settings = self._settings
        self._elapsed = max(0.0, self._speed - settings.start_speed) / settings.acceleration
        self._aim(target)
        return True

    def _aim(self, target):
        self._guidance = Guidance(SampledPath(self._believed, target), self._settings)
        self._goal = Pose(*target.object_poses[-1].tolist())
        self._monitor = FollowMonitor(self._settings)
        self._fastest = float(np.hypot(*target.contact_twists[:, :2].T).max())
        self.travelled = self._straight = 0.0
        self._track, self.finished, self.failure = None, False, ''

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
            if self._monitor.lost(self.travelled, measured.pose.transform(self._site.point)):
                self.failure = 'contact is lost: the object does not follow the robot'

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
        if odometry is not None:
            self.roll(odometry)

    def advance(self, time, dt):
        """
        Compute the command.

        :param time: now [s].
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once ``finished`` or ``failure`` is set.
        """
        lag = self._robot.time_constant
        motion = mean_motion(self._last.twist, self._command, lag)
        self._belief = belief = self._estimator.predict(time, motion, lag)
        c_x, c_y, normal = self._site.at(belief.phi - belief.theta)
        flat = self._vehicle((c_x, c_y), belief.center)
        local = flat_pose(flat)
        pose = local.inverse() @ self._goal.inverse() @ belief.pose @ local
        planning = self._limits(flat, normal, self._settings.plan_margin)
        track = self._guidance.revise(pose, self._guidance.follow(pose), planning,
                                      self.travelled, dt)
        if track.remaining <= self._settings.stop_distance:
            track = self._arrive(pose, track, planning)
        self._track = track
        if self.travelled > self._settings.overrun * self._guidance.budget + 1.0:
            self.failure = f'gave up after {self.travelled:.1f} m, planned were ' \
                           f'{self._guidance.budget:.1f} m'
        ended = self.finished or self.failure
        self._command = STOP if ended else self._steer(flat, normal, track, dt)
        return self._command

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
                'rejected_poses': self._estimator.rejected}

    def _limits(self, flat, normal, margin):
        settings = self._settings
        friction = settings.friction_share * self._obj.contact_friction_coefficient
        cone = margin * math.atan(friction)
        if self._robot.drive == 'differential':
            return trailing_limits(flat, self._robot.radius, self._site.lead, cone)
        believed = held_limits(self._supports, self._believed, normal, cone)
        return held_limits(self._supports, flat, normal, cone).within(believed)

    def _arrive(self, pose, track, planning):
        if not self._guidance.is_off(track):
            self.finished = True
            return track
        again = self._guidance.go_around(pose, planning)
        if again is None:
            self.failure = (f'ended {1e3 * track.lateral_error:.0f} mm and '
                            f'{math.degrees(track.heading_error):.1f} deg beside the goal')
        return again or track

    def _steer(self, flat, normal, track, dt):
        settings, robot, belief = self._settings, self._robot, self._belief
        self._elapsed += dt
        speed = contact_speed(self._elapsed, track.remaining, self._fastest, settings)
        limits = self._limits(flat, normal, settings.feedback_margin)
        if limits.low <= 0.0 <= limits.high:
            self._straight = self.travelled
        elif self.travelled - self._straight > settings.one_sided_way:
            self.failure = ('the friction centre lies too far aside of this contact: friction '
                            'does not hold a straight push there')
            return STOP
        curvature = limits.clip(wanted_curvature(track.lateral_error, track.heading_error,
                                                 track.curvature, settings))
        if self._curvature is not None:
            change = settings.curvature_rate * speed * dt
            curvature = min(self._curvature + change, max(self._curvature - change, curvature))
        self._curvature, self._speed = curvature, speed
        alpha = self._supports.push_angle(flat.arm, curvature)
        angle = flat.angle + alpha - normal
        self.failure = jackknifed(self._site, normal, angle)
        if self.failure:
            return STOP
        lead = belief.theta + normal - belief.phi
        if robot.drive == 'differential':
            return limited(differential_command(speed, angle, lead, robot.radius), robot)
        forward = speed * math.cos(alpha)
        rolled = belief.phi - belief.theta - self._site.heading
        omega = forward * curvature - settings.normal_gain * speed * rolled
        return limited(holonomic_command(speed, angle, lead, robot.radius, omega), robot)
