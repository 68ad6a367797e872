"""Events that show where a robot is, and the verdict on each."""

import dataclasses
import math

from helpers.objects import box
from helpers.push_problems import HOLONOMIC
import numpy as np
from push_control.events import PerceptionEvent
from push_control.perception.contact_consistency import MAX_CONTRADICTIONS, Touch
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_control.perception.lost_robot import (
    BEHIND_OBJECT_STD, DISPLACED_TIME, FAULT_STD, JUMP_STD, KNOWN_STD, LostRobotMonitor,
    MAX_PUSHES_WITHOUT_EFFECT, RESTORED_STD, WITHOUT_EFFECT_STD,
)
from push_control.perception.lost_robot_events import (
    InflateRobot, LostRobotTouched, ObjectMoved, ObjectPoseAccepted, ObjectPoseRejected,
    ObjectTapped, OdometryFault, PlaceRobot, PushSucceeded, PushWithoutEffect, RestoreRobot,
    RobotLocalized, RobotMoved, TaskStarted, UnexpectedContact,
)
from push_model.contact import find_contact
from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose
import pytest

HOME = Pose(0.0, 0.0, 0.0)
CERTAIN, UNCERTAIN = 0.01, 0.1
EFFECTLESS = PushWithoutEffect(HOME, CERTAIN)


@dataclasses.dataclass
class Estimate:
    """An estimate of the robot that a test sets."""

    pose: Pose = Pose(-1.0, 0.5, 0.7)
    position_deviation: float = CERTAIN


def monitor(estimate: Estimate | None = None, is_odometry_drifting: bool = True,
            ) -> LostRobotMonitor:
    """Return the monitor of a robot beside a box."""
    return LostRobotMonitor(box(), HOLONOMIC, estimate or Estimate(), is_odometry_drifting)


def memory(number: float) -> RobotMemory:
    """Return a memory that is told from others."""
    return RobotMemory(Pose(number, 0.0, 0.0), np.zeros((1, 3)), np.zeros((1, 3)))


def moved(x: float, time: float = 100.0) -> ObjectMoved:
    """Return a move of the object along x."""
    after = Pose(x, 0.0, 0.0)
    return ObjectMoved(HOME, after, after, time)


def slipped(lost: LostRobotMonitor) -> Pose:
    """Drive to an object while the wheels slip from some place on; return the object's pose."""
    lost.observe(RobotLocalized())
    object_pose = Pose(0.0, 1.0, 0.0)
    for _ in range(50):
        lost.observe(RobotMoved(Pose(0.0, 0.0, 0.05), object_pose))
    for _ in range(40):
        lost.observe(RobotMoved(Pose(0.02, 0.0, 0.0), object_pose))
    return object_pose


def test_pushes_without_effect_in_a_row_make_the_robot_lost() -> None:
    """Each further one makes it less certain; the first may have ended too early."""
    lost = monitor()
    for count in range(1, 4):
        verdict = lost.observe(EFFECTLESS)
        is_lost = count >= MAX_PUSHES_WITHOUT_EFFECT
        assert lost.is_lost == is_lost
        assert verdict == (InflateRobot(WITHOUT_EFFECT_STD) if is_lost else None)


@pytest.mark.parametrize('event', [
    PushSucceeded(Touch.PUSHED, 1.0), PushSucceeded(Touch.TAPPED, 1.0), ObjectTapped(),
    LostRobotTouched(HOME), TaskStarted()])
def test_an_object_that_moves_ends_the_count_of_pushes_without_effect(
        event: PushSucceeded | ObjectTapped | LostRobotTouched | TaskStarted) -> None:
    lost = monitor()
    lost.observe(EFFECTLESS)
    lost.observe(EFFECTLESS)
    assert lost.is_lost and lost.inconsistency is not None
    assert lost.observe(event) is None
    assert not lost.is_lost and lost.inconsistency is None


@pytest.mark.parametrize('deviation, is_known', [(KNOWN_STD - 1e-6, True), (UNCERTAIN, False)])
def test_an_object_does_not_yield_where_a_well_known_robot_pushes_without_effect(
        deviation: float, is_known: bool) -> None:
    """One that was not so well known at the touch may have missed it."""
    lost = monitor(Estimate(position_deviation=UNCERTAIN))
    assert not lost.is_object_unyielding
    lost.observe(PushWithoutEffect(HOME, deviation))
    assert lost.is_object_unyielding == is_known


@pytest.mark.parametrize('event', [
    PushSucceeded(Touch.PUSHED, 1.0), ObjectTapped(), UnexpectedContact(HOME), moved(0.05),
    LostRobotTouched(HOME), OdometryFault(True)])
def test_what_once_moved_or_may_have_been_missed_is_not_unyielding(event) -> None:
    """Nor in the next task: the object is another one, blocked, or elsewhere."""
    lost = monitor()
    lost.observe(event)
    lost.observe(TaskStarted())
    lost.observe(EFFECTLESS)
    assert not lost.is_object_unyielding


def test_object_poses_that_jump_make_no_object_unyielding() -> None:
    """They are of another one from then on; the next task rests on those that it starts with."""
    lost = monitor()
    lost.observe(ObjectPoseAccepted(ObjectPose(0.0, HOME)))
    lost.observe(ObjectPoseAccepted(ObjectPose(0.1, Pose(0.6, 0.0, 0.0))))
    lost.observe(EFFECTLESS)
    assert not lost.is_object_unyielding
    lost.observe(TaskStarted())
    lost.observe(EFFECTLESS)
    assert lost.is_object_unyielding


def test_contacts_that_never_fit_refute_the_estimate() -> None:
    """No pose of the robot explains them; a push that fits takes that back."""
    lost = monitor()
    for _ in range(MAX_CONTRADICTIONS):
        assert not lost.is_refuted
        lost.observe(PushSucceeded(Touch.LATERAL, 1.0))
    assert lost.is_refuted
    assert lost.inconsistency.codes == (
        PerceptionEvent.POSES_ELSEWHERE, PerceptionEvent.CONTACTS_DO_NOT_FIT)
    lost.observe(PushSucceeded(Touch.PUSHED, 2.0))
    assert not lost.is_refuted and lost.inconsistency is None


@pytest.mark.parametrize('angle', [0.0, 1.1, -2.5])
def test_an_object_that_moves_twice_without_a_push_has_the_robot_behind_it(angle: float) -> None:
    """It touches, on the side that the object came from, and keeps its heading."""
    estimate = Estimate()
    lost = monitor(estimate)
    after = Pose(0.06 * math.cos(angle), 0.06 * math.sin(angle), 0.2)
    event = ObjectMoved(HOME, after, after, 100.0)
    assert lost.observe(event) is None
    lost.observe(PushSucceeded(Touch.PUSHED, 50.0))
    assert lost.observe(event) is None
    verdict = lost.observe(event)
    assert isinstance(verdict, PlaceRobot) and verdict.stds == BEHIND_OBJECT_STD
    assert abs(find_contact(box(), after, verdict.pose[:2], HOLONOMIC.radius).gap) < 1e-3
    bearing = math.atan2(verdict.pose.y - after.y, verdict.pose.x - after.x)
    assert wrap_angle(bearing - angle - math.pi) == pytest.approx(0.0, abs=1e-6)
    assert verdict.pose.theta == estimate.pose.theta


def test_an_object_that_turns_on_the_spot_tells_no_direction() -> None:
    lost = monitor()
    turned = Pose(0.0, 0.0, 0.5)
    for _ in range(3):
        assert lost.observe(ObjectMoved(HOME, turned, turned, 100.0)) is None


def test_an_object_that_somebody_carried_away_says_nothing_of_the_robot() -> None:
    """For a while: after that it is on the floor again."""
    lost = monitor()
    lost.observe(ObjectPoseAccepted(ObjectPose(0.0, HOME)))
    lost.observe(ObjectPoseAccepted(ObjectPose(0.1, Pose(2.0, 0.0, 0.0))))
    assert lost.was_displaced(0.1 + 0.9 * DISPLACED_TIME)
    for _ in range(3):
        assert lost.observe(moved(2.0, time=0.2)) is None
    late = 0.2 + DISPLACED_TIME
    assert not lost.was_displaced(late)
    assert lost.observe(moved(2.06, time=late)) is None
    assert isinstance(lost.observe(moved(2.06, time=late)), PlaceRobot)


@pytest.mark.parametrize('driven, restores', [(0.0, True), (3.0, False)])
def test_a_mistake_of_the_tracker_is_undone_once_it_is_over(
        driven: float, restores: bool) -> None:
    """The estimate is that of before, unless the robot may have pushed the object as far."""
    lost = monitor()
    for k, x in enumerate((0.0, 0.0, 1.0, 1.0)):
        assert lost.observe(ObjectPoseAccepted(ObjectPose(0.1 * k, Pose(x, 0.0, 0.0)))) is None
        lost.remember(memory(k))
        lost.observe(RobotMoved(Pose(driven, 0.0, 0.0), None))
    lost.observe(EFFECTLESS)
    verdict = lost.observe(ObjectPoseAccepted(ObjectPose(0.4, HOME)))
    assert isinstance(verdict, RestoreRobot) == restores
    if isinstance(verdict, RestoreRobot):
        assert verdict.memory.odometry_pose == memory(1).odometry_pose
        assert verdict.stds == RESTORED_STD
    # What contacts seemed to show meanwhile was a mistake too.
    assert (lost.inconsistency is None) == restores


def test_a_jump_of_the_poses_is_named_until_they_take_it_back_or_another_task_starts() -> None:
    """By its distance and its rotation."""
    for ending in (ObjectPoseAccepted(ObjectPose(0.2, HOME)), TaskStarted()):
        lost = monitor()
        lost.observe(ObjectPoseAccepted(ObjectPose(0.0, HOME)))
        assert lost.pose_jump is None
        lost.observe(ObjectPoseAccepted(ObjectPose(0.1, Pose(0.3, -0.4, 1.0))))
        jump = lost.pose_jump
        assert jump is not None and jump.code is PerceptionEvent.POSES_JUMPED
        assert jump.values['distance'] == pytest.approx(0.5)
        assert jump.values['rotation'] == pytest.approx(math.degrees(1.0))
        lost.observe(ending)
        assert lost.pose_jump is None


def test_what_is_driven_after_an_outlier_explains_no_displacement() -> None:
    """The object was elsewhere by then."""
    explained, rejected = monitor(), monitor()
    for lost in (explained, rejected):
        lost.observe(ObjectPoseAccepted(ObjectPose(0.0, HOME)))
        if lost is rejected:
            lost.observe(ObjectPoseRejected())
        lost.observe(RobotMoved(Pose(0.5, 0.0, 0.0), None))
        lost.observe(ObjectPoseAccepted(ObjectPose(0.1, Pose(0.4, 0.0, 0.0))))
    assert rejected.was_displaced(0.1) and not explained.was_displaced(0.1)


@pytest.mark.parametrize('has_jumped, stds', [(True, JUMP_STD), (False, FAULT_STD)])
def test_odometry_that_is_wrong_makes_a_certain_robot_uncertain_once(
        has_jumped: bool, stds: tuple[float, float]) -> None:
    """However many messages are wrong."""
    estimate = Estimate()
    lost = monitor(estimate)
    assert lost.observe(OdometryFault(has_jumped)) == InflateRobot(stds)
    estimate.position_deviation = UNCERTAIN
    assert lost.observe(OdometryFault(has_jumped)) is None


@pytest.mark.parametrize('is_drifting', [True, False])
def test_a_lost_robot_that_touches_the_object_is_where_slip_has_led_it(is_drifting: bool) -> None:
    """Odometry that measures the world does not slip."""
    object_pose = Pose(0.0, 1.0, 0.0)
    lost = monitor(Estimate(HOME), is_drifting)
    assert slipped(lost) == object_pose
    assert lost.observe(UnexpectedContact(object_pose)) is None
    lost.observe(EFFECTLESS)
    lost.observe(EFFECTLESS)
    verdict = lost.observe(LostRobotTouched(object_pose))
    assert isinstance(verdict, PlaceRobot) == is_drifting
    if isinstance(verdict, PlaceRobot):
        gap = find_contact(box(), object_pose, verdict.pose[:2], HOLONOMIC.radius).gap
        assert abs(gap) < 0.1


def test_an_unexpected_contact_relocalizes_only_a_robot_that_something_else_contradicts() -> None:
    """One that runs into an object once may have met one that was moved there."""
    lost = monitor(Estimate(HOME))
    object_pose = slipped(lost)
    assert lost.observe(UnexpectedContact(object_pose)) is None
    assert lost.observe(moved(0.06)) is None
    assert isinstance(lost.observe(UnexpectedContact(object_pose)), PlaceRobot)


def test_something_else_than_an_event_is_refused() -> None:
    with pytest.raises(TypeError, match='expected one of LostRobotEvent'):
        monitor().observe('lost')  # pyright: ignore[reportArgumentType]
