"""Approaches of a robot that sees the object only where it faces it."""

import math

from push_control.behaviors.approach import facing_path, FACING_SPACING
from push_control.perception.view import bearing
from push_model.geometry import Pose
from push_navigation.path import Path
import pytest

OBJECT = Pose(0.5, 0.6, 0.3)
# Straight on, then a quarter of a circle to the left.
WAY_ROUND = Path((Pose(0.0, 0.0, 0.4), Pose(1.0, 0.0, 0.4), Pose(1.5, 0.5, 0.4)),
                 (0.0, 0.5 * math.pi))


def test_a_holonomic_base_faces_the_object_on_the_same_way():
    """At every pose but the first, where it stands already."""
    path = facing_path(WAY_ROUND, OBJECT)
    assert path.poses[0] == WAY_ROUND.poses[0]
    assert path.poses[-1][:2] == pytest.approx(WAY_ROUND.poses[-1][:2])
    assert path.length == pytest.approx(WAY_ROUND.length)
    assert max(segment.length for segment in path.segments) < FACING_SPACING + 1e-9
    for pose in path.poses[1:]:
        assert bearing(pose, OBJECT) == pytest.approx(0.0, abs=1e-9)


def test_it_turns_the_short_way_from_one_pose_to_the_next():
    """Also where the direction of the object passes the seam of angles."""
    path = facing_path(WAY_ROUND, Pose(0.5, -0.3, 0.0))
    turns = [after.theta - before.theta for before, after in zip(path.poses[1:], path.poses[2:])]
    assert max(map(abs, turns)) < 0.5
