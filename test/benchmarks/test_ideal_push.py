"""Ideal pushes: what they can and cannot bring away from walls."""

from benchmarks.map_plans.ideal_push import Escape, find_escape
from benchmarks.map_plans.instances import bodies, Instance, nook
from benchmarks.tasks.nooks import Nook
from helpers.maps import walled_room
from push_model.geometry import Pose
import pytest


def instance(*blocks: tuple[float, float, float, float], name: str = 'box_04') -> Instance:
    """Make a task of an object in the middle of a room with blocks in it."""
    obj, robot = bodies(name, 'differential')
    return Instance(walled_room(*blocks), obj, robot, Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0),
                    Pose(1.5, 1.5, 0.0))


@pytest.mark.parametrize('name', ['box_04', 'bin'])
def test_on_open_floor_an_object_can_leave(name: str) -> None:
    """Whatever its shape."""
    assert find_escape(instance(name=name)) is Escape.POSSIBLE


def test_an_object_that_nobody_can_touch_cannot_leave() -> None:
    """Between walls that the robot does not fit between; with one of them open it can."""
    walls = [(-0.5, 0.5, 0.35, 0.45), (-0.5, 0.5, -0.45, -0.35), (-0.5, -0.4, -0.45, 0.45),
             (0.4, 0.5, -0.45, 0.45)]
    assert find_escape(instance(*walls)) is Escape.IMPOSSIBLE
    # Room for the robot behind it, and the way ahead is free.
    assert find_escape(instance(*walls[:2], (-1.6, -1.5, -3.0, 3.0))) is Escape.POSSIBLE


def test_a_box_in_a_niche_is_only_pushed_farther_in() -> None:
    """Where a planner finds nothing either."""
    assert find_escape(nook(Nook.FROM_NICHE, 'box_04', 'differential', 0)) is Escape.IMPOSSIBLE
