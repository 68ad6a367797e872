"""Rooms of the package: all can be read, and all their objects have a place in an order."""

from push_model.files.data import share_directory
from push_model.files.parameter_files import files_by_name
from push_planner.rearrangement.order import plan_order
from push_planner.rearrangement.problem import OrderPlan, Rearrangement
from push_scenario.tidying.room import read_room
from push_scenario.tidying.tidy import tidy
import pytest

ROOMS = files_by_name(share_directory() / 'config' / 'rooms')


@pytest.mark.parametrize('name', ROOMS)
def test_the_order_uses_a_temporary_place(name: str) -> None:
    """Both rooms cannot do without one, and every object gets to its goal."""
    plans: list[OrderPlan] = []

    def plan_only(problem: Rearrangement) -> OrderPlan:
        plans.append(plan_order(problem))
        return plans[-1]._replace(moves=())

    tidy(read_room(ROOMS[name]), find_order=plan_only)
    plan, = plans
    assert not plan.refusals and sum(move.is_temporary for move in plan.moves) == 1
