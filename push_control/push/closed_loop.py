"""
One push with feedback: estimator, guidance and steering law for one target.

Every control step is a chain: estimate the push one drive lag ahead, project the flat output z on
its path, keep or replace that path, choose a curvature within the limits, and compute the command
that gives it.
"""

import math
from typing import NamedTuple

import numpy as np
from push_control.estimation.monitors import jackknife_fault, OneSidedMonitor
from push_control.events import EventReport, PushEvent, sentence
from push_control.laws.command import contact_speed
from push_control.laws.steering_law import Foresight, SteeringInput, SteeringLaw
from push_control.observation import Observation
from push_control.path.guidance import Guidance
from push_control.path.path import CurvatureLimits, PathProjection, SampledPath
from push_control.push.contact_model import ContactModel
from push_control.push.execution import PushExecution
from push_control.push.status import ControllerStatus, Phase
from push_control.push.tracking import PushTracker
from push_control.settings import ControlSettings
from push_model.geometry import Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_model.trajectory import PushTrajectory

# Length beyond ``max_length_ratio`` of the planned one before a push is aborted [m]. Chosen: short
# plans may be exceeded by more.
LENGTH_MARGIN = 1.0
# Distance beside its path at which a push is aborted, over the size of the object, where it is not
# set. Chosen: a disc whose centre of friction lies far to the side, and round which the contact
# rolls, comes back from more than twice its size.
DEVIATION_RATIO = 4.0


class _Target(NamedTuple):
    """
    What is followed at present.

    :param goal: ``Pose`` of the object in the world.
    :param max_speed: of the contact [m/s].
    :param start_distance: travelled distance at which it was taken up [m].
    :param replan_requests: number of plans requested for this push before it.
    """

    goal: Pose
    max_speed: float
    start_distance: float
    replan_requests: int


class _Motion(NamedTuple):
    """
    What was commanded last.

    :param curvature: of z [1/m], or None where the law starts afresh.
    :param elapsed: time since the robot set out [s].
    :param speed: of the contact [m/s].
    """

    curvature: float | None = None
    elapsed: float = 0.0
    speed: float = 0.0


class _Outcome(NamedTuple):
    """
    How the push has ended, if it has.

    :param is_finished: whether the object is at its goal.
    :param failure: ``EventReport``, or None.
    :param may_replan: whether another plan may be requested after the failure.
    """

    is_finished: bool = False
    failure: EventReport | None = None
    may_replan: bool = False


class ClosedLoopPush(PushExecution):
    """Brings the object along the path of a target, from late and noisy measurements."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings,
                 law: SteeringLaw, target: PushTrajectory, observation: Observation):
        """
        Begin a push.

        :param obj: the nominal ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param law: the ``SteeringLaw``; it is reset.
        :param target: the ``PushTrajectory``.
        :param observation: first ``Observation``, with an object pose.
        :raises ValueError: where this robot cannot push so at the target's contact, or there is
            no object pose.
        """
        if observation.object_pose is None:
            raise ValueError('observation.object_pose: got None, expected an ObjectPose')
        self._settings = settings
        self._max_deviation = settings.max_path_deviation or DEVIATION_RATIO * obj.size
        self._law = law
        self._model = ContactModel(obj, robot, settings, target)
        self._time_constant = robot.time_constant
        self._tracker = PushTracker(self._model.motion, settings, self._model.center,
                                    observation.object_pose, observation.odometry)
        self._motion = _Motion()
        law.reset()
        self._follow(target, replan_requests=0)
        # Also loads machine code before the robot moves.
        self._look(observation.time)
        self._model.command(0.0, 0.0)
        self._model.stop()
        self._guidance.restart()

    def _follow(self, target: PushTrajectory, replan_requests: int) -> None:
        """Take up a target, at its start."""
        self._guidance = Guidance(SampledPath(self._model.nominal, target), self._settings)
        self._one_sided = OneSidedMonitor(self._settings)
        goal = Pose(*target.object_poses[-1].tolist())
        self._model.aim(goal)
        self._target = _Target(
            goal,
            float(np.hypot(*target.contact_twists[:, :2].T).max()),
            self._tracker.travelled_distance, replan_requests)
        # Of z one drive lag ahead; None before the first step towards this target.
        self._projection: PathProjection | None = None
        self._outcome = _Outcome()

    def continue_with(self, target: PushTrajectory, observation: Observation) -> bool:
        """
        Change over to another target without a stop, where that starts at the present push.

        :param target: the ``PushTrajectory``.
        :param observation: the newest ``Observation``.
        :return: whether it does; nothing has changed otherwise.
        :raises ValueError: where the robot does not touch the object at the target's start.
        """
        site = self._model.initial_site(target)
        shift = self._model.ahead.pose.inverse() @ Pose(*target.object_poses[0].tolist())
        if (observation.time < self._tracker.last_odometry.time
                or not self._tracker.site.is_same_push(site, shift)):
            return False
        speed, requests = self._motion.speed, self._target.replan_requests
        if self._outcome.failure is not None:
            # The robot has been stopped, and this is the plan that was requested.
            speed, requests = 0.0, requests + 1
        settings = self._settings
        self._motion = self._motion._replace(
            elapsed=max(0.0, speed - settings.start_speed) / settings.acceleration)
        self._follow(target, requests)
        return True

    def observe(self, observation: Observation) -> None:
        """
        Process the measurements that are new.

        :param observation: ``Observation``, usable.
        """
        self._set_failure(self._tracker.observe(observation))

    def pose_fault(self, time: float) -> EventReport | None:
        """
        Tell why poses have not been believed for a while, as of ``Estimator.pose_fault``.

        :param time: now [s].
        """
        return self._tracker.pose_fault(time)

    def pause(self, odometry: Odometry | None) -> None:
        """
        Stand still; the next ``advance`` sets out from rest.

        :param odometry: ``Odometry`` to process meanwhile, or None.
        """
        self._motion = self._motion._replace(elapsed=0.0)
        self._model.stop()
        # A robot that was to stop at the goal may have gone on: judged again from where it stands.
        self._outcome = self._outcome._replace(is_finished=False)
        self._law.reset()
        if odometry is not None:
            self._tracker.add_odometry(odometry)

    def advance(self, time: float, dt: float) -> Twist:
        """
        Compute the command.

        :param time: now [s].
        :param dt: time since the last call [s].
        :return: ``Twist`` in the robot's axes; STOP once ``finished`` or ``failure`` is set.
        """
        is_kept = self._look(time)
        projection = self._projection = self._guidance.last_projection
        if self.finished:
            command = STOP
        elif self._tracker.is_contact_lost:
            command = self._close_gap(dt)
        else:
            projection = self._projection = self._update_path(projection, is_kept, dt)
            self._check_length()
            is_finished, failure, _ = self._outcome
            has_ended = is_finished or failure is not None
            command = STOP if has_ended else self._steer(projection, dt)
        if command is STOP:
            self._model.stop()
        return command

    def _look(self, time: float) -> bool:
        """Look at the push; tell whether its path can be kept."""
        tracker = self._tracker
        interval = tracker.interval_until(time)
        return self._model.look(tracker.filter_memory, interval, self._guidance)

    @property
    def finished(self) -> bool:
        """Whether the object is at its goal."""
        return self._outcome.is_finished

    @property
    def failure(self) -> EventReport | None:
        """Why the push has failed, or None."""
        return self._outcome.failure

    @property
    def replan_requested(self) -> bool:
        """Whether it has failed where another plan may bring the object to its goal."""
        return self.failure is not None and self._outcome.may_replan

    @property
    def notice(self) -> EventReport | None:
        """What is out of the ordinary while the push goes on, or None."""
        return self._tracker.detector.notice

    @property
    def travelled_distance(self) -> float:
        """Path length of the contact since the target was taken up [m]."""
        return self._tracker.travelled_distance - self._target.start_distance

    def status(self, phase: Phase, event: EventReport | None) -> ControllerStatus:
        """
        Describe the push.

        :param phase: the controller's ``Phase``.
        :param event: ``EventReport`` of what is out of the ordinary, or None.
        :return: ``ControllerStatus``.
        """
        state, projection = self._model.ahead, self._projection
        goal, guidance = self._target.goal, self._guidance
        return ControllerStatus(
            phase=phase, reason=sentence(event), event=None if event is None else event.reason,
            position_error=math.hypot(state.x - goal.x, state.y - goal.y),
            heading_error=wrap_angle(state.theta - goal.theta),
            remaining_distance=(guidance.planned_length if projection is None
                                else projection.remaining_distance),
            travelled_distance=self.travelled_distance,
            friction_center=state.center,
            push_direction=state.phi,
            object_pose=state.pose,
            robot_pose=Pose(*self._tracker.site.robot_center(state.pose, state.phi), state.phi),
            in_contact=not self._tracker.is_contact_lost,
            replan_requested=self.replan_requested,
            path_replans=guidance.path_replans,
            reapproaches=guidance.reapproaches,
            slips=self._tracker.detector.slips,
            contact_losses=self._tracker.detector.contact_losses,
            rejected_poses=self._tracker.rejected_poses,
            solver_failures=self._law.solver.failures,
            solver_failure=self._law.solver.last)

    def _close_gap(self, dt: float) -> Twist:
        """Approach an object out of contact slowly; it lies still meanwhile."""
        fault = self._tracker.detector.approach_fault(self._settings.start_speed * dt)
        failure = fault if self.failure is None else self.failure
        self._set_failure(failure)
        self._motion = self._motion._replace(curvature=None, elapsed=0.0)
        self._law.reset()
        if failure is not None:
            return STOP
        return self._model.approach()

    def _update_path(self, projection: PathProjection, is_kept: bool,
                     dt: float) -> PathProjection:
        """Keep the path or replace it, and end the push at its end."""
        guidance, travelled = self._guidance, self.travelled_distance
        if guidance.is_due(projection.remaining_distance, is_kept, travelled, dt):
            projection = guidance.update(self._model.flat_output, projection, self._replan_limits)
        if abs(projection.lateral_error) > self._max_deviation:
            self._fail(PushEvent.OFF_PATH.report(lateral=abs(projection.lateral_error),
                                                 limit=self._max_deviation))
            return projection
        if projection.remaining_distance > self._settings.stop_distance:
            return projection
        flat_output = self._model.flat_output
        again = guidance.arrive(flat_output, projection, self._replan_limits)
        if again is not None:
            return again
        overshoot = max(0.0, flat_output.x)
        if guidance.is_off(projection) or overshoot > self._settings.position_tolerance:
            self._fail(PushEvent.GOAL_MISSED.report(
                distance=1e3 * math.hypot(overshoot, projection.lateral_error),
                heading=math.degrees(projection.heading_error)))
        else:
            self._outcome = self._outcome._replace(is_finished=True)
        return projection

    def _replan_limits(self) -> CurvatureLimits:
        """Limits of new paths: a differential drive has no cone to spare to one side."""
        caution = 1.0
        if not self._model.is_differential:
            caution = self._guidance.cone_fraction(self._model.center_error_ratio())
        return self._model.limits(self._settings.replan_cone_fraction * caution)

    def _check_length(self) -> None:
        """Abort a push that goes on much longer than planned."""
        travelled, planned = self.travelled_distance, self._guidance.planned_length
        if travelled > self._settings.max_length_ratio * planned + LENGTH_MARGIN:
            self._fail(PushEvent.PATH_TOO_LONG.report(travelled=travelled, planned=planned))

    def _fail(self, failure: EventReport) -> None:
        """End the push where another plan may bring the object to its goal."""
        may_replan = self._target.replan_requests < self._settings.max_replan_requests
        self._outcome = self._outcome._replace(failure=failure, may_replan=may_replan)

    def _steer(self, projection: PathProjection, dt: float) -> Twist:
        """Choose the curvature, and compute the command that gives it."""
        settings = self._settings
        elapsed = self._motion.elapsed + dt
        speed = contact_speed(elapsed, projection.remaining_distance, self._target.max_speed,
                              settings)
        limits = self._model.limits_now
        last, fault = self._motion, self._one_sided.fault(limits, self.travelled_distance)
        if fault is not None:
            self._set_failure(fault)
            self._motion = _Motion(last.curvature, elapsed, speed)
            return STOP
        steering = SteeringInput(projection, limits, last.curvature,
                                 settings.max_curvature_rate * speed * dt, speed * dt,
                                 speed * self._time_constant, self._foresee)
        curvature = steering.clip(self._law.curvature(steering))
        command, mode = self._model.command(curvature, speed)
        self._set_failure(jackknife_fault(mode))
        self._motion = _Motion(curvature, elapsed, speed)
        return command

    def _set_failure(self, failure: EventReport | None) -> None:
        """Note why the push has failed, or that it has not."""
        if failure is not self._outcome.failure:
            self._outcome = self._outcome._replace(failure=failure)

    def _foresee(self) -> Foresight:
        """Gather what a law needs to know that looks ahead along the path."""
        model = self._model
        # The preview is relative to where z is now, and so comes after this projection.
        return Foresight(
            projection=self._guidance.project(model.flat_output_now),
            preview=self._guidance.preview, vehicle=model.vehicle, zeta=model.zeta,
            zeta_rest=model.zeta_rest, zeta_limits=model.zeta_limits,
            cone_angle=model.cone_angle)
