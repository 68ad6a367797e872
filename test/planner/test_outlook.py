"""Outlooks of plans, as fitted by the benchmark of stated chances."""

import operator

from helpers.objects import box
from push_model.geometry import Pose
from push_model.outlook import Outlook
from push_model.parameters import RoundRobot
from push_model.plan_request import GoalTolerances, PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.outlook import outlook_models, push_outlook, task_outlook, TimeQuantiles
from push_planner.settings import PlannerSettings
from push_planner.task_planner import plan_for_request
import pytest

TOLERANCES = GoalTolerances()


def outlook(size: float = 1.0, *, time: float = 20.0, is_in_map: bool = False) -> Outlook:
    """State how a task within tolerances ends: ``size`` times the usual ones."""
    tolerances = GoalTolerances(*(size * value for value in TOLERANCES))
    return task_outlook(time, tolerances, is_in_map=is_in_map, is_retry=False)


def test_lines_that_cross_never_let_a_higher_level_fall() -> None:
    """Nor is any of them negative."""
    lines = TimeQuantiles((-1.0, 0.0, 0.5, 1.0), (1.0, 0.2, 0.3, 0.1), (0.0, 0.0, 0.0, 2.0))
    assert lines.at(0.5) == pytest.approx((0.0, 0.1, 0.65, 1.05))
    assert lines.at(10.0, 1.0) == pytest.approx((9.0, 9.0, 9.0, 9.0))


@pytest.mark.parametrize('is_in_map', [False, True])
def test_no_error_of_a_task_that_is_done_exceeds_its_tolerance(is_in_map: bool) -> None:
    """At no level, however narrow or wide it is; the narrower, the smaller the error."""
    sizes = (0.1, 0.3, 0.5, 1.0, 2.0, 10.0)
    outlooks = [outlook(size, is_in_map=is_in_map) for size in sizes]
    for size, stated in zip(sizes, outlooks):
        assert 0.0 < stated.position_error.median <= stated.position_error.p99
        assert stated.position_error.p99 <= size * TOLERANCES.position
        assert stated.heading_error.p99 <= size * TOLERANCES.heading
    for narrow, wide in zip(outlooks, outlooks[1:]):
        assert all(map(operator.lt, narrow.position_error, wide.position_error))
        assert all(map(operator.lt, narrow.heading_error, wide.heading_error))


@pytest.mark.parametrize('is_in_map', [False, True])
def test_narrow_tolerances_of_a_task_take_longer_and_are_met_no_more_often(
        is_in_map: bool) -> None:
    """Be it the distance or the heading that is narrow."""
    outlooks = [outlook(size, is_in_map=is_in_map) for size in (0.3, 0.5, 1.0, 2.0)]
    for narrow, wide in zip(outlooks, outlooks[1:]):
        assert all(map(operator.ge, narrow.time, wide.time))
        assert narrow.chance <= wide.chance
    assert outlooks[0].time.median > 1.2 * outlooks[2].time.median
    sides = GoalTolerances(0.003, TOLERANCES.heading), GoalTolerances(TOLERANCES.position, 0.003)
    for tolerances in sides:
        assert task_outlook(20.0, tolerances, is_in_map=is_in_map, is_retry=False
                            ).time.median > outlooks[2].time.median


@pytest.mark.parametrize('is_in_map', [False, True])
def test_a_task_that_expects_more_time_is_stated_to_take_more(is_in_map: bool) -> None:
    """On open floor and in a map."""
    short, long = (outlook(time=time, is_in_map=is_in_map) for time in (10.0, 60.0))
    assert all(first < second for first, second in zip(short.time, long.time))
    assert short.chance == long.chance


def test_narrow_tolerances_of_a_single_push_are_met_more_seldom() -> None:
    """Down to none at all, and never above the share of pushes that end."""
    chances = [push_outlook(12.0, GoalTolerances(size, 2.0 * size)).chance
               for size in (0.0, 0.003, 0.006, 0.02, 1.0)]
    assert chances == sorted(chances) and chances[0] == 0.0
    assert 0.5 < chances[-1] <= outlook_models()['steered_push'].chance


def test_a_plan_states_its_outlook() -> None:
    """That of its expected time; its median is of that size."""
    request = PlanRequest(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.3, 0.0), Pose(0.5, 0.1, 0.2), box())
    robot = RoundRobot(0.17, 'holonomic', max_speed=0.3)
    plan = plan_for_request(request, robot, PlannerSettings(), DriveSettings())
    stated = plan.trajectory.outlook
    assert stated == task_outlook(plan.expected_time, request.tolerances, is_in_map=False,
                                  is_retry=False)
    assert stated is not None
    assert 0.4 < stated.time.median / plan.expected_time < 2.0
