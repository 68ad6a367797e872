"""Values of diagnostics as people read them, and as programs read them back."""

import math
import re
import subprocess
import sys

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
import numpy as np
from push_control.task.status import TaskState
from push_model.geometry import Pose
from push_ros.diagnostics import (
    BURST, LINE_RATE, LogThrottle, OK, status_values, value_text,
)
from push_scenario.dds.private_network import private_domain, private_environment
import pytest

# A node that logs a hundred lines of each kind at once, and ends.
FLOOD = """
import os
import signal
import sys
from push_ros.diagnostics import ERROR, OK
from push_ros.executor import run
from push_ros.node import PushNode


class Flood(PushNode):
    def __init__(self):
        super().__init__('flood', ())

    def start(self):
        for index in range(100):
            self.reporter.log(OK, f'line {index}')
            self.reporter.log(ERROR, f'fault {index}')
        self.create_timer(0.01, lambda: os.kill(os.getpid(), signal.SIGINT))


sys.exit(run(Flood, []))
"""


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


def logged_lines(count: int, duration: float, clock_rate: float) -> list[str]:
    """Return the lines of a log to which so many come within a while, and of 10 s more."""
    throttle, lines = LogThrottle(), []
    for index in range(count):
        now = index * duration / count
        if throttle.admits(OK, f'line {index}', (now, clock_rate * now)):
            lines.append(f'line {index}')
        if int(now) > int(now - duration / count):
            lines.append(throttle.release((now, clock_rate * now)))
    for index in range(10):
        now = duration + index
        lines.append(throttle.release((now, clock_rate * now)))
    return [line if isinstance(line, str) else line[1] for line in lines if line is not None]


@pytest.mark.parametrize('clock_rate', [0.0, 1.0])
def test_a_flood_of_lines_leaves_the_newest_of_each_second_and_the_last(clock_rate):
    """Also where simulated time stands still."""
    lines = logged_lines(3000, 30.0, clock_rate)
    assert len(lines) <= BURST + LINE_RATE * 31.0
    assert lines[-1].startswith('line 2999 (')


def test_lines_of_a_simulation_are_logged_as_often_as_its_own_time_allows():
    """Ten times as fast as on the wall."""
    assert len(logged_lines(190, 10.0, 10.0)) == 190


@pytest.mark.dds
def test_a_node_that_ends_logs_what_it_has_held_back():
    """The newest line of either kind, with the number of those before it, and none twice."""
    with private_domain() as domain:
        done = subprocess.run([sys.executable, '-c', FLOOD], text=True, stderr=subprocess.PIPE,
                              env=private_environment(domain))
    assert done.returncode == 0, done.stderr
    for kind in ('line', 'fault'):
        lines = re.findall(rf'{kind} \d+.*', done.stderr)
        count = int(re.fullmatch(rf'{kind} 99 \((\d+) lines before it are left out\)',
                                 lines[-1])[1])
        assert len(lines) + count == 100
