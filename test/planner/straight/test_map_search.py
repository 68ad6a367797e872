"""Pushes in maps: paths that were checked otherwise, reasons that name places, goals at walls."""

import dataclasses
import math

from helpers.maps import scattered_cells, true_distances, walled_floor, walled_room
from helpers.objects import bin_, box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.trajectory import PushStyle
from push_navigation.floor import make_floor
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import sample_path
from push_navigation.path_planner import CLEARANCE_STEPS
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.settings import PlannerSettings
from push_planner.straight.map_search import planner
from push_planner.straight.map_search.object_distance import distance_grid, narrowest_passage
from push_planner.straight.map_search.planner import (
    MAX_EXPANSIONS, MIN_FRACTION, plan_push_in_map)
from push_planner.straight.map_search.priority_queue import push, remove_first
from push_planner.straight.map_search.reachable_set import (
    fill_reachable_set, HALF_WINDOW, path_length, ReachableSet, RobotMargins, SPACING, UNREACHED)
from push_planner.straight.map_search.refusal_memory import Question, RefusalMemory
from push_planner.straight.map_search.scene import (
    distance_to_object, make_scene, object_clearance)
from push_planner.straight.planner import ApproachPaths, plan_straight_push
import pytest
from scipy.ndimage import label

pytestmark = pytest.mark.slow
ROBOT = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
HOLONOMIC = dataclasses.replace(ROBOT, drive='holonomic')
BOX = box()
SETTINGS, DRIVE = PlannerSettings(), DriveSettings()
HERE, START = Pose(-1.6, 0.2, 0.4), Pose(-0.9, -1.1, 1.0)
MIN_CLEARANCE = MIN_FRACTION * DRIVE.map_clearance


def plan(occupancy_map, goal, robot=ROBOT, here=HERE, start=START, **request):
    """Plan for the box."""
    return plan_push_in_map(PlanRequest(here, start, goal, BOX, **request), robot, SETTINGS, DRIVE,
                            occupancy_map)


def refusal(occupancy_map, goal, here=HERE, start=START):
    """Return the ``PlanningFailed`` with which a plan is refused."""
    with pytest.raises(PlanningFailed) as failure:
        plan(occupancy_map, goal, here=here, start=start)
    return failure.value


@pytest.mark.parametrize('robot', [ROBOT, HOLONOMIC], ids=['differential', 'holonomic'])
@pytest.mark.parametrize('goal', [Pose(1.5, 0.3, 1.0), Pose(1.2, -1.6, -2.0)])
def test_the_object_is_pushed_through_a_door_step_by_step(robot, goal):
    """Each push taken as expected, all are free, for the robot too; the goal is reached."""
    occupancy_map = walled_floor(6.0, 4.5, 0.9)
    here, at, styles = HERE, START, []
    for _ in range(25):
        found = plan(occupancy_map, goal, robot, here, at)
        trajectory, path = found.first.trajectory, found.first.approach_path
        assert occupancy_map.object_is_free(BOX, trajectory.object_poses, 0.0)
        assert occupancy_map.robot_is_free(robot, trajectory.robot_poses, MIN_CLEARANCE - 1e-6)
        assert occupancy_map.robot_is_free(robot, sample_path(path, robot, 0.02),
                                           MIN_CLEARANCE - 1e-3)
        styles.append(trajectory.style)
        here = Pose(*trajectory.object_poses[-1].tolist())
        at = Pose(*trajectory.robot_poses[-1].tolist())
        if math.dist(here[:2], goal[:2]) < 0.01 and abs(math.remainder(
                here.theta - goal.theta, math.tau)) < math.radians(1.0):
            break
    else:
        pytest.fail(f'got to {here}, expected {goal}')
    # To waypoints up to the door, then to the goal itself.
    assert styles[0] is PushStyle.WAYPOINT and styles[-1] is PushStyle.STRAIGHT


@pytest.mark.parametrize('heading', [1.0, -2.0, 3.1])
@pytest.mark.parametrize('x, y', [(-1.6, 0.0), (-1.5, -1.5)], ids=['wall', 'corner'])
def test_a_disc_is_rolled_to_its_heading_before_a_goal_at_walls(
        x: float, y: float, heading: float) -> None:
    """The search with the widest margins finds how; at the goal there is no room for it."""
    request = PlanRequest(Pose(0.8, 0.5, 0.0), Pose(1.2, -0.8, 0.0), Pose(x, y, heading),
                          bin_(feet=4))
    planned = plan_push_in_map(request, HOLONOMIC, SETTINGS, DRIVE, walled_room(side=4.0))
    assert 0 < planned.expansions < MAX_EXPANSIONS[0]


def test_where_any_heading_does_that_of_the_goal_has_no_effect() -> None:
    """The same pushes lead to the same place, whatever heading the goal states."""
    occupancy_map, ends = walled_floor(6.0, 4.5, 0.9), []
    for heading in (1.0, -2.0):
        goal, here, at = Pose(1.5, 0.3, heading), HERE, START
        for _ in range(25):
            trajectory = plan(occupancy_map, goal, here=here, start=at,
                              heading_tolerance=math.tau).first.trajectory
            assert occupancy_map.object_is_free(BOX, trajectory.object_poses, 0.0)
            here = Pose(*trajectory.object_poses[-1].tolist())
            at = Pose(*trajectory.robot_poses[-1].tolist())
            if math.dist(here[:2], goal[:2]) < 0.01:
                break
        ends.append(here)
    assert ends[0] == ends[1]
    assert math.dist(ends[0][:2], goal[:2]) < 0.01


def test_the_rest_of_a_sequence_is_taken_up_where_all_went_as_planned():
    """The next push is the one that was kept, without a search; else there is a new one."""
    occupancy_map, goal = walled_floor(6.0, 4.5, 0.9), Pose(1.5, 0.3, 1.0)
    found = plan(occupancy_map, goal)
    assert len(found.remaining.pushes) >= 2
    report, trajectory = found.first.report, found.first.trajectory
    straight = math.dist(HERE[:2], goal[:2])
    assert straight / 0.3 < report['least_chain_time'] <= report['chain_time']
    here, at = (Pose(*poses[-1].tolist())
                for poses in (trajectory.object_poses, trajectory.robot_poses))
    beside = here @ Pose(0.01, -0.01, 0.03)
    for pose in (here, beside):
        following = plan_push_in_map(PlanRequest(pose, at, goal, BOX), ROBOT, SETTINGS, DRIVE,
                                     occupancy_map, remaining=found.remaining)
        assert following.expansions == 0
        assert following.remaining.pushes == found.remaining.pushes[1:]
        end = following.first.trajectory.object_poses[-1]
        assert math.dist(end[:2], found.remaining.pushes[0].end[:2]) < 0.06
    cells = occupancy_map.occupied.copy()
    middle = occupancy_map.to_map([found.remaining.pushes[0].end[:2]]) / occupancy_map.resolution
    column, row = middle[0].astype(int)
    cells[row, column] = True
    blocked = OccupancyMap(occupancy_map.resolution, occupancy_map.origin, cells)
    changes = ((here @ Pose(0.2, 0.1, 0.0), goal, occupancy_map),
               (here, goal @ Pose(0.05, 0.0, 0.0), occupancy_map), (here, goal, blocked))
    for pose, new_goal, floor in changes:
        following = plan_push_in_map(PlanRequest(pose, at, new_goal, BOX), ROBOT, SETTINGS, DRIVE,
                                     floor, remaining=found.remaining)
        assert following.expansions > 0


def test_where_the_floor_is_open_a_map_changes_nothing():
    """The push is that of open floor."""
    goal = Pose(-0.4, 0.5, 2.0)
    found = plan(walled_floor(20.0, 20.0), goal)
    free = plan_straight_push(PlanRequest(HERE, START, goal, BOX), ROBOT, SETTINGS, DRIVE)
    assert found.expansions == 0 and found.remaining.pushes == ()
    np.testing.assert_allclose(found.first.trajectory.object_poses, free.trajectory.object_poses,
                               atol=1e-9)


@pytest.mark.parametrize('goal', [Pose(2.0, 2.71, 0.0), Pose(-2.71, -1.0, 0.0)])
def test_goals_beside_a_wall_are_reached(goal):
    """The last push comes from a side that is free; nothing overlaps the wall."""
    occupancy_map = walled_room()
    found = plan(occupancy_map, goal)
    later_poses = [push.end for push in found.remaining.pushes]
    assert not later_poses or later_poses[-1] == pytest.approx(goal, abs=1e-9)
    end = later_poses[-1] if later_poses else Pose(*found.first.trajectory.object_poses[-1])
    assert math.dist(end[:2], goal[:2]) < 0.05
    assert occupancy_map.object_is_free(BOX, found.first.trajectory.object_poses, 0.0)


def test_a_floor_that_is_too_narrow_is_named():
    """The place, the width there, and what is needed."""
    refused = refusal(walled_floor(6.0, 4.0, 0.3), Pose(1.5, 0.0, 0.0))
    report = refused.report
    assert refused.code is PlanFailure.BLOCKED
    assert math.hypot(*report['narrow_place']) < 0.15
    assert report['width'] < 0.35 and report['needed_width'] == pytest.approx(0.42, abs=0.01)


def test_an_object_that_is_shut_in_is_named():
    """In a corner no face leads away from both walls."""
    here = Pose(-2.72, -2.72, 0.0)
    refused = refusal(walled_room(), Pose(1.0, 1.0, 0.0), here=here)
    assert refused.code is PlanFailure.NO_FACE and refused.report['expansions'] < 100


def test_an_object_without_a_face_is_told_how_far_off_its_goal_it_is() -> None:
    """The numbers are those of the poses; the sentence has them where the goal is near."""
    here, goal = Pose(-2.72, -2.72, 0.0), Pose(-2.70, -2.72, -0.01)
    refused = refusal(walled_room(), goal, here=here)
    assert refused.code is PlanFailure.NO_FACE
    assert refused.report['position_error'] == pytest.approx(0.02)
    assert refused.report['heading_error'] == pytest.approx(0.01)
    assert '20 mm and 0.6 degrees from its goal' in refused.reason
    assert 'goal' not in refusal(walled_room(), Pose(1.0, 1.0, 0.0), here=here).reason


def test_where_the_robot_has_no_room_at_a_face_all_faces_are_counted():
    """A box in a niche that it fills: of its four faces one is left, which leads deeper."""
    floor = walled_room((-3.0, -0.25, -3.0, -2.0), (0.25, 3.0, -3.0, -2.0))
    refused = refusal(floor, Pose(1.0, 1.0, 0.0), here=Pose(0.0, -2.79, 0.0),
                      start=Pose(0.0, 0.0, 0.0))
    assert refused.code is PlanFailure.NO_FACE
    assert refused.report['faces'] == 4 and refused.report['faces_with_room'] == 1


def test_a_question_that_has_not_changed_is_answered_from_memory():
    """The same answer without a search; another map, pose or goal is another question."""
    memory, answer = RefusalMemory(), PlanningFailed(PlanFailure.BLOCKED, 'a wall', {'width': 0.3})
    floor = walled_room()
    question = Question(PlanRequest(HERE, START, HERE, BOX, odometry_drift=0.1), ROBOT, SETTINGS,
                        DRIVE, floor)
    memory.add(question, answer)

    def recalled(occupancy_map=floor, **changes):
        return memory.recall(question._replace(
            request=question.request._replace(**changes), occupancy_map=occupancy_map))
    beside = HERE @ Pose(0.001, 0.0, 0.001)
    for same in (recalled(), recalled(walled_room()), recalled(object_pose=beside),
                 recalled(obj=dataclasses.replace(BOX, contact_friction_coefficient=0.3))):
        assert (same.code, same.reason, same.report) == (
            answer.code, answer.reason, answer.report)
    away = HERE @ Pose(0.01, 0.0, 0.0)
    for other in (recalled(walled_room((0.0, 0.1, 0.0, 0.1))), recalled(object_pose=away),
                  recalled(robot_pose=away), recalled(goal=away), recalled(odometry_drift=0.05),
                  recalled(position_tolerance=0.05)):
        assert other is None


@pytest.mark.parametrize('count', [1, 3])
def test_paths_to_first_pushes_use_up_the_work_of_a_request(
        count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot that gets to none of them tries no more than the work is for."""
    tried: list[Pose] = []

    def travel_time(_: ApproachPaths, start: Pose) -> float:
        tried.append(start)
        return math.inf
    monkeypatch.setattr(ApproachPaths, 'travel_time', travel_time)
    monkeypatch.setattr(planner, 'PATH_WORK', planner.MAX_WORK // count)
    # Answers are remembered: no other test asks this.
    refusal(walled_floor(6.0, 4.5, 0.9), Pose(1.5, 0.3, 1.0),
            start=START @ Pose(0.01 * count, 0.0, 0.0))
    assert len(tried) == count


def test_where_object_or_goal_do_not_fit_there_is_no_plan():
    """The sentence says which."""
    for here, goal, text in ((HERE, Pose(5.0, 0.0, 0.0), 'goal is at 5.00 m'),
                             (Pose(-2.9, 0.0, 0.0), Pose(1.0, 0.0, 0.0), 'object stands at')):
        with pytest.raises(PlanningFailed, match=text) as failure:
            plan(walled_room(), goal, here=here)
        assert failure.value.code is PlanFailure.NOT_FREE


def test_the_robot_comes_from_another_room():
    """Through a door far from both, where it knows its place; else the reason says so."""
    occupancy_map = walled_room((-2.0, 3.0, -0.1, 0.1))
    start, here = Pose(2.0, -1.0, 1.0), Pose(2.0, 1.2, 0.4)
    found = plan(occupancy_map, Pose(0.0, 1.5, 0.0), here=here, start=start)
    assert found.first.approach_path.length > 7.0
    request = PlanRequest(here, start, Pose(0.0, 1.5, 0.0), BOX, odometry_slope=0.1,
                          odometry_drift=0.1)
    with pytest.raises(PlanningFailed) as failure:
        plan_push_in_map(request, ROBOT, SETTINGS, DRIVE, occupancy_map)
    assert failure.value.code is PlanFailure.UNCERTAIN_POSITION
    report = failure.value.report
    assert report['position_deviation'] > 0.05 and report['narrow_place'][0] < -1.5
    assert report['needed_width'] > report['width'] > 2.0 * ROBOT.radius
    # The numbers are those of the place, and decide there.
    place = report['narrow_place']
    assert report['width'] == pytest.approx(2.0 * occupancy_map.clearance([place])[0])
    _, sigmas = CLEARANCE_STEPS[-1]
    assert report['needed_width'] == pytest.approx(
        2.0 * (ROBOT.radius + sigmas * report['position_deviation']), rel=0.02)
    # The path leads there, from the robot to the object, and a robot that knew its place could go.
    path = np.array(report['robot_path'])
    assert math.dist(path[0], start[:2]) < 0.02 and math.dist(path[-1], here[:2]) < 0.5
    assert np.hypot(*(path - place).T).min() < 0.2
    assert occupancy_map.clearance(path).min() > ROBOT.radius


def test_a_plan_does_not_depend_on_the_frame():
    """A map that lies elsewhere gives the same plan there."""
    origin = Pose(4.0, -3.0, 2.1)
    plain = walled_floor(6.0, 4.5, 0.9)
    moved = OccupancyMap(plain.resolution, origin @ plain.origin, plain.occupied)
    goal = Pose(1.5, 0.3, 1.0)
    first = plan(plain, goal)
    second = plan(moved, origin @ goal, here=origin @ HERE, start=origin @ START)
    assert second.expansions == first.expansions
    np.testing.assert_allclose([(origin @ push.end)[:2] for push in first.remaining.pushes],
                               [push.end[:2] for push in second.remaining.pushes], atol=1e-6)


def test_the_robot_reaches_what_is_connected():
    """Against the labels of free cells, found without the search."""
    occupancy_map = walled_room((-0.8, -0.6, -3.0, 3.0))
    scene = make_scene(occupancy_map, BOX, 0.17)
    pose, margins = np.array([3.1, 3.1, 0.5]), RobotMargins(0.05, 0.03)
    side = 2 * HALF_WINDOW + 1
    offsets = SPACING * np.stack(np.meshgrid(*2 * [np.arange(side) - HALF_WINDOW]), axis=-1)
    c, s = math.cos(pose[2]), math.sin(pose[2])
    points = offsets.reshape(-1, 2) + pose[:2]
    away = np.array([distance_to_object(scene, c * x + s * y, c * y - s * x)
                     for x, y in offsets.reshape(-1, 2)])
    gaps = occupancy_map.clearance_in_map_frame(*points.T)
    free = (away >= 0.2 + 1e-6) & (gaps >= 0.22 + 1e-6)
    labels, _ = label(free.reshape(side, side), structure=np.ones((3, 3)))
    reachable = ReachableSet(np.empty((side, side)), np.empty((side, side, 2)),
                             np.empty(1 << 14, dtype=np.int64))
    start = int(np.flatnonzero(free)[0])
    fill_reachable_set(scene, margins, pose, points[start], HALF_WINDOW, reachable)
    connected = labels == labels.ravel()[start]
    assert 0.1 < connected[labels > 0].mean() < 0.9
    assert (reachable.lengths[connected] < UNREACHED).all()
    assert (reachable.lengths[(labels > 0) & ~connected] >= UNREACHED).all()
    there = points[np.flatnonzero(connected.ravel())[-1]]
    straight = math.dist(there, points[start])
    assert straight <= path_length(reachable, pose, HALF_WINDOW, *there) + SPACING


def test_a_hallway_is_driven_until_the_drift_fills_it():
    """A heading that drifts by d moves a robot by d s^2 / 2 across a straight path of length s."""
    occupancy_map = walled_room((-3.0, 3.0, -3.0, -0.6), (-3.0, 3.0, 0.6, 3.0))
    scene = make_scene(occupancy_map, BOX, 0.17)
    # The object is elsewhere.
    pose, drift = np.array([3.0, 5.5, 0.0]), 0.06
    half = 56
    side = 2 * half + 1
    reachable = ReachableSet(np.empty((side, side)), np.empty((side, side, 2)),
                             np.empty(1 << 14, dtype=np.int64))
    margins = RobotMargins(0.0, 0.0, drift=drift)
    fill_reachable_set(scene, margins, pose, (0.3, 3.0), half, reachable)
    row = reachable.lengths[half - 50]
    farthest = row[row < UNREACHED].max()
    assert math.isclose(farthest, math.sqrt(2.0 * (0.6 - 0.17) / drift), rel_tol=0.05)


def test_clearances_of_the_object_are_those_of_its_outline():
    """Never more than the true distance of any point on it, but for the spacing of points."""
    occupancy_map, rng = scattered_cells(6), np.random.default_rng(7)
    scene = make_scene(occupancy_map, BOX, 0.17)
    corners = np.array(BOX.outline)
    rim = np.concatenate([first + (last - first) * np.linspace(0.0, 1.0, 100)[:, None]
                          for first, last in zip(corners, np.roll(corners, -1, axis=0))])
    for _ in range(40):
        pose = Pose(*rng.uniform(0.3, 1.7, 2), rng.uniform(-3.0, 3.0))
        true = true_distances(occupancy_map, [pose.transform(point) for point in rim]).min()
        found = object_clearance(scene, *pose, 10.0)
        assert found <= true + 0.015
        if found > 0.05:
            assert found > true - 0.07


def test_lengths_of_paths_are_those_of_the_grid():
    """On open floor along rows and diagonals; round a wall no shorter than there."""
    occupancy_map = walled_room((-0.1, 0.1, -3.0, 2.4))
    floor = make_floor(occupancy_map)
    grid = distance_grid(floor, (1.0, 1.0), 0.2)
    rows, columns = grid.lengths.shape
    assert (rows, columns) == occupancy_map.occupied.shape
    x, y = grid.spacing * (np.indices((rows, columns))[::-1] + 0.5)
    reached = grid.lengths < UNREACHED
    clear = occupancy_map.clearance_in_map_frame(x, y)
    assert not reached[clear < 0.2 - 0.5 * grid.spacing - 1e-6].any()
    assert reached[clear > 0.2].all()
    straight = np.hypot(x - 1.0, y - 1.0)
    assert (grid.lengths[reached] >= straight[reached] - 1.5 * grid.spacing).all()
    free = reached & (x < 2.6)
    assert grid.lengths[free].max() < 1.09 * straight[free].max() + 0.1
    beyond = reached & (x > 3.2)
    assert grid.lengths[beyond].min() > np.hypot(3.2 - 1.0, 5.4 - 1.0)
    passage = narrowest_passage(floor, (5.0, 1.0), (1.0, 1.0))
    assert 2.8 < passage.x < 3.2 and passage.y > 5.4
    assert passage.width == pytest.approx(0.55, abs=0.05)


def test_items_leave_the_queue_in_order():
    """As a sort would have it."""
    rng = np.random.default_rng(3)
    keys, items, numbers = np.empty(300), np.empty(300, dtype=np.int64), rng.uniform(size=200)
    count = 0
    for item, number in enumerate(numbers):
        count = push(keys, items, count, number, item)
    order = []
    while count:
        order.append(int(items[0]))
        count = remove_first(keys, items, count)
    assert order == np.argsort(numbers).tolist()
