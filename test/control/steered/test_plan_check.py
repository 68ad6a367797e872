"""A plan is driven only where it does what was asked for, in every number that it states."""

import dataclasses
import math
import re

from helpers.maps import walled_room
from helpers.objects import box
from helpers.push_problems import (
    DIFFERENTIAL, face_problem, HOLONOMIC, round_problem, vertex_problem,
)
from helpers.straight_pushes import IDEAL, straight_push
import numpy as np
from push_control.steered.plan_check import (
    check_length, check_map, check_plan, ExpectedEnds, ExpectedPush, MAX_POSITIONS, PoseRegion,
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
    return ExpectedPush(obj, robot, ExpectedEnds(), occupancy_map)


def changed(plan: PushTrajectory, name: str, sample: int, offset: tuple[float, float, float],
            ratio: float = 1.0) -> PushTrajectory:
    """Change one sample of an array, as to ``ratio * value + offset``."""
    values = getattr(plan, name).copy()
    values[sample] = ratio * values[sample] + offset
    return dataclasses.replace(plan, **{name: values})


def moved_goal(plan: PushTrajectory, distance: float, is_last: bool) -> ExpectedPush:
    """Expect a plan to a goal beyond the end of a plan, along its x axis."""
    x, y, theta = plan.object_poses[-1].tolist()
    return ExpectedPush(BOX, HOLONOMIC, ExpectedEnds(
        (), PoseRegion(Pose(x + distance, y, theta), 0.01, 0.02), is_last), None)


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
            check_map(plan, BOX, HOLONOMIC, walled_room(wall))
        check_map(plan, BOX, HOLONOMIC, walled_room())
    check_plan(ahead, expected(walled_room()))


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
        check_map(turned, BOX, HOLONOMIC, post)


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
        check_map(cut, BOX, IDEAL, room)


def test_a_body_that_starts_in_an_obstacle_may_leave_it_once() -> None:
    """It may not enter another one between two samples."""
    plan = plan_push(face_problem(Pose(1.5, 0.0, 0.0))).trajectory
    beside = (-0.1, 0.0, 0.19, 0.25)
    check_plan(plan, expected(walled_room(beside)))
    for spoilt in (plan, thinned(plan, [0, -1])):
        with pytest.raises(ValueError, match='leads the object into an obstacle'):
            check_map(spoilt, BOX, HOLONOMIC, walled_room(beside, (1.0, 1.05, -0.1, 0.1)))


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
    check_map(far, BOX, HOLONOMIC, OccupancyMap(0.005, Pose(-100.0, -1.0, 0.0),
                                                np.zeros((400, 60_000), dtype=bool)))
    assert MAX_POSITIONS <= counts[0] <= MAX_POSITIONS + 2 * len(far.times)


@pytest.mark.parametrize('name, sample, offset, text', [
    ('contact_poses', 0, (-0.02, 0.0, 0.0), 'contact_poses: got 0.02 m from the rim of the robot'),
    ('contact_poses', 9, (0.0, 0.1, 0.0), 'm from the rim of the robot at sample 9'),
    ('object_twists', 5, (0.2, 0.0, 0.0), 'object_twists: got 0.2 m/s beside the rate'),
    ('object_twists', 5, (0.0, 0.0, 1.0), 'object_twists: got 0.566 m/s beside the rate'),
    ('robot_twists', -1, (0.0, 0.2, 0.0), 'robot_twists: got 0.2 m/s beside the rate'),
    ('contact_twists', 7, (0.3, 0.0, 0.0), 'contact_twists: got 0.3 m/s beside the object'),
    ('contact_twists', 7, (0.0, 0.0, -2.0), 'contact_twists: got 0.34 m/s beside the rate of')])
def test_a_number_that_contradicts_the_others_is_named(
        ahead: PushTrajectory, name: str, sample: int, offset: tuple[float, float, float],
        text: str) -> None:
    """With what was expected: each array is driven in its own way."""
    check_plan(ahead, expected())
    with pytest.raises(ValueError, match=re.escape(text) + '.*, expected at most 0'):
        check_plan(changed(ahead, name, sample, offset), expected())


def test_robot_and_contact_do_not_go_round_the_object_together(ahead: PushTrajectory) -> None:
    """The contact is on the rim of the robot, and not on the object."""
    away = changed(changed(ahead, 'contact_poses', 20, (-0.04, 0.0, 0.0)), 'robot_poses', 20,
                   (-0.04, 0.0, 0.0))
    slow = dataclasses.replace(away, times=20.0 * away.times)
    with pytest.raises(ValueError, match='got 0.04 m from the outline of the object at sample 20'):
        check_plan(slow, expected())


def test_a_differential_drive_does_not_move_sideways() -> None:
    """Its heading is where it goes; a holonomic robot may have any."""
    plan = plan_push(vertex_problem(Pose(1.5, 0.0, -math.pi / 4))).trajectory
    check_plan(plan, expected(robot=DIFFERENTIAL))
    turned = dataclasses.replace(plan, robot_poses=plan.robot_poses + (0.0, 0.0, math.pi / 2))
    check_plan(turned, expected(robot=HOLONOMIC))
    with pytest.raises(ValueError, match='robot_poses: got .* m/s across the heading'):
        check_plan(turned, expected(robot=DIFFERENTIAL))


def test_a_line_is_as_long_as_the_path_of_the_robot() -> None:
    """Its ends alone do not tell: a line may go round a whole circle more."""
    plan = straight_push(BOX, BEHIND, 0.6, curvature=1.5)
    line = plan.straight_line()
    around = dataclasses.replace(plan, line=line._replace(
        length=line.length + 2.0 * math.pi / line.curvature))
    with pytest.raises(ValueError, match='line.length: got 4.789 m, expected that of robot_pos'):
        check_plan(around, expected(robot=IDEAL))


def test_a_steered_push_of_a_task_leads_to_the_goal_or_nearer(ahead: PushTrajectory) -> None:
    """It may go past the goal by a size of the object; the last push has to end there."""
    for distance, is_free in ((0.0, True), (0.5, True), (-0.7, True), (-1.2, False)):
        if is_free:
            check_plan(ahead, moved_goal(ahead, distance, is_last=False))
            continue
        with pytest.raises(ValueError, match='the plan leads away from the goal: got an end 1.20'):
            check_plan(ahead, moved_goal(ahead, distance, is_last=False))
    for distance in (0.5, -0.7):
        with pytest.raises(ValueError, match='the plan ends beside the goal: got'):
            check_plan(ahead, moved_goal(ahead, distance, is_last=True))


@pytest.mark.parametrize('is_last', [True, False])
def test_a_plan_takes_no_detours(is_last: bool) -> None:
    """Thirty metres up and down before it goes to a goal that is half a metre away."""
    plan = plan_push(face_problem(Pose(0.5, 0.0, 0.0))).trajectory
    end = Pose(*plan.object_poses[-1].tolist())
    ends = ExpectedEnds((), PoseRegion(end, 0.01, 0.02), is_last)
    expectation = ExpectedPush(BOX, HOLONOMIC, ends, None)
    check_plan(plan, expectation)
    samples = np.concatenate([np.arange(len(plan.times))] + 30 * [
        np.arange(len(plan.times))[::-1], np.arange(len(plan.times))])
    times = np.arange(len(samples)) * float(np.diff(plan.times).max())
    detour = dataclasses.replace(plan, times=times, **{
        name: getattr(plan, name)[samples] for name in COLUMNS})
    with pytest.raises(ValueError, match='the plan is too long: got 30.5 m of object_poses, exp'):
        check_length(detour, expectation)


def test_plans_of_all_contacts_and_drives_are_driven() -> None:
    """The planner's own plans pass every check."""
    problems = [vertex_problem(Pose(x, y, theta)) for x, y, theta in (
        (1.0, 0.3, 0.2), (2.0, -1.0, -2.0))] + [
        face_problem(Pose(1.0, 0.3, 0.2)), face_problem(Pose(-0.3, 0.2, 2.5)),
        round_problem(Pose(1.0, 0.5, 0.6))]
    for problem in problems:
        check_plan(plan_push(problem).trajectory, ExpectedPush(
            problem.obj, problem.robot,
            ExpectedEnds((PoseRegion(problem.start, 1e-6, 1e-6),),
                         PoseRegion(problem.goal, 0.01, 0.02)),
            None))
