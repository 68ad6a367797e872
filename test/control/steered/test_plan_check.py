"""A plan is driven only where it does what was asked for, in every number that it states."""

import dataclasses
import math

from helpers.maps import walled_room
from helpers.objects import box
from helpers.push_problems import face_problem, HOLONOMIC
from helpers.straight_pushes import IDEAL, straight_push
import numpy as np
from push_control.steered.plan_check import (
    _check_map, check_plan, ExpectedPush, MAX_POSITIONS,
)
from push_model.geometry import BoolArray, FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import COLUMNS, PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_planner.steered.planner import plan_push
import pytest

BOX = box()
START = Pose(0.0, 0.0, 0.0)
# From a face of the box, straight ahead: 0.2 m of object, and the robot behind it.
BEHIND = Pose(-0.2 - IDEAL.radius, 0.0, 0.0)


@pytest.fixture(scope='module')
def ahead() -> PushTrajectory:
    """Plan a push of 1.5 m along x."""
    return plan_push(face_problem(Pose(1.5, 0.0, 0.0))).trajectory


def expected(occupancy_map: OccupancyMap | None = None, obj: PushedObject = BOX,
             robot: RoundRobot = HOLONOMIC) -> ExpectedPush:
    """Expect a push from anywhere to anywhere."""
    return ExpectedPush(obj, robot, (), None, occupancy_map)


def thinned(plan: PushTrajectory, samples: list[int]) -> PushTrajectory:
    """Keep some samples of a plan."""
    return dataclasses.replace(plan, **{name: getattr(plan, name)[samples]
                                        for name in ('times', *COLUMNS)})


@pytest.mark.parametrize('samples', [[0, -1], [0, 1, -2, -1]])
@pytest.mark.parametrize('wall', [(0.7, 0.75, -3.0, 3.0), (0.7, 0.75, 0.15, 0.2)])
def test_a_plan_does_not_jump_over_a_wall(ahead: PushTrajectory, samples: list[int],
                                          wall: tuple[float, float, float, float]) -> None:
    """Whatever samples it leaves out; the same plan on a free floor is driven."""
    for plan in (ahead, thinned(ahead, samples)):
        with pytest.raises(ValueError, match='leads the object into an obstacle of the map'):
            check_plan(plan, expected(walled_room(wall)))
        check_plan(plan, expected(walled_room()))


def test_a_corner_of_the_object_does_not_turn_through_a_wall() -> None:
    """The ends of a turn are free, and the middle of the object does not move."""
    turned = thinned(plan_push(face_problem(Pose(1.5, 0.0, 0.0))).trajectory, [0, -1])
    poses = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, math.pi / 2]])
    robots = np.array([[-0.37, 0.0, 0.0], [0.0, -0.37, math.pi / 2]])
    contacts = np.array([[-0.2, 0.0, 0.0], [0.0, -0.2, math.pi / 2]])
    turned = dataclasses.replace(turned, object_poses=poses, contact_poses=contacts,
                                 robot_poses=robots, **{
                                     name: np.zeros((2, 3)) for name in COLUMNS
                                     if name.endswith('twists')})
    post = walled_room((0.25, 0.3, -0.025, 0.025), resolution=0.025)
    with pytest.raises(ValueError, match='leads the object into an obstacle of the map'):
        check_plan(turned, expected(post))


def test_the_arc_that_a_robot_drives_is_compared_with_the_map() -> None:
    """Not its chord between two samples."""
    plan = straight_push(BOX, BEHIND, 0.6, curvature=1.5)
    cut = thinned(plan, [0, -1])
    x, y, _ = plan.robot_poses[len(plan.times) // 2]
    chord_x, chord_y, _ = 0.5 * (plan.robot_poses[0] + plan.robot_poses[-1])
    outward = np.array((x - chord_x, y - chord_y))
    # The chord passes it at twice the distance.
    post = np.array((x, y)) + (IDEAL.radius - 0.03) * outward / np.hypot(*outward)
    room = walled_room((post[0], post[0] + 0.01, post[1], post[1] + 0.01), resolution=0.01)
    with pytest.raises(ValueError, match='leads the robot into an obstacle of the map'):
        check_plan(cut, expected(room, robot=IDEAL))


def test_a_body_that_starts_in_an_obstacle_may_leave_it_once() -> None:
    """It may not enter another one between two samples."""
    plan = plan_push(face_problem(Pose(1.5, 0.0, 0.0))).trajectory
    beside = (-0.1, 0.0, 0.19, 0.25)
    check_plan(plan, expected(walled_room(beside)))
    for spoilt in (plan, thinned(plan, [0, -1])):
        with pytest.raises(ValueError, match='leads the object into an obstacle'):
            check_plan(spoilt, expected(walled_room(beside, (1.0, 1.05, -0.1, 0.1))))


def test_a_fine_map_takes_no_more_positions_than_time_allows(
        ahead: PushTrajectory, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plan is checked between two commands of a robot that moves."""
    counts = []
    collisions = OccupancyMap.robot_collisions

    def count(floor: OccupancyMap, robot: RoundRobot, poses: FloatArray,
              margin: float) -> BoolArray:
        counts.append(len(poses))
        return collisions(floor, robot, poses, margin)
    monkeypatch.setattr(OccupancyMap, 'robot_collisions', count)
    far = thinned(ahead, [0, -1])
    far = dataclasses.replace(far, times=1e4 * far.times, **{
        name: getattr(far, name) * (100.0, 1.0, 1.0)
        for name in ('object_poses', 'robot_poses', 'contact_poses')}, **{
        name: 1e-4 * getattr(far, name) for name in COLUMNS if name.endswith('twists')})
    _check_map(far, BOX, HOLONOMIC, OccupancyMap(0.005, Pose(-100.0, -1.0, 0.0),
                                                 np.zeros((400, 60_000), dtype=bool)))
    assert MAX_POSITIONS <= counts[0] <= MAX_POSITIONS + 2 * len(far.times)


@pytest.mark.parametrize('name, factor, text', [
    ('contact_poses', 1000.0, 'contact point off the object'),
    ('contact_twists', 50.0, 'contact point that is beyond the robot')])
def test_a_contact_point_that_neither_body_has_is_refused(ahead: PushTrajectory, name: str,
                                                          factor: float, text: str) -> None:
    """Length and speed of the push would be its own."""
    spoilt = dataclasses.replace(ahead, **{name: factor * getattr(ahead, name)})
    with pytest.raises(ValueError, match=text):
        check_plan(spoilt, expected())
