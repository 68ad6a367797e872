"""Tasks with bad bases: what is too heavy and called so, and the tables."""

from types import SimpleNamespace

from benchmarks.tasks.base_tables import base_table, weight_table
from benchmarks.tasks.bases import BAD_BASES, GOOD, NOT_LEARNED
from benchmarks.tasks.cases import BASES, KINDS
from benchmarks.tasks.groups import faults_of
from benchmarks.tasks.weight import first_touch, weight_record
from helpers.objects import box
import numpy as np
from push_control.goal import TaskFailure
from push_model.parameters import RoundRobot
from push_sim_node.tape import Tape
import pytest

KIND = KINDS[BASES][0]
WEAK = list(BAD_BASES).index('spinning beyond 20 N')
# Weight times friction of the object of these tests [N].
NEEDED = 0.3 * 5.0 * 9.81


def tape_of(gaps):
    """Return a tape with these gaps, one each 0.5 s."""
    return Tape(('time', 'gap'), np.array([(0.5 * k, gap) for k, gap in enumerate(gaps)]))


def result_of(force, failure, gaps=(1.0, 0.01, 0.0005, 0.02, 0.0)):
    """Return a run of 8 s in which a robot of this force pushes an object that needs 14.7 N."""
    scenario = SimpleNamespace(true_object=box(mass=5.0),
                               true_robot=RoundRobot(0.17, max_push_force=force))
    return SimpleNamespace(scenario=scenario, status=SimpleNamespace(failure=failure),
                           tape=tape_of(gaps), duration=8.0)


@pytest.mark.parametrize('ratio, is_heavy', [(0.99, True), (1.01, False), (np.inf, False)])
def test_an_object_is_too_heavy_where_it_needs_more_than_the_robot_has(ratio, is_heavy):
    for failure, is_called in ((TaskFailure.TOO_HEAVY, True), (TaskFailure.NO_PROGRESS, False),
                               (None, False)):
        record = weight_record(result_of(ratio * NEEDED, failure))
        assert record['is_too_heavy'] is is_heavy
        assert record['called_too_heavy'] is is_called
        assert record.get('called_after') == (7.0 if is_called else None)


def test_the_first_touch_is_the_first_row_without_a_gap():
    """Soft contacts have negative gaps; a robot that never touches has none."""
    assert first_touch(tape_of((0.3, 0.002, -0.001, 0.5))) == 1.0
    assert first_touch(tape_of((0.3, 0.002))) is None
    record = weight_record(result_of(1.0, TaskFailure.TOO_HEAVY, gaps=(0.3, 0.2)))
    assert record['called_too_heavy'] and 'called_after' not in record


def task(number, base=0, treated=None, **record):
    """Return (job, record) of a task that is done in 30 s."""
    job = {'part': BASES, 'kind': KIND, 'seed': 100 * number + base}
    if treated is not None:
        job['base'] = treated
    name = GOOD if treated == GOOD else list(BAD_BASES)[base]
    return job, {'variety': name, 'success': True, 'outcome': 'done', 'reason': '',
                 'duration': 30.0, 'is_too_heavy': False, 'called_too_heavy': False, **record}


def cells_of(text):
    """Return the cells of a table by the first of each row, without those of the head."""
    rows = [[cell.strip() for cell in line.strip('|').split('|')] for line in text.splitlines()]
    return {row[0]: row[1:] for row in rows[2:]}


def test_both_columns_and_the_times_are_of_the_same_tasks():
    """Time over that of a good base, where both are done; what falls short is bold."""
    pairs = [task(0, treated=GOOD, duration=20.0), task(1, treated=GOOD, duration=40.0),
             task(2, treated=GOOD, success=False),
             task(0, duration=22.0), task(1, duration=40.0), task(2),
             task(0, treated=NOT_LEARNED, success=False), task(1, treated=NOT_LEARNED,
                                                               duration=80.0),
             task(2, treated=NOT_LEARNED, success=False)]
    tasks, without, learned, aim, ratio_without, ratio, ratio_aim, times, false = cells_of(
        base_table(pairs, BASES))[list(BAD_BASES)[0]]
    assert (tasks, aim, ratio_aim, false) == ('3', '99 %', '1.15', '0')
    assert without.startswith('1 of 3') and learned.startswith('3 of 3')
    assert (ratio_without, ratio) == ('2.00', '1.05')
    slow = [(job, {**record, 'duration': 60.0}) if not record['variety'] == GOOD else (job, record)
            for job, record in pairs]
    assert cells_of(base_table(slow, BASES))[list(BAD_BASES)[0]][5] == '**2.25**'


def test_heavy_objects_count_apart():
    """Called late counts as not called; one that is done need not be, a light one must not be."""
    heavy = {'is_too_heavy': True, 'success': False, 'outcome': 'failed', 'reason': 'aborted'}
    called = {'called_too_heavy': True, 'called_after': 7.0}
    pairs = [task(0, WEAK), task(1, WEAK, **heavy, **called),
             task(2, WEAK, **heavy, **{**called, 'called_after': 12.0}),
             task(3, WEAK, **heavy), task(4, WEAK, is_too_heavy=True),
             task(0, 1, success=False, outcome='failed', **called),
             task(0, WEAK, treated=NOT_LEARNED, **called)]
    assert cells_of(base_table(pairs, BASES))['spinning beyond 20 N'][0] == '1'
    weights = cells_of(weight_table(pairs, BASES))
    heavy_count, soon, ever, times, done, fit, false = weights['spinning beyond 20 N']
    assert (heavy_count, ever, times, done, fit, false) == ('4', '2', '10, 12', '1', '1', '0')
    assert soon.startswith('**1 of 3')
    assert weights['all'][-2:] == ['2', '**1**']
    assert [bool(faults_of(*pair)) for pair in pairs[:6]] == [
        False, False, False, True, False, True]
