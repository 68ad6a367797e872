"""Perception of a task: where the robot is, where the object is at rest, and what contradicts."""

import math

from push_base.base_model import BaseModel, PredictedMotion
from push_control.events import PerceptionEvent
from push_control.perception.contact_consistency import Touch
from push_control.perception.localization import Localization
from push_control.perception.lost_robot import LostRobotMonitor
from push_control.perception.lost_robot_events import (
    InflateRobot, LostRobotEvent, LostRobotTouched, ObjectMoved, ObjectPoseAccepted,
    ObjectPoseRejected, ObjectTapped, OdometryFault, PlaceRobot, PushSucceeded, PushWithoutEffect,
    RestoreRobot, RobotLocalized, RobotMoved, TapCompared, TaskStarted, UnexpectedContact, Verdict)
from push_control.perception.measurement_faults import is_finite_odometry
from push_control.perception.object_at_rest import ObjectAtRest, StationarityWindow, Tap
from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.perception.raw_perception import RawPerception
from push_control.perception.view import View
from push_control.settings import ControlSettings
from push_control.supervision_settings import SupervisionSettings
from push_model.events import EventReport, PushEvent, Report
from push_model.geometry import Pose
from push_model.observation import Observation
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectEstimate, ObjectPose, Odometry, PoseDeviation, Twist
from push_navigation.map_clearance import PositionUncertainty

# Errors of the object at rest over the standard deviations of an ensemble that estimates a bias,
# which is too sure; measured: 1.1 to 1.3 in the root mean square.
DEVIATION_FACTOR = 1.3
# Time for which poses may be missing where they are expected again [s]; chosen: the estimate is
# off by a little, and at the edge of a view poses come and go.
RETURN_TIME = 0.75
# Age of a pose, and time for which poses show an object at rest, that is seen [s]; chosen: three
# periods of a slow camera with its latency, and two poses of it.
PRESENT_TIME, SEEN_TIME = 0.35, 0.08
# Time without a pose that is explained, while others come, after which a robot waits [s]; chosen:
# two outliers in a row at 10 Hz, which trackers give by chance, take less.
UNEXPLAINED_TIME = 0.35


class TaskPerception(RawPerception):
    """
    Estimates where robot and object are.

    ``localization``: the ``Localization`` of both. ``base``: the ``BaseModel``, which gets every
    command. ``view``: the ``View``, from where the object is seen.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 supervision: SupervisionSettings, *, since: float = -math.inf) -> None:
        """
        Start without measurements.

        :param since: time before which object poses tell nothing of where the object is [s].
        """
        super().__init__(control)
        self._time_constant = robot.time_constant
        self.base = BaseModel(robot)
        self._since = since
        self.view = View.from_settings(supervision)
        self._has_limited_view = supervision.has_limited_view
        # When poses were last not to be expected [s].
        self._unexpected_at = -math.inf
        self.localization = Localization(obj, robot, control, supervision)
        self._monitor = LostRobotMonitor(obj, robot, self.localization,
                                         supervision.odometry_reference == 'drifting')
        self._window = StationarityWindow(control, supervision)
        self._at_rest_from = 0.0
        # The newest pose that the filter accepts, and whether the newest one is an outlier.
        self._accepted: ObjectPose | None = None
        self._is_outlier = False
        # A push of which the average of the object at rest is to show the effect.
        self._tap: Tap | None = None
        self._is_tap_new = False
        # Whether a place in the map has put the robot elsewhere, and nobody has asked yet.
        self._is_relocated = False

    # Measurements.

    def update(self, observation: Observation) -> None:
        """Take in measurements."""
        odometry, measured = observation.odometry, self._present_pose(observation)
        if observation.base is not None:
            self.base.dead_time = observation.base.dead_time
        has_odometry = is_finite_odometry(odometry)
        has_pose = measured is not None and measured.pose.is_finite()
        if has_odometry:
            self._take_odometry(odometry)
        if measured is not None and has_pose:
            measured = self._take_object_pose(measured)
        if observation.place is not None and self.localization.take_place(observation.place):
            self._is_relocated = True
            # What was known before a push is of where the robot was not.
            self._tap = None
            self._observe(RobotLocalized())
        if has_odometry or has_pose:
            odometry = self.localization.corrected(odometry)
        self._observation = observation._replace(odometry=odometry, object_pose=measured)
        self._take_bumper(observation)
        if self.has_limited_view and not self.expects_pose:
            self._unexpected_at = self.time

    def _present_pose(self, observation: Observation) -> ObjectPose | None:
        """Return the object pose, unless it is of where the object was before."""
        measured = observation.object_pose
        return None if measured is None or measured.time < self._since else measured

    def _take_odometry(self, odometry: Odometry) -> None:
        """Move the robot by odometry, and correct it where that measures the world."""
        is_first = not self.localization.has_received_odometry
        step = self.localization.move(odometry)
        if is_first:
            self._observe(RobotLocalized())
        elif step is not None:
            self._observe(RobotMoved(step, self._last_object_pose))
        self.localization.correct_by(odometry)

    @property
    def _last_object_pose(self) -> Pose | None:
        """Pose of the object when last seen; while it is not seen, the expected one."""
        if self._accepted is None:
            return None
        return self.localization.object_pose if self.is_blind else self._accepted.pose

    def _take_object_pose(self, measured: ObjectPose) -> ObjectPose:
        """Correct the estimate by an object pose; return the newest one that it includes."""
        measured = self._placed(measured)
        is_new = self._pose_time is None or measured.time > self._pose_time
        self._pose_time = measured.time
        is_accepted = self.localization.update(measured)
        if is_new:
            self._is_outlier = not is_accepted
        if is_accepted:
            self._accept(measured)
        elif is_new:
            self._observe(ObjectPoseRejected())
        accepted = self._accepted or measured
        if measured.time >= self._at_rest_from:
            self._window.add(measured if self._is_outlier else accepted, self._is_outlier)
        return accepted

    def _placed(self, measured: ObjectPose) -> ObjectPose:
        """Place a pose that is relative to the robot in the world, by where the robot was."""
        localization = self.localization
        if measured.relative is None or not localization.is_initialized:
            return measured
        return measured._replace(pose=localization.pose_at(measured.time) @ measured.relative)

    def _accept(self, measured: ObjectPose) -> None:
        localization = self.localization
        self._observe(ObjectPoseAccepted(measured))
        if localization.is_initialized:
            self._monitor.remember(localization.remember_robot())
        self._accepted = measured
        if localization.has_pose_bias:
            self._accepted = localization.without_bias(measured)

    @property
    def corrected_observation(self) -> Observation:
        """The newest ``Observation``, with the robot as localized since."""
        odometry = self.observation.odometry._replace(pose=self.localization.pose)
        return self.observation._replace(odometry=odometry)

    # What is seen.

    @property
    def has_limited_view(self) -> bool:
        """Tell whether there are places from which the object is not seen."""
        return self._has_limited_view

    @property
    def expects_pose(self) -> bool:
        """Tell whether the robot is estimated to be where poses of the object have to come."""
        localization = self.localization
        if not (localization.is_initialized and localization.has_object):
            return False
        robot, obj = localization.pose, localization.object_pose
        return self.view.expects(robot, obj, localization.members.gap(obj, robot),
                                 localization.position_deviation,
                                 float(localization.standard_deviations[2]))

    @property
    def is_blind(self) -> bool:
        """Tell whether no object poses come, as was to be expected lately."""
        timeout = self._control.pose_timeout
        return (self.has_limited_view and timeout < self.pose_age < math.inf
                and self.time - self._unexpected_at <= timeout + RETURN_TIME)

    @property
    def has_fresh_pose(self) -> bool:
        """Tell whether poses of the object come."""
        return self.pose_age <= max(PRESENT_TIME, self._control.pose_timeout)

    @property
    def sees_object_at_rest(self) -> bool:
        """Tell whether poses come that show the object at rest."""
        average = self._window.object_at_rest
        return average is not None and self.has_fresh_pose and average.duration >= SEEN_TIME

    @property
    def awaits_explanation(self) -> bool:
        """
        Tell whether the object has not been where it should for longer than a tracker errs.

        Another pose tells whether it was moved; where they come seldom, that takes long.
        """
        return (self._is_outlier and self._accepted is not None and self._pose_time is not None
                and self._pose_time - self._accepted.time >= UNEXPLAINED_TIME)

    def measurement_fault(self, needs_object: bool) -> EventReport | None:
        """Tell why the measurements cannot be used; a robot that is blind needs no pose."""
        fault = super().measurement_fault(needs_object and not self.is_blind)
        if fault is None and self.localization.is_place_lost:
            return PushEvent.PLACE_LOST.report()
        return fault

    @property
    def object_pose(self) -> ObjectPose:
        """
        The newest measured ``ObjectPose``; where the object is expected now while blind.

        :raises RuntimeError: before the first one.
        """
        if self.is_blind:
            return ObjectPose(self.time, self.localization.object_pose)
        return super().object_pose

    @property
    def expected_object_pose(self) -> Pose:
        """``Pose`` that the object should have by now, be it seen or not."""
        if self.has_limited_view:
            return self.localization.object_pose
        return self.object_pose.pose

    # The robot.

    @property
    def is_localized(self) -> bool:
        """Tell whether it is known where the robot is."""
        return self.localization.is_initialized

    @property
    def robot_pose(self) -> Pose:
        """``Pose`` of the robot in the world."""
        return self.localization.pose

    @property
    def position_deviation(self) -> float:
        """Standard deviation of the robot's position [m]."""
        return self.localization.position_deviation

    def take_over_robot(self, previous: RawPerception) -> None:
        """Start with the robot where it was localized while it pushed another object."""
        if isinstance(previous, TaskPerception):
            self.localization.take_over_robot(previous.localization)

    @property
    def predicted_motion(self) -> PredictedMotion:
        """``PredictedMotion`` of the robot within its dead time."""
        return self.base.predict(self.observation.odometry.twist, self.time)

    @property
    def predicted_pose(self) -> Pose | None:
        """``Pose`` of the robot a dead time and a lag ahead; None where it has no dead time."""
        if self.base.dead_time == 0.0:
            return None
        lag, (displacement, velocity) = self._time_constant, self.predicted_motion
        x, y, theta = self.robot_pose @ displacement
        rotation = lag * velocity.omega
        v_x, v_y = Pose(0.0, 0.0, theta + 0.5 * rotation).rotate(velocity[:2])
        return Pose(x + lag * v_x, y + lag * v_y, theta + rotation)

    def add_command(self, command: Twist, time: float) -> None:
        """Note what is commanded, which acts later where the base is late."""
        self.base.add_command(command, time)

    @property
    def is_robot_measured(self) -> bool:
        """Tell whether odometry measures the robot in the world, without drift."""
        return self.localization.is_robot_measured

    @property
    def is_robot_placed(self) -> bool:
        """Tell whether the place of the robot in its map is measured, beside odometry."""
        return self.localization.is_robot_placed

    def pop_relocation(self) -> bool:
        """Tell once that the robot is elsewhere in its map than it seemed to be."""
        is_relocated, self._is_relocated = self._is_relocated, False
        return is_relocated

    @property
    def is_robot_elsewhere(self) -> bool:
        """Tell whether jumps of odometry have put the robot elsewhere: nothing known holds."""
        return self.localization.is_robot_elsewhere

    @property
    def position_uncertainty(self) -> PositionUncertainty:
        """``PositionUncertainty`` of the robot; it grows where odometry drifts."""
        return self.localization.position_uncertainty

    @property
    def odometry_inconsistency(self) -> Report[PerceptionEvent] | None:
        """Inconsistency of odometry with the contacts; None where there is none."""
        return self.localization.odometry_inconsistency

    @property
    def gap(self) -> float:
        """Gap between the robot and the object at rest [m], negative on overlap."""
        return self.localization.members.gap(self.object_at_rest.pose, self.robot_pose)

    def update_from_contact(self, obj: PushedObject, robot: RoundRobot, deviation: float,
                            is_certain: bool = True) -> None:
        """
        Localize the robot by its contact with the object, at the time of the last object pose.

        :param deviation: standard deviation of the gap [m].
        :param is_certain: whether they are in contact for certain.
        """
        self.localization.update_from_contact(self.object_pose, obj, robot, deviation, is_certain)

    def correct_overlap(self, obj: PushedObject, robot: RoundRobot, deviation: float) -> None:
        """
        Correct a robot pose that overlaps the object.

        :param deviation: standard deviation of the gap [m].
        """
        self.localization.correct_overlap(self.object_pose, obj, robot, deviation)

    # The object.

    @property
    def object_estimate(self) -> ObjectEstimate | None:
        """The present ``ObjectEstimate``; None before the first measurements."""
        localization = self.localization
        if not (localization.is_initialized and localization.has_object):
            return None
        return ObjectEstimate(self.time, localization.object_pose,
                              localization.object_covariance, localization.friction_center)

    @property
    def knowledge(self) -> ObjectKnowledge:
        """``ObjectKnowledge`` of by now."""
        return self.localization.knowledge

    def start_from(self, knowledge: ObjectKnowledge) -> None:
        """Start with what was learned of the object."""
        self.localization.start_from(knowledge)

    # The object at rest.

    @property
    def has_object_at_rest(self) -> bool:
        """Tell whether the object was measured since it may be at rest."""
        return self._window.object_at_rest is not None

    @property
    def object_at_rest(self) -> ObjectAtRest:
        """
        The ``ObjectAtRest``.

        :raises RuntimeError: where it was not measured since it may be at rest.
        """
        average, localization = self._window.object_at_rest, self.localization
        if average is None:
            raise RuntimeError('perception: got no pose of the object at rest, expected one')
        if localization.is_relative:
            return self._relative_at_rest(average)
        if not localization.has_pose_bias:
            return average
        x, y, heading = (DEVIATION_FACTOR * localization.object_deviations).tolist()
        return average._replace(
            pose=localization.object_pose, position_error=max(x, y, average.position_error),
            heading_error=max(heading, average.heading_error), is_biased=True)

    def _relative_at_rest(self, average: ObjectAtRest) -> ObjectAtRest:
        """
        Return the object at rest by poses that are relative to the robot.

        Where the robot is measured in the world, its errors count; else the goal is known only as
        its odometry has it, which ``goal_deviation`` tells.
        """
        average = average._replace(pose=self.localization.object_pose)
        if not self.is_robot_measured:
            return average
        localization = self.localization
        x, y, heading = localization.object_deviations.tolist()
        return average._replace(position_error=max(average.position_error, x, y),
                                heading_error=max(average.heading_error, heading),
                                is_in_map=localization.is_robot_in_map)

    @property
    def is_object_landmark(self) -> bool:
        """Tell whether the object is seen relative to a robot whose own place drifts or jumps."""
        localization = self.localization
        return localization.is_relative and not (
            self.is_robot_measured and not localization.is_robot_in_map)

    @property
    def goal_deviation(self) -> PoseDeviation | None:
        """
        ``PoseDeviation`` of the object in the frame of its goal; None where tolerances bound it.

        With poses that are relative to a robot the place of the goal errs as that of the robot
        does, however well the object is seen: it drifts with odometry, or is that of a map.
        """
        if not self.is_object_landmark:
            return None
        return self.localization.object_covariance.deviation

    def restart_averaging(self, time: float) -> None:
        """Forget where the object was at rest."""
        self._window.clear()
        self._at_rest_from = time

    @property
    def motion_report(self) -> Report[PerceptionEvent]:
        """Why the object does not come to rest."""
        return self._window.motion_report()

    @property
    def repeats_pose(self) -> bool:
        """Tell whether the last object poses are one, to the last digit."""
        return self._window.repeats_pose and not self.is_blind

    @property
    def have_poses_jumped(self) -> bool:
        """Tell whether object poses have jumped in this task."""
        return self._monitor.have_poses_jumped

    @property
    def pose_jump(self) -> Report[PerceptionEvent] | None:
        """Jump of the object poses in this task that they did not take back, or None."""
        return self._monitor.pose_jump

    # Is the robot where it is localized?

    @property
    def pose_inconsistency(self) -> Report[PerceptionEvent] | None:
        """Inconsistency of object poses or robot with the contacts; None where all fits."""
        return self._monitor.inconsistency

    @property
    def is_refuted(self) -> bool:
        """Tell whether contacts have shown that robot and object are not where they seem to be."""
        return self._monitor.is_refuted

    @property
    def is_object_unyielding(self) -> bool:
        """Tell whether a robot that seems to be where it should has pushed without effect."""
        return self._monitor.is_object_unyielding

    @property
    def is_lost(self) -> bool:
        """Tell whether pushes without effect have shown that the robot is elsewhere."""
        return self._monitor.is_lost

    @property
    def was_displaced(self) -> bool:
        """Tell whether the object has lately moved further than the robot can have pushed it."""
        return self._monitor.was_displaced(self.time)

    def forget_contacts(self) -> None:
        """Note that another task starts: what contacts have shown may have been mended."""
        self._tap = None
        self._observe(TaskStarted())

    def distrust_odometry(self, has_jumped: bool) -> None:
        """Note that odometry is wrong, so that the robot may be elsewhere."""
        self.localization.set_jumped(has_jumped)
        if self.localization.is_initialized:
            self._observe(OdometryFault(has_jumped))

    def on_push_succeeded(self, contact: Touch = Touch.PUSHED) -> None:
        """
        Note that a push has moved the object, so that the robot is where it is estimated to be.

        :param contact: ``Touch``, but for those that have not moved it.
        """
        self._tap = None
        self._observe(PushSucceeded(contact, self.time))

    def on_tapped(self, tap: Tap) -> None:
        """
        Note that a push has ended as planned before it was seen how the object moves.

        :param tap: ``Tap``; one that noise has hidden until now is added to it.
        """
        self._tap, self._is_tap_new = tap.after(self._tap), True

    def evaluate_push(self) -> None:
        """
        Evaluate a push whose effect shows in the average of the object at rest only.

        One that is too short to be told from noise is evaluated together with the next one.
        """
        tap = self._tap
        if tap is None or not self._is_tap_new:
            return
        self._is_tap_new = False
        after = self.object_at_rest
        if not tap.has_moved_object(after):
            if not tap.is_too_short(after, self.localization.members.obj.size):
                self._forget_contact(tap)
                self.on_push_without_effect()
            return
        self._tap = None
        if tap.if_missed is not None:
            self._observe(ObjectTapped())
        if math.hypot(*tap.driven) > 0.0:
            self._observe(TapCompared(tap.motion(after)))

    def _forget_contact(self, tap: Tap) -> None:
        """Forget where the robot seemed to be by a contact that there was not."""
        if tap.if_missed is not None and not self.localization.is_relative:
            self.localization.restore_robot(tap.if_missed, 0.0, 0.0)

    def on_push_without_effect(self, deviation: float = math.inf) -> None:
        """
        Note that a push has not moved the object: after some, the robot is elsewhere.

        :param deviation: standard deviation of the robot's position at the touch [m].
        """
        self._tap = None
        self._observe(PushWithoutEffect(self.object_pose.pose, deviation))

    def on_unexpected_contact(self) -> None:
        """Note that the robot has run into an object that should not be there."""
        self._tap = None
        self._observe(UnexpectedContact(self.object_pose.pose))

    def on_lost_robot_touched(self) -> bool:
        """Note that a lost robot moves the object; return whether that relocalizes it."""
        return self._observe(LostRobotTouched(self.object_pose.pose)) is not None

    def on_object_moved(self, before: Pose) -> None:
        """
        Note that the object has moved while it was not pushed.

        :param before: ``Pose`` that the object had at rest.
        """
        self._observe(ObjectMoved(before, self.object_at_rest.pose, self.object_pose.pose,
                                  self.time))

    def _observe(self, event: LostRobotEvent) -> Verdict:
        """Let the monitor evaluate an event, and correct the robot as it says."""
        verdict, localization = self._monitor.observe(event), self.localization
        if isinstance(verdict, PlaceRobot):
            localization.place_robot(verdict.pose, verdict.stds)
        elif isinstance(verdict, RestoreRobot):
            localization.restore_robot(verdict.memory, *verdict.stds)
            self._observe(RobotLocalized())
        elif isinstance(verdict, InflateRobot):
            localization.inflate_covariance(*verdict.stds)
        return verdict
