"""The benchmark of stated chances: its fit, and how it counts."""

from benchmarks.chances.coverage import Share
from benchmarks.chances.fit import fit_model, quantile_plane
from benchmarks.chances.jobs import push_jobs, task_jobs
from benchmarks.chances.samples import Ends, Sample
import numpy as np
from push_model.geometry import FloatArray
from push_model.outlook import LEVELS
from push_model.plan_request import GoalTolerances
from push_planner.outlook import usable_tolerances
import pytest


@pytest.mark.parametrize('level', LEVELS)
def test_the_share_below_a_quantile_plane_is_its_level(level: float) -> None:
    """The optimum passes through three samples, and at most as many as it should lie above."""
    rng = np.random.default_rng(5)
    known: FloatArray = rng.uniform(5.0, 60.0, (200, 2))
    actual: FloatArray = 2.0 + known @ (1.0, 0.2) * rng.lognormal(0.0, 0.3, 200)
    offset, *slopes = quantile_plane(known, actual, level)
    residuals = actual - offset - known @ slopes
    above, at_plane = (residuals > 1e-6).sum(), (np.abs(residuals) <= 1e-6).sum()
    assert above <= (1.0 - level) * 200 <= above + at_plane


def test_a_plane_without_noise_is_met_at_every_level() -> None:
    """Also by slopes of very different size."""
    known: FloatArray = np.random.default_rng(6).uniform(1.0, 9.0, (20, 2)) * (1.0, 1e-3)
    for level in LEVELS:
        assert quantile_plane(known, 0.5 + known @ (3.0, 700.0), level) == pytest.approx(
            (0.5, 3.0, 700.0))


def test_errors_in_proportion_to_what_noise_leaves_of_tolerances_are_fitted_exactly() -> None:
    """At every level, so that narrow and wide tolerances say the same."""
    samples = [sample(0.6 * usable_tolerances(GoalTolerances(size, 0.02)).position, tolerance=size)
               for size in (0.003, 0.005, 0.01, 0.02)]
    assert fit_model(samples)['position_error'] == pytest.approx([0.6] * len(LEVELS))


def sample(error: float, *, tolerance: float = 0.01, is_retry: bool = False,
           is_done: bool = True) -> Sample:
    """Make one of a task that took as long as expected."""
    return Sample('open_floor', 'open floor', 1, 20.0, GoalTolerances(tolerance, 0.02),
                  Ends(20.0, error, 0.0), GoalTolerances(tolerance, 0.02), is_done,
                  is_retry=is_retry)


def test_chances_are_shares_of_runs_and_attempts_unheard_of_are_expected_to_be_like_others(
        ) -> None:
    """Two runs that were not made stand for what is expected."""
    model = fit_model([sample(0.005)] * 6 + [sample(0.02), sample(0.0, is_done=False)])
    assert model['chance'] == pytest.approx((6.0 + 1.0) / 10.0)
    assert model['retry_chance'] == pytest.approx(model['chance'])
    assert fit_model([sample(0.005)] * 8 + [sample(0.02, is_retry=True)] * 2)[
        'retry_chance'] == pytest.approx(0.9 * 2.0 / 4.0)


def test_shares_that_are_off_are_bold() -> None:
    """By more than three points."""
    assert not str(Share(50.0, 52, 100)).startswith('**')
    assert str(Share(50.0, 60, 100)).startswith('**60 (')


def test_the_first_jobs_do_not_depend_on_their_number() -> None:
    """So that a longer run resumes a shorter one."""
    assert task_jobs('open floor', 30)[:10] == task_jobs('open floor', 10)
    spatial = push_jobs(12, is_spatial=True)
    assert spatial[:5] == push_jobs(5, is_spatial=True)
    assert not any(job['kind'].startswith('table') for job in spatial)
