"""An object that is bumped: it gets out of the overlap, along and about the contact force."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import Pose
from push_planner.rearrangement.footprints import object_gap
from push_sim_node.bumped_object import displaced_pose, PlacedDisc, PlacedObject
import pytest

STANDING = Pose(0.3, -0.2, 0.5)
TURN = Pose(1.0, 2.0, 2.2)
KINDS = {'box': box(), 'bin': bin_()}
DEPTH = 0.004


def bump(first: str, second: str, bearing: float) -> tuple[PlacedObject, PlacedObject]:
    """Return an object that stands, and another that is in it by a depth, from a bearing."""
    item, obj = PlacedObject(KINDS[first], STANDING), KINDS[second]

    def at(distance: float) -> PlacedObject:
        return PlacedObject(obj, STANDING @ Pose(
            distance * math.cos(bearing), distance * math.sin(bearing), 0.3))
    low, high = 0.0, 2.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        is_out = object_gap(obj, at(middle).pose, item.obj, item.pose) > -DEPTH
        low, high = (low, middle) if is_out else (middle, high)
    return item, at(high)


@pytest.mark.parametrize('second', KINDS)
@pytest.mark.parametrize('first', KINDS)
def test_it_gets_out_of_the_overlap(first: str, second: str) -> None:
    """By no more than some depths, wherever it is bumped; the same in another frame."""
    for bearing in np.linspace(-3.0, 3.0, 13).tolist():
        item, body = bump(first, second, bearing)
        pose = displaced_pose(item, body)
        assert object_gap(item.obj, pose, body.obj, body.pose) > -0.1 * DEPTH
        assert 0.3 * DEPTH < math.dist(pose[:2], item.pose[:2]) < 2.0 * DEPTH
        turned = displaced_pose(item._replace(pose=TURN @ item.pose),
                                body._replace(pose=TURN @ body.pose))
        assert turned == pytest.approx(TURN @ pose, abs=1e-9)


def test_what_nothing_touches_stays() -> None:
    """To the last digit."""
    item = PlacedObject(KINDS['box'], STANDING)
    assert displaced_pose(item, PlacedDisc(0.73, -0.2, 0.17)) == STANDING


def test_both_corners_of_a_face_push() -> None:
    """A box flush with another is clear of it, and hardly rotated."""
    item = PlacedObject(KINDS['box'], Pose(0.0, 0.0, 0.0))
    body = PlacedObject(KINDS['box'], Pose(DEPTH - 0.4, 0.0, 0.0))
    pose = displaced_pose(item, body)
    assert object_gap(item.obj, pose, body.obj, body.pose) > -1e-5
    assert abs(pose.theta) < 0.5 * DEPTH / 0.4


def test_a_force_through_the_centre_of_friction_turns_nothing() -> None:
    """One beside it turns the object about the side on which it pushes."""
    item = PlacedObject(KINDS['box'], Pose(0.0, 0.0, 0.0))
    straight = displaced_pose(item, PlacedDisc(-0.3 + DEPTH, 0.0, 0.1))
    assert straight == pytest.approx((DEPTH, 0.0, 0.0), abs=1e-6)
    left = displaced_pose(item, PlacedDisc(-0.3 + DEPTH, 0.1, 0.1))
    right = displaced_pose(item, PlacedDisc(-0.3 + DEPTH, -0.1, 0.1))
    assert left.theta < -1e-3 and right.theta == pytest.approx(-left.theta)
    assert left.x < DEPTH


def test_rotation_and_motion_are_those_of_the_limit_surface() -> None:
    """Their ratio is the lever over c^2, with c the mean distance of equal supports."""
    lever, c_squared = 0.1, 2.0 * 0.2 ** 2
    item = PlacedObject(KINDS['box'], Pose(0.0, 0.0, 0.0))
    pose = displaced_pose(item, PlacedDisc(-0.3 + 1e-5, lever, 0.1))
    assert pose.theta / pose.x == pytest.approx(-lever / c_squared, rel=1e-3)
