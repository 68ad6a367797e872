"""Page of the benchmark of tasks: which failures come first, and which are replayed."""

from benchmarks import task_page
from benchmarks.controller.tables import table
from benchmarks.task_page import failure_lines, markdown_lines, write_page
from benchmarks.tasks.cases import METHODS, OPEN

RECORD = {'success': True, 'outcome': 'done', 'reason': '', 'pushes': 2, 'recoveries': 0,
          'duration': 20.0, 'position_error': 0.004, 'heading_error': 0.01}
FAILED = {**RECORD, 'success': False, 'outcome': 'failed', 'reason': 'no plan within 3 s'}
LOST = {**RECORD, 'success': False, 'outcome': 'failed', 'reason': 'the object is lost'}
BROKEN = {'success': False, 'outcome': 'error', 'reason': 'ValueError: no'}


def job(seed):
    """Make a job."""
    return {'part': OPEN, 'kind': 'box_04, holonomic', 'seed': seed, 'method': METHODS[0]}


def test_the_first_of_each_class_comes_first():
    """What succeeded without a collision is not there."""
    records = [RECORD, FAILED, FAILED, LOST, {**RECORD, 'robot_clearance': -0.01}]
    found = failure_lines([(job(seed), record) for seed, record in enumerate(records)])
    assert [entry[0]['seed'] for entry in found] == [1, 3, 4, 2]
    assert found[2][2] == 'robot collides'


def test_a_table_is_split_into_its_cells():
    """As it was put together."""
    assert markdown_lines(table(['', 'b'], [('1, 2', 3)])) == [['', 'b'], ['1, 2', '3']]


def test_what_ended_with_an_error_is_not_run_again(monkeypatch, tmp_path):
    """Others are, within a limit; the line says how many."""
    monkeypatch.setattr(task_page, 'MAX_REPLAYS', 1)
    shown = []
    monkeypatch.setattr(task_page, 'write_batch_report',
                        lambda tables, path, title: shown.extend(tables))
    records = [RECORD, BROKEN, FAILED, LOST]
    text = write_page(tmp_path / 'tasks.html', [job(seed) for seed in range(4)], records)
    success, faults = shown
    assert text.endswith('in it: 1')
    assert success.lines[1][2:4] == ['4', '25.0 %']
    assert faults.title == '3 faults in 4 tasks' and list(faults.replays) == [2]
    assert faults.lines[1][0] == f'{OPEN}, box_04, holonomic, seed 1'
