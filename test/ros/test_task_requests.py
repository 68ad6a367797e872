"""Requests of tasks in live maps, as the planner's node handles them, without a network."""

import numpy as np
from push_model.geometry import BoolArray, Pose
from push_model.plan_request import PlanFailure, PlanRequest
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import MapSettings
from push_planner.problem import PlanningFailed
from push_planner.ros.parameters import PlannerParameters
from push_planner.ros.task_requests import TaskRequestHandler
from push_ros.conversions.map import to_map_message
from push_ros.conversions.primitives import to_stamp
from push_scenario.definition.loader import load_scenario
import pytest

SCENARIO = load_scenario('task_approach')
FRAME = 'odom'
OBJECT, GOAL = Pose(0.0, 0.0, 0.0), Pose(1.2, 0.0, 0.0)
REQUEST = PlanRequest(OBJECT, Pose(-0.8, 0.0, 0.0), GOAL, SCENARIO.object)


def marks(*places: Pose) -> BoolArray:
    """Mark the cells of an object of 0.4 m at some places, in a map of 8 m about the origin."""
    cells = np.zeros((80, 80), dtype=np.bool_)
    for place in places:
        row, column = (round(10.0 * value) + 40 for value in (place.y, place.x))
        cells[row - 2:row + 2, column - 2:column + 2] = True
    return cells


@pytest.fixture
def handler() -> TaskRequestHandler:
    """Make one that clears footprints."""
    assert SCENARIO.task is not None
    return TaskRequestHandler(PlannerParameters(
        SCENARIO.object, SCENARIO.robot, SCENARIO.planner, SCENARIO.task.drive,
        MapSettings(footprint_clearing_enabled=True)), FRAME)


def show(handler: TaskRequestHandler, time: float, cells: BoolArray) -> None:
    """Let a map come."""
    handler.on_map(to_map_message(OccupancyMap(0.1, Pose(-4.0, -4.0, 0.0), cells),
                                  to_stamp(time), FRAME))
    assert handler.take_map() is not None


def test_a_goal_where_the_costmap_still_shows_the_object_is_free(
        handler: TaskRequestHandler) -> None:
    """The object was there long ago, and each map since has shown it; an obstacle is another."""
    handler.clearing.record(10.0, GOAL, None)
    show(handler, 10.0, marks(GOAL))
    handler.clearing.record(60.0, OBJECT, None)
    show(handler, 60.0, marks(GOAL, OBJECT))
    assert handler.plan(REQUEST).trajectory.duration > 0.0
    show(handler, 61.0, marks(OBJECT))
    show(handler, 62.0, marks(GOAL, OBJECT))
    with pytest.raises(PlanningFailed) as failure:
        handler.plan(REQUEST)
    assert failure.value.code is PlanFailure.NOT_FREE
