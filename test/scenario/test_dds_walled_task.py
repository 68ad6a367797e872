"""A task without a path over Fast DDS, in lockstep: three nodes in three processes."""

import dataclasses

from push_control.behaviors.progress import MAP_TIME_LIMIT
from push_model.plan_request import PlanFailure
from push_scenario.dds.replay import run_over_dds
from push_scenario.definition.loader import load_scenario
from push_scenario.definition.placement import Placement
from push_scenario.simulation.result import Outcome
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]


def test_a_task_without_a_path_fails_and_says_so(tmp_path):
    """The robot never moves; it waits for a map that shows a path, and then gives up."""
    goal = Placement(5.0, 0.0, 0.0)
    result = run_over_dds(dataclasses.replace(load_scenario('task_map'), goal=goal), None,
                          tmp_path, record=False)
    assert result.outcome is Outcome.FAILED and PlanFailure.NOT_FREE in result.codes
    assert not result.tape['robot_v_x'].any() and result.duration >= MAP_TIME_LIMIT
