"""What the supervisor of a task knows: rest, friction centre, tries; and its retreat."""

import math

from helpers.objects import bin_, box
import numpy as np
from push_control.settings import ControlSettings
from push_control.task.behavior import BehaviorContext
from push_control.task.object_model import ObjectModelEstimator
from push_control.task.perception import ObjectAtRest, StationarityWindow
from push_control.task.progress import GoalCheck, ProgressMonitor
from push_control.task.retreat import retreat_path
from push_control.task.settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.friction import friction_center, with_friction_center
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import ObjectPose
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import sample_path
from push_navigation.settings import DriveSettings
import pytest

CONTROL, SUPERVISION, DRIVE = ControlSettings(), SupervisionSettings(), DriveSettings()
GOAL = Pose(1.0, -2.0, math.pi)
AT_GOAL = ObjectAtRest(GOAL, 0.5, 5e-4, 1e-3)


def noisy(rng, pose, count):
    """Yield measurements of a pose, at 20 Hz."""
    for i in range(count):
        x, y, turn = rng.normal(0.0, (CONTROL.pose_noise, CONTROL.pose_noise,
                                      CONTROL.heading_noise))
        yield ObjectPose(0.05 * i, Pose(pose.x + x, pose.y + y, wrap_angle(pose.theta + turn)))


def test_the_average_of_poses_at_rest_is_as_good_as_it_says():
    """Errors of many averages spread as their standard errors, across the seam of angles too."""
    scores = []
    for seed in range(200):
        window = StationarityWindow(CONTROL, SUPERVISION)
        for measured in noisy(np.random.default_rng(seed), GOAL, 20):
            window.add(measured)
        object_at_rest = window.object_at_rest
        scores.append(((object_at_rest.pose.x - GOAL.x) / object_at_rest.position_error,
                       (object_at_rest.pose.y - GOAL.y) / object_at_rest.position_error,
                       wrap_angle(object_at_rest.pose.theta - GOAL.theta) / object_at_rest.heading_error))
    assert np.mean(np.square(scores), axis=0) == pytest.approx([1.0] * 3, abs=0.3)


def test_an_object_that_moves_is_seen_from_there_on():
    """Nothing of where it was enters the average; a pose that came before is not taken twice."""
    window = StationarityWindow(CONTROL, SUPERVISION)
    for i in range(10):
        window.add(ObjectPose(0.05 * i, GOAL))
    there = GOAL._replace(x=GOAL.x + 0.02)
    for i in range(10, 15):
        window.add(ObjectPose(0.05 * i, there))
        window.add(ObjectPose(0.05 * (i - 3), GOAL))
    assert window.object_at_rest.pose == pytest.approx(there)
    assert window.object_at_rest.duration == pytest.approx(0.2)


@pytest.mark.parametrize('obj', [box(), box(friction=(0.2, 0.4, 0.3, 0.5)), bin_()])
def test_friction_is_shifted_and_not_changed(obj):
    """The centre is where it was asked for, and all supports together rub as much as before."""
    learnt = with_friction_center(obj, (0.03, -0.02))
    assert friction_center(learnt) == pytest.approx((0.03, -0.02))
    assert sum(learnt.capacities) == pytest.approx(sum(obj.capacities))
    assert with_friction_center(obj, friction_center(obj)).capacities == pytest.approx(
        obj.capacities)


def test_no_support_pulls():
    """A centre beyond the feet is approached only as far as they go."""
    learnt = with_friction_center(box(), (0.5, 0.0))
    assert min(learnt.capacities) > 0.0
    assert 0.1 < friction_center(learnt)[0] < 0.2


def test_pushes_from_two_sides_tell_the_friction_centre():
    """What a push cannot tell, along its line, does no harm."""
    true, learnt = np.array((0.03, -0.02)), ObjectModelEstimator(box(), CONTROL)
    for corner, along in (((-0.2, -0.2), 0.05), ((0.2, -0.2), -0.03)) * 3:
        line = (true - corner) / np.hypot(*(true - corner))
        before = learnt.relative_deviation(corner)
        learnt.update(corner, tuple(true + along * line))
        assert learnt.relative_deviation(corner) < before
    assert friction_center(learnt.obj) == pytest.approx(tuple(true), abs=2e-3)


def test_a_push_from_an_uncertain_place_tells_less():
    """What it saw is taken for an error of its place rather than of the friction centre."""
    shifts = []
    for unsure in (0.0, 0.03, 0.3):
        learnt = ObjectModelEstimator(box(), CONTROL)
        learnt.update((-0.2, 0.0), (0.0, 0.03), unsure)
        shifts.append(friction_center(learnt.obj)[1])
    assert 0.03 > shifts[0] > shifts[1] > 5.0 * shifts[2] > 0.0


@pytest.mark.parametrize('angle', [0.0, 1.0, -2.2])
def test_what_a_push_sees_is_compared_across_it(angle):
    """To its left, however far along it sees the centre; once learnt there is nothing left."""
    learnt, turn = ObjectModelEstimator(box(), CONTROL), Pose(0.0, 0.0, angle)
    point = turn.rotate((-0.25, 0.0))
    for along, left in ((-0.04, 0.02), (0.0, 0.02), (0.05, -0.03)):
        across, shift, unsure = learnt.lateral_innovation(point, turn.rotate((along, left)))
        assert (math.cos(across), math.sin(across)) == pytest.approx(turn.rotate((0.0, 1.0)))
        assert shift == pytest.approx(left)
    for _ in range(20):
        learnt.update(point, turn.rotate((0.0, 0.02)))
    _, left_over, surer = learnt.lateral_innovation(point, turn.rotate((0.0, 0.02)))
    assert abs(left_over) < 1e-3 and surer < 0.1 * unsure
    assert learnt.lateral_innovation(turn.rotate((0.0, -0.25)), (0.0, 0.0))[2] > 0.9 * unsure


def test_it_is_done_only_where_that_is_certain():
    """Near the tolerance a longer look is asked for, but not for ever."""
    inside = SUPERVISION.position_tolerance - 5e-4
    edge = AT_GOAL._replace(pose=GOAL._replace(x=GOAL.x + inside))
    far = AT_GOAL._replace(pose=GOAL._replace(theta=-GOAL.theta + 0.1))
    max_attempts = ProgressMonitor(SUPERVISION)
    assert max_attempts.check_goal(AT_GOAL, GOAL) is GoalCheck.REACHED
    assert max_attempts.check_goal(edge, GOAL) is GoalCheck.UNCERTAIN
    assert max_attempts.check_goal(edge._replace(duration=SUPERVISION.max_averaging_time), GOAL) is GoalCheck.MISSED
    assert max_attempts.check_goal(far, GOAL) is GoalCheck.MISSED


def test_tries_count_from_the_last_that_brought_it_nearer():
    """It gives up after as many as allowed in a row, and says what went wrong last."""
    max_attempts = ProgressMonitor(SUPERVISION)

    def object_at_rest(error):
        return AT_GOAL._replace(pose=GOAL._replace(y=GOAL.y + error))

    for error in (0.5, 0.3):
        for _ in range(SUPERVISION.max_attempts - 1):
            max_attempts.check_goal(object_at_rest(error), GOAL)
            max_attempts.count_attempt()
            assert not max_attempts.abort_reason
    max_attempts.check_goal(object_at_rest(0.4), GOAL)
    max_attempts.count_attempt('slipped')
    assert 'slipped' in max_attempts.abort_reason


@pytest.mark.parametrize('drive', ['differential', 'holonomic'])
@pytest.mark.parametrize('turned', [-0.6, 0.0, 0.4])
def test_the_retreat_leads_off_the_object(drive, turned):
    """All along it the gap grows; the robot does not turn."""
    robot, obj = RoundRobot(radius=0.17, drive=drive), box()
    start = Pose(-0.37, 0.05, turned)
    way = retreat_path(BehaviorContext(obj, robot, CONTROL, DRIVE, SUPERVISION), start,
                       Pose(0.0, 0.0, 0.0))
    gaps = [find_contact(obj, Pose(0.0, 0.0, 0.0), pose[:2], robot.radius)[2]
            for pose in sample_path(way, robot, 0.02)]
    assert all(np.diff(gaps) > 0.0)
    assert way.length == pytest.approx(DRIVE.retreat_distance)
    assert way.poses[-1].theta == turned


def test_no_retreat_along_the_object_or_into_a_wall():
    """A differential drive that looks along a face has none; a wall behind it leaves less."""
    robot, obj, pose = RoundRobot(radius=0.17), box(), Pose(0.0, 0.0, 0.0)
    context = BehaviorContext(obj, robot, CONTROL, DRIVE, SUPERVISION)
    assert retreat_path(context, Pose(-0.37, 0.0, 0.5 * math.pi), pose) is None
    start = Pose(-0.37, 0.0, 0.0)
    for columns, length in ((0, DRIVE.retreat_distance), (26, 0.5 * DRIVE.retreat_distance), (28, None)):
        walled = np.zeros((80, 80), dtype=bool)
        walled[:, :columns] = True
        way = retreat_path(context._replace(occupancy_map=OccupancyMap(0.05, Pose(-2.0, -2.0, 0.0), walled)), start, pose)
        assert (way and distance(way.poses[-1], start)) == pytest.approx(length)
