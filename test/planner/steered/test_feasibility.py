"""Problems that the planner accepts, and the reasons for which it refuses others."""

import dataclasses
import math
import pickle
import re
from typing import Callable

from helpers.objects import bin_, box
from helpers.push_problems import (
    DIFFERENTIAL, face_problem, HOLONOMIC, round_problem, vertex_problem)
from push_model.geometry import Pose
from push_model.parameters import Contact, PushedObject, RoundRobot, Support
from push_model.plan_request import GoalTolerances, PlanFailure
from push_planner.problem import (
    PlannerSettings, PlanningFailed, problem_from_placement, PushProblem)
from push_planner.steered import assembly
from push_planner.steered.feasibility import check_feasibility, check_not_at_goal
from push_planner.steered.integration.refinement import refine
from push_planner.steered.planner import plan_push
import pytest

AHEAD = Pose(1.5, 0.3, -0.6)


@pytest.mark.parametrize('field, value', [
    ('pushing_speed', 0.0), ('pushing_speed', math.nan), ('segments', 1), ('segments', 10.5),
    ('cone_margin', 1.2), ('final_straight', -0.1), ('friction_discount', 0.0),
    ('max_path_length', 'far')])
def test_settings_out_of_range_are_refused_by_name(field, value):
    """The error names the field and what came."""
    with pytest.raises(ValueError, match=f'PlannerSettings.{field}: got {value!r}'):
        PlannerSettings(**{field: value})


@pytest.mark.parametrize('turn', [0.0, 2.0, -3.0])
def test_a_placement_is_read_off_the_poses(turn):
    """The contact, its normal and the robot's heading, wherever the whole scene stands."""
    scene = Pose(3.0, -1.0, turn)
    away = 0.2 * math.sqrt(2.0) + 0.17 + 0.01
    robot_pose = scene @ Pose(-away, 0.0, 0.1)
    problem = problem_from_placement(box(), DIFFERENTIAL, scene @ Pose(0.0, 0.0, -math.pi / 4),
                                     robot_pose, scene @ AHEAD)
    assert (problem.contact.kind, problem.contact.index) == ('vertex', 0)
    assert problem.normal_offset == pytest.approx(0.0, abs=1e-9)
    assert problem.heading_offset == pytest.approx(-0.1)
    assert problem.vehicle.arm == pytest.approx(0.2 * math.sqrt(2.0))


@pytest.mark.parametrize('robot_x, word', [(-0.5, 'away from'), (-0.3, 'inside')])
def test_a_robot_apart_from_the_object_is_refused(robot_x, word):
    """The reason tells how far it is off."""
    with pytest.raises(PlanningFailed) as failure:
        problem_from_placement(box(), HOLONOMIC, Pose(0.0, 0.0, 0.0), Pose(robot_x, 0.0, 0.0),
                               AHEAD)
    off = abs(abs(robot_x) - 0.37)
    assert f'it is {off:.3f} m {word} it' in failure.value.reason
    assert abs(failure.value.report['gap']) == pytest.approx(off)


@pytest.mark.parametrize('name', ['object pose', 'robot pose', 'goal'])
def test_poses_that_are_not_finite_are_refused(name):
    """The reason names the pose."""
    poses = {'object pose': Pose(0.0, 0.0, 0.0), 'robot pose': Pose(-0.37, 0.0, 0.0),
             'goal': AHEAD}
    poses[name] = Pose(0.0, math.nan, 0.0)
    with pytest.raises(PlanningFailed, match=f'the {name} is not finite'):
        problem_from_placement(box(), HOLONOMIC, *poses.values())


def slippery(mu):
    return vertex_problem(AHEAD, obj=box(contact_friction_coefficient=mu))


def frictionless_floor():
    obj = PushedObject(mass=1.0, inertia=0.1, supports=[Support(0.0, 0.0, 0.0)],
                       outline=box().outline)
    return vertex_problem(AHEAD, obj=obj)


def wrong_side():
    """Ask for a push along the face, not into it."""
    return dataclasses.replace(face_problem(AHEAD), normal=2.0)


IMPOSSIBLE = {
    'goal nan': (vertex_problem(Pose(math.nan, 0.0, 0.0)), PlanFailure.INVALID_VALUE,
                 'goal is not finite'),
    'goal infinite': (vertex_problem(Pose(0.0, math.inf, 0.0)), PlanFailure.INVALID_VALUE,
                      'goal is not finite'),
    'at the goal': (vertex_problem(Pose(0.001, 0.0, 2 * math.pi - math.pi / 4)),
                    PlanFailure.AT_GOAL, 'at the goal already: 1.0 mm and 0.00 deg off'),
    'slippery contact': (slippery(0.0), PlanFailure.NO_CONTACT_FRICTION,
                         'a frictionless contact cannot steer'),
    'slippery floor': (frictionless_floor(), PlanFailure.NO_SUPPORT_FRICTION,
                       'friction 0 under every support'),
    'too fast': (vertex_problem(AHEAD, pushing_speed=0.6), PlanFailure.ROBOT_TOO_SLOW,
                 '0.6 m/s is faster .* 0.5 m/s'),
    'face': (face_problem(AHEAD, DIFFERENTIAL), PlanFailure.UNSUPPORTED_CONTACT,
             'on a face contact .* place the robot at a vert'),
    'round': (round_problem(AHEAD, DIFFERENTIAL), PlanFailure.UNSUPPORTED_CONTACT,
              'on a round contact'),
    'facing away': (vertex_problem(AHEAD, heading=2.0), PlanFailure.FACING_AWAY,
                    'points away from the object: .* 115 deg'),
    'askew': (vertex_problem(AHEAD, heading=0.3), PlanFailure.ONE_SIDED_STEERING,
              'heads 17.2 deg off .* to one side only'),
    'jackknifed': (vertex_problem(AHEAD, normal=0.5, heading=0.5), PlanFailure.JACKKNIFED,
                   'jackknife: its normal is 28.6 deg'),
    'off centre': (face_problem(AHEAD, offset=0.1), PlanFailure.ONE_SIDED_STEERING,
                   'cannot steer to both sides: .* 26.6 deg off'),
    'wrong side': (wrong_side(), PlanFailure.WRONG_SIDE, 'wrong side: .* 115 deg off'),
    'too far': (vertex_problem(Pose(30.0, 0.0, 0.0)), PlanFailure.PATH_TOO_LONG,
                r'a push of 3\d.\d m, at most 20 m'),
    'sideways': (vertex_problem(Pose(0.0, 0.05, -math.pi / 4), max_path_length=3.0),
                 PlanFailure.PATH_TOO_LONG, r'a push of \d+.\d m, at most 3 m'),
    'too sharp': (vertex_problem(AHEAD, robot=RoundRobot(radius=0.17, max_yaw_rate=0.02),
                                 pushing_speed=0.3),
                  PlanFailure.LIMIT_EXCEEDED,
                  r'on \d+ routes, .* the yaw rate of the robot would be exceeded'),
    'too wide': (face_problem(AHEAD, pushing_speed=0.5), PlanFailure.LIMIT_EXCEEDED,
                 'the speed of the robot would be exc'),
    'too tight': (vertex_problem(Pose(1.08, 0.06, -0.91), max_path_length=5.0),
                  PlanFailure.LIMIT_EXCEEDED, 'the friction cone would be exceeded'),
}


SLOW = ('too sharp', 'too wide', 'too tight')


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in IMPOSSIBLE])
def test_the_impossible_is_refused_with_its_reason(name):
    """A code for programs, and one sentence with the numbers for people."""
    problem, code, reason = IMPOSSIBLE[name]
    with pytest.raises(PlanningFailed, match=reason) as failure:
        plan_push(problem)
    assert failure.value.code is code
    assert failure.value.reason == str(failure.value)
    assert '\n' not in failure.value.reason


def _turned(problem: PushProblem, turn: float) -> PushProblem:
    return dataclasses.replace(problem, heading=problem.heading + turn)


def _moved_round(problem: PushProblem, change: float) -> PushProblem:
    return dataclasses.replace(_turned(problem, change), normal=problem.normal + change)


def _shifted(problem: PushProblem, shift: float) -> PushProblem:
    offset = problem.contact.offset
    return dataclasses.replace(problem, contact=dataclasses.replace(
        problem.contact, offset=offset - math.copysign(shift, offset)))


def _rotated(problem: PushProblem, rotation: float) -> PushProblem:
    return dataclasses.replace(problem, goal=problem.goal @ Pose(0.0, 0.0, rotation))


def _gripped(problem: PushProblem, friction: float) -> PushProblem:
    return dataclasses.replace(problem, obj=dataclasses.replace(
        problem.obj, contact_friction_coefficient=friction))


def _slowed(problem: PushProblem, speed: float) -> PushProblem:
    return dataclasses.replace(problem, settings=dataclasses.replace(
        problem.settings, pushing_speed=speed))


Change = Callable[[PushProblem, float], PushProblem]
CHANGES: list[tuple[PushProblem, str, Change]] = [
    (vertex_problem(AHEAD, heading=2.0), 'turn', _turned),
    (vertex_problem(AHEAD, heading=-0.3), 'turn', _turned),
    (vertex_problem(AHEAD, normal=0.5, heading=0.5), 'normal', _moved_round),
    (vertex_problem(AHEAD, normal=-0.5, heading=-0.45), 'normal', _moved_round),
    (face_problem(AHEAD, offset=0.1), 'shift', _shifted),
    (face_problem(AHEAD, offset=-0.1), 'shift', _shifted),
    (face_problem(AHEAD, offset=0.05), 'contact_friction', _gripped),
    (slippery(0.0), 'contact_friction', _gripped),
    (slippery(0.02), 'contact_friction', _gripped),
    (_gripped(face_problem(AHEAD, offset=0.05), 0.0), 'contact_friction', _gripped),
    (vertex_problem(AHEAD, pushing_speed=0.6), 'pushing_speed', _slowed),
    (face_problem(Pose(1.5, 0.3, 1.7), robot_yaw='fixed'), 'rotation', _rotated),
    (face_problem(Pose(1.5, 0.3, -2.9), robot_yaw='fixed'), 'rotation', _rotated)]
# Name of a number -> how sentences tell it, and its unit.
SENTENCES = {'turn': (r'turned by (.*) deg to the (left|right) it', math.radians(1.0)),
             'normal': (r'turned by (.*) deg to the (left|right) about', math.radians(1.0)),
             'shift': (r'(\d+)() mm nearer to the centre of friction', 1e-3),
             'contact_friction': (r'with a contact friction of ([\d.]+)() it', 1.0),
             'rotation': (r'a goal rotated by ([+-][\d.]+)() deg beside', math.radians(1.0))}


@pytest.mark.parametrize('problem, name, change', CHANGES)
def test_the_least_change_that_a_refusal_names_does_and_less_does_not(
        problem: PushProblem, name: str, change: Change) -> None:
    with pytest.raises(PlanningFailed) as failure:
        check_feasibility(problem)
    needed = failure.value.report[name]
    less, more = (0.99, 1.01) if name != 'pushing_speed' else (1.01, 0.99)
    check_feasibility(change(problem, more * needed))
    with pytest.raises(PlanningFailed):
        check_feasibility(change(problem, less * needed))


@pytest.mark.parametrize('problem, name, change', [
    case for case in CHANGES if case[1] in SENTENCES])
def test_what_the_sentence_of_a_refusal_tells_to_do_is_accepted(
        problem: PushProblem, name: str, change: Change) -> None:
    """Numbers are rounded, but never to less than is needed."""
    with pytest.raises(PlanningFailed) as failure:
        check_feasibility(problem)
    pattern, unit = SENTENCES[name]
    told = re.search(pattern, failure.value.reason)
    assert told is not None
    sign = -1.0 if told[2] == 'right' else 1.0
    check_feasibility(change(problem, sign * unit * float(told[1])))


def beside_a_vertex() -> PushProblem:
    """Push at an obtuse vertex, whose normals are far off the centre of friction."""
    outline = ((-0.2, 0.0), (0.0, -0.05), (0.4, -0.05), (0.4, 0.3), (0.0, 0.3))
    supports = [Support(x, y, 0.3) for x, y in ((0.3, 0.0), (0.35, 0.0), (0.3, 0.1))]
    obj = PushedObject(mass=1.0, inertia=0.1, supports=tuple(supports), outline=outline,
                       center_of_mass=(0.315, 0.03))
    return PushProblem(obj, DIFFERENTIAL, Contact('vertex', 1), Pose(0.0, 0.0, 0.0), 1.4, 1.4,
                       AHEAD)


@pytest.mark.parametrize('problem, code', [
    (vertex_problem(AHEAD, heading=2.0, obj=box(contact_friction_coefficient=0.02)),
     PlanFailure.FACING_AWAY),
    (vertex_problem(AHEAD, heading=2.0, obj=box(contact_friction_coefficient=0.0)),
     PlanFailure.NO_CONTACT_FRICTION),
    (beside_a_vertex(), PlanFailure.JACKKNIFED)], ids=['away', 'frictionless', 'obtuse'])
def test_a_refusal_names_no_change_where_none_of_its_kind_would_do(
        problem: PushProblem, code: PlanFailure) -> None:
    """No friction turns a robot round, and no turn about a vertex goes beyond its faces."""
    with pytest.raises(PlanningFailed) as failure:
        check_feasibility(problem)
    assert failure.value.code is code
    assert not failure.value.report and 'it could' not in failure.value.reason


def test_a_bin_has_no_vertices():
    """A placement at a bin is a round contact."""
    problem = problem_from_placement(bin_(), HOLONOMIC, Pose(1.0, 0.0, 0.5),
                                     Pose(1.0, -0.37, math.pi / 2), Pose(1.0, 1.0, 0.5))
    assert problem.contact.kind == 'round'
    assert problem.normal == pytest.approx(math.pi / 2)
    assert problem.normal_offset == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('spoilt', [
    {'least_length': -0.1}, {'least_v_squared': -0.1}, {'total': math.nan}, {'total': math.inf}],
    ids=str)
def test_an_integration_that_breaks_down_is_no_plan(monkeypatch, spoilt):
    """Refinement may run away; that is refused with a reason, not raised as another error."""
    def run_away(*arguments):
        refined = refine(*arguments)
        return refined and refined._replace(checks=refined.checks._replace(**spoilt))

    monkeypatch.setattr(assembly, 'refine', run_away)
    with pytest.raises(PlanningFailed, match='the fine integration broke down') as failure:
        plan_push(vertex_problem(AHEAD))
    assert failure.value.code is PlanFailure.NOT_ACCEPTED


def test_a_failure_survives_pickling():
    """As it comes back from another process: code, reason and report."""
    failure = PlanningFailed(PlanFailure.PATH_TOO_LONG, 'too long', {'path_length': 3.0})
    again = pickle.loads(pickle.dumps(failure))
    assert (again.code, again.reason, again.report) == (failure.code, 'too long', failure.report)


@pytest.mark.parametrize('share, is_there', [(0.9, True), (1.1, False)])
def test_a_goal_within_the_tolerances_asked_for_needs_no_push(share, is_there):
    """Of position and heading alike; any heading will do where that is free."""
    tolerances, start = GoalTolerances(0.03, 0.05), Pose(1.0, 2.0, 3.0)
    for offset in (Pose(share * 0.03, 0.0, 0.0), Pose(0.0, 0.0, share * 0.05)):
        if is_there:
            with pytest.raises(PlanningFailed) as failure:
                check_not_at_goal(start, start @ offset, PlannerSettings(), tolerances)
            assert failure.value.code is PlanFailure.AT_GOAL
        else:
            check_not_at_goal(start, start @ offset, PlannerSettings(), tolerances)
        # Without tolerances, as accurately as plans are.
        check_not_at_goal(start, start @ offset, PlannerSettings())
    with pytest.raises(PlanningFailed):
        check_not_at_goal(start, start @ Pose(0.01, 0.0, 2.0), PlannerSettings(heading_free=True),
                          tolerances)
