"""The report of the calibration: what it counts."""

import math

from benchmarks.calibration.over_dds import Calibrated
from benchmarks.calibration.report import Errors, LIMITS, main, QUANTITIES, row
from push_scenario.simulation.result import Outcome
import pytest


def test_what_is_right_is_counted():
    """By size, without what was not measured; the limits are those in the text."""
    errors = Errors([0.005, -0.03, 0.02, math.nan], 3)
    assert row('dead_time', errors) == '| dead time | 2 of 4 within 20 ms | 20, 30 ms | 3 |'
    assert row('offset', Errors([0.001, -0.002])).endswith(
        '| 2 of 2 within 3 mm | 1.5, 2.0 mm |  |')


@pytest.mark.parametrize('name', LIMITS)
def test_limits_are_written_as_they_are(name):
    """The number in the text is that which is compared with."""
    quantity = QUANTITIES[name]
    assert float(quantity.limit.split()[0]) == pytest.approx(quantity.factor * LIMITS[name])


@pytest.mark.slow
def test_the_page_is_written(tmp_path, capsys):
    """With the table that is printed."""
    assert main(['--bases', '1', '--out', str(tmp_path)]) == 0
    table = capsys.readouterr().out[-400:].split('\n', 1)[1]
    assert table.strip() in (tmp_path / 'calibrate.md').read_text()


def test_tasks_that_are_not_done_with_the_file_are_counted(monkeypatch, capsys):
    """Beside the errors of what the file states; times are of tasks that are done."""
    def run(_, seed, folder):
        assert folder.is_dir()
        is_done = seed != 1
        return Calibrated({'dead_time': 0.01 * seed, 'least_speed': 0.0},
                          Outcome.DONE if is_done else Outcome.FAILED, 20.0 + seed, '')

    monkeypatch.setattr('benchmarks.calibration.over_dds.calibrate_over_dds', run)
    assert main(['--over-dds', '4']) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-3:] == [
        '| dead time | 3 of 4 within 20 ms | 15, 30 ms |',
        '| least speed | 4 of 4 within 0.01 m/s | 0.000, 0.000 m/s |',
        '| task with the file | 3 of 4 done | 22, 23 s |']
