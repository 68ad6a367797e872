"""Effort of planning over the number of segments."""

import functools

from helpers.study_outcomes import numbers, outcome_of
import numpy as np
import pytest
from studies.chapter3 import solver_effort

pytestmark = [pytest.mark.physics, pytest.mark.slow]
STUDY, = solver_effort.STUDIES


@functools.lru_cache(maxsize=None)
def found(**overrides):
    """Compute the table, some of its values overridden; return table and findings."""
    lists = {name: list(value) for name, value in overrides.items()}
    outcome = outcome_of(STUDY, **lists)
    return outcome.tables['effort'], numbers(outcome)


def test_work_hardly_grows_up_to_the_steps_of_the_nlp():
    table, findings = found()
    counts = np.array(table['segments'])
    within = counts <= findings['steps']
    for name in solver_effort.GOALS:
        work = table[f'{name}_relative_work']
        assert work[counts == 6] == [1.0]
        assert work[within].max() < 2.0 * work[within].min()
        assert work[-1] < 0.7 * table['integrations_relative'][-1]
    assert counts[within][-1] == 4 * 6 and counts[-1] == 48


def test_work_grows_with_the_steps_once_there_are_more_segments_than_those():
    """Up to 24 segments it is the iterations alone that differ."""
    table, _ = found(segment_counts=(2, 24, 48, 96))
    for name in solver_effort.GOALS:
        counts, work = table['segments'], table[f'{name}_relative_work']
        at = {count: work[counts.index(count)] for count in counts}
        steps = np.array(work) / table[f'{name}_iterations']
        assert steps[:3] == pytest.approx(steps[0]) and counts[2] == 24
        assert at[24] < 2.0 * at[2]
        assert 1.5 < at[96] / at[48] < 3.0


def test_more_segments_make_a_push_no_longer():
    table, findings = found()
    for name in solver_effort.GOALS:
        extra = table[f'{name}_extra_duration']
        assert (np.diff(extra) < 0.0).all()
        assert findings[f'{name}_few'] > 5.0 * findings[f'{name}_six'] > 0.0


def test_the_symmetrical_push_is_symmetrical_and_gains_less():
    _, findings = found()
    assert findings['symmetrical_asymmetry'] < 0.05
    assert findings['asymmetrical_asymmetry'] > 0.3
    assert findings['asymmetrical_few'] > 2.0 * findings['symmetrical_few']


def test_a_mirrored_goal_takes_the_same_work_and_time():
    table, _ = found()
    mirrored, _ = found(goal=(2.0, -0.5, 0.0), asymmetrical_goal=(2.0, -0.5, 0.5))
    for name in solver_effort.GOALS:
        assert mirrored[f'{name}_iterations'] == table[f'{name}_iterations']
        assert mirrored[f'{name}_duration_s'] == pytest.approx(table[f'{name}_duration_s'],
                                                               rel=1e-6)
