"""A robot that cannot see the object is blind; one that should and does not has a fault."""

import math

from helpers.kinematic_view import CONTROL, half_angle, KinematicView
from push_control.perception.perception import RETURN_TIME
from push_control.perception.view import UNSEEN_TIME
from push_model.events import PushEvent
from push_model.geometry import Pose
import pytest

NEAREST = 0.15
OBJECT = Pose(0.0, 0.0, 0.0)
IN_VIEW, BESIDE, NEAR = Pose(-0.8, 0.0, 0.0), Pose(-0.8, 0.0, 2.0), Pose(-0.38, 0.0, 0.0)
TIMEOUT = CONTROL.pose_timeout


def seen_and_moved(pose, **view):
    """See the object, then go elsewhere."""
    room = KinematicView(IN_VIEW, OBJECT, **{**half_angle(40.0), 'view_nearest': NEAREST, **view})
    room.stand(0.5)
    room.robot_pose = pose
    return room


def fault(room, needs_object=True):
    """Return the reason of a fault, or None."""
    report = room.perception.measurement_fault(needs_object)
    return None if report is None else report.code


@pytest.mark.parametrize('pose', [BESIDE, NEAR])
def test_an_object_out_of_view_is_no_fault(pose):
    """However long it is not seen."""
    room = seen_and_moved(pose)
    for _ in range(20):
        room.stand(0.5)
        assert fault(room) is None
    assert room.perception.is_blind and not room.perception.expects_pose


def test_where_all_sides_are_seen_an_old_pose_is_a_fault():
    """As it is without a view."""
    room = KinematicView(IN_VIEW, OBJECT)
    room.stand(0.5)
    room.object_pose = None
    room.stand(TIMEOUT + 0.1)
    assert fault(room) is PushEvent.OBJECT_POSE_STALE
    assert not room.perception.is_blind and not room.perception.has_limited_view


def test_an_object_that_is_gone_where_it_should_be_seen_is_a_fault():
    """As late as one without a view."""
    room = seen_and_moved(IN_VIEW)
    room.object_pose = None
    room.stand(TIMEOUT - 0.04)
    assert fault(room) is None
    room.stand(0.1)
    assert fault(room) is PushEvent.OBJECT_POSE_STALE and not room.perception.is_blind


def test_poses_have_time_to_come_back():
    """They are late, and the robot is not quite where it is estimated to be."""
    room = seen_and_moved(BESIDE)
    room.stand(2.0)
    room.robot_pose, room.object_pose = IN_VIEW, None
    room.stand(RETURN_TIME + TIMEOUT - 0.04)
    assert room.perception.expects_pose and fault(room) is None
    room.stand(0.1)
    assert fault(room) is PushEvent.OBJECT_POSE_STALE


def test_a_blind_robot_reads_where_the_object_is_expected():
    """The newest pose otherwise; a fault of odometry stays one."""
    room = seen_and_moved(BESIDE)
    assert room.perception.object_pose.time == room.perception.time
    room.stand(1.0)
    read = room.perception.object_pose
    assert read.time == room.perception.time
    assert read.pose == room.perception.localization.object_pose
    assert room.perception.expected_object_pose == read.pose


def test_what_was_never_seen_is_neither_expected_nor_blind():
    """A robot that looks for it drives; one that needs it does not."""
    room = KinematicView(IN_VIEW, None, **half_angle(40.0))
    room.stand(1.0)
    perception = room.perception
    assert not perception.is_blind and not perception.expects_pose
    assert fault(room) is PushEvent.NO_OBJECT_POSE and fault(room, needs_object=False) is None
    assert math.isinf(perception.pose_age) and not perception.has_fresh_pose
    assert not perception.sees_object_at_rest


def test_poses_that_come_show_the_object():
    """From the second one on, and for a while after the last one."""
    room = KinematicView(IN_VIEW, OBJECT, **half_angle(40.0))
    room.measure()
    assert room.perception.has_fresh_pose and not room.perception.sees_object_at_rest
    room.stand(0.2)
    assert room.perception.sees_object_at_rest
    room.object_pose = None
    room.stand(UNSEEN_TIME)
    assert not room.perception.sees_object_at_rest
