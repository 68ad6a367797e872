"""Progress of a task: when it is done, when it has come nearer, and when it is aborted."""

import dataclasses
import math

from helpers.objects import box
from helpers.straight_pushes import straight_push
from push_control.behaviors.failures import BehaviorFailure, held_up
from push_control.behaviors.progress import (
    CAUTION_FACTOR, GoalCheck, MAP_FAILURES, MAP_TIME_LIMIT, MAX_HOLD_UPS, MAX_INSPECTIONS,
    MAX_SAFETY_STOPS, MAX_UNSEEN_AFTER_JUMP, MAX_UNSEEN_PUSHES, MIN_CONE_FRACTION,
    ProgressMonitor, REST_REPORT_TIME, REST_TIME_LIMIT, RestClock, WAYPOINT_DISTANCE,
    WAYPOINTS_PER_ATTEMPT)
from push_control.events import TaskEvent
from push_control.goal import TaskFailure
from push_control.perception.object_at_rest import ObjectAtRest
from push_control.settings import ControlSettings
from push_control.supervision_settings import aimed_tolerances, SupervisionSettings
from push_model.events import codes
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.trajectory import PushStyle
import pytest

SUPERVISION = SupervisionSettings()
AIM = SUPERVISION.position_tolerance, SUPERVISION.heading_tolerance
GOAL = Pose(1.0, -2.0, math.pi)
AT_GOAL = ObjectAtRest(GOAL, 0.5, 5e-4, 1e-3)
REQUEST = PlanRequest(Pose(0.0, 0.0, 0.0), Pose(2.0, 0.0, 0.0), GOAL, box())


def beside_goal(error):
    """Put the object beside its goal."""
    return AT_GOAL._replace(pose=GOAL._replace(y=GOAL.y + error))


def test_a_task_is_done_only_where_that_is_certain():
    """Near the tolerance more measurements are needed, but not for ever."""
    inside = SUPERVISION.position_tolerance - 5e-4
    edge = AT_GOAL._replace(pose=GOAL._replace(x=GOAL.x + inside))
    rotated = AT_GOAL._replace(pose=GOAL._replace(theta=-GOAL.theta + 0.1))
    monitor = ProgressMonitor(SUPERVISION, AIM)
    assert monitor.check_goal(AT_GOAL, GOAL) is GoalCheck.REACHED
    assert monitor.check_goal(edge, GOAL) is GoalCheck.UNCERTAIN
    late = edge._replace(duration=SUPERVISION.max_averaging_time)
    assert monitor.check_goal(late, GOAL) is GoalCheck.MISSED
    assert monitor.check_goal(rotated, GOAL) is GoalCheck.MISSED


@pytest.mark.parametrize('is_averaged, least_chance', [(False, 0.9953), (True, 0.9892)])
def test_a_task_seen_now_and_then_is_done_where_it_is_by_all_odds(is_averaged, least_chance):
    """By the chance that the tolerance holds, at least where further poses tell little."""
    settings = dataclasses.replace(SUPERVISION, view_angle=0.6)
    tolerance = settings.heading_tolerance
    error = 0.15 * tolerance
    duration = settings.max_averaging_time if is_averaged else 0.5
    for part in (0.0, 0.3, 0.59, 0.63, 0.64, 0.67, 0.7, 0.9, 1.1):
        seen = ObjectAtRest(GOAL._replace(theta=GOAL.theta + part * tolerance), duration, 5e-4,
                            error)
        chance = 0.5 + 0.5 * math.erf((1.0 - part) * tolerance / error / math.sqrt(2.0))
        check = ProgressMonitor(settings, AIM).check_goal(seen, GOAL)
        assert (check is GoalCheck.REACHED) == (chance > least_chance)
        assert is_averaged == (check is not GoalCheck.UNCERTAIN) or check is GoalCheck.REACHED


def test_errors_that_all_poses_have_alike_count_however_long_they_are_averaged() -> None:
    """As those of a camera that is mounted amiss; yet half the tolerance is always enough."""
    tolerance = SUPERVISION.position_tolerance
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for common, part, expected in ((0.15, 0.6, GoalCheck.REACHED), (0.15, 0.7, GoalCheck.MISSED),
                                   (0.0, 0.7, GoalCheck.REACHED), (2.0, 0.45, GoalCheck.REACHED),
                                   (2.0, 0.55, GoalCheck.MISSED)):
        averaged = beside_goal(part * tolerance)._replace(
            duration=SUPERVISION.max_averaging_time, common_position_error=common * tolerance)
        assert monitor.check_goal(averaged, GOAL) is expected


def test_noise_is_averaged_for_as_long_as_it_asks_for():
    """Longer than usual, but neither than the limit nor than until more would tell little."""
    noisy = AT_GOAL._replace(duration=SUPERVISION.max_averaging_time,
                             heading_error=0.4 * SUPERVISION.heading_tolerance)
    monitor = ProgressMonitor(SUPERVISION, AIM)
    assert monitor.check_goal(AT_GOAL._replace(heading_error=noisy.heading_error),
                              GOAL) is GoalCheck.UNCERTAIN
    assert monitor.check_goal(noisy, GOAL) is GoalCheck.UNCERTAIN
    assert monitor.averaging_report(noisy).values['limit'] == SUPERVISION.averaging_time_limit
    assert monitor.check_goal(noisy._replace(duration=SUPERVISION.averaging_time_limit),
                              GOAL) is GoalCheck.MISSED
    precise = noisy._replace(heading_error=0.16 * SUPERVISION.heading_tolerance)
    assert monitor.check_goal(precise, GOAL) is GoalCheck.REACHED
    rotated = GOAL._replace(theta=GOAL.theta + 0.7 * SUPERVISION.heading_tolerance)
    assert monitor.check_goal(precise._replace(pose=rotated), GOAL) is GoalCheck.MISSED
    assert monitor.averaging_report(AT_GOAL) is None


def test_what_noise_makes_of_the_error_is_no_progress():
    """An average that may be improved counts once it is."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for _ in range(SUPERVISION.max_attempts):
        monitor.check_goal(beside_goal(0.01)._replace(position_error=0.005), GOAL)
        monitor.count_attempt()
    assert monitor.abort_cause is not None


def test_attempts_count_from_the_last_progress():
    """It aborts after as many as allowed in a row, with the last failure."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for error in (0.5, 0.3):
        for _ in range(SUPERVISION.max_attempts - 1):
            monitor.check_goal(beside_goal(error), GOAL)
            monitor.count_attempt()
            assert monitor.abort_cause is None
    monitor.check_goal(beside_goal(0.4), GOAL)
    monitor.count_attempt(BehaviorFailure.OBJECT_NOT_MOVED.report())
    assert monitor.abort_cause.codes == (
        TaskEvent.ATTEMPTS_FAILED, BehaviorFailure.OBJECT_NOT_MOVED)


@pytest.mark.parametrize('error, rotation, is_biased', [
    (0.012, 0.0, False), (0.025, 0.01, False), (0.001, 0.04, False), (0.004, 0.0, True)])
def test_a_task_that_fails_near_its_goal_names_the_least_tolerances_that_would_do(
        error: float, rotation: float, is_biased: bool) -> None:
    """With them the same object is at its goal; with a little less it is not."""
    at_rest = beside_goal(error)._replace(duration=60.0, is_biased=is_biased)
    at_rest = at_rest._replace(pose=at_rest.pose._replace(theta=GOAL.theta + rotation))
    if is_biased:
        at_rest = at_rest._replace(position_error=0.006)
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.check_goal(beside_goal(0.4), GOAL)
    for _ in range(max(MAX_INSPECTIONS + 1, SUPERVISION.max_attempts)):
        monitor.check_goal(at_rest, GOAL)
        if is_biased:
            monitor.count_inspection(at_rest)
        else:
            monitor.count_attempt()
    cause = monitor.abort_cause
    assert cause is not None
    assert cause.code is (TaskEvent.GOAL_UNCERTAIN if is_biased else TaskEvent.NEARLY_DONE)
    named = (1e-3 * cause.values['position_tolerance'],
             math.radians(cause.values['heading_tolerance']))
    for reduction, expected in ((0.0, True), (0.11, False)):
        # Of each tolerance that is not the one of the task.
        position, heading = (
            value - reduction * step if value > own else own for value, step, own in
            zip(named, (1e-3, math.radians(1.0)), AIM))
        wider = dataclasses.replace(SUPERVISION, position_tolerance=position,
                                    heading_tolerance=heading)
        check = ProgressMonitor(wider, AIM).check_goal(at_rest, GOAL)
        assert (check is GoalCheck.REACHED) == expected


def test_a_task_that_fails_far_from_its_goal_names_no_tolerances() -> None:
    """Nobody would call that done."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for _ in range(SUPERVISION.max_attempts):
        monitor.check_goal(beside_goal(0.4), GOAL)
        monitor.count_attempt()
    assert monitor.abort_cause is not None
    assert monitor.abort_cause.code is TaskEvent.ATTEMPTS_USED_UP


def test_stops_by_the_safety_layer_count_from_the_last_progress():
    """A long task is not ended by what it has got over each time, a fault that lasts ends it."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for error in (0.5, 0.3, 0.1):
        monitor.check_goal(beside_goal(error), GOAL)
        for _ in range(MAX_SAFETY_STOPS - 1):
            assert not monitor.count_safety_stop()
            monitor.check_goal(beside_goal(0.99 * error), GOAL)
    assert monitor.count_safety_stop()


@pytest.mark.parametrize('error, is_progress', [(0.2, True), (0.49, False), (0.6, False)])
def test_a_push_that_brings_the_object_nearer_is_progress_at_once(error, is_progress):
    """Stops before it do not count for the way from there, where the object was not averaged."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.check_goal(beside_goal(0.5), GOAL)
    for _ in range(MAX_SAFETY_STOPS - 1):
        assert not monitor.count_safety_stop()
    plan = straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.1)
    monitor.count_finished_push(plan, beside_goal(error).pose, GOAL)
    assert monitor.count_safety_stop() != is_progress


def test_pushes_to_waypoints_as_planned_are_no_failures():
    """A long detour of them is neither aborted nor planned with more caution; a circle is."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for number in range(30):
        monitor.check_goal(beside_goal(0.3 + 0.1 * number), GOAL)
        monitor.count_waypoint()
        assert monitor.abort_cause is None
    for _ in range(WAYPOINTS_PER_ATTEMPT * SUPERVISION.max_attempts):
        monitor.count_waypoint()
    assert monitor.abort_cause.code is TaskEvent.ATTEMPTS_USED_UP


def test_an_object_that_goes_a_long_distance_round_makes_progress():
    """Its expected time falls while its error rises; where neither falls, the task is aborted."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    count = 2 * SUPERVISION.max_attempts
    for number in range(count):
        monitor.check_goal(beside_goal(0.1 + 0.02 * number), GOAL, 100.0 * 0.85 ** number)
        monitor.count_attempt()
        assert monitor.abort_cause is None
    for _ in range(SUPERVISION.max_attempts):
        monitor.check_goal(beside_goal(1.0), GOAL, 100.0)
        monitor.count_attempt()
    assert monitor.abort_cause is not None


def test_plans_become_more_careful_without_progress():
    """The cone fraction falls every other attempt, to its minimum, and recovers with progress."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.check_goal(beside_goal(0.5), GOAL)
    fractions = []
    for _ in range(12):
        fractions.append(monitor.cone_fraction)
        monitor.count_attempt()
    assert fractions[:4] == [1.0, 1.0, CAUTION_FACTOR, CAUTION_FACTOR]
    assert fractions == sorted(fractions, reverse=True) and fractions[-1] == MIN_CONE_FRACTION
    monitor.check_goal(beside_goal(0.1), GOAL)
    assert monitor.cone_fraction == 1.0


@pytest.mark.parametrize('code, request_, aborts', [
    (PlanFailure.TIPS, REQUEST, True), (PlanFailure.NO_FEASIBLE_SITE, REQUEST, False),
    (PlanFailure.TIPS, REQUEST._replace(robot_pose=Pose(2.2, 0.0, 0.0)), False),
    (PlanFailure.TIPS, REQUEST._replace(object_pose=Pose(0.0, 0.0, 0.5)), False)])
def test_the_same_planning_failure_twice_from_the_same_poses_aborts(code, request_, aborts):
    """Whatever numbers its sentence has; not another failure, nor one from elsewhere."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.on_planning_failed(REQUEST, PlanFailure.TIPS, 'a wall 1.03 m high', 0.0)
    assert monitor.abort_cause is None
    monitor.on_planning_failed(request_, code, 'a wall 1.02 m high', 1.0)
    assert (monitor.abort_cause is not None) == aborts
    assert not aborts or monitor.abort_cause.codes == (TaskEvent.PLANNING_FAILED_AGAIN, code)
    monitor.forget_planning_failures()
    assert monitor.abort_cause is None


def test_a_plan_that_cannot_be_used_tells_nothing_of_the_poses() -> None:
    """However often; a failure to plan from there still counts from before."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.on_planning_failed(REQUEST, PlanFailure.TIPS, 'too high', 0.0)
    for time in (1.0, 2.0, 3.0):
        monitor.on_planning_failed(REQUEST, PlanFailure.INVALID_PLAN, 'begins elsewhere', time)
        assert monitor.abort_cause is None
    monitor.on_planning_failed(REQUEST, PlanFailure.TIPS, 'too high', 4.0)
    assert monitor.abort_cause is not None


@pytest.mark.parametrize('code', MAP_FAILURES)
@pytest.mark.parametrize('map_period', [1, 4, 100])
def test_a_map_that_lets_the_object_through_is_waited_for(
        code: PlanFailure, map_period: int) -> None:
    """However many others come before it; that is no attempt, and over after a while."""
    monitor, time, requests = ProgressMonitor(SUPERVISION, AIM), 0, 0
    monitor.check_goal(beside_goal(0.5), GOAL)
    while monitor.abort_cause is None:
        assert time <= MAP_TIME_LIMIT
        if not monitor.awaits_map(REQUEST, time):
            requests += 1
            monitor.on_planning_failed(REQUEST, code, 'a wall', time)
        time += 1
        if time % map_period == 0:
            monitor.forget_planning_failures()
    assert time > MAP_TIME_LIMIT and monitor.abort_cause.codes == (
        TaskEvent.PLANNING_FAILED_FOR_LONG, code)
    # Twice in each map, and once more at last.
    assert requests <= 2 * (time // map_period + 1) + 1
    assert monitor.cone_fraction == 1.0 and monitor.failure is TaskFailure.NO_PLAN


def test_the_wait_for_a_map_ends_with_a_plan_or_where_the_object_is_elsewhere() -> None:
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for time in (0.0, 1.0):
        monitor.on_planning_failed(REQUEST, PlanFailure.NOT_FREE, 'a wall', time)
    assert monitor.awaits_map(REQUEST, 2.0)
    assert not monitor.awaits_map(REQUEST._replace(object_pose=Pose(0.3, 0.0, 0.0)), 2.0)
    monitor.on_plan()
    assert not monitor.awaits_map(REQUEST, 3.0)
    monitor.on_planning_failed(REQUEST, PlanFailure.NOT_FREE, 'a wall', 2.0 * MAP_TIME_LIMIT)
    assert monitor.abort_cause is None


def test_an_object_with_biased_poses_is_seen_from_other_sides():
    """Within what pushes aim at, no push helps; after some looks the task fails, with numbers."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    biased = AT_GOAL._replace(position_error=SUPERVISION.position_tolerance, is_biased=True)
    for _ in range(MAX_INSPECTIONS):
        assert monitor.check_goal(biased, GOAL) is GoalCheck.UNSEEN
        monitor.count_inspection(biased)
        assert monitor.abort_cause is None
    monitor.count_inspection(biased)
    assert monitor.abort_cause.code is TaskEvent.GOAL_UNCERTAIN
    assert monitor.abort_cause.values['position'] == pytest.approx(10.0)
    beside = biased._replace(pose=GOAL._replace(y=GOAL.y + 0.02))
    assert monitor.check_goal(beside, GOAL) is GoalCheck.MISSED


def test_tolerances_that_pushes_aim_at_leave_room_for_the_bias():
    """All of them where there is none, and half of them at least."""
    assert aimed_tolerances(ControlSettings(), SUPERVISION) == AIM
    biases = [aimed_tolerances(ControlSettings(pose_bias=bias), SUPERVISION)[0]
              for bias in (0.0, 0.002, 0.004, 0.1)]
    assert biases == sorted(biases, reverse=True) and biases[1] < biases[0]
    assert biases[-1] == 0.5 * SUPERVISION.position_tolerance


@pytest.mark.parametrize('degrees, part', [(0.3, 1.0), (1.0, 1.0), (1.5, 0.5), (3.0, 0.5)])
def test_pushes_aim_at_what_noise_leaves_of_the_tolerance(degrees, part):
    """At half of it where averages take long, and at all of it with usual noise."""
    control = ControlSettings(heading_noise=math.radians(degrees))
    position, heading = aimed_tolerances(control, SUPERVISION)
    assert position == SUPERVISION.position_tolerance
    assert heading == pytest.approx(part * SUPERVISION.heading_tolerance)


def test_strict_tolerances_are_aimed_at_as_a_whole_with_the_usual_noise():
    """Half of 0.3 degrees would be asked of pushes that cannot do it."""
    strict = dataclasses.replace(SUPERVISION, position_tolerance=0.003,
                                 heading_tolerance=math.radians(0.3))
    control = ControlSettings(pose_noise=0.002, heading_noise=math.radians(0.3))
    assert aimed_tolerances(control, strict) == (0.003, math.radians(0.3))


def test_a_finished_push_is_a_waypoint_only_where_its_plan_ends():
    """Such a push elsewhere, and any other one anywhere, counts as an attempt."""
    plan = straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.1)
    end = Pose(*plan.object_poses[-1].tolist())
    off = end @ Pose(WAYPOINT_DISTANCE + 0.01, 0.0, 0.0)
    waypoint = dataclasses.replace(plan, style=PushStyle.WAYPOINT)
    for push, pose, attempts in ((waypoint, end, 0), (waypoint, off, 2), (plan, end, 2)):
        monitor = ProgressMonitor(SUPERVISION, AIM)
        for _ in range(2):
            monitor.count_finished_push(push, pose)
        assert (monitor.cone_fraction < 1.0) is (attempts == 2)


def test_long_waits_for_rest_add_up_until_the_next_push():
    """Short ones do not count; a push clears them."""
    clock = RestClock()
    for start in (0.0, 100.0):
        clock.wait(start)
        clock.wait(start + REST_REPORT_TIME)
        assert not clock.is_long
        clock.end_wait()
    for start in (200.0, 300.0):
        clock.wait(start)
        clock.wait(start + 0.5 * REST_TIME_LIMIT + 1.0)
        assert clock.is_long and clock.is_too_long is (start == 300.0)
        clock.end_wait()
        assert not clock.is_long and not clock.is_too_long
    monitor = ProgressMonitor(SUPERVISION, AIM)
    used = monitor.rest_clock
    monitor.count_push(repeats_pose=False)
    assert monitor.rest_clock is not used


@pytest.mark.parametrize('is_pushed_well', [False, True])
def test_only_a_push_that_ends_well_forgives_wheels_that_have_spun(is_pushed_well):
    """An object that came nearer before they spun may be too heavy all the same."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.check_goal(beside_goal(0.5), GOAL)
    stall = BehaviorFailure.BASE_STALLS.report()
    assert not monitor.count_spin(stall)
    assert monitor.last_spin is stall
    if is_pushed_well:
        end = beside_goal(0.3).pose
        monitor.count_finished_push(straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.1), end,
                                    GOAL)
    monitor.check_goal(beside_goal(0.3), GOAL)
    assert (monitor.last_spin is None) == is_pushed_well
    assert monitor.count_spin(stall) != is_pushed_well


@pytest.mark.parametrize('is_pushed_on', [False, True])
def test_an_object_that_is_held_up_three_times_ends_a_task(is_pushed_on):
    """Unless a push between them ends well, and brings it nearer."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    monitor.check_goal(beside_goal(0.5), GOAL)
    hold_up = held_up(is_in_map=False)
    for _ in range(MAX_HOLD_UPS - 1):
        monitor.count_hold_up(hold_up)
        # It has come nearer until then, which tells nothing of the next push.
        monitor.check_goal(beside_goal(0.3), GOAL)
        assert monitor.abort_cause is None and monitor.hold_up is hold_up
    if is_pushed_on:
        monitor.count_finished_push(straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.1),
                                    beside_goal(0.2).pose, GOAL)
        monitor.check_goal(beside_goal(0.1), GOAL)
    monitor.count_hold_up(hold_up)
    assert (monitor.abort_cause is None) == is_pushed_on
    if not is_pushed_on:
        assert codes(monitor.abort_cause) == (TaskEvent.ABORTED, BehaviorFailure.HELD_UP)
        assert monitor.failure is TaskFailure.NO_PROGRESS


def test_a_base_that_stalls_at_what_it_has_pushed_is_not_too_weak():
    """Something holds the object up; before the first push it may be too heavy."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    assert monitor.hold_up is None
    plan = straight_push(box(), Pose(-0.37, 0.0, 0.0), 0.3)
    monitor.count_finished_push(plan, Pose(0.02, 0.0, 0.0))
    assert monitor.hold_up is None
    monitor.count_finished_push(plan, Pose(0.25, 0.0, 0.0))
    assert monitor.hold_up.code is BehaviorFailure.HELD_UP


def test_pushes_that_leave_the_pose_to_the_last_digit_end_a_task():
    """Only some in a row: the tracker is frozen, or the robot pushes elsewhere."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for repeats in (*[True] * (MAX_UNSEEN_PUSHES - 1), False, *[True] * (MAX_UNSEEN_PUSHES - 1)):
        monitor.count_push(repeats_pose=repeats)
        assert monitor.abort_cause is None and monitor.failure is None
    monitor.count_push(repeats_pose=True)
    assert monitor.abort_cause.code is TaskEvent.PUSHES_UNSEEN
    assert monitor.failure is TaskFailure.NO_MEASUREMENTS


def test_after_a_jump_of_the_poses_fewer_such_pushes_end_a_task() -> None:
    """Poses that are frozen elsewhere show themselves sooner; one push may still miss."""
    monitor = ProgressMonitor(SUPERVISION, AIM)
    for _ in range(MAX_UNSEEN_AFTER_JUMP - 1):
        monitor.count_push(repeats_pose=True, have_poses_jumped=True)
        assert monitor.abort_cause is None
    monitor.count_push(repeats_pose=True, have_poses_jumped=True)
    assert monitor.abort_cause.values['count'] == MAX_UNSEEN_AFTER_JUMP < MAX_UNSEEN_PUSHES
