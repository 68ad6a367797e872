"""Benchmark of the controller: confidence interval and groups."""

from benchmarks.controller.tables import ALL, groups, wilson
import pytest


@pytest.mark.parametrize(('hits', 'count'), [(0, 10), (5, 10), (997, 1000), (1000, 1000)])
def test_the_interval_is_that_of_scipy(hits, count):
    """Also where all or none succeed."""
    # Imported here: collecting the tests takes a tenth of the time of all of them.
    from scipy.stats import binomtest
    expected = binomtest(hits, count).proportion_ci(method='wilson')
    assert wilson(hits, count) == pytest.approx((expected.low, expected.high), abs=1e-5)


def test_refused_pushes_are_counted_apart():
    """Neither goals without a plan nor refused starts are pushes; failures are."""
    def job(seed):
        return {'kind': 'box, holonomic', 'stress': 'as stated', 'seed': seed}

    def record(outcome, success):
        return {'plan': '', **{f'{law}.{name}': value for law in ('feedback', 'mpc')
                               for name, value in (('outcome', outcome), ('success', success))}}

    records = [{'plan': 'no contact'}, record('refused', False), record('failed', False),
               record('done', True), record('done', False)]
    found = groups([job(seed) for seed in range(5)], records)
    assert {group.kind for group in found} == {ALL, 'box, holonomic'}
    for group in found:
        assert (group.unplanned, group.refused, len(group.pushes), group.successes) == (1, 1, 3, 1)
