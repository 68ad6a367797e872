"""A task with a lidar over Fast DDS, in lockstep: three nodes in three processes."""

from push_scenario.dds.replay import run_over_dds
from push_scenario.definition.loader import load_scenario
from push_scenario.evaluation.metrics import distance_travelled
from push_scenario.simulation.result import Outcome
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]


def test_a_robot_comes_from_the_other_end_of_a_flat_by_its_lidar(tmp_path):
    """It passes two doors, pushes, and is done where the object truly is at its goal."""
    scenario = load_scenario('task_lidar')
    result = run_over_dds(scenario, None, tmp_path, record=False)
    assert result.outcome is Outcome.DONE and result.pushes >= 1
    assert abs(result.position_error) <= scenario.bounds.position_error
    assert distance_travelled(result.tape)[-1] > 8.0
