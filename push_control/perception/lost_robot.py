"""
Monitor of a robot that may not be where it is localized.

The robot feels nothing. That it is elsewhere shows in the object: pushes have no effect, contacts
come unexpected, the object moves although nobody pushes it. Or odometry says so itself. Perception
reports each of these as an event; the verdict on it is how to correct the estimate of the robot.
"""

import functools
import math
from typing import Protocol

import numpy as np
from push_control.events import PerceptionEvent
from push_control.perception.contact_consistency import ContactConsistency, Touch
from push_control.perception.displacement import Displacement, DisplacementWatch
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.lost_robot_events import (
    InflateRobot, LostRobotEvent, LostRobotTouched, ObjectMoved, ObjectPoseAccepted,
    ObjectPoseRejected, ObjectTapped, OdometryFault, PlaceRobot, PushSucceeded, PushWithoutEffect,
    RestoreRobot, RobotLocalized, RobotMoved, TapCompared, TaskStarted, UnexpectedContact, Verdict)
from push_control.perception.slip_search import SlipSearch
from push_model.contact import find_contact
from push_model.events import Report
from push_model.geometry import distance, Pose
from push_model.parameters import PushedObject, RoundRobot

# Moves of an object that nothing explains, of which the last one relocalizes the robot; chosen:
# the first one may have been somebody else.
UNEXPLAINED_MOVES = 2
# Standard deviations (x, y, heading) of a robot that is localized by such a move [m, m, rad];
# chosen: about a radius, and what a heading errs by that has led there.
BEHIND_OBJECT_STD = 0.15, 0.15, 0.4
# Steps of the search for the contact behind an object; chosen: each one leaves less than half of
# the distance, so that 12 leave below a millimetre.
TRACE_STEPS = 12
# Standard deviations that odometry which was wrong adds to the robot's position [m] and heading
# [rad]: by a jump, which is not added up, and otherwise; chosen: what it covers before that is
# noticed and until it stands.
JUMP_STD = 0.03, 0.03
FAULT_STD = 0.08, 0.05
# Pushes in a row without effect from which on the robot is elsewhere, and the standard deviations
# that each of them adds to its position [m] and heading [rad]; chosen: one may end too early.
MAX_PUSHES_WITHOUT_EFFECT = 2
WITHOUT_EFFECT_STD = 0.05, 0.1
# Least standard deviations (x, y, heading) of a robot whose slip is inferred [m, m, rad]; chosen:
# few hypotheses remain then.
MIN_SLIP_STD = 0.03, 0.03, 0.1
# Standard deviation of the robot's position at the touch up to which an object that a push has not
# moved is one that does not yield [m]; chosen: a robot that is known so well does not miss it by
# as much as a push is driven on.
KNOWN_STD = 0.04
# Time for which a displacement of the object explains that it is elsewhere [s]; chosen: a plan is
# made meanwhile.
DISPLACED_TIME = 2.0
# Standard deviations that the motion since then adds to a robot whose pose is restored from before
# a mistake of the tracker [m], [rad]; chosen: seconds of driving.
RESTORED_STD = 0.01, 0.01


class RobotEstimate(Protocol):
    """Estimate of the robot that the monitor reads, and does not change."""

    @property
    def pose(self) -> Pose:
        """Mean ``Pose`` of the robot."""
        ...

    @property
    def position_deviation(self) -> float:
        """Standard deviation of x or y, the greater one [m]."""
        ...


class LostRobotMonitor:
    """Evaluates by events whether the robot is where it is localized."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, estimate: RobotEstimate,
                 is_odometry_drifting: bool = True) -> None:
        """
        Start without any event.

        :param estimate: of the robot, read as an event is observed.
        :param is_odometry_drifting: whether odometry adds up what wheels measure, so that slip of
            the wheels displaces it.
        """
        self._object = obj
        self._robot = robot
        self._estimate = estimate
        self._is_odometry_drifting = is_odometry_drifting
        self._contacts = ContactConsistency()
        self._unexplained_moves = 0
        # Whether no contact has ever moved the object, and nothing said that the robot is
        # elsewhere; whether object poses have jumped in this task; and whether the last push was
        # without effect although the robot is well known.
        self._is_undisturbed = True
        self._have_poses_jumped = False
        self._is_surely_without_effect = False
        # The path since contacts last fitted, and when they did.
        self._slip_search = SlipSearch(obj, robot)
        self._fitted_at = -math.inf
        # Motions of the object that are not the robot's, the time of the last one, and what is
        # estimated of the robot before the next one.
        self._displacements = DisplacementWatch[RobotMemory | None]()
        self._displaced_at = -math.inf
        self._memory: RobotMemory | None = None

    @property
    def is_lost(self) -> bool:
        """Tell whether pushes without effect have shown that the robot is elsewhere."""
        return self._contacts.pushes_without_effect >= MAX_PUSHES_WITHOUT_EFFECT

    @property
    def is_refuted(self) -> bool:
        """Tell whether contacts have shown that robot and object are not where they seem to be."""
        return self._contacts.is_refuting

    @property
    def have_poses_jumped(self) -> bool:
        """Tell whether object poses have jumped in this task."""
        return self._have_poses_jumped

    @property
    def pose_jump(self) -> Report[PerceptionEvent] | None:
        """Jump of the object poses in this task that they did not take back, or None."""
        shift = self._displacements.shift
        if shift is None or not self._have_poses_jumped:
            return None
        return PerceptionEvent.POSES_JUMPED.report(
            distance=math.hypot(shift.x, shift.y), rotation=math.degrees(abs(shift.theta)))

    @property
    def is_object_unyielding(self) -> bool:
        """Tell whether a robot that seems to be where it should has pushed without effect."""
        return (self._is_undisturbed and not self._have_poses_jumped
                and self._is_surely_without_effect)

    def was_displaced(self, time: float) -> bool:
        """
        Check whether the object has lately moved further than the robot can have pushed it.

        :param time: now [s].
        """
        return time - self._displaced_at < DISPLACED_TIME

    @property
    def inconsistency(self) -> Report[PerceptionEvent] | None:
        """Inconsistency of object poses or robot with the contacts; None where all fits."""
        contacts, shift = self._contacts.inconsistency, self._displacements.shift
        if contacts is None:
            return None
        if shift is None:
            return PerceptionEvent.POSES_ELSEWHERE.report(contacts=contacts)
        return PerceptionEvent.POSES_JUMPED_ELSEWHERE.report(
            contacts=contacts, distance=math.hypot(shift.x, shift.y),
            rotation=math.degrees(abs(shift.theta)))

    def remember(self, memory: RobotMemory) -> None:
        """
        Keep an estimate of the robot, to which it returns if the next object pose is a mistake.

        :param memory: ``RobotMemory`` at an accepted object pose.
        """
        self._memory = memory

    @functools.singledispatchmethod
    def observe(self, event: LostRobotEvent) -> Verdict:
        """
        Evaluate an event.

        :param event: one of ``LostRobotEvent``.
        :return: how to correct the robot; None where its estimate stands.
        """
        raise TypeError(f'event: got {event!r}, expected one of LostRobotEvent')

    # The robot and its odometry.

    @observe.register
    def _on_task_started(self, _: TaskStarted) -> None:
        self._contacts.clear()
        self._have_poses_jumped = False

    @observe.register
    def _on_robot_localized(self, _: RobotLocalized) -> None:
        self._slip_search.restart(self._estimate.pose)

    @observe.register
    def _on_robot_moved(self, event: RobotMoved) -> None:
        self._displacements.drive(math.hypot(event.step.x, event.step.y))
        if event.object_pose is not None:
            self._slip_search.drive(event.step, event.object_pose)

    @observe.register
    def _on_odometry_fault(self, event: OdometryFault) -> Verdict:
        self._is_undisturbed = False
        stds = JUMP_STD if event.has_jumped else FAULT_STD
        # Once: however many messages are wrong, the robot stands soon.
        return InflateRobot(stds) if self._estimate.position_deviation < stds[0] else None

    # Object poses.

    @observe.register
    def _on_pose_rejected(self, _: ObjectPoseRejected) -> None:
        self._displacements.reject()

    @observe.register
    def _on_pose_accepted(self, event: ObjectPoseAccepted) -> Verdict:
        """Restore the robot once a mistake of the tracker is over."""
        displacement = self._displacements.update(event.measured, self._memory)
        if displacement is Displacement.NONE:
            return None
        self._have_poses_jumped = True
        self._displaced_at = event.measured.time
        memory = self._displacements.memory
        if displacement is Displacement.DISPLACED or memory is None:
            return None
        self._contacts.clear()
        return RestoreRobot(memory, RESTORED_STD)

    # Contacts.

    @observe.register
    def _on_push_succeeded(self, event: PushSucceeded) -> None:
        self._unexplained_moves = 0
        self._add_contact(event.contact)
        if self._contacts.fits:
            # Where its tracker took another object for this one, the robot is not known.
            is_known = self._displaced_at <= self._fitted_at
            self._fitted_at = event.time
            self._slip_search.restart(self._estimate.pose if is_known else None)

    @observe.register
    def _on_object_tapped(self, _: ObjectTapped) -> None:
        self._add_contact(Touch.TAPPED)

    @observe.register
    def _on_tap_compared(self, event: TapCompared) -> None:
        self._contacts.add_tap(event.motion)

    @observe.register
    def _on_push_without_effect(self, event: PushWithoutEffect) -> Verdict:
        self._add_contact(Touch.WITHOUT_EFFECT)
        self._is_surely_without_effect = event.deviation <= KNOWN_STD
        if not self.is_lost:
            return None
        return (self._infer_slip(event.object_pose, is_touching=False)
                or InflateRobot(WITHOUT_EFFECT_STD))

    @observe.register
    def _on_unexpected_contact(self, event: UnexpectedContact) -> Verdict:
        self._add_contact(Touch.UNEXPECTED)
        if self.is_lost or self._unexplained_moves:
            return self._infer_slip(event.object_pose, is_touching=True)
        return None

    @observe.register
    def _on_lost_robot_touched(self, event: LostRobotTouched) -> Verdict:
        self._add_contact(Touch.TAPPED)
        return self._infer_slip(event.object_pose, is_touching=True)

    @observe.register
    def _on_object_moved(self, event: ObjectMoved) -> Verdict:
        """
        Place the robot behind an object that has moved twice without a push.

        Further than the robot drives, somebody else has moved it, or its tracker. Else, the first
        time, it may have been somebody else. The second time it is the robot, which is not where
        it is estimated to be: it touches the object from behind, as that has moved.
        """
        if self.was_displaced(event.time):
            return None
        self._is_undisturbed = False
        self._unexplained_moves += 1
        has_moved = distance(event.before, event.after) > 0.0
        if self._unexplained_moves < UNEXPLAINED_MOVES or not has_moved:
            return None
        return (self._infer_slip(event.object_pose, is_touching=True)
                or PlaceRobot(self._pose_behind(event.before, event.after), BEHIND_OBJECT_STD))

    def _add_contact(self, contact: Touch) -> None:
        self._contacts.add(contact, self._estimate.position_deviation)
        self._is_undisturbed &= contact is Touch.WITHOUT_EFFECT
        self._is_surely_without_effect = False

    def _infer_slip(self, object_pose: Pose, is_touching: bool) -> PlaceRobot | None:
        """Place the robot where slip of its wheels explains all events; None if it does not."""
        if not self._is_odometry_drifting:
            return None
        poses = self._slip_search.find(object_pose, is_touching)
        if poses is None:
            return None
        x_std, y_std, heading_std = np.maximum(MIN_SLIP_STD, poses.std(axis=0)).tolist()
        return PlaceRobot(Pose(*poses.mean(axis=0).tolist()), (x_std, y_std, heading_std))

    def _pose_behind(self, before: Pose, after: Pose) -> Pose:
        """Return the pose of a robot that touches the object from behind, as that has moved."""
        moved = distance(after, before)
        x, y = (after.x - before.x) / moved, (after.y - before.y) / moved
        # Sphere tracing: from the inside out, against the motion, by the gap each time.
        offset = 0.0
        behind = after.x, after.y
        for _ in range(TRACE_STEPS):
            behind = after.x - offset * x, after.y - offset * y
            offset += abs(find_contact(self._object, after, behind, self._robot.radius).gap)
        return Pose(*behind, self._estimate.pose.theta)
