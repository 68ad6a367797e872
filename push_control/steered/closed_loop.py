"""
One push with feedback: estimator, guidance and steering law for one target.

Every control step is a chain: estimate the push one drive lag ahead, project the flat output z on
its path, keep or replace that path, choose a curvature within the limits, and compute the command
that gives it.
"""

import math
from typing import NamedTuple

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered.contact_model import ContactModel
from push_control.steered.execution import PushExecution
from push_control.steered.laws.command import contact_speed
from push_control.steered.laws.steering_law import Foresight, SteeringInput, SteeringLaw
from push_control.steered.monitors import jackknife_fault, OneSidedMonitor
from push_control.steered.path.guidance import Guidance
from push_control.steered.path.path import (
    CurvatureLimits, flat_output_pose, FlatOutputPath, path_to_goal, PathProjection, SampledPath)
from push_control.steered.plan_bounds import PlanBounds, planned_length
from push_control.steered.status import ControllerStatus, Phase
from push_control.steered.tracking import PushTracker
from push_control.supervision_settings import GLIMPSED_SIGMAS
from push_model.events import EventReport, PushEvent, sentence
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_safety.stop import is_at_rest

# Spacing of the positions at which a new path is compared with the floor of the plan [m]; chosen:
# a small part of any turn, and of the margin of the floor.
FLOOR_SPACING = 0.1
# Fraction of the tolerances within which a push has arrived. Chosen: the estimate of the pose is
# off by some millimetres itself.
ARRIVAL_TOLERANCE_RATIO = 0.85
# Time at rest for which further poses may show that the object is at its goal [s]. Chosen: the
# mean of a hundred poses, at 20 Hz, errs by a tenth of their noise where errors are independent.
ARRIVAL_TIME_LIMIT = 5.0


class _Target(NamedTuple):
    """
    Plan that is followed at present.

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
    Motion that was commanded last.

    :param curvature: of z [1/m], or None where the law starts afresh.
    :param elapsed: time since the robot set out [s].
    :param speed: of the contact [m/s].
    """

    curvature: float | None = None
    elapsed: float = 0.0
    speed: float = 0.0


class _Outcome(NamedTuple):
    """
    Outcome of the push, if it has ended.

    :param has_arrived: whether the robot stops because the object seems to be at its goal.
    :param rest_time: when the robot has come to rest there [s], or None.
    :param is_finished: whether the object is at its goal.
    :param failure: ``EventReport``, or None.
    :param may_replan: whether another plan may be requested after the failure.
    """

    has_arrived: bool = False
    rest_time: float | None = None
    is_finished: bool = False
    failure: EventReport | None = None
    may_replan: bool = False


class ClosedLoopPush(PushExecution):
    """Brings the object along the path of a target, from late and noisy measurements."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings,
                 law: SteeringLaw, target: PushTrajectory, observation: Observation):
        """
        Start a push.

        :param law: the ``SteeringLaw``; it is reset.
        :param observation: first ``Observation``, with an object pose.
        :raises ValueError: where this robot cannot push so at the target's contact, or there is
            no object pose.
        """
        if observation.object_pose is None:
            raise ValueError('observation.object_pose: got None, expected an ObjectPose')
        self._settings = settings
        self._size = obj.size
        self._law = law
        self._model = ContactModel(obj, robot, settings, target)
        self._time_constant = robot.time_constant + robot.dead_time
        self._tracker = PushTracker(self._model.motion, settings, self._model.center,
                                    observation.object_pose, observation.odometry)
        self._motion = _Motion()
        law.reset()
        self._bound_by(target)
        self._follow(target, replan_requests=0)
        # Also loads machine code before the robot moves.
        self._look(observation.time)
        self._model.command(0.0, 0.0)
        self._model.stop()
        self._guidance.restart()

    def _bound_by(self, target: PushTrajectory) -> None:
        """Let a plan decide what the push may take of floor and length."""
        self._bounds = PlanBounds(target, self._size, self._settings)
        self._bounds_start = self._tracker.travelled_distance

    def _follow(self, target: PushTrajectory, replan_requests: int) -> None:
        """Take up a target, at its start."""
        self._guidance = Guidance(SampledPath(self._model.nominal, target), self._settings)
        self._one_sided = OneSidedMonitor(self._settings)
        self._bounds.restart()
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

        One that was requested after a failure must keep to the bounds of the first plan: else that
        failure is final.
        """
        site = self._model.initial_site(target)
        shift = self._model.predicted.pose.inverse() @ Pose(*target.object_poses[0].tolist())
        if (observation.time < self._tracker.last_odometry.time
                or not self._tracker.site.is_same_push(site, shift)):
            return False
        failure, settings = self._outcome.failure, self._settings
        # After a failure the robot has been stopped.
        speed = self._motion.speed if failure is None else 0.0
        self._motion = self._motion._replace(
            elapsed=max(0.0, speed - settings.start_speed) / settings.acceleration)
        if failure is None or not self._has_goal_of(target):
            self._bound_by(target)
            self._follow(target, self._target.replan_requests)
        else:
            self._retry(target, failure)
        return True

    def retry_after(self, failed: 'ClosedLoopPush', target: PushTrajectory) -> None:
        """
        Keep to the bounds of a push that has failed, where this one begins for the same goal.

        :param failed: the ``ClosedLoopPush`` that has requested the target.
        :param target: the ``PushTrajectory`` that this push has begun with.
        """
        failure = failed.failure
        if failure is None or not failed._has_goal_of(target):
            return
        self._bounds = failed._bounds
        self._bounds_start = self._tracker.travelled_distance - failed._bounded_distance
        self._target = self._target._replace(replan_requests=failed._target.replan_requests)
        self._retry(target, failure)

    def _has_goal_of(self, target: PushTrajectory) -> bool:
        """Tell whether a target ends where the present one does."""
        return self._settings.tolerances.contain(Pose(*target.object_poses[-1].tolist()),
                                                 self._target.goal)

    def _retry(self, target: PushTrajectory, failure: EventReport) -> None:
        """Take up the plan requested after a failure, where it keeps to the first one's bounds."""
        if self._keeps_to_bounds(planned_length(target), target.object_poses[:, :2]):
            self._follow(target, self._target.replan_requests + 1)
        else:
            self._outcome = _Outcome(
                failure=PushEvent.PLAN_EXCEEDS_FLOOR.report(failure=failure))

    def observe(self, observation: Observation) -> None:
        """Process the measurements that are new."""
        self._set_failure(self._tracker.observe(observation))

    def pose_fault(self, time: float) -> EventReport | None:
        """Tell why poses have not been believed for a while, as of ``Estimator.pose_fault``."""
        return self._tracker.pose_fault(time)

    def pause(self, odometry: Odometry | None) -> None:
        """Stand still; the next ``advance`` sets out from rest."""
        self._motion = self._motion._replace(elapsed=0.0)
        self._model.stop()
        # A robot that was to stop at the goal may have gone on: judged again from where it stands.
        self._outcome = self._outcome._replace(has_arrived=False, rest_time=None,
                                               is_finished=False)
        self._law.reset()
        if odometry is not None:
            self._tracker.add_odometry(odometry)

    def advance(self, time: float, dt: float) -> Twist:
        """Compute the command."""
        keeps_path = self._look(time)
        projection = self._projection = self._guidance.last_projection
        if self._outcome.has_arrived:
            command = STOP
            self._check_arrival(time)
        elif self._tracker.is_contact_lost:
            command = self._close_gap(dt)
        else:
            projection = self._projection = self._update_path(projection, keeps_path, dt)
            self._check_bounds(projection.remaining_distance, dt)
            has_ended = self._outcome.has_arrived or self.failure is not None
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
        """Tell whether the object is at its goal."""
        return self._outcome.is_finished

    @property
    def failure(self) -> EventReport | None:
        """Why the push has failed, or None."""
        return self._outcome.failure

    @property
    def replan_requested(self) -> bool:
        """Tell whether it has failed where another plan may bring the object to its goal."""
        return self.failure is not None and self._outcome.may_replan

    @property
    def notice(self) -> EventReport | None:
        """Notice of an event while the push goes on, or None."""
        return self._tracker.detector.notice

    @property
    def travelled_distance(self) -> float:
        """Path length of the contact since the target was taken up [m]."""
        return self._tracker.travelled_distance - self._target.start_distance

    def status(self, phase: Phase, event: EventReport | None) -> ControllerStatus:
        """Describe the push."""
        state, projection, guidance = self._model.predicted, self._projection, self._guidance
        position_error, heading_error = self._errors
        return ControllerStatus(
            phase=phase, reason=sentence(event), event=None if event is None else event.code,
            position_error=position_error,
            heading_error=heading_error,
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

    def _update_path(self, projection: PathProjection, keeps_path: bool,
                     dt: float) -> PathProjection:
        """Keep the path or replace it, and end the push at its end."""
        guidance, travelled = self._guidance, self.travelled_distance
        if guidance.is_due(projection.remaining_distance, keeps_path, travelled, dt):
            reapproaches = guidance.reapproaches
            projection = guidance.update(self._model.flat_output, projection, self._draw_path)
            if guidance.reapproaches > reapproaches:
                self._bounds.restart()
        if projection.remaining_distance > self._settings.stop_distance:
            return projection
        return self._arrive(projection)

    def _arrive(self, projection: PathProjection) -> PathProjection:
        """Approach the goal again unless the object has come near enough, or end the push."""
        flat_output = self._model.flat_output
        # Back from beyond the goal is a matter of another plan.
        is_beyond = flat_output.x > self._settings.position_tolerance
        if not (is_beyond or self._is_at_goal(ARRIVAL_TOLERANCE_RATIO)):
            again = self._guidance.reapproach(flat_output, self._draw_path)
            if again is not None:
                self._bounds.restart()
                return again
        if self._is_at_goal():
            self._outcome = self._outcome._replace(has_arrived=True)
        else:
            self._fail(self._missed_goal())
        return projection

    def _check_arrival(self, time: float) -> None:
        """Tell at rest whether the object is at its goal, once enough poses have shown it."""
        outcome = self._outcome
        if outcome.is_finished or not is_at_rest(self._tracker.last_odometry.twist):
            return
        rest_time = time if outcome.rest_time is None else outcome.rest_time
        is_finished = self._is_at_goal(sigmas=GLIMPSED_SIGMAS)
        self._outcome = outcome._replace(rest_time=rest_time, is_finished=is_finished)
        if not self._is_at_goal(sigmas=-GLIMPSED_SIGMAS):
            self._fail(self._missed_goal())
        elif not is_finished and time - rest_time > ARRIVAL_TIME_LIMIT:
            self._set_failure(self._uncertain_arrival())

    def _uncertain_arrival(self) -> EventReport:
        settings, (position_error, heading_error) = self._settings, self._errors
        position_std, heading_std = self._tracker.pose_deviations(self._target.goal)
        return PushEvent.ARRIVAL_UNCERTAIN.report(
            time=ARRIVAL_TIME_LIMIT, distance=1e3 * position_error,
            heading=math.degrees(abs(heading_error)),
            position_std=1e3 * position_std, heading_std=math.degrees(heading_std),
            position_tolerance=1e3 * settings.position_tolerance,
            heading_tolerance=round(math.degrees(settings.heading_tolerance), 3))

    def _missed_goal(self) -> EventReport:
        position_error, heading_error = self._errors
        return PushEvent.GOAL_MISSED.report(distance=1e3 * position_error,
                                            heading=math.degrees(heading_error))

    def _is_at_goal(self, tolerance_ratio: float = 1.0, sigmas: float = 0.0) -> bool:
        """
        Tell whether the errors of the object keep to a fraction of the tolerances.

        That z is at its goal is not enough: it lies off the object's frame, whose heading error
        adds to its distance.

        :param sigmas: standard deviations of the estimate that are added to the errors.
        """
        position_error, heading_error = self._errors
        if sigmas != 0.0:
            position_std, heading_std = self._tracker.pose_deviations(self._target.goal)
            position_error += sigmas * position_std
            heading_error = abs(heading_error) + sigmas * heading_std
        return (position_error <= tolerance_ratio * self._settings.position_tolerance
                and abs(heading_error) <= tolerance_ratio * self._settings.heading_tolerance)

    def _replan_limits(self) -> CurvatureLimits:
        """Limits of new paths: a differential drive has no cone to spare to one side."""
        caution = 1.0
        if not self._model.is_differential:
            caution = self._guidance.cone_fraction(self._model.center_error_ratio())
        return self._model.limits(self._settings.replan_cone_fraction * caution)

    def _draw_path(self, pose: Pose) -> FlatOutputPath | None:
        """Draw the shortest path to the goal; None where it leaves the bounds of the plan."""
        path = path_to_goal(pose, self._replan_limits(), self._settings.final_straight)
        is_allowed = self._keeps_to_bounds(path.length, self._object_positions(path))
        return path if is_allowed else None

    def _keeps_to_bounds(self, length: float, positions: FloatArray) -> bool:
        """Tell whether a path from here keeps to what the first plan needed, and some more."""
        return (self._bounded_distance + length <= self._bounds.max_length
                and self._bounds.is_on_floor(positions))

    def _object_positions(self, path: FlatOutputPath) -> FloatArray:
        """Positions of an object whose z follows a path, in the world [m], shape (n, 2)."""
        local = flat_output_pose(self._model.vehicle)
        frame, to_object = self._target.goal @ local, local.inverse()
        distances = np.arange(0.0, path.length, FLOOR_SPACING).tolist()
        return np.array([(frame @ path.at(s).pose @ to_object)[:2] for s in distances])

    @property
    def _bounded_distance(self) -> float:
        """Path length of the contact since the first plan was taken up [m]."""
        return self._tracker.travelled_distance - self._bounds_start

    @property
    def _errors(self) -> tuple[float, float]:
        """Distance of the object from its goal [m], and heading error [rad]."""
        state, goal = self._model.predicted, self._target.goal
        return (math.hypot(state.x - goal.x, state.y - goal.y),
                wrap_angle(state.theta - goal.theta))

    def _check_bounds(self, remaining_distance: float, dt: float) -> None:
        """Abort a push that takes more floor, length or time than its plan stands for."""
        if self._outcome.has_arrived or self._outcome.failure is not None:
            return
        state = self._model.predicted
        excess = self._bounds.check((state.x, state.y), self._bounded_distance,
                                    remaining_distance, dt)
        if excess is not None:
            position_error, heading_error = self._errors
            report = excess.code.report(**excess.values, distance=1e3 * position_error,
                                        heading=math.degrees(abs(heading_error)))
            if excess.code is PushEvent.NO_PROGRESS:
                self._fail(report)
            else:
                # No plan from here keeps to what has been exceeded.
                self._set_failure(report)

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
