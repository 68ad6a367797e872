"""Fit of the outlook of plans: quantile regression, and shares of runs."""

from typing import Any, Sequence

from benchmarks.chances.samples import Sample
import numpy as np
from push_model.geometry import FloatArray
from push_model.outlook import LEVELS
from push_planner.outlook import STEERED_PUSH, TimeQuantiles
from scipy import sparse
from scipy.optimize import linprog


def fit_model(samples: Sequence[Sample],
              narrow_slopes: Sequence[float] | None = None) -> dict[str, Any]:
    """
    Fit one model of ``push_planner.outlook``.

    :param samples: of this model.
    :param narrow_slopes: of times, where all tolerances are the same; None to fit them.
    :return: plain values, as ``OutlookModel.from_mapping`` takes them.
    """
    done = [sample for sample in samples if sample.is_done]
    chance = _chance([sample for sample in samples if not sample.is_retry], 0.5)
    retry_chance = _chance([sample for sample in samples if sample.is_retry], chance)
    # Weibull's plotting positions: a further error is below the quantile with its chance.
    errors = np.quantile([sample.relative_errors for sample in done], LEVELS, axis=0,
                         method='weibull')
    position_error, heading_error = ([_rounded(value) for value in column] for column in errors.T)
    return {'chance': _rounded(chance), 'retry_chance': _rounded(retry_chance),
            'time': _fit_time(done, narrow_slopes),
            'position_error': position_error, 'heading_error': heading_error}


def _fit_time(done: Sequence[Sample],
              narrow_slopes: Sequence[float] | None) -> dict[str, list[float]]:
    numbers = [(sample.expected_time, sample.narrowness) for sample in done]
    known, narrow = np.array(numbers).T
    actual = np.array([sample.actual.time for sample in done])
    planes = []
    for level, slope in zip(LEVELS, narrow_slopes or [None] * len(LEVELS)):
        if slope is None:
            planes.append(quantile_plane(np.column_stack([known, narrow]), actual, level))
        else:
            line = quantile_plane(known[:, None], actual - slope * narrow, level)
            planes.append((*line, slope))
    return {name: [_rounded(value) for value in values]
            for name, values in zip(TimeQuantiles._fields, zip(*planes))}


def quantile_plane(known: FloatArray, actual: FloatArray, level: float) -> tuple[float, ...]:
    """
    Fit a plane below which a share of the samples lies.

    It minimizes ``sum of level r+ + (1 - level) r-`` over the residuals ``r+ - r- = y - a - x b``
    (Koenker and Bassett 1978), as a linear program. No slope is negative: whoever expects more
    gets no less.

    :param known: x, shape (n, k).
    :param actual: y, shape (n,).
    :param level: the share, in (0, 1).
    :return: offset a and k slopes b.
    """
    count, dimension = known.shape
    costs = np.concatenate([np.zeros(1 + dimension), np.full(count, level),
                            np.full(count, 1.0 - level)])
    scales = np.abs(known).max(axis=0)
    eye = sparse.eye(count)
    equations = sparse.hstack([np.column_stack([np.ones(count), known / scales]), eye, -eye])
    bounds = [(None, None)] + [(0.0, None)] * (dimension + 2 * count)
    solution = linprog(costs, A_eq=equations, b_eq=actual, bounds=bounds)
    return float(solution.x[0]), *(solution.x[1:1 + dimension] / scales).tolist()


def _chance(samples: Sequence[Sample], expected: float) -> float:
    """
    Estimate a chance by Laplace's rule of succession: what is expected counts as two runs.

    A steered push counts where it is done, whatever its tolerances.
    """
    hits = sum(sample.weight * (sample.is_done if sample.model == STEERED_PUSH
                                else sample.is_within) for sample in samples)
    return (hits + 2.0 * expected) / (sum(sample.weight for sample in samples) + 2.0)


def _rounded(value: float) -> float:
    """Round to what can be told apart."""
    return float(f'{value:.4g}')
