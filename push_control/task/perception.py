"""Perception of a task: pose of the robot, and pose of the object at rest."""

from collections import deque
import math
from typing import NamedTuple

import numpy as np
from push_control.estimation.monitors import is_finite_odometry, measurement_fault
from push_control.events import EventReport
from push_control.localization.contact_evidence import Contact, ContactEvidence
from push_control.localization.displacement import Displacement, DisplacementWatch
from push_control.localization.push_ensemble import OdometryNoise, PushEnsemble, RobotMemory
from push_control.localization.slip_search import SlipSearch
from push_control.observation import Observation
from push_control.safety.odometry_check import integrated_step
from push_control.settings import ControlSettings
from push_control.task.settings import SupervisionSettings
from push_model.contact import find_contact, FoundContact
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectPose, Odometry

# Moves of an object that nothing explains, of which the last one relocalizes the robot; chosen:
# the first one may have been somebody else.
UNEXPLAINED_MOVES = 2
# Standard deviations (x, y, heading) of a robot that is localized by such a move [m, m, rad];
# chosen: about a radius, and what a heading errs by that has led there.
BEHIND_OBJECT_STD = (0.15, 0.15, 0.4)
# Steps of the search for the contact behind an object; chosen: each one leaves less than half of
# the distance, so that 12 leave below a millimetre.
TRACE_STEPS = 12
# Poses of which noise is estimated, and its ratio to what is stated above which it is greater;
# chosen: a second or two of poses, and more than an estimate from these errs by.
NOISE_POSES = 30
NOISY_RATIO = 1.6
# Shift from the first to the last of them, over that noise, by which the object moves steadily;
# chosen: noise alone shifts them by 1.4 of it, in the root mean square.
MOVING_SIGMAS = 10.0
# Part of these that may be outliers, while the object is at rest by the others; chosen: a tracker
# errs less often by chance, and noise of which too little is stated gives two in three.
MAX_OUTLIER_RATIO = 1.0 / 3.0
# Standard deviations that odometry which was wrong adds to the robot's position [m] and heading
# [rad]: by a jump, which is not added up, and otherwise; chosen: what it covers before that is
# noticed and until it stands.
JUMP_STD = 0.03, 0.03
DISTRUST_STD = 0.08, 0.05
# Motion of an object at rest that shows a push too short to be seen at once, in standard errors;
# pushes in a row without any from which on the robot is elsewhere, and the standard deviations
# that each of them adds to its position [m] and heading [rad]; chosen: one may end too early.
PUSHED_SIGMAS = 3.0
VAIN_PUSHES = 2
VAIN_STD = 0.05, 0.1
# Least standard deviations (x, y, heading) of a robot whose slip was guessed [m, m, rad]; chosen:
# few guesses are left then.
LEAST_FOUND_STD = 0.03, 0.03, 0.1
# Time for which a displacement of the object explains that it is elsewhere [s]; chosen: a plan is
# made meanwhile.
DISPLACED_TIME = 2.0
# Standard deviations that what was driven meanwhile adds to a robot whose place is remembered
# from before a mistake of the tracker [m], [rad]; chosen: seconds of driving.
RETURN_STD = 0.01, 0.01
# Standard deviations of the scale of odometry beyond which an estimate of it is no chance; chosen.
UNLIKELY_SIGMAS = 4.0
# Errors of the object at rest over the standard deviations of an ensemble that estimates a bias,
# which is too sure; measured: 1.1 to 1.3 in the root mean square.
DEVIATION_FACTOR = 1.3


class ObjectAtRest(NamedTuple):
    """
    An object at rest.

    :param pose: average of the measured poses.
    :param duration: time between the first and the last of them [s].
    :param position_error: standard error of the position along each axis [m].
    :param heading_error: standard error of the heading [rad].
    :param is_biased: whether these are mostly errors that further poses from the same side do not
        reduce.
    """

    pose: Pose
    duration: float
    position_error: float
    heading_error: float
    is_biased: bool = False


class _Sample(NamedTuple):
    """
    A measured pose in a window, or the sum of all of them.

    :param time: [s].
    :param x: [m].
    :param y: [m].
    :param rotation: since the first pose [rad].
    :param position_variance: of its error along each axis [m^2].
    :param heading_variance: of its error [rad^2].
    """

    time: float
    x: float
    y: float
    rotation: float
    position_variance: float
    heading_variance: float


class StationarityWindow:
    """Averages measured poses while the object is at rest; starts over when it has moved."""

    def __init__(self, control: ControlSettings, supervision: SupervisionSettings) -> None:
        """
        Start without measurements.

        :param control: ``ControlSettings``, for the noise of the poses.
        :param supervision: ``SupervisionSettings``.
        """
        self._control = control
        self._supervision = supervision
        self._latest: deque[ObjectPose] = deque(maxlen=NOISE_POSES)
        self._are_outliers: deque[bool] = deque(maxlen=NOISE_POSES)
        self.clear()

    def clear(self) -> None:
        """Forget all measurements, but for those that show how noisy they are."""
        self._samples: deque[_Sample] = deque()
        self._sum = _Sample(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        # Headings are averaged relative to the first, clear of the seam of angles.
        self._first_heading = 0.0
        self._average: ObjectAtRest | None = None

    def add(self, measured: ObjectPose, is_outlier: bool = False) -> None:
        """
        Take in a measurement.

        :param measured: ``ObjectPose``, finite; one that is not newer than the last is ignored.
        :param is_outlier: whether nothing explains it; does not count while that is seldom.
        """
        if self._samples and measured.time <= self._samples[-1].time:
            return
        if is_outlier and self._latest and measured.time <= self._latest[-1].time:
            return
        self._latest.append(measured)
        self._are_outliers.append(is_outlier)
        if is_outlier and sum(self._are_outliers) <= MAX_OUTLIER_RATIO * len(self._latest):
            return
        noise = self._control.believed_covariance(measured)
        position_deviation, heading_deviation = noise.position_deviation, noise.heading_deviation
        gate, pose = self._supervision.motion_gate_sigmas, measured.pose
        before = None if self._average is None else self._average.pose
        if (before is not None and (
                distance(pose, before) > gate * position_deviation
                or abs(wrap_angle(pose.theta - before.theta)) > gate * heading_deviation)):
            self.clear()
        if not self._samples:
            self._first_heading = pose.theta
        self._append(_Sample(measured.time, pose.x, pose.y,
                             wrap_angle(pose.theta - self._first_heading),
                             position_deviation ** 2, heading_deviation ** 2))
        self._average = self._averaged()

    @property
    def repeats_pose(self) -> bool:
        """Whether the last poses are one, to the last digit."""
        return (len(self._latest) == NOISE_POSES
                and len({measured.pose for measured in self._latest}) == 1)

    @property
    def object_at_rest(self) -> ObjectAtRest | None:
        """The ``ObjectAtRest``; None before the first measurement."""
        return self._average

    def unrest(self) -> str:
        """Describe why the object does not come to rest, one sentence."""
        poses = [measured.pose for measured in self._latest]
        steps = np.array([(b.x - a.x, b.y - a.y, wrap_angle(b.theta - a.theta))
                          for a, b in zip(poses, poses[1:])])
        if len(steps) < 2:
            return 'the object is not at rest: no poses of it come'
        # Of independent errors, by which three successive ones differ from a straight line.
        noise = np.sqrt((np.diff(steps, axis=0) ** 2).mean(axis=0) / 6.0)
        position, heading = float(noise[:2].max()), float(noise[2])
        shift = np.abs(steps.sum(axis=0))
        duration = self._latest[-1].time - self._latest[0].time
        if (shift > MOVING_SIGMAS * noise).any() and len(poses) == NOISE_POSES:
            return (f'the object is not at rest: it moves by itself, at '
                    f'{math.hypot(shift[0], shift[1]) / duration:.2f} m/s and '
                    f'{math.degrees(shift[2]) / duration:.0f} deg/s')
        believed = self._control.believed_covariance(self._latest[-1])
        text = (f'the object is not at rest: its poses differ from one to the next by '
                f'{1e3 * position:.1f} mm and {math.degrees(heading):.2f} deg')
        if max(position / believed.position_deviation,
               heading / believed.heading_deviation) < NOISY_RATIO:
            return text
        return text + (f', and noise of {1e3 * believed.position_deviation:.1f} mm and '
                       f'{math.degrees(believed.heading_deviation):.2f} deg is stated')

    def _append(self, sample: _Sample) -> None:
        """Add a sample to the window and its sum, and drop those that are too old."""
        samples, longest = self._samples, self._supervision.max_averaging_time
        samples.append(sample)
        total = [a + b for a, b in zip(self._sum, sample)]
        while sample.time - samples[0].time > longest:
            total = [a - b for a, b in zip(total, samples.popleft())]
        self._sum = _Sample(*total)

    def _averaged(self) -> ObjectAtRest:
        count, total = len(self._samples), self._sum
        return ObjectAtRest(
            Pose(total.x / count, total.y / count,
                 wrap_angle(self._first_heading + total.rotation / count)),
            self._samples[-1].time - self._samples[0].time,
            math.sqrt(total.position_variance) / count,
            math.sqrt(total.heading_variance) / count)


def has_moved(before: Pose, pose: Pose, settings: SupervisionSettings) -> bool:
    """
    Tell whether an object has moved too far for its plan.

    :param before: ``Pose`` that it had.
    :param pose: ``Pose`` that it has.
    :param settings: ``SupervisionSettings``.
    """
    return (distance(pose, before) > settings.moved_distance
            or abs(wrap_angle(pose.theta - before.theta)) > settings.moved_angle)


class TaskPerception:
    """
    Estimates where robot and object are.

    ``localization``: the ``PushEnsemble``.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 supervision: SupervisionSettings) -> None:
        """
        Start without measurements.

        :param obj: the nominal ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._control = control
        self._supervision = supervision
        self.localization = PushEnsemble(obj, robot, control, _odometry_noise(supervision))
        self._window = StationarityWindow(control, supervision)
        self._rest_from = 0.0
        self._pose_time: float | None = None
        # The newest pose that the filter believes, and whether it does not believe the newest one.
        self._believed: ObjectPose | None = None
        self._is_outlier = False
        self._observation: Observation | None = None
        self._unexplained_moves = 0
        # Pose of the object before a push that has not been seen to move it.
        self._pose_before_push: Pose | None = None
        self._evidence = ContactEvidence()
        # Since contacts last fitted, and when they did.
        self._slip_search = SlipSearch(obj, robot)
        self._fitted_at = -math.inf
        # Motions of the object that are not the robot's: time of the last one, and what is
        # estimated of the robot before the next one.
        self._displacements = DisplacementWatch[RobotMemory | None]()
        self._displaced_at = -math.inf
        self._memory: RobotMemory | None = None
        # The newest odometry, and whether the pose of the next one has jumped.
        self._odometry: Odometry | None = None
        self._has_jumped = False

    def update(self, observation: Observation) -> None:
        """
        Take in measurements.

        :param observation: ``Observation``, with odometry as it comes.
        """
        odometry, measured = observation.odometry, observation.object_pose
        has_odometry = is_finite_odometry(odometry)
        has_pose = measured is not None and measured.pose.is_finite()
        if has_odometry:
            self._predict(odometry)
            covariance = self._supervision.believed_covariance(odometry)
            if covariance is not None:
                self.localization.update_robot(odometry.pose, covariance.matrix)
        if measured is not None and has_pose:
            is_new = self._pose_time is None or measured.time > self._pose_time
            self._pose_time = measured.time
            is_believed = self.localization.update(measured)
            if is_new:
                self._is_outlier = not is_believed
                if not is_believed:
                    self._displacements.doubt()
            if is_believed:
                self._note_displacement(measured)
                self._believed = measured
                if self.localization.has_pose_bias:
                    self._believed = self.localization.without_bias(measured)
            believed = self._believed or measured
            if measured.time >= self._rest_from:
                self._window.add(measured if self._is_outlier else believed, self._is_outlier)
            measured = believed
        if has_odometry or has_pose:
            odometry = self._corrected(odometry)
        self._observation = Observation(observation.time, odometry, measured,
                                        observation.pose_doubt)

    def _note_displacement(self, measured: ObjectPose) -> None:
        """Forget what was inferred of the robot from poses that were a mistake."""
        localization = self.localization
        displacement = self._displacements.update(measured, self._memory)
        memory = self._displacements.memory
        if displacement is Displacement.RETURNED and memory is not None:
            localization.restore_robot(memory, *RETURN_STD)
            self._evidence.clear()
            self._slip_search.restart(localization.pose)
        if displacement is not Displacement.NONE:
            self._displaced_at = measured.time
        if localization.is_initialized:
            self._memory = localization.remember_robot()

    def distrust_odometry(self, has_jumped: bool) -> None:
        """
        Note that odometry is wrong, so that the robot may be elsewhere.

        :param has_jumped: whether the pose of the next one has jumped, so that its step is not to
            be added up.
        """
        self._has_jumped = has_jumped
        localization, deviations = self.localization, JUMP_STD if has_jumped else DISTRUST_STD
        # Once: however many messages are wrong, the robot stands soon.
        if localization.is_initialized and localization.position_deviation < deviations[0]:
            localization.inflate_covariance(*deviations)

    def _predict(self, odometry: Odometry) -> None:
        """Move the robot by odometry; by its twist alone where its pose has jumped."""
        last, step = self._odometry, None
        is_new = last is None or odometry.time > last.time
        if is_new:
            self._odometry = odometry
        if self._has_jumped and last is not None and is_new:
            self._has_jumped = False
            step = integrated_step(last, odometry)
        if last is not None and is_new:
            step = step or last.pose.inverse() @ odometry.pose
            self._displacements.drive(math.hypot(step.x, step.y))
            if self._believed is not None:
                self._slip_search.drive(step, self._believed.pose)
        self.localization.predict(odometry, step)
        if last is None:
            self._slip_search.restart(self.localization.pose)

    def _corrected(self, odometry: Odometry) -> Odometry:
        """Put the robot where it is localized."""
        if not self.localization.is_initialized:
            return odometry
        return Odometry(odometry.time, self.localization.pose, odometry.twist,
                        odometry.covariance)

    @property
    def time(self) -> float:
        """Time of the newest measurement [s]; 0 before the first."""
        return 0.0 if self._observation is None else self._observation.time

    @property
    def observation(self) -> Observation:
        """
        The newest ``Observation``, its odometry corrected for drift.

        :raises RuntimeError: before the first one.
        """
        if self._observation is None:
            raise RuntimeError('perception: got no observation, expected one')
        return self._observation

    @property
    def corrected_observation(self) -> Observation:
        """The same, with the robot as localized since."""
        odometry = self.observation.odometry._replace(pose=self.localization.pose)
        return self.observation._replace(odometry=odometry)

    @property
    def object_pose(self) -> ObjectPose:
        """
        The newest measured ``ObjectPose``.

        :raises RuntimeError: before the first one.
        """
        measured = self.observation.object_pose
        if measured is None:
            raise RuntimeError('perception: got no object pose, expected one')
        return measured

    @property
    def robot_pose(self) -> Pose:
        """``Pose`` of the robot in the world."""
        return self.localization.pose

    @property
    def has_object_at_rest(self) -> bool:
        """Whether the object was measured since it may be at rest."""
        return self._window.object_at_rest is not None

    @property
    def object_at_rest(self) -> ObjectAtRest:
        """
        The ``ObjectAtRest``.

        :raises RuntimeError: where it was not measured since it may be at rest.
        """
        found, localization = self._window.object_at_rest, self.localization
        if found is None:
            raise RuntimeError('perception: got no pose of the object at rest, expected one')
        if not localization.has_pose_bias:
            return found
        x, y, heading = (DEVIATION_FACTOR * localization.object_deviations).tolist()
        return found._replace(
            pose=localization.object_pose, position_error=max(x, y, found.position_error),
            heading_error=max(heading, found.heading_error), is_biased=True)

    def measurement_fault(self, needs_object: bool) -> EventReport | None:
        """
        Tell why the measurements cannot be used.

        :param needs_object: whether the object pose must be fresh.
        :return: ``EventReport``, or None where they can.
        """
        observation = self.observation
        pose_time = self._pose_time if needs_object else observation.time
        return measurement_fault(observation, pose_time, self._control)

    @property
    def unrest(self) -> str:
        """Why the object does not come to rest, one sentence."""
        return self._window.unrest()

    @property
    def repeats_pose(self) -> bool:
        """Whether the last object poses are one, to the last digit."""
        return self._window.repeats_pose

    @property
    def odometry_doubt(self) -> str:
        """What is wrong with odometry by the contacts with the object; empty where nothing is."""
        scale = self.localization.odometry_scale
        if abs(scale) <= UNLIKELY_SIGMAS * self._supervision.odometry_scale:
            return ''
        return (f'odometry means {100.0 * abs(scale):.0f} % {"more" if scale > 0.0 else "less"} '
                'motion than there is, as where wheels slip')

    @property
    def pose_doubt(self) -> str:
        """What contacts show of object poses, or of the robot; empty where all fits."""
        doubt, shift = self._evidence.doubt, self._displacements.shift
        if not doubt:
            return ''
        if shift is not None:
            doubt += (f', which have jumped by {math.hypot(shift.x, shift.y):.2f} m and '
                      f'{math.degrees(abs(shift.theta)):.0f} deg')
        return doubt + (': they are of another object or of the robot, mirrored or in other axes, '
                        'or the robot is elsewhere')

    @property
    def is_refuted(self) -> bool:
        """Whether contacts have shown that robot and object are not where they seem to be."""
        return self._evidence.is_refuting

    @property
    def is_lost(self) -> bool:
        """Whether pushes that moved nothing have shown that the robot is elsewhere."""
        return self._evidence.vain_pushes >= VAIN_PUSHES

    @property
    def was_displaced(self) -> bool:
        """Whether the object has lately moved further than the robot can have pushed it."""
        return self.time - self._displaced_at < DISPLACED_TIME

    def restart_averaging(self, time: float) -> None:
        """
        Forget where the object was at rest.

        :param time: from which on it may be at rest again [s].
        """
        self._window.clear()
        self._rest_from = time

    @property
    def gap(self) -> float:
        """Gap between the robot and the object at rest [m], negative on overlap."""
        return self.localization.members.gap(self.object_at_rest.pose, self.robot_pose)

    def update_from_contact(self, obj: PushedObject, robot: RoundRobot, deviation: float,
                            is_certain: bool = True) -> None:
        """
        Localize the robot by its contact with the object, at the time of the last object pose.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param deviation: standard deviation of the gap [m].
        :param is_certain: whether they are in contact for certain.
        """
        _, normal, gap = self._measured_contact(obj, robot)
        self.localization.update_along(normal, gap, deviation, is_certain)

    def correct_overlap(self, obj: PushedObject, robot: RoundRobot, deviation: float) -> None:
        """
        Correct a robot pose that overlaps the object.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param deviation: standard deviation of the gap [m].
        """
        if self._measured_contact(obj, robot).gap < 0.0:
            self.update_from_contact(obj, robot, deviation)

    def on_push_succeeded(self, contact: Contact = Contact.PUSHED) -> None:
        """
        Note that a push has moved the object, so that the robot is where it is estimated to be.

        :param contact: ``Contact``, but for those that have not moved it.
        """
        self._unexplained_moves = 0
        self._evidence.add(contact, self.localization.position_deviation)
        if self._evidence.fits:
            # Where its tracker took another object for this one, the robot is not known.
            is_known = self._displaced_at <= self._fitted_at
            self._fitted_at = self.time
            self._slip_search.restart(self.localization.pose if is_known else None)

    def on_push_unseen(self, before: Pose) -> None:
        """
        Note that a push has ended as planned before the object was seen to move.

        :param before: ``Pose`` of the object before it.
        """
        self._pose_before_push = before

    def judge_push(self) -> None:
        """Doubt the place of a robot whose pushes do not move the object, which is at rest."""
        before, self._pose_before_push = self._pose_before_push, None
        if before is None:
            return
        found = self.object_at_rest
        if (distance(found.pose, before) > PUSHED_SIGMAS * found.position_error
                or abs(wrap_angle(found.pose.theta - before.theta))
                > PUSHED_SIGMAS * found.heading_error):
            self._evidence.add(Contact.TAPPED, self.localization.position_deviation)
        else:
            self.on_push_in_vain()

    def on_push_in_vain(self) -> None:
        """Note that a push has not moved the object: after some, the robot is elsewhere."""
        self._evidence.add(Contact.IN_VAIN, self.localization.position_deviation)
        if self.is_lost and not self._find_robot(is_touching=False):
            self.localization.inflate_covariance(*VAIN_STD)

    def forget_contacts(self) -> None:
        """Begin another task: what contacts have shown may have been mended."""
        self._evidence.clear()

    def on_unexpected_contact(self) -> None:
        """Note that the robot has run into an object that should not be there."""
        self._evidence.add(Contact.UNEXPECTED, self.localization.position_deviation)
        if self.is_lost or self._unexplained_moves:
            self._find_robot(is_touching=True)

    def on_lost_robot_touched(self) -> bool:
        """Note that a robot that was lost moves the object; return whether it is found by that."""
        self._evidence.add(Contact.TAPPED, self.localization.position_deviation)
        return self._find_robot(is_touching=True)

    def on_object_moved(self, obj: PushedObject, robot: RoundRobot, before: Pose) -> None:
        """
        Note that the object has moved while it was not pushed.

        Further than the robot drives, somebody else has moved it, or its tracker. Else, the first
        time, it may have been somebody else. The second time it is the robot, which is not where
        it is estimated to be: it touches the object from behind, as that has moved.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param before: ``Pose`` that the object had.
        """
        if self.was_displaced:
            return
        self._unexplained_moves += 1
        pose, estimate = self.object_at_rest.pose, self.localization.pose
        moved = distance(pose, before)
        if self._unexplained_moves < UNEXPLAINED_MOVES or moved == 0.0:
            return
        if self._find_robot(is_touching=True):
            return
        x, y = (pose.x - before.x) / moved, (pose.y - before.y) / moved
        # Sphere tracing: from the inside out, against the motion, by the gap each time.
        offset = 0.0
        behind = pose.x, pose.y
        for _ in range(TRACE_STEPS):
            behind = pose.x - offset * x, pose.y - offset * y
            offset += abs(find_contact(obj, pose, behind, robot.radius).gap)
        self.localization.place_robot(Pose(*behind, estimate.theta), BEHIND_OBJECT_STD)

    def _find_robot(self, is_touching: bool) -> bool:
        """Place the robot where slip may have led it; return whether that explains all."""
        found = self._slip_search.find(self.object_pose.pose, is_touching)
        if found is None or self._supervision.odometry_reference != 'drifting':
            return False
        deviations = np.maximum(LEAST_FOUND_STD, found.std(axis=0)).tolist()
        self.localization.place_robot(Pose(*found.mean(axis=0).tolist()), deviations)
        return True

    def _measured_contact(self, obj: PushedObject, robot: RoundRobot) -> FoundContact:
        """Find the contact at the time of the last object pose."""
        measured = self.object_pose
        robot_pose = self.localization.pose_at(measured.time)
        return find_contact(obj, measured.pose, robot_pose[:2], robot.radius)


def _odometry_noise(supervision: SupervisionSettings) -> OdometryNoise:
    """Errors of odometry; one whose pose is absolute has a random walk alone."""
    if supervision.odometry_reference == 'absolute':
        return OdometryNoise(0.0, 0.0, supervision.odometry_walk,
                             supervision.odometry_heading_walk)
    return OdometryNoise(supervision.odometry_scale, supervision.odometry_drift,
                         supervision.odometry_walk, supervision.odometry_heading_walk)
