"""Plans of tasks: any goal from anywhere, each push planned and integrated again."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_navigation.settings import DriveSettings
from push_navigation.speed_profile import travel_time
from push_planner.problem import PlanningFailed, problem_from_placement
from push_planner.sequence.costs import plan_approach, standoff_pose
from push_planner.sequence.planner import plan_task
from push_planner.settings import PlannerSettings, TaskSettings
from push_planner.single_push.contact_sites import robot_start, site_problems
from push_planner.single_push.planner import plan_push
from push_planner.verification.verification import verify
import pytest

pytestmark = pytest.mark.slow
HOME, HERE = Pose(0.0, 0.0, 0.0), Pose(-1.2, 0.9, 2.0)
SETTINGS, DRIVE, TASK = PlannerSettings(), DriveSettings(), TaskSettings()
SURE = TaskSettings(correction_time=0.0)
NEAR = [Pose(0.05 * math.cos(angle), 0.05 * math.sin(angle), 0.02) for angle in (0.3, 1.9, 4.0)]
CASES = [(box(), DIFFERENTIAL, goal) for goal in NEAR + [
    Pose(0.0, 0.0, math.pi), Pose(0.8, -0.3, 0.03), Pose(-1.4, 0.5, -1.5)]] + [
    (box(), HOLONOMIC, Pose(0.0, 0.01, 0.02)), (bin_(), HOLONOMIC, Pose(0.03, -0.04, -0.05))]


def execute(obj, robot, found, goal):
    """Plan and integrate all pushes, each from where the one before has ended."""
    pose, ratios = found.pushes[0].start, []
    gentle = dataclasses.replace(SETTINGS, final_straight=0.03, max_path_length=6.0)
    for push in found.pushes:
        place = pose @ push.start.inverse() @ push.robot_start
        problem = problem_from_placement(obj, robot, pose, place, push.end, gentle)
        assert problem.contact.kind == push.contact.kind
        answer = plan_push(problem)
        check = verify(answer)
        assert check.position_error < 2e-3 and check.heading_error < 3e-3
        assert check.friction_usage <= 1.0
        ratios.append(answer.trajectory.duration / push.duration)
        pose = Pose(*answer.trajectory.object_poses[-1])
    assert distance(pose, goal) < 2e-3 and abs(wrap_angle(pose.theta - goal.theta)) < 3e-3
    return ratios


@pytest.mark.parametrize('obj, robot, goal', CASES)
def test_all_pushes_of_a_sequence_lead_to_the_goal(obj, robot, goal):
    """They take the time that was estimated, and the first plan is the first push."""
    found = plan_task(obj, robot, HOME, HERE, goal)
    assert all(ratio < 1.05 for ratio in execute(obj, robot, found, goal))
    first, plan_ = found.pushes[0], found.plan
    assert found.pushes[-1].end == goal and plan_.problem.goal == first.end
    assert first.duration == plan_.trajectory.duration
    for before, after in zip(found.pushes, found.pushes[1:]):
        assert before.end == after.start
    assert found.approach_path.poses[0] == pytest.approx(HERE)
    standoff = standoff_pose(first.robot_start, DRIVE)
    assert found.approach_path.poses[-1] == pytest.approx(standoff, abs=1e-9)
    place = plan_.trajectory.robot_poses[0]
    assert distance(place, first.robot_start) < 1e-6
    assert abs(wrap_angle(place[2] - first.robot_start.theta)) < 1e-6


@pytest.mark.parametrize('obj, robot, goal', CASES[2:])
def test_the_duration_is_the_sum_of_its_parts(obj, robot, goal):
    """Paths of the robot, settling and pushes."""
    found = plan_task(obj, robot, HOME, HERE, goal)
    total = travel_time(found.approach_path, robot, DRIVE)
    for before, after in zip(found.pushes, found.pushes[1:]):
        # After a straight end the robot stands at the object as it did before.
        stands = before.end @ before.start.inverse() @ before.robot_start
        path = plan_approach(robot, obj, before.end, stands, after.robot_start, DRIVE)
        total += travel_time(path, robot, DRIVE)
    total += sum(push.duration + TASK.switch_time for push in found.pushes)
    assert found.duration == pytest.approx(total, rel=1e-3)


@pytest.mark.parametrize('obj, robot, goal', [
    (box(), HOLONOMIC, Pose(0.7, 0.9, 1.0)), (box(), HOLONOMIC, Pose(0.0, 0.02, 0.3)),
    (bin_(), HOLONOMIC, Pose(-0.5, 0.4, 2.0)), (box(), DIFFERENTIAL, Pose(1.9, 0.4, -1.1))])
def test_no_single_push_is_faster(obj, robot, goal):
    """All sites are solved one by one, the path to them included."""
    found, best = plan_task(obj, robot, HOME, HERE, goal, task=SURE), math.inf
    for problem in site_problems(obj, robot, HOME, goal, SETTINGS):
        try:
            time = plan_push(problem).trajectory.duration
        except PlanningFailed:
            continue
        path = plan_approach(robot, obj, HOME, HERE, robot_start(problem), DRIVE)
        best = min(best, time + TASK.switch_time + travel_time(path, robot, DRIVE))
    assert found.duration <= min(best, found.single_push_time) * (1.0 + 1e-9)
    assert (found.duration == found.single_push_time) == (len(found.pushes) == 1)


@pytest.mark.parametrize('obj, robot, goal', [CASES[0], CASES[4], CASES[7]])
def test_it_does_not_matter_where_in_the_world(obj, robot, goal):
    """All poses moved together give the same sequence, moved; asked again, exactly the same."""
    moved = Pose(13.0, -4.0, 2.3)
    one, again = (plan_task(obj, robot, HOME, HERE, goal) for _ in range(2))
    assert one.pushes == again.pushes and one.duration == again.duration
    two = plan_task(obj, robot, moved @ HOME, moved @ HERE, moved @ goal)
    assert two.duration == pytest.approx(one.duration, rel=1e-4)
    for first, second in zip(one.pushes, two.pushes, strict=True):
        assert distance(moved @ first.end, second.end) < 1e-3
        assert distance(moved @ first.robot_start, second.robot_start) < 1e-3


@pytest.mark.parametrize('goal', [Pose(-0.4, 0.9, 0.8), Pose(0.6, 0.1, 0.05)])
def test_the_mirror_image_takes_as_long(goal):
    """Box, goal and robot reflected in the x axis."""
    times = [plan_task(box(), DIFFERENTIAL, HOME, Pose(x, side * y, side * theta),
                       Pose(goal.x, side * goal.y, side * goal.theta)).duration
             for x, y, theta in [HERE] for side in (1.0, -1.0)]
    assert times[1] == pytest.approx(times[0], rel=1e-3)


def test_a_goal_nearby_takes_several_pushes_of_a_differential_drive():
    """No more than three quarters of what a single push would take."""
    found = plan_task(box(), DIFFERENTIAL, HOME, HERE, NEAR[0])
    assert len(found.pushes) > 1 and found.duration < 0.75 * found.single_push_time
    alone = plan_task(box(), DIFFERENTIAL, HOME, HERE, NEAR[0], task=TaskSettings(max_pushes=1))
    assert len(alone.pushes) == 1 and alone.duration == alone.single_push_time
    assert alone.single_push_time == pytest.approx(found.single_push_time, rel=0.15)


def test_what_is_nearly_there_is_not_rotated_all_round():
    """Pushed on in a full circle it would be there sooner, and miss again nearly always."""
    for goal, here in ((Pose(-0.013, 0.006, -0.016), Pose(-0.184, 0.42, -3.124)),
                       (Pose(0.012, 0.007, 0.016), Pose(0.206, -0.654, 1.081))):
        rotations, times = [], []
        for task in (TASK, SURE):
            found = plan_task(bin_(), HOLONOMIC, HOME, here, goal, task=task)
            headings = found.plan.trajectory.object_poses[:, 2]
            rotations.append(np.abs(np.diff(np.unwrap(headings))).sum() + sum(
                step.rotation for step in found.later_steps))
            times.append(found.duration)
        assert rotations[0] < 0.5 * math.pi and rotations[1] > 1.5 * math.pi
        assert times[0] > times[1]


@pytest.mark.parametrize('poses, reason', [
    ((HOME, HERE, Pose(math.nan, 0.0, 0.0)), 'the goal is not finite'),
    ((HOME, Pose(0.0, math.inf, 0.0), NEAR[0]), 'the robot pose is not finite'),
    ((HOME, HERE, HOME), 'at the goal already'),
    ((HOME, HOME, NEAR[0]), 'no push sequence.*stands where it cannot get round the object'),
    ((HOME, HERE, Pose(600.0, 0.0, 0.0)),
     'no push sequence.*a push of .* at most 20 m is accepted')])
def test_what_cannot_be_says_why(poses, reason):
    """One sentence."""
    with pytest.raises(PlanningFailed, match=reason):
        plan_task(box(), DIFFERENTIAL, *poses)


def test_impossible_robots_and_objects_are_refused():
    """As for single pushes."""
    with pytest.raises(PlanningFailed, match='not for flat pushers'):
        plan_task(box(), RoundRobot(radius=math.inf), HOME, HERE, NEAR[0])
    with pytest.raises(PlanningFailed, match='no friction'):
        plan_task(box(contact_friction_coefficient=0.0), HOLONOMIC, HOME, HERE, NEAR[0])
    with pytest.raises(PlanningFailed, match='round contact is not supported'):
        plan_task(bin_(), DIFFERENTIAL, HOME, HERE, NEAR[0])
