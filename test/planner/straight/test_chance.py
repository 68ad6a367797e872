"""Chance of a goal from which no push leads back: a bound, limits, and the pushes that follow."""

import itertools
import math

from helpers.maps import walled_room
from helpers.objects import box
import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.plan_request import PlanRequest
from push_model.trajectory import PushStyle
from push_navigation.settings import DriveSettings
from push_planner.settings import PlannerSettings
from push_planner.straight.map_search.chance import (
    CORRECTED_RATIO, FAILURE_COST, failure_cost, FREE_RISK)
from push_planner.straight.map_search.planner import MapPlan, plan_push_in_map
from push_planner.straight.map_search.problem import Lattice, Query, SearchSettings
import pytest

ERROR = 0.01
SETTINGS = SearchSettings(0.007, 0.012, accepted_error=ERROR, open_radius=1.0, contact_time=4.0,
                          pushing_speed=0.2, robot_speed=0.3)
ORIGIN = Pose(0.0, 0.0, 0.0)
QUERY = Query(ORIGIN, ORIGIN, ORIGIN, SETTINGS, Lattice(0.18, 12, 0.0), 0.02, 1.0, 0.0,
              is_goal_enclosed=True, closing_time=0.0, max_expansions=1, max_work=1, half=1,
              first_half=1)


def risk(miss: float, std: float, remaining: float = 0.0) -> float:
    """Return the chance of a miss that is charged [1]."""
    return failure_cost(QUERY, miss, std, remaining) / FAILURE_COST


@pytest.mark.parametrize('miss, std', [(0.0, 0.006), (0.0, 0.009), (0.6, 0.004), (1.0, 0.002)])
def test_no_more_pushes_miss_than_are_charged(miss: float, std: float) -> None:
    """Of drawn ends, those farther off than the error that is accepted; without miss as many."""
    ends = np.random.default_rng(5).normal(scale=std, size=(20000, 2))
    ends[:, 0] += miss * SETTINGS.position_tolerance
    missed = float((np.hypot(*ends.T) > ERROR).mean())
    charged = risk(miss, std) + FREE_RISK
    assert missed <= charged + 0.01
    if miss == 0.0:
        assert missed == pytest.approx(charged, abs=0.015)


def test_what_goes_farther_or_is_less_sure_is_charged_more() -> None:
    """By miss and by deviation; less the more way is left, as later pushes correct."""
    misses, stds = (0.0, 0.5, 1.0, 1.4), (0.006, 0.01, 0.03)
    for (miss, later), std in itertools.product(itertools.pairwise(misses), stds):
        assert risk(miss, std) < risk(later, std)
    for miss, (std, wider) in itertools.product(misses, itertools.pairwise(stds)):
        assert risk(miss, std) < risk(miss, wider)
    assert risk(0.0, 0.03, 0.1) > risk(0.0, 0.03, 0.3) > risk(0.0, 0.03, 0.5)
    # A way longer by d counts as an error that is wider by a part of d.
    wider = QUERY._replace(settings=SETTINGS._replace(accepted_error=ERROR + CORRECTED_RATIO))
    assert failure_cost(wider, 0.5, 0.05, 0.0) == pytest.approx(
        FAILURE_COST * risk(0.5, 0.05, 1.0))


def test_certain_pushes_are_free_and_hopeless_ones_cost_all() -> None:
    """Nothing is charged where pushes lead back from the goal."""
    assert risk(0.0, 0.0) == risk(0.5, 0.002) == 0.0
    assert risk(2.0, 0.001) == 1.0
    assert risk(0.0, 10.0) == pytest.approx(1.0 - FREE_RISK, abs=1e-5)
    assert failure_cost(QUERY._replace(is_goal_enclosed=False), 3.0, 1.0, 0.0) == 0.0


def plan_before_wall(*blocks: tuple[float, float, float, float]) -> MapPlan:
    """Plan a push of 0.6 m straight on to a wall, from among blocks."""
    goal = Pose(0.0, -2.76, 0.0)
    request = PlanRequest(Pose(0.0, -2.16, 0.0), Pose(0.0, -1.0, -math.pi / 2), goal, box())
    robot = RoundRobot(radius=0.17, max_speed=0.3, max_yaw_rate=1.9, max_acceleration=0.9)
    return plan_push_in_map(request, robot, PlannerSettings(), DriveSettings(),
                            walled_room(*blocks))


@pytest.mark.slow
def test_into_a_niche_the_last_push_is_a_short_one() -> None:
    """At the wall alone a longer one may miss, as others correct it."""
    wall = plan_before_wall()
    niche = plan_before_wall((-1.5, -0.35, -3.0, -2.4), (0.35, 1.5, -3.0, -2.4))
    assert niche.first.trajectory.style is PushStyle.WAYPOINT
    last = niche.remaining.pushes[-1]
    assert last.end[:2] == pytest.approx((0.0, -2.76), abs=1e-6)
    assert last.length < 0.5 * wall.remaining.pushes[-1].length
