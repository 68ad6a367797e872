"""The guard of a push ends it in time, and lets go on what comes no nearer."""

from helpers.maps import walled_room
from helpers.objects import box
from helpers.straight_pushes import IDEAL, straight_push
import numpy as np
from push_control.behaviors.obstacle_guard import (
    blocks_push, guarded_members, ObstacleGuard, REACTION_TIME)
from push_model.geometry import Pose
import pytest

BOX, SPEED, PERIOD = box(), 0.3, 0.05
# The map ends there on the right.
WALL = 3.0


def guard(end):
    """Return the guard of a push of the box along x, up to a pose."""
    start = Pose(-0.2 - IDEAL.radius, 0.0, 0.0)
    target = straight_push(BOX, start, 0.3, object_pose=Pose(end - 0.3, 0.0, 0.0))
    return ObstacleGuard(walled_room(), BOX, IDEAL, target)


def stopping_place(found, heading=1.0):
    """Move box and robot along x, and return where the guard stops the box; None for nowhere."""
    x = WALL - 0.5 if heading > 0.0 else WALL - 0.21
    for _ in range(40):
        if found.is_close([Pose(x, 0.0, 0.0)], [Pose(x - 0.4, 0.0, 0.0)], PERIOD):
            return x
        x += heading * SPEED * PERIOD
    return None


@pytest.mark.parametrize('end, kept', [(2.2, 0.01), (WALL - 0.2 - 0.02, 0.0)])
def test_a_push_ends_before_the_wall(end, kept):
    """With what it moves on until it stands; a plan that comes nearer may go on a little."""
    place = stopping_place(guard(end))
    clearance = WALL - 0.2 - (place + SPEED * REACTION_TIME)
    # Between two looks it moves on, and maps are coarse.
    assert kept - 2.5 * SPEED * PERIOD < clearance < kept + 0.03


def test_an_object_that_may_be_elsewhere_keeps_clear_wherever_it_may_be() -> None:
    """The nearest of its places ends the push; it ends as one that is known to be there."""
    known, uncertain = guard(2.2), guard(2.2)
    offset = 0.06
    for step in range(40):
        x = WALL - 0.5 + step * SPEED * PERIOD
        places = [Pose(x - offset, 0.0, 0.0), Pose(x, 0.0, 0.0)]
        robots = [Pose(place.x - 0.4, 0.0, 0.0) for place in places]
        is_close = known.is_close(places[1:], robots[1:], PERIOD)
        assert uncertain.is_close(places, robots, PERIOD) == is_close
        if is_close:
            return
    raise AssertionError('nothing has ended the push')


def test_members_that_keep_clear_reach_as_far_as_most_do() -> None:
    """The outermost one is 1.6 standard deviations off, in the mean of many ensembles."""
    offsets = np.random.default_rng(1).standard_normal((2000, 200))
    chosen = guarded_members(200)
    assert len(set(chosen.tolist())) == len(chosen) and 0 <= chosen.min() <= chosen.max() < 200
    assert offsets[:, chosen].max(axis=1).mean() == pytest.approx(1.6, abs=0.1)


def test_losing_sight_is_no_motion() -> None:
    """A place nearer to the wall that an object may have is not one that it has moved to."""
    watching, x = guard(2.2), 2.4
    for _ in range(6):
        assert not watching.is_close([Pose(x, 0.0, 0.0)], [Pose(x - 0.4, 0.0, 0.0)], PERIOD)
    places = [Pose(x, 0.0, 0.0), Pose(x + 0.15, 0.0, 0.0)]
    robots = [Pose(place.x - 0.4, 0.0, 0.0) for place in places]
    for _ in range(6):
        assert not watching.is_close(places, robots, PERIOD)


def test_what_moves_off_the_wall_goes_on():
    """However near it is at first."""
    assert stopping_place(guard(2.2), heading=-1.0) is None


def test_a_new_map_blocks_what_is_left_of_a_push() -> None:
    """And not what is behind it or beside it, nor what the former map has as well."""
    start = Pose(-0.2 - IDEAL.radius, 0.0, 0.0)
    target = straight_push(BOX, start, 0.5)
    ahead, beside = walled_room((0.4, 0.5, -0.1, 0.1)), walled_room((0.4, 0.5, 0.3, 0.5))
    end = Pose(*target.robot_poses[-1])
    assert blocks_push(target, BOX, IDEAL, None, ahead, start)
    assert not blocks_push(target, BOX, IDEAL, None, beside, start)
    assert not blocks_push(target, BOX, IDEAL, ahead, ahead, start)
    assert not blocks_push(target, BOX, IDEAL, ahead, None, start)
    behind = walled_room((-0.5, -0.35, -0.1, 0.1))
    assert blocks_push(target, BOX, IDEAL, None, behind, start)
    assert not blocks_push(target, BOX, IDEAL, None, behind, end)
