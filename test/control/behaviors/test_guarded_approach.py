"""Guarded approach: how it ends, where there is no contact or not at the right place."""

import functools
import math

from helpers.objects import box
from push_control.behaviors.behavior import BehaviorContext
from push_control.behaviors.failures import BehaviorFailure
from push_control.behaviors.guarded_approach import GuardedApproach
from push_control.perception.perception import TaskPerception
from push_control.settings import ControlSettings
from push_control.steered.start import robot_start_pose
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.events import PushEvent
from push_model.geometry import distance, Pose
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose, Odometry, STOP
from push_navigation.settings import DriveSettings
from push_planner.steered.site_selection import choose_site
import pytest

# Plans and simulated pushes take some seconds each.
pytestmark = pytest.mark.slow

CONTROL, SUPERVISION, DRIVE = ControlSettings(), SupervisionSettings(), DriveSettings()
ORIGIN, STEP = Pose(0.0, 0.0, 0.0), 0.05
ROBOTS = {drive: RoundRobot(radius=0.17, drive=drive) for drive in ('differential', 'holonomic')}


@functools.lru_cache(maxsize=None)
def target(drive):
    """Plan the push that the robot approaches, once."""
    return choose_site(box(), ROBOTS[drive], ORIGIN, Pose(1.5, 0.2, 0.1)).plan.trajectory


def approach_box(drive, aside=0.0, moves=True, there=True, steps=4000):
    """
    Touch a box at the origin, which gives way; return behaviour, true robot, its start and time.

    :param aside: how far the robot stands beside its place, as it knows.
    :param moves: whether its wheels turn.
    :param there: whether there is anything where the box is seen.
    """
    robot, obj = ROBOTS[drive], box()
    context = BehaviorContext(obj, robot, CONTROL, DRIVE, SUPERVISION)
    start = robot_start_pose(target(drive), ORIGIN)
    back = start.transform((-DRIVE.standoff, aside)) if drive == 'differential' else (
        Pose(*start[:2], target(drive).contact_poses[0][2]).transform((-DRIVE.standoff, aside)))
    begin = true = Pose(*back, start.theta)
    pose, behavior, command = ORIGIN, None, STOP
    perception = TaskPerception(obj, robot, CONTROL, SUPERVISION)
    for k in range(steps):
        time = k * STEP
        if moves:
            true = Pose(*true.transform((STEP * command.v_x, STEP * command.v_y)), true.theta)
        _, normal, gap = find_contact(obj, pose, true[:2], robot.radius)
        if there and gap < 0.0:
            pose = Pose(pose.x - gap * math.cos(normal), pose.y - gap * math.sin(normal), 0.0)
        perception.update(Observation(time, Odometry(time, true, command), ObjectPose(time, pose)))
        behavior = behavior or GuardedApproach(context, target(drive), perception.object_at_rest)
        command = behavior.step(perception, STEP)
        if behavior.finished or behavior.failure:
            break
    return behavior, true, begin, time


@pytest.mark.parametrize('drive', ROBOTS)
def test_it_ends_where_the_object_is_displaced(drive):
    """The robot stands where the plan starts."""
    behavior, true, _, _ = approach_box(drive)
    assert behavior.finished and behavior.failure is None
    assert distance(true, robot_start_pose(target(drive), ORIGIN)) < 0.02


@pytest.mark.parametrize('drive', ROBOTS)
@pytest.mark.parametrize('aside', [0.0, 2.0])
def test_a_missing_object_is_noticed_soon(drive, aside):
    """
    Without a contact, the robot goes little further than the probe distance.

    Where it seems to drive through the object the ensemble blames odometry, so that it is the time
    that is limited: the stall time-out, at the speed of the contact, comes on top.
    """
    behavior, true, begin, _ = approach_box(drive, aside, there=False)
    assert not behavior.finished
    assert behavior.failure.code is BehaviorFailure.NO_CONTACT
    gap = find_contact(box(), ORIGIN, begin[:2], 0.17)[2]
    length = max(0.0, gap) + SUPERVISION.probe_distance + 0.02
    stalled = length + CONTROL.start_speed * SUPERVISION.stall_timeout + max(0.0, gap)
    assert distance(true, begin) < (length if aside else stalled)


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_stalled_robot_is_noticed(drive):
    """Its wheels stand: the time is limited."""
    behavior, _, _, time = approach_box(drive, moves=False)
    assert behavior.failure.code is BehaviorFailure.NO_CONTACT and time < 15.0


@pytest.mark.parametrize('drive', ROBOTS)
def test_a_push_is_not_begun_beside_its_place(drive):
    """Farther aside than the controller tolerates, the behaviour fails by itself."""
    behavior, _, _, _ = approach_box(drive, 1.5 * CONTROL.start_tolerance)
    assert not behavior.finished
    assert behavior.failure.code is PushEvent.ROBOT_NOT_AT_START
