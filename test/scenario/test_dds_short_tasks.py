"""Tasks of unsteered pushes over Fast DDS, in lockstep, each as in one process."""

from push_scenario.dds.replay import run_over_dds
from push_scenario.definition.loader import load_scenario
from push_scenario.evaluation.metrics import is_as_expected
from push_scenario.evaluation.report import format_report
import pytest

pytestmark = [pytest.mark.dds, pytest.mark.slow]


@pytest.mark.parametrize('name', ['task_tap', 'task_frictionless'])
def test_the_task_ends_as_expected(name, tmp_path):
    """
    With requests, plans and their style in messages, and three nodes in three processes.

    The first one has commands without a stamp.
    """
    result = run_over_dds(load_scenario(name), None, tmp_path, record=False,
                          stamped=name != 'task_tap')
    assert is_as_expected(result), format_report([result])
