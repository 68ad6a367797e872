"""Site selection: the fastest site, whatever the others would have taken."""

import dataclasses
import math

from helpers.objects import bin_, box
from helpers.push_problems import DIFFERENTIAL, HOLONOMIC
import numpy as np
from push_model.geometry import distance, Pose
from push_model.parameters import Contact, RoundRobot, Support
from push_model.signals import ObjectPose, Odometry, STOP
from push_planner.problem import PlannerSettings, PlanningFailed, problem_from_placement
from push_planner.steered.contact_sites import site_problems
from push_planner.steered.planner import plan_push
from push_planner.steered.replanning import plan_from_measurements
from push_planner.steered.site_selection import choose_site
import pytest

HOME = Pose(0.0, 0.0, 0.0)
FIXED = PlannerSettings(robot_yaw='fixed', max_path_length=3.0)
AUTO = PlannerSettings(site='best')
UNEVEN = (0.4, 0.3, 0.35, 0.2)
FACES = {0: Pose(0.0, 1.5, 0.0), 1: Pose(-1.5, 0.0, 0.0), 2: Pose(0.0, -1.5, 0.0),
         3: Pose(1.5, 0.0, 0.0)}


def one_by_one(obj, robot, goal, settings):
    """Solve every site, without any bound."""
    durations = []
    for problem in site_problems(obj, robot, HOME, goal, settings):
        try:
            durations.append(plan_push(problem).trajectory.duration)
        except PlanningFailed:
            durations.append(math.inf)
    return durations


@pytest.mark.slow
@pytest.mark.parametrize('robot, obj, settings, goal', [
    (HOLONOMIC, box(friction=UNEVEN), PlannerSettings(), Pose(0.7, 0.9, 1.0)),
    (HOLONOMIC, box(friction=UNEVEN), PlannerSettings(pushing_speed=0.45), Pose(0.3, 0.0, 2.0)),
    (HOLONOMIC, box(), FIXED, Pose(1.5, 0.05, 0.05)),
    (HOLONOMIC, bin_(), PlannerSettings(), Pose(0.1, -0.6, -2.5)),
    (DIFFERENTIAL, box(friction=UNEVEN), PlannerSettings(), Pose(1.5, 1.6, 0.4))],
    ids=['held', 'fast', 'rolling', 'round', 'differential'])
def test_no_site_is_quicker_than_the_choice(robot, obj, settings, goal):
    """Solving all sites one by one finds the same time, and no bound is above the truth."""
    durations = one_by_one(obj, robot, goal, settings)
    choice = choose_site(obj, robot, HOME, goal, settings)
    assert choice.plan.trajectory.duration == pytest.approx(min(durations), rel=1e-9)
    assert len(choice.candidates) == len(durations)
    got = [option.duration for option in choice.candidates if option.duration is not None]
    assert got == sorted(got) and len(got) < len(durations)


def mirrored_feature(contact):
    """Reflect a vertex or a face of the box in the x axis."""
    return contact.kind, (3 if contact.kind == 'vertex' else 6) - contact.index


@pytest.mark.slow
@pytest.mark.parametrize('robot', [DIFFERENTIAL, HOLONOMIC], ids=lambda robot: robot.drive)
def test_the_mirror_image_is_pushed_from_the_mirrored_site(robot):
    """Object and goal are reflected in the x axis, and so is the choice."""
    goal = Pose(1.2, 0.8, 0.5)
    one = choose_site(box(friction=UNEVEN), robot, HOME, goal)
    other = choose_site(box(friction=UNEVEN[::-1]), robot, HOME,
                        Pose(goal.x, -goal.y, -goal.theta))
    kind, index = mirrored_feature(one.candidates[0].contact)
    reflected = other.candidates[0].contact
    assert (reflected.kind, reflected.index) == (kind, index % 4)
    x, y, heading = one.candidates[0].robot_pose
    assert other.candidates[0].robot_pose == pytest.approx((x, -y, -heading), abs=1e-9)
    assert other.candidates[0].duration == pytest.approx(one.candidates[0].duration, rel=1e-6)


@pytest.mark.parametrize('face', FACES)
@pytest.mark.parametrize('scene', [HOME, Pose(3.0, -1.0, 2.0)])
def test_a_goal_straight_ahead_of_a_face_is_pushed_there(face, scene):
    """From the opposite side, in the time that the way takes."""
    choice = choose_site(box(), HOLONOMIC, scene, scene @ FACES[face])
    first = choice.candidates[0]
    assert first.contact == Contact('face', face)
    assert first.path_length == pytest.approx(1.5, abs=1e-3)
    behind = scene.inverse() @ first.robot_pose
    assert distance(behind, Pose(*(-0.37 / 1.5 * c for c in FACES[face][:2]), 0.0)) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize('robot, obj, kinds', [
    (HOLONOMIC, box(), {'vertex': 4, 'face': 4}),
    (HOLONOMIC, box(friction=(0.6, 0.2, 0.2, 0.6)), {'vertex': 4, 'face': 6}),
    (DIFFERENTIAL, box(), {'vertex': 20, 'face': 4}),
    (HOLONOMIC, bin_(), {'round': 13})], ids=['box', 'uneven', 'differential', 'bin'])
def test_the_table_has_every_site_with_time_or_reason(robot, obj, kinds):
    """Robots touch the object there; with a plan there is a time, else a reason."""
    goal = Pose(1.5, 0.2, 0.1)
    choice = choose_site(obj, robot, HOME, goal)
    candidates = choice.candidates
    found = {kind: sum(option.contact.kind == kind for option in candidates) for kind in kinds}
    assert found == kinds
    assert len(candidates) == sum(kinds.values())
    for option in candidates:
        assert (option.duration is None) == (option.path_length is None) == bool(option.reason)
        found = problem_from_placement(obj, robot, HOME, option.robot_pose, goal,
                                       PlannerSettings(contact_tolerance=1e-9))
        assert (found.contact.kind, found.contact.index) == (
            option.contact.kind, option.contact.index)
    begin = choice.plan.trajectory.robot_poses[0]
    np.testing.assert_allclose(begin[:2], candidates[0].robot_pose[:2], atol=1e-9)


def test_a_differential_drive_starts_straight_behind_the_friction_centre():
    """The normal runs through the centre, which leaves the whole cone; the heading leads."""
    problems = [problem for problem in site_problems(box(), DIFFERENTIAL, HOME, FACES[0], AUTO)
                if problem.contact.kind == 'vertex']
    for problem in problems:
        assert problem.normal_offset == pytest.approx(0.0, abs=1e-9)
        assert abs(problem.heading_offset) < 0.7 * problem.planning_cone_angle
    assert len({round(problem.heading_offset, 6) for problem in problems}) == 5


@pytest.mark.parametrize('robot, obj, goal, reason', [
    (DIFFERENTIAL, bin_(), Pose(1.0, 0.0, 0.0), 'on a round contact is not supported'),
    (HOLONOMIC, box(), Pose(0.0, 0.0, 0.0), 'the object is at the goal already'),
    (HOLONOMIC, box(), Pose(math.nan, 0.0, 0.0), 'the goal is not finite'),
    (HOLONOMIC, box(), Pose(50.0, 0.0, 0.0), 'at most 20 m is accepted'),
    (HOLONOMIC, box(contact_friction_coefficient=0.0), FACES[0], 'contact has no friction')],
    ids=['round', 'there', 'nan', 'far', 'slippery'])
def test_where_all_sites_are_refused_the_least_bad_is_named(robot, obj, goal, reason):
    """The report has the table, each site with its reason."""
    with pytest.raises(PlanningFailed, match=reason) as failure:
        choose_site(obj, robot, HOME, goal)
    candidates = failure.value.report['sites']
    assert failure.value.reason == f'no feasible contact site; best candidate: {candidates[0]}'
    assert len(candidates) > 4 and all(option.reason for option in candidates)


def test_the_least_bad_site_is_the_one_that_came_nearest():
    """A vertex that is merely too far off goes before faces that can never be used."""
    with pytest.raises(PlanningFailed) as failure:
        choose_site(box(), DIFFERENTIAL, HOME, Pose(50.0, 50.0, 0.0))
    candidates = failure.value.report['sites']
    assert candidates[0].contact.kind == 'vertex' and 'a push of 7' in candidates[0].reason
    assert [option.contact.kind for option in candidates[-4:]] == ['face'] * 4


def test_objects_without_friction_and_fences_are_refused():
    """As where the robot is placed."""
    floating = dataclasses.replace(box(), supports=(Support(0.0, 0.0, 0.0),))
    with pytest.raises(PlanningFailed, match='friction 0 under every support'):
        choose_site(floating, HOLONOMIC, HOME, FACES[0])
    with pytest.raises(PlanningFailed, match='not for flat pushers'):
        choose_site(box(), RoundRobot(radius=math.inf, drive='holonomic'), HOME, FACES[0])


def plan_at(place, goal, settings=None):
    """Plan for a robot that stands there at rest."""
    return plan_from_measurements(box(), HOLONOMIC, ObjectPose(0.0, HOME),
                                  Odometry(0.0, place, STOP), goal, settings)


@pytest.mark.parametrize('place, sites', [(Pose(-0.37, 0.1, 0.0), 9), (Pose(-2.0, 0.0, 0.0), 8)],
                         ids=['beside a face', 'away'])
def test_the_settings_say_whether_the_robot_stays(place, sites):
    """Where it stands is one more site, if it stands at the object."""
    goal = Pose(0.0, 1.5, 0.0)
    choice = plan_at(place, goal, AUTO)
    assert len(choice.candidates) == sites
    assert choice.candidates[0].contact == Contact('face', 0)
    with pytest.raises(PlanningFailed):
        plan_at(place, goal)


def test_a_robot_that_stands_well_stays():
    """At the quickest site its own place is as quick, and the plan starts there."""
    goal = Pose(1.5, 0.3, 0.2)
    place = choose_site(box(), HOLONOMIC, HOME, goal).candidates[0].robot_pose
    stay, auto = (plan_at(place, goal, settings) for settings in (None, AUTO))
    assert stay.candidates == () and len(auto.candidates) == 9
    assert auto.plan.trajectory.duration == pytest.approx(stay.plan.trajectory.duration, rel=1e-9)
    assert auto.plan.trajectory.robot_poses[0] == pytest.approx(place, abs=1e-9)
