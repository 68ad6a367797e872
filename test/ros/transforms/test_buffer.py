"""Laws of the buffer of transforms."""

import numpy as np
from push_model.geometry import Pose
from push_model.rigid_transform import RigidTransform
from push_ros.transforms.buffer import (
    HISTORY, LookupFailure, TransformBuffer, TransformUnavailable,
)
import pytest

SECOND = 1_000_000_000


def planar(x=0.0, y=0.0, yaw=0.0):
    """Make a transform in the plane."""
    return RigidTransform.from_angles((x, y, 0.0), (0.0, 0.0, yaw))


@pytest.fixture
def robot():
    """Make the frames of a robot that drives along x at 1 m/s, with a camera on it."""
    buffer = TransformBuffer()
    for time in range(5):
        buffer.set('map', 'odom', time * SECOND, planar(10.0, 0.1 * time))
        buffer.set('odom', 'base_link', time * SECOND, planar(float(time)))
    buffer.set('base_link', 'camera', 0, planar(0.2, 0.0, 0.5), is_static=True)
    return buffer


def failure_of(buffer, *arguments):
    """Look up what is not there."""
    with pytest.raises(TransformUnavailable) as raised:
        buffer.lookup(*arguments)
    return raised.value.failure


def test_frames_compose_along_the_tree_at_one_time(robot):
    """Each transform is taken at the time that is asked for."""
    found = robot.lookup('map', 'camera', 2_500_000_000).planar
    np.testing.assert_allclose(found, (10.0 + 2.5 + 0.2, 0.25, 0.5))


def test_a_lookup_and_its_inverse_are_inverse(robot):
    """From source to target and back is the identity."""
    there = robot.lookup('odom', 'camera', SECOND)
    back = robot.lookup('camera', 'odom', SECOND)
    np.testing.assert_allclose((there @ back).planar, (0.0, 0.0, 0.0), atol=1e-12)


def test_the_newest_is_that_of_the_last_common_time(robot):
    """A frame whose transforms have stopped holds the others back."""
    robot.set('odom', 'base_link', 6 * SECOND, planar(6.0))
    assert robot.lookup('map', 'base_link').planar == pytest.approx((14.0, 0.4, 0.0))
    assert robot.lookup('odom', 'base_link').x == pytest.approx(6.0)


def test_a_frame_in_itself_needs_no_transform():
    """Its transform is the identity, at any time and with a leading slash or without."""
    assert TransformBuffer().lookup('odom', '/odom', 7) == RigidTransform()


def test_nothing_is_extrapolated(robot):
    """Before the first and after the last stamp there is no transform, and the error says so."""
    assert failure_of(robot, 'odom', 'camera', 5 * SECOND) is LookupFailure.TOO_LATE
    robot.set('odom', 'base_link', HISTORY + 4 * SECOND, planar(4.0))
    assert failure_of(robot, 'odom', 'camera', SECOND) is LookupFailure.TOO_EARLY
    with pytest.raises(TransformUnavailable, match=r'odom -> base_link are of 4.000 to 14.000 s'):
        robot.lookup('odom', 'camera', SECOND)


def test_what_is_missing_is_named(robot):
    """An unknown frame, and one in another tree, with all that is known."""
    robot.set('world', 'tag', 0, planar(), is_static=True)
    assert failure_of(robot, 'odom', 'tags', 0) is LookupFailure.UNKNOWN_FRAME
    assert failure_of(robot, 'odom', 'tag', 0) is LookupFailure.NOT_CONNECTED
    with pytest.raises(TransformUnavailable, match=r"'tag' and 'odom' .*known: base_link"):
        robot.lookup('odom', 'tag', 0)


def test_late_transforms_are_put_in_their_place(robot):
    """The order in which they come makes no difference."""
    robot.set('odom', 'base_link', 3_500_000_000, planar(3.0))
    assert robot.lookup('odom', 'base_link', 3_250_000_000).x == pytest.approx(3.0)


def test_time_that_goes_back_starts_over(robot):
    """What was of a later time is no longer known; static transforms stay."""
    robot.set('odom', 'base_link', 0, planar(-1.0))
    assert failure_of(robot, 'odom', 'base_link', SECOND) is LookupFailure.TOO_LATE
    assert robot.lookup('odom', 'camera').x == pytest.approx(-0.8)
    robot.clear()
    assert failure_of(robot, 'odom', 'camera') is LookupFailure.UNKNOWN_FRAME
    assert robot.lookup('base_link', 'camera').planar == pytest.approx(Pose(0.2, 0.0, 0.5))


def test_a_frame_may_get_another_parent(robot):
    """Only the newest parent counts."""
    robot.set('base_link', 'box', SECOND, planar(0.4))
    robot.set('odom', 'box', 2 * SECOND, planar(7.0))
    assert robot.lookup('odom', 'box').x == pytest.approx(7.0)
    assert not robot.is_below('box', 'base_link') and robot.is_below('box', 'odom')


def test_frames_in_a_loop_end_in_an_error():
    """Two frames that are each other's parent have no way to a third one."""
    buffer = TransformBuffer()
    buffer.set('a', 'b', 0, planar())
    buffer.set('b', 'a', 0, planar())
    buffer.set('odom', 'base_link', 0, planar())
    assert failure_of(buffer, 'odom', 'a', 0) is LookupFailure.NOT_CONNECTED


@pytest.mark.parametrize('parent, child', [('', 'a'), ('a', ''), ('a', '/a')])
def test_frames_without_a_name_are_refused(parent, child):
    """Nor may a frame be its own parent."""
    with pytest.raises(ValueError, match='expected two different names'):
        TransformBuffer().set(parent, child, 0, planar())


def test_only_static_transforms_make_two_frames_rigid(robot):
    """Whichever of the two is above; not where one link moves, nor where one is unknown."""
    robot.set('camera', 'lens', 0, planar(0.0, 0.1), is_static=True)
    robot.set('camera', 'tag', 2 * SECOND, planar(1.0))
    expected = planar(0.2, 0.0, 0.5) @ planar(0.0, 0.1)
    np.testing.assert_allclose(robot.rigid('base_link', '/lens').planar, expected.planar)
    np.testing.assert_allclose((robot.rigid('lens', 'base_link') @ expected).planar,
                               (0.0, 0.0, 0.0), atol=1e-12)
    assert robot.rigid('odom', '/odom') == RigidTransform()
    for frames in (('odom', 'camera'), ('base_link', 'tag'), ('base_link', 'nowhere')):
        assert robot.rigid(*frames) is None
