"""One push with feedback: estimator, guidance and steering law for one target."""

import functools
import math

import numpy as np
from push_control.estimation.contact_site import initial_contact_site
from push_control.estimation.monitors import OneSidedMonitor
from push_control.events import EventReport, PushEvent, sentence
from push_control.laws.command import contact_speed
from push_control.laws.contact_steering import ContactSteering
from push_control.laws.limit_surface_table import LimitSurfaceTable
from push_control.laws.steering_law import SteeringInput
from push_control.path.guidance import Guidance
from push_control.path.path import flat_output_pose, SampledPath
from push_control.push.execution import PushExecution
from push_control.push.status import ControllerStatus, Phase
from push_control.push.tracking import PushTracker
from push_model.friction import friction_center
from push_model.geometry import Pose, wrap_angle
from push_model.quasi_static import vehicle
from push_model.signals import STOP


class ClosedLoopPush(PushExecution):
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
        site = initial_contact_site(obj, robot, target)
        self._believed, supports = vehicle(obj, site.point), LimitSurfaceTable(obj, site.point)
        self._drive = ContactSteering(obj, robot, settings, site, supports)
        self._center = friction_center(obj)
        self._tracking = PushTracker(robot, site, supports, settings, self._center, observation)
        self._command, self._curvature, self._elapsed, self._speed = STOP, None, 0.0, 0.0
        self._vehicle = functools.lru_cache(maxsize=1)(functools.partial(vehicle, obj))
        self._belief = self._tracking.states(observation.time, STOP)[0]
        self._anew = 0
        law.reset()
        self._aim(target)

    def continue_with(self, target, observation):
        """
        Take up another target without a stop, where it starts at the push that is under way.

        :param target: the ``PushTrajectory``.
        :param observation: the newest ``Observation``.
        :return: whether it does.
        :raises ValueError: where the robot does not touch the object at the target's start.
        """
        meant = initial_contact_site(self._obj, self._robot, target)
        shift = self._belief.pose.inverse() @ Pose(*target.object_poses[0].tolist())
        tracking, settings = self._tracking, self._settings
        if observation.time < tracking.last.time or not tracking.site.is_kept(meant, shift):
            return False
        speed = 0.0 if self._failure else self._speed
        self._anew += bool(self._failure)
        self._elapsed = max(0.0, speed - settings.start_speed) / settings.acceleration
        self._aim(target)
        return True

    def _aim(self, target):
        settings = self._settings
        self._guidance = Guidance(SampledPath(self._believed, target), settings)
        self._goal = Pose(*target.object_poses[-1].tolist())
        self._one_sided, self._asks = OneSidedMonitor(settings), False
        self._fastest = float(np.hypot(*target.contact_twists[:, :2].T).max())
        self._begin, self._track, self._finished, self._failure = self._tracking.way, None, False, None

    def observe(self, observation):
        """
        Take in the measurements that are new.

        :param observation: ``Observation``, usable.
        """
        self._failure = self._tracking.observe(observation)

    def pause(self, odometry):
        """
        Stand still; the next advance sets out anew.

        :param odometry: ``Odometry`` to take in meanwhile, or None.
        """
        self._elapsed, self._command = 0.0, STOP
        self._law.reset()
        if odometry is not None:
            self._tracking.roll(odometry)

    def advance(self, time, dt):
        """
        Compute the command.

        :param time: now [s].
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once ``finished`` or ``failure`` is set.
        """
        now, self._belief = self._tracking.states(time, self._command)
        ahead, site = self._belief, self._tracking.site
        self._drive.site = site
        c_x, c_y, normal = site.at(ahead.phi - ahead.theta)
        flat = self._vehicle((c_x, c_y), ahead.center).with_c_squared_ratio(math.exp(ahead.q))
        pose = self._from_goal(flat, ahead)
        planning = self._drive.limits(flat, normal, self._settings.replan_cone_fraction * self._care)
        self._track = track = self._guidance.follow(pose)
        if self._tracking.watch.lost:
            self._command = self._approach(dt)
            return self._command
        firm = self._drive.limits(flat, normal, self._settings.feedback_cone_fraction)
        self._track = track = self._guidance.revise(pose, track, planning, firm, self.travelled_distance,
                                                    dt)
        if track.remaining_distance <= self._settings.stop_distance:
            self._track = track = self._arrive(pose, track, planning)
        if self.travelled_distance > self._settings.max_length_ratio * self._guidance.budget + 1.0:
            self._ask_anew(PushEvent.PATH_TOO_LONG.report(
                travelled=self.travelled_distance, planned=self._guidance.budget))
        over = self._finished or self._failure
        self._command = STOP if over else self._steer(flat, now, track, dt)
        return self._command

    @property
    def finished(self) -> bool:
        """Whether the object is at its goal."""
        return self._finished

    @property
    def failure(self) -> EventReport | None:
        """Why the push has failed, or None."""
        return self._failure

    @property
    def travelled_distance(self):
        """Way of the contact since the target was taken up [m]."""
        return self._tracking.way - self._begin

    @property
    def notice(self) -> EventReport | None:
        """What is out of the ordinary, or None."""
        return self._tracking.watch.notice

    def status(self, phase: Phase, event: EventReport | None) -> ControllerStatus:
        """
        Describe the push.

        :param phase: the controller's ``Phase``.
        :param event: ``EventReport`` of what is out of the ordinary, or None.
        :return: ``ControllerStatus``.
        """
        belief, goal = self._belief, self._goal
        return ControllerStatus(phase, sentence(event), None if event is None else event.event, **{
                'position_error': math.hypot(belief.x - goal.x, belief.y - goal.y),
                'heading_error': wrap_angle(belief.theta - goal.theta),
                'remaining_distance': self._track.remaining_distance if self._track else self._guidance.budget,
                'travelled_distance': self.travelled_distance, 'friction_center': belief.center,
                'push_direction': belief.phi, 'object_pose': belief.pose,
                'robot_pose': Pose(*self._tracking.site.robot_center(belief.pose, belief.phi),
                                   belief.phi),
                'replan_requested': self._failure is not None and self._asks,
                'path_replans': self._guidance.path_replans, 'reapproaches': self._guidance.reapproaches,
                'solver_failures': self._law.solver.failures,
                'solver_failure': self._law.solver.last, **self._tracking.report})

    @property
    def _care(self):
        """Share of the cone for new paths: a differential drive has none to spare to one side."""
        wrong = math.dist(self._belief.center, self._center) / self._believed.arm
        return 1.0 if self._robot.drive == 'differential' else self._guidance.care(wrong)

    def _approach(self, dt):
        """Close a gap; the object lies still meanwhile."""
        way = self._settings.start_speed * dt
        self._failure = self._failure or self._tracking.watch.out_of_reach(way)
        self._elapsed, self._curvature = 0.0, None
        self._law.reset()
        return STOP if self._failure else self._drive.approach(self._belief)

    def _arrive(self, pose, track, planning):
        again = self._guidance.arrive(pose, track, planning)
        self._finished = again is None and not self._guidance.is_off(track)
        if again is None and not self._finished:
            self._ask_anew(PushEvent.GOAL_MISSED.report(
                lateral=1e3 * track.lateral_error, heading=math.degrees(track.heading_error)))
        return again or track

    def _ask_anew(self, failure):
        self._failure, self._asks = failure, self._anew < self._settings.max_replan_requests

    def _from_goal(self, flat, belief):
        local = flat_output_pose(flat)
        return local.inverse() @ self._goal.inverse() @ belief.pose @ local

    def _steer(self, flat, now, track, dt):
        self._elapsed += dt
        self._speed = speed = contact_speed(self._elapsed, track.remaining_distance, self._fastest,
                                            self._settings)
        normal = self._tracking.site.at(now.phi - now.theta)[2]
        limits = self._drive.limits(flat, normal, self._settings.feedback_cone_fraction)
        self._failure = self._one_sided.trouble(limits, self.travelled_distance)
        if self._failure:
            return STOP
        situation = SteeringInput(
            track, lambda: self._guidance.follow(self._from_goal(flat, now)),
            self._guidance.preview, flat, limits=limits, previous_curvature=self._curvature,
            max_change=self._settings.max_curvature_rate * speed * dt, distance=speed * dt,
            lag_distance=speed * self._robot.time_constant, **self._drive.stance(flat, normal, now))
        self._curvature = situation.clip(self._law.curvature(situation))
        command, self._failure = self._drive.command(flat, self._belief, self._curvature, speed)
        return STOP if self._failure else command
