"""Outlooks of plans, as fitted by the benchmark of stated chances."""

from helpers.objects import box
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import GoalTolerances, PlanRequest
from push_navigation.settings import DriveSettings
from push_planner.outlook import outlook_models, push_outlook, QuantileLines, task_outlook
from push_planner.settings import PlannerSettings
from push_planner.task_planner import plan_for_request
import pytest

TOLERANCES = GoalTolerances()


def test_lines_that_cross_never_let_a_higher_level_fall() -> None:
    """Nor is any of them negative."""
    lines = QuantileLines((-1.0, 0.0, 0.5, 1.0), (1.0, 0.2, 0.3, 0.1))
    assert lines.at(0.5) == pytest.approx((0.0, 0.1, 0.65, 1.05))
    assert lines.at(10.0) == pytest.approx((9.0, 9.0, 9.0, 9.0))


@pytest.mark.parametrize('is_in_map', [False, True])
def test_a_task_that_expects_more_time_is_stated_to_take_more(is_in_map: bool) -> None:
    """On open floor and in a map."""
    short, long = (task_outlook(time, TOLERANCES, is_in_map=is_in_map, is_retry=False)
                   for time in (10.0, 60.0))
    assert all(first < second for first, second in zip(short.time, long.time))
    assert short.chance == long.chance


def test_narrow_tolerances_of_a_single_push_are_met_more_seldom() -> None:
    """Down to none at all, and never above the share of pushes that end."""
    chances = [push_outlook(12.0, 2.0, GoalTolerances(size, 2.0 * size)).chance
               for size in (0.0, 0.003, 0.006, 0.02, 1.0)]
    assert chances == sorted(chances) and chances[0] == 0.0
    assert 0.5 < chances[-1] <= outlook_models()['steered_push'].chance


def test_a_plan_states_its_outlook() -> None:
    """That of its expected time; its median is of that size."""
    request = PlanRequest(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.3, 0.0), Pose(0.5, 0.1, 0.2), box())
    robot = RoundRobot(0.17, 'holonomic', max_speed=0.3)
    plan = plan_for_request(request, robot, PlannerSettings(), DriveSettings())
    outlook = plan.trajectory.outlook
    assert outlook == task_outlook(plan.expected_time, request.tolerances, is_in_map=False,
                                   is_retry=False)
    assert outlook is not None
    assert 0.4 < outlook.time.median / plan.expected_time < 2.0
