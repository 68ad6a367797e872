"""Values of diagnostics as people read them, and as programs read them back."""

import math

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
import numpy as np
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_ros.diagnostics import status_values, value_text
import pytest


@pytest.mark.parametrize('value, text', [
    (None, 'none'), ('', ''), (True, 'true'), (3, '3'), (120.0, '120'), (0.1 + 0.2, '0.3'),
    (np.float64(-0.25), '-0.25'), (1.2345678e-7, '1.23457e-07'), (math.nan, 'nan'),
    (TaskState.PUSH, 'push'), ((0.5, -1.0), '0.5, -1'), (['face 0', 'vertex 1'],
                                                         'face 0, vertex 1'),
    (Pose(1.0, -0.25, math.pi), '1.0000 m, -0.2500 m, 3.1416 rad')])
def test_a_value_is_written_for_people(value, text):
    """Without the names of types, and without digits that mean nothing."""
    assert value_text(value) == text


@pytest.mark.parametrize('value', [0.02, 28.82, 1795334400.123456, -1e-9, 123456.0, 100.0])
def test_a_number_is_read_back(value):
    """To six digits, and times to the microsecond."""
    assert float(value_text(value)) == pytest.approx(value, rel=1e-5, abs=1e-12)
    assert abs(value) < 1.0 or float(value_text(value)) == pytest.approx(value, abs=1e-6)


def test_values_are_found_by_their_names():
    """Whatever unit the key states."""
    status = DiagnosticStatus(values=[KeyValue(key='since [s]', value='2.5'),
                                      KeyValue(key='state', value='push')])
    assert status_values(status) == {'since': '2.5', 'state': 'push'}
