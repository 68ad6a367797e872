"""Places of a robot whose wheels have slipped, by what it has not touched."""

import math

from helpers.objects import bin_, box
from helpers.push_problems import HOLONOMIC
import numpy as np
from push_control.perception.slip_search import (
    MAX_OVERLAP, MAX_PATH_POSES, MAX_TOUCH_GAP, PATH_DISTANCE, SlipSearch,
)
from push_model.contact import find_contact
from push_model.geometry import distance, FloatArray, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
import pytest

ORIGIN = Pose(0.0, 0.0, 0.0)
START = Pose(-1.5, 0.3, 0.4)
AHEAD = Pose(0.02, 0.0, 0.0)
TURN = Pose(0.0, 0.0, 0.09)
# Of the wheels: ahead, turn by 155 degrees, ahead.
STEPS = [*(20 * [AHEAD]), *(30 * [TURN]), *(30 * [AHEAD])]


def slipped(step: Pose, ratio: float) -> Pose:
    """Return the motion of a robot whose wheels slip."""
    return Pose(ratio * step.x, ratio * step.y, ratio * step.theta)


def touch(obj: PushedObject, robot: Pose, angle: float) -> Pose:
    """Place an object so that a robot touches it at an angle in its axes."""
    direction = robot.theta + angle
    place = robot @ Pose(3.0 * math.cos(angle), 3.0 * math.sin(angle), 0.7)
    for _ in range(60):
        gap = find_contact(obj, place, robot[:2], HOLONOMIC.radius).gap
        place = Pose(place.x - gap * math.cos(direction), place.y - gap * math.sin(direction),
                     place.theta)
    return place


def driven(object_pose: Pose, start: Pose = START, steps: list[Pose] = STEPS,
           obj: PushedObject | None = None) -> SlipSearch:
    """Drive past an object that stays where it is."""
    search = SlipSearch(obj or box(), HOLONOMIC)
    search.restart(start)
    for step in steps:
        search.drive(step, object_pose)
    return search


def found(search: SlipSearch, object_pose: Pose, is_touching: bool) -> FloatArray:
    """Find a robot that can be found."""
    poses = search.find(object_pose, is_touching)
    assert poses is not None
    return poses


@pytest.mark.parametrize('obj', [box(), bin_()])
@pytest.mark.parametrize('ratio', [0.5, 0.6, 0.7])
def test_a_robot_that_slipped_as_it_turned_is_found_at_the_touch(
        obj: PushedObject, ratio: float) -> None:
    """Odometry errs by 45 to 80 degrees, and what is found by a fraction of that."""
    true, measured = START, START
    for i, step in enumerate(STEPS):
        true = true @ slipped(step, ratio if 20 <= i < 50 else 1.0)
        measured = measured @ step
    object_pose = touch(obj, true, 0.0)
    poses = found(driven(object_pose, obj=obj), object_pose, is_touching=True)
    x, y, theta = poses.mean(axis=0).tolist()
    assert abs(wrap_angle(theta - true.theta)) < 0.4 * abs(wrap_angle(
        measured.theta - true.theta))
    assert distance((x, y), true) < 0.4 * distance(measured, true)


@pytest.mark.parametrize('is_touching', [False, True])
def test_places_found_neither_overlap_the_object_nor_miss_a_touch(
        is_touching: bool) -> None:
    end = START
    for step in STEPS:
        end = end @ step
    object_pose = touch(box(), end @ Pose(0.1, 0.0, 0.0), 0.0)
    poses = found(driven(object_pose), object_pose, is_touching)
    gaps = [find_contact(box(), object_pose, pose[:2], HOLONOMIC.radius).gap for pose in poses]
    assert min(gaps) > -MAX_OVERLAP
    assert not is_touching or max(gaps) < MAX_TOUCH_GAP


def test_odometry_that_leads_through_the_object_is_not_believed() -> None:
    """The robot has slipped before it came there; nobody believes that it came so far."""
    object_pose = START @ Pose(0.9, 0.0, 0.0)
    poses = found(driven(object_pose, steps=70 * [AHEAD]), object_pose, is_touching=False)
    assert max(distance(START, pose) for pose in poses) < 0.9


@pytest.mark.parametrize('world', [Pose(0.0, 0.0, 2.0), Pose(-3.0, 5.0, -1.0)])
def test_it_does_not_matter_where_the_world_has_its_axes(world: Pose) -> None:
    object_pose = START @ Pose(0.9, 0.1, 0.5)
    here = found(driven(object_pose), object_pose, is_touching=True)
    there = found(driven(world @ object_pose, world @ START), world @ object_pose,
                  is_touching=True)
    for before, after in zip(here, there, strict=True):
        expected = world @ Pose(*before.tolist())
        assert after[:2] == pytest.approx(expected[:2], abs=1e-9)
        assert wrap_angle(after[2] - expected.theta) == pytest.approx(0.0, abs=1e-9)


def test_a_long_path_is_remembered_from_its_beginning() -> None:
    """With fewer places, so that as much is computed."""
    away, back = Pose(0.02, 0.0, 0.0), Pose(-0.02, 0.0, 0.0)
    count = round(1.2 * MAX_PATH_POSES * PATH_DISTANCE / 0.02)
    object_pose = START @ Pose(-0.9, 0.0, 0.0)
    near = driven(object_pose, steps=[*(count * [away]), *(count * [back])])
    gaps = [find_contact(box(), object_pose, pose[:2], HOLONOMIC.radius).gap
            for pose in found(near, object_pose, is_touching=False)]
    assert min(gaps) > -MAX_OVERLAP


def test_where_slip_explains_nothing_no_place_is_found() -> None:
    """An object that stands where the robot began, or a robot that has not moved."""
    assert driven(START).find(START, is_touching=False) is None
    assert driven(ORIGIN, steps=[]).find(ORIGIN, is_touching=False) is None
    far = Pose(9.0, 0.0, 0.0)
    assert driven(far).find(far, is_touching=True) is None


def test_a_flat_pusher_is_not_searched_for() -> None:
    search = SlipSearch(box(), RoundRobot(radius=math.inf, drive='holonomic'))
    search.restart(START)
    for step in STEPS:
        search.drive(step, ORIGIN)
    assert search.find(ORIGIN, is_touching=False) is None


def test_before_it_is_begun_nothing_is_noted() -> None:
    search = SlipSearch(box(), HOLONOMIC)
    search.drive(AHEAD, ORIGIN)
    assert search.find(ORIGIN, is_touching=False) is None
    assert np.isfinite(found(driven(Pose(5.0, 0.0, 0.0)), Pose(5.0, 0.0, 0.0), False)).all()
